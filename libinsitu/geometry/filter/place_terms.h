// Where a particle's centre stands in world space: within a box, or on one side of a plane.
#pragma once

#include "geometry/filter/filter_block.h"

namespace insitu {

// Of the arrays of a step: world = origin + scale * value.
struct WorldPositions {
  kernels::ArrayView position;
  double scale = 1.0;
  double origin[3] = {};

  double at(std::uint64_t item, std::uint32_t c) const { return origin[c] + position.value(item, c) * scale; }
};

// Corners and faces belong to the box.
struct BoxTerm {
  WorldPositions world;
  double lower[3] = {};
  double upper[3] = {};

  std::uint64_t word(const FilterBlock& block) const;
  bool accepts(std::uint64_t item) const;
};

// Keeps plane[0] x + plane[1] y + plane[2] z >= plane[3].
struct PlaneTerm {
  WorldPositions world;
  double plane[4] = {};

  std::uint64_t word(const FilterBlock& block) const;
  bool accepts(std::uint64_t item) const;
};

}  // namespace insitu
