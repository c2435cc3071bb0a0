// The paper's structure is a tree by its own rules, and gives the hits of the brute force to the last bit.
#include "benchmarks/paper_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <sstream>

#include "kernels/pkd_reference.h"
#include "unit/kernels/hit_check.h"
#include "unit/kernels/simd_guard.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {
namespace {

using bench::AxisRule;
using bench::PaperTree;
using bench::RayWay;
using bench::TreeLayout;
using kernels::Hit;
using kernels::Ray;

constexpr std::array all_tree_layouts = {TreeLayout::heap, TreeLayout::in_order};
constexpr std::array all_rules = {AxisRule::round_robin, AxisRule::longest_side};
constexpr std::array all_sizes = {0u, 1u, 2u, 3u, 4u, 5u, 7u, 8u, 31u, 32u, 33u, 64u, 100u, 255u, 256u, 1000u};

std::vector<float> positions_of(const TestTree& tree) {
  std::vector<float> position;
  for (std::uint64_t i = 0; i < tree.count(); ++i)
    for (int c = 0; c < 3; ++c) position.push_back(static_cast<float>(tree.given(i)[c]));
  return position;
}

TreeCase make_case(std::uint64_t count, Shape shape, std::uint64_t seed) {
  TreeCase c;
  c.count = count;
  c.shape = shape;
  c.order = Order::index32;
  c.seed = seed;
  c.thickness = seed % 3 == 0 ? 0.2 : 1.5;
  return c;
}

// Nodes below `node` in a heap of `count`, level by level: children are those of 2i+1 and 2i+2, nothing else.
std::uint64_t nodes_below(std::uint64_t node, std::uint64_t count) {
  std::uint64_t sum = 0;
  for (std::uint64_t first = node, last = node; first < count; first = 2 * first + 1, last = 2 * last + 2)
    sum += std::min(last, count - 1) - first + 1;
  return sum;
}

TEST(PaperTree, LeftSubtreesFillAHeap) {
  for (std::uint64_t count = 1; count < 5000; ++count)
    ASSERT_EQ(bench::left_subtree_size(count), nodes_below(1, count)) << count;
  CounterRandom random(1);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t count = 1 + random.next() % (std::uint64_t{1} << (1 + random.below(45)));
    ASSERT_EQ(bench::left_subtree_size(count), nodes_below(1, count)) << count;
  }
}

// The rules of the tree, read from its order alone. `places` are those of a subtree, its root first.
class TreeRules {
 public:
  explicit TreeRules(const PaperTree& paper) : paper_(paper) {}

  void check() {
    const kernels::PkdTree& tree = paper_.tree();
    kernels::PkdBox<float> box = {};
    for (int c = 0; c < 3; ++c) {
      box.lower[c] = static_cast<float>(tree.lower[c]);
      box.upper[c] = static_cast<float>(tree.upper[c]);
    }
    if (tree.count > 0) check_below(0, tree.count, 0, 0, box);
    EXPECT_EQ(seen_, tree.count);
  }

 private:
  float key(std::uint64_t place, int axis) const {
    return paper_.position()[3 * place + static_cast<std::uint64_t>(axis)];
  }

  void check_below(std::uint64_t begin, std::uint64_t end, std::uint64_t node, int depth,
                   const kernels::PkdBox<float>& box) {
    const bool heap = paper_.layout() == TreeLayout::heap;
    const std::uint64_t count = paper_.tree().count;
    if (heap ? node >= count : begin >= end) return;
    ++seen_;
    const std::uint64_t place = heap ? node : begin + (end - begin) / 2;
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(key(place, c), box.lower[c]) << place;
      EXPECT_LE(key(place, c), box.upper[c]) << place;
    }
    const int axis = paper_.axes()[place];
    float widest = 0.0f;
    for (int c = 0; c < 3; ++c) widest = std::max(widest, box.upper[c] - box.lower[c]);
    if (paper_.rule() == AxisRule::round_robin) {
      EXPECT_EQ(axis, depth % 3);
    } else {
      EXPECT_EQ(box.upper[axis] - box.lower[axis], widest);
    }
    kernels::PkdBox<float> below = box;
    kernels::PkdBox<float> above = box;
    below.upper[axis] = above.lower[axis] = key(place, axis);
    check_below(begin, place, 2 * node + 1, depth + 1, below);
    check_below(place + 1, end, 2 * node + 2, depth + 1, above);
  }

  const PaperTree& paper_;
  std::uint64_t seen_ = 0;
};

TEST(PaperTree, KeepsItsRules) {
  std::uint64_t seed = 0;
  for (const Shape shape : all_shapes) {
    for (const unsigned count : all_sizes) {
      const TestTree given(make_case(count, shape, ++seed));
      const std::vector<float> position = positions_of(given);
      for (const TreeLayout layout : all_tree_layouts) {
        for (const AxisRule rule : all_rules) {
          const PaperTree paper(position, 1.0, layout, rule, PaperTree::Items::by_index);
          TreeRules(paper).check();
          // Every particle once, where its item says.
          std::vector<bool> is_seen(count, false);
          for (std::uint64_t place = 0; place < count; ++place) {
            const std::uint64_t item = paper.tree().item(place);
            ASSERT_FALSE(is_seen[item]);
            is_seen[item] = true;
            for (std::uint64_t c = 0; c < 3; ++c) ASSERT_EQ(paper.position()[3 * place + c], position[3 * item + c]);
          }
          ASSERT_FALSE(::testing::Test::HasFailure()) << given.tree().count << ' ' << name_of(shape);
        }
      }
    }
  }
}

bool is_same(const Hit& a, const Hit& b) {
  return std::bit_cast<std::uint64_t>(a.t) == std::bit_cast<std::uint64_t>(b.t) && a.item == b.item;
}

struct Counts {
  std::size_t rays = 0;
  std::size_t hits = 0;
};

// All variants against `expected`, on the SIMD target in force.
void expect_hits(const std::vector<std::unique_ptr<PaperTree>>& trees, const std::vector<Ray>& rays,
                 const std::vector<Hit>& expected, const std::string& what) {
  const auto expect = [&](const PaperTree& tree, const char* way, const auto& first, const auto& any) {
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size(), 0);
    first(hits.data());
    any(occluded.data());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i)
      wrong += is_same(hits[i], expected[i]) && (occluded[i] != 0) == expected[i].found() ? 0 : 1;
    EXPECT_EQ(wrong, 0u) << what << ", " << (tree.layout() == TreeLayout::heap ? "heap, " : "in order, ")
                         << (tree.rule() == AxisRule::round_robin ? "round robin, " : "longest side, ") << way;
  };
  for (const auto& tree : trees) {
    for (const RayWay way : {RayWay::single, RayWay::packet})
      expect(
          *tree, way == RayWay::single ? "single" : "packet",
          [&](Hit* hits) { tree->first_hits(way, rays.data(), hits, rays.size()); },
          [&](std::uint8_t* occluded) { tree->any_hits(way, rays.data(), occluded, rays.size()); });
    if (tree->layout() != TreeLayout::in_order || tree->rule() != AxisRule::round_robin) continue;
    expect(
        *tree, "the library's kernels", [&](Hit* hits) { tree->library_first_hits(rays.data(), hits, rays.size()); },
        [&](std::uint8_t* occluded) { tree->library_any_hits(rays.data(), occluded, rays.size()); });
  }
}

Counts check(const TreeCase& c, std::size_t ray_count) {
  const TestTree given(c);
  const std::vector<float> position = positions_of(given);
  std::vector<std::unique_ptr<PaperTree>> trees;
  for (const TreeLayout layout : all_tree_layouts)
    for (const AxisRule rule : all_rules)
      trees.push_back(
          std::make_unique<PaperTree>(position, given.tree().radius.uniform, layout, rule, PaperTree::Items::by_index));
  std::ostringstream what;
  what << c;
  CounterRandom random(c.seed + 77);
  std::vector<Ray> rays = make_rays(given, ray_count, random);
  const std::vector<Ray> limited = limit_rays(given.tree(), rays);
  rays.insert(rays.end(), limited.begin(), limited.end());
  std::vector<Hit> expected;
  Counts counts;
  for (const Ray& ray : rays) {
    expected.push_back(kernels::reference_first_hit(given.tree(), ray));
    ++counts.rays;
    counts.hits += expected.back().found() ? 1 : 0;
  }
  for_each_simd_target([&](const char* target) { expect_hits(trees, rays, expected, what.str() + ", " + target); });
  return counts;
}

class PaperTreeOfShape : public ::testing::TestWithParam<Shape> {};

TEST_P(PaperTreeOfShape, HitsAsBruteForceDoes) {
  Counts sum;
  std::uint64_t seed = 100;
  for (const unsigned count : all_sizes) {
    const Counts counts = check(make_case(count, GetParam(), ++seed), 96);
    sum.rays += counts.rays;
    sum.hits += counts.hits;
  }
  // Rays that all miss would prove nothing.
  EXPECT_GT(sum.hits, sum.rays / 4);
  EXPECT_LT(sum.hits, sum.rays);
}

INSTANTIATE_TEST_SUITE_P(Shapes, PaperTreeOfShape, ::testing::ValuesIn(all_shapes),
                         [](const auto& info) { return std::string(name_of(info.param)); });

// Particles too small, or too far away, for the frame of the whole tree: rays are traced in double.
TEST(PaperTree, HitsAtEveryMagnitude) {
  std::uint64_t seed = 200;
  for (const double size : {1e-12, 1.0, 1e12}) {
    for (const double offset : {0.0, 1e4 * size}) {
      TreeCase c = make_case(500, Shape::uniform, ++seed);
      c.size = size;
      c.offset = offset;
      check(c, 48);
    }
  }
  TreeCase c = make_case(1000, Shape::clustered, ++seed);
  c.thickness = 1e-4;
  check(c, 48);
}

}  // namespace
}  // namespace insitu::testing
