// Rays through particles that can be seen through, against brute force, to the last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "kernels/pkd_reference.h"
#include "kernels/pkd_transparent.h"
#include "unit/kernels/hit_check.h"
#include "unit/kernels/simd_guard.h"

namespace insitu::testing {
namespace {

using kernels::EnteredItem;
using kernels::ItemOpacity;
using kernels::NearestEntries;
using kernels::OpticalDepth;
using kernels::PkdTree;
using kernels::Ray;

// Of an item, by its number: a share of them not there, a share opaque, the others of some opacity.
struct Opacities {
  std::uint64_t absent_of_16 = 2;
  std::uint64_t opaque_of_64 = 1;
  double scale = 1.0;

  static float of(const void* context, std::uint64_t item) {
    const auto* self = static_cast<const Opacities*>(context);
    CounterRandom random(item);
    if (random.below(16) < self->absent_of_16) return 0.0f;
    if (random.below(64) < self->opaque_of_64) return 1.0f;
    return static_cast<float>(self->scale * random.between(0.001, 0.999));
  }
  ItemOpacity get() const { return {&Opacities::of, this}; }
};

bool is_same(const EnteredItem& a, const EnteredItem& b) {
  return a.t == b.t && a.item == b.item && a.geometry == b.geometry && a.is_opaque == b.is_opaque;
}

// List after list, each behind the last one of the list before.
std::vector<EnteredItem> all_entries(const PkdTree& tree, const Ray& ray, const ItemOpacity& opacity,
                                     std::size_t& lists) {
  std::vector<EnteredItem> entries;
  for (EnteredItem behind;; behind = entries.back()) {
    NearestEntries list(behind);
    kernels::pkd_nearest_entries(tree, ray, 1.0, 0, opacity, list);
    entries.insert(entries.end(), list.begin(), list.end());
    ++lists;
    if (!list.goes_on()) return entries;
  }
}

struct Counts {
  std::size_t most_layers = 0;
  std::size_t opaque_rays = 0;
  std::size_t dimmed_rays = 0;
};

void expect_brute_force(const TreeCase& c, const Opacities& opacities, std::size_t rays, Counts& counts) {
  const TestTree test_tree(c);
  const PkdTree& tree = test_tree.tree();
  CounterRandom random(c.seed + 99);
  std::vector<Ray> all = make_rays(test_tree, rays, random);
  const std::vector<Ray> limited = limit_rays(tree, all);
  all.insert(all.end(), limited.begin(), limited.end());
  const ItemOpacity opacity = opacities.get();
  for_each_simd_target([&](const char* target) {
    for (const Ray& ray : all) {
      const std::vector<EnteredItem> expected = kernels::reference_entries(tree, ray, opacity);
      std::size_t lists = 0;
      const std::vector<EnteredItem> found = all_entries(tree, ray, opacity, lists);
      ASSERT_EQ(found.size(), expected.size()) << c << ' ' << target;
      for (std::size_t i = 0; i < found.size(); ++i) ASSERT_TRUE(is_same(found[i], expected[i])) << c << ' ' << target;
      // A full list may be the last one: one more says so.
      ASSERT_LE(lists, expected.size() / NearestEntries::most + 1) << c;
      counts.most_layers = std::max(counts.most_layers, found.size());

      const OpticalDepth sum = kernels::reference_optical_depth(tree, ray, opacity);
      const OpticalDepth depth = kernels::pkd_optical_depth(tree, ray, opacity, 0);
      if (sum >= kernels::opaque_depth) {
        ASSERT_GE(depth, kernels::opaque_depth) << c << ' ' << target;
        ++counts.opaque_rays;
      } else {
        ASSERT_EQ(depth, sum) << c << ' ' << target;
        counts.dimmed_rays += sum > 0 ? 1 : 0;
      }
    }
  });
}

class EveryTransparentLayout : public ::testing::TestWithParam<Layout> {};

TEST_P(EveryTransparentLayout, IsThatOfBruteForce) {
  Counts counts;
  std::uint64_t seed = 7000;
  for (const std::uint64_t count : {0, 1, 31, 33, 100, 700}) {
    for (const Order order : all_orders) {
      for (const Radii radii : all_radii) {
        TreeCase c;
        c.count = count;
        c.layout = GetParam();
        c.order = order;
        c.radii = radii;
        c.shape = all_shapes[seed % all_shapes.size()];
        c.larger_id_first = seed % 3 == 0 && order != Order::placed;
        c.thickness = seed % 2 == 0 ? 1.0 : 5.0;
        c.seed = ++seed;
        expect_brute_force(c, Opacities{}, 12, counts);
      }
    }
  }
  EXPECT_GT(counts.most_layers, NearestEntries::most);
  EXPECT_GT(counts.opaque_rays, 100u);
  EXPECT_GT(counts.dimmed_rays, 100u);
}

INSTANTIATE_TEST_SUITE_P(Layouts, EveryTransparentLayout, ::testing::ValuesIn(all_layouts),
                         [](const auto& info) { return std::string(name_of(info.param)); });

// Hundreds of layers, many of them at exactly the same distance.
TEST(Transparent, MoreLayersThanAListHolds) {
  for (const Shape shape : {Shape::uniform, Shape::coincident, Shape::coincident_groups, Shape::collinear}) {
    for (const Order order : all_orders) {
      Counts counts;
      TreeCase c;
      c.count = 600;
      c.shape = shape;
      c.order = order;
      c.thickness = 6.0;
      c.larger_id_first = order != Order::placed;
      c.seed = 7500;
      expect_brute_force(c, Opacities{1, 0, 0.01}, 24, counts);
      EXPECT_GT(counts.most_layers, 3 * NearestEntries::most) << c;
      EXPECT_GT(counts.dimmed_rays, 10u) << c;
    }
  }
}

// Distances in other units than those of the tree: as with integer positions.
TEST(Transparent, DistancesAreScaled) {
  TreeCase c;
  c.count = 500;
  c.thickness = 6.0;
  c.seed = 7600;
  const TestTree tree(c);
  CounterRandom random(7601);
  const Opacities opacities{0, 0, 0.01};
  std::size_t layers = 0;
  for (const double scale : {0.37, 3.0, 1e-7}) {
    for (const Ray& ray : make_rays(tree, 48, random)) {
      const std::vector<EnteredItem> expected = kernels::reference_entries(tree.tree(), ray, opacities.get());
      std::vector<EnteredItem> found;
      for (EnteredItem behind;; behind = found.back()) {
        NearestEntries list(behind);
        kernels::pkd_nearest_entries(tree.tree(), ray, scale, 3, opacities.get(), list);
        found.insert(found.end(), list.begin(), list.end());
        if (!list.goes_on()) break;
      }
      ASSERT_EQ(found.size(), expected.size()) << scale;
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].t, expected[i].t * scale);
        EXPECT_EQ(found[i].geometry, 3u);
      }
      layers = std::max(layers, found.size());
    }
  }
  EXPECT_GT(layers, NearestEntries::most);
}

TEST(NearestEntries, DoNotDependOnTheOrderOfOffers) {
  const auto smaller = [](std::uint64_t a, std::uint64_t b) { return a < b; };
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CounterRandom random(seed);
    std::vector<EnteredItem> offers(random.below(120));
    for (std::uint64_t i = 0; i < offers.size(); ++i)
      offers[i] = {static_cast<double>(random.below(20)), i, static_cast<std::uint32_t>(random.below(3)),
                   random.below(40) == 0};
    std::vector<EnteredItem> expected = offers;
    const auto before = [](const EnteredItem& a, const EnteredItem& b) {
      return std::tie(a.t, a.geometry, a.item) < std::tie(b.t, b.geometry, b.item);
    };
    std::sort(expected.begin(), expected.end(), before);
    const EnteredItem behind =
        expected.empty() || seed % 2 == 0 ? EnteredItem{} : expected[random.below(expected.size())];
    std::erase_if(expected,
                  [&](const EnteredItem& e) { return !before(behind, e) && behind.item != kernels::no_item; });
    const auto end = std::find_if(expected.begin(), expected.end(), [](const EnteredItem& e) { return e.is_opaque; });
    if (end != expected.end()) expected.erase(end + 1, expected.end());
    if (expected.size() > NearestEntries::most) expected.resize(NearestEntries::most);
    for (int round = 0; round < 4; ++round) {
      NearestEntries list(behind);
      // Some come twice.
      for (std::size_t i = 0; i < 2 * offers.size(); ++i) {
        const EnteredItem& offer = i < offers.size() ? offers[i] : offers[random.below(offers.size())];
        list.add(offer, smaller);
      }
      ASSERT_EQ(list.size(), expected.size()) << seed;
      for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_TRUE(is_same(list.begin()[i], expected[i])) << seed;
      for (std::size_t i = offers.size(); i > 1; --i) std::swap(offers[i - 1], offers[random.below(i)]);
    }
  }
}

TEST(OpticalDepth, AddsUpToTheProductOfWhatPasses) {
  EXPECT_EQ(kernels::optical_depth(0.0f), 0u);
  EXPECT_EQ(kernels::optical_depth(1.0f), kernels::opaque_depth);
  EXPECT_EQ(kernels::optical_depth(0.9999f), kernels::opaque_depth);
  EXPECT_EQ(kernels::transmittance(0), 1.0);
  EXPECT_EQ(kernels::transmittance(kernels::opaque_depth), 0.0);
  EXPECT_NEAR(kernels::transmittance(kernels::opaque_depth - 1), 1.0 / 1024.0, 1e-12);
  CounterRandom random(1);
  for (int i = 0; i < 1000; ++i) {
    OpticalDepth sum = 0;
    double product = 1.0;
    for (int k = 0; k < 5; ++k) {
      const auto opacity = static_cast<float>(random.magnitude(-6.0, -0.2));
      sum += kernels::optical_depth(opacity);
      product *= 1.0 - static_cast<double>(opacity);
    }
    if (product < 1.0 / 1000.0) continue;
    EXPECT_NEAR(kernels::transmittance(sum), product, 1e-9);
  }
}

}  // namespace
}  // namespace insitu::testing
