// A geometry that can be seen through. How opaque an item of it is comes from outside: geometries know no colours.
#pragma once

#include "geometry/geometry.h"
#include "kernels/nearest_entries.h"
#include "kernels/opacity.h"

namespace insitu {

class TransparentGeometry : public Geometry {
 public:
  const TransparentGeometry* transparent() const override { return this; }

  // Offers `entries`, as items of geometry `number`, what the ray enters with t_min < t <= t_max: each item once, items
  // of opacity 0 not at all, those of opacity 1 as first_hits has it.
  virtual void nearest_entries(const kernels::Ray& ray, std::uint32_t number, const kernels::ItemOpacity& opacity,
                               kernels::NearestEntries& entries) const = 0;
  // `depth` plus that of all items that the ray enters in between; once nothing passes it may go without some.
  virtual kernels::OpticalDepth optical_depth(const kernels::Ray& ray, const kernels::ItemOpacity& opacity,
                                              kernels::OpticalDepth depth) const = 0;
};

}  // namespace insitu
