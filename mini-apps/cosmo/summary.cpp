#include "summary.h"

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>

namespace cosmo {

OutputFile::OutputFile(const std::string& path) : path_(path) {
  if (path.empty()) return;
  file_.reset(std::fopen(path.c_str(), "w"));
  if (!file_) throw std::invalid_argument("cannot write " + path + ": " + std::generic_category().message(errno));
}

void write_summary(const Options& options, const RunCost& cost, OutputFile& out) {
  if (!out) return;
  std::FILE* const file = out.file();
  const auto integer = [&](const char* name, std::uint64_t value) {
    std::fprintf(file, "  \"%s\": %llu,\n", name, static_cast<unsigned long long>(value));
  };
  const auto real = [&](const char* name, double value) { std::fprintf(file, "  \"%s\": %.6g,\n", name, value); };
  const SimulationDesc& simulation = options.simulation;
  std::fprintf(file, "{\n");
  integer("particles_per_side", simulation.particles);
  integer("mesh_per_side", simulation.mesh == 0 ? 2 * simulation.particles : simulation.mesh);
  integer("steps", cost.steps);
  integer("pictures", cost.pictures);
  integer("image_width", options.picture.width);
  integer("image_height", options.picture.height);
  integer("samples_per_pixel", options.picture.samples_per_pixel);
  integer("ao_samples", options.picture.ao_samples);
  real("total_s", cost.total_s);
  real("setup_s", cost.setup_s);
  real("step_s", cost.step_s());
  real("color_s", cost.color_s);
  real("library_s", cost.library.calls_s);
  real("library_share", cost.share());
  real("render_s", cost.library.render_s);
  real("write_s", cost.library.write_s);
  integer("rays", cost.library.rays);
  integer("host_bytes", cost.host_bytes());
  integer("particle_bytes", cost.particle_bytes);
  integer("mesh_bytes", cost.mesh_bytes);
  integer("library_peak_bytes", cost.library.peak_bytes);
  integer("frame_buffer_bytes", cost.library.frame_buffer_bytes);
  integer("extra_bytes", cost.extra_bytes());
  real("extra_share", cost.extra_share());
  real("extra_share_of_particles", cost.particle_extra_share());
  std::fprintf(file, "  \"build_s\": [");
  const char* separator = "";
  for (const double seconds : cost.library.build_s) {
    std::fprintf(file, "%s%.6g", separator, seconds);
    separator = ", ";
  }
  std::fprintf(file, "]\n}\n");
}

}  // namespace cosmo
