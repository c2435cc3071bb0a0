// Bonds, arrows and cells through the API: what may not show in a picture, and what has to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "api_test_tools.h"
#include "guarded_memory.h"

namespace insitu {
namespace {

using testing::Cloud;
using testing::Context;
using testing::fails;
using testing::Picture;
using testing::shuffled_order;
using testing::SplitMix64;
using testing::works;

template <class T>
constexpr std::uint32_t type_of() {
  if constexpr (std::is_same_v<T, std::int32_t>) return INSITU_I32;
  if constexpr (std::is_same_v<T, std::int64_t>) return INSITU_I64;
  if constexpr (std::is_same_v<T, std::uint32_t>) return INSITU_U32;
  return INSITU_U64;
}

template <class T>
insitu_array pairs_of(const std::vector<T>& pairs) {
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
};

insitu_camera camera_at(double x, double y, double z) {
  insitu_camera camera;
  insitu_camera_init(&camera);
  camera.eye[0] = x;
  camera.eye[1] = y;
  camera.eye[2] = z;
  for (double& c : camera.look_at) c = 0.5;
  return camera;
}

Picture draw(Data data, const Wish& wish, std::string* warnings = nullptr, const insitu_array* pairs = nullptr) {
  const Context context(wish.threads);
  if (warnings != nullptr) {
    const auto keep = [](void* user, std::int32_t, const char* text) { *static_cast<std::string*>(user) += text; };
    EXPECT_TRUE(works(context, insitu_context_set_log(context, keep, warnings, INSITU_LOG_WARNING)));
  }
  const insitu_camera camera = camera_at(1.3, 1.1, 2.6);
  const insitu_view view = testing::make_view(context, &camera);
  insitu_effects effects;
  insitu_effects_init(&effects);
  effects.flags = INSITU_EFFECT_SHADOWS | INSITU_EFFECT_AMBIENT_OCCLUSION;
  effects.ao_samples = 2;
  effects.ao_radius = 0.3;  // whatever the bounds of the scene
  EXPECT_TRUE(works(context, insitu_view_set_effects(context, view, &effects)));
  const insitu_image image = testing::make_image(context, 80, 64, 2);
  const insitu_geometry set = testing::make_particles(context, wish.order);
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
  const insitu_style style = testing::make_style("value", 0.0, 1.0);
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
  EXPECT_TRUE(works(context, insitu_commit(context)));
  EXPECT_TRUE(works(context, insitu_render(context, view, image)));
  Picture picture = testing::read_picture(context, image);
  EXPECT_TRUE(works(context, insitu_step_end(context)));
  return picture;
}

Picture without_items(Picture picture) {
  picture.item.clear();
  return picture;
}

insitu_cell unit_cell(std::uint32_t flags = INSITU_CELL_PERIODIC) {
  insitu_cell cell;
  insitu_cell_init(&cell);
  cell.flags = flags;
  for (int i = 0; i < 3; ++i) cell.vectors[i][i] = 1.0;
  return cell;
}

// Pixels whose colours differ by more than the last bits, which the shift of a ray may change.
std::size_t clearly_differing(const Picture& a, const Picture& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.color.size(); i += 4) {
    bool differs = false;
    for (std::size_t c = 0; c < 4; ++c) differs = differs || std::abs(a.color[i + c] - b.color[i + c]) > 1e-4f;
    count += differs ? 1 : 0;
  }
  return count;
}

TEST(Bonds, ByDistanceAreThoseOfEveryNearPair) {
  for (const bool periodic : {false, true}) {
    Data data(80);
    data.bond(0.21, periodic);
    ASSERT_GT(data.pairs.size(), 100u);
    const insitu_cell cell = unit_cell();
    Wish wish;
    wish.cell = periodic ? &cell : nullptr;
    wish.bond_flags = periodic ? INSITU_BONDS_PERIODIC : 0;
    const Picture none = draw(data, wish);
    wish.cutoff = 0.21;
    const Picture found = draw(data, wish);
    wish.cutoff = 0.0;
    wish.by_pairs = true;
    const Picture given = draw(data, wish);
    EXPECT_EQ(without_items(found), without_items(given));
    EXPECT_FALSE(found == none);
    EXPECT_GT(given.hits(), none.hits() + 100);
  }
}

TEST(Bonds, LookTheSameForAnyOrderAndAnyThreads) {
  Data data(120);
  // Some stand twice at one place, in two colours: their bonds are hit at exactly the same distance.
  for (std::size_t i = 0; i < 60; ++i) {
    data.value.push_back(1.0 - data.value[i]);
    for (std::size_t c = 0; c < 3; ++c) {
      data.xyz.push_back(data.xyz[3 * i + c]);
      data.vector.push_back(data.vector[3 * i + c]);
    }
  }
  data.ball = 0.02;  // their bonds are as thick: much of a bond can be seen
  data.bond(0.2, false);
  const insitu_cell cell = unit_cell(INSITU_CELL_PERIODIC | INSITU_CELL_OUTLINE);
  for (const bool by_pairs : {true, false}) {
    Wish wish;
    wish.by_pairs = by_pairs;
    wish.cutoff = by_pairs ? 0.0 : 0.2;
    wish.cell = &cell;
    wish.bond_flags = INSITU_BONDS_PERIODIC;
    const Picture expected = without_items(draw(data, wish));
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
      const Data other = data.reordered(shuffled_order(data.count(), seed));
      wish.threads = seed == 2 ? 4 : 1;
      wish.order = seed == 3 ? INSITU_ORDER_COPY : by_pairs ? INSITU_ORDER_INDEX : INSITU_ORDER_PERMUTE;
      EXPECT_EQ(without_items(draw(other, wish)), expected) << seed;
    }
    // The other way round it is the same bond.
    Data turned = data;
    for (std::size_t i = 0; i + 1 < turned.pairs.size(); i += 2) std::swap(turned.pairs[i], turned.pairs[i + 1]);
    EXPECT_EQ(without_items(draw(turned, wish)), expected);
  }
  Wish wish;
  wish.arrows = true;
  const Picture expected = without_items(draw(data, wish));
  EXPECT_GT(expected.color.size(), 0u);
  EXPECT_EQ(without_items(draw(data.reordered(shuffled_order(data.count(), 5)), wish)), expected);
}

TEST(Bonds, PairsOfAnyTypeAreReadInPlace) {
  Data data(60);
  data.bond(0.3, false);
  Wish wish;
  wish.by_pairs = true;
  const Picture expected = draw(data, wish);
  const std::vector<std::int64_t> i64(data.pairs.begin(), data.pairs.end());
  const std::vector<std::uint32_t> u32(data.pairs.begin(), data.pairs.end());
  const std::vector<std::uint64_t> u64(data.pairs.begin(), data.pairs.end());
  for (const insitu_array& array : {pairs_of(i64), pairs_of(u32), pairs_of(u64)})
    EXPECT_EQ(draw(data, wish, nullptr, &array), expected) << array.type;
  // Two columns, and records with other things between; each ends, then begins, at a page that must not be touched.
  const std::size_t count = data.pairs.size() / 2;
  const testing::GuardedMemory memory(12 * count);
  const testing::GuardedMemory second(4 * count);
  for (const bool at_end : {true, false}) {
    std::byte* records = memory.flush(12 * (count - 1) + 8, at_end);
    for (std::size_t i = 0; i < count; ++i) std::memcpy(records + 12 * i, &data.pairs[2 * i], 8);
    const insitu_array strided = insitu_array_records(INSITU_I32, 2, records, count, 12);
    EXPECT_EQ(draw(data, wish, nullptr, &strided), expected);
    std::byte* columns[2] = {memory.flush(4 * count, at_end), second.flush(4 * count, at_end)};
    for (std::size_t i = 0; i < 2 * count; ++i) std::memcpy(columns[i % 2] + i / 2 * 4, &data.pairs[i], 4);
    insitu_array soa = insitu_array_records(INSITU_I32, 2, columns[0], count, 4);
    soa.component[1] = columns[1];
    EXPECT_EQ(draw(data, wish, nullptr, &soa), expected);
  }
}

TEST(Bonds, BadPairsAreCountedAndLeftOut) {
  Data data(40);
  data.bond(0.3, false);
  const std::int32_t lost = data.pairs[0];
  data.xyz[3 * static_cast<std::size_t>(lost)] = std::numeric_limits<double>::quiet_NaN();
  Wish wish;
  wish.by_pairs = true;
  Data good = data;
  good.pairs.clear();
  std::size_t bad = 0;
  for (std::size_t i = 0; i < data.pairs.size(); i += 2) {
    const bool is_bad = data.pairs[i] == lost || data.pairs[i + 1] == lost;
    bad += is_bad ? 1 : 0;
    if (!is_bad) good.pairs.insert(good.pairs.end(), {data.pairs[i], data.pairs[i + 1]});
  }
  ASSERT_GT(bad, 0u);
  const Picture expected = without_items(draw(good, wish));
  constexpr std::int32_t huge = std::numeric_limits<std::int32_t>::max();
  data.pairs.insert(data.pairs.end(), {-1, 0, 40, 1, 5, 5, huge, -huge});
  std::string warnings;
  EXPECT_EQ(without_items(draw(data, wish, &warnings)), expected);
  const std::string text = std::to_string(bad + 4) + " of " + std::to_string(data.pairs.size() / 2) + " bonds";
  EXPECT_NE(warnings.find(text), std::string::npos) << warnings;
  data.pairs.clear();
  EXPECT_EQ(draw(data, wish), draw(data, Wish{}));  // none at all
}

TEST(Arrows, BadVectorsAreCountedAndLeftOut) {
  Data data(40);
  Wish wish;
  wish.arrows = true;
  std::string warnings;
  const Picture all = draw(data, wish, &warnings);
  EXPECT_EQ(warnings, "");
  for (std::size_t i = 0; i < 60; ++i) data.vector[i] = 0.0;
  data.vector[90] = std::numeric_limits<double>::infinity();
  const Picture fewer = draw(data, wish, &warnings);
  EXPECT_LT(fewer.hits(), all.hits());
  EXPECT_NE(warnings.find("1 of 40 arrows"), std::string::npos) << warnings;
}

// The same by copying: particles, bonds and all, moved by the cell's vectors.
TEST(Cells, ReplicasLookLikeCopies) {
  for (const bool many : {false, true}) {  // many: more than are traced in turn
    Data data(many ? 6 : 40);
    for (double& x : data.xyz) x = 0.1 + 0.2 * x;
    for (double& v : data.vector) v *= 0.3;
    data.bond(0.15, false);
    insitu_cell cell = unit_cell();
    const double edge = many ? 0.21 : 0.4;
    for (int i = 0; i < 3; ++i) cell.vectors[i][i] = edge;
    cell.vectors[1][0] = 0.1;
    const std::uint32_t n[3] = {many ? 5u : 3u, many ? 4u : 2u, many ? 4u : 1u};
    std::copy_n(n, 3, cell.replicate);
    Data copies = data;
    copies.xyz.clear();
    copies.value.clear();
    copies.vector.clear();
    copies.pairs.clear();
    for (std::uint32_t k = 0; k < n[0] * n[1] * n[2]; ++k) {
      const double count[3] = {double(k % n[0]), double(k / n[0] % n[1]), double(k / n[0] / n[1])};
      const auto first = static_cast<std::int32_t>(copies.count());
      for (const std::int32_t end : data.pairs) copies.pairs.push_back(first + end);
      for (std::size_t i = 0; i < data.count(); ++i) {
        copies.value.push_back(data.value[i]);
        for (std::size_t c = 0; c < 3; ++c) {
          copies.vector.push_back(data.vector[3 * i + c]);
          double x = data.xyz[3 * i + c];
          for (std::size_t v = 0; v < 3; ++v) x += count[v] * cell.vectors[v][c];
          copies.xyz.push_back(x);
        }
      }
    }
    Wish wish;
    wish.by_pairs = true;
    wish.arrows = true;
    const Picture expected = draw(copies, wish);
    wish.cell = &cell;
    const Picture shown = draw(data, wish);
    EXPECT_GT(expected.hits(), 300u);
    // Ambient occlusion excludes the item itself, so that a ray along a border may come out otherwise here and there.
    EXPECT_LE(clearly_differing(shown, expected), 8u) << many;
    EXPECT_NEAR(static_cast<double>(shown.hits()), static_cast<double>(expected.hits()), 3.0);
    for (const std::uint64_t item : shown.item)
      EXPECT_TRUE(item == ~std::uint64_t{0} || item < std::max(data.count(), data.pairs.size() / 2)) << item;
    EXPECT_EQ(draw(data, wish), shown);
    wish.threads = 3;
    EXPECT_EQ(draw(data, wish), shown);
  }
}

TEST(Cells, WrappedParticlesLookLikeMovedOnes) {
  for (const bool tilted : {false, true}) {
    Data inside(150);
    insitu_cell cell = unit_cell();
    if (tilted) {
      cell.vectors[1][0] = 0.25;
      cell.vectors[2][1] = -0.5;
    }
    Data outside = inside;
    SplitMix64 random(9);
    for (std::size_t i = 0; i < inside.count(); ++i) {
      const double fraction[3] = {inside.xyz[3 * i], inside.xyz[3 * i + 1], inside.xyz[3 * i + 2]};
      double away[3];
      for (double& a : away) a = static_cast<double>(random.below(3)) - 1.0;
      if (i % 4 != 0) std::fill(away, away + 3, 0.0);  // most have not left
      for (std::size_t c = 0; c < 3; ++c) {
        inside.xyz[3 * i + c] = outside.xyz[3 * i + c] = 0.0;
        for (std::size_t v = 0; v < 3; ++v) {
          inside.xyz[3 * i + c] += fraction[v] * cell.vectors[v][c];
          outside.xyz[3 * i + c] += (fraction[v] + away[v]) * cell.vectors[v][c];
        }
      }
    }
    for (const bool with_bonds : {false, true}) {
      Wish wish;
      wish.cell = &cell;
      if (with_bonds) wish.cutoff = 0.2;
      wish.bond_flags = INSITU_BONDS_PERIODIC;
      const Picture expected = draw(inside, wish);
      insitu_cell wrapping = cell;
      wrapping.flags |= INSITU_CELL_WRAP;
      wish.cell = &wrapping;
      const Picture shown = draw(outside, wish);
      EXPECT_LE(clearly_differing(shown, expected), 8u) << tilted << with_bonds;
      EXPECT_EQ(draw(inside, wish).hits(), expected.hits());
      EXPECT_EQ(draw(outside.reordered(shuffled_order(150, 3)), wish).color, shown.color);
      wish.cell = &cell;
      EXPECT_GT(clearly_differing(draw(outside, wish), expected), 200u);
    }
  }
}

TEST(Cells, OutlineAndBounds) {
  Data data(5);
  insitu_cell cell = unit_cell(INSITU_CELL_PERIODIC | INSITU_CELL_OUTLINE);
  cell.outline_radius = 0.02;
  Wish wish;
  wish.cell = &cell;
  const Picture shown = draw(data, wish);
  const Picture plain = draw(data, Wish{});
  EXPECT_LE(shown.hits(), plain.hits());  // edges are no item; they may hide some
  EXPECT_GT(shown.hits() + 10, plain.hits());
  std::size_t edges = 0;
  for (std::size_t i = 0; i < shown.depth.size(); ++i)
    edges += std::isfinite(shown.depth[i]) && !std::isfinite(plain.depth[i]) ? 1 : 0;
  EXPECT_GT(edges, 100u);

  testing::Studio studio;
  const Cloud cloud(50);
  cell.replicate[1] = 4;
  EXPECT_TRUE(works(studio.context, insitu_particles_set_cell(studio.context, studio.geometry, &cell)));
  insitu_bonds_desc bonds;
  insitu_bonds_desc_init(&bonds);
  bonds.particles = studio.geometry;
  bonds.cutoff = 0.3;
  bonds.radius = 0.01;
  insitu_geometry sticks = {0};
  EXPECT_TRUE(works(studio.context, insitu_bonds_create(studio.context, &bonds, &sticks)));
  insitu_step_begin(studio.context, 0, 0.0);
  insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
  EXPECT_TRUE(works(studio.context, insitu_commit(studio.context)));
  for (const insitu_geometry geometry : {studio.geometry, sticks}) {
    double lower[3];
    double upper[3];
    EXPECT_TRUE(works(studio.context, insitu_geometry_bounds(studio.context, geometry, lower, upper)));
    EXPECT_NEAR(upper[0], 1.0, 0.2);
    EXPECT_NEAR(upper[1], 4.0, 0.2);
    EXPECT_NEAR(lower[1], 0.0, 0.2);
  }
  EXPECT_TRUE(works(studio.context, insitu_step_end(studio.context)));
}

TEST(Glyphs, BadInputIsRefusedWithAReason) {
  testing::Studio studio;
  const insitu_context context = studio.context;
  const Cloud cloud(50);
  insitu_cell cell = unit_cell();
  const auto set_cell = [&] { return insitu_particles_set_cell(context, studio.geometry, &cell); };
  cell.vectors[2][2] = 0.0;
  EXPECT_TRUE(fails(context, set_cell(), INSITU_ERROR_INVALID_ARGUMENT, {"one plane"}));
  cell = unit_cell(32);
  EXPECT_TRUE(fails(context, set_cell(), INSITU_ERROR_INVALID_ARGUMENT, {"flags"}));
  cell = unit_cell(INSITU_CELL_WRAP);
  EXPECT_TRUE(fails(context, set_cell(), INSITU_ERROR_INVALID_ARGUMENT, {"WRAP", "periodic"}));
  cell = unit_cell();
  for (std::uint32_t& n : cell.replicate) n = 1000;
  EXPECT_TRUE(fails(context, set_cell(), INSITU_ERROR_INVALID_ARGUMENT, {"2^20"}));
  cell = unit_cell();
  cell.origin[1] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(fails(context, set_cell(), INSITU_ERROR_INVALID_ARGUMENT, {"origin"}));

  insitu_bonds_desc bonds;
  insitu_bonds_desc_init(&bonds);
  insitu_geometry out = {7};
  EXPECT_TRUE(fails(context, insitu_bonds_create(context, &bonds, &out), INSITU_ERROR_INVALID_HANDLE, {"0"}));
  EXPECT_EQ(out.id, 0u);
  bonds.particles = studio.geometry;
  bonds.cutoff = -1.0;
  EXPECT_TRUE(fails(context, insitu_bonds_create(context, &bonds, &out), INSITU_ERROR_INVALID_ARGUMENT, {"cutoff"}));
  bonds.cutoff = 1.0;
  const std::vector<std::int32_t> some = {0, 1};
  insitu_array pairs = pairs_of(some);
  bonds.pairs = &pairs;
  EXPECT_TRUE(fails(context, insitu_bonds_create(context, &bonds, &out), INSITU_ERROR_INVALID_ARGUMENT, {"only one"}));
  bonds.cutoff = 0.0;
  EXPECT_TRUE(fails(context, insitu_bonds_create(context, &bonds, &out), INSITU_ERROR_WRONG_STATE, {"step"}));
  pairs.components = 3;
  EXPECT_TRUE(
      fails(context, insitu_bonds_create(context, &bonds, &out), INSITU_ERROR_INVALID_ARGUMENT, {"pairs", "2"}));
  pairs.components = 2;
  pairs.type = INSITU_F32;
  EXPECT_TRUE(fails(context, insitu_bonds_create(context, &bonds, &out), INSITU_ERROR_UNSUPPORTED, {"pairs", "f32"}));

  insitu_vectors_desc vectors;
  insitu_vectors_desc_init(&vectors);
  vectors.particles = studio.geometry;
  EXPECT_TRUE(
      fails(context, insitu_vectors_create(context, &vectors, &out), INSITU_ERROR_INVALID_ARGUMENT, {"attribute"}));
  vectors.attribute = "spin";
  EXPECT_TRUE(works(context, insitu_vectors_create(context, &vectors, &out)));
  EXPECT_TRUE(fails(context, insitu_particles_update(context, out, &cloud.desc), INSITU_ERROR_INVALID_HANDLE, {"set"}));
  EXPECT_TRUE(fails(context, insitu_bonds_update(context, out, &bonds), INSITU_ERROR_UNSUPPORTED, {"pairs"}) ||
              fails(context, insitu_bonds_update(context, out, &bonds), INSITU_ERROR_INVALID_HANDLE, {"bonds"}));
  insitu_step_begin(context, 0, 0.0);
  insitu_particles_update(context, studio.geometry, &cloud.desc);
  EXPECT_TRUE(fails(context, insitu_commit(context), INSITU_ERROR_INVALID_ARGUMENT, {"spin"}));
  EXPECT_EQ(insitu_step_end(context), INSITU_ERROR_INVALID_ARGUMENT);
  EXPECT_TRUE(works(context, insitu_geometry_destroy(context, out)));

  // Bonds longer than many cells, across their borders.
  cell = unit_cell();
  EXPECT_TRUE(works(context, set_cell()));
  insitu_bonds_desc_init(&bonds);
  bonds.particles = studio.geometry;
  bonds.cutoff = 20.0;
  bonds.flags = INSITU_BONDS_PERIODIC;
  EXPECT_TRUE(works(context, insitu_bonds_create(context, &bonds, &out)));
  insitu_step_begin(context, 0, 0.0);
  insitu_particles_update(context, studio.geometry, &cloud.desc);
  EXPECT_TRUE(fails(context, insitu_commit(context), INSITU_ERROR_INVALID_ARGUMENT, {"ten cells"}));
  insitu_step_end(context);
  // Sets take what stands on them along.
  EXPECT_TRUE(works(context, insitu_geometry_destroy(context, studio.geometry)));
  EXPECT_TRUE(fails(context, insitu_geometry_destroy(context, out), INSITU_ERROR_INVALID_HANDLE, {"destroyed"}));
}

TEST(Glyphs, PairsOfAPermutedSetAreRefused) {
  testing::Studio studio(INSITU_ORDER_PERMUTE);
  Cloud cloud(50);
  cloud.position.flags |= INSITU_ARRAY_PERMUTABLE;
  const std::vector<std::int32_t> some = {0, 1};
  const insitu_array pairs = pairs_of(some);
  insitu_bonds_desc bonds;
  insitu_bonds_desc_init(&bonds);
  bonds.particles = studio.geometry;
  bonds.pairs = &pairs;
  insitu_geometry out = {0};
  const std::vector<double> before = cloud.xyz;
  insitu_step_begin(studio.context, 0, 0.0);
  insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
  EXPECT_TRUE(works(studio.context, insitu_bonds_create(studio.context, &bonds, &out)));
  EXPECT_TRUE(fails(studio.context, insitu_commit(studio.context), INSITU_ERROR_UNSUPPORTED, {"PERMUTE", "pairs"}));
  EXPECT_EQ(cloud.xyz, before);
  insitu_step_end(studio.context);
}

// With a checksum of every borrowed array, a change of the pairs within the step is seen.
TEST(Glyphs, ChangedPairsAreSeen) {
  for (const bool change : {false, true}) {
    const Context context(0, 0, 0, INSITU_CHECK_CHECKSUM);
    const insitu_geometry set = testing::make_particles(context);
    const Cloud cloud(20);
    std::vector<std::int32_t> some = {0, 1, 2, 3};
    const insitu_array pairs = pairs_of(some);
    insitu_bonds_desc bonds;
    insitu_bonds_desc_init(&bonds);
    bonds.particles = set;
    bonds.pairs = &pairs;
    insitu_geometry sticks = {0};
    for (int step = 0; step < 2; ++step) {  // created, then updated
      some[3] = 3;
      insitu_step_begin(context, static_cast<std::uint64_t>(step), 0.0);
      insitu_particles_update(context, set, &cloud.desc);
      EXPECT_TRUE(works(context, step == 0 ? insitu_bonds_create(context, &bonds, &sticks)
                                           : insitu_bonds_update(context, sticks, &bonds)));
      EXPECT_TRUE(works(context, insitu_commit(context)));
      if (change) some[3] = 4;
      const insitu_status status = insitu_step_end(context);
      if (change) {
        EXPECT_TRUE(fails(context, status, INSITU_ERROR_WRONG_STATE, {"bonds", "changed"}));
      } else {
        EXPECT_TRUE(works(context, status));
      }
    }
  }
}

// What a commit finds as the one before left it costs and warns nothing again; a new cell counts at the next one.
TEST(Glyphs, FurtherCommitsBuildWhatChanged) {
  testing::Studio studio;
  const insitu_context context = studio.context;
  std::string warnings;
  const auto keep = [](void* user, std::int32_t, const char* text) { *static_cast<std::string*>(user) += text; };
  EXPECT_TRUE(works(context, insitu_context_set_log(context, keep, &warnings, INSITU_LOG_WARNING)));
  const Cloud cloud(50);
  const std::vector<std::int32_t> some = {0, 1, 2, -1};
  const insitu_array pairs = pairs_of(some);
  insitu_bonds_desc bonds;
  insitu_bonds_desc_init(&bonds);
  bonds.particles = studio.geometry;
  bonds.pairs = &pairs;
  insitu_geometry sticks = {0};
  insitu_step_begin(context, 0, 0.0);
  insitu_particles_update(context, studio.geometry, &cloud.desc);
  EXPECT_TRUE(works(context, insitu_bonds_create(context, &bonds, &sticks)));
  EXPECT_TRUE(works(context, insitu_commit(context)));
  EXPECT_NE(warnings, "");
  warnings.clear();
  const std::uint64_t borrowed = studio.context.stats().borrowed_bytes;
  EXPECT_TRUE(works(context, insitu_commit(context)));
  EXPECT_EQ(warnings, "");
  EXPECT_EQ(studio.context.stats().borrowed_bytes, borrowed);
  insitu_cell cell = unit_cell();
  cell.replicate[0] = 3;
  double lower[3];
  double upper[3];
  EXPECT_TRUE(works(context, insitu_particles_set_cell(context, studio.geometry, &cell)));
  EXPECT_TRUE(works(context, insitu_geometry_bounds(context, sticks, lower, upper)));
  EXPECT_LT(upper[0], 1.5);
  EXPECT_TRUE(works(context, insitu_commit(context)));
  EXPECT_TRUE(works(context, insitu_geometry_bounds(context, sticks, lower, upper)));
  EXPECT_GT(upper[0], 2.0);
  EXPECT_TRUE(works(context, insitu_render(context, studio.view, studio.image)));
  EXPECT_TRUE(works(context, insitu_step_end(context)));
}

// Steps in which the set, or the pairs, are missing; a cap on memory; nothing is kept.
TEST(Glyphs, StepsComeAndGo) {
  testing::Studio studio;
  const insitu_context context = studio.context;
  const Cloud cloud(200);
  insitu_bonds_desc bonds;
  insitu_bonds_desc_init(&bonds);
  bonds.particles = studio.geometry;
  bonds.cutoff = 0.3;
  insitu_geometry sticks = {0};
  EXPECT_TRUE(works(context, insitu_bonds_create(context, &bonds, &sticks)));
  EXPECT_TRUE(works(context, studio.step(cloud.desc, 0)));
  const Picture by_distance = studio.picture();
  insitu_step_begin(context, 1, 0.0);  // without the set there are no bonds either
  EXPECT_TRUE(works(context, insitu_commit(context)));
  EXPECT_TRUE(works(context, insitu_render(context, studio.view, studio.image)));
  EXPECT_TRUE(works(context, insitu_step_end(context)));
  EXPECT_EQ(studio.picture().hits(), 0u);
  EXPECT_TRUE(works(context, studio.step(cloud.desc, 2)));
  EXPECT_EQ(studio.picture(), by_distance);

  std::vector<std::int64_t> some(100);
  for (std::size_t i = 0; i < some.size(); ++i) some[i] = static_cast<std::int64_t>(i);
  const insitu_array pairs = pairs_of(some);
  bonds.cutoff = 0.0;
  bonds.radius = 0.05;
  bonds.pairs = &pairs;
  insitu_step_begin(context, 3, 0.0);
  insitu_particles_update(context, studio.geometry, &cloud.desc);
  EXPECT_TRUE(works(context, insitu_bonds_update(context, sticks, &bonds)));
  EXPECT_TRUE(works(context, insitu_commit(context)));
  EXPECT_TRUE(works(context, insitu_render(context, studio.view, studio.image)));
  EXPECT_EQ(studio.context.stats().borrowed_bytes, 200u * 24u + 800u);
  EXPECT_TRUE(works(context, insitu_step_end(context)));
  const Picture by_pairs = studio.picture();
  EXPECT_FALSE(by_pairs == by_distance);
  std::fill(some.begin(), some.end(), -1);  // no longer the library's
  EXPECT_TRUE(works(context, studio.step(cloud.desc, 4)));
  EXPECT_FALSE(studio.picture() == by_pairs);

  testing::Studio poor(INSITU_ORDER_INDEX, 0, 60000);
  bonds.pairs = nullptr;
  bonds.particles = poor.geometry;
  bonds.cutoff = 0.9;
  EXPECT_TRUE(works(poor.context, insitu_bonds_create(poor.context, &bonds, &sticks)));
  EXPECT_TRUE(fails(poor.context, poor.step(cloud.desc), INSITU_ERROR_OVER_BUDGET, {"bonds"}));
  EXPECT_TRUE(works(poor.context, insitu_geometry_destroy(poor.context, sticks)));
  EXPECT_TRUE(works(poor.context, poor.step(cloud.desc)));
}

}  // namespace
}  // namespace insitu
