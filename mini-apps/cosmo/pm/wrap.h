// The periodic box [0, side).
#pragma once

#include <cmath>

namespace cosmo {

// The image of `x` in the box, rounded to the precision of the state; never `side` itself.
inline float wrapped(double x, double side) {
  if (!(x >= 0.0 && x < side)) x -= side * std::floor(x / side);
  const auto inside = static_cast<float>(x);
  return inside >= 0.0f && static_cast<double>(inside) < side ? inside : 0.0f;  // also for NaN
}

}  // namespace cosmo
