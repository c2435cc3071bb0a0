#include "api/context.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <new>
#include <utility>

#include "api/filter_input.h"
#include "api/particles_input.h"
#include "core/error.h"
#include "core/stopwatch.h"
#include "image/file_pattern.h"
#include "image/image_writer.h"

namespace insitu {
namespace {

std::uint32_t next_context_serial() {
  static std::atomic<std::uint32_t> counter{0};
  return counter.fetch_add(1);
}

constexpr std::uint32_t most_pixels_per_side = 1 << 16;
constexpr std::uint32_t most_samples = 1 << 16;
constexpr double default_pixel_error = 0.02;  // five of the 255 steps of a PNG file

std::string software() {
  return "libinsitu " + std::to_string(INSITU_VERSION_MAJOR) + "." + std::to_string(INSITU_VERSION_MINOR) + "." +
         std::to_string(INSITU_VERSION_PATCH);
}

CameraMetadata camera_metadata(const Camera& camera) {
  CameraMetadata metadata;
  metadata.kind = camera.kind;
  for (int c = 0; c < 3; ++c) {
    const auto i = static_cast<std::size_t>(c);
    metadata.eye[i] = camera.eye[c];
    metadata.look_at[i] = camera.look_at[c];
    metadata.up[i] = camera.up[c];
  }
  metadata.fov_y_deg = camera.fov_y_deg;
  metadata.height = camera.height;
  return metadata;
}

[[noreturn]] void refuse(const std::string& text) { throw Error(INSITU_ERROR_INVALID_ARGUMENT, text); }

void read_sampling(const insitu_image_desc& desc, ImageObject& image) {
  if (desc.samples_per_pixel != 0) image.samples_per_pixel = desc.samples_per_pixel;
  if (image.samples_per_pixel > most_samples) refuse("image: more than 65536 samples per pixel");
  if (!(desc.pixel_error >= 0.0 && std::isfinite(desc.pixel_error)))
    refuse("image: pixel_error is negative or not finite");
  if (desc.max_samples_per_pixel == 0) {
    if (desc.pixel_error != 0.0) refuse("image: pixel_error has no effect without max_samples_per_pixel");
    return;
  }
  if (desc.max_samples_per_pixel > most_samples) refuse("image: max_samples_per_pixel is above 65536");
  if (desc.max_samples_per_pixel < image.samples_per_pixel)
    refuse("image: max_samples_per_pixel, " + std::to_string(desc.max_samples_per_pixel) +
           ", is below samples_per_pixel, " + std::to_string(image.samples_per_pixel));
  if (image.samples_per_pixel < 2) refuse("image: max_samples_per_pixel needs 2 samples_per_pixel or more to judge by");
  image.max_samples_per_pixel = desc.max_samples_per_pixel;
  image.pixel_error = desc.pixel_error == 0.0 ? default_pixel_error : desc.pixel_error;
}

}  // namespace

const char* handle_kind_name(HandleKind kind) {
  switch (kind) {
    case HandleKind::geometry:
      return "geometry";
    case HandleKind::colormap:
      return "colormap";
    case HandleKind::view:
      return "view";
    case HandleKind::image:
      return "image";
  }
  return "object";
}

Context::Context(const insitu_context_desc& desc)
    : serial_(next_context_serial()),
      workers_(desc.max_threads),
      budget_(desc.max_extra_bytes),
      check_level_(desc.check_level),
      flags_(desc.flags),
      geometries_(HandleKind::geometry, serial_),
      colormaps_(HandleKind::colormap, serial_),
      views_(HandleKind::view, serial_),
      images_(HandleKind::image, serial_) {}

// ----------------------------------------------------------------------------------------------- messages and state --

void Context::set_log(insitu_log_fn fn, void* user, std::int32_t level) {
  log_fn_ = fn;
  log_user_ = user;
  log_level_ = level;
}

void Context::set_report(const char* path) { report_path_ = path == nullptr ? "" : path; }

void Context::log(std::int32_t level, const char* text) noexcept {
  if (log_fn_ != nullptr && level <= log_level_) log_fn_(log_user_, level, text);
}

void Context::warn(const std::string& text) {
  report_.warnings.push_back(text);
  log(INSITU_LOG_WARNING, text.c_str());
}

// Without memory of its own: what failed may have been an allocation.
insitu_status Context::fail(insitu_status status, const char* text) noexcept {
  keep_error_text(text);
  log(INSITU_LOG_ERROR, error_text_.data());
  if (in_step_ && report_.status == INSITU_OK) {
    report_.status = status;
    report_.error = error_text_.data();  // reserved by begin_step
  }
  return status;
}

void Context::keep_error_text(const char* text) noexcept {
  const std::size_t length = std::min(std::strlen(text), error_text_.size() - 1);
  std::memmove(error_text_.data(), text, length);
  error_text_[length] = '\0';
}

void Context::need_step(const char* call) const {
  if (!in_step_)
    throw Error(INSITU_ERROR_WRONG_STATE,
                std::string(call) + " is for use between insitu_step_begin and insitu_step_end");
}

void Context::need_commit(const char* call) const {
  need_step(call);
  if (!committed_) throw Error(INSITU_ERROR_WRONG_STATE, std::string(call) + " needs insitu_commit first");
}

// --------------------------------------------------------------------------------------------------------- geometry --

std::uint64_t Context::create_particles(const insitu_particles_desc& desc) {
  if ((desc.flags & ~std::uint32_t{INSITU_PARTICLES_KEEP_PERMUTATION}) != 0) refuse("unknown flags for particles");
  const ParticleOrder order = read_order(desc.order);
  const bool keep = (desc.flags & INSITU_PARTICLES_KEEP_PERMUTATION) != 0;
  const std::uint64_t id =
      geometries_.insert(std::make_unique<GeometryObject>(desc.name == nullptr ? "particles" : desc.name, order, keep));
  if (desc.position == nullptr) return id;
  try {
    update_particles(id, desc);
  } catch (...) {
    geometries_.remove(id);
    throw;
  }
  return id;
}

void Context::update_particles(std::uint64_t id, const insitu_particles_desc& desc) {
  GeometryObject& geometry = particle_set(id);
  need_step("insitu_particles_update");
  ParticleArrays arrays = read_particle_arrays(desc, geometry.particles.name(), geometry.particles.order());
  scene_dirty_ = true;
  geometry.changed = true;
  geometry.particles.bind(std::move(arrays));
  if (is_null()) return;
  if (check_level_ >= INSITU_CHECK_VALUES) check_values(geometry);
  if (check_level_ >= INSITU_CHECK_CHECKSUM) geometry.checksum = workers_.run([&] { return checksum_of(geometry); });
}

void Context::check_values(const GeometryObject& geometry) {
  const std::vector<std::string> counts = workers_.run([&] { return geometry.particles.describe_bad_values(); });
  for (const std::string& text : counts) warn(geometry.particles.name() + ": " + text);
}

void Context::permutation(std::uint64_t id, std::uint64_t* original, std::uint64_t count) {
  const GeometryObject& geometry = particle_set(id);
  need_commit("insitu_particles_permutation");
  if (is_null()) return;
  if (original == nullptr && geometry.particles.item_count() != 0) refuse("original is NULL");
  geometry.particles.permutation(original, count);
}

void Context::restore_order(std::uint64_t id) {
  GeometryObject& geometry = particle_set(id);
  need_commit("insitu_particles_restore_order");
  if (is_null()) return;
  scene_dirty_ = true;
  scene_.clear();
  geometry.particles.restore_order();
}

void Context::set_filter(std::uint64_t id, const insitu_filter* description) {
  GeometryObject& geometry = particle_set(id);
  std::shared_ptr<const Filter> filter = description == nullptr ? nullptr : read_filter(budget_, *description);
  if (filter && geometry.particles.is_bound()) geometry.particles.check_filter(*filter);
  geometry.filter = std::move(filter);
  geometry.filter_changed = true;
  geometry.changed = true;
}

void Context::set_style(std::uint64_t id, const insitu_style& description) {
  GeometryObject& geometry = geometries_.get(id);
  const Style style = make_style(description);
  const Colormap& map = colormap_of(style);
  check_map(style, map);
  if (geometry.glyphs && is_transparent(style, map))
    throw Error(INSITU_ERROR_UNSUPPORTED, "style: bonds and vectors are always opaque, and this style is not");
  const Particles& particles = geometry.glyphs ? particle_set(geometry.glyphs->set()).particles : geometry.particles;
  if (particles.is_bound()) Colors::check(style, particles);
  geometry.style = style;
  geometry.style_is_default = false;
  scene_dirty_ = true;
}

void Context::bounds(std::uint64_t id, double lower[3], double upper[3]) {
  const GeometryObject& geometry = geometries_.get(id);
  need_commit("insitu_geometry_bounds");
  for (int c = 0; c < 3; ++c) {
    lower[c] = std::numeric_limits<double>::infinity();
    upper[c] = -lower[c];
  }
  if (is_null() || !is_drawn(geometry) ||
      !(geometry.glyphs ? geometry.glyphs->is_built() : geometry.particles.is_built()))
    return;
  each_shown(geometry, [&](const Geometry& shown, const glm::dvec3& shift) {
    double low[3];
    double high[3];
    shown.bounds(low, high);
    if (!(low[0] <= high[0])) return;
    for (int c = 0; c < 3; ++c) {
      lower[c] = std::min(lower[c], low[c] + shift[c]);
      upper[c] = std::max(upper[c], high[c] + shift[c]);
    }
  });
}

void Context::destroy_geometry(std::uint64_t id) {
  geometries_.get(id);
  scene_.clear();
  scene_dirty_ = true;
  destroy_glyphs_of(id);
  geometries_.remove(id);
}

// -------------------------------------------------------------------------------------------------------- colormaps --

std::uint64_t Context::create_colormap(const insitu_colormap_desc& desc) {
  if (desc.kind > INSITU_COLORMAP_CATEGORICAL)
    refuse("colormap: kind is neither INSITU_COLORMAP_CONTINUOUS nor INSITU_COLORMAP_CATEGORICAL");
  if (desc.rgba == nullptr || desc.count == 0) refuse("colormap: there are no colours");
  if (desc.count > (1u << 24)) refuse("colormap: more than 2^24 colours");
  return colormaps_.insert(std::make_unique<Colormap>(Colormap::from_srgb(
      static_cast<ColormapKind>(desc.kind), {desc.rgba, static_cast<std::size_t>(4 * desc.count)})));
}

void Context::destroy_colormap(std::uint64_t id) {
  colormaps_.get(id);
  scene_.clear();
  scene_dirty_ = true;
  colormaps_.remove(id);
}

const Colormap& Context::colormap_of(const Style& style) {
  return style.own_map != 0 ? colormaps_.get(style.own_map) : *builtin_colormap(style.colormap_name);
}

// ------------------------------------------------------------------------------------------------------------ views --

std::uint64_t Context::create_view(const insitu_view_desc* desc) {
  return views_.insert(std::make_unique<ViewObject>(make_view(desc)));
}

void Context::fit_view(std::uint64_t id, double aspect) {
  ViewObject& view = views_.get(id);
  need_commit("insitu_view_fit");
  if (!(aspect >= 0.0 && std::isfinite(aspect))) refuse("aspect is negative or not finite");
  if (is_null()) return;
  refresh_scene();
  fit_camera(view.camera, scene_.bounds(), aspect == 0.0 ? 1.0 : aspect);
  view.to_be_fitted = false;
}

void Context::turn_view(std::uint64_t id, double angle_deg) {
  ViewObject& view = views_.get(id);
  if (!std::isfinite(angle_deg)) refuse("the angle is not finite");
  turn_camera(view.camera, angle_deg);
}

// ----------------------------------------------------------------------------------------------------------- images --

std::uint64_t Context::create_image(const insitu_image_desc& desc) {
  const std::uint32_t width = desc.width == 0 ? 1024 : desc.width;
  const std::uint32_t height = desc.height == 0 ? 768 : desc.height;
  if (width > most_pixels_per_side || height > most_pixels_per_side) refuse("image: more than 65536 pixels a side");
  constexpr std::uint32_t known = INSITU_CHANNEL_COLOR | INSITU_CHANNEL_DEPTH | INSITU_CHANNEL_POSITION |
                                  INSITU_CHANNEL_NORMAL | INSITU_CHANNEL_ITEM;
  if ((desc.channels & ~known) != 0) refuse("image: unknown channels");
  auto image = std::make_unique<ImageObject>();
  read_sampling(desc, *image);
  const std::uint32_t channels = desc.channels | INSITU_CHANNEL_COLOR;
  image->share = BudgetShare(budget_, FrameBuffer::bytes_for(width, height, channels), "the frame buffer");
  image->frame.allocate(width, height, channels);
  return images_.insert(std::move(image));
}

void Context::render(std::uint64_t view_id, std::uint64_t image_id) {
  ViewObject& view = views_.get(view_id);
  ImageObject& image = images_.get(image_id);
  need_commit("insitu_render");
  if (is_null()) return;
  refresh_scene();
  const double aspect = static_cast<double>(image.frame.width) / static_cast<double>(image.frame.height);
  if (view.to_be_fitted && !scene_.bounds().empty()) {
    fit_camera(view.camera, scene_.bounds(), aspect);
    view.to_be_fitted = false;
  }
  RenderSettings settings;
  settings.camera = view.camera;
  if (settings.camera.kind == INSITU_CAMERA_ORTHOGRAPHIC && settings.camera.height == 0.0) {
    Camera fitted = settings.camera;
    fit_camera(fitted, scene_.bounds(), aspect);
    settings.camera.height = fitted.height > 0.0 ? fitted.height : 1.0;
  }
  settings.lights = view.lights.empty() ? default_lights() : view.lights;
  settings.effects = view.effects;
  settings.background = view.background;
  settings.samples_per_pixel = image.samples_per_pixel;
  settings.max_samples_per_pixel = image.max_samples_per_pixel;
  settings.pixel_error = image.pixel_error;

  const Stopwatch watch;
  const RenderCosts costs = workers_.run([&] { return render_frame(scene_, settings, image.frame); });
  const double seconds = watch.seconds();
  report_.render_s += seconds;
  costs_ += costs;
  image.rendered = true;
  image.metadata.step = report_.step;
  image.metadata.time = report_.time;
  image.metadata.camera = camera_metadata(settings.camera);
  image.metadata.samples_per_pixel = image.samples_per_pixel;
  image.metadata.max_samples_per_pixel = image.max_samples_per_pixel;
  image.metadata.pixel_error = image.pixel_error;
  image.metadata.mean_samples_per_pixel = static_cast<double>(costs.camera.rays) / static_cast<double>(costs.pixels);
  image.metadata.seconds_build = report_.build_s;
  image.metadata.seconds_render = seconds;
  image.metadata.software = software();
}

void Context::write_image(std::uint64_t image_id, const char* pattern) {
  const ImageObject& image = images_.get(image_id);
  if (pattern == nullptr || *pattern == '\0') refuse("the file name pattern is empty");
  const ExpandedPattern path = expand_pattern(pattern, report_.step, report_.time);
  if (!path.ok()) refuse(path.error);
  if (is_null()) return;
  if (!image.rendered) throw Error(INSITU_ERROR_WRONG_STATE, "nothing has been rendered into this image yet");
  const Stopwatch watch;
  const WriteResult result = insitu::write_image(image.frame, image.metadata, path.text);
  if (result.status != INSITU_OK) throw Error(result.status, result.message);
  if (!in_step_) return;
  report_.write_s += watch.seconds();
  report_.images.push_back(path.text);
}

insitu_array Context::channel(std::uint64_t image_id, std::uint32_t channel) {
  const FrameBuffer& frame = images_.get(image_id).frame;
  const auto view = [&](std::uint32_t type, std::uint32_t components, const void* data, bool empty) {
    if (empty) refuse("this image was created without that channel");
    return insitu_array_records(type, components, data, frame.pixel_count(), 0);
  };
  switch (channel) {
    case INSITU_CHANNEL_COLOR:
      return view(INSITU_F32, 4, frame.color.data(), frame.color.empty());
    case INSITU_CHANNEL_DEPTH:
      return view(INSITU_F32, 1, frame.depth.data(), frame.depth.empty());
    case INSITU_CHANNEL_POSITION:
      return view(INSITU_F32, 3, frame.position.data(), frame.position.empty());
    case INSITU_CHANNEL_NORMAL:
      return view(INSITU_F32, 3, frame.normal.data(), frame.normal.empty());
    case INSITU_CHANNEL_ITEM:
      return view(INSITU_U64, 1, frame.item.data(), frame.item.empty());
    default:
      refuse("channel is not one of INSITU_CHANNEL_*");
  }
}

// ------------------------------------------------------------------------------------------------------------- step --

void Context::begin_step(std::uint64_t step, double time) {
  if (in_step_) throw Error(INSITU_ERROR_WRONG_STATE, "the step before has not been ended by insitu_step_end");
  report_ = {};
  report_.step = step;
  report_.time = time;
  report_.error.reserve(error_text_.size());
  costs_ = {};
  in_step_ = true;
  committed_ = false;
  scene_dirty_ = true;
}

void Context::commit() {
  need_step("insitu_commit");
  // Whatever can be wrong is found before anything moves.
  geometries_.for_each([this](std::uint64_t, GeometryObject& geometry) {
    if (!is_drawn(geometry)) return;
    if (geometry.glyphs) return check_glyphs(geometry);
    if (geometry.filter) geometry.particles.check_filter(*geometry.filter);
    Colors::check(geometry.style, geometry.particles);
    colormap_of(geometry.style);
  });
  if (!is_null()) {
    scene_.clear();  // holds what is built anew
    geometries_.for_each([this](std::uint64_t, GeometryObject& geometry) {
      select(geometry);
      build(geometry);
      if (!geometry.glyphs && geometry.changed && is_drawn(geometry)) build_cell(geometry);
    });
    geometries_.for_each([this](std::uint64_t, GeometryObject& geometry) {
      if (!geometry.glyphs || !is_drawn(geometry)) return;
      if (particle_set(geometry.glyphs->set()).changed || !geometry.glyphs->is_built()) build_glyphs(geometry);
    });
    geometries_.for_each([](std::uint64_t, GeometryObject& geometry) {
      if (geometry.particles.is_built()) geometry.changed = false;
    });
    scene_dirty_ = true;
    refresh_scene();
  }
  committed_ = true;
}

// Puts a changed filter in force: with the tree where that is still to be built, otherwise in the one that stands.
void Context::select(GeometryObject& geometry) {
  if (!std::exchange(geometry.filter_changed, false)) return;
  Particles& particles = geometry.particles;
  particles.set_filter(geometry.filter);
  if (!particles.is_built()) return;
  const Stopwatch watch;
  report_.items_filtered -= particles.drawn_count() - particles.shown_count();
  workers_.run([&] { particles.select(budget_); });
  report_.items_filtered += particles.drawn_count() - particles.shown_count();
  report_.build_s += watch.seconds();
}

void Context::build(GeometryObject& geometry) {
  Particles& particles = geometry.particles;
  if (!particles.is_bound() || particles.is_built()) return;
  const Stopwatch watch;
  workers_.run([&] { particles.build(budget_); });
  report_.build_s += watch.seconds();
  const std::uint64_t items = particles.item_count();
  const std::uint64_t skipped = items - particles.drawn_count();
  report_.items_total += items;
  report_.items_skipped += skipped;
  report_.items_filtered += particles.drawn_count() - particles.shown_count();
  const PkdBuilt& made = particles.how_built();
  report_.trees_built += made.how == PkdBuilt::How::built ? 1 : 0;
  report_.trees_repaired += made.how == PkdBuilt::How::repaired ? 1 : 0;
  report_.trees_reused += made.how == PkdBuilt::How::reused ? 1 : 0;
  report_.items_moved += made.moved;
  report_.treelets += particles.treelet_count();
  report_.treelet_bytes += particles.treelet_bytes();
  report_.bytes_borrowed += particles.borrowed_bytes();
  report_.bytes_copied += particles.copied_bytes();
  if (skipped != 0)
    warn(particles.name() + ": " + std::to_string(skipped) + " of " + std::to_string(items) +
         " particles are not drawn: their position is not finite, or their radius not positive and finite");
}

void Context::refresh_scene() {
  if (!scene_dirty_) return;
  const Stopwatch watch;
  scene_.clear();
  workers_.run([this] {
    fill_scene();
    scene_.commit();
  });
  scene_dirty_ = false;
  report_.build_s += watch.seconds();
}

insitu_status Context::end_step() {
  if (!in_step_) throw Error(INSITU_ERROR_WRONG_STATE, "insitu_step_end without insitu_step_begin");
  if (check_level_ >= INSITU_CHECK_CHECKSUM && !is_null()) {
    geometries_.for_each([this](std::uint64_t, GeometryObject& geometry) {
      if (!geometry.particles.is_bound() && !(geometry.glyphs && geometry.glyphs->takes_part())) return;
      if (workers_.run([&] { return checksum_of(geometry); }) != geometry.checksum)
        fail(INSITU_ERROR_WRONG_STATE,
             (geometry.particles.name() + ": values of its arrays changed between the update and insitu_step_end")
                 .c_str());
    });
  }
  scene_.clear();
  geometries_.for_each([](std::uint64_t, GeometryObject& geometry) {
    geometry.particles.release();
    geometry.shown_cell.release();
    if (geometry.glyphs) geometry.glyphs->release();
  });
  in_step_ = false;
  committed_ = false;
  if (report_.status != INSITU_OK) keep_error_text(report_.error.c_str());
  try {
    const insitu_status written = write_report();
    if (report_.status == INSITU_OK) return written;
  } catch (const std::bad_alloc&) {
    if (report_.status == INSITU_OK) throw;  // otherwise the step's own error counts
  }
  return report_.status;
}

insitu_status Context::write_report() {
  refresh_report();
  if (report_path_.empty() || is_null()) return INSITU_OK;
  const AppendResult result = append_line(report_path_, to_json_line(report_));
  if (result.status == INSITU_OK || report_.status != INSITU_OK) return result.status;
  return fail(result.status, result.message.c_str());
}

void Context::refresh_report() {
  report_.bytes_owned = budget_.owned();
  report_.bytes_peak = budget_.peak();
  report_.pixels = costs_.pixels;
  report_.samples = costs_.camera.rays;
  report_.pixels_over_error = costs_.pixels_over_error;
  report_.effects.clear();
  const auto add = [this](const char* name, const PassCost& cost) {
    if (cost.rays != 0) report_.effects.push_back({name, cost.rays, cost.seconds});
  };
  add("camera", costs_.camera);
  add("shadows", costs_.shadows);
  add("ambient_occlusion", costs_.ambient_occlusion);
}

insitu_stats Context::stats() const {
  insitu_stats stats;
  insitu_stats_init(&stats);
  stats.step = report_.step;
  stats.borrowed_bytes = report_.bytes_borrowed;
  stats.copied_bytes = report_.bytes_copied;
  stats.owned_bytes = budget_.owned();
  stats.peak_bytes = budget_.peak();
  stats.items = report_.items_total;
  stats.items_skipped = report_.items_skipped;
  stats.items_filtered = report_.items_filtered;
  stats.trees_built = report_.trees_built;
  stats.trees_repaired = report_.trees_repaired;
  stats.trees_reused = report_.trees_reused;
  stats.items_moved = report_.items_moved;
  stats.treelets = report_.treelets;
  stats.treelet_bytes = report_.treelet_bytes;
  stats.rays = costs_.camera.rays + costs_.shadows.rays + costs_.ambient_occlusion.rays;
  stats.build_s = report_.build_s;
  stats.render_s = report_.render_s;
  stats.write_s = report_.write_s;
  stats.total_s = report_.total_s;
  stats.pixels = costs_.pixels;
  stats.samples = costs_.camera.rays;
  stats.pixels_over_error = costs_.pixels_over_error;
  return stats;
}

}  // namespace insitu
