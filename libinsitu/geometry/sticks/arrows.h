// Arrows: vectors at particles, each a shaft and a head.
#pragma once

#include "geometry/sticks/particle_points.h"
#include "geometry/sticks/sticks.h"

namespace insitu {

// Source of Sticks. The shaft of particle i has the id 2 i, the head 2 i + 1.
struct ArrowSource {
  ParticlePoints points;
  kernels::ArrayView vectors;
  double scale = 1.0;  // length of the arrow over that of the vector
  double radius = 0.0;
  double head_radius = 0.0;
  double head_length = 0.0;  // an arrow that is shorter is all head, made smaller in proportion
  bool centred = false;      // the particle in the middle of the arrow, not at its tail

  // A vector that is not finite cannot be drawn; one of no length can, as nothing.
  bool is_good(std::uint64_t item) const;

  bool is_shown(std::uint64_t id) const { return points.is_shown(id / 2); }
  bool stick(std::uint64_t id, kernels::Stick& out) const;
  std::uint64_t shown_item(std::uint64_t id, double) const { return id / 2; }
  std::uint64_t color_item(std::uint64_t id, double) const { return id / 2; }
  bool prefer(std::uint64_t a, std::uint64_t b) const;
};

}  // namespace insitu
