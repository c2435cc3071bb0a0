// The twelve edges of a cell.
#pragma once

#include "geometry/cell.h"
#include "geometry/sticks/sticks.h"

namespace insitu {

struct OutlineSource {
  Cell cell;
  double radius = 0.0;

  bool is_shown(std::uint64_t) const { return true; }
  // Edge 4 k + i runs along vector k from the i-th corner of the face across it.
  bool stick(std::uint64_t id, kernels::Stick& out) const {
    const auto k = static_cast<int>(id / 4);
    double count[3] = {};
    count[(k + 1) % 3] = static_cast<double>(id % 2);
    count[(k + 2) % 3] = static_cast<double>(id / 2 % 2);
    double offset[3];
    cell.offset_of(count, offset);
    for (int c = 0; c < 3; ++c) {
      out.a[c] = cell.origin[c] + offset[c];
      out.b[c] = out.a[c] + cell.edge[k][c];
    }
    out.radius = radius;
    out.ends = kernels::StickEnds::round;
    return true;
  }
  // No particle stands behind an edge.
  std::uint64_t shown_item(std::uint64_t, double) const { return kernels::no_item; }
  std::uint64_t color_item(std::uint64_t, double) const { return 0; }
  bool prefer(std::uint64_t a, std::uint64_t b) const { return a < b; }
};

}  // namespace insitu
