#include "lattice.h"

#include <cmath>

#include "random.h"

namespace melt {

Box Lattice::box(double density) const { return {std::cbrt(static_cast<double>(atoms()) / density)}; }

Lattice lattice_for(std::uint64_t atoms) {
  auto cells = static_cast<std::uint64_t>(std::cbrt(static_cast<double>(atoms) / 4.0));
  cells = cells > 1 ? cells - 1 : 1;  // start below, whatever cbrt rounds to
  while (Lattice{cells}.atoms() < atoms) ++cells;
  return {cells};
}

std::vector<Particle> fcc_crystal(const Lattice& lattice, const Box& box) {
  // The four atoms of a unit cell, in quarters of its side: the corner and three face centres, moved by a quarter so
  // that no atom starts on the face of the box.
  constexpr double basis[4][3] = {{1, 1, 1}, {3, 3, 1}, {3, 1, 3}, {1, 3, 3}};
  const double quarter = box.side / (4.0 * static_cast<double>(lattice.cells));
  std::vector<Particle> particles;
  particles.reserve(lattice.atoms());
  for (std::uint64_t z = 0; z < lattice.cells; ++z) {
    for (std::uint64_t y = 0; y < lattice.cells; ++y) {
      for (std::uint64_t x = 0; x < lattice.cells; ++x) {
        for (const auto& atom : basis) {
          Particle p{};
          p.position = {quarter * (4.0 * static_cast<double>(x) + atom[0]),
                        quarter * (4.0 * static_cast<double>(y) + atom[1]),
                        quarter * (4.0 * static_cast<double>(z) + atom[2])};
          p.id = static_cast<std::int64_t>(particles.size());
          particles.push_back(p);
        }
      }
    }
  }
  return particles;
}

void set_velocities(std::vector<Particle>& particles, double temperature, std::uint64_t seed) {
  const auto n = static_cast<double>(particles.size());
  Vec3 mean{};
  for (Particle& p : particles) {
    for (std::size_t k = 0; k < 3; ++k) {
      p.velocity[k] = random_normal(seed, 3 * static_cast<std::uint64_t>(p.id) + k);
      mean[k] += p.velocity[k] / n;
    }
  }
  double square = 0.0;
  for (Particle& p : particles) {
    for (std::size_t k = 0; k < 3; ++k) {
      p.velocity[k] -= mean[k];
      square += p.velocity[k] * p.velocity[k];
    }
  }
  // Three degrees of freedom are gone with the total momentum: T = sum(v^2) / (3N - 3).
  const double scale = std::sqrt(temperature * (3.0 * n - 3.0) / square);
  for (Particle& p : particles) {
    for (double& v : p.velocity) v *= scale;
  }
}

}  // namespace melt
