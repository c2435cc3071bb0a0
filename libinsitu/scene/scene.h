// What is drawn in a step: the built geometries with their colours, and rays through all of them.
#pragma once

#include <memory>
#include <vector>

#include "geometry/geometry.h"
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
  std::uint32_t geometry = ~0u;  // place in Scene::entries()
  bool found() const { return item != kernels::no_item; }
};

class Scene {
 public:
  Scene();
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // A geometry, or an instance of it: drawn `shift` away from where it stands.
  struct Entry {
    const Geometry* geometry;
    Colors colors;
    Bounds bounds;  // where it is drawn
    glm::dvec3 shift{0.0};
  };

  void clear();
  // In the order of creation, which decides when two geometries are hit at exactly the same distance.
  void add(const Geometry& geometry, const Colors& colors, const glm::dvec3& shift = glm::dvec3(0.0));
  // Call within the workers.
  void commit();

  const std::vector<Entry>& entries() const { return entries_; }
  const Bounds& bounds() const { return bounds_; }

  // Hits with t_min < t <= t_max. `hits` and `occluded` are overwritten.
  void first_hits(const SceneRay* rays, SceneHit* hits, std::size_t count) const;
  void any_hits(const SceneRay* rays, std::uint8_t* occluded, std::size_t count) const;

  // Up to so many entries are traced one after another, each with the rays that meet its box; more of them stand as
  // boxes in an Embree scene, which rays go through one by one. Measured: frames of 2, 4, 27 and 64 sets took 0.51,
  // 0.55, 0.85 and 1.3 times as long in turn (medians of five runs on one thread).
  static constexpr std::size_t most_in_turn = 32;

 private:
  std::vector<Entry> entries_;
  Bounds bounds_;
  std::unique_ptr<EmbreeBridge> embree_;  // made when first needed, and kept
};

}  // namespace insitu
