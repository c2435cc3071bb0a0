// The simulation box: a corner and three edges.
#pragma once

#include <array>

namespace replay {

struct Box {
  bool known = false;
  std::array<double, 3> origin = {};
  std::array<std::array<double, 3>, 3> edge = {};

  // From coordinates in units of the edges.
  std::array<double, 3> from_scaled(double a, double b, double c) const {
    std::array<double, 3> out = origin;
    for (std::size_t k = 0; k < 3; ++k) out[k] += a * edge[0][k] + b * edge[1][k] + c * edge[2][k];
    return out;
  }

  // As LAMMPS describes it: bounds along the axes, and the tilts of y along x, z along x and z along y.
  static Box from_bounds(const std::array<double, 3>& lower, const std::array<double, 3>& upper, double xy, double xz,
                         double yz) {
    Box box;
    box.known = true;
    box.origin = lower;
    box.edge[0] = {upper[0] - lower[0], 0.0, 0.0};
    box.edge[1] = {xy, upper[1] - lower[1], 0.0};
    box.edge[2] = {xz, yz, upper[2] - lower[2]};
    return box;
  }
};

}  // namespace replay
