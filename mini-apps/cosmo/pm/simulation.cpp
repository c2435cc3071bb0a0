#include "simulation.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "initial.h"
#include "power_spectrum.h"
#include "wrap.h"

namespace cosmo {
namespace {

void require(bool condition, const std::string& sentence) {
  if (!condition) throw std::invalid_argument(sentence);
}

SimulationDesc checked(SimulationDesc desc) {
  const Cosmology& c = desc.cosmology;
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (desc.mesh == 0) desc.mesh = 2 * desc.particles;
  require(desc.particles >= 4 && desc.particles <= 1024 && desc.particles % 4 == 0,
          "particles per side must be a multiple of 4, from 4 to 1024");
  require(desc.mesh >= 8 && desc.mesh <= 2048 && desc.mesh % 4 == 0,
          "mesh nodes per side must be a multiple of 4, from 8 to 2048");
  require(positive(desc.side), "the side of the box must be positive");
  require(positive(c.omega_m) && positive(c.h) && positive(c.sigma_8) && std::isfinite(c.n_s) &&
              std::isfinite(c.omega_lambda),
          "omega_m, h and sigma_8 must be positive, omega_lambda and n_s finite");
  require(c.omega_b >= 0.0 && c.omega_b < c.omega_m, "baryons are a part of matter: 0 <= omega_b < omega_m");
  require(positive(desc.a_start) && desc.a_start < desc.a_end && std::isfinite(desc.a_end),
          "the run must start at a positive scale factor before the one it ends at");
  require(desc.steps >= 1, "a run needs a step");
  for (int i = 1; i <= 1000; ++i) {  // a closed universe with much vacuum never had a beginning
    const double a = 0.001 * i * std::max(1.0, desc.a_end);
    require(c.expansion(a) > 0.0, "this universe does not expand from a beginning to the end of the run");
  }
  return desc;
}

std::vector<Vec3f> random_start(const SimulationDesc& given) {
  const SimulationDesc desc = checked(given);
  Workers workers(desc.threads);
  return random_displacements(PowerSpectrum(desc.cosmology), desc.particles, desc.side, desc.seed, workers);
}

}  // namespace

Simulation::Simulation(const SimulationDesc& desc) : Simulation(desc, random_start(desc)) {}

Simulation::Simulation(const SimulationDesc& desc, std::span<const Vec3f> displacements)
    : desc_(checked(desc)),
      workers_(desc_.threads),
      density_(desc_.mesh, desc_.side),
      gravity_(desc_.mesh, desc_.side, desc_.cosmology.omega_m, workers_) {
  require(displacements.size() == desc_.particles * desc_.particles * desc_.particles,
          "there must be one displacement per particle");
  const double offset = 0.5 * desc_.side / static_cast<double>(desc_.mesh);
  zeldovich_start(desc_.cosmology, displacements, desc_.particles, desc_.side, offset, desc_.a_start, particles_,
                  workers_);
  find_forces();
  gravity_.kick(particles_.position, particles_.momentum, leading_kick(), workers_);
}

// Steps of equal sqrt(a), which are equal conformal times while matter dominates: short enough, compared with a, at the
// start, and short enough for the fast particles at the end.
double Simulation::a_at(double step) const {
  const double start = std::sqrt(desc_.a_start);
  const double s = start + (std::sqrt(desc_.a_end) - start) * step / static_cast<double>(desc_.steps);
  return s * s;
}

double Simulation::leading_kick() const {
  if (done()) return 0.0;
  const auto now = static_cast<double>(steps_);
  return desc_.cosmology.kick(a_at(now), a_at(now + 0.5));
}

void Simulation::find_forces() {
  density_.deposit(particles_.position, workers_);
  gravity_.solve(density_, workers_);
}

void Simulation::step() {
  const auto now = static_cast<double>(steps_);
  const auto drift = static_cast<double>(desc_.cosmology.drift(a_at(now), a_at(now + 1.0)));
  const double side = desc_.side;
  workers_.for_blocks(particles_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        particles_.position[i][k] = wrapped(
            static_cast<double>(particles_.position[i][k]) + drift * static_cast<double>(particles_.momentum[i][k]),
            side);
      }
    }
  });
  find_forces();
  ++steps_;
  const double trailing = desc_.cosmology.kick(a_at(now + 0.5), a_at(now + 1.0));
  gravity_.kick(particles_.position, particles_.momentum, trailing + leading_kick(), workers_);
}

void Simulation::color_by_density() {
  // A mesh with one node per particle: on the finer one of the forces, particles in voids would see little but
  // themselves.
  Density smooth(desc_.particles, desc_.side);
  smooth.deposit(particles_.position, workers_);
  smooth.interpolate(particles_.position, particles_.color, workers_);
  // The density is positive: a particle sees at least itself.
  workers_.for_blocks(particles_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) particles_.color[i] = std::log10(particles_.color[i]);
  });
}

void Simulation::color_by_speed() {
  const double ahead = leading_kick();
  const double unit = 100.0 / a();  // peculiar velocity a dx/dt = p / a
  workers_.for_blocks(particles_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f g = gravity_.acceleration(particles_.position[i]);
      double square = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double p = static_cast<double>(particles_.momentum[i][k]) - ahead * static_cast<double>(g[k]);
        square += p * p;
      }
      particles_.color[i] = static_cast<float>(unit * std::sqrt(square));
    }
  });
}

double Simulation::density_contrast() {
  constexpr std::size_t width = 4;  // divides the mesh
  const std::size_t nodes = desc_.mesh;
  const std::size_t cubes = nodes / width;
  const double per_mean = density_.per_mean() / static_cast<double>(width * width * width);
  const double square = workers_.sum(cubes, [&](std::size_t cube) {
    std::vector<std::uint64_t> weights(cubes * cubes);
    for (std::size_t i = 0; i < width * nodes; ++i) {
      // Cubes begin at node 1: the lattice started half a cell before it, so that every small shift crosses a face.
      const std::size_t x = (cube * width + i / nodes + 1) % nodes;
      const std::size_t y = i % nodes;
      const std::uint64_t* const row = &density_.weights()[(x * nodes + y) * nodes];
      std::uint64_t* const to = &weights[(y + nodes - 1) % nodes / width * cubes];
      for (std::size_t z = 0; z < nodes; ++z) to[(z + nodes - 1) % nodes / width] += row[z];
    }
    double sum = 0.0;
    for (const std::uint64_t weight : weights) {
      const double delta = static_cast<double>(weight) * per_mean - 1.0;
      sum += delta * delta;
    }
    return sum;
  });
  return std::sqrt(square / static_cast<double>(cubes * cubes * cubes));
}

std::array<double, 3> Simulation::total_momentum() const {
  std::array<double, 3> total{};
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      total[k] += static_cast<double>(particles_.mass[i]) * static_cast<double>(particles_.momentum[i][k]);
    }
  }
  return total;
}

double Simulation::absolute_momentum() const {
  double total = 0.0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const Vec3f& p = particles_.momentum[i];
    total += static_cast<double>(particles_.mass[i]) * static_cast<double>(std::hypot(p[0], p[1], p[2]));
  }
  return total;
}

}  // namespace cosmo
