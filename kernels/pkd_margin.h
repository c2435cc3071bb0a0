// How far f32 tests of a whole tree may be off.
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/pkd_tree.h"

namespace insitu::kernels {

// Half of the spacing of numbers at 1: the relative error of one operation.
constexpr double f32_unit = 5.9604644775390625e-8;
constexpr double f64_unit = 1.1102230246251565e-16;

// Whole trees in f32: rays start at the point where they enter the box of the tree, rounded to f32, and `value` covers
// that rounding and those of the tests (docs/math/particles.md). While the margin is below the largest radius this is
// the fast way: at worst four times as many candidates as hits have to be confirmed. Smaller particles get a frame for
// every leaf.
struct TreeMargin {
  double value;
  double extent;  // diagonal of the tree
  bool fits;
  double farthest;  // coordinates of origins: rays from behind it lose more in double than the margin has to spare

  bool Fits(const Ray& ray) const {
    double distance = 0.0;
    for (int c = 0; c < 3; ++c) distance = std::max(distance, std::abs(ray.origin[c]));
    return distance < farthest;
  }

  // Not less than two of them.
  float twice() const { return static_cast<float>(2.0 * value * (1.0 + 1e-3)); }

  explicit TreeMargin(const PkdTree& tree) {
    double diagonal2 = 0.0;
    double magnitude = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double side = tree.upper[c] - tree.lower[c] + 2.0 * tree.radius_max;
      diagonal2 += side * side;
      magnitude = std::max({magnitude, std::abs(tree.lower[c]), std::abs(tree.upper[c])});
    }
    extent = std::sqrt(diagonal2);
    value = 32.0 * f32_unit * (2.0 * extent + magnitude);
    fits = value < tree.radius_max && extent > 1e-12 && extent + magnitude < 1e12;
    farthest = fits ? 4.0 * f32_unit * extent / (128.0 * f64_unit) : 0.0;
  }
};

}  // namespace insitu::kernels
