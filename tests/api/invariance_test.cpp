// The picture depends on the particles alone: not on threads, the order of the arrays, where they live or how the tree
// is built. Bit for bit, with shadows and ambient occlusion.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Context;
using testing::Picture;
using testing::works;

constexpr std::size_t count = testing::sanitized ? 6000 : 40000;

struct Particle {
  float x[3];
  float radius;
  double heat[2];
  std::uint8_t type;
  std::uint32_t id;
};

// Spread, clustered, on a lattice whose spheres cut each other in exact symmetry, and many at one point that differ in
// one thing each.
std::vector<Particle> make_particles(std::uint64_t seed) {
  testing::SplitMix64 random(seed);
  std::vector<Particle> particles(count);
  for (std::size_t i = 0; i < count; ++i) {
    Particle& p = particles[i];
    p.radius = 0.02f;
    p.type = static_cast<std::uint8_t>(random.below(4));
    for (float& x : p.x) x = static_cast<float>(random.unit());
    if (i % 4 == 1)
      for (float& x : p.x) x = 0.5f + 0.1f * (x - 0.5f) * (x - 0.5f);
    if (i % 4 == 2)
      for (float& x : p.x) x = static_cast<float>(random.below(16)) / 16.0f;
    if (i % 4 == 2) p.radius = 0.04f;
    p.heat[0] = random.unit();
    p.heat[1] = random.unit();
    p.id = static_cast<std::uint32_t>(i);
  }
  // Twins that stand in front of the others.
  for (std::size_t i = 0; i < 200; ++i) {
    Particle& p = particles[29 * i];
    p.x[0] = 0.25f * static_cast<float>(1 + i % 3);
    p.x[1] = 0.5f;
    p.x[2] = 1.25f;
    p.radius = i % 5 == 0 ? 0.1f : 0.11f;
    p.heat[0] = static_cast<double>(i) / 200.0;
    p.type = static_cast<std::uint8_t>(i % 4);
  }
  return particles;
}

struct Variant {
  std::uint32_t max_threads = 0;
  std::uint32_t order = INSITU_ORDER_INDEX;
  std::uint32_t max_samples = 0;  // per pixel; 0: not adaptive
  double treelet_share = 0.0;
  double opacity = 0.0;
};

std::vector<Particle> shuffled(const std::vector<Particle>& particles, std::uint64_t seed) {
  std::vector<Particle> result;
  for (const std::size_t from : testing::shuffled_order(particles.size(), seed)) result.push_back(particles[from]);
  return result;
}

insitu_camera front_camera() {
  insitu_camera camera;
  insitu_camera_init(&camera);
  const double eye[3] = {0.7, 0.9, 2.6};
  for (int c = 0; c < 3; ++c) {
    camera.eye[c] = eye[c];
    camera.look_at[c] = 0.5;
  }
  return camera;
}

// Borrowed views of records that stay where they are.
struct Arrays {
  explicit Arrays(std::vector<Particle>& particles) : Arrays(particles.data(), particles.size()) {}
  Arrays(Particle* particles, std::size_t size) {
    const auto field = [size](std::uint32_t scalar, std::uint32_t components, const void* first) {
      insitu_array array = insitu_array_records(scalar, components, first, size, sizeof(Particle));
      array.flags = INSITU_ARRAY_PERMUTABLE;
      return array;
    };
    position = field(INSITU_F32, 3, particles->x);
    radius = field(INSITU_F32, 1, &particles->radius);
    heat = field(INSITU_F64, 2, particles->heat);
    type = field(INSITU_U8, 1, &particles->type);
    id = field(INSITU_U32, 1, &particles->id);
    attribute = {"heat", &heat};
    insitu_particles_desc_init(&desc);
    desc.position = &position;
    desc.radius = &radius;
    desc.type = &type;
    desc.attributes = &attribute;
    desc.attribute_count = 1;
    desc.payload = payload;
    desc.payload_count = 1;
  }
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;

  insitu_array position, radius, heat, type, id;
  insitu_attribute attribute;
  const insitu_array* payload[1] = {&id};
  insitu_particles_desc desc;
};

// The length of the vector, over a range that is found in the data.
insitu_style by_heat() {
  insitu_style style;
  insitu_style_init(&style);
  style.color_by = INSITU_COLOR_ATTRIBUTE;
  style.attribute = "heat";
  return style;
}

Picture draw(std::vector<Particle> particles, const Variant& variant) {
  const Context context(variant.max_threads);
  Arrays arrays(particles);
  arrays.desc.treelet_share = variant.treelet_share;
  const insitu_geometry geometry = testing::make_particles(context, variant.order);
  insitu_style style = by_heat();
  style.opacity = variant.opacity;
  EXPECT_TRUE(works(context, insitu_geometry_set_style(context, geometry, &style)));
  const insitu_camera camera = front_camera();
  const insitu_view view = testing::make_view(context, &camera, 3);
  // No multiple of any tile.
  const insitu_image image = testing::make_image(context, 70, 50, 2, variant.max_samples);
  EXPECT_TRUE(works(context, run_step(context, geometry, arrays.desc, view, image)));
  return testing::read_picture(context, image).named([&](std::uint64_t item) { return particles[item].id; });
}

// More threads than this machine may have: the host raises the limit, so that all of them run.
class Invariance : public ::testing::Test {
 protected:
  tbb::global_control limit_{tbb::global_control::max_allowed_parallelism, 8};
};

TEST_F(Invariance, NumberOfThreads) {
  const std::vector<Particle> particles = make_particles(1);
  const Picture reference = draw(particles, {.max_threads = 1});
  EXPECT_GT(reference.hits(), 1000u);
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY}) {
    for (const std::uint32_t max_threads : {1u, 2u, 3u, 8u, 0u}) {
      SCOPED_TRACE(max_threads);
      EXPECT_EQ(draw(particles, {max_threads, order}), reference);
    }
  }
}

// With many treelets, with few, and with none that fit.
TEST_F(Invariance, Treelets) {
  const std::vector<Particle> particles = make_particles(4);
  const Picture reference = draw(particles, {.max_threads = 1});
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY}) {
    for (const double share : {1.0, 0.02, 1e-9}) {
      SCOPED_TRACE(share);
      EXPECT_EQ(draw(particles, {.max_threads = 3, .order = order, .treelet_share = share}), reference);
    }
  }
}

// Again and again: what differs between runs is the work that each thread happens to get.
TEST_F(Invariance, Repetition) {
  const std::vector<Particle> particles = make_particles(2);
  const Picture reference = draw(particles, {.max_threads = 1});
  for (int round = 0; round < (testing::sanitized ? 2 : 10); ++round)
    EXPECT_EQ(draw(particles, {8, INSITU_ORDER_PERMUTE}), reference);
}

TEST_F(Invariance, OrderOfTheParticles) {
  const std::vector<Particle> particles = make_particles(3);
  const Picture reference = draw(particles, {.max_threads = 1});
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(seed);
      EXPECT_EQ(draw(shuffled(particles, seed), {8, order}), reference);
    }
    std::vector<Particle> backwards(particles.rbegin(), particles.rend());
    EXPECT_EQ(draw(backwards, {2, order}), reference);
  }
}

// How many samples a pixel takes is decided by what they show, which is the same.
TEST_F(Invariance, AdaptiveSampling) {
  const std::vector<Particle> particles = make_particles(8);
  const Picture fixed = draw(particles, {.max_threads = 1});
  const Picture reference = draw(particles, {.max_threads = 1, .max_samples = 24});
  EXPECT_NE(reference.color, fixed.color);
  EXPECT_EQ(reference.item, fixed.item);
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY})
    EXPECT_EQ(draw(shuffled(particles, 5), {8, order, 24}), reference);
}

// Particles that can be seen through: dozens of layers per ray, more than a list of them holds, and shadows through all
// of them.
TEST_F(Invariance, Transparency) {
  std::vector<Particle> particles = make_particles(9);
  particles.resize(testing::sanitized ? 300 : 1500);
  const Picture opaque = draw(particles, {.max_threads = 1});
  for (const std::uint32_t max_samples : {0u, 6u}) {
    const Picture reference = draw(particles, {.max_threads = 1, .max_samples = max_samples, .opacity = 0.05});
    EXPECT_NE(reference.color, opaque.color);
    EXPECT_EQ(reference.item, opaque.item);
    for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY}) {
      for (const double share : {0.0, 1.0}) {
        SCOPED_TRACE(share);
        EXPECT_EQ(draw(shuffled(particles, 6 + order), {8, order, max_samples, share, 0.05}), reference);
      }
    }
  }
}

// Small sets are a single leaf, or a few.
TEST_F(Invariance, OrderOfFewParticles) {
  const std::vector<Particle> all = make_particles(4);
  for (const std::size_t few : {2u, 31u, 33u, 70u, 300u}) {
    std::vector<Particle> particles;
    // Mostly twins.
    for (std::size_t i = 0; i < few; ++i) particles.push_back(i % 3 == 0 ? all[i] : all[29 * (i % 200)]);
    for (std::size_t i = 0; i < few; ++i) {
      particles[i].id = static_cast<std::uint32_t>(i);
      particles[i].heat[1] = static_cast<double>(i);
    }
    const Picture reference = draw(particles, {.max_threads = 1});
    for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY})
      for (std::uint64_t seed = 1; seed <= 10; ++seed)
        EXPECT_EQ(draw(shuffled(particles, seed), {2, order}), reference) << few << " particles, seed " << seed;
  }
}

// An order that the tree's own building has made before: permuting what is permuted changes nothing in the picture.
TEST_F(Invariance, PermutedAgainAndAgain) {
  std::vector<Particle> particles = make_particles(5);
  const Picture reference = draw(particles, {.max_threads = 1});
  const Context context(8);
  const Arrays arrays(particles);
  const insitu_geometry geometry = testing::make_particles(context, INSITU_ORDER_PERMUTE);
  const insitu_style style = by_heat();
  EXPECT_TRUE(works(context, insitu_geometry_set_style(context, geometry, &style)));
  const insitu_camera camera = front_camera();
  const insitu_view view = testing::make_view(context, &camera, 3);
  const insitu_image image = testing::make_image(context, 70, 50, 2);
  for (int step = 0; step < 3; ++step) {
    EXPECT_TRUE(works(context, run_step(context, geometry, arrays.desc, view, image)));
    const auto id = [&](std::uint64_t item) { return particles[item].id; };
    EXPECT_EQ(testing::read_picture(context, image).named(id), reference);
  }
}

// Two sets in one picture; `swapped`: they live the other way round in memory, and are updated the other way round.
Picture draw_two(const std::vector<Particle>& one, const std::vector<Particle>& two, bool swapped,
                 const Variant& variant) {
  const Context context(variant.max_threads);
  std::vector<Particle> memory = swapped ? two : one;
  memory.insert(memory.end(), swapped ? one.begin() : two.begin(), swapped ? one.end() : two.end());
  const Arrays first_arrays(memory.data() + (swapped ? two.size() : 0), one.size());
  const Arrays second_arrays(memory.data() + (swapped ? 0 : one.size()), two.size());
  const insitu_geometry geometries[2] = {testing::make_particles(context, variant.order),
                                         testing::make_particles(context, variant.order)};
  const insitu_style style = by_heat();
  EXPECT_TRUE(works(context, insitu_geometry_set_style(context, geometries[0], &style)));
  const insitu_camera camera = front_camera();
  const insitu_view view = testing::make_view(context, &camera, 3);
  const insitu_image image = testing::make_image(context, 70, 50, 2);
  insitu_step_begin(context, 0, 0.0);
  for (const int which : {swapped ? 1 : 0, swapped ? 0 : 1})
    insitu_particles_update(context, geometries[which], which == 0 ? &first_arrays.desc : &second_arrays.desc);
  insitu_commit(context);
  insitu_render(context, view, image);
  EXPECT_TRUE(works(context, insitu_step_end(context)));
  Picture picture = testing::read_picture(context, image);
  picture.item.clear();  // an item does not say of which set it is
  return picture;
}

TEST_F(Invariance, TwoSets) {
  const std::vector<Particle> all = make_particles(6);
  const std::vector<Particle> one(all.begin(), all.begin() + count / 2);
  // The second set shares points with the first one: there the one that was created first shows.
  const std::vector<Particle> two(all.begin() + count / 4, all.end());
  const Picture reference = draw_two(one, two, false, {.max_threads = 1});
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY}) {
    for (const std::uint32_t max_threads : {1u, 2u, 8u}) {
      SCOPED_TRACE(max_threads);
      EXPECT_EQ(draw_two(one, two, true, {max_threads, order}), reference);
      EXPECT_EQ(draw_two(shuffled(one, 7), shuffled(two, 8), false, {max_threads, order}), reference);
    }
  }
}

// One set cut into two shows what it showed before; only colours by an automatic range could differ, and there are
// none.
TEST_F(Invariance, OneSetInTwoParts) {
  std::vector<Particle> all = make_particles(7);
  const auto depth_of = [](const std::vector<std::vector<Particle>*>& sets) {
    const Context context;
    const insitu_camera camera = front_camera();
    const insitu_view view = testing::make_view(context, &camera, 0);
    const insitu_image image = testing::make_image(context, 70, 50, 1);
    std::vector<std::unique_ptr<Arrays>> arrays;
    insitu_step_begin(context, 0, 0.0);
    for (std::vector<Particle>* set : sets) {
      arrays.push_back(std::make_unique<Arrays>(*set));
      insitu_geometry geometry;
      insitu_particles_create(context, &arrays.back()->desc, &geometry);
    }
    insitu_commit(context);
    insitu_render(context, view, image);
    EXPECT_TRUE(works(context, insitu_step_end(context)));
    return testing::read_picture(context, image).depth;
  };
  std::vector<Particle> one(all.begin(), all.begin() + count / 3);
  std::vector<Particle> two(all.begin() + count / 3, all.end());
  const std::vector<float> whole = depth_of({&all});
  const std::vector<float> parts = depth_of({&one, &two});
  EXPECT_EQ(std::memcmp(whole.data(), parts.data(), whole.size() * sizeof(float)), 0);
}

}  // namespace
}  // namespace insitu
