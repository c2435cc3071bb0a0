#include "power_spectrum.h"

#include <cmath>
#include <numbers>

#include "quadrature.h"

namespace cosmo {

double transfer_function(const Cosmology& cosmology, double k) {
  if (k <= 0.0) return 1.0;
  const double h = cosmology.h;
  const double m = cosmology.omega_m * h * h;
  const double b = cosmology.omega_b * h * h;
  const double fraction = cosmology.omega_b / cosmology.omega_m;
  const double theta = 2.7255 / 2.7;  // temperature of the microwave background (Fixsen 2009)
  // Sound horizon in Mpc, equation 26; suppression below it, equations 30 and 31.
  const double s = 44.5 * std::log(9.83 / m) / std::sqrt(1.0 + 10.0 * std::pow(b, 0.75));
  const double alpha = 1.0 - 0.328 * std::log(431.0 * m) * fraction + 0.38 * std::log(22.3 * m) * fraction * fraction;
  const double ks = 0.43 * k * h * s;
  const double gamma = cosmology.omega_m * h * (alpha + (1.0 - alpha) / (1.0 + ks * ks * ks * ks));
  // Equations 28 and 29.
  const double q = k * theta * theta / gamma;
  const double l = std::log(2.0 * std::numbers::e + 1.8 * q);
  const double c = 14.2 + 731.0 / (1.0 + 62.5 * q);
  return l / (l + c * q * q);
}

PowerSpectrum::PowerSpectrum(const Cosmology& cosmology) : cosmology_(cosmology) {
  const double unscaled = sigma(8.0);
  amplitude_ = cosmology.sigma_8 * cosmology.sigma_8 / (unscaled * unscaled);
}

double PowerSpectrum::operator()(double k) const {
  if (k <= 0.0) return 0.0;
  const double t = transfer_function(cosmology_, k);
  return amplitude_ * std::pow(k, cosmology_.n_s) * t * t;
}

double PowerSpectrum::sigma(double r) const {
  // sigma^2 = integral dlnk k^3 P(k) W(kr)^2 / 2 pi^2, W the transform of a sphere.
  const double square = integral(std::log(1e-5 / r), std::log(1e3 / r), 8192, [&](double lnk) {
    const double k = std::exp(lnk);
    const double x = k * r;
    const double w = x < 1e-2 ? 1.0 - 0.1 * x * x : 3.0 * (std::sin(x) - x * std::cos(x)) / (x * x * x);
    return k * k * k * (*this)(k)*w * w / (2.0 * std::numbers::pi * std::numbers::pi);
  });
  return std::sqrt(square);
}

}  // namespace cosmo
