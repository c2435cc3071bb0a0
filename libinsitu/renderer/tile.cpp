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

// Traced at a time: enough for the packets and streams of the kernels, at about 100 bytes a ray.
constexpr std::size_t most_samples = 1024;
constexpr std::size_t most_layered_samples = 256;  // each may come to dozens of layers at a time
constexpr std::size_t most_occlusion_rays = 16384;

// Bits 0, 2, 4 and 6 of i: with those of i / 2 the coordinates of point i of a Morton curve over 16 x 16 pixels.
std::uint32_t even_bits(std::uint32_t i) { return (i & 1) | (i >> 1 & 2) | (i >> 2 & 4) | (i >> 3 & 8); }

}  // namespace

TileRenderer::TileRenderer(const Scene& scene, const RenderSettings& settings, const EffectPlan& plan,
                           FrameBuffer& frame)
    : scene_(scene),
      settings_(settings),
      plan_(plan),
      frame_(frame),
      rays_(settings.camera, static_cast<double>(frame.width) / static_cast<double>(frame.height)),
      batch_samples_(std::clamp<std::size_t>(most_occlusion_rays / std::max(plan.ao_samples, 1u), 16,
                                             scene.is_transparent() ? most_layered_samples : most_samples)) {}

void TileRenderer::render(std::uint32_t tile_x, std::uint32_t tile_y) {
  x0_ = tile_x * tile_edge_px;
  y0_ = tile_y * tile_edge_px;
  width_ = std::min(tile_edge_px, frame_.width - x0_);
  height_ = std::min(tile_edge_px, frame_.height - y0_);
  pixels_.assign(std::size_t{width_} * height_, PixelSamples{});
  wanted_.assign(pixels_.size(), settings_.samples_per_pixel);
  take_samples();
  if (settings_.max_samples_per_pixel > 0)
    while (want_more()) take_samples();
  store();
}

// In Morton order, and the samples of a pixel one after the other: rays that follow each other stay together.
void TileRenderer::take_samples() {
  samples_.clear();
  for (std::uint32_t place = 0; place < tile_edge_px * tile_edge_px; ++place) {
    const std::uint32_t column = even_bits(place);
    const std::uint32_t row = even_bits(place >> 1);
    if (column >= width_ || row >= height_) continue;
    const std::uint32_t pixel = row * width_ + column;
    const std::uint32_t begin = pixels_[pixel].count;
    for (std::uint32_t index = begin; index < wanted_[pixel]; ++index) {
      aim(pixel, index);
      if (samples_.size() == batch_samples_) trace_batch();
    }
  }
  if (!samples_.empty()) trace_batch();
}

// Judges every pixel anew, also those that were done: what their neighbours have found since may say otherwise.
bool TileRenderer::want_more() {
  const SamplingRule rule{settings_.max_samples_per_pixel, settings_.pixel_error};
  estimate_variances(pixels_, width_, variances_);
  bool more = false;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    wanted_[i] = next_count(rule, pixels_[i], variances_[i]);
    more = more || wanted_[i] > pixels_[i].count;
  }
  if (more) return true;
  for (std::size_t i = 0; i < pixels_.size(); ++i)
    if (displayed_error(pixels_[i], variances_[i]) > rule.pixel_error) ++costs_.pixels_over_error;
  return false;
}

void TileRenderer::aim(std::uint32_t pixel, std::uint32_t index) {
  Sample& s = samples_.emplace_back();
  s.pixel = pixel;
  s.index = index;
  s.weight = 1.0;
  s.x = x0_ + pixel % width_;
  s.y = y0_ + pixel / width_;
  // Where all pixels have the same few places, what lies between these places is missed by all of them, and none gives
  // its neighbours a hint. The first sample stays in the middle, where depth and the like are taken.
  constexpr std::uint32_t purpose = 2;
  const bool own_places = settings_.max_samples_per_pixel > 0 && index > 0;
  const glm::dvec2 within = own_places ? scrambled_point(index, s.x, s.y, purpose, plan_.seed) : r2_point(index);
  glm::dvec3 origin;
  glm::dvec3 direction;
  rays_.ray((s.x + within.x) / frame_.width, (s.y + within.y) / frame_.height, origin, direction);
  set_ray(s.ray, origin, direction);
  s.ray.ray.t_min = settings_.camera.near_clip;
  if (settings_.camera.far_clip > 0.0) s.ray.ray.t_max = settings_.camera.far_clip;
}

void TileRenderer::trace_batch() {
  trace_camera();
  if (scene_.is_transparent()) {
    composite_layers();
  } else {
    light_samples();
    shade();
    keep_channels();
  }
  samples_.clear();
}

void TileRenderer::light_samples() {
  if (plan_.ao_samples > 0) occlude_ambient();
  light_directly();
}

void TileRenderer::trace_camera() {
  const Stopwatch watch;
  const std::size_t count = samples_.size();
  stream_.resize(count);
  hits_.resize(count);
  for (std::size_t i = 0; i < count; ++i) stream_[i] = samples_[i].ray;
  scene_.first_hits(stream_.data(), hits_.data(), count);
  for (std::size_t i = 0; i < count; ++i) {
    samples_[i].hit = hits_[i];
    if (hits_[i].found() && !scene_.is_transparent()) locate(samples_[i]);
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

// Beyond the least samples a pixel is averaged over many, each of which may be noisier: a quarter of the occlusion rays
// leaves the same error for less. So it is with a layer, whose error counts by its weight: with numbers in proportion
// to the weights, all layers of a ray together are as noisy as an opaque surface.
std::uint32_t TileRenderer::occlusion_rays(const Sample& sample, bool is_beyond_least) const {
  const std::uint32_t rays = is_beyond_least ? (plan_.ao_samples + 3) / 4 : plan_.ao_samples;
  return static_cast<std::uint32_t>(std::ceil(rays * sample.weight));
}

// All occlusion rays of a pixel, in layers at the same place, are one sequence.
std::uint64_t TileRenderer::first_occlusion_ray(const Sample& sample) const {
  const std::uint64_t least = std::min(sample.index, settings_.samples_per_pixel);
  return least * occlusion_rays(sample, false) + (sample.index - least) * occlusion_rays(sample, true);
}

void TileRenderer::trace_stream() {
  if (scene_.is_transparent()) {
    arriving_.resize(stream_.size());
    scene_.transmittances(stream_.data(), arriving_.data(), stream_.size());
  } else {
    occluded_.resize(stream_.size());
    scene_.any_hits(stream_.data(), occluded_.data(), stream_.size());
  }
}

double TileRenderer::arriving(std::size_t ray) const {
  return scene_.is_transparent() ? arriving_[ray] : 1.0 - occluded_[ray];
}

// Ambient occlusion: the share of the hemisphere, weighted by the cosine to the normal, in which nothing is hit within
// ao_radius.
void TileRenderer::occlude_ambient() {
  const Stopwatch watch;
  constexpr std::uint32_t purpose = 1;
  stream_.clear();
  lit_.clear();
  for (std::uint32_t i = 0; i < samples_.size(); ++i) {
    const Sample& s = samples_[i];
    if (!s.hit.found()) continue;
    const glm::dvec2 noise = pixel_noise(s.x, s.y, s.layer << 8 | purpose, plan_.seed);
    SceneRay ray;
    ray.exclude_geometry = s.hit.geometry;
    ray.ray.exclude = s.hit.item;
    ray.ray.t_min = s.t_epsilon;
    ray.ray.t_max = plan_.ao_radius;
    const std::uint64_t first = first_occlusion_ray(s);
    const std::uint32_t rays = occlusion_rays(s, s.index >= settings_.samples_per_pixel);
    for (std::uint32_t k = 0; k < rays; ++k) {
      const glm::dvec2 u = shifted(r2_point(first + k), noise);
      set_ray(ray, s.point + s.t_epsilon * s.normal, cosine_direction(s.normal, u));
      stream_.push_back(ray);
    }
    lit_.push_back(i);
  }
  trace_stream();
  std::size_t ray = 0;
  for (const std::uint32_t i : lit_) {
    double blocked = 0.0;
    const std::uint32_t rays = occlusion_rays(samples_[i], samples_[i].index >= settings_.samples_per_pixel);
    for (std::uint32_t k = 0; k < rays; ++k) blocked += 1.0 - arriving(ray++);
    samples_[i].ambient_visible = 1.0 - blocked / rays;
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
    if (plan_.shadows) {
      trace_stream();
      costs_.shadows.rays += stream_.size();
      costs_.shadows.seconds += watch.seconds();
    }
    for (std::size_t i = 0; i < lit_.size(); ++i) {
      Sample& s = samples_[lit_[i]];
      const double share = plan_.shadows ? arriving(i) : 1.0;
      if (share > 0.0) s.light += share * (light.radiance * glm::dot(s.normal, light.towards));
    }
  }
}

glm::dvec3 TileRenderer::radiance(const Sample& sample) const {
  const Rgba color = scene_.entries()[sample.hit.geometry].colors.of(sample.color_item);
  const glm::dvec3 light = plan_.ambient * sample.ambient_visible + sample.light;
  return glm::dvec3(color.r, color.g, color.b) * light;
}

// Premultiplied.
glm::dvec4 TileRenderer::background() const {
  const glm::dvec4& back = settings_.background;
  return {back.r * back.a, back.g * back.a, back.b * back.a, back.a};
}

void TileRenderer::shade() {
  for (const Sample& s : samples_) pixels_[s.pixel].add(s.hit.found() ? glm::dvec4(radiance(s), 1.0) : background());
}

// Depth and the like have no meaningful average: they are those of the first sample, in the middle of the pixel, and of
// its first layer.
void TileRenderer::keep_channels() {
  for (const Sample& s : samples_) {
    if (s.index != 0 || s.layer != 0 || !s.hit.found()) continue;
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
  costs_.pixels += pixels_.size();
  for (std::uint32_t y = 0; y < height_; ++y) {
    for (std::uint32_t x = 0; x < width_; ++x) {
      const glm::dvec4 color = pixels_[std::size_t{y} * width_ + x].mean();
      float* out = &frame_.color[4 * (std::size_t{y0_ + y} * frame_.width + x0_ + x)];
      for (int c = 0; c < 4; ++c) out[c] = static_cast<float>(color[c]);
    }
  }
}

}  // namespace insitu
