// Transparent particles in a tile: rounds of layers, each lit as an opaque surface is, added up front to back.
#include "core/stopwatch.h"
#include "renderer/tile.h"

namespace insitu {

// samples_ are the camera rays of the batch, with their hits of what is opaque; in each round they are the layers.
void TileRenderer::composite_layers() {
  camera_rays_.swap(samples_);
  colors_.assign(camera_rays_.size(), glm::dvec3(0.0));
  layered_.clear();
  for (const Sample& ray : camera_rays_) layered_.emplace_back(ray.ray, ray.hit);
  for (;;) {
    samples_.clear();
    next_layers();
    if (samples_.empty()) break;
    light_samples();
    keep_channels();
    for (const Sample& layer : samples_) colors_[layer.camera_ray] += layer.weight * radiance(layer);
  }
  for (std::size_t i = 0; i < camera_rays_.size(); ++i) {
    const double passed = layered_[i].transmittance();
    pixels_[camera_rays_[i].pixel].add(glm::dvec4(colors_[i], 1.0 - passed) + passed * background());
  }
}

void TileRenderer::next_layers() {
  const Stopwatch watch;
  for (std::uint32_t i = 0; i < camera_rays_.size(); ++i) {
    if (layered_[i].is_done()) continue;
    found_.clear();
    layered_[i].advance(scene_, found_);
    for (const Layer& layer : found_) {
      Sample& sample = samples_.emplace_back(camera_rays_[i]);
      sample.hit = layer.hit;
      sample.weight = layer.weight;
      sample.layer = layer.place;
      sample.camera_ray = i;
      locate(sample);
    }
  }
  costs_.layers += samples_.size();
  costs_.camera.seconds += watch.seconds();
}

}  // namespace insitu
