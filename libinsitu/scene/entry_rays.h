// Rays of a scene as the geometry of one of its entries sees them.
#pragma once

#include "kernels/slabs.h"
#include "scene/scene.h"

namespace insitu {

inline kernels::Ray ray_for(const SceneRay& ray, std::uint32_t geometry, const glm::dvec3& shift) {
  kernels::Ray own = ray.ray;
  for (int c = 0; c < 3; ++c) own.origin[c] -= shift[c];
  if (ray.exclude_geometry != geometry) own.exclude = kernels::no_item;
  return own;
}

inline bool meets(const SceneRay& ray, const Bounds& box, double t_max) {
  const kernels::RaySlabs slabs(ray.ray.origin, ray.ray.direction);
  const double lower[3] = {box.lower.x, box.lower.y, box.lower.z};
  const double upper[3] = {box.upper.x, box.upper.y, box.upper.z};
  return slabs.enter(lower, upper, ray.ray.t_min, t_max) < std::numeric_limits<double>::infinity();
}

}  // namespace insitu
