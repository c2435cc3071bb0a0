// Motion under gravity: linear growth, the collapse of a plane wave, conserved quantities, order of the time step.
#include <gtest/gtest.h>

#include "pm/spectrum.h"
#include "states.h"

namespace cosmo {
namespace {

SimulationDesc small(std::uint64_t particles, std::uint64_t steps, double a_end) {
  SimulationDesc desc;
  desc.particles = particles;
  desc.side = 64.0;
  desc.steps = steps;
  desc.a_end = a_end;
  return desc;
}

void finish(Simulation& simulation) {
  while (!simulation.done()) simulation.step();
}

// Amplitudes along `wave` of displacements and momenta, by projection on the wave they started as.
struct Amplitudes {
  double displacement = 0.0;
  double momentum = 0.0;
};
Amplitudes amplitudes(const Simulation& simulation, const std::array<int, 3>& wave) {
  const SimulationDesc& desc = simulation.desc();
  const Particles& particles = simulation.particles();
  const std::vector<Vec3f> unit = plane_wave(desc.particles, wave, 1.0);
  Amplitudes sum;
  double norm = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::array<double, 3> q = lattice_place(desc, particles.id[i]);
    const Vec3f& u = unit[static_cast<std::size_t>(particles.id[i])];
    for (std::size_t k = 0; k < 3; ++k) {
      sum.displacement += u[k] * nearest(particles.position[i][k] - q[k], desc.side);
      sum.momentum += u[k] * particles.momentum[i][k];
      norm += u[k] * u[k];
    }
  }
  return {sum.displacement / norm, sum.momentum / norm};
}

// Waves of small amplitude follow linear theory: by a factor of 40 from redshift 49 on, in a universe that its
// cosmological constant has begun to rule. What is left of the time step's error is below half a percent; what clouds,
// differences and the lattice of the particles do to forces goes with the square of kh.
TEST(Growth, OfPlaneWavesIsLinear) {
  for (const std::array<int, 3>& wave : {std::array{1, 0, 0}, std::array{0, 2, 1}, std::array{1, -1, 2}}) {
    const SimulationDesc desc = small(32, 80, 1.0);
    const double psi = 0.1;  // Mpc/h today; a cell of the mesh has 1
    Simulation simulation(desc, plane_wave(32, wave, psi));
    finish(simulation);
    const Amplitudes a = amplitudes(simulation, wave);
    const Cosmology& c = desc.cosmology;
    const double kh = 2.0 * std::numbers::pi / 64.0 * std::hypot(wave[0], wave[1], wave[2]);
    const double tolerance = 0.005 + 0.25 * kh * kh;
    const double displacement = a.displacement / psi;
    const double momentum = a.momentum / (psi * c.expansion(1.0) * c.growth_rate(1.0));
    const std::string name = std::to_string(wave[0]) + std::to_string(wave[1]) + std::to_string(wave[2]);
    RecordProperty("displacement" + name, std::to_string(displacement));
    RecordProperty("momentum" + name, std::to_string(momentum));
    EXPECT_NEAR(displacement, 1.0, tolerance) << name;
    EXPECT_NEAR(momentum, 1.0, 1.5 * tolerance) << name;
  }
}

// Differences between runs with ever shorter steps fall by four: what is left of them is the mesh's.
TEST(Growth, TimeStepIsOfSecondOrder) {
  const std::array<int, 3> wave = {1, 0, 0};
  const auto final_amplitude = [&](std::uint64_t steps) {
    Simulation simulation(small(16, steps, 0.5), plane_wave(16, wave, 1.0));
    finish(simulation);
    return amplitudes(simulation, wave).displacement;
  };
  const double coarse = final_amplitude(10);
  const double middle = final_amplitude(20);
  const double fine = final_amplitude(40);
  EXPECT_NEAR((coarse - middle) / (middle - fine), 4.0, 0.8);
}

// Until sheets cross, a plane wave of any amplitude moves as Zel'dovich says: x = q + D(a) psi sin(kq), exactly. At 0.9
// of the time of crossing the density peaks at ten times the mean.
TEST(Growth, PancakeCollapsesAsZeldovichSays) {
  const SimulationDesc desc = small(32, 80, 1.0);
  const double k = 2.0 * std::numbers::pi / desc.side;
  const double psi = 0.9 / k;
  Simulation simulation(desc, plane_wave(32, {1, 0, 0}, psi));
  finish(simulation);
  const Particles& particles = simulation.particles();
  const std::vector<Vec3f> unit = plane_wave(32, {1, 0, 0}, 1.0);
  double square = 0.0, speed_square = 0.0, across = 0.0, largest = 0.0;
  const double speed = psi * desc.cosmology.growth_rate(1.0);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::array<double, 3> q = lattice_place(desc, particles.id[i]);
    const double u = unit[static_cast<std::size_t>(particles.id[i])][0];
    const double error = nearest(particles.position[i][0] - q[0] - psi * u, desc.side);
    square += error * error;
    largest = std::max(largest, std::abs(error));
    speed_square += std::pow(particles.momentum[i][0] - speed * u, 2);
    across = std::max({across, std::abs(nearest(particles.position[i][1] - q[1], desc.side)),
                       std::abs(nearest(particles.position[i][2] - q[2], desc.side))});
  }
  const auto n = static_cast<double>(particles.size());
  RecordProperty("rms_error", std::to_string(std::sqrt(square / n)));
  RecordProperty("largest_error", std::to_string(largest));
  // In Mpc/h: a cell has 1, particles moved by up to 9.
  EXPECT_LT(std::sqrt(square / n), 0.06);
  EXPECT_LT(largest, 0.2);
  EXPECT_LT(std::sqrt(speed_square / n), 0.02 * speed);
  EXPECT_LT(across, 1e-3);
}

// The lowest modes of a random field, while all of it is small.
TEST(Growth, OfThePowerSpectrumIsLinear) {
  SimulationDesc desc = small(32, 40, 0.1);
  desc.side = 400.0;
  Simulation simulation(desc);
  const std::vector<PowerBin> start = measure_power(simulation.density(), desc.side, simulation.workers());
  finish(simulation);
  const std::vector<PowerBin> end = measure_power(simulation.density(), desc.side, simulation.workers());
  const double growth = desc.cosmology.growth(desc.a_end) / desc.cosmology.growth(desc.a_start);
  for (std::size_t bin = 0; bin < 4; ++bin) {
    RecordProperty("bin" + std::to_string(bin), std::to_string(end[bin].power / start[bin].power / growth / growth));
    EXPECT_NEAR(end[bin].power / start[bin].power, growth * growth, 0.01 * growth * growth) << end[bin].k;
  }
}

TEST(Growth, MomentumIsConserved) {
  SimulationDesc desc = small(32, 60, 1.0);
  Simulation simulation(desc);
  finish(simulation);
  EXPECT_GT(simulation.density_contrast(), 1.0);  // it did collapse
  for (const double p : simulation.total_momentum()) EXPECT_NEAR(p, 0.0, 1e-6 * simulation.absolute_momentum());
  for (const Vec3f& x : simulation.particles().position) {
    for (const float c : x) ASSERT_TRUE(c >= 0.0f && c < 64.0f);
  }
}

// Colours are what they say: ten to the density is the count of particles around, and speeds belong to positions
// although the momenta between steps are half a step ahead.
TEST(Growth, ColorsAreDensityAndSpeed) {
  SimulationDesc desc = small(16, 40, 0.5);
  Simulation whole(desc);
  for (int i = 0; i < 20; ++i) whole.step();
  whole.color_by_speed();
  const Particles then = whole.particles();
  // The same run, ended at this time: there momenta are those of the positions.
  SimulationDesc half = desc;
  half.a_end = whole.a();
  half.steps = 20;
  Simulation ended(half);
  finish(ended);
  double square = 0.0, error = 0.0;
  for (std::size_t i = 0; i < then.size(); ++i) {
    const Vec3f& p = ended.particles().momentum[i];
    const double speed = 100.0 / half.a_end * std::hypot(p[0], p[1], p[2]);
    square += speed * speed;
    error += std::pow(then.color[i] - speed, 2);
  }
  EXPECT_LT(std::sqrt(error / square), 1e-3);

  whole.color_by_density();
  double mass = 0.0;
  Density plain(16, desc.side);
  plain.deposit(whole.particles().position, whole.workers());
  for (const std::uint64_t weight : plain.weights()) {
    mass += std::pow(static_cast<double>(weight) / static_cast<double>(Clouds::particle), 2);
  }
  // The mean over particles of the density they see is the mean over nodes of its square.
  double seen = 0.0;
  for (const float color : whole.particles().color) seen += std::pow(10.0, color);
  EXPECT_NEAR(seen / mass, 1.0, 1e-3);
}

}  // namespace
}  // namespace cosmo
