// Under a filter a tree gives the hits of the brute force over the particles that are left, to the last bit, for every
// layout, order, kind of radius and shape, with treelets and without.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernels/pkd_reference.h"
#include "unit/kernels/hit_check.h"
#include "unit/kernels/test_selection.h"

namespace insitu::testing {
namespace {

// What is left of the particles.
enum class Left { none, one, tenth, half, most, run, region, all };
constexpr std::array all_left = {Left::none, Left::one, Left::tenth,  Left::half,
                                 Left::most, Left::run, Left::region, Left::all};

const char* name_of(Left left) {
  constexpr const char* names[] = {"none", "one", "tenth", "half", "most", "run", "region", "all"};
  return names[static_cast<int>(left)];
}

std::vector<bool> choose(const kernels::PkdTree& tree, Left left, CounterRandom& random) {
  std::vector<bool> chosen(tree.count, left == Left::all);
  if (tree.count == 0) return chosen;
  const std::uint64_t first = random.below(tree.count);
  for (std::uint64_t place = 0; place < tree.count; ++place) {
    const std::uint64_t die = random.below(20);
    if (left == Left::tenth) chosen[place] = die < 2;
    if (left == Left::half) chosen[place] = die < 10;
    if (left == Left::most) chosen[place] = die < 19;
    if (left == Left::run) chosen[place] = place >= first && place < first + 1 + tree.count / 5;
    if (left == Left::region) {
      double centre[3];
      tree.centre(place, centre);
      chosen[place] = centre[0] < 0.6 * tree.lower[0] + 0.4 * tree.upper[0];
    }
  }
  if (left == Left::one) chosen[first] = true;
  return chosen;
}

// The reference passes by what is not selected: against all hits of all particles, of which these are struck out.
void check_reference(const kernels::PkdTree& filtered, const std::vector<bool>& chosen,
                     const std::vector<kernels::Ray>& rays, const std::string& what) {
  kernels::PkdTree whole = filtered;
  whole.selected = {};
  std::vector<bool> item_chosen(filtered.position.count);
  for (std::uint64_t place = 0; place < filtered.count; ++place) item_chosen[filtered.item(place)] = chosen[place];
  for (std::size_t i = 0; i < rays.size(); i += 5) {
    std::vector<std::uint64_t> expected;
    std::vector<std::uint64_t> found;
    for (const kernels::Span& span : kernels::reference_all_hits(whole, rays[i]))
      if (item_chosen[span.item]) expected.push_back(span.item);
    for (const kernels::Span& span : kernels::reference_all_hits(filtered, rays[i])) found.push_back(span.item);
    EXPECT_EQ(found, expected) << what;
    const kernels::Hit first = kernels::reference_first_hit(filtered, rays[i]);
    EXPECT_TRUE(!first.found() || item_chosen[first.item]) << what;
    const bool starts_outside = rays[i].t_min == 0.0 && std::isinf(rays[i].t_max);
    EXPECT_TRUE(first.found() || expected.empty() || !starts_outside) << what;
  }
}

// Leaves are longer in three cases of four.
kernels::PkdTree filtered(kernels::PkdTree tree, const TestSelection& selection, std::uint64_t seed) {
  tree.selected = selection.places();
  tree.selected.thinning = static_cast<unsigned>((seed + seed / 8) % 4);  // tests run through selections in eights
  return tree;
}

HitCounts check(const TreeCase& c, Left left, std::size_t ray_count, std::size_t all_hits_every = 3) {
  const TestTree test_tree(c);
  CounterRandom random(c.seed + 991);
  const std::vector<bool> chosen = choose(test_tree.tree(), left, random);
  const TestSelection selection(chosen);
  const kernels::PkdTree tree = filtered(test_tree.tree(), selection, c.seed);
  std::ostringstream what;
  what << c << ", left " << name_of(left) << ", thinning " << tree.selected.thinning;
  const std::vector<kernels::Ray> rays = make_rays(test_tree, ray_count, random);
  check_reference(tree, chosen, rays, what.str());
  const HitCounts counts = expect_brute_force_hits(tree, rays, all_hits_every, what.str());
  expect_brute_force_hits(tree, limit_rays(tree, rays), all_hits_every, what.str() + ", limited");
  return counts;
}

class FilteredLayout : public ::testing::TestWithParam<Layout> {};

TEST_P(FilteredLayout, SmallTrees) {
  HitCounts sum;
  std::uint64_t seed = 0;
  for (const std::uint64_t count : {0, 1, 2, 33, 64, 65, 100, 300}) {
    for (const Order order : all_orders) {
      for (const Left left : all_left) {
        TreeCase c;
        c.count = count;
        c.layout = GetParam();
        c.order = order;
        c.radii = all_radii[seed % all_radii.size()];
        c.shape = all_shapes[seed % all_shapes.size()];
        c.larger_id_first = seed % 3 == 0 && order != Order::placed;
        c.seed = ++seed;
        const HitCounts counts = check(c, left, 24);
        sum.rays += counts.rays;
        sum.hits += counts.hits;
      }
    }
  }
  EXPECT_GT(sum.hits, sum.rays / 8);
  EXPECT_LT(sum.hits, sum.rays);
}

INSTANTIATE_TEST_SUITE_P(Layouts, FilteredLayout, ::testing::ValuesIn(all_layouts),
                         [](const auto& info) { return std::string(insitu::testing::name_of(info.param)); });

class FilteredShape : public ::testing::TestWithParam<Shape> {};

// Thin particles, and thick ones that overlap: what is hidden by what is left out has to be found.
TEST_P(FilteredShape, Shapes) {
  std::uint64_t seed = 100 + 9 * static_cast<std::uint64_t>(GetParam());
  for (const Left left : all_left) {
    for (const double thickness : {0.1, 1.0, 4.0}) {
      TreeCase c;
      c.count = 1000;
      c.shape = GetParam();
      c.layout = all_layouts[seed % all_layouts.size()];
      c.order = all_orders[seed % all_orders.size()];
      c.radii = all_radii[seed % all_radii.size()];
      c.thickness = thickness;
      c.seed = ++seed;
      check(c, left, 36, 4);
    }
  }
}

TEST_P(FilteredShape, LargeTrees) {
  std::uint64_t seed = 200 + 9 * static_cast<std::uint64_t>(GetParam());
  for (const Left left : {Left::one, Left::tenth, Left::most, Left::region}) {
    TreeCase c;
    c.count = 30000;
    c.shape = GetParam();
    c.layout = seed % 2 == 0 ? Layout::records_f32 : Layout::columns_f64;
    c.order = all_orders[seed % 2];
    c.radii = all_radii[seed % 3];
    c.thickness = 2.0;
    c.seed = ++seed;
    check(c, left, 36, 8);
  }
}

// Rays as a camera sends them: packets, whose beams are wide.
TEST_P(FilteredShape, FromACamera) {
  std::uint64_t seed = 300 + 9 * static_cast<std::uint64_t>(GetParam());
  for (const Left left : all_left) {
    TreeCase c;
    c.count = 2000;
    c.shape = GetParam();
    c.layout = seed % 2 == 0 ? Layout::records_f32 : Layout::records_f64;
    c.order = all_orders[seed % all_orders.size()];
    c.radii = all_radii[seed % 3];
    c.seed = ++seed;
    const TestTree test_tree(c);
    CounterRandom random(seed);
    const TestSelection selection(choose(test_tree.tree(), left, random));
    const kernels::PkdTree tree = filtered(test_tree.tree(), selection, seed);
    for (const double distance : {0.0, 1.0}) {
      double ahead[3];
      random.direction(ahead);
      std::vector<kernels::Ray> rays;
      for (int pixel = 0; pixel < 24 * 24; ++pixel) {
        kernels::Ray ray{};
        const double off[3] = {pixel % 24 - 11.5, pixel / 24 - 11.5, 0.5 * (pixel % 24) - 6.0};
        double length = 0.0;
        for (int k = 0; k < 3; ++k) {
          ray.origin[k] = 0.5 * (tree.lower[k] + tree.upper[k]) - distance * test_tree.size() * ahead[k];
          ray.direction[k] = ahead[k] + 0.6 / (1.0 + distance) * off[k] / 12.0;
          length += ray.direction[k] * ray.direction[k];
        }
        for (double& d : ray.direction) d /= std::sqrt(length);
        rays.push_back(ray);
      }
      std::ostringstream what;
      what << c << ", left " << name_of(left) << ", camera";
      expect_brute_force_hits(tree, rays, 64, what.str());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, FilteredShape, ::testing::ValuesIn(all_shapes),
                         [](const auto& info) { return std::string(insitu::testing::name_of(info.param)); });

// Whether a range has anything, and which, against one look at each place.
TEST(SelectedPlaces, AgreeWithPlainBits) {
  CounterRandom random(7);
  for (const std::uint64_t count : {1u, 63u, 64u, 65u, 4096u, 4097u, 300000u}) {
    for (const double share : {0.0, 2.0 / static_cast<double>(count), 0.001, 0.3, 1.0}) {
      std::vector<bool> chosen(count);
      for (std::uint64_t i = 0; i < count; ++i) chosen[i] = random.unit() < share;
      const TestSelection selection(chosen);
      const kernels::SelectedPlaces& places = selection.places();
      std::vector<std::uint64_t> before(count + 1, 0);
      for (std::uint64_t i = 0; i < count; ++i) before[i + 1] = before[i] + (chosen[i] ? 1 : 0);
      for (int trial = 0; trial < 2000; ++trial) {
        const std::uint64_t begin = random.below(count + 1);
        const std::uint64_t length = random.below(trial % 2 == 0 ? 200 : count + 1);
        const std::uint64_t end = std::min(count, begin + length);
        EXPECT_EQ(places.any(begin, end), before[end] != before[begin]) << begin << " to " << end << " of " << count;
        if (begin == end) continue;
        EXPECT_EQ(places.has(begin), chosen[begin]);
        const std::uint64_t some = std::min<std::uint64_t>(end - begin, 64);
        std::uint64_t expected = 0;
        for (std::uint64_t i = 0; i < some; ++i) expected |= std::uint64_t{chosen[begin + i]} << i;
        EXPECT_EQ(places.bits(begin, some), expected);
      }
    }
  }
}

}  // namespace
}  // namespace insitu::testing
