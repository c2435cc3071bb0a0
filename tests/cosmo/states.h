// States to test on, and comparisons that do not care about the order of the particles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "pm/simulation.h"

namespace cosmo {

inline std::vector<Vec3f> random_positions(std::size_t count, double side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> anywhere(0.0f, static_cast<float>(side));
  std::vector<Vec3f> positions(count);
  for (Vec3f& p : positions) {
    for (float& x : p) x = std::min(anywhere(random), std::nextafter(static_cast<float>(side), 0.0f));
  }
  return positions;
}

// Displacements of today along `wave`, a wave vector in units of the lowest: psi = amplitude direction sin(k q).
inline std::vector<Vec3f> plane_wave(std::size_t nodes, const std::array<int, 3>& wave, double amplitude) {
  const double length = std::hypot(wave[0], wave[1], wave[2]);
  std::vector<Vec3f> displacements(nodes * nodes * nodes);
  for (std::size_t i = 0; i < displacements.size(); ++i) {
    const std::size_t place[3] = {i / nodes / nodes, i / nodes % nodes, i % nodes};
    double phase = 0.0;
    for (std::size_t k = 0; k < 3; ++k) phase += wave[k] * static_cast<double>(place[k]);
    phase *= 2.0 * std::numbers::pi / static_cast<double>(nodes);
    for (std::size_t k = 0; k < 3; ++k) {
      displacements[i][k] = static_cast<float>(amplitude * wave[k] / length * std::sin(phase));
    }
  }
  return displacements;
}

// Where the particle with this id was before it was displaced.
inline std::array<double, 3> lattice_place(const SimulationDesc& desc, std::int64_t id) {
  const auto n = static_cast<std::int64_t>(desc.particles);
  const std::int64_t place[3] = {id / n / n, id / n % n, id % n};
  std::array<double, 3> q{};
  for (std::size_t k = 0; k < 3; ++k) {
    q[k] = desc.side * (static_cast<double>(place[k]) / static_cast<double>(n) +
                        0.5 / static_cast<double>(desc.mesh == 0 ? 2 * desc.particles : desc.mesh));
  }
  return q;
}

// The shortest of the differences between two coordinates over all periodic images.
inline double nearest(double d, double side) { return d - side * std::round(d / side); }

// Everything that belongs to a particle, by id.
inline Particles by_id(const Particles& particles) {
  Particles sorted;
  sorted.resize(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const auto to = static_cast<std::size_t>(particles.id[i]);
    sorted.position[to] = particles.position[i];
    sorted.momentum[to] = particles.momentum[i];
    sorted.id[to] = particles.id[i];
    sorted.mass[to] = particles.mass[i];
    sorted.color[to] = particles.color[i];
  }
  return sorted;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

// The same particles with the same positions and momenta, to the last bit, in any order.
inline bool same_particles(const Particles& a, const Particles& b) {
  const Particles x = by_id(a);
  const Particles y = by_id(b);
  return same_bytes(x.position, y.position) && same_bytes(x.momentum, y.momentum) && same_bytes(x.id, y.id) &&
         same_bytes(x.mass, y.mass);
}

inline void shuffle(Particles& particles, unsigned seed) {
  std::mt19937 random(seed);
  for (std::size_t i = particles.size() - 1; i > 0; --i) {
    const std::size_t j = random() % (i + 1);
    std::swap(particles.position[i], particles.position[j]);
    std::swap(particles.momentum[i], particles.momentum[j]);
    std::swap(particles.id[i], particles.id[j]);
    std::swap(particles.mass[i], particles.mass[j]);
    std::swap(particles.color[i], particles.color[j]);
  }
}

}  // namespace cosmo
