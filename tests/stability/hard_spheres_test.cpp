// Spheres in the cases that break others, against quadruple precision over every sphere: how many hits are missed, and
// how many are invented, beyond what rounding leaves open. Both must be none; the counts are printed.
//
// What rounding leaves open: the line of a ray is known to about u (|f| + r), with u = 2^-53 and the distance |f| of
// the start from the centre. A ray that passes the rim within 16 times that is uncertain, and judged either way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "geometry/particles/particles.h"
#include "kernels/pkd_traverse.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/counter_random.h"
#include "unit/kernels/quad_sphere.h"
#include "unit/kernels/simd_guard.h"

namespace insitu::testing {
namespace {

constexpr double u = 0x1p-53;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Spheres {
  std::vector<double> x;
  std::vector<double> radius;

  void add(const double centre[3], double r) {
    x.insert(x.end(), centre, centre + 3);
    radius.push_back(r);
  }
  std::size_t count() const { return radius.size(); }
  const double* centre(std::size_t i) const { return &x[3 * i]; }
};

struct Counts {
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;
  std::uint64_t uncertain = 0;  // rays that pass some rim too close to call, in front of everything certain
  std::uint64_t missed = 0;     // a certain hit is there, and none as near was found
  std::uint64_t invented = 0;   // what was found is no hit, or not at that distance
};

// What quadruple precision says of one ray.
struct Truth {
  double certain_t = infinity;  // nearest hit that no rounding can take away, with the room rounding may need
  bool uncertain = false;
};

// How far off the distance of a hit may be: see unit/kernels/sphere_test.cpp.
double room(const QuadSphereHit& hit, double radius) {
  const double reach = static_cast<double>(hit.distance) + radius;
  const double chord =
      std::max(static_cast<double>(hit.half_chord), std::sqrt(2.0 * radius * std::min(16.0 * u * reach, radius)));
  return 16.0 * u * reach * (1.0 + radius / chord);
}

double band(const QuadSphereHit& hit, double radius) { return 16.0 * u * (static_cast<double>(hit.distance) + radius); }

Truth truth_of(const Spheres& spheres, const kernels::Ray& ray) {
  Truth truth;
  double uncertain_t = infinity;
  for (std::size_t i = 0; i < spheres.count(); ++i) {
    const double r = spheres.radius[i];
    const QuadSphereHit hit = quad_sphere(ray.origin, ray.direction, spheres.centre(i), r);
    const double along = static_cast<double>(hit.enter);
    if (std::abs(static_cast<double>(hit.offset - Quad(r))) <= band(hit, r)) {
      // The point of the line nearest to the centre.
      const QuadVector f = QuadVector::of(ray.origin) - QuadVector::of(spheres.centre(i));
      const double nearest = static_cast<double>(-dot(f, QuadVector::of(ray.direction)));
      if (nearest > 0.0) uncertain_t = std::min(uncertain_t, nearest - room(hit, r));
      continue;
    }
    if (!hit.hit) continue;
    const double slack = room(hit, r);
    // Starts on the surface are left to rounding too.
    for (const double t : {along, static_cast<double>(hit.leave)}) {
      if (t <= slack) {
        if (t > -slack) uncertain_t = std::min(uncertain_t, 0.0);
        continue;
      }
      truth.certain_t = std::min(truth.certain_t, t + slack);
      break;
    }
  }
  truth.uncertain = uncertain_t < truth.certain_t;
  return truth;
}

bool is_invented(const Spheres& spheres, const kernels::Ray& ray, const kernels::Hit& found) {
  const double r = spheres.radius[found.item];
  const QuadSphereHit hit = quad_sphere(ray.origin, ray.direction, spheres.centre(found.item), r);
  if (static_cast<double>(hit.offset) > r + band(hit, r)) return true;
  if (!hit.hit) return false;
  const double off =
      std::min(std::abs(found.t - static_cast<double>(hit.enter)), std::abs(found.t - static_cast<double>(hit.leave)));
  return off > room(hit, r);
}

// Every SIMD target must give the same; the counts are those of the last.
Counts judge(const char* what, const Spheres& spheres, const std::vector<kernels::Ray>& rays) {
  Budget budget(0);
  ParticleArrays arrays;
  arrays.position = positions_of(spheres.x);
  arrays.radius = view_of(spheres.radius, 1, INSITU_USE_RADIUS);
  Particles particles(what, ParticleOrder::index, false);
  particles.bind(std::move(arrays));
  particles.build(budget);
  EXPECT_EQ(particles.drawn_count(), spheres.count()) << what;
  std::vector<Truth> truths;
  for (const kernels::Ray& ray : rays) truths.push_back(truth_of(spheres, ray));
  Counts counts;
  for_each_simd_target([&](const char* target) {
    counts = {};
    std::vector<kernels::Hit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size(), 0);
    particles.first_hits(rays.data(), hits.data(), rays.size());
    particles.any_hits(rays.data(), occluded.data(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ++counts.rays;
      counts.hits += hits[i].found() ? 1 : 0;
      counts.uncertain += truths[i].uncertain ? 1 : 0;
      counts.missed += truths[i].certain_t < infinity && !(hits[i].t <= truths[i].certain_t) ? 1 : 0;
      counts.invented += hits[i].found() && is_invented(spheres, rays[i], hits[i]) ? 1 : 0;
      EXPECT_EQ(occluded[i] != 0, hits[i].found()) << what << ", ray " << i << ", " << target;
    }
    EXPECT_EQ(counts.missed, 0u) << what << ", " << target;
    EXPECT_EQ(counts.invented, 0u) << what << ", " << target;
  });
  std::cout << what << ": " << counts.rays << " rays, " << counts.hits << " hits, " << counts.uncertain
            << " uncertain, " << counts.missed << " missed, " << counts.invented << " invented\n";
  return counts;
}

// A unit vector at right angles to a unit vector.
void across(const double d[3], CounterRandom& random, double out[3]) {
  double length = 0.0;
  while (length < 0.1) {
    double other[3];
    random.direction(other);
    out[0] = d[1] * other[2] - d[2] * other[1];
    out[1] = d[2] * other[0] - d[0] * other[2];
    out[2] = d[0] * other[1] - d[1] * other[0];
    length = std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
  }
  for (int c = 0; c < 3; ++c) out[c] /= length;
}

// A ray from `distance` away that passes the centre at `off`.
kernels::Ray passing(const double centre[3], double off, double distance, CounterRandom& random) {
  kernels::Ray ray{};
  random.direction(ray.direction);
  double side[3];
  across(ray.direction, random, side);
  for (int c = 0; c < 3; ++c) ray.origin[c] = centre[c] + off * side[c] - distance * ray.direction[c];
  return ray;
}

Spheres random_spheres(std::size_t count, double size, double low, double high, CounterRandom& random) {
  Spheres spheres;
  for (std::size_t i = 0; i < count; ++i) {
    const double centre[3] = {size * random.between(-1, 1), size * random.between(-1, 1), size * random.between(-1, 1)};
    spheres.add(centre, random.magnitude(low, high));
  }
  return spheres;
}

// Axis-parallel rays at exactly the radius, and some units in the last place beside it: here the truth is exact.
TEST(HardSpheres, TangentToTheLastPlace) {
  Spheres spheres;
  const double centre[3] = {0.0, 0.0, 0.0};
  spheres.add(centre, 1.0);
  std::vector<kernels::Ray> rays;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 1; side <= 2; ++side) {
      for (int ulps = -64; ulps <= 64; ++ulps) {
        for (const double sign : {-1.0, 1.0}) {
          kernels::Ray ray{};
          ray.direction[axis] = sign;
          ray.origin[axis] = -4.0 * sign;
          ray.origin[(axis + side) % 3] = sign * (1.0 + ulps * 0x1p-52);
          rays.push_back(ray);
        }
      }
    }
  }
  const Counts counts = judge("tangent along the axes", spheres, rays);
  // Every sum in between is exact here, so even the last place counts: 64 steps inside and the tangent itself.
  EXPECT_EQ(counts.hits, 3u * 2u * 2u * 65u);
}

TEST(HardSpheres, GrazingEverywhere) {
  CounterRandom random(1);
  const Spheres spheres = random_spheres(200, 10.0, -2.0, 0.5, random);
  std::vector<kernels::Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    const std::size_t at = random.below(spheres.count());
    const double off = spheres.radius[at] * (1.0 + random.sign() * random.magnitude(-16.0, -3.0));
    rays.push_back(passing(spheres.centre(at), off, random.magnitude(0.0, 4.0), random));
  }
  judge("grazing", spheres, rays);
}

TEST(HardSpheres, RadiiFrom1e8thTo1e3) {
  CounterRandom random(2);
  Spheres spheres = random_spheres(300, 1e3, -8.0, 0.0, random);
  const double far_away[3] = {3e3, 0.0, 0.0};
  spheres.add(far_away, 1e3);
  std::vector<kernels::Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    const std::size_t at = random.below(spheres.count());
    const double r = spheres.radius[at];
    // From a few radii away, and from so far that the tiny ones are near the limit of what can be told.
    rays.push_back(passing(spheres.centre(at), r * random.between(0.0, 1.2), r * random.magnitude(0.1, 6.0), random));
  }
  const Counts counts = judge("radii from 1e-8 to 1e3", spheres, rays);
  EXPECT_GT(counts.hits, 2000u);
}

// So small that f32 tells nothing of them but where they are, with rays that pass them by so little that in f32 they go
// through the middle: what is behind, in front or around must be hit all the same.
TEST(HardSpheres, PassedByLessThanF32Tells) {
  CounterRandom random(12);
  Spheres spheres;
  const double far_away[3] = {3e3, 0.0, 0.0};
  spheres.add(far_away, 1e3);
  std::vector<kernels::Ray> rays;
  for (int i = 0; i < 240; ++i) {
    double centre[3];
    for (double& x : centre) x = random.sign() * (16.0 + static_cast<double>(random.below(400)));
    spheres.add(centre, 1e-8);
    const int axis = i % 3;
    kernels::Ray ray{};
    ray.direction[axis] = random.sign();
    std::copy_n(centre, 3, ray.origin);
    ray.origin[axis] -= 8.0 * ray.direction[axis];
    ray.origin[(axis + 1) % 3] += 1e-7;
    rays.push_back(ray);
    if (i % 2 == 0) continue;
    double behind[3];
    std::copy_n(centre, 3, behind);
    behind[axis] += 4.0 * ray.direction[axis];
    spheres.add(behind, 1.0);
  }
  const Counts counts = judge("passed by less than f32 tells", spheres, rays);
  EXPECT_GT(counts.hits, 100u);
}

TEST(HardSpheres, FromFarAway) {
  CounterRandom random(3);
  const Spheres spheres = random_spheres(200, 1.0, -2.0, -1.0, random);
  for (const double distance : {1e3, 1e5, 1e7}) {
    std::vector<kernels::Ray> rays;
    for (int i = 0; i < 1000; ++i) {
      const std::size_t at = random.below(spheres.count());
      rays.push_back(passing(spheres.centre(at), spheres.radius[at] * random.between(0.0, 1.5), distance, random));
    }
    const Counts counts = judge("from far away", spheres, rays);
    EXPECT_GT(counts.hits, 500u);
  }
}

TEST(HardSpheres, FarFromTheOrigin) {
  CounterRandom random(4);
  for (const double offset : {1e4, 1e6, 1e7}) {
    Spheres spheres = random_spheres(200, 1.0, -2.0, -1.0, random);
    for (double& x : spheres.x) x += offset;
    std::vector<kernels::Ray> rays;
    for (int i = 0; i < 1000; ++i) {
      const std::size_t at = random.below(spheres.count());
      rays.push_back(passing(spheres.centre(at), spheres.radius[at] * random.between(0.0, 1.2), 3.0, random));
    }
    const Counts counts = judge("far from the origin", spheres, rays);
    EXPECT_GT(counts.hits, 500u);
  }
}

// From the centre, from the inside, and from the surface itself.
TEST(HardSpheres, FromWithin) {
  CounterRandom random(5);
  const Spheres spheres = random_spheres(100, 1.0, -2.0, 0.0, random);
  std::vector<kernels::Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    const std::size_t at = random.below(spheres.count());
    const double depth = i % 3 == 0 ? 0.0 : i % 3 == 1 ? random.between(-1.0, 1.0) : random.sign();
    rays.push_back(passing(spheres.centre(at), 0.0, spheres.radius[at] * depth, random));
  }
  const Counts counts = judge("from within", spheres, rays);
  EXPECT_GT(counts.hits, 2000u);
}

TEST(HardSpheres, Duplicates) {
  CounterRandom random(6);
  Spheres spheres;
  const double centre[3] = {0.25, -0.5, 0.125};
  for (int i = 0; i < 300; ++i) spheres.add(centre, 0.5);                // one sphere, 300 times
  for (int i = 0; i < 100; ++i) spheres.add(centre, 0.5 + i * 0x1p-50);  // and shells a few bits apart
  const double other[3] = {2.0, 0.0, 0.0};
  for (int i = 0; i < 100; ++i) spheres.add(other, random.magnitude(-3.0, 0.0));
  std::vector<kernels::Ray> rays;
  for (int i = 0; i < 500; ++i)
    rays.push_back(passing(i % 2 == 0 ? centre : other, random.between(0.0, 0.6), random.magnitude(-1.0, 2.0), random));
  judge("duplicates", spheres, rays);
}

// On a line and in a plane, along which the rays run: every slab of the tree is grazed.
TEST(HardSpheres, CollinearAndPlanar) {
  CounterRandom random(7);
  Spheres line;
  Spheres plane;
  for (int i = 0; i < 200; ++i) {
    const double on_line[3] = {0.01 * i, 0.0, 0.0};
    line.add(on_line, 0.004);
    const double on_plane[3] = {0.1 * (i % 20), 0.1 * (i / 20), 1.0};
    plane.add(on_plane, 0.04);
  }
  for (const Spheres* spheres : {&line, &plane}) {
    std::vector<kernels::Ray> rays;
    for (int i = 0; i < 1000; ++i) {
      const double* centre = spheres->centre(random.below(spheres->count()));
      kernels::Ray ray{};
      const std::size_t axis = random.below(3);
      for (double& d : ray.direction) d = random.below(2) == 0 ? 0.0 : -0.0;
      ray.direction[axis] = random.sign();
      const double r = spheres->radius[0];
      for (std::size_t c = 0; c < 3; ++c) ray.origin[c] = centre[c] - 5.0 * ray.direction[c];
      // At the centres, exactly at the rim, and between.
      ray.origin[(axis + 1) % 3] += r * (i % 4 == 0 ? 0.0 : i % 4 == 1 ? 1.0 : random.between(-1.2, 1.2));
      rays.push_back(ray);
    }
    const Counts counts = judge(spheres == &line ? "on a line" : "in a plane", *spheres, rays);
    EXPECT_GT(counts.hits, 300u);
  }
}

// Coordinates around zero that are denormal, with radii that are not; and whole scenes of extreme size.
TEST(HardSpheres, DenormalsAndExtremeMagnitudes) {
  CounterRandom random(8);
  Spheres spheres;
  for (int i = 0; i < 100; ++i) {
    const double centre[3] = {random.sign() * 4.9e-324, random.between(-1.0, 1.0) * 1e-310, i * 1e-320};
    spheres.add(centre, 1.0 - i * 0.005);
  }
  std::vector<kernels::Ray> rays;
  for (int i = 0; i < 500; ++i) {
    rays.push_back(passing(spheres.centre(0), random.between(0.0, 1.3), 3.0, random));
    for (double& d : rays.back().direction)
      if (i % 3 == 0 && std::abs(d) < 0.3) d = random.sign() * 1e-310;
    double length = 0.0;
    for (const double d : rays.back().direction) length += d * d;
    for (double& d : rays.back().direction) d /= std::sqrt(length);
  }
  judge("denormal coordinates", spheres, rays);

  for (const double size : {1e-140, 1e-60, 1e-30, 1e30, 1e60, 1e99}) {
    Spheres scaled = random_spheres(150, 1.0, -2.0, -0.5, random);
    for (double& x : scaled.x) x *= size;
    for (double& r : scaled.radius) r *= size;
    std::vector<kernels::Ray> more;
    for (int i = 0; i < 400; ++i) {
      const std::size_t at = random.below(scaled.count());
      more.push_back(passing(scaled.centre(at), scaled.radius[at] * random.between(0.0, 1.2), 3.0 * size, random));
    }
    const Counts counts = judge(("size " + std::to_string(std::log10(size))).c_str(), scaled, more);
    EXPECT_GT(counts.hits, 250u) << size;
  }
}

// Rays that are none end and hit nothing; particles that are none are not there.
TEST(HardSpheres, NaNAndInfinityAreNotHit) {
  CounterRandom random(9);
  Spheres spheres = random_spheres(200, 1.0, -2.0, -1.0, random);
  Spheres with_bad = spheres;
  for (const double bad : {nan, infinity, -infinity}) {
    for (int c = 0; c < 3; ++c) {
      double centre[3] = {0.0, 0.0, 0.0};
      centre[c] = bad;
      with_bad.add(centre, 10.0);
    }
    const double middle[3] = {0.0, 0.0, 0.0};
    with_bad.add(middle, bad);
  }
  Budget budget(0);
  ParticleArrays arrays;
  arrays.position = positions_of(with_bad.x);
  arrays.radius = view_of(with_bad.radius, 1, INSITU_USE_RADIUS);
  Particles particles("with bad values", ParticleOrder::index, false);
  particles.bind(std::move(arrays));
  particles.build(budget);
  EXPECT_EQ(particles.drawn_count(), spheres.count());
  std::uint64_t hits = 0;
  for_each_simd_target([&](const char* target) {
    for (int i = 0; i < 200; ++i) {
      const std::size_t at = random.below(spheres.count());
      kernels::Ray good = passing(spheres.centre(at), 0.5 * spheres.radius[at], 3.0, random);
      kernels::Hit hit;
      particles.first_hits(&good, &hit, 1);
      EXPECT_TRUE(hit.found());
      EXPECT_LT(hit.item, spheres.count());
      ++hits;
      kernels::Ray bad = good;
      const double value = i % 3 == 0 ? nan : i % 3 == 1 ? infinity : -infinity;
      (i % 2 == 0 ? bad.origin : bad.direction)[i % 3 == 0 ? i / 3 % 3 : 1] = value;
      if (i % 7 == 0) bad.t_min = nan;
      kernels::Hit none;
      std::uint8_t occluded = 0;
      particles.first_hits(&bad, &none, 1);
      particles.any_hits(&bad, &occluded, 1);
      EXPECT_FALSE(none.found()) << target << ", ray " << i;
      EXPECT_EQ(occluded, 0) << target << ", ray " << i;
      EXPECT_TRUE(particles.all_hits(bad).empty()) << target << ", ray " << i;
    }
  });
  std::cout << "bad values: " << hits << " good rays, all hit; 12 bad particles, none hit\n";
}

}  // namespace
}  // namespace insitu::testing
