// A few large particles among many small ones, traced apart: the same hits as sphere by sphere.
#include "geometry/particles/size_classes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geometry/particles/particles.h"
#include "kernels/sphere.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/counter_random.h"

namespace insitu::testing {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class T>
struct Grains {
  std::vector<T> x;
  std::vector<T> radius;
  std::vector<double> value;

  // Every hundredth is `factor` times as large.
  Grains(std::size_t count, double factor, std::uint64_t seed) {
    CounterRandom random(seed);
    const double small = 0.3 / std::cbrt(static_cast<double>(count));
    for (std::size_t i = 0; i < count; ++i) {
      for (int c = 0; c < 3; ++c) x.push_back(static_cast<T>(random.unit()));
      radius.push_back(static_cast<T>(small * (i % 100 == 0 ? factor : random.between(0.5, 1.0))));
      value.push_back(random.unit());
    }
  }
  ParticleArrays arrays(double treelet_share) {
    ParticleArrays arrays;
    arrays.position = positions_of(x);
    arrays.radius = view_of(radius, 1, INSITU_USE_RADIUS);
    arrays.attributes.push_back({"value", attribute_of(value)});
    arrays.treelet_share = treelet_share;
    return arrays;
  }
};

template <class T>
double nearest(const Grains<T>& grains, const kernels::Ray& ray, double most_value) {
  double t = infinity;
  for (std::size_t i = 0; i < grains.radius.size(); ++i) {
    if (grains.value[i] > most_value) continue;
    const double centre[3] = {static_cast<double>(grains.x[3 * i]), static_cast<double>(grains.x[3 * i + 1]),
                              static_cast<double>(grains.x[3 * i + 2])};
    const double hit =
        kernels::sphere_first_hit(ray.origin, ray.direction, centre, static_cast<double>(grains.radius[i]), ray.t_min);
    if (hit <= ray.t_max) t = std::min(t, hit);
  }
  return t;
}

std::vector<kernels::Ray> some_rays() {
  std::vector<kernels::Ray> rays(200);
  CounterRandom random(4);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    random.direction(rays[i].direction);
    for (int c = 0; c < 3; ++c) rays[i].origin[c] = random.unit() - (i % 2 == 0 ? 2.0 * rays[i].direction[c] : 0.0);
    if (i % 5 == 0) rays[i].t_max = 0.4;
  }
  return rays;
}

template <class T>
void expect_nearest(const Grains<T>& grains, const Particles& particles, double most_value) {
  const std::vector<kernels::Ray> rays = some_rays();
  std::vector<kernels::Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size(), 0);
  particles.first_hits(rays.data(), hits.data(), rays.size());
  particles.any_hits(rays.data(), occluded.data(), rays.size());
  std::size_t large = 0;
  std::size_t small = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double expected = nearest(grains, rays[i], most_value);
    EXPECT_EQ(hits[i].t, expected) << i;
    EXPECT_EQ(hits[i].found(), expected != infinity);
    EXPECT_EQ(occluded[i] != 0, expected != infinity);
    if (hits[i].found()) ++(particles.radius(hits[i].item) > 0.05 ? large : small);
    kernels::Hit alone;
    particles.first_hits(&rays[i], &alone, 1);
    EXPECT_EQ(alone.t, expected) << i;
  }
  EXPECT_GT(large, 10u);
  EXPECT_GT(small, 10u);
}

TEST(SizeClasses, AreHitAsSphereBySphere) {
  for (const ParticleOrder order : {ParticleOrder::index, ParticleOrder::permute, ParticleOrder::copy}) {
    Grains<float> grains(20000, 10.0, 1);
    Budget budget(0);
    Particles particles("grains", order, false);
    particles.bind(grains.arrays(0.15));
    particles.build(budget);
    ASSERT_TRUE(particles.has_size_classes());
    EXPECT_GT(particles.treelet_count(), 0u);
    EXPECT_LE(particles.treelet_bytes(), 20000u * 12 * 0.15);
    expect_nearest(grains, particles, 1.0);
  }
  Grains<double> grains(20000, 10.0, 2);
  Budget budget(0);
  Particles particles("grains", ParticleOrder::permute, false);
  particles.bind(grains.arrays(0.15));
  particles.build(budget);
  ASSERT_TRUE(particles.has_size_classes());
  expect_nearest(grains, particles, 1.0);
}

TEST(SizeClasses, AreFiltered) {
  Grains<float> grains(20000, 10.0, 3);
  Budget budget(0);
  Particles particles("grains", ParticleOrder::permute, false);
  particles.bind(grains.arrays(0.15));
  particles.build(budget);
  for (const double most : {0.5, 1.0}) {
    std::vector<FilterTerm> terms(1);
    terms[0].attribute = "value";
    terms[0].range[0] = 0.0;
    terms[0].range[1] = most;
    particles.set_filter(std::make_shared<const Filter>(std::move(terms)));
    particles.select(budget);
    EXPECT_TRUE(particles.has_size_classes());
    expect_nearest(grains, particles, most);
  }
}

// Both are met at exactly the same distance: the rule for all particles decides, not the class.
TEST(SizeClasses, ShareTheRuleForEqualDistances) {
  for (const bool large_first : {false, true}) {
    Grains<double> grains(20000, 10.0, 4);
    for (double& x : grains.x) x += 8.0;  // out of the way
    const std::size_t large = 100;
    const std::size_t small = 101;
    grains.radius[large] = 0.25;
    grains.radius[small] = 0.0078125;
    // The ray goes along z, and meets both at z = 8: the preferred one has the smaller x.
    const double centres[2][3] = {{8.0, 8.0, 8.25}, {8.0, 8.0, 8.0078125}};
    std::copy_n(centres[0], 3, &grains.x[3 * large]);
    std::copy_n(centres[1], 3, &grains.x[3 * small]);
    kernels::Ray ray = {{8.0, 8.0, 4.0}, {0.0, 0.0, 1.0}};
    if (large_first) {
      // The other way round: both end at z = 8, and the ray comes from above.
      grains.x[3 * large + 2] = 7.75;
      grains.x[3 * small + 2] = 7.9921875;
      ray = {{8.0, 8.0, 12.0}, {0.0, 0.0, -1.0}};
    }
    // Nothing else stands there.
    for (std::size_t i = 0; i < grains.radius.size(); ++i) {
      if (i == large || i == small) continue;
      const double dx = grains.x[3 * i] - 8.0;
      const double dy = grains.x[3 * i + 1] - 8.0;
      if (std::hypot(dx, dy) <= grains.radius[i]) grains.x[3 * i] += 0.5;
    }
    Budget budget(0);
    Particles particles("grains", ParticleOrder::index, false);
    particles.bind(grains.arrays(0.15));
    particles.build(budget);
    ASSERT_TRUE(particles.has_size_classes());
    const std::vector<kernels::Ray> rays(8, ray);
    std::vector<kernels::Hit> hits(8);
    particles.first_hits(rays.data(), hits.data(), 8);
    for (const kernels::Hit& hit : hits) {
      EXPECT_EQ(hit.t, 4.0);
      EXPECT_EQ(hit.item, large_first ? large : small);  // the smaller z
    }
  }
}

TEST(SizeClasses, AreMadeWhereTheyHelpAndFit) {
  const auto has_classes = [](double factor, double share) {
    Grains<float> grains(20000, factor, 5);
    Budget budget(0);
    Particles particles("grains", ParticleOrder::permute, false);
    particles.bind(grains.arrays(share));
    particles.build(budget);
    return particles.has_size_classes();
  };
  EXPECT_TRUE(has_classes(10.0, 0.15));
  EXPECT_FALSE(has_classes(1.0, 0.15));
  EXPECT_FALSE(has_classes(10.0, 0.02));
  EXPECT_FALSE(has_classes(10.0, 0.0));
}

}  // namespace
}  // namespace insitu::testing
