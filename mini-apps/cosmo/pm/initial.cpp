#include "initial.h"

#include <cmath>
#include <numbers>

#include "fourier.h"
#include "random.h"
#include "wrap.h"

namespace cosmo {
namespace {

// Of the universe at H0 = 100 km/s/Mpc, in 1e10 solar masses / h per (Mpc/h)^3.
constexpr double critical_density = 27.7536627;

Field white_noise(std::size_t nodes, std::uint64_t seed, Workers& workers) {
  Field noise(nodes);
  workers.for_each(nodes, [&](std::size_t x) {
    for (std::size_t y = 0; y < nodes; ++y) {
      float* const row = noise.row(x, y);
      for (std::size_t z = 0; z < nodes; ++z) {
        row[z] = static_cast<float>(random_normal(seed, (x * nodes + y) * nodes + z));
      }
    }
  });
  return noise;
}

}  // namespace

std::vector<Vec3f> random_displacements(const PowerSpectrum& power, std::size_t nodes, double side, std::uint64_t seed,
                                        Workers& workers) {
  const auto n = static_cast<double>(nodes);
  const double lowest = 2.0 * std::numbers::pi / side;
  // The transform of white noise, not normalised, has variance n^3; that of a field with power P has P n^6 / V. So a
  // mode of the noise is multiplied by i times its wave number times sqrt(P n^3 / V) / k^2 / n^3, tabulated by the
  // square of the wave number, an integer in units of the lowest.
  const std::size_t half = nodes / 2;
  std::vector<float> amplitude(3 * half * half + 1);
  for (std::size_t square = 1; square < amplitude.size(); ++square) {
    const double index = std::sqrt(static_cast<double>(square));
    const double k = lowest * index;
    const double delta = std::sqrt(power(k) * n * n * n / (side * side * side));
    amplitude[square] = static_cast<float>(delta / (k * index) / (n * n * n));
  }

  const Fourier fourier(nodes);
  std::vector<Vec3f> displacements(nodes * nodes * nodes);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Field field = white_noise(nodes, seed, workers);
    // -div psi = delta is psi_k = i k / k^2 delta_k.
    fourier.filter(field, workers, [&](const Modes& modes) {
      const std::ptrdiff_t y = Fourier::wave_number(modes.y, nodes);
      for (std::size_t i = 0; i < nodes; ++i) {
        const std::ptrdiff_t x = Fourier::wave_number(i, nodes);
        for (std::size_t c = 0; c < modes.count; ++c) {
          const auto z = static_cast<std::ptrdiff_t>(modes.z + c);
          const std::ptrdiff_t wave[3] = {x, y, z};
          // A mode that changes sign from place to place has no derivative that is real.
          const bool none = wave[axis] == static_cast<std::ptrdiff_t>(half);
          const auto k = none ? 0.0f : static_cast<float>(wave[axis]);
          const float a = amplitude[static_cast<std::size_t>(x * x + y * y + z * z)];
          modes.at(i, c) *= std::complex<float>(0.0f, k * a);
        }
      }
    });
    workers.for_each(nodes, [&](std::size_t x) {
      for (std::size_t y = 0; y < nodes; ++y) {
        const float* const row = field.row(x, y);
        for (std::size_t z = 0; z < nodes; ++z) displacements[(x * nodes + y) * nodes + z][axis] = row[z];
      }
    });
  }
  return displacements;
}

void zeldovich_start(const Cosmology& cosmology, std::span<const Vec3f> displacements, std::size_t nodes, double side,
                     double offset, double a, Particles& particles, Workers& workers) {
  const std::size_t count = nodes * nodes * nodes;
  const double growth = cosmology.growth(a);
  const double speed = a * a * cosmology.expansion(a) * cosmology.growth_rate(a) * growth;
  const double spacing = side / static_cast<double>(nodes);
  const double mass = cosmology.omega_m * critical_density * side * side * side / static_cast<double>(count);
  particles.resize(count);
  workers.for_blocks(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t place[3] = {i / nodes / nodes, i / nodes % nodes, i % nodes};
      for (std::size_t k = 0; k < 3; ++k) {
        const double q = spacing * static_cast<double>(place[k]) + offset;
        const double psi = displacements[i][k];
        particles.position[i][k] = wrapped(q + growth * psi, side);
        particles.momentum[i][k] = static_cast<float>(speed * psi);
      }
      particles.id[i] = static_cast<std::int64_t>(i);
      particles.mass[i] = static_cast<float>(mass);
      particles.color[i] = 0.0f;
    }
  });
}

}  // namespace cosmo
