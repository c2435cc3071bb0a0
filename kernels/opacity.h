// Opacities of items, and how much light is left behind many of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace insitu::kernels {

// How opaque an item is: 0 (as if it were not there) to 1. Called from many threads at a time.
struct ItemOpacity {
  float (*function)(const void* context, std::uint64_t item);
  const void* context;
  float of(std::uint64_t item) const { return function(context, item); }
};

// Optical depth, the negative logarithm of the share of light that passes, in units of 2^-32. Integers, because their
// sum is the same in any order: neither the order of the particles nor that of the nodes may show in a picture.
using OpticalDepth = std::uint64_t;
constexpr double optical_depth_unit = 1.0 / 4294967296.0;
// From ln(1024) on nothing passes: rays need not go on to the end.
constexpr OpticalDepth opaque_depth = static_cast<OpticalDepth>(6.931471805599453 / optical_depth_unit);

inline OpticalDepth optical_depth(float opacity) {
  if (!(opacity > 0.0f)) return 0;
  if (opacity >= 1.0f) return opaque_depth;
  const double depth = -std::log1p(-static_cast<double>(opacity)) / optical_depth_unit;
  return std::min(opaque_depth, static_cast<OpticalDepth>(depth + 0.5));
}

// The share of light that passes, 0 to 1.
inline double transmittance(OpticalDepth depth) {
  if (depth >= opaque_depth) return 0.0;
  return depth == 0 ? 1.0 : std::exp(-static_cast<double>(depth) * optical_depth_unit);
}

}  // namespace insitu::kernels
