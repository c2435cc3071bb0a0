// The state behind an insitu_context: its objects, the open step, and what the step has cost. One method per call of
// the C API; each throws Error, which api.cpp turns into a status.
#pragma once

#include <array>
#include <string>

#include "api/glyphs.h"
#include "api/handles.h"
#include "core/budget.h"
#include "core/workers.h"
#include "image/framebuffer.h"
#include "image/image_metadata.h"
#include "insitu/insitu.h"
#include "renderer/renderer.h"
#include "report/report.h"
#include "scene/scene.h"

namespace insitu {

// A set of particles; or bonds or vectors, which have `glyphs`, and of `particles` nothing but the name.
struct GeometryObject {
  GeometryObject(std::string name, ParticleOrder order, bool keep_permutation)
      : particles(std::move(name), order, keep_permutation) {}
  Particles particles;
  Style style;
  bool style_is_default = false;  // of vectors: follows the attribute
  std::optional<CellDisplay> cell;
  std::shared_ptr<const Filter> filter;
  bool filter_changed = false;  // since the last commit
  bool changed = true;          // arrays, cell or filter, since the last commit
  ShownCell shown_cell;         // as of the last commit of the step
  std::unique_ptr<Glyphs> glyphs;
  std::uint64_t checksum = 0;  // of the bound arrays, with INSITU_CHECK_CHECKSUM
};

struct ViewObject {
  Camera camera = default_camera();
  bool to_be_fitted = true;
  Effects effects;
  std::vector<Light> lights;  // empty: the default ones
  glm::dvec4 background{1.0};
};

struct ImageObject {
  FrameBuffer frame;
  BudgetShare share;
  std::uint32_t samples_per_pixel = 4;
  std::uint32_t max_samples_per_pixel = 0;
  double pixel_error = 0.0;
  ImageMetadata metadata;
  bool rendered = false;
};

// Throws Error(invalid_argument). NULL: all defaults.
ViewObject make_view(const insitu_view_desc* desc);
std::vector<Light> read_lights(const insitu_light* lights, std::uint64_t count);
glm::dvec4 read_background(const double rgba[4]);

class Context {
 public:
  explicit Context(const insitu_context_desc& desc);

  void set_log(insitu_log_fn fn, void* user, std::int32_t level);
  void set_report(const char* path);

  std::uint64_t create_particles(const insitu_particles_desc& desc);
  void update_particles(std::uint64_t id, const insitu_particles_desc& desc);
  void permutation(std::uint64_t id, std::uint64_t* original, std::uint64_t count);
  void restore_order(std::uint64_t id);
  void set_filter(std::uint64_t id, const insitu_filter* filter);
  void set_style(std::uint64_t id, const insitu_style& style);
  void bounds(std::uint64_t id, double lower[3], double upper[3]);
  void destroy_geometry(std::uint64_t id);

  void set_cell(std::uint64_t id, const insitu_cell* cell);
  std::uint64_t create_bonds(const insitu_bonds_desc& desc);
  void update_bonds(std::uint64_t id, const insitu_bonds_desc& desc);
  std::uint64_t create_vectors(const insitu_vectors_desc& desc);
  void update_vectors(std::uint64_t id, const insitu_vectors_desc& desc);

  std::uint64_t create_colormap(const insitu_colormap_desc& desc);
  void destroy_colormap(std::uint64_t id);

  std::uint64_t create_view(const insitu_view_desc* desc);
  ViewObject& view(std::uint64_t id) { return views_.get(id); }
  void fit_view(std::uint64_t id, double aspect);
  void turn_view(std::uint64_t id, double angle_deg);
  void destroy_view(std::uint64_t id) { views_.remove(id); }

  std::uint64_t create_image(const insitu_image_desc& desc);
  void render(std::uint64_t view, std::uint64_t image);
  void write_image(std::uint64_t image, const char* pattern);
  insitu_array channel(std::uint64_t image, std::uint32_t channel);
  void destroy_image(std::uint64_t id) { images_.remove(id); }

  void begin_step(std::uint64_t step, double time);
  void commit();
  // The step's first error; its text is error_text().
  insitu_status end_step();
  insitu_stats stats() const;

  // The first error of a step sticks.
  bool in_step() const { return in_step_; }
  insitu_status step_status() const { return report_.status; }
  insitu_status fail(insitu_status status, const char* text) noexcept;
  const char* error_text() const { return error_text_.data(); }
  void count_time(double seconds) { report_.total_s += in_step_ ? seconds : 0.0; }

 private:
  void need_step(const char* call) const;
  void need_commit(const char* call) const;
  bool is_null() const { return (flags_ & INSITU_CONTEXT_NULL) != 0; }
  void log(std::int32_t level, const char* text) noexcept;
  void keep_error_text(const char* text) noexcept;
  void warn(const std::string& text);
  void check_values(const GeometryObject& geometry);
  void build(GeometryObject& geometry);
  void select(GeometryObject& geometry);
  void refresh_scene();
  // context_glyphs.cpp
  GeometryObject& particle_set(std::uint64_t id);
  std::uint64_t create_glyphs(std::uint64_t set, const std::string& name,
                              const std::function<void(GeometryObject&)>& make);
  const Style& glyph_style(const GeometryObject& object);
  bool is_drawn(const GeometryObject& object);
  void check_glyphs(const GeometryObject& object);
  void build_cell(GeometryObject& geometry);
  void build_glyphs(GeometryObject& object);
  void each_shown(const GeometryObject& object, const std::function<void(const Geometry&, const glm::dvec3&)>& action);
  void fill_scene();
  static std::uint64_t checksum_of(const GeometryObject& object) {
    return object.glyphs ? object.glyphs->checksum() : object.particles.checksum();
  }
  void destroy_glyphs_of(std::uint64_t set);
  const Colormap& colormap_of(const Style& style);
  insitu_status write_report();
  void refresh_report();

  const std::uint32_t serial_;  // in the ids of this context's objects
  Workers workers_;
  Budget budget_;
  std::uint32_t check_level_;
  std::uint32_t flags_;
  insitu_log_fn log_fn_ = nullptr;
  void* log_user_ = nullptr;
  std::int32_t log_level_ = 0;
  std::string report_path_;
  std::array<char, 2048> error_text_{};

  HandleTable<GeometryObject> geometries_;
  HandleTable<Colormap> colormaps_;
  HandleTable<ViewObject> views_;
  HandleTable<ImageObject> images_;

  bool in_step_ = false;
  bool committed_ = false;    // since step_begin
  bool scene_dirty_ = false;  // colours or geometries changed since the scene was made
  Scene scene_;
  StepReport report_;  // of the open step, or of the last one
  RenderCosts costs_;  // likewise
};

}  // namespace insitu
