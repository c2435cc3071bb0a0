#include "antialiasing_scenes.h"

#include <cmath>
#include <numbers>

#include "renderer/sampling.h"

namespace bench {
namespace {

constexpr double picture_height = 2.0;  // of a cube of size 1

insitu::kernels::ArrayView view_of(const std::vector<float>& values, std::uint32_t components) {
  insitu::kernels::ArrayView view;
  view.type = insitu::kernels::Scalar::f32;
  view.components = components;
  view.count = values.size() / components;
  view.stride = static_cast<std::int64_t>(components * sizeof(float));
  for (std::size_t c = 0; c < components; ++c) view.base[c] = reinterpret_cast<const std::byte*>(values.data() + c);
  return view;
}

}  // namespace

CloudPicture::CloudPicture(const std::string& kind, std::uint64_t particles, std::uint32_t edge_px,
                           insitu::Workers& workers)
    : edge_px_(edge_px), workers_(workers), particles_("particles", insitu::ParticleOrder::index, false) {
  const bool dust = kind == "dust";
  ParticleScene cloud = make_scene(dust ? "uniform" : "clustered", particles);
  // Particles that are spread at random cover a share of 1 - exp(-count pi r^2) of the unit square.
  if (dust) cloud.radius = std::sqrt(0.5 / (std::numbers::pi * static_cast<double>(particles)));
  position_ = std::move(cloud.position);
  for (std::uint64_t i = 0; i < particles; ++i)
    heat_.push_back(static_cast<float>(insitu::pixel_noise(static_cast<std::uint32_t>(i), 0, 9, 1).x));
  insitu::ParticleArrays arrays;
  arrays.position = view_of(position_, 3);
  arrays.radius_default = cloud.radius;
  arrays.attributes.push_back({"heat", view_of(heat_, 1)});
  particles_.bind(arrays);
  insitu::Style style;
  style.by_attribute = true;
  style.attribute = "heat";
  workers_.run([&] {
    particles_.build(budget_);
    scene_.add(particles_, insitu::Colors(style, particles_, *insitu::builtin_colormap("viridis")));
    scene_.commit();
  });
  settings_.lights = insitu::default_lights();
  settings_.background = glm::dvec4(glm::dvec3(dust ? 0.0 : 1.0), 1.0);
  settings_.effects.ambient_occlusion = kind == "occlusion";
}

// Of the square of `size_px` pixels whose upper left corner is there.
insitu::Camera CloudPicture::camera(double left_px, double top_px, double size_px) const {
  insitu::Camera camera;
  camera.kind = INSITU_CAMERA_ORTHOGRAPHIC;
  camera.eye = {0.5, 0.5, 3.0};
  camera.look_at = {0.5, 0.5, 0.5};
  const double pixel = picture_height / edge_px_;
  const glm::dvec3 shift = pixel * ((left_px + 0.5 * size_px - 0.5 * edge_px_) * camera.right() -
                                    (top_px + 0.5 * size_px - 0.5 * edge_px_) * camera.true_up());
  camera.eye += shift;
  camera.look_at += shift;
  camera.height = size_px * pixel;
  return camera;
}

Rendered CloudPicture::render(const Sampling& sampling, const glm::dvec2& shift_px) {
  insitu::RenderSettings settings = settings_;
  settings.camera = camera(shift_px.x, shift_px.y, edge_px_);
  settings.samples_per_pixel = sampling.samples;
  settings.max_samples_per_pixel = sampling.max_samples;
  settings.pixel_error = sampling.pixel_error;
  Rendered rendered;
  rendered.frame.allocate(edge_px_, edge_px_, INSITU_CHANNEL_COLOR);
  rendered.costs = workers_.run([&] { return render_frame(scene_, settings, rendered.frame); });
  return rendered;
}

insitu::FrameBuffer CloudPicture::reference(std::uint32_t edge, const glm::dvec2& shift_px) {
  insitu::RenderSettings settings = settings_;
  settings.samples_per_pixel = 1;
  settings.effects.ao_samples = 1;  // as right on average, and there are many of them
  insitu::FrameBuffer result;
  result.allocate(edge_px_, edge_px_, INSITU_CHANNEL_COLOR);
  // In squares, so that the larger picture does not need the memory of all its pixels.
  constexpr std::uint32_t square_px = 16;
  insitu::FrameBuffer large;
  large.allocate(square_px * edge, square_px * edge, INSITU_CHANNEL_COLOR);
  for (std::uint32_t top = 0; top < edge_px_; top += square_px) {
    for (std::uint32_t left = 0; left < edge_px_; left += square_px) {
      settings.camera = camera(left + shift_px.x, top + shift_px.y, square_px);
      settings.effects.seed = top * edge_px_ + left + 1;
      workers_.run([&] { return render_frame(scene_, settings, large); });
      for (std::uint32_t y = 0; y < square_px; ++y) {
        for (std::uint32_t x = 0; x < square_px; ++x) {
          double sum[4] = {};
          for (std::uint32_t v = y * edge; v < (y + 1) * edge; ++v)
            for (std::size_t i = std::size_t{v} * large.width + x * edge, n = 0; n < edge; ++i, ++n)
              for (std::size_t c = 0; c < 4; ++c) sum[c] += static_cast<double>(large.color[4 * i + c]);
          for (std::size_t c = 0; c < 4; ++c)
            result.color[4 * (std::size_t{top + y} * edge_px_ + left + x) + c] =
                static_cast<float>(sum[c] / (edge * edge));
        }
      }
    }
  }
  return result;
}

}  // namespace bench
