// What the build leaves behind: a tree by the rules of pkd_tree.h, with every particle once, and unchanged.
#include "geometry/pkd/pkd_build.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/pkd_reference.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {
namespace {

std::array<double, 4> particle_at(const kernels::PkdTree& tree, std::uint64_t place) {
  double centre[3];
  tree.centre(place, centre);
  return {centre[0], centre[1], centre[2], tree.radius.value(tree.item(place))};
}

// Every particle of the cloud stands at exactly one place, with its own coordinates and radius.
void expect_permutation(const TestTree& built, const TreeCase& c) {
  const kernels::PkdTree& tree = built.tree();
  ASSERT_EQ(tree.count, c.count) << c;
  // Packed coordinates that move alone carry no numbers: then the values themselves are compared.
  const bool alone = c.order == Order::placed && c.radii == Radii::uniform &&
                     (c.layout == Layout::records_f32 || c.layout == Layout::records_f64);
  std::vector<std::array<double, 4>> given;
  std::vector<std::array<double, 4>> found;
  std::vector<bool> seen(c.count, false);
  for (std::uint64_t place = 0; place < c.count; ++place) {
    const std::uint64_t who = alone ? place : built.original(place);
    ASSERT_LT(who, c.count) << c;
    ASSERT_FALSE(seen[who]) << c;
    seen[who] = true;
    given.push_back({built.given(who)[0], built.given(who)[1], built.given(who)[2], built.given_radius(who)});
    found.push_back(particle_at(tree, place));
  }
  if (alone) {
    std::sort(given.begin(), given.end());
    std::sort(found.begin(), found.end());
  }
  EXPECT_EQ(given, found) << c;
}

class EveryLayout : public ::testing::TestWithParam<Layout> {};

TEST_P(EveryLayout, KeepsTheRulesAndTheParticles) {
  std::uint64_t seed = 0;
  for (const std::uint64_t count : {0, 1, 2, 31, 32, 33, 34, 63, 64, 65, 66, 100, 1000}) {
    for (const Shape shape : all_shapes) {
      for (const Order order : all_orders) {
        TreeCase c;
        c.count = count;
        c.shape = shape;
        c.layout = GetParam();
        c.order = order;
        c.radii = all_radii[seed % 3];
        c.seed = ++seed;
        const TestTree built(c);
        EXPECT_EQ(kernels::find_broken_invariant(built.tree()), kernels::no_item) << c;
        expect_permutation(built, c);
      }
    }
  }
}

// Beyond the size of one block, whose subtrees are built in scratch memory.
TEST_P(EveryLayout, KeepsTheRulesAboveABlock) {
  std::uint64_t seed = 500;
  for (const Order order : all_orders) {
    TreeCase c;
    c.count = 140000;
    c.layout = GetParam();
    c.order = order;
    c.shape = all_shapes[seed % all_shapes.size()];
    c.radii = all_radii[seed % 3];
    c.seed = ++seed;
    const TestTree built(c);
    EXPECT_EQ(kernels::find_broken_invariant(built.tree()), kernels::no_item) << c;
    expect_permutation(built, c);
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, EveryLayout, ::testing::ValuesIn(all_layouts),
                         [](const auto& info) { return std::string(name_of(info.param)); });

// Clouds with many equal coordinates are where a selection degenerates; the rules hold, and building ends.
TEST(Build, LargeCloudsOfEqualCoordinates) {
  for (const Shape shape :
       {Shape::grid, Shape::planar, Shape::collinear, Shape::coincident, Shape::coincident_groups}) {
    for (const Order order : {Order::placed, Order::index32}) {
      TreeCase c;
      c.count = 150000;
      c.shape = shape;
      c.order = order;
      const TestTree built(c);
      EXPECT_EQ(kernels::find_broken_invariant(built.tree()), kernels::no_item) << c;
    }
  }
}

TEST(Build, OfACoincidentRunTheOneToBeShownStandsFirst) {
  TreeCase c;
  c.count = 500;
  c.shape = Shape::coincident;
  c.order = Order::index32;
  EXPECT_EQ(TestTree(c).tree().item(0), 0u);
  c.larger_id_first = true;
  EXPECT_EQ(TestTree(c).tree().item(0), 499u);
}

// The check itself: it finds a particle on the wrong side of a plane.
TEST(Build, BrokenTreesAreFound) {
  TreeCase c;
  c.count = 200;
  c.layout = Layout::records_f64;
  c.order = Order::index32;
  TestTree built(c);
  ASSERT_EQ(kernels::find_broken_invariant(built.tree()), kernels::no_item);
  std::vector<std::uint32_t> index(built.tree().index32, built.tree().index32 + c.count);
  kernels::PkdTree broken = built.tree();
  broken.index32 = index.data();
  std::swap(index.front(), index.back());
  EXPECT_NE(kernels::find_broken_invariant(broken), kernels::no_item);
}

}  // namespace
}  // namespace insitu::testing
