// The tree gives the hits of the brute force, to the last bit, for every layout, order, kind of radius and shape.
#include "kernels/pkd_traverse.h"

#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

#include "geometry/particles/particle_scan.h"
#include "geometry/pkd/pkd_build.h"
#include "kernels/pkd_reference.h"
#include "unit/kernels/hit_check.h"

namespace insitu::testing {
namespace {

std::string text_of(const TreeCase& c) {
  std::ostringstream out;
  out << c;
  return out.str();
}

HitCounts check(const TreeCase& c, std::size_t ray_count, std::size_t all_hits_every = 2) {
  const TestTree tree(c);
  EXPECT_EQ(tree.count(), c.count) << c;
  EXPECT_EQ(kernels::find_broken_invariant(tree.tree()), kernels::no_item) << c;
  CounterRandom random(c.seed + 77);
  std::vector<kernels::Ray> rays = make_rays(tree, ray_count, random);
  const HitCounts counts = expect_brute_force_hits(tree.tree(), rays, all_hits_every, text_of(c));
  expect_brute_force_hits(tree.tree(), limit_rays(tree.tree(), rays), all_hits_every, text_of(c) + ", limited");
  return counts;
}

class EveryLayout : public ::testing::TestWithParam<Layout> {};

// All combinations of size, order and kind of radius; the shapes take turns.
TEST_P(EveryLayout, SmallTrees) {
  HitCounts sum;
  std::uint64_t seed = 0;
  for (const std::uint64_t count : {0, 1, 2, 3, 31, 32, 33, 63, 64, 65, 100}) {
    for (const Order order : all_orders) {
      for (const Radii radii : all_radii) {
        TreeCase c;
        c.count = count;
        c.layout = GetParam();
        c.order = order;
        c.radii = radii;
        c.shape = all_shapes[seed % all_shapes.size()];
        // Placed particles are known by their places, which the build changes: no rule for it to follow.
        c.larger_id_first = seed % 3 == 0 && order != Order::placed;
        c.seed = ++seed;
        const HitCounts counts = check(c, 24);
        sum.rays += counts.rays;
        sum.hits += counts.hits;
      }
    }
  }
  // Rays that all miss would prove nothing.
  EXPECT_GT(sum.hits, sum.rays / 4);
  EXPECT_LT(sum.hits, sum.rays);
}

// Every shape with every kind of radius, thin and thick.
TEST_P(EveryLayout, Shapes) {
  std::uint64_t seed = 1000;
  for (const Shape shape : all_shapes) {
    for (const Radii radii : all_radii) {
      for (const double thickness : {0.1, 1.0, 4.0}) {
        TreeCase c;
        c.count = 1000;
        c.layout = GetParam();
        c.order = all_orders[seed % all_orders.size()];
        c.shape = shape;
        c.radii = radii;
        c.thickness = thickness;
        c.seed = ++seed;
        check(c, 24, 4);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, EveryLayout, ::testing::ValuesIn(all_layouts),
                         [](const auto& info) { return std::string(name_of(info.param)); });

class EveryShape : public ::testing::TestWithParam<Shape> {};

TEST_P(EveryShape, LargeTrees) {
  std::uint64_t seed = 2000;
  for (const auto& [count, rays] : {std::pair{10000u, 48u}, std::pair{100000u, 12u}}) {
    for (const Layout layout : {Layout::records_f32, Layout::columns_f64}) {
      TreeCase c;
      c.count = count;
      c.layout = layout;
      c.shape = GetParam();
      c.order = all_orders[seed % 2];
      c.radii = all_radii[seed % 3];
      c.thickness = 2.0;
      c.seed = ++seed;
      check(c, rays, 8);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, ::testing::ValuesIn(all_shapes),
                         [](const auto& info) { return std::string(name_of(info.param)); });

class EveryMagnitude : public ::testing::TestWithParam<int> {};

// Scenes of 10^exponent length units, around the origin and far from it, with both float types.
TEST_P(EveryMagnitude, OfTheScene) {
  const double size = std::pow(10.0, GetParam());
  std::uint64_t seed = 3000;
  for (const double offset : {0.0, 10.0 * size, 1e4 * size, 1e7}) {
    for (const Layout layout : {Layout::records_f32, Layout::strided_f32, Layout::columns_f64}) {
      for (const Shape shape : {Shape::uniform, Shape::clustered, Shape::grid}) {
        TreeCase c;
        c.count = 500;
        c.size = size;
        c.offset = offset;
        c.layout = layout;
        c.shape = shape;
        c.order = all_orders[seed % all_orders.size()];
        c.radii = all_radii[seed % 3];
        c.seed = ++seed;
        check(c, 24, 4);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(PowerOfTen, EveryMagnitude, ::testing::Values(-30, -12, -6, -3, 0, 3, 6, 12, 30),
                         [](const auto& info) {
                           return (info.param < 0 ? "minus_" : "plus_") + std::to_string(std::abs(info.param));
                         });

// Rays as a camera sends them, and as many more as fill streams of occlusion rays: they share their way through the
// tree.
class RaysTogether : public ::testing::TestWithParam<Shape> {};

TEST_P(RaysTogether, FromACamera) {
  std::uint64_t seed = 5000;
  for (const double distance : {0.0, 0.3, 2.0, 100.0}) {
    for (const Layout layout : {Layout::records_f32, Layout::columns_f32, Layout::records_f64, Layout::rows_f64}) {
      TreeCase c;
      c.count = 2000;
      c.shape = GetParam();
      c.layout = layout;
      c.order = all_orders[seed % all_orders.size()];
      c.radii = all_radii[seed % 3];
      c.offset = seed % 2 == 0 ? 0.0 : 3.0;
      c.seed = ++seed;
      const TestTree tree(c);
      CounterRandom random(seed);
      double ahead[3];
      random.direction(ahead);
      double aim[3];
      tree.tree().centre(0, aim);
      // A picture of 24 x 24 pixels, as wide as the cloud is from there; every fourth has limits of its own.
      const double spread = 1.5 / (1.0 + 24.0 * distance);
      std::vector<kernels::Ray> rays;
      for (int pixel = 0; pixel < 24 * 24; ++pixel) {
        kernels::Ray ray{};
        const double off[3] = {pixel % 24 - 11.5, pixel / 24 - 11.5, 0.5 * (pixel % 24) - 6.0};
        double length = 0.0;
        for (int k = 0; k < 3; ++k) {
          ray.origin[k] = aim[k] - distance * ahead[k];
          ray.direction[k] = ahead[k] + spread * off[k] / 12.0;
          length += ray.direction[k] * ray.direction[k];
        }
        for (double& d : ray.direction) d /= std::sqrt(length);
        if (pixel % 16 == 0) ray.t_min = random.unit() * distance;
        if (pixel % 4 == 0) ray.t_max = std::max(ray.t_min, distance + random.between(-0.5, 0.5));
        rays.push_back(ray);
      }
      expect_brute_force_hits(tree.tree(), rays, 64, text_of(c) + ", camera");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, RaysTogether, ::testing::ValuesIn(all_shapes),
                         [](const auto& info) { return std::string(name_of(info.param)); });

// More occlusion rays than one stream holds, some of them occluded already.
TEST(Traverse, LongStreams) {
  TreeCase c;
  c.count = 3000;
  c.shape = Shape::clustered;
  c.radii = Radii::per_item;
  const TestTree tree(c);
  CounterRandom random(6000);
  const std::vector<kernels::Ray> rays = make_rays(tree, 10000, random);
  std::vector<std::uint8_t> alone(rays.size(), 0);
  for (std::size_t i = 0; i < rays.size(); ++i) kernels::pkd_any_hits(tree.tree(), &rays[i], &alone[i], 1);
  std::vector<std::uint8_t> together(rays.size(), 0);
  for (std::size_t i = 0; i < rays.size(); i += 3) together[i] = 2;
  kernels::pkd_any_hits(tree.tree(), rays.data(), together.data(), rays.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) wrong += together[i] != (i % 3 == 0 ? 2 : alone[i]) ? 1 : 0;
  EXPECT_EQ(wrong, 0u);
}

// A tree over arrays of the caller through `index`, in f64 or f32.
kernels::PkdTree make_indexed_tree(bool f32, const std::vector<double>& wide, const std::vector<float>& narrow,
                                   const std::vector<double>& radius, std::vector<std::uint32_t>& index) {
  kernels::PkdTree tree;
  kernels::ArrayView& position = tree.position;
  position.type = f32 ? kernels::Scalar::f32 : kernels::Scalar::f64;
  position.count = tree.count = radius.size();
  position.components = 3;
  const std::size_t size = kernels::size_of(position.type);
  position.stride = static_cast<std::ptrdiff_t>(3 * size);
  const auto* first =
      f32 ? reinterpret_cast<const std::byte*>(narrow.data()) : reinterpret_cast<const std::byte*>(wide.data());
  for (std::size_t c = 0; c < 3; ++c) position.base[c] = first + c * size;
  tree.radius.kind = kernels::RadiusView::Kind::per_item;
  tree.radius.array.base[0] = reinterpret_cast<const std::byte*>(radius.data());
  tree.radius.array.stride = sizeof(double);
  tree.radius.array.type = kernels::Scalar::f64;
  tree.radius.array.count = radius.size();
  const ScanResult scan = scan_particles(tree, true);
  std::copy_n(scan.lower, 3, tree.lower);
  std::copy_n(scan.upper, 3, tree.upper);
  tree.radius_max = scan.radius_max;
  tree.index32 = index.data();
  tree.position_by_place = false;
  build_index(tree, index.data());
  return tree;
}

// Radii from 1e-8 to 1e3 in one cloud: the largest widens every split plane, the smallest must still be found.
TEST(Traverse, RadiiOfElevenOrdersOfMagnitude) {
  constexpr std::uint64_t count = 400;
  CounterRandom random(5);
  std::vector<double> x = make_cloud(Shape::uniform, count, 1e3, random);
  std::vector<double> radius(count);
  for (double& r : radius) r = random.magnitude(-8.0, 1.0);
  radius[7] = 1e3;
  std::vector<float> narrow(x.begin(), x.end());
  for (const bool f32 : {false, true}) {
    std::vector<std::uint32_t> index(count);
    for (std::uint32_t i = 0; i < count; ++i) index[i] = i;
    kernels::PkdTree tree = make_indexed_tree(f32, x, narrow, radius, index);
    std::vector<kernels::Ray> rays;
    for (std::uint64_t i = 0; i < count; ++i) {
      // From a place near the small particle, so that the large ones do not hide it.
      kernels::Ray ray{};
      random.direction(ray.direction);
      const double distance = radius[i] * random.magnitude(0.1, 3.0);
      for (std::uint64_t c = 0; c < 3; ++c)
        ray.origin[c] = tree.position.value(i, static_cast<std::uint32_t>(c)) - distance * ray.direction[c];
      rays.push_back(ray);
      ray.t_max = distance;
      rays.push_back(ray);
    }
    expect_brute_force_hits(tree, rays, 4, f32 ? "f32" : "f64");
  }
}

// Hits of several trees, one after another: the nearer one stays, and of equal ones the first.
TEST(Traverse, KeepsNearerHitsOfOtherTrees) {
  TreeCase c;
  c.count = 300;
  c.seed = 11;
  const TestTree tree(c);
  CounterRandom random(12);
  const std::vector<kernels::Ray> rays = make_rays(tree, 240, random);
  std::vector<kernels::Hit> alone(rays.size());
  kernels::pkd_first_hits(tree.tree(), rays.data(), alone.data(), rays.size());
  constexpr std::uint64_t other = 123456789;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!alone[i].found()) continue;
    ++compared;
    kernels::Hit nearer = {std::nextafter(alone[i].t, 0.0), other};
    kernels::Hit equal = {alone[i].t, other};
    kernels::Hit farther = {std::nextafter(alone[i].t, 1e30), other};
    for (kernels::Hit* hit : {&nearer, &equal, &farther}) kernels::pkd_first_hits(tree.tree(), &rays[i], hit, 1);
    EXPECT_EQ(nearer.item, other);
    EXPECT_EQ(equal.item, other);
    EXPECT_EQ(farther.item, alone[i].item);
    EXPECT_EQ(farther.t, alone[i].t);
  }
  EXPECT_GT(compared, 50u);
}

TEST(Traverse, LeavesOccludedRaysAlone) {
  TreeCase c;
  c.count = 10;
  const TestTree tree(c);
  kernels::Ray away{};
  away.origin[0] = 1e3;
  away.direction[0] = 1.0;
  std::uint8_t occluded = 7;
  kernels::pkd_any_hits(tree.tree(), &away, &occluded, 1);
  EXPECT_EQ(occluded, 7);
}

TEST(SimdTargets, AreNamedAndCanBeForced) {
  const std::vector<const char*> names = kernels::simd_target_names();
  ASSERT_FALSE(names.empty());
  for (const char* name : names) EXPECT_STRNE(name, "");
  EXPECT_FALSE(kernels::force_simd_target("abacus"));
  EXPECT_TRUE(kernels::force_simd_target(nullptr));
  std::string text;
  for (const char* name : names) text += std::string(" ") + name;
  std::cout << "SIMD targets:" << text << '\n';
}

}  // namespace
}  // namespace insitu::testing
