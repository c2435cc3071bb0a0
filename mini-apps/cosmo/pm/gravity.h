// Gravity by a particle mesh: the potential of the density, and the kick it gives to particles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "density.h"
#include "fourier.h"

namespace cosmo {

class Gravity {
 public:
  Gravity(std::size_t nodes, double side, double omega_m, Workers& workers);

  // Solves laplace phi = 3/2 Omega_m delta on the mesh.
  void solve(const Density& density, Workers& workers);

  // - grad phi at a place: fourth order differences at the nodes, interpolated by the clouds of the deposit. The pull
  // of a particle on itself, and the sum of all forces, are then zero (Hockney & Eastwood, chapter 5).
  Vec3f acceleration(const Vec3f& position) const;

  // momentum += factor * acceleration, for all particles.
  void kick(std::span<const Vec3f> positions, std::span<Vec3f> momenta, double factor, Workers& workers) const;

  std::uint64_t bytes() const { return potential_.bytes() + influence_.size() * sizeof(float); }

 private:
  void tabulate(double omega_m, Workers& workers);

  std::size_t nodes_;
  double side_;
  Clouds clouds_;
  Fourier fourier_;
  Field potential_;
  std::vector<float> influence_;  // of modes 0 ... nodes/2 along each axis: it is even in all three
};

}  // namespace cosmo
