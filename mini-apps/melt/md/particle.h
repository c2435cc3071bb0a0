// One atom as the simulation keeps it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace melt {

// All quantities are in Lennard-Jones reduced units: length in sigma, energy in epsilon, mass in atom masses, time in
// sigma sqrt(m / epsilon), temperature in epsilon / k_B.
using Vec3 = std::array<double, 3>;

// Atoms are records in one array, as in most particle codes that grew around a struct. It is the layout in which zero
// copy matters most: a renderer that insists on packed float triples must gather every position and every velocity,
// about as many bytes again as it wants to read. Here position and velocity are read where they are, 80 bytes apart,
// and a renderer that may permute moves whole records, one cache line and a bit each.
struct Particle {
  Vec3 position;    // within the periodic box, or up to half a list skin outside of it between two list builds
  Vec3 velocity;    // at the time of `position` (velocity Verlet keeps both in step)
  Vec3 force;       // on this atom, at `position`
  std::int64_t id;  // 0 .. N-1; the place in the array says nothing about who an atom is
};

static_assert(sizeof(Particle) == 80 && offsetof(Particle, velocity) == 24 && offsetof(Particle, force) == 48);

}  // namespace melt
