#include "picture.h"

#include <filesystem>
#include <system_error>

namespace melt {
namespace {

// Atoms are drawn with their Lennard-Jones radius, sigma / 2: neighbours at the potential's minimum nearly touch.
constexpr double atom_radius = 0.5;
// Occlusion within a few atoms shows which atom lies before which; farther away it would only darken the box.
constexpr double ao_radius = 3.0;

}  // namespace

Picture::Picture(const PictureDesc& desc)
    : pattern_(desc.folder + "/melt_{step:6}.png"),
      order_(desc.order),
      aspect_(static_cast<double>(desc.width) / static_cast<double>(desc.height)) {
  std::error_code ignored;  // a folder that cannot be made shows when the first picture is written
  std::filesystem::create_directories(desc.folder, ignored);
  ready_ = create(desc);
}

bool Picture::ok(insitu_status status) {
  if (status == INSITU_OK) return true;
  error_ = insitu_error_text(context_.get());
  return false;
}

// Once, before the time loop: a context, what there is to see, from where, and on how many pixels.
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

  // No arrays yet: this only declares the atoms, and how they look. Colour is the speed, on a fixed range so that
  // pictures of different steps can be compared.
  insitu_particles_desc particles;
  insitu_particles_desc_init(&particles);
  particles.name = "atoms";
  particles.order = desc.order;
  particles.radius_default = atom_radius;
  insitu_style style;
  insitu_style_init(&style);
  style.color_by = INSITU_COLOR_ATTRIBUTE;
  style.attribute = "velocity";
  style.component = 0;  // the length of the vector
  style.range_mode = INSITU_RANGE_FIXED;
  style.range[1] = desc.speed_max;
  style.colormap = "inferno";

  insitu_effects effects;
  insitu_effects_init(&effects);
  if (desc.ao_samples > 0) effects.flags |= INSITU_EFFECT_AMBIENT_OCCLUSION;
  if (desc.shadows) effects.flags |= INSITU_EFFECT_SHADOWS;
  effects.ao_samples = desc.ao_samples;
  effects.ao_radius = ao_radius;
  insitu_camera camera;  // the direction alone counts: the first picture moves it until all atoms fill the image
  insitu_camera_init(&camera);
  camera.eye[0] = 2.0;
  camera.eye[1] = -3.0;
  camera.eye[2] = 1.6;
  camera.up[2] = 1.0;
  insitu_view_desc view;
  insitu_view_desc_init(&view);
  view.camera = &camera;
  view.effects = &effects;

  insitu_image_desc image;
  insitu_image_desc_init(&image);
  image.width = desc.width;
  image.height = desc.height;

  return ok(insitu_context_set_report(context, report.c_str())) &&
         ok(insitu_particles_create(context, &particles, &atoms_)) &&
         ok(insitu_geometry_set_style(context, atoms_, &style)) && ok(insitu_view_create(context, &view, &view_)) &&
         ok(insitu_image_create(context, &image, &image_));
}

// In the time loop: hand over this step's arrays, draw, take them back.
bool Picture::draw(std::uint64_t step, double time, std::span<Particle> particles) {
  if (!ready_) return false;
  insitu_context const context = context_.get();

  // Every column of the records is described by its first item and the distance to the next; nothing is copied. The
  // library reads positions and velocities only. If it may change the order of the records, it must know of forces and
  // ids too, and permutes all four together: what belongs to an atom stays with the atom.
  const auto column = [&](std::uint32_t type, std::uint32_t components, const auto Particle::*member) {
    insitu_array array = insitu_array_records(type, components, particles.empty() ? nullptr : &(particles[0].*member),
                                              particles.size(), sizeof(Particle));
    if (order_ == INSITU_ORDER_PERMUTE) array.flags = INSITU_ARRAY_PERMUTABLE;
    return array;
  };
  const insitu_array position = column(INSITU_F64, 3, &Particle::position);
  const insitu_array velocity = column(INSITU_F64, 3, &Particle::velocity);
  const insitu_array force = column(INSITU_F64, 3, &Particle::force);
  const insitu_array id = column(INSITU_I64, 1, &Particle::id);

  const insitu_attribute attribute = {"velocity", &velocity};
  const insitu_array* const payload[] = {&force, &id};
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.order = order_;
  desc.position = &position;
  desc.radius_default = atom_radius;
  desc.attributes = &attribute;
  desc.attribute_count = 1;
  if (order_ == INSITU_ORDER_PERMUTE) {
    desc.payload = payload;
    desc.payload_count = 2;
  }

  // The first error of a step makes the calls after it do nothing, and insitu_step_end returns it: one check is enough.
  insitu_step_begin(context, step, time);
  insitu_particles_update(context, atoms_, &desc);
  insitu_status fitted = insitu_commit(context);
  if (!camera_fitted_) fitted = insitu_view_fit(context, view_, aspect_);
  insitu_render(context, view_, image_);
  insitu_image_write(context, image_, pattern_.c_str());
  const bool written = ok(insitu_step_end(context));

  camera_fitted_ = fitted == INSITU_OK;
  add_cost();
  return written;
}

void Picture::add_cost() {
  insitu_stats stats;
  insitu_stats_init(&stats);
  if (insitu_stats_get(context_.get(), &stats) != INSITU_OK) return;
  cost_.build_s += stats.build_s;
  cost_.render_s += stats.render_s;
  cost_.write_s += stats.write_s;
  cost_.rays += stats.rays;
  cost_.copied_bytes = stats.copied_bytes;
  cost_.peak_bytes = stats.peak_bytes;
}

}  // namespace melt
