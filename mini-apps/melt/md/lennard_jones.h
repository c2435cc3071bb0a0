// The pair potential.
#pragma once

#include <cmath>

namespace melt {

// Lennard-Jones, truncated at r_c and shifted in force:
//
//   u(r) = 4 (r^-12 - r^-6) - u_c - (r - r_c) u'_c   for r < r_c, else 0,
//
// with u_c and u'_c the value and slope of the plain potential at r_c. Energy and force both go to zero at r_c without
// a step, which is what a symplectic integrator needs to conserve energy; shifting the energy alone leaves a step of
// 0.039 epsilon/sigma in the force at r_c = 2.5. (Allen & Tildesley, chapter 5; Toxvaerd & Dyre, J. Chem. Phys. 134,
// 081102 (2011), who show that structure and dynamics of the liquid hardly notice.)
class LennardJones {
 public:
  explicit LennardJones(double cutoff) : cutoff_(cutoff), cutoff_square_(cutoff * cutoff) {
    const double inv2 = 1.0 / cutoff_square_;
    const double inv6 = inv2 * inv2 * inv2;
    slope_ = -(48.0 * inv6 * inv6 - 24.0 * inv6) / cutoff;
    shift_ = 4.0 * (inv6 * inv6 - inv6) - cutoff * slope_;
  }

  double cutoff() const { return cutoff_; }
  double cutoff_square() const { return cutoff_square_; }

  struct Pair {
    double energy;
    double force_over_r;  // force on i = force_over_r * (x_i - x_j)
  };
  // For 0 < r^2 < cutoff_square().
  Pair operator()(double r2) const {
    const double inv2 = 1.0 / r2;
    const double r = std::sqrt(r2);
    const double inv6 = inv2 * inv2 * inv2;
    return {4.0 * inv6 * (inv6 - 1.0) - shift_ - r * slope_, inv2 * (48.0 * inv6 * (inv6 - 0.5) + r * slope_)};
  }

 private:
  double cutoff_;
  double cutoff_square_;
  double slope_;  // u'_c
  double shift_;  // u_c - r_c u'_c
};

}  // namespace melt
