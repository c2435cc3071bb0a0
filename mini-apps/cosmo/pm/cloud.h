// Cloud in cell: a particle is a cube as wide as a cell of the mesh, and belongs to the eight nodes around it in
// proportion to the volumes (Hockney & Eastwood, Computer Simulation Using Particles, 1988, chapter 5).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "particles.h"

namespace cosmo {

// Places on the periodic mesh are fixed point numbers: then weights are integers, their sums are exact, and a density
// does not depend on the order in which particles are added up. 2^-14 of a cell is the resolution of single precision
// on a mesh of 1024 nodes; the weights of a particle add up to 2^42, so that a node holds up to 2^22 particles.
class Clouds {
 public:
  static constexpr unsigned fraction_bits = 14;
  static constexpr std::uint32_t one = 1u << fraction_bits;
  static constexpr std::uint64_t particle = std::uint64_t{1} << (3 * fraction_bits);  // weight of a whole particle

  Clouds(std::size_t nodes, double side)
      : nodes_(static_cast<std::uint32_t>(nodes)),
        scale_(static_cast<float>(static_cast<double>(nodes * one) / side)) {}

  struct Cloud {
    std::uint32_t low[3];   // node below, along x, y, z
    std::uint32_t high[3];  // node above
    std::uint32_t part[3];  // share of the node above, of `one`
  };
  Cloud at(const Vec3f& position) const {
    Cloud cloud;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto place = std::min(static_cast<std::uint32_t>(position[k] * scale_), nodes_ * one - 1);
      const std::uint32_t node = place >> fraction_bits;
      cloud.low[k] = node;
      cloud.high[k] = node + 1 == nodes_ ? 0 : node + 1;
      cloud.part[k] = place & (one - 1);
    }
    return cloud;
  }

 private:
  std::uint32_t nodes_;
  float scale_;
};

}  // namespace cosmo
