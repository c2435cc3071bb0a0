// Gravity between particles, against Newton.
#include <gtest/gtest.h>

#include "states.h"

namespace cosmo {
namespace {

constexpr double side = 64.0;
constexpr std::size_t nodes = 64;
constexpr double omega_m = 0.3;

double length(const Vec3f& v) { return std::hypot(v[0], v[1], v[2]); }

// Two particles alone in the box, r apart. Each pulls with 3/2 Omega_m (V / N) / 4 pi r^2, and the even background that
// keeps the mean density at zero pushes with 3/2 Omega_m (V / N) r / 3V; the images of a cubic lattice cancel up to
// terms of the order (r / side)^4 beside that.
TEST(Forces, AreThoseOfNewton) {
  Workers workers(2);
  Density density(nodes, side);
  Gravity gravity(nodes, side, omega_m, workers);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const double r : {3.0, 5.0, 8.0}) {  // in cells
    double mean = 0.0;
    double largest = 0.0;
    constexpr int pairs = 60;
    for (int i = 0; i < pairs; ++i) {
      const Vec3f p = random_positions(1, side, static_cast<unsigned>(i))[0];
      const double d[3] = {normal(random), normal(random), normal(random)};
      const double scale = r / std::hypot(d[0], d[1], d[2]);
      Vec3f q;
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = static_cast<double>(p[k]) + scale * d[k];
        q[k] = static_cast<float>(x - side * std::floor(x / side));
      }
      const std::vector<Vec3f> both = {p, q};
      density.deposit(both, workers);
      gravity.solve(density, workers);
      const Vec3f on_p = gravity.acceleration(p);
      const double volume = side * side * side;
      const double expected =
          1.5 * omega_m * volume / 2.0 * (1.0 / (4.0 * std::numbers::pi * r * r) - r / (3.0 * volume));
      double error = 0.0;
      double along = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        error += std::pow(on_p[k] - expected * scale * d[k] / r, 2);
        along += on_p[k] * scale * d[k] / r;
      }
      mean += along / expected / pairs;
      largest = std::max(largest, std::sqrt(error) / expected);
      const Vec3f on_q = gravity.acceleration(q);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(on_p[k], -on_q[k], 2e-5 * expected + 1e-3);
    }
    RecordProperty("mean_" + std::to_string(r), std::to_string(mean));
    RecordProperty("largest_" + std::to_string(r), std::to_string(largest));
    EXPECT_NEAR(mean, 1.0, 0.01) << r;
    EXPECT_LT(largest, r < 4.0 ? 0.2 : r < 6.0 ? 0.08 : 0.04) << r;
  }
}

TEST(Forces, NobodyPullsItself) {
  Workers workers(2);
  Density density(nodes, side);
  Gravity gravity(nodes, side, omega_m, workers);
  const double of_neighbour = 1.5 * omega_m * side * side * side / (4.0 * std::numbers::pi);  // at a distance of 1 cell
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Vec3f> alone = random_positions(1, side, seed);
    density.deposit(alone, workers);
    gravity.solve(density, workers);
    EXPECT_LT(length(gravity.acceleration(alone[0])), 1e-5 * of_neighbour);
  }
}

TEST(Forces, AddUpToNothing) {
  Workers workers(2);
  Density density(32, side);
  Gravity gravity(32, side, omega_m, workers);
  const std::vector<Vec3f> positions = random_positions(4000, side, 9);
  density.deposit(positions, workers);
  gravity.solve(density, workers);
  double sum[3] = {};
  double magnitudes = 0.0;
  for (const Vec3f& p : positions) {
    const Vec3f a = gravity.acceleration(p);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += a[k];
    magnitudes += length(a);
  }
  EXPECT_LT(std::hypot(sum[0], sum[1], sum[2]), 1e-6 * magnitudes);
}

}  // namespace
}  // namespace cosmo
