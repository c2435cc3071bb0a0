// Rays and hits in double precision: what the kernels exchange with the renderer.
#pragma once

#include <cstdint>
#include <limits>

namespace insitu::kernels {

constexpr std::uint64_t no_item = ~std::uint64_t{0};

struct Ray {
  double origin[3];
  double direction[3];  // of unit length
  double t_min = 0.0;   // hits have t_min < t <= t_max
  double t_max = std::numeric_limits<double>::infinity();
  std::uint64_t exclude = no_item;  // the item that a secondary ray starts on: a convex surface is not hit again
};

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  std::uint64_t item = no_item;  // index in the caller's arrays
  bool found() const { return item != no_item; }
};

// Where a ray runs inside of one item.
struct Span {
  double t_enter;
  double t_leave;
  std::uint64_t item;
};

}  // namespace insitu::kernels
