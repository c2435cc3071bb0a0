#include "simulation.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "lattice.h"

namespace melt {
namespace {

Lattice checked_lattice(const SimulationDesc& desc) {
  const auto positive = [](double v, const char* what) {
    if (!(v > 0.0 && std::isfinite(v))) throw std::invalid_argument(std::string(what) + " must be above zero");
  };
  positive(desc.density, "the density");
  positive(desc.temperature, "the temperature");
  positive(desc.dt, "the time step");
  positive(desc.cutoff, "the cutoff");
  positive(desc.skin, "the list skin");
  if (desc.atoms > std::numeric_limits<std::uint32_t>::max() / 2) {
    throw std::invalid_argument("too many atoms: places in the array are kept as 32-bit numbers");
  }
  const Lattice lattice = lattice_for(desc.atoms);
  // Below this an atom would see two images of the same neighbour.
  if (lattice.box(desc.density).side < 2.0 * desc.cutoff) {
    throw std::invalid_argument("too few atoms: the box (side " + std::to_string(lattice.box(desc.density).side) +
                                ") must be at least twice as wide as the cutoff of " + std::to_string(desc.cutoff));
  }
  return lattice;
}

}  // namespace

Simulation::Simulation(const SimulationDesc& desc)
    : dt_(desc.dt),
      box_(checked_lattice(desc).box(desc.density)),
      workers_(desc.threads),
      particles_(fcc_crystal(lattice_for(desc.atoms), box_)),
      forces_(box_, LennardJones(desc.cutoff), desc.skin, particles_.size()) {
  set_velocities(particles_, desc.temperature, desc.seed);
  totals_ = forces_.compute(particles_, workers_);
}

void Simulation::step() {
  const double half = 0.5 * dt_;
  workers_.for_each(particles_.size(), [&](std::size_t i) {
    Particle& p = particles_[i];
    for (std::size_t k = 0; k < 3; ++k) {
      p.velocity[k] += half * p.force[k];
      p.position[k] += dt_ * p.velocity[k];
    }
  });
  totals_ = forces_.compute(particles_, workers_);
  workers_.for_each(particles_.size(), [&](std::size_t i) {
    Particle& p = particles_[i];
    for (std::size_t k = 0; k < 3; ++k) p.velocity[k] += half * p.force[k];
  });
  ++steps_;
}

void Simulation::step_with_thermostat(double temperature, double tau) {
  step();
  const double now = energies().temperature;
  const double scale = std::sqrt(1.0 + dt_ / tau * (temperature / now - 1.0));
  workers_.for_each(particles_.size(), [&](std::size_t i) {
    for (double& v : particles_[i].velocity) v *= scale;
  });
}

double Simulation::kinetic() {
  const std::span<const std::uint32_t> places = forces_.places();
  return workers_.sum(places.size(), [&](std::size_t slot) {
    const Vec3& v = particles_[places[slot]].velocity;
    return 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  });
}

Energies Simulation::energies() {
  const double k = kinetic();
  return {k, totals_.energy, 2.0 * k / (3.0 * static_cast<double>(particles_.size()) - 3.0),
          (2.0 * k + totals_.virial) / (3.0 * box_.volume())};
}

}  // namespace melt
