// Drawing a simulation does nothing to it.
#include "picture.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "states.h"

namespace melt {
namespace {

namespace fs = std::filesystem;

class PictureTest : public testing::Test {
 protected:
  PictureTest() {
    const testing::TestInfo* const test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("melt_") + test->name();
    for (char& c : name) c = c == '/' ? '_' : c;
    folder_ = fs::path(testing::TempDir()) / name;
    fs::remove_all(folder_);
  }
  ~PictureTest() override { fs::remove_all(folder_); }

  PictureDesc small(std::uint32_t order) const {
    PictureDesc desc;
    desc.folder = folder_.string();
    desc.width = 64;
    desc.height = 48;
    desc.ao_samples = 2;
    desc.order = order;
    desc.threads = 2;
    return desc;
  }

  // A run of 60 steps; after each, `drawn` may do what it likes with the simulation, and `compare` sees it beside one
  // that was left alone.
  static void run(const std::function<void(Simulation&)>& drawn,
                  const std::function<void(std::span<const Particle>, std::span<const Particle>)>& compare) {
    SimulationDesc desc;
    desc.atoms = 2048;
    Simulation alone(desc);
    Simulation watched(desc);
    for (int i = 0; i < 60; ++i) {
      alone.step_with_thermostat(1.6, 0.05);
      watched.step_with_thermostat(1.6, 0.05);
      drawn(watched);
      compare(std::as_const(alone).particles(), std::as_const(watched).particles());
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(watched.list_builds(), 3u);
  }

  fs::path folder_;
};

void expect_same_memory(std::span<const Particle> a, std::span<const Particle> b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0);
}

bool is_png(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  char signature[8] = {};
  file.read(signature, sizeof signature);
  return std::string(signature, 8) == "\x89PNG\r\n\x1a\n";
}

class ReadingOnly : public PictureTest, public testing::WithParamInterface<std::uint32_t> {};

TEST_P(ReadingOnly, LeavesTheTrajectoryAsItIsInMemory) {
  Picture picture(small(GetParam()));
  run(
      [&](Simulation& simulation) {
        if (simulation.steps() % 5 != 0) return;
        ASSERT_TRUE(picture.draw(simulation.steps(), simulation.time(), simulation.particles())) << picture.error();
      },
      expect_same_memory);
  EXPECT_TRUE(is_png(folder_ / "melt_000005.png"));
  EXPECT_TRUE(is_png(folder_ / "melt_000060.png"));
  EXPECT_EQ(picture.cost().copied_bytes > 0, GetParam() == INSITU_ORDER_COPY);
  EXPECT_GT(picture.cost().rays, 12u * 64 * 48);
}

INSTANTIATE_TEST_SUITE_P(Orders, ReadingOnly, testing::Values(INSITU_ORDER_INDEX, INSITU_ORDER_COPY),
                         [](const auto& info) { return info.param == INSITU_ORDER_INDEX ? "index" : "copy"; });

// Records move, atoms do not notice: forces are summed in an order that does not depend on places in the array.
TEST_F(PictureTest, PermutingLeavesTheTrajectoryOfEveryAtom) {
  Picture picture(small(INSITU_ORDER_PERMUTE));
  run(
      [&](Simulation& simulation) {
        if (simulation.steps() % 5 != 0) return;
        ASSERT_TRUE(picture.draw(simulation.steps(), simulation.time(), simulation.particles())) << picture.error();
        simulation.records_moved();
        std::size_t moved = 0;
        for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
          if (simulation.particles()[i].id != static_cast<std::int64_t>(i)) ++moved;
        }
        EXPECT_GT(moved, 1000u);
      },
      [](std::span<const Particle> alone, std::span<const Particle> watched) {
        ASSERT_TRUE(same_atoms(alone, watched));
      });
  EXPECT_EQ(picture.cost().copied_bytes, 0u);
}

TEST_F(PictureTest, RunGoesOnWhenNothingCanBeWritten) {
  std::ofstream(folder_) << "a file where the folder should be";
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE}) {
    Picture picture(small(order));
    run(
        [&](Simulation& simulation) {
          if (simulation.steps() % 20 != 0) return;
          EXPECT_FALSE(picture.draw(simulation.steps(), simulation.time(), simulation.particles()));
          EXPECT_NE(picture.error(), "");
          simulation.records_moved();
        },
        [](std::span<const Particle> alone, std::span<const Particle> watched) {
          ASSERT_TRUE(same_atoms(alone, watched));
        });
  }
}

}  // namespace
}  // namespace melt
