// What snapshots have in common: pieces, arrays that not all particles have, and how large particles are drawn.
#include "snapshot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "read_files.h"
#include "snapshot_radii.h"

namespace replay::test {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsNan;

TEST(Snapshot, NamesOfPieces) {
  const auto plain = piece_name("dir.1/snap_004.0");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->path(12), "dir.1/snap_004.12");
  const auto packed = piece_name("snap.3.hdf5.gz");
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->number, 3u);
  EXPECT_EQ(packed->path(0), "snap.0.hdf5.gz");
  for (const char* name :
       {"snap", "snap.", "snap.hdf5", "snap.1x", "snap.-1", "snap.00", "snap.99999999999999999999"}) {
    EXPECT_FALSE(piece_name(name)) << name;
  }
}

TEST(Snapshot, TypesMeetInOneThatHoldsBoth) {
  Scalars floats = std::vector<float>{1.5f};
  append(floats, std::vector<float>{2.5f});
  EXPECT_EQ(floats.index(), 1u);
  append(floats, std::vector<double>{0.1});
  EXPECT_EQ(std::get<0>(floats), (std::vector<double>{1.5, 2.5, 0.1}));
  Scalars ids = std::vector<std::uint32_t>{4294967295u};
  append(ids, std::vector<std::uint64_t>{std::uint64_t{1} << 63});
  EXPECT_EQ(std::get<5>(ids), (std::vector<std::uint64_t>{4294967295u, std::uint64_t{1} << 63}));
  Scalars whole = std::vector<std::int32_t>{-1};
  append(whole, std::vector<std::int64_t>{std::int64_t{1} << 40});
  EXPECT_EQ(std::get<4>(whole), (std::vector<std::int64_t>{-1, std::int64_t{1} << 40}));
  append(whole, std::vector<float>{0.5f});
  EXPECT_EQ(std::get<0>(whole), (std::vector<double>{-1, std::ldexp(1.0, 40), 0.5}));
}

TEST(Snapshot, ParticlesWithoutAValue) {
  Frame frame;
  SnapshotBuilder builder(frame);
  builder.add_positions(std::vector<float>(12));
  builder.add("a", 1, 1, std::vector<float>{1});
  builder.add("a", 1, 3, std::vector<float>{3});
  builder.add("b", 2, 1, std::vector<std::int32_t>{1, 2});
  builder.finish();
  EXPECT_THAT(values(frame, "a"), ElementsAre(IsNan(), 1, IsNan(), 3));
  EXPECT_THAT(values(frame, "b"), ElementsAre(0, 0, 1, 2, 0, 0, 0, 0));
}

Frame lattice(int n, double spacing) {
  Frame frame;
  for (int i = 0; i < n * n * n; ++i) {
    for (const int c : {i % n, i / n % n, i / n / n}) frame.position.push_back(c * spacing);
  }
  return frame;
}

TEST(SnapshotRadii, AreHalfTheSpacingOfALattice) {
  Frame frame = lattice(21, 2.0);
  EXPECT_NEAR(common_radius(frame), 1.0, 0.1);
  // One particle far out changes nothing, and neither does one nowhere.
  frame.position.insert(frame.position.end(), {40, 40, 90, std::nan(""), 0, 0});
  EXPECT_NEAR(common_radius(frame), 1.0, 0.1);
}

TEST(SnapshotRadii, DoNotLetClustersVanish) {
  Frame frame = lattice(10, 1e-6);
  frame.position.insert(frame.position.end(), {0, 0, 0, 1, 1, 1});
  EXPECT_NEAR(common_radius(frame), std::cbrt(1.0 / 1002) / 8, 1e-6);
}

TEST(SnapshotRadii, FollowMassAndDensityWhereTheyAreKnown) {
  Frame frame = lattice(3, 4.0);
  std::vector<float> density(27, std::numeric_limits<float>::quiet_NaN());
  density[0] = 1;
  density[1] = 64;
  frame.add("density").scalars = density;
  choose_snapshot_radii(frame);
  EXPECT_EQ(frame.find("radius"), nullptr);
  EXPECT_GT(frame.radius_for_all, 0.0);
  frame.add("mass").scalars = std::vector<double>(27, 8.0);
  choose_snapshot_radii(frame);
  const std::vector<double> radius = values(frame, "radius");
  EXPECT_EQ(radius[0], 1.0);
  EXPECT_EQ(radius[1], 0.25);
  EXPECT_THAT(std::vector<double>(radius.begin() + 2, radius.end()), Each(static_cast<float>(common_radius(frame))));
}

TEST(SnapshotRadii, OfNoParticlesAndOfCoincidentOnes) {
  Frame frame;
  EXPECT_EQ(common_radius(frame), 0.0);
  frame.position.assign(30, 1.0);
  EXPECT_EQ(common_radius(frame), 0.0);
}

}  // namespace
}  // namespace replay::test
