// The arithmetic of treelets, which stores no topology: against a plain walk down the tree, for numbers of particles
// that no machine holds.
#include <gtest/gtest.h>

#include <vector>

#include "geometry/pkd/treelet_build.h"
#include "kernels/treelets.h"
#include "unit/kernels/counter_random.h"

namespace insitu::testing {
namespace {

using kernels::TreeletRun;
using kernels::Treelets;

std::vector<std::uint64_t> particle_counts() {
  std::vector<std::uint64_t> counts;
  for (int bit = 1; bit < 62; ++bit)
    for (const int off : {-2, -1, 0, 1, 7})
      if ((std::int64_t{1} << bit) + off > 0)
        counts.push_back(static_cast<std::uint64_t>((std::int64_t{1} << bit) + off));
  CounterRandom random(1);
  for (int i = 0; i < 200; ++i) counts.push_back(1 + random.next() % (std::uint64_t{1} << (1 + random.below(61))));
  return counts;
}

// Down to a subtree by the rule of kernels/pkd_tree.h: the middle splits, what is before it is the left side.
TEST(TreeletShape, RunsAreSubtreesAndTheirSplits) {
  CounterRandom random(2);
  for (const std::uint64_t count : particle_counts()) {
    for (int way = 0; way < 20; ++way) {
      std::uint64_t begin = 0;
      std::uint64_t end = count;
      TreeletRun run = {0, count + 1};
      // As in a shape: one to three levels at the root, three everywhere else.
      for (unsigned bits = 1 + static_cast<unsigned>(random.below(3)); end - begin >= (std::uint64_t{1} << bits) - 1;
           bits = 3) {
        const auto k = static_cast<unsigned>(random.below(std::uint64_t{1} << bits));
        run = child_run(run, bits, k);
        for (unsigned level = bits; level-- > 0;) {
          const std::uint64_t mid = begin + (end - begin) / 2;
          if ((k >> level & 1) == 0) {
            end = mid;
          } else {
            begin = mid + 1;
          }
        }
        ASSERT_EQ(run.begin, begin) << count;
        ASSERT_EQ(run.span, end - begin + 1) << count;
        if (begin == end) break;
      }
    }
  }
}

TEST(TreeletShape, LevelsFollowEachOtherAndFit) {
  for (const std::uint64_t count : particle_counts()) {
    for (const double per_treelet : {1.0, 16.0, 1000.0}) {
      const std::uint64_t everything = ~std::uint64_t{0};
      const unsigned depth = treelet_depth(count, per_treelet, everything);
      // The shape holds as many levels as the deepest tree has: no write behind level_begin.
      ASSERT_LE(depth, 3 * Treelets::most_levels) << count;
      const Treelets shape = treelet_shape(count, depth);
      ASSERT_EQ(shape.exist(), depth != 0) << count;
      if (depth == 0) continue;
      ASSERT_LE(shape.levels, Treelets::most_levels);
      ASSERT_LE(shape.count, count);
      // No deeper is asked for than leaves treelets of the wanted size, or as deep as can be.
      const double left = static_cast<double>(count >> depth);
      const bool is_deepest = depth == 3 * Treelets::most_levels || count >> (depth + 1) == 0;
      ASSERT_TRUE(is_deepest || left <= per_treelet) << count;
      std::uint64_t first = 0;
      std::uint64_t nodes = 1;
      for (unsigned level = 0; level < shape.levels; ++level) {
        ASSERT_EQ(shape.level_begin[level], first) << count;
        ASSERT_EQ(shape.nodes_at(level), nodes) << count;
        first += nodes;
        nodes <<= shape.bits_at(level);
      }
      ASSERT_EQ(nodes, shape.count) << count;
      ASSERT_EQ(first, shape.node_count()) << count;
      ASSERT_EQ(treelet_bytes(count, depth), first * sizeof(kernels::TreeletNode)) << count;
      // One byte too few costs a level.
      ASSERT_LT(treelet_depth(count, per_treelet, treelet_bytes(count, depth) - 1), depth) << count;
    }
  }
}

// 2^40 particles by 16: seventy billion treelets, found by a number each.
TEST(TreeletShape, ATrillionParticlesGetTreeletsOfTheWantedSize) {
  const std::uint64_t count = std::uint64_t{1} << 40;
  const Treelets shape = treelet_shape(count, treelet_depth(count, 16.0, ~std::uint64_t{0}));
  EXPECT_EQ(shape.count, std::uint64_t{1} << 36);
  EXPECT_EQ(shape.levels, 12u);
  TreeletRun run = shape.root();
  for (unsigned level = 0; level < shape.levels; ++level)
    run = child_run(run, shape.bits_at(level), (1u << shape.bits_at(level)) - 1);
  EXPECT_EQ(run.begin + run.span, count + 1);
  EXPECT_LE(run.span, 17u);
}

}  // namespace
}  // namespace insitu::testing
