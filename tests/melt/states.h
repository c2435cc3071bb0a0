// States to test on, and comparisons that do not care about the order of the records.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "md/simulation.h"

namespace melt {

// A liquid after `steps` steps of melting.
inline Simulation liquid(std::uint64_t atoms, std::uint64_t steps, SimulationDesc desc = {}) {
  desc.atoms = atoms;
  Simulation simulation(desc);
  for (std::uint64_t i = 0; i < steps; ++i) simulation.step_with_thermostat(desc.temperature, 0.05);
  return simulation;
}

inline std::vector<Particle> by_id(std::span<const Particle> particles) {
  std::vector<Particle> sorted(particles.begin(), particles.end());
  std::sort(sorted.begin(), sorted.end(), [](const Particle& a, const Particle& b) { return a.id < b.id; });
  return sorted;
}

inline bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
inline bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a[0], b[0]) && same_bits(a[1], b[1]) && same_bits(a[2], b[2]);
}
// The same atoms with the same positions, velocities and forces, to the last bit, in any order.
inline bool same_atoms(std::span<const Particle> a, std::span<const Particle> b) {
  const std::vector<Particle> x = by_id(a);
  const std::vector<Particle> y = by_id(b);
  return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const Particle& p, const Particle& q) {
    return p.id == q.id && same_bits(p.position, q.position) && same_bits(p.velocity, q.velocity) &&
           same_bits(p.force, q.force);
  });
}

inline void shuffle(Simulation& simulation, unsigned seed) {
  std::mt19937 random(seed);
  const std::span<Particle> particles = simulation.particles();
  for (std::size_t i = particles.size() - 1; i > 0; --i) std::swap(particles[i], particles[random() % (i + 1)]);
  simulation.records_moved();
}

}  // namespace melt
