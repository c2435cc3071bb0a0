// Opacity through the C API: what it may be asked of, and of copies of particles.
#include <gtest/gtest.h>

#include "glyph_scenes.h"

namespace insitu {
namespace {

using testing::clearly_differing;
using testing::Data;
using testing::draw;
using testing::fails;
using testing::Picture;
using testing::SplitMix64;
using testing::Studio;
using testing::unit_cell;
using testing::Wish;
using testing::works;

insitu_style uniform(double opacity) {
  insitu_style style;
  insitu_style_init(&style);
  style.opacity = opacity;
  return style;
}

TEST(Opacity, IsUnsupportedForBondsAndVectors) {
  Studio studio;
  insitu_bonds_desc bonds;
  insitu_bonds_desc_init(&bonds);
  bonds.particles = studio.geometry;
  bonds.cutoff = 0.1;
  bonds.flags = INSITU_BONDS_OWN_STYLE;
  insitu_vectors_desc vectors;
  insitu_vectors_desc_init(&vectors);
  vectors.particles = studio.geometry;
  vectors.attribute = "velocity";
  insitu_geometry glyphs[2];
  ASSERT_TRUE(works(studio.context, insitu_bonds_create(studio.context, &bonds, &glyphs[0])));
  ASSERT_TRUE(works(studio.context, insitu_vectors_create(studio.context, &vectors, &glyphs[1])));
  const double half[] = {0.2, 0.4, 0.6, 0.5};
  insitu_colormap_desc map;
  insitu_colormap_desc_init(&map);
  map.rgba = half;
  map.count = 1;
  insitu_style by_map = testing::make_style("velocity", 0.0, 1.0);
  ASSERT_TRUE(works(studio.context, insitu_colormap_create(studio.context, &map, &by_map.own_map)));
  insitu_style by_value = testing::make_style("velocity", 0.0, 1.0);
  by_value.opacity_map = half;
  by_value.opacity_map_count = 4;
  const insitu_style faint = uniform(0.5);
  const insitu_style* const see_through[] = {&by_map, &by_value, &faint};
  const insitu_style opaque = uniform(1.0);
  for (const insitu_geometry geometry : glyphs) {
    for (const insitu_style* style : see_through)
      EXPECT_TRUE(fails(studio.context, insitu_geometry_set_style(studio.context, geometry, style),
                        INSITU_ERROR_UNSUPPORTED, {"bonds and vectors", "opaque"}));
    EXPECT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, geometry, &opaque)));
  }
  for (const insitu_style* style : see_through)
    EXPECT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, style)));
}

TEST(Opacity, ByValueNeedsAContinuousMap) {
  Studio studio;
  const double half[] = {0.5};
  insitu_style style = testing::make_style("type", 0.0, 1.0);
  style.opacity_map = half;
  style.opacity_map_count = 1;
  style.colormap = "elements";
  EXPECT_TRUE(fails(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style),
                    INSITU_ERROR_INVALID_ARGUMENT, {"opacity_map", "continuous"}));
  style.colormap = "coolwarm";
  EXPECT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
}

// Bonds in the style of their set are as opaque as ever, whatever the balls around them are.
TEST(Opacity, OfASetLeavesItsBondsOpaque) {
  Data data(40);
  data.ball = 0.15;
  Wish wish;
  wish.cutoff = 0.3;
  wish.effects = INSITU_EFFECT_SHADOWS;
  wish.opacity = 1e-6;
  const Picture almost_bonds_alone = draw(data, wish);
  data.ball = 1e-9;
  wish.opacity = 0.0;
  EXPECT_LE(clearly_differing(almost_bonds_alone, draw(data, wish)), 8u);
}

// Copies of the cell, in turn and through Embree, against particles that are really there.
TEST(Opacity, OfReplicasIsThatOfCopies) {
  for (const bool many : {false, true}) {
    Data data(many ? 6 : 40);
    data.ball = 0.08;
    for (double& x : data.xyz) x = 0.1 + 0.2 * x;
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
    for (std::uint32_t k = 0; k < n[0] * n[1] * n[2]; ++k) {
      const double count[3] = {double(k % n[0]), double(k / n[0] % n[1]), double(k / n[0] / n[1])};
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
    wish.opacity = 0.1;
    const Picture expected = draw(copies, wish);
    wish.cell = &cell;
    const Picture shown = draw(data, wish);
    EXPECT_GT(expected.hits(), 300u);
    // An occlusion ray along a border may come out otherwise here and there.
    EXPECT_LE(clearly_differing(shown, expected), 12u) << many;
    EXPECT_EQ(shown.hits(), expected.hits());
    wish.threads = 3;
    EXPECT_EQ(draw(data, wish), shown);
    wish.opacity = 0.0;
    EXPECT_GT(clearly_differing(draw(data, wish), shown), 300u);
  }
}

TEST(Opacity, OfWrappedParticlesIsThatOfMovedOnes) {
  Data inside(150);
  inside.ball = 0.1;
  Data outside = inside;
  SplitMix64 random(9);
  for (std::size_t i = 0; i < 3 * inside.count(); ++i)
    if (i / 3 % 3 == 0) outside.xyz[i] += static_cast<double>(random.below(3)) - 1.0;
  const insitu_cell cell = unit_cell(INSITU_CELL_PERIODIC | INSITU_CELL_WRAP);
  Wish wish;
  wish.opacity = 0.15;
  const Picture expected = draw(inside, wish);
  wish.cell = &cell;
  const Picture shown = draw(outside, wish);
  EXPECT_LE(clearly_differing(shown, expected), 12u);
  EXPECT_EQ(shown.hits(), expected.hits());
  EXPECT_EQ(draw(outside.reordered(testing::shuffled_order(150, 3)), wish).color, shown.color);
  wish.cell = nullptr;
  EXPECT_GT(clearly_differing(draw(outside, wish), expected), 200u);
}

}  // namespace
}  // namespace insitu
