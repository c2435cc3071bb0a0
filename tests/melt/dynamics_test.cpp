// The time step: conserved quantities, order, reversibility.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "md/observables.h"
#include "states.h"

namespace melt {
namespace {

// The standard deviation of the total energy per atom over a fixed time without thermostat.
double energy_fluctuation(double dt, double time) {
  SimulationDesc desc;
  desc.dt = 0.002;
  Simulation start = liquid(500, 250, desc);
  // The same state for every dt.
  desc.dt = dt;
  desc.atoms = 500;
  Simulation simulation(desc);
  std::copy(start.particles().begin(), start.particles().end(), simulation.particles().begin());
  // Forces belong to the old state until the first step is done; the energies counted start after it.
  simulation.step();
  const auto steps = static_cast<int>(std::lround(time / dt));
  double sum = 0.0;
  double square = 0.0;
  const double first = simulation.energies().total() / 500.0;
  for (int i = 0; i < steps; ++i) {
    simulation.step();
    const double e = simulation.energies().total() / 500.0 - first;
    sum += e;
    square += e * e;
  }
  return std::sqrt(square / steps - sum / steps * sum / steps);
}

TEST(Dynamics, StartsAsAsked) {
  SimulationDesc desc;
  desc.atoms = 3000;
  desc.temperature = 1.7;
  Simulation simulation(desc);
  EXPECT_EQ(simulation.particles().size(), 4000u);  // the next 4 k^3
  EXPECT_NEAR(4000.0 / simulation.box().volume(), 0.8442, 1e-12);
  EXPECT_NEAR(simulation.energies().temperature, 1.7, 1e-12);
  for (const double p : total_momentum(simulation.particles())) EXPECT_NEAR(p, 0.0, 1e-11);

  // Maxwell-Boltzmann: each component is normal with variance T, so <v^4> = 3 <v^2>^2; 12000 samples give both moments
  // to about 2 and 4 %.
  double second = 0.0;
  double fourth = 0.0;
  for (const Particle& p : simulation.particles()) {
    for (const double v : p.velocity) {
      second += v * v / 12000.0;
      fourth += v * v * v * v / 12000.0;
    }
  }
  EXPECT_NEAR(second, 1.7, 0.05);
  EXPECT_NEAR(fourth / (3.0 * second * second), 1.0, 0.1);

  desc.seed = 2;
  EXPECT_FALSE(same_atoms(Simulation(desc).particles(), simulation.particles()));
}

TEST(Dynamics, RefusesWhatCannotBeSimulated) {
  SimulationDesc desc;
  desc.atoms = 32;  // box side 3.4, cutoff 2.5
  EXPECT_THROW(Simulation{desc}, std::invalid_argument);
  desc = {};
  desc.density = 0.0;
  EXPECT_THROW(Simulation{desc}, std::invalid_argument);
  desc = {};
  desc.dt = std::nan("");
  EXPECT_THROW(Simulation{desc}, std::invalid_argument);
  desc = {};
  desc.temperature = -1.0;
  EXPECT_THROW(Simulation{desc}, std::invalid_argument);
}

// 3000 steps without thermostat in the hot liquid: the energy per atom stays within 1e-3 (in epsilon; its kinetic part
// is 2.4), and what trend there is within 2e-4; momentum stays zero to rounding.
TEST(Dynamics, EnergyAndMomentumAreConserved) {
  Simulation simulation = liquid(500, 500);
  const double start = simulation.energies().total() / 500.0;
  double largest = 0.0;
  double first_half = 0.0;
  double second_half = 0.0;
  const int steps = 3000;
  for (int i = 0; i < steps; ++i) {
    simulation.step();
    const double e = simulation.energies().total() / 500.0 - start;
    largest = std::max(largest, std::abs(e));
    (i < steps / 2 ? first_half : second_half) += e / (steps / 2);
  }
  RecordProperty("largest_departure", std::to_string(largest));
  RecordProperty("trend", std::to_string(second_half - first_half));
  EXPECT_LT(largest, 1e-3);
  EXPECT_LT(std::abs(second_half - first_half), 2e-4);
  for (const double p : total_momentum(simulation.particles())) EXPECT_NEAR(p, 0.0, 1e-10);
}

// Velocity Verlet conserves a shadow energy that differs from the energy by O(dt^2).
TEST(Dynamics, EnergyFluctuationIsOfSecondOrderInTheTimeStep) {
  const double coarse = energy_fluctuation(0.004, 2.0);
  const double middle = energy_fluctuation(0.002, 2.0);
  const double fine = energy_fluctuation(0.001, 2.0);
  EXPECT_NEAR(coarse / middle, 4.0, 0.8);
  EXPECT_NEAR(middle / fine, 4.0, 0.8);
}

TEST(Dynamics, IsReversible) {
  Simulation simulation = liquid(256, 300);
  const std::vector<Particle> start = by_id(simulation.particles());
  for (int i = 0; i < 200; ++i) simulation.step();
  EXPECT_GT(std::abs(simulation.particles()[0].position[0] - start[0].position[0]), 1e-3);  // it did move
  for (Particle& p : simulation.particles()) {
    for (double& v : p.velocity) v = -v;
  }
  for (int i = 0; i < 200; ++i) simulation.step();
  // Rounding, some 1e-16 per step, grows by chaos: exp(2 t) or so over a time of 1.6.
  const std::vector<Particle> end = by_id(simulation.particles());
  for (std::size_t i = 0; i < end.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(simulation.box().nearest(end[i].position[k] - start[i].position[k]), 0.0, 1e-10);
      EXPECT_NEAR(end[i].velocity[k], -start[i].velocity[k], 1e-9);
    }
  }
}

TEST(Dynamics, ThermostatReachesItsTemperature) {
  Simulation simulation = liquid(500, 400);
  EXPECT_NEAR(simulation.energies().temperature, 1.6, 0.1);
  for (int i = 0; i < 400; ++i) simulation.step_with_thermostat(0.8, 0.05);
  EXPECT_NEAR(simulation.energies().temperature, 0.8, 0.05);
}

}  // namespace
}  // namespace melt
