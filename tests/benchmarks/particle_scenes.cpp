#include "particle_scenes.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "renderer/sampling.h"

namespace bench {
namespace {

constexpr std::uint32_t seed = 2015;

// Two numbers in [0, 1).
glm::dvec2 noise(std::uint64_t i, std::uint32_t purpose) {
  return insitu::pixel_noise(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i >> 32), purpose, seed);
}

// Two independent normal numbers (Box and Muller 1958).
glm::dvec2 normal_noise(std::uint64_t i, std::uint32_t purpose) {
  const glm::dvec2 u = noise(i, purpose);
  const double r = std::sqrt(-2.0 * std::log(1.0 - u.x));
  return {r * std::cos(2.0 * std::numbers::pi * u.y), r * std::sin(2.0 * std::numbers::pi * u.y)};
}

}  // namespace

ParticleScene make_scene(const std::string& name, std::uint64_t count) {
  ParticleScene scene;
  scene.name = name;
  scene.position.resize(3 * count);
  const double spacing = std::cbrt(1.0 / static_cast<double>(count));
  const bool clustered = name == "clustered";
  if (!clustered && name != "uniform") throw std::invalid_argument("no scene of this name: " + name);
  scene.radius = clustered ? 0.2 * spacing : 0.5 * spacing;
  for (std::uint64_t i = 0; i < count; ++i) {
    glm::dvec3 at;
    if (clustered) {
      const auto cluster = static_cast<std::uint64_t>(noise(i, 1).x * 200.0);
      const glm::dvec2 a = normal_noise(i, 2);
      const glm::dvec2 b = normal_noise(i, 3);
      at = glm::dvec3(noise(cluster, 4), noise(cluster, 5).x) + 0.02 * glm::dvec3(a, b.x);
    } else {
      at = glm::dvec3(noise(i, 6), noise(i, 7).x);
    }
    for (int c = 0; c < 3; ++c) scene.position[3 * i + static_cast<std::uint64_t>(c)] = static_cast<float>(at[c]);
  }
  return scene;
}

std::vector<insitu::kernels::Ray> camera_rays(const std::string& view, std::uint32_t edge_px) {
  const bool close = view == "close";
  if (!close && view != "far") throw std::invalid_argument("no view of this name: " + view);
  const glm::dvec3 eye = close ? glm::dvec3(0.52, 0.47, 0.45) : glm::dvec3(0.5, 0.5, -1.6);
  const double ahead = close ? 0.5 : 1.3;  // distance of an image plane of size 1
  std::vector<insitu::kernels::Ray> rays;
  rays.reserve(std::size_t{edge_px} * edge_px);
  // Tiles of 64 x 64 pixels, each in Morton order: neighbours stay together, however many rays one takes at a time.
  const auto even_bits = [](std::uint32_t v) {
    return (v & 1) | (v >> 1 & 2) | (v >> 2 & 4) | (v >> 3 & 8) | (v >> 4 & 16) | (v >> 5 & 32);
  };
  constexpr std::uint32_t tile = 64;
  for (std::uint32_t tile_y = 0; tile_y < edge_px; tile_y += tile) {
    for (std::uint32_t tile_x = 0; tile_x < edge_px; tile_x += tile) {
      for (std::uint32_t i = 0; i < tile * tile; ++i) {
        const double x = (tile_x + even_bits(i) + 0.5) / edge_px - 0.5;
        const double y = 0.5 - (tile_y + even_bits(i >> 1) + 0.5) / edge_px;
        const glm::dvec3 direction = glm::normalize(glm::dvec3(x, y, ahead));
        insitu::kernels::Ray ray{};
        for (int c = 0; c < 3; ++c) {
          ray.origin[c] = eye[c];
          ray.direction[c] = direction[c];
        }
        ray.t_max = std::numeric_limits<double>::infinity();
        ray.exclude = insitu::kernels::no_item;
        rays.push_back(ray);
      }
    }
  }
  return rays;
}

std::vector<insitu::kernels::Ray> occlusion_rays(const std::vector<insitu::kernels::Ray>& camera,
                                                 const std::vector<insitu::kernels::Hit>& hits,
                                                 const std::vector<float>& position, double reach) {
  std::vector<insitu::kernels::Ray> rays;
  for (std::size_t i = 0; i < camera.size(); ++i) {
    if (!hits[i].found()) continue;
    insitu::kernels::Ray ray{};
    glm::dvec3 normal;
    for (int c = 0; c < 3; ++c) {
      ray.origin[c] = camera[i].origin[c] + hits[i].t * camera[i].direction[c];
      normal[c] = ray.origin[c] - static_cast<double>(position[3 * hits[i].item + static_cast<std::uint64_t>(c)]);
    }
    const glm::dvec3 direction = insitu::cosine_direction(glm::normalize(normal), noise(i, 8));
    for (int c = 0; c < 3; ++c) ray.direction[c] = direction[c];
    ray.t_max = reach;
    ray.exclude = hits[i].item;
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace bench
