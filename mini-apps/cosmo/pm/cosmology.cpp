#include "cosmology.h"

#include <cmath>

#include "quadrature.h"

namespace cosmo {
namespace {

// Intervals that leave no error above rounding of the single precision state: steps are short, integrals from the
// beginning of time are long.
constexpr int step_pairs = 32;
constexpr int long_pairs = 512;

// integral da / (a E)^3 from 0 to a. The integrand behaves like a^(3/2) at the start; with a = s^2 it is smooth.
double heath_integral(const Cosmology& c, double a) {
  return integral(0.0, std::sqrt(a), long_pairs, [&](double s) {
    if (s == 0.0) return 0.0;
    const double x = s * s * c.expansion(s * s);
    return 2.0 * s / (x * x * x);
  });
}

}  // namespace

double Cosmology::expansion(double a) const {
  const double omega_k = 1.0 - omega_m - omega_lambda;
  return std::sqrt(omega_m / (a * a * a) + omega_k / (a * a) + omega_lambda);
}

double Cosmology::growth(double a) const {
  return expansion(a) * heath_integral(*this, a) / (expansion(1.0) * heath_integral(*this, 1.0));
}

double Cosmology::growth_rate(double a) const {
  const double omega_k = 1.0 - omega_m - omega_lambda;
  const double e = expansion(a);
  const double dlne = -0.5 * (3.0 * omega_m / (a * a * a) + 2.0 * omega_k / (a * a)) / (e * e);
  const double x = a * e;
  return dlne + a / (x * x * x * heath_integral(*this, a));
}

double Cosmology::drift(double a, double b) const {
  return integral(a, b, step_pairs, [this](double s) { return 1.0 / (s * s * s * expansion(s)); });
}

double Cosmology::kick(double a, double b) const {
  return integral(a, b, step_pairs, [this](double s) { return 1.0 / (s * s * expansion(s)); });
}

}  // namespace cosmo
