#include "renderer/tile.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/stopwatch.h"
#include "renderer/sampling.h"

namespace insitu {
namespace {

void set_ray(SceneRay& ray, const glm::dvec3& origin, const glm::dvec3& direction) {
  for (int c = 0; c < 3; ++c) {
    ray.ray.origin[c] = origin[c];
    ray.ray.direction[c] = direction[c];
  }
}

// How far a point computed as origin + t direction, and the hit test from there, may be off: some roundings of the
// largest number involved. Rays that leave the point start beyond it.
double rounding_of(const glm::dvec3& point, const SceneRay& ray, double t, double magnitude) {
  double largest = std::max(t, magnitude);
  for (int c = 0; c < 3; ++c) largest = std::max({largest, std::abs(point[c]), std::abs(ray.ray.origin[c])});
  return 32.0 * 2.220446049250313e-16 * largest;
}

// Bits 0, 2, 4 and 6 of i: with those of i / 2 the coordinates of point i of a Morton curve over 16 x 16 pixels.
std::uint32_t even_bits(std::uint32_t i) { return (i & 1) | (i >> 1 & 2) | (i >> 2 & 4) | (i >> 3 & 8); }

}  // namespace

TileRenderer::TileRenderer(const Scene& scene, const RenderSettings& settings, const EffectPlan& plan,
                           FrameBuffer& frame)
    : scene_(scene),
      settings_(settings),
      plan_(plan),
      frame_(frame),
      rays_(settings.camera, static_cast<double>(frame.width) / static_cast<double>(frame.height)) {}

void TileRenderer::render(std::uint32_t tile_x, std::uint32_t tile_y) {
  x0_ = tile_x * tile_edge_px;
  y0_ = tile_y * tile_edge_px;
  width_ = std::min(tile_edge_px, frame_.width - x0_);
  height_ = std::min(tile_edge_px, frame_.height - y0_);
  pixels_.assign(std::size_t{width_} * height_, glm::dvec4(0.0));
  for (std::uint32_t sample = 0; sample < settings_.samples_per_pixel; ++sample) {
    trace_camera(sample);
    if (plan_.ao_samples > 0) occlude_ambient(sample);
    light_directly();
    shade();
    if (sample == 0) keep_channels();
  }
  store();
}

void TileRenderer::trace_camera(std::uint32_t sample) {
  const Stopwatch watch;
  const glm::dvec2 within = r2_point(sample);
  const std::size_t count = std::size_t{width_} * height_;
  samples_.resize(count);
  stream_.resize(count);
  hits_.resize(count);
  // In Morton order, so that rays that follow each other stay together.
  std::uint32_t next = 0;
  for (std::uint32_t place = 0; place < tile_edge_px * tile_edge_px; ++place) {
    const std::uint32_t column = even_bits(place);
    const std::uint32_t row = even_bits(place >> 1);
    if (column >= width_ || row >= height_) continue;
    const std::uint32_t i = next++;
    Sample& s = samples_[i];
    s.pixel = row * width_ + column;
    s.x = x0_ + column;
    s.y = y0_ + row;
    s.ray = {};
    glm::dvec3 origin;
    glm::dvec3 direction;
    rays_.ray((s.x + within.x) / frame_.width, (s.y + within.y) / frame_.height, origin, direction);
    set_ray(s.ray, origin, direction);
    s.ray.ray.t_min = settings_.camera.near_clip;
    if (settings_.camera.far_clip > 0.0) s.ray.ray.t_max = settings_.camera.far_clip;
    stream_[i] = s.ray;
  }
  scene_.first_hits(stream_.data(), hits_.data(), count);
  for (std::size_t i = 0; i < count; ++i) {
    samples_[i].hit = hits_[i];
    if (hits_[i].found()) locate(samples_[i]);
  }
  costs_.camera.rays += count;
  costs_.camera.seconds += watch.seconds();
}

void TileRenderer::locate(Sample& sample) const {
  const kernels::Ray& ray = sample.ray.ray;
  const double t = sample.hit.t;
  const glm::dvec3 direction(ray.direction[0], ray.direction[1], ray.direction[2]);
  sample.point = glm::dvec3(ray.origin[0], ray.origin[1], ray.origin[2]) + t * direction;
  const Scene::Entry& entry = scene_.entries()[sample.hit.geometry];
  const double local[3] = {sample.point.x - entry.shift.x, sample.point.y - entry.shift.y,
                           sample.point.z - entry.shift.z};
  const Surface surface = entry.geometry->surface(sample.hit.item, local);
  sample.normal = glm::dvec3(surface.normal[0], surface.normal[1], surface.normal[2]);
  if (sample.normal == glm::dvec3(0.0)) sample.normal = -direction;
  if (glm::dot(sample.normal, direction) > 0.0) sample.normal = -sample.normal;
  sample.t_epsilon = rounding_of(sample.point, sample.ray, t, surface.magnitude);
  sample.item = surface.item;
  sample.color_item = surface.color_item;
  sample.ambient_visible = 1.0;
  sample.light = glm::dvec3(0.0);
}

// Ambient occlusion: the share of the hemisphere, weighted by the cosine to the normal, in which nothing is hit within
// ao_radius.
void TileRenderer::occlude_ambient(std::uint32_t sample) {
  const Stopwatch watch;
  constexpr std::uint32_t purpose = 1;
  stream_.clear();
  lit_.clear();
  for (std::uint32_t i = 0; i < samples_.size(); ++i) {
    const Sample& s = samples_[i];
    if (!s.hit.found()) continue;
    const glm::dvec2 noise = pixel_noise(s.x, s.y, purpose, plan_.seed);
    SceneRay ray;
    ray.exclude_geometry = s.hit.geometry;
    ray.ray.exclude = s.hit.item;
    ray.ray.t_min = s.t_epsilon;
    ray.ray.t_max = plan_.ao_radius;
    for (std::uint32_t k = 0; k < plan_.ao_samples; ++k) {
      const glm::dvec2 u = shifted(r2_point(std::uint64_t{sample} * plan_.ao_samples + k), noise);
      set_ray(ray, s.point + s.t_epsilon * s.normal, cosine_direction(s.normal, u));
      stream_.push_back(ray);
    }
    lit_.push_back(i);
  }
  occluded_.resize(stream_.size());
  scene_.any_hits(stream_.data(), occluded_.data(), stream_.size());
  const std::uint8_t* occluded = occluded_.data();
  for (const std::uint32_t i : lit_) {
    std::uint32_t blocked = 0;
    for (std::uint32_t k = 0; k < plan_.ao_samples; ++k) blocked += *occluded++;
    samples_[i].ambient_visible = 1.0 - static_cast<double>(blocked) / plan_.ao_samples;
  }
  costs_.ambient_occlusion.rays += stream_.size();
  costs_.ambient_occlusion.seconds += watch.seconds();
}

void TileRenderer::light_directly() {
  for (const PlannedLight& light : plan_.directional) {
    const Stopwatch watch;
    stream_.clear();
    lit_.clear();
    for (std::uint32_t i = 0; i < samples_.size(); ++i) {
      const Sample& s = samples_[i];
      if (!s.hit.found() || !(glm::dot(s.normal, light.towards) > 0.0)) continue;
      lit_.push_back(i);
      if (!plan_.shadows) continue;
      SceneRay ray;
      ray.exclude_geometry = s.hit.geometry;
      ray.ray.exclude = s.hit.item;
      ray.ray.t_min = s.t_epsilon;
      set_ray(ray, s.point + s.t_epsilon * s.normal, light.towards);
      stream_.push_back(ray);
    }
    occluded_.assign(lit_.size(), 0);
    if (plan_.shadows) {
      scene_.any_hits(stream_.data(), occluded_.data(), stream_.size());
      costs_.shadows.rays += stream_.size();
      costs_.shadows.seconds += watch.seconds();
    }
    for (std::size_t i = 0; i < lit_.size(); ++i) {
      Sample& s = samples_[lit_[i]];
      if (occluded_[i] == 0) s.light += light.radiance * glm::dot(s.normal, light.towards);
    }
  }
}

void TileRenderer::shade() {
  const glm::dvec4& back = settings_.background;
  const glm::dvec4 background(back.r * back.a, back.g * back.a, back.b * back.a, back.a);
  for (const Sample& s : samples_) {
    if (!s.hit.found()) {
      pixels_[s.pixel] += background;
      continue;
    }
    const Rgba color = scene_.entries()[s.hit.geometry].colors.of(s.color_item);
    const glm::dvec3 light = plan_.ambient * s.ambient_visible + s.light;
    pixels_[s.pixel] += glm::dvec4(glm::dvec3(color.r, color.g, color.b) * light, 1.0);
  }
}

// Depth and the like have no meaningful average: they are those of the first sample, in the middle of the pixel.
void TileRenderer::keep_channels() {
  for (const Sample& s : samples_) {
    if (!s.hit.found()) continue;
    const std::size_t at = std::size_t{s.y} * frame_.width + s.x;
    if (!frame_.depth.empty()) frame_.depth[at] = static_cast<float>(s.hit.t);
    if (!frame_.item.empty()) frame_.item[at] = s.item;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto axis = static_cast<glm::length_t>(c);
      if (!frame_.position.empty()) frame_.position[3 * at + c] = static_cast<float>(s.point[axis]);
      if (!frame_.normal.empty()) frame_.normal[3 * at + c] = static_cast<float>(s.normal[axis]);
    }
  }
}

void TileRenderer::store() {
  const double weight = 1.0 / settings_.samples_per_pixel;
  for (std::uint32_t y = 0; y < height_; ++y) {
    for (std::uint32_t x = 0; x < width_; ++x) {
      const glm::dvec4 color = pixels_[std::size_t{y} * width_ + x] * weight;
      float* out = &frame_.color[4 * (std::size_t{y0_ + y} * frame_.width + x0_ + x)];
      for (int c = 0; c < 4; ++c) out[c] = static_cast<float>(color[c]);
    }
  }
}

}  // namespace insitu
