// A camera ray on its way through transparent particles, front to back: layer by layer, each with the share that it has
// in the colour of the ray (the over operator of Porter and Duff, "Compositing digital images", SIGGRAPH 1984).
#pragma once

#include <vector>

#include "scene/scene.h"

namespace insitu {

struct Layer {
  SceneHit hit;
  double weight;        // opacity times what the layers before it let pass
  std::uint32_t place;  // 0 is the nearest
};

class LayeredRay {
 public:
  // Below this share nothing more is looked for; the last layer takes the rest.
  static constexpr double least_transmittance = 1.0 / 1024;

  // `opaque`: the first hit of what cannot be seen through.
  LayeredRay(const SceneRay& ray, const SceneHit& opaque) : ray_(ray), opaque_(opaque) {}

  bool is_done() const { return is_done_; }
  double transmittance() const { return transmittance_; }
  // Appends the next layers, kernels::NearestEntries::most of them at most.
  void advance(const Scene& scene, std::vector<Layer>& layers);

 private:
  SceneRay ray_;
  SceneHit opaque_;
  kernels::EnteredItem behind_;
  double transmittance_ = 1.0;
  std::uint32_t place_ = 0;
  bool is_done_ = false;
};

}  // namespace insitu
