// What it costs to see through particles: frames of the same particles in several opacities, beside the opaque one.
// Layers are counted per camera ray that meets any particle.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "measure.h"
#include "own_particles.h"
#include "renderer/renderer.h"

namespace {

struct Options {
  bool quick = false;
  std::string json;
  std::vector<std::string> scenes = {"uniform", "clustered"};
  std::vector<double> opacities = {1.0, 0.3, 0.05};
  std::uint64_t particles = 1000000;
  std::uint32_t edge_px = 256;
  unsigned threads = 1;
  int repetitions = 5;
};

// The particles of a set in one colour and opacity.
struct Look {
  Look(const insitu::Particles& particles, double opacity) {
    insitu::Style style;
    style.opacity = static_cast<float>(opacity);
    scene.add(particles, insitu::Colors(style, particles, *insitu::builtin_colormap("viridis")));
    scene.commit();
  }
  insitu::Scene scene;
  insitu::FrameBuffer frame;
  insitu::RenderCosts costs;
};

insitu::RenderSettings settings_of(const insitu::Scene& scene, bool with_effects) {
  insitu::RenderSettings settings;
  settings.camera = insitu::default_camera();
  insitu::fit_camera(settings.camera, scene.bounds(), 1.0);
  settings.lights = insitu::default_lights();
  settings.samples_per_pixel = 1;
  settings.effects.shadows = settings.effects.ambient_occlusion = with_effects;
  settings.effects.ao_samples = 4;
  return settings;
}

void measure(const Options& options, const std::string& name, bool with_effects, const bench::OwnParticles& own,
             insitu::Workers& workers, bench::Report& report) {
  std::vector<std::unique_ptr<Look>> looks;
  std::vector<bench::Contender> contenders;
  for (const double opacity : options.opacities) {
    looks.push_back(std::make_unique<Look>(own.set(), opacity));
    Look& look = *looks.back();
    look.frame.allocate(options.edge_px, options.edge_px, INSITU_CHANNEL_COLOR | INSITU_CHANNEL_DEPTH);
    const insitu::RenderSettings settings = settings_of(look.scene, with_effects);
    contenders.push_back({std::to_string(opacity), {}, [&look, &workers, settings] {
                            look.costs = workers.run([&] { return render_frame(look.scene, settings, look.frame); });
                          }});
  }
  const std::vector<double> seconds = bench::take_turns(contenders, options.repetitions);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const insitu::RenderCosts& costs = looks[i]->costs;
    std::uint64_t hits = 0;
    for (const float depth : looks[i]->frame.depth) hits += std::isfinite(depth) ? 1 : 0;
    const auto per_hit = [hits](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(hits); };
    const double layers = looks[i]->scene.is_transparent() ? per_hit(costs.layers) : 1.0;
    const double rays = per_hit(costs.shadows.rays + costs.ambient_occlusion.rays);
    std::printf("| %s | %s | %g | %.1f | %.1f | %.1f | %.2f |\n", name.c_str(),
                with_effects ? "shadows, 4 occlusion rays" : "none", options.opacities[i], layers, rays,
                1e3 * seconds[i], seconds[i] / seconds[0]);
    std::fflush(stdout);
    report.context()["rows"].push_back({{"scene", name},
                                        {"effects", with_effects},
                                        {"opacity", options.opacities[i]},
                                        {"layers_per_hit", layers},
                                        {"rays_per_hit", rays},
                                        {"seconds", seconds[i]}});
    if (i == 0) continue;
    char opacity[32];
    std::snprintf(opacity, sizeof opacity, "%g", options.opacities[i]);
    report.results()[name + (with_effects ? "_ao" : "") + "_opacity_" + opacity + "_slowdown"] =
        seconds[i] / seconds[0];
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Frames of particles that can be seen through, beside opaque ones");
  Options options;
  app.add_flag("--quick", options.quick, "3 repetitions: within 30 s");
  app.add_option("--json", options.json, "write {context, results} to this file");
  app.add_option("--particles", options.particles)->capture_default_str();
  app.add_option("--edge", options.edge_px, "pixels")->capture_default_str();
  app.add_option("--scenes", options.scenes, "uniform, clustered")->capture_default_str();
  app.add_option("--opacities", options.opacities, "the others are held against the first")->capture_default_str();
  app.add_option("--threads", options.threads)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (options.quick) options.repetitions = 3;

  bench::Report report(argc, argv);
  report.context()["particles"] = options.particles;
  report.context()["edge_px"] = options.edge_px;
  report.context()["threads"] = options.threads;
  insitu::Workers workers(options.threads);
  std::printf("| particles | effects | opacity | layers | rays | ms | over opaque |\n|---|---|---|---|---|---|---|\n");
  for (const std::string& name : options.scenes) {
    bench::OwnParticles own(bench::make_scene(name, options.particles), insitu::ParticleOrder::permute, 0.15);
    workers.run([&] { own.build(); });
    for (const bool with_effects : {false, true}) measure(options, name, with_effects, own, workers, report);
  }
  if (!report.write(options.json)) {
    std::fprintf(stderr, "%s could not be written\n", options.json.c_str());
    return 1;
  }
}
