#include "player.h"

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "filters.h"
#include "glyphs.h"
#include "image_name.h"

namespace replay {
namespace {

void print_message(void*, std::int32_t level, const char* text) {
  std::cerr << "insitu-replay: " << (level == INSITU_LOG_WARNING ? "warning: " : "") << text << '\n';
}

// 0 for what is no type.
std::int32_t type_of(double value) { return value >= 0.0 && value < 2e9 ? static_cast<std::int32_t>(value) : 0; }

constexpr std::uint32_t scalar_type(const std::vector<double>&) { return INSITU_F64; }
constexpr std::uint32_t scalar_type(const std::vector<float>&) { return INSITU_F32; }
constexpr std::uint32_t scalar_type(const std::vector<std::int32_t>&) { return INSITU_I32; }
constexpr std::uint32_t scalar_type(const std::vector<std::uint32_t>&) { return INSITU_U32; }
constexpr std::uint32_t scalar_type(const std::vector<std::int64_t>&) { return INSITU_I64; }
constexpr std::uint32_t scalar_type(const std::vector<std::uint64_t>&) { return INSITU_U64; }

void copy(const std::array<double, 3>& from, double to[3]) { std::copy(from.begin(), from.end(), to); }

}  // namespace

Player::Player(const Options& options) : options_(options), clock_(std::chrono::steady_clock::now()) {
  insitu_context_desc desc;
  insitu_context_desc_init(&desc);
  desc.max_threads = options.threads;
  insitu_context context = nullptr;
  if (insitu_context_create(&desc, &context) != INSITU_OK) throw LibraryError(insitu_error_text(nullptr));
  context_.reset(context);
  if (!options.quiet) check(insitu_context_set_log(context, print_message, nullptr, INSITU_LOG_WARNING));
  if (!options.report.empty()) check(insitu_context_set_report(context, options.report.c_str()));

  insitu_particles_desc particles;
  insitu_particles_desc_init(&particles);
  particles.order = options.order;
  check(insitu_particles_create(context, &particles, &particles_));
  create_view();
  create_image();
}

void Player::check(insitu_status status) const {
  if (status != INSITU_OK) throw LibraryError(insitu_error_text(context_.get()));
}

void Player::create_view() {
  insitu_effects effects;
  insitu_effects_init(&effects);
  if (options_.shadows) effects.flags |= INSITU_EFFECT_SHADOWS;
  if (options_.ao_samples > 0) effects.flags |= INSITU_EFFECT_AMBIENT_OCCLUSION;
  effects.ao_samples = options_.ao_samples;
  effects.ao_radius = options_.ao_radius;
  insitu_view_desc desc;
  insitu_view_desc_init(&desc);
  desc.effects = &effects;
  std::copy(options_.background.begin(), options_.background.end(), desc.background);
  check(insitu_view_create(context_.get(), &desc, &view_));
}

void Player::create_image() {
  insitu_image_desc desc;
  insitu_image_desc_init(&desc);
  desc.width = options_.width;
  desc.height = options_.height;
  desc.samples_per_pixel = options_.samples;
  desc.max_samples_per_pixel = options_.max_samples;
  desc.pixel_error = options_.pixel_error;
  if (is_exr(options_.out)) {
    desc.channels = INSITU_CHANNEL_DEPTH | INSITU_CHANNEL_POSITION | INSITU_CHANNEL_NORMAL | INSITU_CHANNEL_ITEM;
  }
  check(insitu_image_create(context_.get(), &desc, &image_));
}

// The file's own number as long as numbers grow, so that no picture overwrites another one.
std::uint64_t Player::number_of(const Frame& frame) {
  const std::uint64_t next = last_step_ ? *last_step_ + 1 : 0;
  last_step_ = frame.step && *frame.step >= next ? *frame.step : next;
  return *last_step_;
}

void Player::play(Frame& frame) {
  if (last_step_ && !has_step(options_.out)) {
    throw UsageError("--out " + options_.out + ": there is more than one step, expected {step} in the name");
  }
  insitu_context const context = context_.get();
  const ColorChoice color = choose_color(frame, options_);
  Arrays arrays;
  arrays.radius = choose_radius(frame, options_);
  const std::uint64_t step = number_of(frame);
  check(insitu_step_begin(context, step, frame.time.value_or(static_cast<double>(step))));
  update(frame, arrays);
  set_style(color);
  set_filter(frame);
  update_glyphs(frame);
  check(insitu_commit(context));
  if (fit_) fit();
  const int turns = options_.camera.turntable;
  for (int i = 0; i < turns; ++i) draw(step, 360.0 * i / turns);
  check(insitu_step_end(context));
}

void Player::update(Frame& frame, Arrays& arrays) {
  const std::uint64_t count = frame.count();
  const std::uint32_t flags = options_.order == INSITU_ORDER_PERMUTE ? std::uint32_t{INSITU_ARRAY_PERMUTABLE} : 0u;
  const auto records = [&](std::uint32_t type, std::uint32_t components, const void* data) {
    insitu_array array = insitu_array_records(type, components, data, count, 0);
    array.flags = flags;
    return array;
  };
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.order = options_.order;
  arrays.position_array = records(INSITU_F64, 3, frame.position.data());
  desc.position = &arrays.position_array;
  desc.radius_default = arrays.radius.for_all;
  desc.radius_scale = ball_scale(options_);
  desc.treelet_share = options_.treelet_share;
  if (!arrays.radius.per_particle.empty()) {
    arrays.radius_array = records(INSITU_F32, 1, arrays.radius.per_particle.data());
    desc.radius = &arrays.radius_array;
  }
  if (!arrays.radius.mapped.empty()) {
    const RadiusMap& map = *options_.radius_map;
    desc.radius_attribute = arrays.radius.mapped.c_str();
    desc.radius_component = arrays.radius.component;
    desc.radius_map = map.radii.data();
    desc.radius_map_count = map.radii.size();
    std::copy(map.range.begin(), map.range.end(), desc.radius_range);
  }
  arrays.values.reserve(frame.attributes.size());
  for (const Attribute& attribute : frame.attributes) {
    if (attribute.name == "type") {
      arrays.type.resize(attribute.size());
      for_each_value(attribute.scalars, [&](std::size_t i, double value) { arrays.type[i] = type_of(value); });
      arrays.type_array = records(INSITU_I32, 1, arrays.type.data());
      desc.type = &arrays.type_array;
      continue;
    }
    arrays.values.push_back(std::visit(
        [&](const auto& values) { return records(scalar_type(values), attribute.components, values.data()); },
        attribute.scalars));
    arrays.attributes.push_back({attribute.name.c_str(), &arrays.values.back()});
  }
  desc.attributes = arrays.attributes.data();
  desc.attribute_count = arrays.attributes.size();
  check(insitu_particles_update(context_.get(), particles_, &desc));
}

void Player::set_style(const ColorChoice& color) {
  insitu_style style;
  insitu_style_init(&style);
  if (!color.attribute.empty()) {
    style.color_by = INSITU_COLOR_ATTRIBUTE;
    style.attribute = color.attribute.c_str();
    style.component = color.component;
    style.colormap = color.colormap.c_str();
  }
  if (!options_.opacity_map.empty()) {
    const bool is_continuous =
        !color.attribute.empty() && color.colormap != "categorical" && color.colormap != "elements";
    if (!is_continuous) {
      throw UsageError("--opacity-map: expected a colour by value, such as --color speed --colormap viridis");
    }
    style.opacity_map = options_.opacity_map.data();
    style.opacity_map_count = options_.opacity_map.size();
  }
  style.opacity = options_.opacity;
  if (options_.range) {
    style.range_mode = INSITU_RANGE_FIXED;
    style.range[0] = (*options_.range)[0];
    style.range[1] = (*options_.range)[1];
  }
  // All zero would be the library's default, and not black.
  constexpr double nearly_black = 1e-6;
  for (std::size_t i = 0; i < 3; ++i) style.color[i] = std::max(color.color[i], nearly_black);
  check(insitu_geometry_set_style(context_.get(), particles_, &style));
}

void Player::set_filter(const Frame& frame) {
  const FrameFilter filter(frame, options_);
  const insitu_filter description = filter.filter();
  check(insitu_particles_set_filter(context_.get(), particles_, &description));
}

void Player::update_glyphs(const Frame& frame) {
  insitu_context const context = context_.get();
  const CellChoice cell = choose_cell(frame, options_);
  check(insitu_particles_set_cell(context, particles_, cell.known ? &cell.cell : nullptr));
  BondChoice bonds = choose_bonds(frame, options_);
  if (bonds.wanted) {
    bonds.bonds.particles = particles_;
    check(bonds_.id == 0 ? insitu_bonds_create(context, &bonds.bonds, &bonds_)
                         : insitu_bonds_update(context, bonds_, &bonds.bonds));
  }
  check_vectors(frame, options_);
  if (options_.vectors.empty() || vectors_.id != 0) return;
  insitu_vectors_desc vectors;
  insitu_vectors_desc_init(&vectors);
  vectors.particles = particles_;
  vectors.attribute = options_.vectors.c_str();
  vectors.scale = options_.vector_scale;
  check(insitu_vectors_create(context, &vectors, &vectors_));
}

// Once per file: in a trajectory the camera stands still.
void Player::fit() {
  fit_ = false;
  const CameraOptions& wish = options_.camera;
  insitu_context const context = context_.get();
  insitu_camera camera;
  insitu_camera_init(&camera);
  camera.kind = wish.orthographic ? INSITU_CAMERA_ORTHOGRAPHIC : INSITU_CAMERA_PERSPECTIVE;
  camera.fov_y_deg = wish.fov_deg;
  camera.height = wish.height;
  if (wish.up) copy(*wish.up, camera.up);
  if (!wish.eye) {
    copy(wish.from, camera.eye);
    check(insitu_view_set_camera(context, view_, &camera));
    check(insitu_view_fit(context, view_, static_cast<double>(options_.width) / options_.height));
    return;
  }
  copy(*wish.eye, camera.eye);
  if (wish.at) {
    copy(*wish.at, camera.look_at);
  } else {
    double lower[3];
    double upper[3];
    check(insitu_geometry_bounds(context, particles_, lower, upper));
    for (int i = 0; i < 3; ++i) camera.look_at[i] = lower[i] <= upper[i] ? (lower[i] + upper[i]) / 2 : 0.0;
  }
  check(insitu_view_set_camera(context, view_, &camera));
}

void Player::draw(std::uint64_t step, double angle_deg) {
  insitu_context const context = context_.get();
  const bool turns = options_.camera.turntable > 1;
  const std::string name = image_name(turns ? with_angle(options_.out) : options_.out, step, angle_deg);
  insitu_camera start;
  insitu_camera_init(&start);
  if (turns) {
    check(insitu_view_get_camera(context, view_, &start));
    check(insitu_view_turn(context, view_, angle_deg));
  }
  check(insitu_render(context, view_, image_));
  check(insitu_image_write(context, image_, name.c_str()));
  // Every angle starts from the same camera: no error adds up.
  if (turns) check(insitu_view_set_camera(context, view_, &start));
  print_line(name);
}

void Player::print_line(const std::string& name) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - clock_).count();
  clock_ = now;
  if (options_.quiet) return;
  insitu_stats stats;
  insitu_stats_init(&stats);
  check(insitu_stats_get(context_.get(), &stats));
  char text[128];
  const auto number = [](std::uint64_t count) { return static_cast<unsigned long long>(count); };
  char filtered[40] = "";
  if (!options_.filters.empty())
    std::snprintf(filtered, sizeof filtered, ", %llu filtered", number(stats.items_filtered));
  std::snprintf(text, sizeof text, "  %llu particles, %llu skipped%s, %.2f s\n", number(stats.items),
                number(stats.items_skipped), filtered, seconds);
  std::cout << name << text << std::flush;
}

}  // namespace replay
