// One tile of an image: camera rays, the effects of the plan, and shading, one stream of rays after another.
#pragma once

#include "renderer/adaptive.h"
#include "renderer/renderer.h"

namespace insitu {

constexpr std::uint32_t tile_edge_px = 16;

class TileRenderer {
 public:
  TileRenderer(const Scene& scene, const RenderSettings& settings, const EffectPlan& plan, FrameBuffer& frame);

  void render(std::uint32_t tile_x, std::uint32_t tile_y);
  const RenderCosts& costs() const { return costs_; }

 private:
  // A camera ray and what it came to.
  struct Sample {
    std::uint32_t pixel;  // within the tile
    std::uint32_t index;  // among the samples of its pixel
    std::uint32_t x;
    std::uint32_t y;
    SceneRay ray;
    SceneHit hit;
    glm::dvec3 point;
    glm::dvec3 normal;
    double t_epsilon;          // secondary rays start beyond it
    std::uint64_t item;        // as the item channel shows it
    std::uint64_t color_item;  // whose colour it has
    double ambient_visible;    // 0 to 1
    glm::dvec3 light;          // direct light, cosine included
  };

  // Brings every pixel to its number in wanted_.
  void take_samples();
  bool want_more();
  void aim(std::uint32_t pixel, std::uint32_t index);
  void trace_batch();
  void trace_camera();
  void locate(Sample& sample) const;
  std::uint32_t occlusion_rays(const Sample& sample) const;
  std::uint64_t first_occlusion_ray(const Sample& sample) const;
  void occlude_ambient();
  void light_directly();
  void shade();
  void keep_channels();
  void store();

  const Scene& scene_;
  const RenderSettings& settings_;
  const EffectPlan& plan_;
  FrameBuffer& frame_;
  CameraRays rays_;
  RenderCosts costs_;

  std::uint32_t x0_ = 0;
  std::uint32_t y0_ = 0;
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
  std::size_t batch_samples_ = 0;  // at most, at a time
  std::vector<Sample> samples_;
  std::vector<SceneRay> stream_;
  std::vector<SceneHit> hits_;
  std::vector<std::uint8_t> occluded_;
  std::vector<std::uint32_t> lit_;  // places in samples_ that the stream's rays belong to
  std::vector<PixelSamples> pixels_;
  std::vector<std::uint32_t> wanted_;  // samples per pixel
  std::vector<glm::dvec4> variances_;
};

}  // namespace insitu
