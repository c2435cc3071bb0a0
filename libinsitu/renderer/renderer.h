// Pixels from a committed scene.
#pragma once

#include <glm/vec4.hpp>
#include <vector>

#include "image/framebuffer.h"
#include "renderer/effects.h"
#include "scene/scene.h"

namespace insitu {

struct RenderSettings {
  Camera camera;
  std::vector<Light> lights;
  Effects effects;
  glm::dvec4 background{1.0};               // linear RGB, not premultiplied, and opacity
  std::uint32_t samples_per_pixel = 4;      // of adaptive sampling the least
  std::uint32_t max_samples_per_pixel = 0;  // 0: no adaptive sampling
  double pixel_error = 0.02;                // tolerated standard error of displayed values of 0..1
};

// Rays and seconds of one effect; seconds are those of all threads added up.
struct PassCost {
  std::uint64_t rays = 0;
  double seconds = 0.0;
  PassCost& operator+=(const PassCost& other) {
    rays += other.rays;
    seconds += other.seconds;
    return *this;
  }
};

struct RenderCosts {
  PassCost camera;
  PassCost shadows;
  PassCost ambient_occlusion;
  std::uint64_t layers = 0;  // that camera rays went through, where something is transparent
  std::uint64_t pixels = 0;
  std::uint64_t pixels_over_error = 0;  // with the most samples and still above pixel_error
  RenderCosts& operator+=(const RenderCosts& other) {
    camera += other.camera;
    shadows += other.shadows;
    ambient_occlusion += other.ambient_occlusion;
    layers += other.layers;
    pixels += other.pixels;
    pixels_over_error += other.pixels_over_error;
    return *this;
  }
};

// Fills `frame`, tile by tile, with as many threads as the caller's TBB arena has. The result is the same, bit for bit,
// for any number of them.
RenderCosts render_frame(const Scene& scene, const RenderSettings& settings, FrameBuffer& frame);

}  // namespace insitu
