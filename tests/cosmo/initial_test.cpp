// The random field at the start has the spectrum that was asked for.
#include <gtest/gtest.h>

#include "pm/initial.h"
#include "pm/spectrum.h"
#include "states.h"

namespace cosmo {
namespace {

// Each mode is a complex Gaussian: its power has a standard deviation as large as its mean, and half of the modes are
// independent of the others. Up to half of the lattice's highest wave number, where a lattice still shows a field.
TEST(Initial, PowerSpectrumIsTheOneAskedFor) {
  SimulationDesc desc;
  desc.particles = 64;
  desc.a_start = 0.01;
  const PowerSpectrum linear(desc.cosmology);
  const double growth = desc.cosmology.growth(desc.a_start);
  double sum = 0.0, modes = 0.0, chi_square = 0.0;
  int bins = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    desc.seed = seed;
    Simulation simulation(desc);
    for (const PowerBin& bin : measure_power(simulation.density(), desc.side, simulation.workers())) {
      if (bin.k > 0.5 * std::numbers::pi * 64.0 / desc.side) break;
      const double ratio = bin.power / (growth * growth * linear(bin.k));
      const auto count = static_cast<double>(bin.modes);
      sum += count * ratio;
      modes += count;
      chi_square += (ratio - 1.0) * (ratio - 1.0) * 0.5 * count;
      ++bins;
    }
  }
  RecordProperty("mean_ratio", std::to_string(sum / modes));
  RecordProperty("chi_square_per_bin", std::to_string(chi_square / bins));
  EXPECT_NEAR(sum / modes, 1.0, 3.0 * std::sqrt(2.0 / modes) + 0.01);
  EXPECT_GT(chi_square / bins, 0.4);  // 32 bins: 1 +- 0.25
  EXPECT_LT(chi_square / bins, 1.8);
}

TEST(Initial, FieldDependsOnTheSeedAlone) {
  const PowerSpectrum power{Cosmology()};
  Workers one(1), several(0);
  const std::vector<Vec3f> a = random_displacements(power, 16, 50.0, 1, one);
  EXPECT_TRUE(same_bytes(a, random_displacements(power, 16, 50.0, 1, several)));
  EXPECT_FALSE(same_bytes(a, random_displacements(power, 16, 50.0, 2, several)));
  // Twice as large fluctuations, twice as large displacements.
  Cosmology strong;
  strong.sigma_8 *= 2.0;
  const std::vector<Vec3f> b = random_displacements(PowerSpectrum(strong), 16, 50.0, 1, one);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(b[i][0], 2.0f * a[i][0], 1e-4f);
}

TEST(Initial, ParticlesStartAsZeldovichSays) {
  SimulationDesc desc;
  desc.particles = 16;
  desc.mesh = 32;
  desc.side = 50.0;
  const Cosmology& c = desc.cosmology;
  Workers workers(2);
  const std::vector<Vec3f> psi = random_displacements(PowerSpectrum(c), 16, 50.0, 4, workers);
  Particles particles;
  const double a = 0.1;
  zeldovich_start(c, psi, 16, 50.0, 0.5 * 50.0 / 32.0, a, particles, workers);
  ASSERT_EQ(particles.size(), 4096u);
  double mass = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    ASSERT_EQ(particles.id[i], static_cast<std::int64_t>(i));
    const std::array<double, 3> q = lattice_place(desc, particles.id[i]);
    // a^2 dx/dt by a difference over time: da/dt = a E.
    const double da = 1e-4;
    const double rate = a * a * a * c.expansion(a) * (c.growth(a + da) - c.growth(a - da)) / (2.0 * da);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GE(particles.position[i][k], 0.0f);
      EXPECT_LT(particles.position[i][k], 50.0f);
      EXPECT_NEAR(nearest(particles.position[i][k] - q[k] - c.growth(a) * psi[i][k], 50.0), 0.0, 1e-5);
      EXPECT_NEAR(particles.momentum[i][k], rate * psi[i][k], 1e-5);
    }
    mass += particles.mass[i];
  }
  // 2.775e11 h^2 solar masses per cubic megaparsec is the critical density.
  EXPECT_NEAR(mass / (27.75 * c.omega_m * 50.0 * 50.0 * 50.0), 1.0, 1e-3);
}

TEST(Initial, RefusesWhatCannotBeSimulated) {
  const auto refused = [](const std::function<void(SimulationDesc&)>& change) {
    SimulationDesc desc;
    desc.particles = 8;
    change(desc);
    EXPECT_THROW(Simulation{desc}, std::invalid_argument);
  };
  refused([](SimulationDesc& d) { d.particles = 9; });
  refused([](SimulationDesc& d) { d.mesh = 18; });
  refused([](SimulationDesc& d) { d.side = 0.0; });
  refused([](SimulationDesc& d) { d.side = std::nan(""); });
  refused([](SimulationDesc& d) { d.a_start = 0.0; });
  refused([](SimulationDesc& d) { d.a_end = d.a_start; });
  refused([](SimulationDesc& d) { d.steps = 0; });
  refused([](SimulationDesc& d) { d.cosmology.omega_b = d.cosmology.omega_m; });
  refused([](SimulationDesc& d) { d.cosmology.omega_m = -1.0; });
  refused([](SimulationDesc& d) { d.cosmology.omega_lambda = 5.0; });
  SimulationDesc desc;
  desc.particles = 8;
  EXPECT_THROW(Simulation(desc, std::vector<Vec3f>(511)), std::invalid_argument);
}

}  // namespace
}  // namespace cosmo
