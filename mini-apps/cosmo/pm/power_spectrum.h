// The power spectrum of linear theory today.
#pragma once

#include "cosmology.h"

namespace cosmo {

// Transfer function of cold dark matter with baryons, without their acoustic wiggles: Eisenstein & Hu, ApJ 496, 605
// (1998), equations 26 and 28 to 31. `k` in h/Mpc. 1 for k = 0.
double transfer_function(const Cosmology& cosmology, double k);

// P(k) = A k^n_s T(k)^2, A chosen for sigma_8.
class PowerSpectrum {
 public:
  explicit PowerSpectrum(const Cosmology& cosmology);

  // (Mpc/h)^3, for k in h/Mpc; 0 for k = 0.
  double operator()(double k) const;
  // Standard deviation of the density contrast in spheres of radius r, in Mpc/h.
  double sigma(double r) const;

 private:
  Cosmology cosmology_;
  double amplitude_ = 1.0;
};

}  // namespace cosmo
