// Ray and sphere in double precision: the arithmetic that decides every picture, and the reference for the SIMD leaves.
//
// With f = o - c and unit d, the point of the ray nearest to the centre is at t = b = -f.d, and its offset from the
// centre is p = f + b d. The ray meets the sphere when |p|^2 <= r^2, at t = b -+ sqrt(r^2 - |p|^2).
// Taking |p|^2 from the vector p instead of |f|^2 - b^2 avoids the cancellation that loses small spheres far from the
// origin of the ray (Haines, Guenther, Akenine-Moeller: "Precision improvements for ray/sphere intersection",
// Ray Tracing Gems, 2019, chapter 7).
//
// Plain operations only, and built with -ffp-contract=off: the same bits on every machine.
#pragma once

#include <cmath>

#include "kernels/ray.h"

namespace insitu::kernels {

struct SphereRoots {
  bool hit;
  double enter;
  double leave;
};

inline SphereRoots sphere_roots(const double origin[3], const double direction[3], const double centre[3],
                                double radius) {
  const double fx = origin[0] - centre[0];
  const double fy = origin[1] - centre[1];
  const double fz = origin[2] - centre[2];
  const double b = -(fx * direction[0] + fy * direction[1] + fz * direction[2]);
  const double px = fx + b * direction[0];
  const double py = fy + b * direction[1];
  const double pz = fz + b * direction[2];
  const double discriminant = radius * radius - (px * px + py * py + pz * pz);
  if (!(discriminant >= 0.0)) return {false, 0.0, 0.0};
  const double s = std::sqrt(discriminant);
  return {true, b - s, b + s};
}

// The first intersection with t_min < t: of the outside, or of the inside when the ray starts within the sphere.
// Infinity when there is none.
inline double sphere_first_hit(const double origin[3], const double direction[3], const double centre[3], double radius,
                               double t_min) {
  const SphereRoots roots = sphere_roots(origin, direction, centre, radius);
  if (!roots.hit) return std::numeric_limits<double>::infinity();
  if (roots.enter > t_min) return roots.enter;
  return roots.leave > t_min ? roots.leave : std::numeric_limits<double>::infinity();
}

}  // namespace insitu::kernels
