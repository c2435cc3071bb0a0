// Drawing a simulation does nothing to it, and the picture does not depend on how it was drawn.
#include "picture.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "states.h"
#include "temporary_folder.h"

namespace cosmo {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t steps = 12;

SimulationDesc run_desc() {
  SimulationDesc desc;
  desc.particles = 16;
  desc.side = 16.0;
  desc.steps = steps;
  return desc;
}

PictureDesc picture_desc(const std::string& folder, std::uint32_t order) {
  PictureDesc desc;
  desc.folder = folder;
  desc.width = 64;
  desc.height = 48;
  desc.order = order;
  desc.threads = 2;
  desc.side = 16.0;
  desc.spacing = 1.0;
  desc.slab = 4.0;
  return desc;
}

// The pixels of a PNG file as they are packed in it; what stands before them, such as render times, left out.
std::string pixels(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string all(std::istreambuf_iterator<char>(file), {});
  EXPECT_EQ(all.substr(0, 8), "\x89PNG\r\n\x1a\n") << path;
  const std::size_t data = all.find("IDAT");
  return data == std::string::npos ? "" : all.substr(data);
}

// Runs, draws every fourth step, and leaves the particles by id.
Particles drawn(const PictureDesc& desc, Picture::Cost* cost = nullptr, std::size_t* moved = nullptr) {
  Simulation simulation(run_desc());
  Picture picture(desc);
  while (!simulation.done()) {
    simulation.step();
    if (simulation.steps() % 4 != 0) continue;
    if (desc.color_by == ColorBy::density) {
      simulation.color_by_density();
    } else {
      simulation.color_by_speed();
    }
    const Particles before = simulation.particles();
    EXPECT_TRUE(picture.draw(simulation.steps(), simulation.a(), simulation.particles())) << picture.error();
    const Particles& after = simulation.particles();
    EXPECT_TRUE(same_particles(before, after));
    EXPECT_TRUE(same_bytes(by_id(before).color, by_id(after).color));
    if (moved == nullptr) continue;
    *moved = 0;
    for (std::size_t i = 0; i < after.size(); ++i) *moved += before.id[i] != after.id[i];
  }
  if (cost != nullptr) *cost = picture.cost();
  return by_id(simulation.particles());
}

TEST(CosmoPicture, LeavesTheRunAndIsTheSameInEveryOrder) {
  Simulation alone(run_desc());
  while (!alone.done()) alone.step();
  const insitu::testing::TemporaryFolder folder;
  for (const std::uint32_t order : {INSITU_ORDER_PERMUTE, INSITU_ORDER_INDEX, INSITU_ORDER_COPY}) {
    Picture::Cost cost;
    std::size_t moved = 0;
    const Particles particles = drawn(picture_desc(folder.file(std::to_string(order)), order), &cost, &moved);
    EXPECT_TRUE(same_particles(alone.particles(), particles));
    EXPECT_EQ(moved > 0, order == INSITU_ORDER_PERMUTE);
    EXPECT_EQ(cost.copied_bytes > 0, order == INSITU_ORDER_COPY);
    EXPECT_EQ(cost.build_s.size(), 3u);
    EXPECT_GT(cost.calls_s, 0.0);
    EXPECT_GE(cost.frame_buffer_bytes, 64u * 48 * 16);
    EXPECT_GE(cost.peak_bytes, cost.frame_buffer_bytes);
    if (order == INSITU_ORDER_PERMUTE) {  // nothing per particle
      EXPECT_LE(cost.peak_bytes - cost.frame_buffer_bytes, particles.bytes() / 10);
    }
  }
  for (const char* const name : {"cosmo_0004.png", "cosmo_0008.png", "cosmo_0012.png"}) {
    const std::string picture = pixels(folder.path() / std::to_string(INSITU_ORDER_PERMUTE) / name);
    EXPECT_GT(picture.size(), 1000u);
    EXPECT_TRUE(picture == pixels(folder.path() / std::to_string(INSITU_ORDER_INDEX) / name)) << name;
    EXPECT_TRUE(picture == pixels(folder.path() / std::to_string(INSITU_ORDER_COPY) / name)) << name;
  }
  const fs::path one = folder.path() / std::to_string(INSITU_ORDER_INDEX);
  EXPECT_FALSE(pixels(one / "cosmo_0004.png") == pixels(one / "cosmo_0012.png"));
}

TEST(CosmoPicture, ShowsWhatItIsAskedFor) {
  const insitu::testing::TemporaryFolder folder;
  std::vector<std::string> pictures;
  const auto draw = [&](const char* name, const std::function<void(PictureDesc&)>& change) {
    PictureDesc desc = picture_desc(folder.file(name), INSITU_ORDER_PERMUTE);
    change(desc);
    drawn(desc);
    pictures.push_back(pixels(folder.path() / name / "cosmo_0012.png"));
  };
  draw("slab", [](PictureDesc&) {});
  draw("thin", [](PictureDesc& d) { d.slab = 2.0; });
  draw("box", [](PictureDesc& d) { d.slab = 0.0; });
  draw("speed", [](PictureDesc& d) { d.color_by = ColorBy::speed; });
  draw("bare", [](PictureDesc& d) { d.ao_samples = 0; });
  draw("faint", [](PictureDesc& d) { d.opacity = 0.25; });
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    EXPECT_FALSE(pictures[i].empty());
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(pictures[i] == pictures[j]) << i << ' ' << j;
  }
}

TEST(CosmoPicture, RunGoesOnWhenNothingCanBeWritten) {
  const insitu::testing::TemporaryFolder folder;
  std::ofstream(folder.file("taken")) << "a file where the folder should be";
  Simulation simulation(run_desc());
  Picture picture(picture_desc(folder.file("taken"), INSITU_ORDER_PERMUTE));
  simulation.step();
  const Particles before = simulation.particles();
  EXPECT_FALSE(picture.draw(1, simulation.a(), simulation.particles()));
  EXPECT_NE(picture.error(), "");
  EXPECT_TRUE(same_particles(before, simulation.particles()));
}

}  // namespace
}  // namespace cosmo
