// The simulation: state, time step, thermostat.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "box.h"
#include "forces.h"
#include "particle.h"
#include "workers.h"

namespace melt {

struct SimulationDesc {
  std::uint64_t atoms = 32000;  // rounded up to a full cube of fcc cells, 4 k^3
  double density = 0.8442;      // atoms per sigma^3; with T = 0.722 the triple point of the Lennard-Jones substance
  double temperature = 1.6;
  double dt = 0.004;
  double cutoff = 2.5;
  double skin = 0.4;  // the fastest of 0.3, 0.4 and 0.5 in the hot liquid
  std::uint64_t seed = 1;
  int threads = 0;  // 0 = as many as the machine has
};

// What the run knows about its state without another look at the pairs. Energies are of the whole system.
struct Energies {
  double kinetic;
  double potential;
  double temperature;  // 2 K / (3N - 3): the total momentum is fixed
  double pressure;     // (2 K + virial) / 3V
  double total() const { return kinetic + potential; }
};

class Simulation {
 public:
  // Throws std::invalid_argument with a sentence for the user when `desc` cannot be simulated.
  explicit Simulation(const SimulationDesc& desc);

  // One time step by velocity Verlet (Swope et al., J. Chem. Phys. 76, 637 (1982)): second order, symplectic,
  // reversible.
  void step();
  // The same, with the velocities then scaled towards `temperature` within a time of about `tau` (Berendsen et al.,
  // J. Chem. Phys. 81, 3684 (1984)). Enough to bring a crystal to a liquid's temperature; for sampling, use step().
  void step_with_thermostat(double temperature, double tau);

  // The records may be permuted as a whole at any time between steps; say so before the next one.
  std::span<Particle> particles() { return particles_; }
  std::span<const Particle> particles() const { return particles_; }
  void records_moved() { forces_.records_moved(particles_); }

  // Independent, to the last bit, of the order of the records and of the number of threads.
  Energies energies();
  const Box& box() const { return box_; }
  std::uint64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * dt_; }
  std::uint64_t list_builds() const { return forces_.list_builds(); }

 private:
  double kinetic();

  double dt_;
  Box box_;
  Workers workers_;
  std::vector<Particle> particles_;
  Forces forces_;
  Forces::Totals totals_;
  std::uint64_t steps_ = 0;
};

}  // namespace melt
