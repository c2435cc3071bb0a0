// The expanding background: how fast space expands, how fast small fluctuations grow in it.
//
// Units of the whole code: lengths are comoving, in Mpc/h; times in 1/H0; velocities therefore in H0 Mpc/h = 100 km/s.
// The state variable of a particle is x and its momentum per mass p = a^2 dx/dt, for which the equations of motion have
// no drag term (Peebles, The Large-Scale Structure of the Universe, 1980, section 7):
//     dx/dt = p / a^2        dp/dt = -grad phi / a        laplace phi = 3/2 Omega_m delta
#pragma once

namespace cosmo {

// Matter, a cosmological constant, and curvature for what is left to 1. Radiation does not matter after a = 0.01.
struct Cosmology {
  double omega_m = 0.31;
  double omega_lambda = 0.69;
  double omega_b = 0.049;  // baryons, a part of omega_m; only in the transfer function
  double h = 0.68;         // H0 in 100 km/s/Mpc
  double n_s = 0.965;      // spectral index of the primordial fluctuations
  double sigma_8 = 0.81;   // of linear theory today

  // H(a) / H0.
  double expansion(double a) const;
  // Linear growth factor, with growth(1) = 1: Heath, MNRAS 179, 351 (1977), D ~ H integral da / (a H)^3.
  double growth(double a) const;
  // d ln D / d ln a.
  double growth_rate(double a) const;

  // The two halves of a leapfrog step, exact for the background (Quinn, Katz, Stadel & Lake, astro-ph/9710043): over
  // [a, b] x changes by p times drift, and p by -grad phi times kick.
  double drift(double a, double b) const;  // integral dt / a^2 = integral da / (a^3 E)
  double kick(double a, double b) const;   // integral dt / a   = integral da / (a^2 E)
};

}  // namespace cosmo
