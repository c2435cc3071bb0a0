// The first pass over the arrays of a step: which particles can be drawn, and within which bounds.
#pragma once

#include <cstdint>
#include <limits>

#include "kernels/pkd_tree.h"

namespace insitu {

// Positions beyond this magnitude would overflow when squared in double; they count as not finite.
constexpr double largest_coordinate = 1e100;

struct ScanResult {
  double lower[3];  // of the centres of drawn particles
  double upper[3];
  double radius_min;
  double radius_max;
  std::uint64_t drawn;
};

constexpr ScanResult nothing_found() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}, infinity, 0.0, 0};
}
// Of the particles of both.
ScanResult joined(const ScanResult& a, const ScanResult& b);

bool is_drawable(const kernels::PkdTree& tree, std::uint64_t item);

// All items of tree.position, in parallel. `judge_radius` false: positions alone decide.
ScanResult scan_particles(const kernels::PkdTree& tree, bool judge_radius);

}  // namespace insitu
