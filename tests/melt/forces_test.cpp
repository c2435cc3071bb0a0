// Forces and energies against a sum over all pairs that shares nothing with the code under test but the formula's
// paper.
#include "md/forces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "md/observables.h"
#include "states.h"

namespace melt {
namespace {

constexpr long double rc = 2.5L;

// u(r) of lennard_jones.h, in extended precision and in the plainest form.
long double energy(long double r) {
  if (r >= rc) return 0.0L;
  const long double slope = -48.0L * std::pow(rc, -13.0L) + 24.0L * std::pow(rc, -7.0L);
  const auto plain = [](long double x) { return 4.0L * (std::pow(x, -12.0L) - std::pow(x, -6.0L)); };
  return plain(r) - plain(rc) - (r - rc) * slope;
}

struct Oracle {
  std::vector<std::array<long double, 3>> forces;
  long double energy = 0.0L;
  long double virial = 0.0L;
};

Oracle all_pairs(std::span<const Particle> particles, double side) {
  Oracle sum;
  sum.forces.resize(particles.size());
  const long double slope = -48.0L * std::pow(rc, -13.0L) + 24.0L * std::pow(rc, -7.0L);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    for (std::size_t j = i + 1; j < particles.size(); ++j) {
      std::array<long double, 3> d;
      long double r2 = 0.0L;
      for (std::size_t k = 0; k < 3; ++k) {
        d[k] = std::remainder(static_cast<long double>(particles[i].position[k]) - particles[j].position[k],
                              static_cast<long double>(side));
        r2 += d[k] * d[k];
      }
      const long double r = std::sqrt(r2);
      if (r >= rc) continue;
      const long double force = 48.0L * std::pow(r, -13.0L) - 24.0L * std::pow(r, -7.0L) + slope;
      for (std::size_t k = 0; k < 3; ++k) {
        sum.forces[i][k] += force * d[k] / r;
        sum.forces[j][k] -= force * d[k] / r;
      }
      sum.energy += energy(r);
      sum.virial += force * r;
    }
  }
  return sum;
}

TEST(LennardJones, EnergyAndForceVanishAtTheCutoff) {
  const LennardJones potential(2.5);
  const LennardJones::Pair pair = potential(std::nextafter(6.25, 0.0));
  EXPECT_NEAR(pair.energy, 0.0, 1e-15);
  EXPECT_NEAR(pair.force_over_r, 0.0, 1e-15);
}

TEST(LennardJones, ForceIsMinusTheSlopeOfTheEnergy) {
  const LennardJones potential(2.5);
  for (double r = 0.8; r < 2.49; r += 0.01) {
    const double h = 1e-5;
    const double slope = (potential((r + h) * (r + h)).energy - potential((r - h) * (r - h)).energy) / (2.0 * h);
    const double force = potential(r * r).force_over_r * r;
    EXPECT_NEAR(force, -slope, 1e-6 * (1.0 + std::abs(force))) << "r = " << r;
    EXPECT_NEAR(potential(r * r).energy, static_cast<double>(energy(r)), 1e-13 * (1.0 + std::pow(r, -12.0)));
  }
}

// Boxes one, two, three and four list reaches wide, dense and thin.
TEST(Forces, EqualASumOverAllPairs) {
  struct Case {
    std::uint64_t atoms;
    double density;
  };
  for (const Case c : {Case{108, 0.8442}, Case{256, 0.8442}, Case{500, 0.8442}, Case{864, 0.7}, Case{256, 0.1}}) {
    SimulationDesc desc;
    desc.density = c.density;
    Simulation simulation = liquid(c.atoms, 60, desc);
    const Oracle oracle = all_pairs(simulation.particles(), simulation.box().side);
    const Energies energies = simulation.energies();
    EXPECT_NEAR(energies.potential, static_cast<double>(oracle.energy), 1e-12 * static_cast<double>(c.atoms));
    const double virial = 3.0 * simulation.box().volume() * energies.pressure - 2.0 * energies.kinetic;
    EXPECT_NEAR(virial, static_cast<double>(oracle.virial), 1e-11 * static_cast<double>(c.atoms));
    for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(simulation.particles()[i].force[k], static_cast<double>(oracle.forces[i][k]), 1e-10);
      }
    }
  }
}

TEST(Forces, AreTheGradientOfTheEnergy) {
  Simulation simulation = liquid(256, 60);
  std::vector<Particle> particles(simulation.particles().begin(), simulation.particles().end());
  const double h = 1e-5;
  for (std::size_t i = 0; i < particles.size(); i += 37) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = particles[i].position[k];
      particles[i].position[k] = x + h;
      const long double above = all_pairs(particles, simulation.box().side).energy;
      particles[i].position[k] = x - h;
      const long double below = all_pairs(particles, simulation.box().side).energy;
      particles[i].position[k] = x;
      const auto slope = static_cast<double>((above - below) / (2.0L * h));
      // The error of the central difference is h^2 u''' / 6, with u''' up to some 10^5 between atoms that collide.
      EXPECT_NEAR(particles[i].force[k], -slope, 1e-4);
    }
  }
}

// Pair forces are equal and opposite to the last bit; what remains is the rounding of some 60 terms per sum.
TEST(Forces, SumToZero) {
  const Simulation simulation = liquid(4000, 60);
  Vec3 sum{};
  for (const Particle& p : simulation.particles()) {
    for (std::size_t k = 0; k < 3; ++k) sum[k] += p.force[k];
  }
  for (const double s : sum) EXPECT_NEAR(s, 0.0, 1e-10);
}

}  // namespace
}  // namespace melt
