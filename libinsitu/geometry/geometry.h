// What the scene and the renderer see of a geometry, whatever it is made of: rays in batches, and the surface at a hit.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/ray.h"

namespace insitu {

// The surface of an item at a point of it.
struct Surface {
  double normal[3];          // outwards, of unit length; all 0 when there is none
  double magnitude;          // largest number, besides those of the ray, that the point was computed with: a length
  std::uint64_t item;        // what the item channel shows
  std::uint64_t color_item;  // the item of the particles whose colour it has
};

class TransparentGeometry;

class Geometry {
 public:
  virtual ~Geometry() = default;

  // World space; lower > upper when nothing is drawn.
  virtual void bounds(double lower[3], double upper[3]) const = 0;
  // hits[i] becomes the first hit of rays[i] with t_min < t <= t_max, unless a nearer or equally near one is there.
  virtual void first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const = 0;
  // occluded[i] becomes 1 when anything is hit; rays with occluded[i] != 0 are left alone.
  virtual void any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const = 0;
  // `item` as a hit has it. Once per hit that is shaded, which costs a hundred times as much.
  virtual Surface surface(std::uint64_t item, const double point[3]) const = 0;
  // As what it can be seen through (transparent_geometry.h); nullptr: it is opaque, whatever its colours say.
  virtual const TransparentGeometry* transparent() const { return nullptr; }
};

}  // namespace insitu
