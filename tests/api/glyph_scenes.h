// Scenes of bonds, arrows and cells, and pictures of them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "api_test_tools.h"
#include "filter_terms.h"

namespace insitu::testing {

template <class T>
constexpr std::uint32_t type_of() {
  if constexpr (std::is_same_v<T, std::int32_t>) return INSITU_I32;
  if constexpr (std::is_same_v<T, std::int64_t>) return INSITU_I64;
  if constexpr (std::is_same_v<T, std::uint32_t>) return INSITU_U32;
  return INSITU_U64;
}

template <class T>
inline insitu_array pairs_of(const std::vector<T>& pairs) {
  return insitu_array_records(type_of<T>(), 2, pairs.data(), pairs.size() / 2, 0);
}

// Particles with a value to colour by, and everything that can stand on them.
struct Data {
  std::vector<double> xyz;
  std::vector<double> value;
  std::vector<double> vector;
  std::vector<std::int32_t> pairs;
  double ball = 0.04;

  explicit Data(std::size_t count, std::uint64_t seed = 1) {
    SplitMix64 random(seed);
    for (std::size_t i = 0; i < count; ++i) {
      for (int c = 0; c < 3; ++c) xyz.push_back(random.unit());
      for (int c = 0; c < 3; ++c) vector.push_back(random.unit() - 0.5);
      value.push_back(random.unit());
    }
  }
  std::size_t count() const { return value.size(); }

  // Every pair nearer than that, within the unit cell or across its borders.
  void bond(double cutoff, bool periodic) {
    pairs.clear();
    for (std::size_t i = 0; i < count(); ++i) {
      for (std::size_t j = i + 1; j < count(); ++j) {
        double square = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
          double d = xyz[3 * j + c] - xyz[3 * i + c];
          if (periodic) d -= std::round(d);
          square += d * d;
        }
        if (square < cutoff * cutoff) pairs.insert(pairs.end(), {std::int32_t(i), std::int32_t(j)});
      }
    }
  }

  Data reordered(const std::vector<std::size_t>& order) const {
    Data other = *this;
    std::vector<std::int32_t> place(count());
    for (std::size_t i = 0; i < count(); ++i) {
      place[order[i]] = static_cast<std::int32_t>(i);
      other.value[i] = value[order[i]];
      for (std::size_t c = 0; c < 3; ++c) {
        other.xyz[3 * i + c] = xyz[3 * order[i] + c];
        other.vector[3 * i + c] = vector[3 * order[i] + c];
      }
    }
    for (std::int32_t& end : other.pairs) end = place[static_cast<std::size_t>(end)];
    return other;
  }
};

struct Wish {
  bool by_pairs = false;
  double cutoff = 0.0;
  std::uint32_t bond_flags = 0;
  bool arrows = false;
  const insitu_cell* cell = nullptr;
  std::uint32_t threads = 1;
  std::uint32_t order = INSITU_ORDER_INDEX;
  std::vector<insitu_filter_term> filter;
  bool filter_late = false;  // set after a first commit without it
  double opacity = 0.0;
  std::uint32_t effects = INSITU_EFFECT_SHADOWS | INSITU_EFFECT_AMBIENT_OCCLUSION;
};

inline insitu_camera camera_at(double x, double y, double z) {
  insitu_camera camera;
  insitu_camera_init(&camera);
  camera.eye[0] = x;
  camera.eye[1] = y;
  camera.eye[2] = z;
  for (double& c : camera.look_at) c = 0.5;
  return camera;
}

inline Picture draw(Data data, const Wish& wish, std::string* warnings = nullptr, const insitu_array* pairs = nullptr) {
  const Context context(wish.threads);
  if (warnings != nullptr) {
    const auto keep = [](void* user, std::int32_t, const char* text) { *static_cast<std::string*>(user) += text; };
    EXPECT_TRUE(works(context, insitu_context_set_log(context, keep, warnings, INSITU_LOG_WARNING)));
  }
  const insitu_camera camera = camera_at(1.3, 1.1, 2.6);
  const insitu_view view = make_view(context, &camera);
  insitu_effects effects;
  insitu_effects_init(&effects);
  effects.flags = wish.effects;
  effects.ao_samples = 2;
  effects.ao_radius = 0.3;  // whatever the bounds of the scene
  EXPECT_TRUE(works(context, insitu_view_set_effects(context, view, &effects)));
  const insitu_image image = make_image(context, 80, 64, 2);
  const insitu_geometry set = make_particles(context, wish.order);
  insitu_array position = insitu_array_records(INSITU_F64, 3, data.xyz.data(), data.count(), 0);
  insitu_array value = insitu_array_records(INSITU_F64, 1, data.value.data(), data.count(), 0);
  insitu_array vector = insitu_array_records(INSITU_F64, 3, data.vector.data(), data.count(), 0);
  for (insitu_array* array : {&position, &value, &vector}) array->flags = INSITU_ARRAY_PERMUTABLE;
  const insitu_attribute attributes[] = {{"value", &value}, {"vector", &vector}};
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.position = &position;
  desc.radius_default = data.ball;
  desc.attributes = attributes;
  desc.attribute_count = 2;
  insitu_style style = make_style("value", 0.0, 1.0);
  style.opacity = wish.opacity;
  EXPECT_TRUE(works(context, insitu_geometry_set_style(context, set, &style)));
  EXPECT_TRUE(works(context, insitu_particles_set_cell(context, set, wish.cell)));
  insitu_geometry glyphs = {0};
  if (wish.arrows) {
    insitu_vectors_desc vectors;
    insitu_vectors_desc_init(&vectors);
    vectors.particles = set;
    vectors.attribute = "vector";
    vectors.scale = 0.2;
    vectors.radius = 0.012;
    EXPECT_TRUE(works(context, insitu_vectors_create(context, &vectors, &glyphs)));
  }
  EXPECT_TRUE(works(context, insitu_step_begin(context, 0, 0.0)));
  EXPECT_TRUE(works(context, insitu_particles_update(context, set, &desc)));
  if (wish.by_pairs || wish.cutoff > 0.0) {
    const insitu_array own = pairs_of(data.pairs);
    insitu_bonds_desc bonds;
    insitu_bonds_desc_init(&bonds);
    bonds.flags = wish.bond_flags;
    bonds.particles = set;
    bonds.pairs = !wish.by_pairs ? nullptr : pairs != nullptr ? pairs : &own;
    bonds.cutoff = wish.cutoff;
    bonds.radius = 0.018;
    EXPECT_TRUE(works(context, insitu_bonds_create(context, &bonds, &glyphs)));
  }
  if (!wish.filter.empty()) {
    if (wish.filter_late) {
      EXPECT_TRUE(works(context, insitu_commit(context)));
    }
    EXPECT_TRUE(works(context, set_filter(context, set, wish.filter)));
  }
  EXPECT_TRUE(works(context, insitu_commit(context)));
  EXPECT_TRUE(works(context, insitu_render(context, view, image)));
  Picture picture = read_picture(context, image);
  EXPECT_TRUE(works(context, insitu_step_end(context)));
  return picture;
}

inline Picture without_items(Picture picture) {
  picture.item.clear();
  return picture;
}

inline insitu_cell unit_cell(std::uint32_t flags = INSITU_CELL_PERIODIC) {
  insitu_cell cell;
  insitu_cell_init(&cell);
  cell.flags = flags;
  for (int i = 0; i < 3; ++i) cell.vectors[i][i] = 1.0;
  return cell;
}

// Pixels whose colours differ by more than the last bits, which the shift of a ray may change.
inline std::size_t clearly_differing(const Picture& a, const Picture& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.color.size(); i += 4) {
    bool differs = false;
    for (std::size_t c = 0; c < 4; ++c) differs = differs || std::abs(a.color[i + c] - b.color[i + c]) > 1e-4f;
    count += differs ? 1 : 0;
  }
  return count;
}

}  // namespace insitu::testing
