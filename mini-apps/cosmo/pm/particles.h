// What the simulation keeps of its particles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cosmo {

using Vec3f = std::array<float, 3>;

// Arrays side by side, as cosmological codes have kept them since GADGET: 40 bytes per particle. All may be permuted
// together between steps; the place in the arrays says nothing about who a particle is.
struct Particles {
  std::vector<Vec3f> position;   // comoving Mpc/h, in [0, side)
  std::vector<Vec3f> momentum;   // per mass: a^2 dx/dt, in 100 km/s
  std::vector<std::int64_t> id;  // place in the starting lattice, x slowest
  std::vector<float> mass;       // 1e10 solar masses / h
  std::vector<float> color;      // what pictures show: refreshed for each of them

  std::size_t size() const { return position.size(); }
  void resize(std::size_t count) {
    position.resize(count);
    momentum.resize(count);
    id.resize(count);
    mass.resize(count);
    color.resize(count);
  }
  std::uint64_t bytes() const { return size() * (2 * sizeof(Vec3f) + sizeof(std::int64_t) + 2 * sizeof(float)); }
};

}  // namespace cosmo
