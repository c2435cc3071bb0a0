// The exported functions, one short body each: the exception firewall. No algorithm lives here.
#include <cstring>
#include <new>
#include <string>

#include "api/context.h"
#include "api/descriptor.h"
#include "core/float_environment.h"
#include "core/stopwatch.h"
#include "geometry/geometry_info.h"

// Recognises a pointer that is not, or no longer, a context, as far as that can be done.
constexpr std::uint64_t context_magic = 0x696e736974753031;  // "insitu01"

struct insitu_context_s {
  std::uint64_t magic = context_magic;
  insitu::Context context;
  explicit insitu_context_s(const insitu_context_desc& desc) : context(desc) {}
};

namespace {

using insitu::Context;
using insitu::copy_in;
using insitu::copy_out;
using insitu::Error;

thread_local char creation_error[1024];

// Calls `report` with what went wrong, when something does.
template <class Body, class Report>
insitu_status guarded(Body&& body, Report&& report) noexcept {
  const insitu::FloatEnvironment guard;
  try {
    body();
    return INSITU_OK;
  } catch (const Error& error) {
    return report(error.status(), error.what());
  } catch (const std::bad_alloc&) {
    return report(INSITU_ERROR_OUT_OF_MEMORY, "the system has no memory left");
  } catch (const std::length_error&) {
    return report(INSITU_ERROR_OUT_OF_MEMORY, "more memory was asked for than there can be");
  } catch (const std::exception& error) {
    return report(INSITU_ERROR_INTERNAL, error.what());
  } catch (...) {
    return report(INSITU_ERROR_INTERNAL, "an unknown exception");
  }
}

bool is_context(insitu_context handle) { return handle != nullptr && handle->magic == context_magic; }

template <class Body>
insitu_status always(insitu_context handle, Body&& body) noexcept {
  if (!is_context(handle)) return INSITU_ERROR_INVALID_HANDLE;
  const insitu::FloatEnvironment guard;  // around the stopwatch too: its arithmetic raises flags
  Context& context = handle->context;
  const insitu::Stopwatch watch;
  const insitu_status status = guarded(
      [&] { body(context); }, [&](insitu_status code, const char* text) noexcept { return context.fail(code, text); });
  context.count_time(watch.seconds());
  return status;
}

// As always(), but does nothing after the first error of a step.
template <class Body>
insitu_status call(insitu_context handle, Body&& body) noexcept {
  if (!is_context(handle)) return INSITU_ERROR_INVALID_HANDLE;
  const Context& context = handle->context;
  if (context.in_step() && context.step_status() != INSITU_OK) return context.step_status();
  return always(handle, std::forward<Body>(body));
}

template <class T>
T& output(T* pointer, const char* name) {
  if (pointer == nullptr) throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string(name) + " is NULL");
  return *pointer;
}

}  // namespace

// ---------------------------------------------------------------------------------------------------------- version --

uint32_t insitu_abi_version(void) { return INSITU_ABI; }

const char* insitu_version_text(void) {
  static const std::string text = [] {
    return std::to_string(INSITU_VERSION_MAJOR) + "." + std::to_string(INSITU_VERSION_MINOR) + "." +
           std::to_string(INSITU_VERSION_PATCH) + " (SIMD:" + insitu::simd_targets_text() + ")";
  }();
  return text.c_str();
}

const char* insitu_status_name(insitu_status status) { return insitu::report_status_name(status).data(); }

// ---------------------------------------------------------------------------------------------------------- context --

insitu_status insitu_context_create(const insitu_context_desc* desc, insitu_context* out) {
  if (out != nullptr) *out = nullptr;
  return guarded(
      [&] {
        output(out, "out");
        insitu_context_desc defaults;
        insitu_context_desc_init(&defaults);
        const insitu_context_desc own = desc == nullptr ? defaults : copy_in(desc, "insitu_context_desc");
        if (own.abi != INSITU_ABI)
          throw Error(INSITU_ERROR_ABI, "the program was compiled for interface " + std::to_string(own.abi) +
                                            ", the library has " + std::to_string(INSITU_ABI));
        if (own.check_level > INSITU_CHECK_CHECKSUM) throw Error(INSITU_ERROR_INVALID_ARGUMENT, "unknown check_level");
        if ((own.flags & ~std::uint32_t{INSITU_CONTEXT_NULL}) != 0)
          throw Error(INSITU_ERROR_INVALID_ARGUMENT, "unknown flags of a context");
        if (own.max_threads > 65536) throw Error(INSITU_ERROR_INVALID_ARGUMENT, "max_threads is above 65536");
        *out = new insitu_context_s(own);
      },
      [](insitu_status status, const char* text) {
        std::strncpy(creation_error, text, sizeof creation_error - 1);
        return status;
      });
}

void insitu_context_destroy(insitu_context context) {
  if (!is_context(context)) return;
  const insitu::FloatEnvironment guard;
  context->magic = 0;
  delete context;
}

insitu_status insitu_context_set_log(insitu_context context, insitu_log_fn fn, void* user, int32_t level) {
  return always(context, [&](Context& c) { c.set_log(fn, user, level); });
}

const char* insitu_error_text(insitu_context context) {
  return is_context(context) ? context->context.error_text() : creation_error;
}

insitu_status insitu_context_set_report(insitu_context context, const char* path) {
  return call(context, [&](Context& c) { c.set_report(path); });
}

// ----------------------------------------------------------------------------------------------------------- arrays --

insitu_status insitu_array_check(const insitu_array* array, uint32_t use, insitu_array_report* out) {
  insitu_array_report report;
  insitu_array_report_init(&report);
  guarded(
      [&] {
        const insitu::ArrayVerdict verdict = insitu::judge_array(copy_in(array, "insitu_array"), use);
        report.status = verdict.status;
        report.borrowed_bytes = verdict.borrowed_bytes;
        verdict.reason.copy(report.reason, sizeof report.reason - 1);
      },
      [&](insitu_status code, const char* text) {
        report.status = code;
        std::strncpy(report.reason, text, sizeof report.reason - 1);
        return code;
      });
  if (out == nullptr) return report.status;
  const insitu_status copied = guarded([&] { copy_out(report, out, "insitu_array_report"); },
                                       [](insitu_status code, const char*) { return code; });
  return copied == INSITU_OK ? report.status : copied;
}

// --------------------------------------------------------------------------------------------------------- geometry --

insitu_status insitu_particles_create(insitu_context context, const insitu_particles_desc* desc, insitu_geometry* out) {
  if (out != nullptr) out->id = 0;
  return call(context,
              [&](Context& c) { output(out, "out").id = c.create_particles(copy_in(desc, "insitu_particles_desc")); });
}

insitu_status insitu_particles_update(insitu_context context, insitu_geometry particles,
                                      const insitu_particles_desc* desc) {
  return call(context, [&](Context& c) { c.update_particles(particles.id, copy_in(desc, "insitu_particles_desc")); });
}

insitu_status insitu_particles_permutation(insitu_context context, insitu_geometry particles, uint64_t* original,
                                           uint64_t count) {
  return call(context, [&](Context& c) { c.permutation(particles.id, original, count); });
}

insitu_status insitu_particles_restore_order(insitu_context context, insitu_geometry particles) {
  return call(context, [&](Context& c) { c.restore_order(particles.id); });
}

insitu_status insitu_particles_set_filter(insitu_context context, insitu_geometry particles,
                                          const insitu_filter* filter) {
  return call(context, [&](Context& c) {
    if (filter == nullptr) return c.set_filter(particles.id, nullptr);
    const insitu_filter own = copy_in(filter, "insitu_filter");
    c.set_filter(particles.id, &own);
  });
}

insitu_status insitu_geometry_set_style(insitu_context context, insitu_geometry geometry, const insitu_style* style) {
  return call(context, [&](Context& c) { c.set_style(geometry.id, copy_in(style, "insitu_style")); });
}

insitu_status insitu_geometry_bounds(insitu_context context, insitu_geometry geometry, double lower[3],
                                     double upper[3]) {
  return call(context, [&](Context& c) {
    output(lower, "lower");
    output(upper, "upper");
    c.bounds(geometry.id, lower, upper);
  });
}

insitu_status insitu_geometry_destroy(insitu_context context, insitu_geometry geometry) {
  return always(context, [&](Context& c) { c.destroy_geometry(geometry.id); });
}

insitu_status insitu_particles_set_cell(insitu_context context, insitu_geometry particles, const insitu_cell* cell) {
  return call(context, [&](Context& c) {
    if (cell == nullptr) return c.set_cell(particles.id, nullptr);
    const insitu_cell own = copy_in(cell, "insitu_cell");
    c.set_cell(particles.id, &own);
  });
}

insitu_status insitu_bonds_create(insitu_context context, const insitu_bonds_desc* desc, insitu_geometry* out) {
  if (out != nullptr) out->id = 0;
  return call(context, [&](Context& c) { output(out, "out").id = c.create_bonds(copy_in(desc, "insitu_bonds_desc")); });
}

insitu_status insitu_bonds_update(insitu_context context, insitu_geometry bonds, const insitu_bonds_desc* desc) {
  return call(context, [&](Context& c) { c.update_bonds(bonds.id, copy_in(desc, "insitu_bonds_desc")); });
}

insitu_status insitu_vectors_create(insitu_context context, const insitu_vectors_desc* desc, insitu_geometry* out) {
  if (out != nullptr) out->id = 0;
  return call(context,
              [&](Context& c) { output(out, "out").id = c.create_vectors(copy_in(desc, "insitu_vectors_desc")); });
}

insitu_status insitu_vectors_update(insitu_context context, insitu_geometry vectors, const insitu_vectors_desc* desc) {
  return call(context, [&](Context& c) { c.update_vectors(vectors.id, copy_in(desc, "insitu_vectors_desc")); });
}

insitu_status insitu_colormap_create(insitu_context context, const insitu_colormap_desc* desc, insitu_colormap* out) {
  if (out != nullptr) out->id = 0;
  return call(context,
              [&](Context& c) { output(out, "out").id = c.create_colormap(copy_in(desc, "insitu_colormap_desc")); });
}

insitu_status insitu_colormap_destroy(insitu_context context, insitu_colormap colormap) {
  return always(context, [&](Context& c) { c.destroy_colormap(colormap.id); });
}

// ------------------------------------------------------------------------------------------------------------- view --

insitu_status insitu_view_create(insitu_context context, const insitu_view_desc* desc, insitu_view* out) {
  if (out != nullptr) out->id = 0;
  return call(context, [&](Context& c) { output(out, "out").id = c.create_view(desc); });
}

insitu_status insitu_view_set_camera(insitu_context context, insitu_view view, const insitu_camera* camera) {
  return call(context, [&](Context& c) {
    insitu::ViewObject& object = c.view(view.id);
    object.camera = insitu::make_camera(copy_in(camera, "insitu_camera"));
    object.to_be_fitted = false;
  });
}

insitu_status insitu_view_get_camera(insitu_context context, insitu_view view, insitu_camera* camera) {
  return call(context,
              [&](Context& c) { copy_out(insitu::describe_camera(c.view(view.id).camera), camera, "insitu_camera"); });
}

insitu_status insitu_view_set_effects(insitu_context context, insitu_view view, const insitu_effects* effects) {
  return call(context,
              [&](Context& c) { c.view(view.id).effects = insitu::make_effects(copy_in(effects, "insitu_effects")); });
}

insitu_status insitu_view_set_lights(insitu_context context, insitu_view view, const insitu_light* lights,
                                     uint64_t count) {
  return call(context, [&](Context& c) { c.view(view.id).lights = insitu::read_lights(lights, count); });
}

insitu_status insitu_view_set_background(insitu_context context, insitu_view view, const double rgba[4]) {
  return call(context, [&](Context& c) { c.view(view.id).background = insitu::read_background(rgba); });
}

insitu_status insitu_view_fit(insitu_context context, insitu_view view, double aspect) {
  return call(context, [&](Context& c) { c.fit_view(view.id, aspect); });
}

insitu_status insitu_view_turn(insitu_context context, insitu_view view, double angle_deg) {
  return call(context, [&](Context& c) { c.turn_view(view.id, angle_deg); });
}

insitu_status insitu_view_destroy(insitu_context context, insitu_view view) {
  return always(context, [&](Context& c) { c.destroy_view(view.id); });
}

// ------------------------------------------------------------------------------------------------------------ image --

insitu_status insitu_image_create(insitu_context context, const insitu_image_desc* desc, insitu_image* out) {
  if (out != nullptr) out->id = 0;
  return call(context, [&](Context& c) { output(out, "out").id = c.create_image(copy_in(desc, "insitu_image_desc")); });
}

insitu_status insitu_render(insitu_context context, insitu_view view, insitu_image image) {
  return call(context, [&](Context& c) { c.render(view.id, image.id); });
}

insitu_status insitu_image_write(insitu_context context, insitu_image image, const char* pattern) {
  return call(context, [&](Context& c) { c.write_image(image.id, pattern); });
}

insitu_status insitu_image_channel(insitu_context context, insitu_image image, uint32_t channel, insitu_array* out) {
  return call(context, [&](Context& c) { copy_out(c.channel(image.id, channel), out, "insitu_array"); });
}

insitu_status insitu_image_destroy(insitu_context context, insitu_image image) {
  return always(context, [&](Context& c) { c.destroy_image(image.id); });
}

// ------------------------------------------------------------------------------------------------------------- step --

insitu_status insitu_step_begin(insitu_context context, uint64_t step, double time) {
  return call(context, [&](Context& c) { c.begin_step(step, time); });
}

insitu_status insitu_commit(insitu_context context) {
  return call(context, [](Context& c) { c.commit(); });
}

insitu_status insitu_step_end(insitu_context context) {
  insitu_status first = INSITU_OK;
  const insitu_status status = always(context, [&](Context& c) { first = c.end_step(); });
  return first != INSITU_OK ? first : status;
}

insitu_status insitu_stats_get(insitu_context context, insitu_stats* out) {
  return always(context, [&](Context& c) { copy_out(c.stats(), out, "insitu_stats"); });
}
