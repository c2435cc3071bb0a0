// The simulation: state and time step.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "cosmology.h"
#include "density.h"
#include "gravity.h"
#include "particles.h"
#include "workers.h"

namespace cosmo {

struct SimulationDesc {
  Cosmology cosmology;
  double side = 100.0;            // of the periodic box, comoving Mpc/h
  std::uint64_t particles = 128;  // per side
  std::uint64_t mesh = 0;         // nodes per side; 0 = two per particle
  double a_start = 0.02;          // scale factors; 1 is today
  double a_end = 1.0;
  std::uint64_t steps = 200;
  std::uint64_t seed = 1;
  int threads = 0;  // 0 = as many as the machine has
};

class Simulation {
 public:
  // Throws std::invalid_argument with a sentence for the user when `desc` cannot be simulated.
  explicit Simulation(const SimulationDesc& desc);
  // The same, from displacements of linear theory today instead of random ones, one per place of the lattice.
  Simulation(const SimulationDesc& desc, std::span<const Vec3f> displacements);

  // One kick-drift-kick step. The kick that ends a step and the one that starts the next are of the same forces, and
  // are given at once: between steps momenta are half a step ahead, at the end of the last step they are not.
  void step();
  bool done() const { return steps_ == desc_.steps; }

  // May be permuted as a whole at any time between steps: what happens to a particle does not depend on its place, to
  // the last bit, nor on the number of threads.
  Particles& particles() { return particles_; }
  const Particles& particles() const { return particles_; }
  // Whom pictures show: log10 of the density in units of the mean, or the peculiar velocity in km/s.
  void color_by_density();
  void color_by_speed();

  const SimulationDesc& desc() const { return desc_; }
  std::uint64_t steps() const { return steps_; }
  double a() const { return a_at(static_cast<double>(steps_)); }
  double redshift() const { return 1.0 / a() - 1.0; }
  // Of the state as it is; the mesh is that of the forces.
  const Density& density() const { return density_; }
  // Standard deviation over cubes of 4^3 nodes. Over single nodes the lattice that particles start from would show.
  double density_contrast();
  std::array<double, 3> total_momentum() const;  // in 1e10 solar masses / h * 100 km/s
  double absolute_momentum() const;              // sum of magnitudes, to compare with
  Workers& workers() { return workers_; }

  // All memory that the simulation needs, in bytes.
  std::uint64_t particle_bytes() const { return particles_.bytes(); }
  std::uint64_t mesh_bytes() const { return density_.bytes() + gravity_.bytes(); }

 private:
  double a_at(double step) const;
  double leading_kick() const;  // by how much momenta are ahead of positions
  void find_forces();

  SimulationDesc desc_;
  Workers workers_;
  Density density_;
  Gravity gravity_;
  Particles particles_;
  std::uint64_t steps_ = 0;
};

}  // namespace cosmo
