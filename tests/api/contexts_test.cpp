// Contexts side by side, each in a thread of the host's: the same pictures as alone.
#include <gtest/gtest.h>

#include <thread>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Cloud;
using testing::Picture;
using testing::works;

// A short run of a simulation of its own; the picture of its last step.
Picture run(std::uint64_t seed, std::uint32_t order, const std::string& folder) {
  const testing::Context context(2);
  const insitu_geometry geometries[2] = {testing::make_particles(context, order),
                                         testing::make_particles(context, INSITU_ORDER_INDEX)};
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 24, 24);
  const std::string report = folder + "/report.jsonl";
  const std::string picture = folder + "/" + std::to_string(seed) + "_{step}.png";
  insitu_context_set_report(context, report.c_str());
  constexpr std::uint64_t steps = testing::sanitized ? 3 : 10;
  for (std::uint64_t step = 0; step < steps; ++step) {
    Cloud one(400 + 100 * step, seed + step);
    Cloud two(100, seed);
    one.position.flags = INSITU_ARRAY_PERMUTABLE;
    insitu_step_begin(context, step, 0.0);
    insitu_particles_update(context, geometries[0], &one.desc);
    if (step % 2 == 0) insitu_particles_update(context, geometries[1], &two.desc);
    insitu_commit(context);
    insitu_render(context, view, image);
    insitu_image_write(context, image, picture.c_str());
    EXPECT_TRUE(works(context, insitu_step_end(context)));
    // Errors and their texts belong to one context.
    EXPECT_EQ(insitu_particles_update(context, {0}, &one.desc), INSITU_ERROR_INVALID_HANDLE);
    EXPECT_NE(context.error().find("geometry"), std::string::npos);
  }
  return testing::read_picture(context, image);
}

TEST(Contexts, SideBySide) {
  constexpr std::size_t count = 4;
  constexpr std::uint32_t orders[count] = {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY,
                                           INSITU_ORDER_INDEX};
  const testing::TemporaryFolder folder;
  Picture alone[count];
  for (std::size_t i = 0; i < count; ++i) alone[i] = run(100 * i, orders[i], folder.path());
  EXPECT_FALSE(alone[0] == alone[3]);
  for (int round = 0; round < 3; ++round) {
    Picture together[count];
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < count; ++i)
      threads.emplace_back([&, i] { together[i] = run(100 * i, orders[i], folder.path()); });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(together[i], alone[i]) << "context " << i;
  }
}

// A context may go from thread to thread, as long as one has it at a time.
TEST(Contexts, HandedOn) {
  const Picture expected = [] {
    testing::Studio studio;
    const Cloud cloud(300);
    EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
    return studio.picture();
  }();
  std::unique_ptr<testing::Studio> studio;
  const Cloud cloud(300);
  std::thread([&] { studio = std::make_unique<testing::Studio>(); }).join();
  std::thread([&] {
    insitu_step_begin(studio->context, 0, 0.0);
    insitu_particles_update(studio->context, studio->geometry, &cloud.desc);
  }).join();
  std::thread([&] { EXPECT_TRUE(works(studio->context, insitu_commit(studio->context))); }).join();
  std::thread([&] {
    EXPECT_TRUE(works(studio->context, insitu_render(studio->context, studio->view, studio->image)));
  }).join();
  std::thread([&] { EXPECT_TRUE(works(studio->context, insitu_step_end(studio->context))); }).join();
  EXPECT_EQ(studio->picture(), expected);
  std::thread([&] { studio.reset(); }).join();
}

// Creation and its errors, in many threads at once: the text is that of the thread.
TEST(Contexts, CreatedEverywhere) {
  std::vector<std::thread> threads;
  for (std::uint32_t i = 0; i < 8; ++i) {
    threads.emplace_back([i] {
      for (int round = 0; round < 20; ++round) {
        insitu_context_desc desc;
        insitu_context_desc_init(&desc);
        insitu_context context = nullptr;
        desc.abi = 1000 + i;
        EXPECT_EQ(insitu_context_create(&desc, &context), INSITU_ERROR_ABI);
        EXPECT_NE(std::string(insitu_error_text(nullptr)).find(std::to_string(1000 + i)), std::string::npos);
        desc.abi = INSITU_ABI;
        EXPECT_EQ(insitu_context_create(&desc, &context), INSITU_OK);
        testing::make_particles(context);
        insitu_context_destroy(context);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace insitu
