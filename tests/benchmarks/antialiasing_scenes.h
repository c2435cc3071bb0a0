// Scenes with many particles per pixel, and pictures of them at any resolution.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "core/workers.h"
#include "particle_scenes.h"
#include "renderer/renderer.h"

namespace bench {

// How a picture is sampled.
struct Sampling {
  std::string name;
  std::uint32_t samples = 4;
  std::uint32_t max_samples = 0;  // 0: fixed
  double pixel_error = 0.02;
};

struct Rendered {
  insitu::FrameBuffer frame;
  insitu::RenderCosts costs;
  double mean_samples() const { return static_cast<double>(costs.camera.rays) / static_cast<double>(costs.pixels); }
};

class CloudPicture {
 public:
  // "clusters": 200 opaque clusters on white; "dust": small particles everywhere, which cover two fifths of the cube,
  // on black; "occlusion": the clusters with 8 ambient occlusion rays per hit. Colours are those of a random attribute.
  // The cube of the particles is half as high as the picture.
  CloudPicture(const std::string& kind, std::uint64_t particles, std::uint32_t edge_px, insitu::Workers& workers);

  // `shift_px`: the camera moves by so much of a pixel, to the right and down.
  Rendered render(const Sampling& sampling, const glm::dvec2& shift_px = glm::dvec2(0.0));

  // edge x edge samples per pixel in a regular grid, each of them a pixel of a larger picture: shares neither samples
  // nor the sampling with what is judged by it.
  insitu::FrameBuffer reference(std::uint32_t edge, const glm::dvec2& shift_px = glm::dvec2(0.0));

  std::uint32_t edge_px() const { return edge_px_; }

 private:
  insitu::Camera camera(double left_px, double top_px, double size_px) const;

  std::uint32_t edge_px_;
  insitu::Workers& workers_;
  std::vector<float> position_;
  std::vector<float> heat_;
  insitu::Budget budget_{0};
  insitu::Particles particles_;
  insitu::Scene scene_;
  insitu::RenderSettings settings_;
};

}  // namespace bench
