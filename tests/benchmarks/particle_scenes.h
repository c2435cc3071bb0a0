// Particles, cameras and rays for measurements: the same for every structure that is compared.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernels/ray.h"

namespace bench {

struct ParticleScene {
  std::string name;
  std::vector<float> position;  // x y z x y z ...
  std::vector<float> radii;     // one each; empty: `radius` for all
  std::vector<float> values;    // an attribute, "value"; or none
  double radius = 0.0;
  std::uint64_t count() const { return position.size() / 3; }
};

// "uniform": in the unit cube, radius half the mean spacing.
// "clustered": 200 Gaussian clusters of width 0.02 in the unit cube, radius a fifth of the mean spacing of the cube.
ParticleScene make_scene(const std::string& name, std::uint64_t count);

constexpr std::size_t tile_rays = 4096;  // 64 x 64 pixels, in Morton order in every array of rays

// "far": the whole cloud in view. "close": from within it. `edge_px` is a multiple of 64.
std::vector<insitu::kernels::Ray> camera_rays(const std::string& view, std::uint32_t edge_px);

// One ambient occlusion ray per hit, in the order of the camera rays. `position` are the centres by item.
std::vector<insitu::kernels::Ray> occlusion_rays(const std::vector<insitu::kernels::Ray>& camera,
                                                 const std::vector<insitu::kernels::Hit>& hits,
                                                 const std::vector<float>& position, double reach);

}  // namespace bench
