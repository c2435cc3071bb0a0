// What is drawn in a step: the built geometries with their colours, and rays through all of them.
#pragma once

#include <memory>
#include <vector>

#include "geometry/particles/particles.h"
#include "kernels/ray.h"
#include "scene/camera.h"
#include "scene/style.h"

namespace insitu {

class EmbreeBridge;

struct SceneRay {
  kernels::Ray ray;  // ray.exclude counts for exclude_geometry alone
  std::uint32_t exclude_geometry = ~0u;
};

struct SceneHit {
  double t = std::numeric_limits<double>::infinity();
  std::uint64_t item = kernels::no_item;
  std::uint32_t geometry = ~0u;
  bool found() const { return item != kernels::no_item; }
};

class Scene {
 public:
  Scene();
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  struct Entry {
    const Particles* particles;
    Colors colors;
    Bounds bounds;
  };

  void clear();
  // In the order of creation, which decides when two geometries are hit at exactly the same distance.
  void add(const Particles& particles, const Colors& colors);
  // One geometry is traced directly; several stand as user geometries in an Embree scene. Call within the workers.
  void commit();

  const std::vector<Entry>& entries() const { return entries_; }
  const Bounds& bounds() const { return bounds_; }

  // Hits with t_min < t <= t_max. `hits` and `occluded` are overwritten.
  void first_hits(const SceneRay* rays, SceneHit* hits, std::size_t count) const;
  void any_hits(const SceneRay* rays, std::uint8_t* occluded, std::size_t count) const;

 private:
  std::vector<Entry> entries_;
  Bounds bounds_;
  std::unique_ptr<EmbreeBridge> embree_;  // made when first needed, and kept
};

}  // namespace insitu
