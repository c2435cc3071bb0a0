#include "mixed_radii.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "measure.h"
#include "own_frame.h"

namespace bench {
namespace {

using insitu::kernels::Ray;

constexpr std::size_t large_every = 100;
constexpr double large_factor = 20.0;

ParticleScene with_radii(const ParticleScene& scene, bool mixed) {
  ParticleScene result = scene;
  const double share = 1.0 / large_every;
  const double equal = scene.radius * std::sqrt(1.0 - share + share * large_factor * large_factor);
  result.radii.assign(scene.count(), static_cast<float>(mixed ? scene.radius : equal));
  if (mixed)
    for (std::size_t i = 0; i < result.radii.size(); i += large_every)
      result.radii[i] = static_cast<float>(scene.radius * large_factor);
  return result;
}

struct Frame {
  std::string name;
  std::unique_ptr<OwnParticles> own;
};

}  // namespace

void measure_mixed_radii(const FrameOptions& options, const ParticleScene& scene, insitu::Workers& workers,
                         FrameMetrics& metrics, nlohmann::ordered_json& rows) {
  std::vector<Frame> frames;
  for (const bool with_treelets : {true, false}) {
    for (const bool mixed : {true, false}) {
      frames.push_back({std::string(with_treelets ? "treelet" : "pkd") + (mixed ? " mixed" : " equal"),
                        std::make_unique<OwnParticles>(with_radii(scene, mixed), insitu::ParticleOrder::permute,
                                                       with_treelets ? options.treelet_share : 0.0)});
      workers.run([&] { frames.back().own->build(); });
    }
  }
  for (const char* view : {"far", "close"}) {
    const std::vector<Ray> camera = camera_rays(view, std::min(options.image_edge_px, 512u));
    std::vector<std::unique_ptr<OwnFrame>> views;
    std::vector<Contender> contenders;
    for (const Frame& frame : frames) {
      views.push_back(std::make_unique<OwnFrame>(*frame.own, camera, options.ao_reach));
      contenders.push_back(views.back()->contender(frame.name, workers));
    }
    const std::vector<double> s = take_turns(contenders, options.repetitions);
    std::printf("%-9s %4.1fM %-5s mixed over equal radii: treelets %.2f, tree alone %.2f\n", scene.name.c_str(),
                static_cast<double>(scene.count()) / 1e6, view, s[0] / s[1], s[2] / s[3]);
    metrics.note_cost("mixed_radii_slowdown", s[0] / s[1]);
    metrics.note_cost("mixed_radii_slowdown_pkd", s[2] / s[3]);
    nlohmann::ordered_json row = {{"scene", scene.name}, {"particles", scene.count()}, {"view", view}};
    for (std::size_t i = 0; i < contenders.size(); ++i) row["seconds"][contenders[i].name] = s[i];
    rows.push_back(row);
  }
}

}  // namespace bench
