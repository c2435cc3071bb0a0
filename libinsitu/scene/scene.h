// What is drawn in a step: the built geometries with their colours, and rays through all of them.
#pragma once

#include <memory>
#include <vector>

#include "geometry/transparent_geometry.h"
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
    const TransparentGeometry* see_through = nullptr;  // the geometry, when its colours let something pass
  };

  void clear();
  // In the order of creation, which decides when two geometries are hit at exactly the same distance.
  void add(const Geometry& geometry, const Colors& colors, const glm::dvec3& shift = glm::dvec3(0.0));
  // Call within the workers.
  void commit();

  const std::vector<Entry>& entries() const { return entries_; }
  const Bounds& bounds() const { return bounds_; }

  // Whether any entry can be seen through. Without one, first and any hits are all that there is to a ray.
  bool is_transparent() const { return is_transparent_; }

  // Hits with t_min < t <= t_max of what cannot be seen through. `hits` and `occluded` are overwritten.
  void first_hits(const SceneRay* rays, SceneHit* hits, std::size_t count) const;
  void any_hits(const SceneRay* rays, std::uint8_t* occluded, std::size_t count) const;

  // Offers `layers` what the ray enters of all that can be seen through, with t_min < t <= t_max.
  void add_layers(const SceneRay& ray, kernels::NearestEntries& layers) const;
  // The share of light, 0 to 1, that arrives along each ray through everything between t_min and t_max.
  void transmittances(const SceneRay* rays, double* arriving, std::size_t count) const;

  // Up to so many entries are traced one after another, each with the rays that meet its box; more of them stand as
  // boxes in an Embree scene, which rays go through one by one. Measured: frames of 2, 4, 27 and 64 sets took 0.51,
  // 0.55, 0.85 and 1.3 times as long in turn (medians of five runs on one thread).
  static constexpr std::size_t most_in_turn = 32;

 private:
  double transmittance(const SceneRay& ray) const;  // of what can be seen through

  std::vector<Entry> entries_;
  Bounds bounds_;
  bool is_transparent_ = false;
  std::unique_ptr<EmbreeBridge> embree_;  // made when first needed, and kept
};

}  // namespace insitu
