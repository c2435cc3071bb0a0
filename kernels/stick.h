// Ray and stick in double precision: cylinders with flat or round ends, and cones. docs/math/sticks.md derives it.
//
// All of them are convex, so that a ray is within one for a single interval. The ray is first moved to its point
// nearest to the middle of the stick, as a vector (see sphere.h): from there on no number is larger than the stick, and
// what is lost is what a shift of the ray's origin by its own rounding would lose as well.
//
// Plain operations only, and built with -ffp-contract=off: the same bits on every machine.
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/sphere.h"

namespace insitu::kernels {

enum class StickEnds : std::uint8_t { flat, round, cone };

// From `a` to `b`, which differ. A cone has its base, of `radius`, at `a`, and its tip at `b`.
struct Stick {
  double a[3];
  double b[3];
  double radius;
  StickEnds ends;
};

// Along which a ray is within a stick; none when enter > leave.
struct StickSpan {
  double enter = std::numeric_limits<double>::infinity();
  double leave = -std::numeric_limits<double>::infinity();

  void include(double t) {
    enter = std::min(enter, t);
    leave = std::max(leave, t);
  }
};

namespace stick_detail {

inline double dot(const double u[3], const double v[3]) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

// The ray along the axis and across it, in coordinates of the stick: t is counted from `t_middle`.
struct AxisRay {
  double length;         // of the stick
  double t_middle;       // of the ray's point nearest to the middle of the stick
  double along;          // of that point, from `a`
  double speed;          // along the axis per t
  double across[3];      // of that point, from the axis
  double drift[3];       // across the axis per t
  double drift_squared;  // 0: the ray runs along the axis
  bool near;             // to the ball around the stick; nothing else is set when it is not
};

inline AxisRay axis_ray(const double origin[3], const double direction[3], const Stick& stick) {
  AxisRay ray{};
  double axis[3];
  double from_middle[3];
  for (int c = 0; c < 3; ++c) {
    axis[c] = stick.b[c] - stick.a[c];
    from_middle[c] = origin[c] - (stick.a[c] + 0.5 * axis[c]);
  }
  ray.length = std::sqrt(dot(axis, axis));
  ray.t_middle = -dot(from_middle, direction);
  double nearest[3];
  for (int c = 0; c < 3; ++c) nearest[c] = from_middle[c] + ray.t_middle * direction[c];
  const double reach = 0.5 * ray.length + stick.radius;
  ray.near = dot(nearest, nearest) <= reach * reach * (1.0 + 1e-9);
  if (!ray.near || !(ray.length > 0.0)) {
    ray.near = false;
    return ray;
  }
  for (double& component : axis) component /= ray.length;
  const double along = dot(nearest, axis);
  ray.along = along + 0.5 * ray.length;
  ray.speed = dot(direction, axis);
  for (int c = 0; c < 3; ++c) {
    ray.across[c] = nearest[c] - along * axis[c];
    ray.drift[c] = direction[c] - ray.speed * axis[c];
  }
  ray.drift_squared = dot(ray.drift, ray.drift);
  return ray;
}

// Between the planes through the ends, and within `radius` of the axis.
inline StickSpan in_cylinder(const AxisRay& ray, double radius) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  StickSpan span{-infinity, infinity};
  if (ray.drift_squared > 0.0) {
    // Nearest to the axis at `at`, and `q` away from it.
    const double at = -dot(ray.across, ray.drift) / ray.drift_squared;
    double q[3];
    for (int c = 0; c < 3; ++c) q[c] = ray.across[c] + at * ray.drift[c];
    const double left = radius * radius - dot(q, q);
    if (!(left >= 0.0)) return {};
    const double half = std::sqrt(left / ray.drift_squared);
    span = {at - half, at + half};
  } else if (!(dot(ray.across, ray.across) <= radius * radius)) {
    return {};
  }
  if (ray.speed != 0.0) {
    const double at_a = -ray.along / ray.speed;
    const double at_b = (ray.length - ray.along) / ray.speed;
    span.enter = std::max(span.enter, std::min(at_a, at_b));
    span.leave = std::min(span.leave, std::max(at_a, at_b));
  } else if (!(ray.along >= 0.0 && ray.along <= ray.length)) {
    return {};
  }
  return span.enter <= span.leave ? span : StickSpan{};
}

// Up to two of three candidates count: where the ray meets the mantle between base and tip, twice, and the base.
inline StickSpan in_cone(const AxisRay& ray, double radius) {
  StickSpan span;
  const double slope = radius / ray.length;
  const double above = ray.length - ray.along;  // of the tip over the ray's point, along the axis
  const double a = ray.drift_squared - slope * slope * ray.speed * ray.speed;
  const double half_b = dot(ray.across, ray.drift) + slope * slope * above * ray.speed;
  const double c = dot(ray.across, ray.across) - slope * slope * above * above;
  const auto on_mantle = [&](double t) {
    const double height = ray.along + t * ray.speed;
    if (height >= 0.0 && height <= ray.length) span.include(t);
  };
  const double discriminant = half_b * half_b - a * c;
  if (discriminant >= 0.0) {
    // Both roots without subtracting near numbers.
    const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    if (a != 0.0) on_mantle(q / a);
    if (q != 0.0) on_mantle(c / q);
  }
  if (ray.speed != 0.0) {
    const double t = -ray.along / ray.speed;
    double squares = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double off = ray.across[k] + t * ray.drift[k];
      squares += off * off;
    }
    if (squares <= radius * radius) span.include(t);
  }
  return span;
}

}  // namespace stick_detail

inline StickSpan stick_span(const double origin[3], const double direction[3], const Stick& stick) {
  const stick_detail::AxisRay ray = stick_detail::axis_ray(origin, direction, stick);
  if (!ray.near) return {};
  StickSpan span = stick.ends == StickEnds::cone ? stick_detail::in_cone(ray, stick.radius)
                                                 : stick_detail::in_cylinder(ray, stick.radius);
  span.enter += ray.t_middle;
  span.leave += ray.t_middle;
  if (stick.ends == StickEnds::round) {
    // The hull of cylinder and balls is their union: the outermost of all parts count.
    for (const double* end : {stick.a, stick.b}) {
      const SphereRoots ball = sphere_roots(origin, direction, end, stick.radius);
      if (!ball.hit) continue;
      span.include(ball.enter);
      span.include(ball.leave);
    }
  }
  return span;
}

// The first intersection with t_min < t: of the outside, or of the inside when the ray starts within the stick.
// Infinity when there is none.
inline double stick_first_hit(const double origin[3], const double direction[3], const Stick& stick, double t_min) {
  const StickSpan span = stick_span(origin, direction, stick);
  if (!(span.enter <= span.leave)) return std::numeric_limits<double>::infinity();
  if (span.enter > t_min) return span.enter;
  return span.leave > t_min ? span.leave : std::numeric_limits<double>::infinity();
}

// Outwards and of unit length, at a point of the surface. 0 to 1: how far the point is along the stick.
inline double stick_normal(const Stick& stick, const double point[3], double normal[3]) {
  double axis[3];
  double p[3];
  for (int c = 0; c < 3; ++c) {
    axis[c] = stick.b[c] - stick.a[c];
    p[c] = point[c] - stick.a[c];
  }
  const double length = std::sqrt(stick_detail::dot(axis, axis));
  for (double& component : axis) component /= length;
  const double along = stick_detail::dot(p, axis);
  double across[3];
  for (int c = 0; c < 3; ++c) across[c] = p[c] - along * axis[c];
  const double off = std::sqrt(stick_detail::dot(across, across));
  const auto mix = [&](double of_across, double of_axis) {
    double squares = 0.0;
    for (int c = 0; c < 3; ++c) {
      normal[c] = of_across * across[c] + of_axis * axis[c];
      squares += normal[c] * normal[c];
    }
    const double size = std::sqrt(squares);
    for (int c = 0; c < 3; ++c) normal[c] = size > 0.0 ? normal[c] / size : 0.0;
  };
  const double radius = stick.radius;
  switch (stick.ends) {
    case StickEnds::round:
      // From the nearest point of the axis.
      mix(1.0, along - std::clamp(along, 0.0, length));
      break;
    case StickEnds::flat: {
      // The surface to which the point is nearest.
      const double side = std::abs(off - radius);
      const double at_a = std::abs(along);
      const double at_b = std::abs(along - length);
      if (side <= std::min(at_a, at_b)) {
        mix(1.0, 0.0);
      } else {
        mix(0.0, at_a < at_b ? -1.0 : 1.0);
      }
      break;
    }
    case StickEnds::cone: {
      const double slant = std::sqrt(length * length + radius * radius);
      const double mantle = std::abs(off * length - radius * (length - along)) / slant;
      if (std::abs(along) < mantle) {
        mix(0.0, -1.0);
      } else {
        // `across` is `off` long; at the tip itself, where it has no direction, the axis remains.
        off > 0.0 ? mix(length / off, radius) : mix(0.0, 1.0);
      }
      break;
    }
  }
  return std::clamp(along / length, 0.0, 1.0);
}

}  // namespace insitu::kernels
