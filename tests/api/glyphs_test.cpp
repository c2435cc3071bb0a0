// Bonds, arrows and cells: what may not show in a picture, and what has to.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "glyph_scenes.h"
#include "guarded_memory.h"

namespace insitu {
namespace {

using testing::clearly_differing;
using testing::Cloud;
using testing::Data;
using testing::draw;
using testing::pairs_of;
using testing::Picture;
using testing::shuffled_order;
using testing::SplitMix64;
using testing::unit_cell;
using testing::Wish;
using testing::without_items;
using testing::works;

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

}  // namespace
}  // namespace insitu
