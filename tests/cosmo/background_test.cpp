// The expanding background and linear theory, against closed forms and integrations that share nothing with the code.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pm/cosmology.h"
#include "pm/power_spectrum.h"

namespace cosmo {
namespace {

Cosmology einstein_de_sitter() {
  Cosmology c;
  c.omega_m = 1.0;
  c.omega_lambda = 0.0;
  return c;
}

Cosmology open_universe() {
  Cosmology c;
  c.omega_m = 0.3;
  c.omega_lambda = 0.0;
  return c;
}

struct Growth {
  long double size, slope;  // D and dD / d ln a
};

// D'' + (2 + d ln E / d ln a) D' = 3/2 Omega_m(a) D in ln a, the linear equation of motion of a density contrast, from
// deep in the time of matter, where D = a; by Runge-Kutta.
Growth integrated_growth(const Cosmology& c, long double a_end) {
  const long double m = c.omega_m, l = c.omega_lambda, k = 1.0L - m - l;
  const auto derivative = [&](long double lna, Growth g) -> Growth {
    const long double a = std::exp(lna);
    const long double e2 = m / (a * a * a) + k / (a * a) + l;
    const long double dlne = (-3.0L * m / (a * a * a) - 2.0L * k / (a * a)) / (2.0L * e2);
    return {g.slope, 1.5L * m / (a * a * a) / e2 * g.size - (2.0L + dlne) * g.slope};
  };
  const long double start = std::log(1e-7L);
  constexpr int steps = 4000;
  const long double h = (std::log(a_end) - start) / steps;
  Growth g{std::exp(start), std::exp(start)};
  const auto moved = [](Growth from, Growth by, long double t) -> Growth {
    return {from.size + t * by.size, from.slope + t * by.slope};
  };
  for (int i = 0; i < steps; ++i) {
    const long double t = start + h * i;
    const Growth k1 = derivative(t, g);
    const Growth k2 = derivative(t + 0.5L * h, moved(g, k1, 0.5L * h));
    const Growth k3 = derivative(t + 0.5L * h, moved(g, k2, 0.5L * h));
    const Growth k4 = derivative(t + h, moved(g, k3, h));
    g.size += h / 6.0L * (k1.size + 2.0L * k2.size + 2.0L * k3.size + k4.size);
    g.slope += h / 6.0L * (k1.slope + 2.0L * k2.slope + 2.0L * k3.slope + k4.slope);
  }
  return g;
}

TEST(Background, GrowthSolvesItsEquation) {
  for (const Cosmology& c : {Cosmology(), open_universe(), einstein_de_sitter()}) {
    const Growth today = integrated_growth(c, 1.0L);
    for (const double a : {0.02, 0.1, 0.3, 0.7, 1.0, 1.5}) {
      const Growth then = integrated_growth(c, a);
      EXPECT_NEAR(c.growth(a) / static_cast<double>(then.size / today.size), 1.0, 2e-6) << c.omega_m << ' ' << a;
      EXPECT_NEAR(c.growth_rate(a) / static_cast<double>(then.slope / then.size), 1.0, 2e-6) << c.omega_m << ' ' << a;
    }
  }
}

// E = a^(-3/2): D = a, and both integrals are powers.
TEST(Background, EinsteinDeSitterInClosedForm) {
  const Cosmology c = einstein_de_sitter();
  for (const auto& [a, b] : {std::pair{0.02, 0.023}, std::pair{0.3, 0.35}, std::pair{0.9, 1.0}}) {
    EXPECT_NEAR(c.expansion(a) * std::pow(a, 1.5), 1.0, 1e-14);
    EXPECT_NEAR(c.growth(a) / a, 1.0, 1e-9);
    EXPECT_NEAR(c.growth_rate(a), 1.0, 1e-9);
    EXPECT_NEAR(c.kick(a, b) / (2.0 * (std::sqrt(b) - std::sqrt(a))), 1.0, 1e-10);
    EXPECT_NEAR(c.drift(a, b) / (2.0 / std::sqrt(a) - 2.0 / std::sqrt(b)), 1.0, 1e-10);
  }
}

TEST(Background, KicksAddUp) {
  const Cosmology c;
  EXPECT_NEAR(c.kick(0.5, 0.55) + c.kick(0.55, 0.6), c.kick(0.5, 0.6), 1e-10);
  EXPECT_NEAR(c.drift(0.5, 0.55) + c.drift(0.55, 0.6), c.drift(0.5, 0.6), 1e-10);
}

// Without baryons, the transfer function of another paper: Bardeen, Bond, Kaiser & Szalay, ApJ 304, 15 (1986), equation
// G3. The two fits agree to some percent.
TEST(Background, TransferFunctionIsThatOfColdDarkMatter) {
  Cosmology c;
  c.omega_b = 0.0;
  EXPECT_EQ(transfer_function(c, 0.0), 1.0);
  for (double k = 1e-4; k < 20.0; k *= 1.3) {
    const double q = k / (c.omega_m * c.h);
    const double bbks =
        std::log(1.0 + 2.34 * q) / (2.34 * q) *
        std::pow(1.0 + 3.89 * q + std::pow(16.1 * q, 2) + std::pow(5.46 * q, 3) + std::pow(6.71 * q, 4), -0.25);
    EXPECT_NEAR(transfer_function(c, k) / bbks, 1.0, 0.06) << k;
  }
}

// Baryons do not clump before recombination: small scales lose power, of the order of twice their share in amplitude.
TEST(Background, BaryonsSuppressSmallScales) {
  const Cosmology with;
  Cosmology without = with;
  without.omega_b = 0.0;
  EXPECT_NEAR(transfer_function(with, 1e-4) / transfer_function(without, 1e-4), 1.0, 1e-3);
  const double suppressed = transfer_function(with, 5.0) / transfer_function(without, 5.0);
  EXPECT_LT(suppressed, 0.85);
  EXPECT_GT(suppressed, 0.5);
}

TEST(Background, FluctuationsHaveTheSizeAskedFor) {
  Cosmology c;
  c.sigma_8 = 0.77;
  const PowerSpectrum power(c);
  // The plain definition, by the trapezoidal rule in k.
  const auto sigma = [&](double r) {
    double square = 0.0;
    constexpr double step = 2e-4;
    for (double k = step; k < 40.0; k += step) {
      const double x = k * r;
      const double w = 3.0 * (std::sin(x) - x * std::cos(x)) / (x * x * x);
      square += step * k * k * power(k) * w * w / (2.0 * std::numbers::pi * std::numbers::pi);
    }
    return std::sqrt(square);
  };
  EXPECT_NEAR(sigma(8.0), 0.77, 1e-3);
  EXPECT_NEAR(power.sigma(3.0) / sigma(3.0), 1.0, 1e-3);
  EXPECT_NEAR(power(1e-5) / power(2e-5), std::pow(0.5, c.n_s), 1e-3);  // primordial on the largest scales
}

}  // namespace
}  // namespace cosmo
