// The sphere test against quadruple precision: how far off distances and normals may be, and that no hit is lost.
//
// With u = 2^-53, the distance |f| of the ray's start from the centre, the radius r and half the chord s, rounding
// moves the line of the ray by a few u |f|, and with it the hit by a few u |f| (1 + r / s): grazing hits are less
// certain along the ray, though not across the surface.
#include "kernels/sphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "unit/kernels/counter_random.h"
#include "unit/kernels/quad_sphere.h"

namespace insitu::testing {
namespace {

constexpr double u = 0x1p-53;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Shot {
  double origin[3];
  double direction[3];
  double centre[3];
  double radius;
};

// A ray that passes the centre at `off` radii, from `distance` away.
Shot make_shot(CounterRandom& random, double radius, double distance, double off, double offset) {
  Shot shot{};
  shot.radius = radius;
  random.direction(shot.direction);
  double other[3];
  random.direction(other);
  const double along = other[0] * shot.direction[0] + other[1] * shot.direction[1] + other[2] * shot.direction[2];
  double side[3];
  double length = 0.0;
  for (int c = 0; c < 3; ++c) {
    side[c] = other[c] - along * shot.direction[c];
    length += side[c] * side[c];
  }
  length = std::max(std::sqrt(length), 1e-3);
  for (int c = 0; c < 3; ++c) {
    shot.centre[c] = offset * random.between(-1.0, 1.0);
    shot.origin[c] = shot.centre[c] + off * radius * side[c] / length - distance * shot.direction[c];
  }
  return shot;
}

Shot random_shot(std::uint64_t seed) {
  CounterRandom random(seed);
  const double radius = random.magnitude(-6.0, 6.0);
  const double distance = radius * (seed % 4 == 0 ? random.between(0.0, 0.9) : random.magnitude(0.1, 7.0));
  const double off = seed % 3 == 0 ? 1.0 + random.sign() * random.magnitude(-15.0, -2.0) : random.between(0.0, 0.999);
  const double offset = seed % 2 == 0 ? 0.0 : random.magnitude(-3.0, 7.0);
  return make_shot(random, radius, distance, off, offset);
}

double as_double(Quad q) { return static_cast<double>(q); }

TEST(Sphere, DistancesAreWithinTheirBound) {
  double worst = 0.0;
  std::uint64_t hits = 0;
  for (std::uint64_t seed = 0; seed < 200000; ++seed) {
    const Shot shot = random_shot(seed);
    const QuadSphereHit truth = quad_sphere(shot.origin, shot.direction, shot.centre, shot.radius);
    const kernels::SphereRoots roots = kernels::sphere_roots(shot.origin, shot.direction, shot.centre, shot.radius);
    if (!roots.hit || !truth.hit) continue;
    ++hits;
    const double reach = as_double(truth.distance) + shot.radius;
    // Nearer to the tangent than the line itself is certain, r / s has no meaning any more: the chord of that much.
    const double chord =
        std::max(as_double(truth.half_chord), std::sqrt(2.0 * shot.radius * std::min(16.0 * u * reach, shot.radius)));
    const double bound = u * reach * (1.0 + shot.radius / chord);
    const double error = std::max(std::abs(as_double(Quad(roots.enter) - truth.enter)),
                                  std::abs(as_double(Quad(roots.leave) - truth.leave)));
    worst = std::max(worst, error / bound);
    ASSERT_LE(error, 16.0 * bound) << "seed " << seed;
  }
  EXPECT_GT(hits, 150000u);
  std::cout << hits << " hits, largest error " << worst << " u (|f| + r) (1 + r/s)\n";
}

TEST(Sphere, HitsLieOnTheSurface) {
  double worst = 0.0;
  for (std::uint64_t seed = 0; seed < 200000; ++seed) {
    const Shot shot = random_shot(seed);
    const kernels::SphereRoots roots = kernels::sphere_roots(shot.origin, shot.direction, shot.centre, shot.radius);
    if (!roots.hit) continue;
    const QuadVector f = QuadVector::of(shot.origin) - QuadVector::of(shot.centre);
    const Quad reach = length(f) + Quad(shot.radius);
    for (const double t : {roots.enter, roots.leave}) {
      const Quad off = length(f + Quad(t) * QuadVector::of(shot.direction)) - Quad(shot.radius);
      const double error = std::abs(as_double(off / reach)) / u;
      worst = std::max(worst, error);
      ASSERT_LE(error, 16.0) << "seed " << seed;
    }
  }
  std::cout << "hits are at most " << worst << " u (|f| + r) off the surface\n";
}

// Only rays that pass the rim nearer than rounding can tell may be judged differently.
TEST(Sphere, NoHitIsLostOutsideOfTheBand) {
  std::uint64_t within = 0;
  std::uint64_t wrong_within = 0;
  for (std::uint64_t seed = 0; seed < 200000; ++seed) {
    CounterRandom random(seed + 5000000);
    const double radius = random.magnitude(-6.0, 6.0);
    const Shot shot = make_shot(random, radius, radius * random.magnitude(0.0, 8.0),
                                1.0 + random.sign() * random.magnitude(-17.0, -4.0), 0.0);
    const QuadSphereHit truth = quad_sphere(shot.origin, shot.direction, shot.centre, shot.radius);
    const bool hit = kernels::sphere_roots(shot.origin, shot.direction, shot.centre, shot.radius).hit;
    const double band = 16.0 * u * (as_double(truth.distance) + radius);
    const bool uncertain = std::abs(as_double(truth.offset - Quad(radius))) <= band;
    within += uncertain ? 1 : 0;
    if (hit == truth.hit) continue;
    wrong_within += uncertain ? 1 : 0;
    ASSERT_TRUE(uncertain) << "seed " << seed;
  }
  EXPECT_GT(within, 1000u);
  std::cout << within << " rays within the band, " << wrong_within << " of them judged differently, 0 outside of it\n";
}

TEST(Sphere, NormalsAreWithinTheirBound) {
  double worst = 0.0;
  for (std::uint64_t seed = 0; seed < 100000; ++seed) {
    const Shot shot = random_shot(seed);
    const QuadSphereHit truth = quad_sphere(shot.origin, shot.direction, shot.centre, shot.radius);
    const double t = kernels::sphere_first_hit(shot.origin, shot.direction, shot.centre, shot.radius, 0.0);
    // Grazing hits move along the surface: their normals are those of other points, and judged by those points.
    if (!truth.hit || t == infinity || as_double(truth.half_chord) < 0.1 * shot.radius) continue;
    const Quad true_t = truth.enter > 0 ? truth.enter : truth.leave;
    const QuadVector f = QuadVector::of(shot.origin) - QuadVector::of(shot.centre);
    const QuadVector normal = (Quad(1) / Quad(shot.radius)) * (f + true_t * QuadVector::of(shot.direction));
    // As the renderer computes it: from the point in space.
    double computed[3];
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double point = shot.origin[c] + t * shot.direction[c];
      largest = std::max({largest, std::abs(point), std::abs(shot.origin[c]), std::abs(shot.centre[c])});
      computed[c] = (point - shot.centre[c]) / shot.radius;
    }
    const double error = as_double(length(QuadVector::of(computed) - normal));
    const double bound = u * (largest + t + shot.radius) / shot.radius;
    worst = std::max(worst, error / bound);
    ASSERT_LE(error, 64.0 * bound) << "seed " << seed;
  }
  std::cout << "largest error of a normal: " << worst << " u (largest coordinate + t + r) / r\n";
}

// The distance that the renderer lets secondary rays start at (libinsitu/renderer/tile.cpp): 32 roundings of the
// largest number that went into the point.
double renderer_t_min(const Shot& shot, const double point[3], double t) {
  double largest = std::max(t, shot.radius);
  for (int c = 0; c < 3; ++c)
    largest = std::max({largest, std::abs(point[c]), std::abs(shot.origin[c]), std::abs(shot.centre[c])});
  return 32.0 * 2.0 * u * largest;
}

// A ray that leaves a hit outward meets neither the sphere nor a twin at the same place. A point that rounding put
// below the surface is left after that depth divided by the cosine: this holds for directions up to 75 degrees from the
// normal.
TEST(Sphere, LeavingRaysDoNotHitAgain) {
  std::uint64_t checked = 0;
  std::uint64_t hit_again = 0;
  for (std::uint64_t seed = 0; seed < 200000; ++seed) {
    const Shot shot = random_shot(seed);
    const double t = kernels::sphere_first_hit(shot.origin, shot.direction, shot.centre, shot.radius, 0.0);
    const double inside =
        std::hypot(shot.origin[0] - shot.centre[0], shot.origin[1] - shot.centre[1], shot.origin[2] - shot.centre[2]);
    if (t == infinity || inside <= shot.radius) continue;
    double point[3];
    double normal[3];
    for (int c = 0; c < 3; ++c) {
      point[c] = shot.origin[c] + t * shot.direction[c];
      normal[c] = (point[c] - shot.centre[c]) / shot.radius;
    }
    // Spheres that the coordinates barely resolve have no outside to leave to.
    const double t_min = renderer_t_min(shot, point, t);
    if (t_min > 1e-4 * shot.radius) continue;
    CounterRandom random(seed + 9000000);
    double away[3];
    random.direction(away);
    const double cosine = away[0] * normal[0] + away[1] * normal[1] + away[2] * normal[2];
    if (std::abs(cosine) < 0.25) continue;
    for (double& a : away) a = std::copysign(1.0, cosine) * a;
    ++checked;
    hit_again += kernels::sphere_first_hit(point, away, shot.centre, shot.radius, t_min) != infinity ? 1 : 0;
  }
  EXPECT_GT(checked, 50000u);
  EXPECT_EQ(hit_again, 0u) << "of " << checked;
}

TEST(Sphere, LimitsAreOpenBelow) {
  const double origin[3] = {-5.0, 0.0, 0.0};
  const double direction[3] = {1.0, 0.0, 0.0};
  const double centre[3] = {0.0, 0.0, 0.0};
  EXPECT_EQ(kernels::sphere_first_hit(origin, direction, centre, 1.0, 0.0), 4.0);
  EXPECT_EQ(kernels::sphere_first_hit(origin, direction, centre, 1.0, 4.0), 6.0);
  EXPECT_EQ(kernels::sphere_first_hit(origin, direction, centre, 1.0, std::nextafter(4.0, 0.0)), 4.0);
  EXPECT_EQ(kernels::sphere_first_hit(origin, direction, centre, 1.0, 6.0), infinity);
  EXPECT_EQ(kernels::sphere_first_hit(origin, direction, centre, 1.0, -100.0), 4.0);
}

TEST(Sphere, NothingMeetsNaN) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double good[3] = {0.0, 0.0, 0.0};
  const double along[3] = {0.0, 0.0, 1.0};
  const double bad[3] = {nan, 0.0, 0.0};
  EXPECT_FALSE(kernels::sphere_roots(bad, along, good, 1.0).hit);
  EXPECT_FALSE(kernels::sphere_roots(good, bad, good, 1.0).hit);
  EXPECT_FALSE(kernels::sphere_roots(good, along, bad, 1.0).hit);
  EXPECT_FALSE(kernels::sphere_roots(good, along, good, nan).hit);
}

}  // namespace
}  // namespace insitu::testing
