// One tile of an image: camera rays, the effects of the plan, and shading, one stream of rays after another.
#pragma once

#include "renderer/adaptive.h"
#include "renderer/layers.h"
#include "renderer/renderer.h"

namespace insitu {

constexpr std::uint32_t tile_edge_px = 16;

class TileRenderer {
 public:
  TileRenderer(const Scene& scene, const RenderSettings& settings, const EffectPlan& plan, FrameBuffer& frame);

  void render(std::uint32_t tile_x, std::uint32_t tile_y);
  const RenderCosts& costs() const { return costs_; }

 private:
  // A camera ray and what it came to; where something is transparent, one of the layers that it goes through.
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
    double weight;             // share in the colour of the ray
    std::uint32_t layer;       // 0 is the nearest
    std::uint32_t camera_ray;  // of a layer: its place among those of the batch
  };

  // Brings every pixel to its number in wanted_.
  void take_samples();
  bool want_more();
  void aim(std::uint32_t pixel, std::uint32_t index);
  void trace_batch();
  void trace_camera();
  void locate(Sample& sample) const;
  void light_samples();
  void trace_stream();
  double arriving(std::size_t ray) const;
  std::uint32_t occlusion_rays(const Sample& sample, bool is_beyond_least) const;
  std::uint64_t first_occlusion_ray(const Sample& sample) const;
  void occlude_ambient();
  void light_directly();
  glm::dvec3 radiance(const Sample& sample) const;
  glm::dvec4 background() const;
  void shade();
  // tile_layers.cpp
  void composite_layers();
  void next_layers();
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
  std::vector<double> arriving_;    // where something is transparent: along the stream's rays, the share of light
  std::vector<std::uint32_t> lit_;  // places in samples_ that the stream's rays belong to
  std::vector<PixelSamples> pixels_;
  std::vector<std::uint32_t> wanted_;  // samples per pixel
  std::vector<glm::dvec4> variances_;
  // Where something is transparent: the camera rays of a batch, and their way through it.
  std::vector<Sample> camera_rays_;
  std::vector<LayeredRay> layered_;
  std::vector<glm::dvec3> colors_;
  std::vector<Layer> found_;
};

}  // namespace insitu
