#include "filtered_particles.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <random>

#include "measure.h"
#include "own_frame.h"

namespace bench {
namespace {

using insitu::kernels::Ray;

constexpr double left_share = 0.1;

// The smooth field: waves along all axes, so that what is left lies in some ten pieces.
float wave_at(const float* x) {
  return std::sin(9.0f * x[0] + 1.0f) + std::sin(11.0f * x[1]) + std::sin(8.0f * x[2] + 2.0f);
}

ParticleScene with_values(const ParticleScene& scene, bool smooth) {
  ParticleScene result = scene;
  std::mt19937 random(5);
  result.values.resize(scene.count());
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] = smooth ? wave_at(&scene.position[3 * i]) : static_cast<float>(random()) * 0x1p-32f;
  return result;
}

// The largest tenth of the values begins here.
double tenth_of(const ParticleScene& scene) {
  std::vector<float> values = scene.values;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>((1.0 - left_share) * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

std::shared_ptr<const insitu::Filter> above(double value) {
  std::vector<insitu::FilterTerm> terms(1);
  terms[0].attribute = "value";
  terms[0].range[0] = value;
  terms[0].range[1] = std::numeric_limits<double>::infinity();
  return std::make_shared<const insitu::Filter>(std::move(terms));
}

ParticleScene left_of(const ParticleScene& scene, double value) {
  ParticleScene left = scene;
  left.position.clear();
  left.values.clear();
  for (std::size_t i = 0; i < scene.values.size(); ++i) {
    if (static_cast<double>(scene.values[i]) < value) continue;
    left.position.insert(left.position.end(), &scene.position[3 * i], &scene.position[3 * i] + 3);
    left.values.push_back(scene.values[i]);
  }
  return left;
}

struct Frame {
  std::string name;
  std::unique_ptr<OwnParticles> own;
};

void measure_views(const FrameOptions& options, const ParticleScene& scene, bool smooth, insitu::Workers& workers,
                   FrameMetrics& metrics, nlohmann::ordered_json& rows) {
  const ParticleScene whole = with_values(scene, smooth);
  const double value = tenth_of(whole);
  const ParticleScene left = left_of(whole, value);
  std::vector<Frame> frames;
  for (const bool with_treelets : {true, false}) {
    for (const bool filtered : {true, false}) {
      const std::string name = std::string(with_treelets ? "treelet" : "pkd") + (filtered ? " filtered" : " alone");
      frames.push_back({name, std::make_unique<OwnParticles>(filtered ? whole : left, insitu::ParticleOrder::permute,
                                                             with_treelets ? options.treelet_share : 0.0)});
      OwnParticles& own = *frames.back().own;
      if (filtered) own.filter(above(value));
      workers.run([&] { own.build(); });
    }
  }
  for (const char* view : {"far", "close"}) {
    const std::vector<Ray> camera = camera_rays(view, std::min(options.image_edge_px, options.quick ? 384u : 512u));
    std::vector<std::unique_ptr<OwnFrame>> views;
    std::vector<Contender> contenders;
    for (const Frame& frame : frames) {
      views.push_back(std::make_unique<OwnFrame>(*frame.own, camera, options.ao_reach));
      contenders.push_back(views.back()->contender(frame.name, workers));
    }
    // Frames of a tenth of the particles are short: more of them.
    const std::vector<double> s = take_turns(contenders, options.repetitions + 2);
    const double speed = s[1] / s[0];
    const double bare_speed = s[3] / s[2];
    std::printf("%-9s %4.1fM %-5s a tenth left by %-6s: treelets %.2f, tree alone %.2f of the speed without the rest\n",
                scene.name.c_str(), static_cast<double>(scene.count()) / 1e6, view, smooth ? "field" : "chance", speed,
                bare_speed);
    metrics.note_speed("filter_10pct_speed", speed);
    metrics.note_speed("filter_10pct_bare_speed", bare_speed);
    if (!smooth) {
      metrics.note_speed("filter_10pct_random_speed", speed);
      metrics.note_speed("filter_10pct_bare_random_speed", bare_speed);
    }
    nlohmann::ordered_json row = {{"scene", scene.name},
                                  {"particles", scene.count()},
                                  {"view", view},
                                  {"left_by", smooth ? "field" : "chance"},
                                  {"camera_rays", camera.size()},
                                  {"ao_rays", views[0]->ao_rays()}};
    for (std::size_t i = 0; i < contenders.size(); ++i) row["seconds"][contenders[i].name] = s[i];
    rows.push_back(row);
  }
}

// Between two filters and back, in the same tree.
void measure_change(const FrameOptions& options, const ParticleScene& scene, insitu::Workers& workers,
                    FrameMetrics& metrics, nlohmann::ordered_json& rows) {
  const ParticleScene whole = with_values(scene, true);
  const double value = tenth_of(whole);
  const std::shared_ptr<const insitu::Filter> filters[2] = {above(value), above(value + 0.01)};
  const auto make = [&](double treelet_share) {
    return std::make_unique<OwnParticles>(whole, insitu::ParticleOrder::permute, treelet_share);
  };
  const std::unique_ptr<OwnParticles> with_treelets = make(options.treelet_share);
  const std::unique_ptr<OwnParticles> bare = make(0.0);
  std::unique_ptr<OwnParticles> fresh;
  for (OwnParticles* own : {with_treelets.get(), bare.get()}) workers.run([&] { own->build(); });
  int turn = 0;
  const std::vector<double> s = take_turns(
      {{"build", [&] { fresh = make(options.treelet_share); }, [&] { workers.run([&] { fresh->build(); }); }},
       {"change", {}, [&] { workers.run([&] { with_treelets->filter(filters[++turn % 2]); }); }},
       {"change without treelets", {}, [&] { workers.run([&] { bare->filter(filters[turn % 2]); }); }}},
      options.repetitions);
  const double pass_ns = s[2] * 1e9 / static_cast<double>(scene.count());
  std::printf("%-9s %4.1fM filter changed in %.1f ms, a %.1fth of a build; its pass: %.2f ns per particle\n",
              scene.name.c_str(), static_cast<double>(scene.count()) / 1e6, s[1] * 1e3, s[0] / s[1], pass_ns);
  metrics.note_speed("filter_change_speed_vs_build", s[0] / s[1]);
  metrics.note_cost("filter_pass_ns_per_particle", pass_ns);
  rows.push_back({{"scene", scene.name},
                  {"particles", scene.count()},
                  {"seconds", {{"build", s[0]}, {"change", s[1]}, {"change without treelets", s[2]}}}});
}

}  // namespace

void measure_filters(const FrameOptions& options, const ParticleScene& scene, insitu::Workers& workers,
                     FrameMetrics& metrics, nlohmann::ordered_json& rows) {
  for (const bool smooth : {true, false}) measure_views(options, scene, smooth, workers, metrics, rows);
  measure_change(options, scene, workers, metrics, rows);
}

}  // namespace bench
