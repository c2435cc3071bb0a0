// The cap on memory that the library owns: for the index, the copy, the kept permutation and frame buffers.
#include <gtest/gtest.h>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Cloud;
using testing::Context;
using testing::fails;
using testing::works;

constexpr std::size_t count = 10000;
constexpr std::uint64_t frame_bytes = 16 * 16 * (16 + 4 + 8);  // colour, depth and item of testing::make_image

struct Case {
  const char* name;
  std::uint32_t order;
  std::uint32_t flags;
  std::uint64_t bytes;  // for `count` particles in f64, besides the frame
  const char* word;     // in the text
};

const Case cases[] = {
    {"index", INSITU_ORDER_INDEX, 0, 4 * count, "index"},
    {"copy", INSITU_ORDER_COPY, 0, (4 + 24) * count, "copy"},
    {"kept permutation", INSITU_ORDER_PERMUTE, INSITU_PARTICLES_KEEP_PERMUTATION, 4 * count, "permutation"},
    {"permute", INSITU_ORDER_PERMUTE, 0, 0, ""},
};

insitu_particles_desc permutable(Cloud& cloud) {
  cloud.position.flags = INSITU_ARRAY_PERMUTABLE;
  return cloud.desc;
}

TEST(Budget, IsExact) {
  for (const Case& each : cases) {
    SCOPED_TRACE(each.name);
    Cloud cloud(count);
    const insitu_particles_desc desc = permutable(cloud);
    const Context context(0, frame_bytes + each.bytes);
    const insitu_geometry geometry = testing::make_particles(context, each.order, each.flags);
    const insitu_view view = testing::make_view(context);
    const insitu_image image = testing::make_image(context, 16, 16);
    EXPECT_EQ(context.stats().owned_bytes, frame_bytes);
    EXPECT_TRUE(works(context, run_step(context, geometry, desc, view, image)));
    EXPECT_EQ(context.stats().owned_bytes, frame_bytes + each.bytes);
    EXPECT_EQ(context.stats().peak_bytes, frame_bytes + each.bytes);
    EXPECT_EQ(context.stats().borrowed_bytes, 24 * count);
    EXPECT_EQ(context.stats().copied_bytes, each.order == INSITU_ORDER_COPY ? 24 * count : 0);
    EXPECT_TRUE(works(context, insitu_geometry_destroy(context, geometry)));
    EXPECT_EQ(context.stats().owned_bytes, frame_bytes);
    EXPECT_TRUE(works(context, insitu_image_destroy(context, image)));
    EXPECT_EQ(context.stats().owned_bytes, 0u);
  }
}

// Treelets take what they are granted, or less, and nothing fails for want of them.
TEST(Budget, TreeletsFitWhatIsThere) {
  constexpr std::uint64_t position_bytes = 24 * count;
  struct Room {
    double share;
    std::uint64_t left;  // for treelets; 0: no cap
    bool expected;
  };
  for (const Room& room : {Room{0.15, 0, true}, Room{0.15, 4096, true}, Room{0.15, 63, false}, Room{1e-6, 0, false},
                           Room{0.0, 0, false}, Room{1e300, 0, true}}) {
    SCOPED_TRACE(::testing::Message() << room.share << ", " << room.left);
    Cloud cloud(count);
    insitu_particles_desc desc = permutable(cloud);
    desc.treelet_share = room.share;
    const Context context(0, room.left == 0 ? 0 : frame_bytes + room.left);
    const insitu_geometry geometry = testing::make_particles(context, INSITU_ORDER_PERMUTE, 0);
    const insitu_view view = testing::make_view(context);
    const insitu_image image = testing::make_image(context, 16, 16);
    EXPECT_TRUE(works(context, run_step(context, geometry, desc, view, image)));
    const insitu_stats stats = context.stats();
    EXPECT_EQ(stats.treelets != 0, room.expected);
    EXPECT_EQ(stats.treelet_bytes != 0, room.expected);
    EXPECT_LE(static_cast<double>(stats.treelet_bytes), room.share * static_cast<double>(position_bytes));
    if (room.left != 0) {
      EXPECT_LE(stats.treelet_bytes, room.left);
    }
    EXPECT_EQ(stats.owned_bytes, frame_bytes + stats.treelet_bytes);
    EXPECT_GT(testing::read_picture(context, image).hits(), 0u);
  }
}

TEST(Budget, OneByteTooFew) {
  for (const Case& each : cases) {
    if (each.bytes == 0) continue;
    SCOPED_TRACE(each.name);
    Cloud cloud(count);
    const insitu_particles_desc desc = permutable(cloud);
    const std::vector<double> before = cloud.xyz;
    const Context context(0, frame_bytes + each.bytes - 1);
    const insitu_geometry geometry = testing::make_particles(context, each.order, each.flags);
    const insitu_view view = testing::make_view(context);
    const insitu_image image = testing::make_image(context, 16, 16);
    insitu_step_begin(context, 0, 0.0);
    EXPECT_TRUE(works(context, insitu_particles_update(context, geometry, &desc)));
    EXPECT_TRUE(fails(context, insitu_commit(context), INSITU_ERROR_OVER_BUDGET, {each.word, "max_extra_bytes"}));
    EXPECT_EQ(insitu_step_end(context), INSITU_ERROR_OVER_BUDGET);
    EXPECT_EQ(cloud.xyz, before) << "nothing has moved";
    EXPECT_LE(context.stats().peak_bytes, frame_bytes + each.bytes - 1);

    // Less fits.
    Cloud less(count / 2);
    EXPECT_TRUE(works(context, run_step(context, geometry, permutable(less), view, image)));
    EXPECT_GT(testing::read_picture(context, image).hits(), 0u);
    EXPECT_EQ(context.stats().owned_bytes, frame_bytes + each.bytes / 2);
  }
}

// The second of two sets does not fit: what the first one got goes back as usual.
TEST(Budget, TwoSets) {
  const Context context(0, frame_bytes + 6 * count);
  const insitu_geometry geometries[2] = {testing::make_particles(context), testing::make_particles(context)};
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 16, 16);
  const Cloud cloud(count);
  insitu_step_begin(context, 0, 0.0);
  for (const insitu_geometry geometry : geometries)
    EXPECT_TRUE(works(context, insitu_particles_update(context, geometry, &cloud.desc)));
  EXPECT_TRUE(fails(context, insitu_commit(context), INSITU_ERROR_OVER_BUDGET, {"index"}));
  EXPECT_EQ(insitu_step_end(context), INSITU_ERROR_OVER_BUDGET);
  EXPECT_TRUE(works(context, run_step(context, geometries[0], cloud.desc, view, image)));
  EXPECT_TRUE(works(context, insitu_geometry_destroy(context, geometries[0])));
  EXPECT_TRUE(works(context, run_step(context, geometries[1], cloud.desc, view, image)));
  EXPECT_LE(context.stats().peak_bytes, frame_bytes + 6 * count);
}

TEST(Budget, FrameBuffers) {
  const Context context(0, 100000);
  insitu_image_desc desc;
  insitu_image_desc_init(&desc);
  desc.width = 65536;
  desc.height = 65536;
  insitu_image image = {5};
  EXPECT_TRUE(fails(context, insitu_image_create(context, &desc, &image), INSITU_ERROR_OVER_BUDGET,
                    {"frame buffer", "100000"}));
  EXPECT_EQ(image.id, 0u);
  EXPECT_EQ(context.stats().owned_bytes, 0u);
  desc.width = desc.height = 79;  // 16 bytes of colour per pixel: 99856
  EXPECT_TRUE(works(context, insitu_image_create(context, &desc, &image)));
  EXPECT_EQ(context.stats().owned_bytes, 99856u);
  desc.width = desc.height = 4;
  EXPECT_TRUE(fails(context, insitu_image_create(context, &desc, &image), INSITU_ERROR_OVER_BUDGET, {"99856"}));
}

}  // namespace
}  // namespace insitu
