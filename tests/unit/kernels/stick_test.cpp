// Ray and stick against quadruple precision, which has formulas of its own: the ray is cut at a thousandth of the
// stick's size from the first hit that double found, and whether a point is within the solid is a matter of distances.
#include "kernels/stick.h"

#include <gtest/gtest.h>

#include "unit/kernels/counter_random.h"
#include "unit/kernels/quad_sphere.h"

namespace insitu::testing {
namespace {

using kernels::Stick;
using kernels::StickEnds;

constexpr StickEnds every_kind[] = {StickEnds::flat, StickEnds::round, StickEnds::cone};

// How far outside of the solid a point is; negative inside, where it need not be a distance.
Quad outside(const Stick& stick, const QuadVector& point) {
  const QuadVector a = QuadVector::of(stick.a);
  const QuadVector axis = QuadVector::of(stick.b) - a;
  const Quad size = length(axis);
  const QuadVector p = point - a;
  const Quad along = dot(p, axis) / size;
  const Quad off = length(p - (along / size) * axis);
  const Quad r = Quad(stick.radius);
  switch (stick.ends) {
    case StickEnds::flat:
      return fmaxq(off - r, fmaxq(-along, along - size));
    case StickEnds::round: {
      const Quad nearest = along < 0 ? Quad(0) : along > size ? size : along;
      return sqrtq(off * off + (along - nearest) * (along - nearest)) - r;
    }
    case StickEnds::cone:
      return fmaxq(-along, (off * size - r * (size - along)) / sqrtq(size * size + r * r));
  }
  return 0;
}

// Where the ray is nearest to the solid, or deepest within it: a convex function along the ray, so that thirds find it.
Quad deepest(const Stick& stick, const QuadVector& origin, const QuadVector& direction, Quad low, Quad high) {
  for (int i = 0; i < 200; ++i) {
    const Quad one = low + (high - low) / 3;
    const Quad two = high - (high - low) / 3;
    const bool first_is_deeper = outside(stick, origin + one * direction) < outside(stick, origin + two * direction);
    (first_is_deeper ? high : low) = first_is_deeper ? two : one;
  }
  return (low + high) / 2;
}

// Between a point outside and one inside.
Quad border(const Stick& stick, const QuadVector& origin, const QuadVector& direction, Quad out, Quad in) {
  for (int i = 0; i < 180; ++i) {
    const Quad mid = (out + in) / 2;
    (outside(stick, origin + mid * direction) > 0 ? out : in) = mid;
  }
  return (out + in) / 2;
}

struct Counts {
  int hits = 0;
  int misses = 0;
};

// `distance` and everything else in units of the stick's size.
void expect_truth(const Stick& stick, const double origin[3], const double direction[3], double size, double distance,
                  Counts& counts) {
  const QuadVector o = QuadVector::of(origin);
  const QuadVector d = (1 / length(QuadVector::of(direction))) * QuadVector::of(direction);
  // The ray's length is off by a few roundings, which moves what is far away.
  const double allowed = 1e-14 * (distance + 10.0 * size);
  const kernels::StickSpan span = kernels::stick_span(origin, direction, stick);
  const Quad span_size = Quad(4 * size);
  const Quad middle = -dot(o - Quad(0.5) * (QuadVector::of(stick.a) + QuadVector::of(stick.b)), d);
  const Quad deep = deepest(stick, o, d, middle - span_size, middle + span_size);
  const Quad depth = outside(stick, o + deep * d);
  if (span.enter <= span.leave) {
    ++counts.hits;
    EXPECT_LT(static_cast<double>(depth), allowed) << "hit what the ray misses";
    // Points that double calls surface are on the surface.
    for (const double t : {span.enter, span.leave})
      EXPECT_LT(static_cast<double>(fabsq(outside(stick, o + Quad(t) * d))), allowed) << "kind " << int(stick.ends);
    // And the first is the first: nothing of the solid lies well before it.
    if (depth < Quad(-allowed)) {
      const Quad first = border(stick, o, d, middle - span_size, deep);
      const Quad before = outside(stick, o + (first - Quad(1e-3 * size)) * d);
      EXPECT_GT(static_cast<double>(before), 0.0);
      // As well as the ray's slope to the surface allows, the distance agrees.
      const double slope =
          static_cast<double>(fabsq(outside(stick, o + (first - Quad(1e-6 * size)) * d))) / 1e-6 / size;
      if (slope > 0.1) {
        EXPECT_LT(std::abs(span.enter - static_cast<double>(first)), 20.0 * allowed);
      }
    }
  } else {
    ++counts.misses;
    EXPECT_GT(static_cast<double>(depth), -allowed) << "missed, kind " << int(stick.ends);
  }
}

Stick random_stick(CounterRandom& random, StickEnds ends, double size, double slenderness) {
  Stick stick{};
  double axis[3];
  random.direction(axis);
  for (int c = 0; c < 3; ++c) {
    stick.a[c] = size * random.between(-1.0, 1.0);
    stick.b[c] = stick.a[c] + size * axis[c];
  }
  stick.radius = size * slenderness;
  stick.ends = ends;
  return stick;
}

void aim(CounterRandom& random, const Stick& stick, double size, double distance, double direction[3],
         double origin[3]) {
  const double along = random.between(-0.2, 1.2);
  for (int c = 0; c < 3; ++c)
    origin[c] = stick.a[c] + along * (stick.b[c] - stick.a[c]) + 1.3 * stick.radius * random.between(-1.0, 1.0) -
                distance * size * direction[c];
}

TEST(Stick, RandomRaysFromNearAndFar) {
  for (const StickEnds ends : every_kind) {
    for (const double distance : {3.0, 1e3, 1e6}) {
      for (const double slenderness : {1e-3, 0.1, 2.0}) {
        Counts counts;
        for (std::uint64_t seed = 0; seed < 24; ++seed) {
          CounterRandom random(seed + 1);
          const double size = seed % 3 == 0 ? 1.0 : seed % 3 == 1 ? 1e-9 : 1e12;
          const Stick stick = random_stick(random, ends, size, slenderness);
          double direction[3];
          double origin[3];
          random.direction(direction);
          aim(random, stick, size, distance, direction, origin);
          expect_truth(stick, origin, direction, size * (1.0 + slenderness), distance * size, counts);
        }
        EXPECT_GT(counts.hits, 3) << int(ends) << ' ' << distance << ' ' << slenderness;
        EXPECT_GT(counts.misses, 1) << int(ends) << ' ' << distance << ' ' << slenderness;
      }
    }
  }
}

// Along the axis, or off it by next to nothing: the quadratic of the mantle has no second power then.
TEST(Stick, AlongTheAxisAndNearlyAlongIt) {
  for (const StickEnds ends : every_kind) {
    for (const double tilt : {0.0, 1e-300, 1e-17, 1e-12, 1e-8, 1e-4}) {
      Counts counts;
      for (std::uint64_t seed = 0; seed < 16; ++seed) {
        CounterRandom random(seed + 1);
        const Stick stick =
            seed % 2 == 0 ? Stick{{0, 0, 0}, {0, 0, 1}, 0.25, ends} : random_stick(random, ends, 1.0, 0.25);
        double direction[3];
        double origin[3];
        double square = 0.0;
        for (int c = 0; c < 3; ++c) {
          direction[c] = (stick.b[c] - stick.a[c]) * random.sign() + tilt * random.between(-1.0, 1.0);
          square += direction[c] * direction[c];
        }
        for (double& c : direction) c /= std::sqrt(square);
        aim(random, stick, 1.0, 4.0, direction, origin);
        expect_truth(stick, origin, direction, 1.25, 4.0, counts);
      }
      EXPECT_GT(counts.hits, 2) << int(ends) << ' ' << tilt;
    }
  }
}

TEST(Stick, ClosedForms) {
  const Stick flat{{0, 0, 0}, {0, 0, 4}, 1.0, StickEnds::flat};
  const Stick round{{0, 0, 0}, {0, 0, 4}, 1.0, StickEnds::round};
  const Stick cone{{0, 0, 0}, {0, 0, 4}, 1.0, StickEnds::cone};
  const auto hit = [](const Stick& s, double ox, double oy, double oz, double dx, double dy, double dz) {
    const double o[3] = {ox, oy, oz};
    const double d[3] = {dx, dy, dz};
    return kernels::stick_first_hit(o, d, s, 0.0);
  };
  const double never = std::numeric_limits<double>::infinity();
  EXPECT_DOUBLE_EQ(hit(flat, -5, 0, 2, 1, 0, 0), 4.0);
  EXPECT_DOUBLE_EQ(hit(flat, 0.5, 0, -3, 0, 0, 1), 3.0);   // the end, along the axis
  EXPECT_DOUBLE_EQ(hit(flat, 0.5, 0, 9, 0, 0, -1), 5.0);   // the other end
  EXPECT_DOUBLE_EQ(hit(flat, 0, 0, 2, 1, 0, 0), 1.0);      // from within
  EXPECT_DOUBLE_EQ(hit(flat, 0, 0, 2, 0, 0, 1), 2.0);      // from within, along the axis
  EXPECT_EQ(hit(flat, 5, 0, 2, 1, 0, 0), never);           // behind the start
  EXPECT_EQ(hit(flat, 1.5, 0, -3, 0, 0, 1), never);        // beside it
  EXPECT_EQ(hit(flat, -5, 0, 4.5, 1, 0, 0), never);        // above it
  EXPECT_DOUBLE_EQ(hit(round, 0, 0, -3, 0, 0, 1), 2.0);    // the pole of the half ball
  EXPECT_DOUBLE_EQ(hit(round, -5, 0, 4.6, 1, 0, 0), 4.2);  // 0.6 above the end: 0.8 off the axis
  EXPECT_DOUBLE_EQ(hit(cone, -5, 0, 2, 1, 0, 0), 4.5);     // half as wide half way up
  EXPECT_DOUBLE_EQ(hit(cone, 0.5, 0, -3, 0, 0, 1), 3.0);   // the base
  EXPECT_DOUBLE_EQ(hit(cone, 0.5, 0, 9, 0, 0, -1), 7.0);   // the mantle from above, where it is 0.5 wide
  EXPECT_DOUBLE_EQ(hit(cone, 0, 0, 9, 0, 0, -1), 5.0);     // the tip
  EXPECT_EQ(hit(cone, -5, 0, 6, 1, 0, 0), never);          // the other half of the double cone
}

TEST(Stick, NormalsStandOnTheSurface) {
  for (const StickEnds ends : every_kind) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      CounterRandom random(seed + 1);
      const Stick stick = random_stick(random, ends, 1.0, 0.3);
      double direction[3];
      double origin[3];
      random.direction(direction);
      aim(random, stick, 1.0, 3.0, direction, origin);
      const double t = kernels::stick_first_hit(origin, direction, stick, 0.0);
      if (t == std::numeric_limits<double>::infinity()) continue;
      double point[3];
      double normal[3] = {};
      for (int c = 0; c < 3; ++c) point[c] = origin[c] + t * direction[c];
      kernels::stick_normal(stick, point, normal);
      EXPECT_NEAR(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2], 1.0, 1e-14);
      // A step outwards along the normal is as far outside as it is long; near an edge it may be one of two normals.
      const QuadVector at = QuadVector::of(point);
      const double step = 1e-4;
      const double off = static_cast<double>(outside(stick, at + Quad(step) * QuadVector::of(normal)));
      EXPECT_NEAR(off, step, 1e-3 * step) << int(ends) << " seed " << seed;
    }
  }
}

TEST(Stick, WithoutLengthOrRadiusNothingBreaks) {
  const double o[3] = {0, 0, -3};
  const double d[3] = {0, 0, 1};
  for (const StickEnds ends : every_kind) {
    EXPECT_FALSE(std::isnan(kernels::stick_first_hit(o, d, Stick{{0, 0, 0}, {0, 0, 0}, 1.0, ends}, 0.0)));
    EXPECT_FALSE(std::isnan(kernels::stick_first_hit(o, d, Stick{{0, 0, 0}, {1, 0, 0}, 0.0, ends}, 0.0)));
  }
}

}  // namespace
}  // namespace insitu::testing
