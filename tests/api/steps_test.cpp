// Ten thousand steps with sets that move, grow and shrink: memory stays flat, and the books add up.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Context;
using testing::works;

std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t pages = 0;
  std::uint64_t resident = 0;
  statm >> pages >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

constexpr std::size_t most = 500;

// A simulation whose arrays are allocated once; how much of them is in use changes from step to step.
struct Simulation {
  Simulation() : position(3 * most), velocity(3 * most), heat(most) {
    testing::SplitMix64 random(1);
    for (double& x : position) x = random.unit();
    for (double& v : velocity) v = 0.01 * (random.unit() - 0.5);
    for (float& h : heat) h = static_cast<float>(random.unit());
  }
  // Grows and shrinks through all sizes, and now and then to nothing.
  static std::size_t size(std::uint64_t step) {
    if (step % 97 == 0) return 0;
    const std::uint64_t phase = step * 7 % (2 * most);
    return static_cast<std::size_t>(phase < most ? phase : 2 * most - phase);
  }
  void move() {
    for (std::size_t i = 0; i < position.size(); ++i) {
      position[i] += velocity[i];
      if (position[i] < 0.0 || position[i] > 1.0) velocity[i] = -velocity[i];
    }
  }
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<float> heat;
};

struct Viewer {
  explicit Viewer(std::uint32_t order)
      : context(2), geometry(testing::make_particles(context, order)), flags(INSITU_ARRAY_PERMUTABLE) {
    view = testing::make_view(context, nullptr, 1);
    image = testing::make_image(context, 8, 8);
    const insitu_style style = testing::make_style("heat", 0.0, 1.0);
    EXPECT_TRUE(works(context, insitu_geometry_set_style(context, geometry, &style)));
  }

  insitu_status step(Simulation& simulation, std::uint64_t number) {
    const std::size_t n = Simulation::size(number);
    simulation.move();
    insitu_array position = insitu_array_records(INSITU_F64, 3, n == 0 ? nullptr : simulation.position.data(), n, 0);
    insitu_array velocity = insitu_array_records(INSITU_F64, 3, n == 0 ? nullptr : simulation.velocity.data(), n, 0);
    insitu_array heat = insitu_array_records(INSITU_F32, 1, n == 0 ? nullptr : simulation.heat.data(), n, 0);
    position.flags = velocity.flags = heat.flags = flags;
    const insitu_attribute attribute = {"heat", &heat};
    const insitu_array* payload[1] = {&velocity};
    insitu_particles_desc desc;
    insitu_particles_desc_init(&desc);
    desc.position = &position;
    desc.attributes = &attribute;
    desc.attribute_count = 1;
    desc.payload = payload;
    desc.payload_count = 1;
    desc.radius_default = 0.05;
    return run_step(context, geometry, desc, view, image, number);
  }

  Context context;
  insitu_geometry geometry;
  std::uint32_t flags;
  insitu_view view;
  insitu_image image;
};

void expect_flat(std::uint32_t order) {
  constexpr std::uint64_t steps = testing::sanitized ? 500 : 10000;
  Simulation simulation;
  Viewer viewer(order);
  std::uint64_t warm = 0;
  std::uint64_t peak = 0;
  for (std::uint64_t step = 0; step < steps; ++step) {
    ASSERT_TRUE(works(viewer.context, viewer.step(simulation, step))) << step;
    const insitu_stats stats = viewer.context.stats();
    const std::size_t n = Simulation::size(step);
    ASSERT_EQ(stats.step, step);
    ASSERT_EQ(stats.items, n);
    ASSERT_EQ(stats.items_skipped, 0u);
    ASSERT_EQ(stats.borrowed_bytes, n * (24 + 24 + 4));
    ASSERT_EQ(stats.copied_bytes, order == INSITU_ORDER_COPY ? n * 24 : 0);
    ASSERT_GE(stats.rays, 64u);
    ASSERT_LE(stats.owned_bytes, stats.peak_bytes);
    ASSERT_GE(stats.peak_bytes, peak);
    ASSERT_GE(stats.total_s, stats.build_s + stats.render_s);
    peak = stats.peak_bytes;
    if (step == steps / 5) warm = resident_bytes();
  }
  const std::uint64_t item_bytes = order == INSITU_ORDER_COPY ? 28 : order == INSITU_ORDER_INDEX ? 4 : 0;
  EXPECT_EQ(peak, 8 * 8 * 28 + most * item_bytes);
  if (!testing::sanitized) {
    EXPECT_LE(resident_bytes(), warm + (1u << 20)) << "from " << warm << " bytes";
  }
}

TEST(Steps, MemoryStaysFlatWithAnIndex) { expect_flat(INSITU_ORDER_INDEX); }
TEST(Steps, MemoryStaysFlatWithPermutation) { expect_flat(INSITU_ORDER_PERMUTE); }
TEST(Steps, MemoryStaysFlatWithCopies) { expect_flat(INSITU_ORDER_COPY); }

// Objects that come and go, pictures in files, and errors, for ever.
TEST(Steps, MemoryStaysFlatWithEverything) {
  constexpr std::uint64_t steps = testing::sanitized ? 50 : 1500;
  const testing::TemporaryFolder folder;
  const std::string picture = folder.file("picture.png");
  const std::string other_picture = folder.file("picture.exr");
  const std::string nowhere = folder.file("none/picture_{step}.png");
  const testing::Cloud one(100, 1);
  const testing::Cloud two(50, 2);
  const Context context(2);
  const insitu_geometry geometry = testing::make_particles(context);
  std::uint64_t warm = 0;
  for (std::uint64_t step = 0; step < steps; ++step) {
    const insitu_geometry guest = testing::make_particles(context);
    const insitu_view view = testing::make_view(context, nullptr, 1);
    const insitu_image image = testing::make_image(context, 8, 8);
    insitu_step_begin(context, step, 0.1 * static_cast<double>(step));
    insitu_particles_update(context, geometry, &one.desc);
    insitu_particles_update(context, guest, &two.desc);
    insitu_commit(context);
    insitu_render(context, view, image);
    insitu_image_write(context, image, step % 2 == 0 ? picture.c_str() : other_picture.c_str());
    const bool fails = step % 5 == 0;
    if (fails) insitu_image_write(context, image, nowhere.c_str());
    ASSERT_EQ(insitu_step_end(context), fails ? INSITU_ERROR_IO : INSITU_OK) << context.error();
    insitu_geometry_destroy(context, guest);
    insitu_view_destroy(context, view);
    insitu_image_destroy(context, image);
    ASSERT_EQ(context.stats().owned_bytes, 100u * 4);
    if (step == steps / 5) warm = resident_bytes();
  }
  if (!testing::sanitized) {
    EXPECT_LE(resident_bytes(), warm + (1u << 20)) << "from " << warm << " bytes";
  }
}

// Whole contexts that come and go. With one thread: TBB itself keeps memory of arenas that its workers have been in.
TEST(Steps, MemoryStaysFlatWithContexts) {
  constexpr int rounds = testing::sanitized ? 30 : 3000;
  std::uint64_t warm = 0;
  for (int round = 0; round < rounds; ++round) {
    const testing::Studio studio(INSITU_ORDER_INDEX, 1);
    const insitu_geometry second = testing::make_particles(studio.context);
    const testing::Cloud cloud(200);
    insitu_step_begin(studio.context, 0, 0.0);
    insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
    insitu_particles_update(studio.context, second, &cloud.desc);
    insitu_commit(studio.context);
    insitu_render(studio.context, studio.view, studio.image);
    ASSERT_TRUE(works(studio.context, insitu_step_end(studio.context)));
    if (round == rounds / 5) warm = resident_bytes();
  }
  if (!testing::sanitized) {
    EXPECT_LE(resident_bytes(), warm + (1u << 20)) << "from " << warm << " bytes";
  }
}

TEST(Steps, OneLineOfTheReportForEach) {
  constexpr std::uint64_t steps = testing::sanitized ? 100 : 1000;
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("report.jsonl");
  const std::string picture = folder.file("p_{step}.png");
  Simulation simulation;
  Viewer viewer(INSITU_ORDER_INDEX);
  insitu_context_set_report(viewer.context, path.c_str());
  for (std::uint64_t step = 0; step < steps; ++step) ASSERT_TRUE(works(viewer.context, viewer.step(simulation, step)));
  // One more with a picture and an error.
  insitu_step_begin(viewer.context, steps, 0.25);
  insitu_commit(viewer.context);
  insitu_render(viewer.context, viewer.view, viewer.image);
  EXPECT_TRUE(works(viewer.context, insitu_image_write(viewer.context, viewer.image, picture.c_str())));
  EXPECT_EQ(insitu_image_write(viewer.context, viewer.image, "a \"name\" of no use"), INSITU_ERROR_UNSUPPORTED);
  EXPECT_EQ(insitu_step_end(viewer.context), INSITU_ERROR_UNSUPPORTED);

  std::istringstream lines(testing::text_of(path));
  std::string line;
  std::uint64_t step = 0;
  for (; std::getline(lines, line); ++step) {
    const nlohmann::json entry = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(entry.is_object()) << line;
    ASSERT_EQ(entry["step"], step);
    ASSERT_GE(entry["seconds"]["total"].get<double>(), 0.0);
    if (step == steps) continue;
    const std::size_t n = Simulation::size(step);
    ASSERT_EQ(entry["status"], "ok");
    ASSERT_EQ(entry["time"], 0.5 * static_cast<double>(step));
    ASSERT_EQ(entry["items"]["total"], n);
    ASSERT_EQ(entry["items"]["skipped"], 0);
    ASSERT_EQ(entry["bytes"]["borrowed"], n * 52);
    ASSERT_TRUE(entry["images"].empty());
    ASSERT_EQ(entry["effects"][0]["name"], "camera");
    ASSERT_EQ(entry["effects"][0]["rays"], 64);
    ASSERT_FALSE(entry.contains("error"));
  }
  EXPECT_EQ(step, steps + 1);
  const nlohmann::json last = nlohmann::json::parse(
      testing::text_of(path).substr(testing::text_of(path).rfind('\n', testing::text_of(path).size() - 2) + 1));
  EXPECT_EQ(last["status"], "unsupported");
  EXPECT_NE(last["error"].get<std::string>().find("a \"name\" of no use"), std::string::npos);
  ASSERT_EQ(last["images"].size(), 1u);
  EXPECT_EQ(last["images"][0], folder.file("p_" + std::to_string(steps) + ".png"));
}

// How the tree of each step was made: anew, from the order of the step before, or without moving a particle.
TEST(Steps, TreesAreReusedAndRepaired) {
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY}) {
    testing::Studio studio(order);
    testing::Cloud cloud(5000);
    cloud.position.flags = order == INSITU_ORDER_PERMUTE ? std::uint32_t{INSITU_ARRAY_PERMUTABLE} : 0u;
    const auto step = [&](std::uint64_t number) {
      EXPECT_TRUE(works(studio.context, studio.step(cloud.desc, number)));
      return studio.context.stats();
    };
    insitu_stats stats = step(1);
    EXPECT_EQ(stats.trees_built, 1u);
    EXPECT_EQ(stats.trees_repaired + stats.trees_reused, 0u);
    EXPECT_GT(stats.items_moved, 2500u);
    stats = step(2);
    EXPECT_EQ(stats.trees_reused, 1u);
    EXPECT_EQ(stats.items_moved, 0u);
    for (std::size_t i = 0; i < cloud.xyz.size(); i += 7) cloud.xyz[i] += i % 2 == 0 ? 1e-3 : -1e-3;
    stats = step(3);
    EXPECT_EQ(stats.trees_repaired, 1u);
    EXPECT_EQ(stats.trees_built + stats.trees_reused, 0u);
    EXPECT_GT(stats.items_moved, 0u);
    EXPECT_LT(stats.items_moved, 2500u);
  }
}

// Counters of skipped particles, of rays by effect, and of bytes, in a step that has them all.
TEST(Steps, WhatTheCountersCount) {
  testing::Studio studio(INSITU_ORDER_COPY);
  testing::Cloud cloud(300);
  cloud.xyz[7] = 0.0 / 0.0;
  cloud.xyz[70] = 1.0 / 0.0;
  ASSERT_TRUE(works(studio.context, studio.step(cloud.desc, 11)));
  const insitu_stats stats = studio.context.stats();
  EXPECT_EQ(stats.step, 11u);
  EXPECT_EQ(stats.items, 300u);
  EXPECT_EQ(stats.items_skipped, 2u);
  EXPECT_EQ(stats.borrowed_bytes, 300u * 24);
  EXPECT_EQ(stats.copied_bytes, 298u * 24);
  EXPECT_EQ(stats.owned_bytes, 298u * 28 + 16 * 16 * 28);
  // One ray per pixel; two for ambient occlusion, and at most one for the shadow, per hit.
  const std::size_t hits = studio.picture().hits();
  EXPECT_GE(stats.rays, 256 + 2 * hits);
  EXPECT_LE(stats.rays, 256 + 3 * hits);
  EXPECT_GT(stats.build_s, 0.0);
  EXPECT_GT(stats.render_s, 0.0);
  EXPECT_EQ(stats.write_s, 0.0);
  EXPECT_EQ(stats.pixels, 256u);
  EXPECT_EQ(stats.samples, 256u);
  EXPECT_EQ(stats.pixels_over_error, 0u);
  // A new step starts from zero.
  insitu_step_begin(studio.context, 12, 0.0);
  EXPECT_EQ(studio.context.stats().items, 0u);
  EXPECT_EQ(studio.context.stats().rays, 0u);
  EXPECT_EQ(studio.context.stats().pixels, 0u);
  EXPECT_EQ(studio.context.stats().build_s, 0.0);
  EXPECT_EQ(studio.context.stats().peak_bytes, stats.peak_bytes);
  EXPECT_TRUE(works(studio.context, insitu_step_end(studio.context)));
}

// An adaptive image: how many samples there were, and how many pixels would have needed more.
TEST(Steps, CountersOfAdaptiveImages) {
  testing::Studio studio;
  const testing::Cloud cloud(300);
  studio.view = testing::make_view(studio.context, nullptr, 0);
  std::uint64_t over_error = 256;
  std::uint64_t samples = 0;
  for (const std::uint32_t most : {4u, 16u, 4096u}) {
    studio.image = testing::make_image(studio.context, 16, 16, 4, most);
    ASSERT_TRUE(works(studio.context, studio.step(cloud.desc)));
    const insitu_stats stats = studio.context.stats();
    EXPECT_EQ(stats.pixels, 256u);
    EXPECT_GT(stats.samples, samples);
    EXPECT_LE(stats.samples, 256u * most);
    EXPECT_EQ(stats.rays, stats.samples);
    EXPECT_LT(stats.pixels_over_error, over_error);
    over_error = stats.pixels_over_error;
    samples = stats.samples;
  }
  EXPECT_LT(samples, 256u * 4096u / 4);
  // Its tolerated error is 0.02 unless the caller says otherwise.
  insitu_image_desc desc;
  insitu_image_desc_init(&desc);
  desc.width = desc.height = 16;
  desc.samples_per_pixel = 4;
  desc.max_samples_per_pixel = 4096;
  for (const double error : {0.02, 0.06}) {
    desc.pixel_error = error;
    ASSERT_TRUE(works(studio.context, insitu_image_create(studio.context, &desc, &studio.image)));
    ASSERT_TRUE(works(studio.context, studio.step(cloud.desc)));
    if (error == 0.02) {
      EXPECT_EQ(studio.context.stats().samples, samples);
    } else {
      EXPECT_LT(studio.context.stats().samples, samples / 2);
    }
  }
}

}  // namespace
}  // namespace insitu
