// Ray and box in double precision, on the safe side: a box that the ray meets is never missed; one that it misses by
// some roundings may be taken.
//
// The distances to the planes of a box are (plane - origin) / direction. Each term carries a relative error of a few
// eps; `slack`, some roundings of the origin's largest coordinate, moves the planes outwards by more than what the
// subtraction loses. A direction of 0 counts as one too small to leave the slab within any distance: with it no
// infinity is multiplied by 0.
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/ray.h"

namespace insitu::kernels {

struct RaySlabs {
  double origin[3];
  double inverse[3];
  double slack;  // a length

  RaySlabs(const double from[3], const double direction[3]) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) {
      constexpr double least = 1e-290;
      const double d = std::abs(direction[c]) < least ? std::copysign(least, direction[c]) : direction[c];
      origin[c] = from[c];
      inverse[c] = 1.0 / d;
      largest = std::max(largest, std::abs(from[c]));
    }
    slack = 16.0 * 2.220446049250313e-16 * largest;
  }

  struct Span {
    double enter;
    double leave;
    bool meets;  // between t_min and t_max
  };
  Span span(const double lower[3], const double upper[3], double t_min, double t_max) const {
    double near = t_min;
    double far = t_max;
    for (int c = 0; c < 3; ++c) {
      const double margin = slack + 16.0 * 2.220446049250313e-16 * std::max(std::abs(lower[c]), std::abs(upper[c]));
      const double a = (lower[c] - margin - origin[c]) * inverse[c];
      const double b = (upper[c] + margin - origin[c]) * inverse[c];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    // Some roundings of the products.
    constexpr double more = 1.0 + 1e-14;
    constexpr double less = 1.0 - 1e-14;
    near = near > 0.0 ? near * less : near * more;
    far = far > 0.0 ? far * more : far * less;
    return {near, far, near <= far};
  }

  // Where the ray enters the box, or infinity when it does not meet it between t_min and t_max.
  double enter(const double lower[3], const double upper[3], double t_min, double t_max) const {
    const Span at = span(lower, upper, t_min, t_max);
    return at.meets ? at.enter : std::numeric_limits<double>::infinity();
  }
};

}  // namespace insitu::kernels
