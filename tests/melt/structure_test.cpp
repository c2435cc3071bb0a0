// Structure of crystal and liquid, against geometry and published numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "md/lattice.h"
#include "md/observables.h"
#include "states.h"

namespace melt {
namespace {

TEST(Lattice, HasAtLeastTheAtomsAskedFor) {
  EXPECT_EQ(lattice_for(1).atoms(), 4u);
  EXPECT_EQ(lattice_for(4).atoms(), 4u);
  EXPECT_EQ(lattice_for(5).atoms(), 32u);
  EXPECT_EQ(lattice_for(4000).atoms(), 4000u);
  EXPECT_EQ(lattice_for(4001).atoms(), 5324u);
  EXPECT_EQ(lattice_for(32000).cells, 20u);
  for (std::uint64_t k = 1; k < 300; ++k) EXPECT_EQ(lattice_for(4 * k * k * k).cells, k);
}

// Face-centred cubic: 12 neighbours at a / sqrt(2), 6 at a, 24 at a sqrt(3/2), 12 at a sqrt(2).
TEST(Lattice, ShellsAreThoseOfTheFaceCentredCube) {
  const Lattice lattice{6};
  const Box box = lattice.box(0.8442);
  const double a = box.side / 6.0;
  RadialDistribution shells(2.0 * a, 2000);
  shells.add(fcc_crystal(lattice, box), box);
  const auto at = [&](double r) { return shells.neighbours(0.99 * r, 1.01 * r); };
  EXPECT_EQ(at(a / std::numbers::sqrt2), 12.0);
  EXPECT_EQ(at(a), 6.0);
  EXPECT_EQ(at(a * std::sqrt(1.5)), 24.0);
  EXPECT_EQ(at(a * std::numbers::sqrt2), 12.0);
  EXPECT_EQ(shells.neighbours(0.0, 1.42 * a), 54.0);  // and none elsewhere
  EXPECT_NEAR(translational_order(fcc_crystal(lattice, box), box, 6), 1.0, 1e-12);
}

TEST(Lattice, MeltsUnderTheThermostat) {
  Simulation simulation = liquid(4000, 500);
  EXPECT_LT(translational_order(simulation.particles(), simulation.box(), 10), 0.06);
}

TEST(RadialDistribution, IsOneWithoutStructure) {
  const Box box{12.0};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(0.0, box.side);
  std::vector<Particle> gas(3000);
  for (Particle& p : gas) p.position = {coordinate(random), coordinate(random), coordinate(random)};
  RadialDistribution g(6.0, 12);
  g.add(gas, box);
  for (std::size_t bin = 1; bin < 12; ++bin) EXPECT_NEAR(g.values()[bin], 1.0, 0.06);  // first bins: few pairs
  RadialDistribution sampled(6.0, 12);
  sampled.add(gas, box, 5);
  EXPECT_NEAR(sampled.values()[11], 1.0, 0.02);
}

// The liquid near the triple point (density 0.8442, T 0.722). Its g(r) is in every textbook: first peak of about 3.0 at
// 1.09, first minimum of 0.55 at 1.55, second peak of 1.3 at 2.1 (Verlet, Phys. Rev. 165, 201 (1968); Hansen &
// McDonald, Theory of Simple Liquids). The truncation of the potential changes it by a percent or two.
TEST(Liquid, RadialDistributionNearTheTriplePoint) {
  Simulation simulation = liquid(2048, 400);
  for (int i = 0; i < 500; ++i) simulation.step_with_thermostat(0.722, 0.05);
  RadialDistribution distribution(6.0, 240);
  double temperature = 0.0;
  for (int sample = 0; sample < 20; ++sample) {
    for (int i = 0; i < 25; ++i) simulation.step();
    distribution.add(simulation.particles(), simulation.box(), 2);
    temperature += simulation.energies().temperature / 20.0;
  }
  EXPECT_NEAR(temperature, 0.722, 0.03);
  const std::vector<double> g = distribution.values();
  const auto bin = [&](double r) { return static_cast<std::size_t>(r / 6.0 * 240.0); };
  for (std::size_t i = 0; i < bin(0.85); ++i) EXPECT_EQ(g[i], 0.0) << "atoms overlap at " << distribution.radius(i);

  const auto peak = std::max_element(g.begin(), g.end());
  EXPECT_NEAR(distribution.radius(static_cast<std::size_t>(peak - g.begin())), 1.09, 0.03);
  EXPECT_NEAR(*peak, 2.95, 0.2);
  const auto dip = std::min_element(g.begin() + static_cast<long>(bin(1.2)), g.begin() + static_cast<long>(bin(1.9)));
  EXPECT_NEAR(distribution.radius(static_cast<std::size_t>(dip - g.begin())), 1.55, 0.08);
  EXPECT_NEAR(*dip, 0.55, 0.08);
  const auto second =
      std::max_element(g.begin() + static_cast<long>(bin(1.9)), g.begin() + static_cast<long>(bin(2.5)));
  EXPECT_NEAR(distribution.radius(static_cast<std::size_t>(second - g.begin())), 2.1, 0.1);
  EXPECT_NEAR(*second, 1.28, 0.08);
  for (std::size_t i = bin(5.0); i < g.size(); ++i) EXPECT_NEAR(g[i], 1.0, 0.06);
  EXPECT_NEAR(distribution.neighbours(0.0, 1.55), 12.2, 0.5);  // of the first shell
}

// Energy and pressure of the full Lennard-Jones liquid at T = 0.85, density 0.776 and 0.86: -5.5121 and -6.0305, 0.007
// and 1.266 (NIST Standard Reference Simulation Website, NVT Monte Carlo). With a cutoff of 3 the structures of the
// force-shifted and of the full liquid agree well enough to average the full potential over our states: plain pairs up
// to the cutoff and the usual corrections for the tail (Allen & Tildesley, chapter 2). The statistical error of a run
// this short is about 0.006 in energy and 0.04 in pressure.
TEST(Liquid, EnergyAndPressureOfTheFullPotential) {
  struct Point {
    double density, energy, pressure;
  };
  constexpr double cutoff = 3.0;
  for (const Point point : {Point{0.776, -5.5121, 0.007}, Point{0.86, -6.0305, 1.266}}) {
    SimulationDesc desc;
    desc.density = point.density;
    desc.cutoff = cutoff;
    Simulation simulation = liquid(864, 300, desc);
    for (int i = 0; i < 300; ++i) simulation.step_with_thermostat(0.85, 0.02);
    double energy = 0.0;
    double pressure = 0.0;
    double temperature = 0.0;
    constexpr int samples = 40;
    for (int sample = 0; sample < samples; ++sample) {
      for (int i = 0; i < 20; ++i) simulation.step_with_thermostat(0.85, 0.5);
      const std::span<const Particle> particles = simulation.particles();
      const double t = simulation.energies().temperature;
      double u = 0.0;
      double w = 0.0;
      for (std::size_t i = 0; i < particles.size(); ++i) {
        for (std::size_t j = i + 1; j < particles.size(); ++j) {
          double r2 = 0.0;
          for (std::size_t k = 0; k < 3; ++k) {
            const double d = simulation.box().nearest(particles[i].position[k] - particles[j].position[k]);
            r2 += d * d;
          }
          if (r2 >= cutoff * cutoff) continue;
          const double inv6 = 1.0 / (r2 * r2 * r2);
          u += 4.0 * inv6 * (inv6 - 1.0);
          w += 48.0 * inv6 * (inv6 - 0.5);
        }
      }
      energy += u / 864.0 / samples;
      pressure += (point.density * t + w / (3.0 * simulation.box().volume())) / samples;
      temperature += t / samples;
    }
    const double inv3 = 1.0 / (cutoff * cutoff * cutoff);
    const double inv9 = inv3 * inv3 * inv3;
    energy += 8.0 / 3.0 * std::numbers::pi * point.density * (inv9 / 3.0 - inv3);
    pressure += 16.0 / 3.0 * std::numbers::pi * point.density * point.density * (2.0 / 3.0 * inv9 - inv3);
    RecordProperty("energy_" + std::to_string(point.density), std::to_string(energy));
    RecordProperty("pressure_" + std::to_string(point.density), std::to_string(pressure));
    EXPECT_NEAR(temperature, 0.85, 0.01);
    EXPECT_NEAR(energy, point.energy, 0.025);
    EXPECT_NEAR(pressure, point.pressure, 0.12);
  }
}

}  // namespace
}  // namespace melt
