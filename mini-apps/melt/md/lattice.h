// The crystal that a run starts from.
#pragma once

#include <cstdint>
#include <vector>

#include "box.h"
#include "particle.h"

namespace melt {

struct Lattice {
  std::uint64_t cells;  // face-centred cubic unit cells along each side of the box

  std::uint64_t atoms() const { return 4 * cells * cells * cells; }
  // Side of the box in which the crystal has `density` atoms per sigma^3.
  Box box(double density) const;
};

// The smallest cubic fcc crystal with at least `atoms` atoms.
Lattice lattice_for(std::uint64_t atoms);

// Atoms at rest on the lattice points; ids follow the unit cells, x fastest.
std::vector<Particle> fcc_crystal(const Lattice& lattice, const Box& box);

// Maxwell-Boltzmann velocities: total momentum zero, and exactly `temperature`. Atom i has the same velocity whatever
// its place in the array.
void set_velocities(std::vector<Particle>& particles, double temperature, std::uint64_t seed);

}  // namespace melt
