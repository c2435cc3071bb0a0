#include "picture.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <system_error>

#include "look.h"

namespace cosmo {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

insitu_image_desc image_of(const PictureDesc& desc) {
  insitu_image_desc image;
  insitu_image_desc_init(&image);
  image.width = desc.width;
  image.height = desc.height;
  image.samples_per_pixel = desc.samples_per_pixel;
  return image;
}

}  // namespace

Picture::Picture(const PictureDesc& desc)
    : pattern_(desc.folder + "/cosmo_{step:4}.png"),
      order_(desc.order),
      attribute_(desc.color_by == ColorBy::speed ? "speed" : "density"),
      radius_(particle_radius(desc)),
      aspect_(static_cast<double>(desc.width) / static_cast<double>(desc.height)),
      camera_fitted_(desc.slab > 0.0) {
  std::error_code ignored;  // a folder that cannot be made shows when the first picture is written
  std::filesystem::create_directories(desc.folder, ignored);
  const Clock::time_point start = Clock::now();
  ready_ = create(desc);
  cost_.calls_s += seconds_since(start);
}

bool Picture::ok(insitu_status status) {
  if (status == INSITU_OK) return true;
  error_ = insitu_error_text(context_.get());
  return false;
}

// Once, before the time loop: a context, what there is to see, how it looks, from where, and on how many pixels.
bool Picture::create(const PictureDesc& desc) {
  insitu_context_desc context_desc;
  insitu_context_desc_init(&context_desc);
  context_desc.max_threads = desc.threads;
  insitu_context context = nullptr;
  if (!ok(insitu_context_create(&context_desc, &context))) return false;
  context_.reset(context);

  const std::string report = desc.folder + "/report.jsonl";
  std::error_code ignored;
  std::filesystem::remove(report, ignored);  // lines are appended; those of the last run tell of other pictures

  insitu_particles_desc particles;  // no arrays yet: this only declares the particles
  insitu_particles_desc_init(&particles);
  particles.name = "matter";
  particles.order = desc.order;
  particles.radius_default = radius_;
  const insitu_colormap_desc colors = color_map();
  if (!ok(insitu_context_set_report(context, report.c_str())) ||
      !ok(insitu_particles_create(context, &particles, &matter_)) ||
      !ok(insitu_colormap_create(context, &colors, &colormap_))) {
    return false;
  }

  insitu_style style;
  insitu_style_init(&style);
  style.color_by = INSITU_COLOR_ATTRIBUTE;
  style.attribute = attribute_;
  style.range_mode = INSITU_RANGE_FIXED;  // so that pictures of different steps can be compared
  color_range(desc.color_by, style.range);
  style.own_map = colormap_;
  style.opacity = desc.opacity;

  const insitu_camera camera = camera_for(desc);
  const insitu_effects effects = effects_for(desc);
  insitu_view_desc view;
  insitu_view_desc_init(&view);
  view.camera = &camera;
  view.effects = &effects;
  const std::array<insitu_light, 2> light = lights();
  view.lights = light.data();
  view.light_count = static_cast<std::uint32_t>(light.size());
  std::copy(background.begin(), background.end(), view.background);
  const insitu_image_desc image = image_of(desc);
  if (!ok(insitu_geometry_set_style(context, matter_, &style)) || !ok(insitu_view_create(context, &view, &view_)) ||
      !ok(insitu_image_create(context, &image, &image_))) {
    return false;
  }

  insitu_stats stats;  // before the first step all that the library owns is the image
  insitu_stats_init(&stats);
  if (!ok(insitu_stats_get(context, &stats))) return false;
  cost_.frame_buffer_bytes = stats.owned_bytes;
  return true;
}

bool Picture::draw(std::uint64_t step, double a, Particles& particles) {
  if (!ready_) return false;
  const Clock::time_point start = Clock::now();
  const bool written = draw_step(step, a, particles);
  cost_.calls_s += seconds_since(start);
  add_cost();
  return written;
}

// In the time loop: hand over this step's arrays, draw, take them back.
bool Picture::draw_step(std::uint64_t step, double a, Particles& particles) {
  insitu_context context = context_.get();

  // Arrays are described, not copied. If the library may change the order of the particles, it must know of all that
  // belongs to one, and permutes everything together; it reads positions and colours only.
  const auto described = [&](std::uint32_t type, std::uint32_t components, const void* data) {
    insitu_array array = insitu_array_records(type, components, data, particles.size(), 0);
    if (order_ == INSITU_ORDER_PERMUTE) array.flags = INSITU_ARRAY_PERMUTABLE;
    return array;
  };
  const insitu_array position = described(INSITU_F32, 3, particles.position.data());
  const insitu_array color = described(INSITU_F32, 1, particles.color.data());
  const insitu_array momentum = described(INSITU_F32, 3, particles.momentum.data());
  const insitu_array id = described(INSITU_I64, 1, particles.id.data());
  const insitu_array mass = described(INSITU_F32, 1, particles.mass.data());

  const insitu_attribute attribute = {attribute_, &color};
  const insitu_array* const payload[] = {&momentum, &id, &mass};
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.order = order_;
  desc.position = &position;
  desc.radius_default = radius_;
  desc.attributes = &attribute;
  desc.attribute_count = 1;
  if (order_ == INSITU_ORDER_PERMUTE) {
    desc.payload = payload;
    desc.payload_count = 3;
  }

  // The first error of a step makes the calls after it do nothing, and insitu_step_end returns it: one check is enough.
  insitu_step_begin(context, step, a);
  insitu_particles_update(context, matter_, &desc);
  insitu_status fitted = insitu_commit(context);
  if (!camera_fitted_) fitted = insitu_view_fit(context, view_, aspect_);
  insitu_render(context, view_, image_);
  insitu_image_write(context, image_, pattern_.c_str());
  const bool written = ok(insitu_step_end(context));
  camera_fitted_ = fitted == INSITU_OK;
  return written;
}

void Picture::add_cost() {
  insitu_stats stats;
  insitu_stats_init(&stats);
  if (insitu_stats_get(context_.get(), &stats) != INSITU_OK) return;
  cost_.build_s.push_back(stats.build_s);
  cost_.render_s += stats.render_s;
  cost_.write_s += stats.write_s;
  cost_.rays += stats.rays;
  cost_.copied_bytes = stats.copied_bytes;
  cost_.peak_bytes = stats.peak_bytes;
}

}  // namespace cosmo
