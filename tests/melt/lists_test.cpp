// Cell lists and neighbour lists against a look at all pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "md/cell_list.h"
#include "md/neighbour_list.h"

namespace melt {
namespace {

std::vector<Vec3> random_points(std::size_t count, const Box& box, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(0.0, box.side);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

TEST(Box, WrapsIntoTheHalfOpenCube) {
  const Box box{7.0};
  for (const double x : {-1e-300, -1e-17, -0.0, 0.0, 6.999999999999999, 7.0, 7.5, -7.0, -20.5, 1e18, -1e300}) {
    const double w = box.wrapped(x);
    EXPECT_TRUE(w >= 0.0 && w < 7.0) << x << " became " << w;
  }
  EXPECT_DOUBLE_EQ(box.wrapped(-0.25), 6.75);
  EXPECT_DOUBLE_EQ(box.wrapped(15.0), 1.0);
  EXPECT_EQ(box.wrapped(std::nan("")), 0.0);
}

TEST(Box, NearestImageIsOdd) {
  const Box box{7.3};
  for (double d = -7.2; d < 7.2; d += 0.0137) {
    EXPECT_EQ(box.nearest(-d), -box.nearest(d));
    EXPECT_LE(std::abs(box.nearest(d)), 3.65);
  }
}

TEST(CellList, HoldsEveryPointOnceSortedByCellAndIndex) {
  const Box box{11.0};
  const std::vector<Vec3> points = random_points(700, box, 1);
  CellList cells(box, 2.0, points.size());
  for (int repeat = 0; repeat < 2; ++repeat) {  // the second sort starts from a used object
    cells.sort(points);
    ASSERT_EQ(cells.cells(), 125u);
    ASSERT_EQ(cells.first(0), 0u);
    ASSERT_EQ(cells.first(125), points.size());
    std::vector<std::uint32_t> all(cells.order().begin(), cells.order().end());
    std::sort(all.begin(), all.end());
    std::vector<std::uint32_t> expected(points.size());
    std::iota(expected.begin(), expected.end(), 0u);
    EXPECT_EQ(all, expected);
    for (std::size_t c = 0; c < cells.cells(); ++c) {
      for (std::uint32_t s = cells.first(c); s < cells.first(c + 1); ++s) {
        const Vec3& p = points[cells.order()[s]];
        const auto at = [&](std::size_t k) { return static_cast<std::size_t>(p[k] / 11.0 * 5.0); };
        EXPECT_EQ((at(2) * 5 + at(1)) * 5 + at(0), c);
        EXPECT_TRUE(s == cells.first(c) || cells.order()[s - 1] < cells.order()[s]);
      }
    }
  }
}

TEST(CellList, NeighbourCellsAreDistinct) {
  for (const double side : {1.5, 2.5, 3.5, 4.5, 9.5}) {
    const CellList cells({side}, 1.0, 100000);
    const auto width = static_cast<std::size_t>(side);
    ASSERT_EQ(cells.cells(), width * width * width);
    for (std::size_t c = 0; c < cells.cells(); ++c) {
      std::vector<std::size_t> around;
      cells.neighbours(c, around);
      const std::set<std::size_t> distinct(around.begin(), around.end());
      const std::size_t expected = std::min<std::size_t>(width, 3);
      EXPECT_EQ(around.size(), expected * expected * expected);
      EXPECT_EQ(distinct.size(), around.size());
      EXPECT_TRUE(distinct.contains(c));
    }
  }
}

TEST(NeighbourList, FindsExactlyThePairsWithinReach) {
  Workers workers(2);
  // From one cell along a side to seven, over several blocks of the list.
  for (const double side : {5.7, 6.2, 8.9, 12.0, 20.0}) {
    const Box box{side};
    const double reach = 2.8;
    const std::vector<Vec3> points = random_points(1100, box, static_cast<unsigned>(side));
    NeighbourList list(box, reach, points.size());
    list.build(points, workers);
    for (std::size_t slot = 0; slot < points.size(); ++slot) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t other = 0; other < points.size(); ++other) {
        double r2 = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
          const double d = points[list.ids()[slot]][k] - points[list.ids()[other]][k];
          const double nearest = std::remainder(d, side);
          r2 += nearest * nearest;
        }
        if (other != slot && r2 < reach * reach) expected.push_back(other);
      }
      std::vector<std::uint32_t> found(list.of(slot).begin(), list.of(slot).end());
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected) << "slot " << slot << ", side " << side;
    }
  }
}

}  // namespace
}  // namespace melt
