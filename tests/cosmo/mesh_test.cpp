// Mass on the mesh, and the transforms.
#include <gtest/gtest.h>

#include "pm/fourier.h"
#include "states.h"

namespace cosmo {
namespace {

constexpr double side = 37.0;

std::uint64_t total(const Density& density) {
  const auto weights = density.weights();
  return std::accumulate(weights.begin(), weights.end(), std::uint64_t{0});
}

// The cloud of a particle overlaps the cells of eight nodes, written down without cells: a node at a distance of d
// nodes along an axis gets 1 - |d|.
double share(double distance) { return std::max(0.0, 1.0 - std::abs(distance)); }

TEST(Density, NoMassIsLost) {
  Workers workers(2);
  Density density(12, side);
  std::vector<Vec3f> positions = random_positions(5000, side, 1);
  const float last = std::nextafter(static_cast<float>(side), 0.0f);
  for (const float x : {0.0f, last, 1e-30f, static_cast<float>(side / 12), static_cast<float>(side / 24)}) {
    positions.push_back({x, x, x});
    positions.push_back({x, 0.0f, last});
  }
  density.deposit(positions, workers);
  EXPECT_EQ(total(density), positions.size() * Clouds::particle);
}

TEST(Density, IsThatOfClouds) {
  Workers workers(2);
  const std::size_t nodes = 8;
  Density density(nodes, side);
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Vec3f> positions = random_positions(3, side, seed);
    density.deposit(positions, workers);
    for (std::size_t i = 0; i < nodes * nodes * nodes; ++i) {
      const std::size_t node[3] = {i / nodes / nodes, i / nodes % nodes, i % nodes};
      double expected = 0.0;
      for (const Vec3f& p : positions) {
        double product = 1.0;
        for (std::size_t k = 0; k < 3; ++k) {
          product *= share(nearest(static_cast<double>(p[k]) / side * nodes - static_cast<double>(node[k]), nodes));
        }
        expected += product;
      }
      const double found = static_cast<double>(density.weights()[i]) / static_cast<double>(Clouds::particle);
      EXPECT_NEAR(found, expected, 1e-3);  // places are known to 2^-14 of a cell, along three axes, three particles
    }
  }
}

TEST(Density, DependsNeitherOnOrderNorOnThreads) {
  std::vector<Vec3f> positions = random_positions(20'000, side, 3);
  Density one(16, side);
  Workers alone(1);
  one.deposit(positions, alone);
  for (const int threads : {2, 0}) {
    std::reverse(positions.begin(), positions.end());
    Workers workers(threads);
    Density several(16, side);
    several.deposit(positions, workers);
    EXPECT_TRUE(std::equal(one.weights().begin(), one.weights().end(), several.weights().begin()));
  }
}

// A lattice with one, or one eighth of a particle per cell, half a cell off the nodes, is even to the last bit.
TEST(Density, OfALatticeIsTheMean) {
  Workers workers(2);
  for (const std::size_t mesh : {8u, 16u}) {
    SimulationDesc desc;
    desc.particles = 8;
    desc.mesh = mesh;
    desc.side = 64.0;
    std::vector<Vec3f> positions;
    for (std::int64_t id = 0; id < 512; ++id) {
      const std::array<double, 3> q = lattice_place(desc, id);
      positions.push_back({static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])});
    }
    Density density(mesh, desc.side);
    density.deposit(positions, workers);
    for (const std::uint64_t weight : density.weights())
      ASSERT_EQ(weight, Clouds::particle * 512 / (mesh * mesh * mesh));
    std::vector<float> seen(positions.size());
    density.interpolate(positions, seen, workers);
    for (const float d : seen) ASSERT_EQ(d, 1.0f);
  }
}

TEST(Fourier, FindsAPlaneWaveWhereItIs) {
  Workers workers(2);
  for (const std::size_t nodes : {8u, 12u, 20u}) {
    const std::array<int, 3> wave = {-2, 3, 1};
    Field field(nodes);
    const double unit = 2.0 * std::numbers::pi / static_cast<double>(nodes);
    const auto fill = [&] {
      for (std::size_t i = 0; i < nodes * nodes * nodes; ++i) {
        const std::size_t p[3] = {i / nodes / nodes, i / nodes % nodes, i % nodes};
        double phase = 0.5;
        for (std::size_t k = 0; k < 3; ++k) phase += unit * wave[k] * static_cast<double>(p[k]);
        field.row(p[0], p[1])[p[2]] = static_cast<float>(std::cos(phase));
      }
    };
    const auto cells = static_cast<double>(nodes * nodes * nodes);
    const Fourier fourier(nodes);
    fill();
    fourier.analyse(field, workers, [&](const Modes& modes) {
      for (std::size_t x = 0; x < nodes; ++x) {
        for (std::size_t c = 0; c < modes.count; ++c) {
          const bool here = Fourier::wave_number(x, nodes) == wave[0] &&
                            Fourier::wave_number(modes.y, nodes) == wave[1] && modes.z + c == 1;
          const std::complex<double> expected = here ? std::polar(0.5 * cells, 0.5) : 0.0;
          const std::complex<double> found(modes.at(x, c));
          EXPECT_LT(std::abs(found - expected), 1e-5 * cells);
        }
      }
    });
    // d/dx: multiplication by i k.
    fill();
    fourier.filter(field, workers, [&](const Modes& modes) {
      for (std::size_t x = 0; x < nodes; ++x) {
        const auto k = static_cast<float>(unit * static_cast<double>(Fourier::wave_number(x, nodes)) / cells);
        for (std::size_t c = 0; c < modes.count; ++c) modes.at(x, c) *= std::complex<float>(0.0f, k);
      }
    });
    for (std::size_t i = 0; i < nodes * nodes * nodes; ++i) {
      const std::size_t p[3] = {i / nodes / nodes, i / nodes % nodes, i % nodes};
      double phase = 0.5;
      for (std::size_t k = 0; k < 3; ++k) phase += unit * wave[k] * static_cast<double>(p[k]);
      EXPECT_NEAR(field.at(p[0], p[1], p[2]), -unit * wave[0] * std::sin(phase), 1e-5);
    }
  }
}

TEST(Fourier, RefusesOddMeshes) {
  EXPECT_THROW(Fourier(10), std::invalid_argument);
  EXPECT_THROW(Fourier(0), std::invalid_argument);
}

}  // namespace
}  // namespace cosmo
