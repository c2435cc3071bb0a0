// Bonds, arrows and cells: bad input, changes within a step and from step to step.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "glyph_scenes.h"

namespace insitu {
namespace {

using testing::Cloud;
using testing::Context;
using testing::fails;
using testing::pairs_of;
using testing::Picture;
using testing::unit_cell;
using testing::works;

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
