// The points that bonds and arrows stand on: positions of particles, read in place, in world space.
#pragma once

#include <cmath>
#include <optional>

#include "geometry/cell.h"
#include "geometry/filter/filter.h"
#include "kernels/array_view.h"
#include "kernels/pkd_tree.h"

namespace insitu {

struct ParticlePoints {
  kernels::ArrayView position;
  double scale = 1.0;
  double origin[3] = {};
  std::optional<Cell> cell;
  bool wrap = false;  // shown at the image within the cell
  // Which of two particles at one place is shown: that of the set's tree.
  kernels::PreferItem prefer = nullptr;
  const void* prefer_context = nullptr;
  const BoundFilter* filter = nullptr;  // of the set; nullptr: all particles are drawn

  std::uint64_t count() const { return position.count; }

  // False for what is never drawn: a coordinate that is not finite or above 1e100.
  bool point(std::uint64_t item, double out[3]) const {
    for (std::uint32_t c = 0; c < 3; ++c) {
      out[c] = origin[c] + position.value(item, c) * scale;
      if (!(std::abs(out[c]) <= 1e100)) return false;
    }
    if (!wrap) return true;
    double image[3];
    double offset[3];
    cell->image_of(out, image);
    cell->offset_of(image, offset);
    for (int c = 0; c < 3; ++c) out[c] -= offset[c];
    return true;
  }

  bool is_shown(std::uint64_t item) const { return filter == nullptr || filter->accepts(item); }
  bool prefers(std::uint64_t a, std::uint64_t b) const {
    return prefer != nullptr ? prefer(prefer_context, a, b) : a < b;
  }
};

}  // namespace insitu
