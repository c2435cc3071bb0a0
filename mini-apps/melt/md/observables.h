// What is measured on a state: structure and momentum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "box.h"
#include "particle.h"

namespace melt {

Vec3 total_momentum(std::span<const Particle> particles);

// Verlet's melting factor: the mean of cos(k . r) over the atoms for a reciprocal vector k = 2 pi / a (-1, 1, -1) of
// the fcc lattice of `cells` unit cells of side a along the box. 1 on the perfect lattice, about 1 / sqrt(N) in the
// liquid (Phys. Rev. 159, 98 (1967); Allen & Tildesley, chapter 5). The lattice may have drifted, so the modulus of the
// complex mean is taken.
double translational_order(std::span<const Particle> particles, const Box& box, std::uint64_t cells);

// g(r): the density of atoms at distance r from an atom, over the mean density. Averages over any number of states.
class RadialDistribution {
 public:
  // Up to `range`, at most half of the box side.
  RadialDistribution(double range, std::size_t bins);

  // Every `stride`-th atom, by place in the array, looks at all others: N^2 / stride distances without any list, so
  // that an error in the lists cannot hide in g(r).
  void add(std::span<const Particle> particles, const Box& box, std::size_t stride = 1);

  double radius(std::size_t bin) const { return (static_cast<double>(bin) + 0.5) * width_; }
  std::vector<double> values() const;
  // Neighbours per atom at distances in [from, to), in whole bins.
  double neighbours(double from, double to) const;

 private:
  double width_;
  std::vector<std::uint64_t> counts_;
  double centres_ = 0.0;       // atoms looked from, over all states
  double pair_density_ = 0.0;  // sum over states of centres * N / V
};

}  // namespace melt
