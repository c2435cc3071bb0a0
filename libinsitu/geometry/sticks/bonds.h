// Bonds: sticks between pairs of particles.
#pragma once

#include "core/budget.h"
#include "geometry/sticks/particle_points.h"
#include "geometry/sticks/sticks.h"

namespace insitu {

// Source of Sticks. The stick of pair p has the id 2 p; where a bond leaves the cell on one side and comes back on the
// other it is drawn as two halves, 2 p at the one end and 2 p + 1 at the other.
struct BondSource {
  ParticlePoints points;
  kernels::ArrayView pairs;              // of the caller: 2 integers each; unused when `found` is set
  const std::uint32_t* found = nullptr;  // of our own: 2 per pair
  std::uint64_t found_count = 0;
  bool periodic = false;
  double radius = 0.0;
  kernels::StickEnds ends = kernels::StickEnds::round;

  std::uint64_t pair_count() const { return found != nullptr ? found_count : pairs.count; }
  // Can the pair be drawn? False: an index out of range, twice the same one or the same place, a point that is not
  // finite.
  bool is_good(std::uint64_t pair) const;

  bool stick(std::uint64_t id, kernels::Stick& out) const;
  // Pairs of the caller are shown by their place in his array, those found here by the particle at the nearer end.
  std::uint64_t shown_item(std::uint64_t id, double along) const {
    return found != nullptr ? color_item(id, along) : id / 2;
  }
  // The particle at the nearer end.
  std::uint64_t color_item(std::uint64_t id, double along) const;
  bool prefer(std::uint64_t a, std::uint64_t b) const;

 private:
  // The ends in an order that does not depend on that of the pair, so that the bits of a bond do not either.
  bool ends_of(std::uint64_t pair, std::uint64_t item[2], double point[2][3]) const;
};

// Every pair of particles that are nearer to each other than `cutoff`, or than `by_radius` times the sum of their
// radii.
struct BondSearch {
  double cutoff = 0.0;  // 0: by radius
  double by_radius = 0.0;
  kernels::RadiusView radius;  // in the space of the arrays: times points.scale
  double radius_max = 0.0;     // likewise
  bool periodic = false;       // across the borders of the cell, too
};

// Two entries per pair, the smaller index first, in ascending order. Call within the workers. Throws Error:
// over_budget; invalid_argument when the longest bond is not below half the height of a periodic cell; unsupported
// above 2^31 pairs.
void find_bonds(Budget& budget, const ParticlePoints& points, const BondSearch& search,
                BudgetVector<std::uint32_t>& pairs);

}  // namespace insitu
