// Bonds: sticks between pairs of particles.
#pragma once

#include "core/budget.h"
#include "geometry/sticks/particle_points.h"
#include "geometry/sticks/sticks.h"

namespace insitu {

// A bond that was searched for: the second end is that of particle b, moved by edges of the cell.
struct FoundBond {
  std::uint32_t a;
  std::uint32_t b;
  std::int32_t image[3];
};

// Source of Sticks. The stick of pair p has the id 2 p; where a bond leaves the cell on one side and comes back on the
// other it is drawn as two halves, 2 p at the one end and 2 p + 1 at the other.
struct BondSource {
  ParticlePoints points;
  kernels::ArrayView pairs;          // of the caller: 2 integers each; unused when `found` is set
  const FoundBond* found = nullptr;  // of our own
  std::uint64_t found_count = 0;
  bool periodic = false;  // `pairs` mean nearest images
  double radius = 0.0;
  kernels::StickEnds ends = kernels::StickEnds::round;

  std::uint64_t pair_count() const { return found != nullptr ? found_count : pairs.count; }
  // The search for bonds has left out what a filter does.
  bool is_shown(std::uint64_t id) const { return found != nullptr || !is_filtered(id / 2); }
  // Both ends are there, but not both of them are drawn.
  bool is_filtered(std::uint64_t pair) const;
  // False for an index out of range, twice the same one or the same place, a point that is not finite.
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
  struct Ends {
    std::uint64_t item[2];
    double point[2][3];
    double d[3];   // from the first to the second, or to the image of it that is meant
    bool crosses;  // to an image
  };
  bool ends_of(std::uint64_t pair, Ends& ends) const;
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

// Each bond once, in ascending order of `a`, the smaller index, and `b`; with periodic also those to images, of a
// particle to its own ones too. Call within the workers. Throws Error: over_budget; invalid_argument when bonds may be
// longer than ten cells; unsupported above 2^31 bonds.
void find_bonds(Budget& budget, const ParticlePoints& points, const BondSearch& search, BudgetVector<FoundBond>& bonds);

}  // namespace insitu
