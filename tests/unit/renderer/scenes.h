// Scenes of a few spheres for tests of the renderer, without the C API in between.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "core/workers.h"
#include "renderer/renderer.h"
#include "unit/geometry/arrays.h"

namespace insitu::testing {

struct Sphere {
  glm::dvec3 centre;
  double radius;
};

// One or more sets of spheres, all in one uniform colour.
class SphereScene {
 public:
  explicit SphereScene(std::vector<std::vector<Sphere>> sets, Rgba color = {1.0f, 1.0f, 1.0f, 1.0f}) {
    Style style;
    style.color = color;
    static Budget budget(0);
    for (const std::vector<Sphere>& spheres : sets) {
      data_.push_back(std::make_unique<Data>());
      Data& data = *data_.back();
      for (const Sphere& sphere : spheres) {
        data.x.insert(data.x.end(), {sphere.centre.x, sphere.centre.y, sphere.centre.z});
        data.radius.push_back(sphere.radius);
      }
      ParticleArrays arrays;
      arrays.position = positions_of(data.x);
      arrays.radius = view_of(data.radius, 1, INSITU_USE_RADIUS);
      data.particles.bind(std::move(arrays));
      data.particles.build(budget);
      scene_.add(data.particles, Colors(style, data.particles, *builtin_colormap("viridis")));
    }
    scene_.commit();
  }
  const Scene& scene() const { return scene_; }

 private:
  struct Data {
    std::vector<double> x;
    std::vector<double> radius;
    Particles particles{"spheres", ParticleOrder::index, false};
  };
  std::vector<std::unique_ptr<Data>> data_;
  Scene scene_;
};

constexpr std::uint32_t all_channels =
    INSITU_CHANNEL_COLOR | INSITU_CHANNEL_DEPTH | INSITU_CHANNEL_POSITION | INSITU_CHANNEL_NORMAL | INSITU_CHANNEL_ITEM;

struct Picture {
  FrameBuffer frame;
  RenderCosts costs;

  glm::dvec3 color(std::uint32_t x, std::uint32_t y) const {
    const float* c = &frame.color[4 * (std::size_t{y} * frame.width + x)];
    return {c[0], c[1], c[2]};
  }
  double alpha(std::uint32_t x, std::uint32_t y) const {
    return frame.color[4 * (std::size_t{y} * frame.width + x) + 3];
  }
  std::size_t at(std::uint32_t x, std::uint32_t y) const { return std::size_t{y} * frame.width + x; }
};

inline Picture render(const Scene& scene, const RenderSettings& settings, std::uint32_t width, std::uint32_t height,
                      unsigned threads = 2) {
  Picture picture;
  picture.frame.allocate(width, height, all_channels);
  Workers workers(threads);
  picture.costs = workers.run([&] { return render_frame(scene, settings, picture.frame); });
  return picture;
}

// Looking along -z from z = 10, `height` high, with one sample in the middle of each pixel.
inline RenderSettings orthographic(double height) {
  RenderSettings settings;
  settings.camera.kind = INSITU_CAMERA_ORTHOGRAPHIC;
  settings.camera.eye = {0.0, 0.0, 10.0};
  settings.camera.look_at = {0.0, 0.0, 0.0};
  settings.camera.height = height;
  settings.samples_per_pixel = 1;
  settings.background = {0.0, 0.0, 0.0, 1.0};
  return settings;
}

inline Light ambient_light(double radiance) {
  Light light;
  light.radiance = glm::dvec3(radiance);
  return light;
}

inline Light light_towards(const glm::dvec3& towards, double radiance) {
  Light light;
  light.directional = true;
  light.towards = glm::normalize(towards);
  light.radiance = glm::dvec3(radiance);
  return light;
}

// Where the middle of a pixel of an orthographic image of that height lies, right and up of its middle.
inline glm::dvec3 pixel_place(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height_px,
                              double height) {
  const double pixel = height / height_px;
  return {(x + 0.5 - 0.5 * width) * pixel, (0.5 * height_px - y - 0.5) * pixel, 0.0};
}

}  // namespace insitu::testing
