// Every layout that real codes have, in every order: one picture, and arrays that stay what they were.
#include <gtest/gtest.h>

#include <map>

#include "api_test_tools.h"
#include "layouts.h"

namespace insitu {
namespace {

using testing::Context;
using testing::Layout;
using testing::Picture;
using testing::works;

constexpr std::uint32_t every_order[] = {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY};

const char* order_name(std::uint32_t order) {
  return order == INSITU_ORDER_INDEX ? "index" : order == INSITU_ORDER_PERMUTE ? "permute" : "copy";
}

// The descriptor of a layout, with all that it points to.
struct Bound {
  Bound(Layout& layout, std::uint32_t order, bool sized) {
    if (order == INSITU_ORDER_PERMUTE)
      for (insitu_array* array : layout.arrays()) array->flags |= INSITU_ARRAY_PERMUTABLE;
    insitu_particles_desc_init(&desc);
    desc.order = order;
    desc.flags = order == INSITU_ORDER_PERMUTE ? INSITU_PARTICLES_KEEP_PERMUTATION : 0;
    desc.position = &layout.position;
    desc.position_scale = layout.scale;
    for (int c = 0; c < 3; ++c) desc.position_origin[c] = layout.origin[c];
    // Under another order an array of radii that does not count is left out; under this one it has to move along.
    if (layout.radius && sized) desc.radius = &*layout.radius;
    if (layout.radius && !sized) payload.push_back(&*layout.radius);
    desc.radius_default = 0.75;
    attribute = {"value", &layout.value};
    desc.attributes = &attribute;
    desc.attribute_count = 1;
    payload.push_back(&layout.id);
    if (layout.record) payload.push_back(&*layout.record);
    desc.payload = payload.data();
    desc.payload_count = payload.size();
  }
  Bound(const Bound&) = delete;
  Bound& operator=(const Bound&) = delete;

  insitu_particles_desc desc;
  insitu_attribute attribute;
  std::vector<const insitu_array*> payload;
};

// Rays straight down, whose starts are exact in every layout, also where integers are shifted by an origin.
insitu_view straight_view(insitu_context context) {
  insitu_camera camera;
  insitu_camera_init(&camera);
  camera.kind = INSITU_CAMERA_ORTHOGRAPHIC;
  camera.eye[0] = camera.look_at[0] = 32.0;
  camera.eye[1] = camera.look_at[1] = 32.0;
  camera.eye[2] = 128.0;
  camera.height = 64.0;
  return testing::make_view(context, &camera, 0);
}

// Perspective, shadows and ambient occlusion.
insitu_view rich_view(insitu_context context) {
  insitu_camera camera;
  insitu_camera_init(&camera);
  const double eye[3] = {20.0, 90.0, 150.0};
  for (int c = 0; c < 3; ++c) {
    camera.eye[c] = eye[c];
    camera.look_at[c] = 32.0;
  }
  return testing::make_view(context, &camera, 4);
}

struct Pictures {
  Picture straight;
  Picture rich;
};

std::vector<std::byte> bytes_of(const Layout& layout) {
  std::vector<std::byte> bytes;
  for (const testing::Memory& memory : layout.memory)
    bytes.insert(bytes.end(), memory.data(), memory.data() + memory.size());
  return bytes;
}

// Where in bytes_of(layout) each byte stands that an array views.
class ByteMap {
 public:
  explicit ByteMap(const Layout& layout) {
    std::size_t begin = 0;
    for (const testing::Memory& memory : layout.memory) {
      starts_[memory.data()] = begin;
      begin += memory.size();
    }
    moved_.assign(begin, false);
  }
  std::size_t place(const std::byte* address) const {
    const auto block = std::prev(starts_.upper_bound(address));
    return block->second + static_cast<std::size_t>(address - block->first);
  }
  std::vector<bool>& moved() { return moved_; }

 private:
  std::map<const std::byte*, std::size_t> starts_;
  std::vector<bool> moved_;
};

// Every array of the layout is `before`, put into the order `original`; all other bytes are where they were.
void expect_permuted(Layout& layout, const std::vector<std::byte>& before, const std::vector<std::uint64_t>& original) {
  const std::vector<std::byte> after = bytes_of(layout);
  ByteMap map(layout);
  std::size_t wrong = 0;
  for (const insitu_array* array : layout.arrays()) {
    const std::size_t size = testing::scalar_bytes(array->type);
    for (std::size_t i = 0; i < original.size(); ++i) {
      for (std::uint32_t c = 0; c < array->components; ++c) {
        const std::size_t now = map.place(testing::address_of(*array, i, c));
        const std::size_t then = map.place(testing::address_of(*array, original[i], c));
        wrong += std::memcmp(&after[now], &before[then], size) != 0 ? 1 : 0;
        for (std::size_t byte = 0; byte < size; ++byte) map.moved()[now + byte] = true;
      }
    }
  }
  EXPECT_EQ(wrong, 0u) << "scalars that are not those of their record";
  std::size_t touched = 0;
  for (std::size_t i = 0; i < before.size(); ++i) touched += !map.moved()[i] && before[i] != after[i] ? 1 : 0;
  EXPECT_EQ(touched, 0u) << "bytes that belong to no array of the descriptor";
}

bool is_permutation_of_places(const std::vector<std::uint64_t>& original) {
  std::vector<bool> seen(original.size(), false);
  for (const std::uint64_t place : original) {
    if (place >= original.size() || seen[place]) return false;
    seen[place] = true;
  }
  return true;
}

// A step with the layout in this order, checking its memory at every turn. Items of the pictures are ids.
Pictures draw(Layout& layout, std::uint32_t order, bool sized) {
  const Context context;
  Bound bound(layout, order, sized);
  const std::size_t count = layout.position.count;
  const std::vector<std::byte> before = bytes_of(layout);
  const insitu_view straight = straight_view(context);
  const insitu_view rich = rich_view(context);
  const insitu_image image = testing::make_image(context, 64, 64, 1);
  const insitu_image small = testing::make_image(context, 40, 30, 2);

  insitu_geometry geometry = {0};
  EXPECT_TRUE(works(context, insitu_step_begin(context, 0, 0.0)));
  EXPECT_TRUE(works(context, insitu_particles_create(context, &bound.desc, &geometry)));
  const insitu_style style = testing::make_style("value", 0.0, 1.0);
  EXPECT_TRUE(works(context, insitu_geometry_set_style(context, geometry, &style)));
  EXPECT_EQ(bytes_of(layout), before) << "before insitu_commit";
  EXPECT_TRUE(works(context, insitu_commit(context)));

  std::vector<std::uint64_t> original(count);
  EXPECT_TRUE(works(context, insitu_particles_permutation(context, geometry, original.data(), count)));
  EXPECT_TRUE(is_permutation_of_places(original));
  if (order != INSITU_ORDER_PERMUTE) {
    EXPECT_EQ(bytes_of(layout), before) << "after insitu_commit";
  } else {
    expect_permuted(layout, before, original);
  }

  const auto id = [&](std::uint64_t item) { return testing::load_integer(layout.id, item); };
  Pictures pictures;
  const std::vector<std::byte> committed = bytes_of(layout);
  EXPECT_TRUE(works(context, insitu_render(context, straight, image)));
  pictures.straight = testing::read_picture(context, image).named(id);
  EXPECT_TRUE(works(context, insitu_render(context, rich, small)));
  pictures.rich = testing::read_picture(context, small).named(id);
  EXPECT_EQ(bytes_of(layout), committed) << "after insitu_render";

  if (order == INSITU_ORDER_PERMUTE) {
    EXPECT_TRUE(works(context, insitu_particles_restore_order(context, geometry)));
    EXPECT_EQ(bytes_of(layout), before) << "after insitu_particles_restore_order";
  }
  EXPECT_TRUE(works(context, insitu_step_end(context)));
  EXPECT_EQ(bytes_of(layout), before) << "after insitu_step_end";
  return pictures;
}

void expect_same_pictures(const std::vector<testing::Particle>& particles) {
  const auto layouts = testing::all_layouts(particles);
  const Pictures uniform = draw(*layouts[0], INSITU_ORDER_INDEX, false);
  const Pictures sized = draw(*layouts[0], INSITU_ORDER_INDEX, true);
  if (particles.size() > 100) {
    EXPECT_GT(uniform.straight.hits(), 500u) << "there is something to see";
    EXPECT_FALSE(uniform.straight == sized.straight);
  }
  for (const auto& layout : layouts) {
    for (const std::uint32_t order : every_order) {
      SCOPED_TRACE(layout->name + ", " + order_name(order) + ", " + std::to_string(particles.size()) + " particles");
      // A shift by an origin rounds the starts of rays that are not exact: their hits may differ in the last bit.
      const bool shifted = layout->origin[0] != 0.0;
      const Pictures one_radius = draw(*layout, order, false);
      EXPECT_EQ(one_radius.straight, uniform.straight);
      if (!shifted) {
        EXPECT_EQ(one_radius.rich, uniform.rich);
      }
      if (!layout->radius) continue;
      const Pictures own_radii = draw(*layout, order, true);
      EXPECT_EQ(own_radii.straight, sized.straight);
      EXPECT_EQ(own_radii.rich, sized.rich);
    }
  }
}

TEST(Layouts, TheSamePictureInEveryLayoutAndOrder) { expect_same_pictures(testing::some_particles(777, 1)); }

TEST(Layouts, FewParticles) {
  for (const std::size_t count : {0u, 1u, 2u, 3u, 32u, 33u, 34u, 65u})
    expect_same_pictures(testing::some_particles(count, count));
}

// Past the size that the build takes to the cache in one go.
TEST(Layouts, ManyParticles) {
  const auto particles = testing::some_particles(40000, 2);
  const auto layouts = testing::all_layouts(particles);
  const Picture reference = draw(*layouts[0], INSITU_ORDER_INDEX, false).rich;
  for (const auto& layout : layouts) {
    for (const std::uint32_t order : every_order) {
      SCOPED_TRACE(layout->name + ", " + order_name(order));
      const Picture picture = draw(*layout, order, false).rich;
      if (layout->origin[0] == 0.0) {
        EXPECT_EQ(picture, reference);
      }
    }
  }
}

// Particles that are not drawn stand in the way of an in-place order: they move behind the others, records whole.
TEST(Layouts, SkippedParticlesMoveAlong) {
  const auto particles = testing::some_particles(500, 3);
  const auto layouts = testing::all_layouts(particles);
  for (const auto& layout : layouts) {
    if (!layout->radius) continue;
    for (std::size_t i = 0; i < particles.size(); i += 3) testing::store(*layout->radius, i, 0, -1.0);
    for (const std::uint32_t order : every_order) {
      SCOPED_TRACE(layout->name + ", " + order_name(order));
      const Picture picture = draw(*layout, order, true).straight;
      EXPECT_EQ(picture, draw(*layouts[0], INSITU_ORDER_INDEX, true).straight);
    }
  }
}

}  // namespace
}  // namespace insitu
