// The P-k-d tree beside Embree: the same particles, rays and threads in one process, all taking turns.
//
// Two baselines. `_vs_embree_sphere` is SPHERE_POINT at its best: every build quality, single rays, packets of 8 and 16
// and streams, the best way for camera rays and the best for occlusion rays. `_vs_embree_best` adds user geometry with
// one sphere per primitive. A frame is one camera ray per pixel and one ambient occlusion ray per hit. Speeds are
// baseline seconds over ours; the metrics are the worst over scenes, sizes, views and numbers of threads.
// paper_variants.h adds what the paper's own layout and split axes would give, there with our seconds over theirs.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "cosmo_step.h"
#include "filtered_particles.h"
#include "frames_vs_count.h"
#include "measure.h"
#include "mixed_radii.h"
#include "paper_variants.h"
#include "particle_builds.h"
#include "particle_frames.h"
#include "particle_rebuilds.h"

int main(int argc, char** argv) {
  CLI::App app("The P-k-d tree beside Embree, on the same particles and rays");
  bench::FrameOptions frames;
  bool builds_only = false;
  bool frames_only = false;
  bool variants_only = false;
  bool filters_only = false;
  bool counts_only = false;
  bool cosmo_only = false;
  bool large = false;
  std::string json;
  std::vector<std::uint64_t> counts;
  std::vector<std::string> scenes = {"uniform", "clustered"};
  app.add_flag("--quick", frames.quick,
               "1M particles, 448 x 448 pixels, one build quality, 3 repetitions: within 45 s");
  app.add_flag("--large", large, "100 million particles as well: frames, one of Embree's structures after another");
  app.add_flag("--builds-only", builds_only, "builds without frames");
  app.add_flag("--frames-only", frames_only, "frames without builds");
  app.add_flag("--variants-only", variants_only, "only the paper's structure beside ours");
  app.add_flag("--filters-only", filters_only, "only filters");
  app.add_flag("--counts-only", counts_only, "only frame rates over the number of particles, 10^5 to 10^7 or 10^8");
  app.add_flag("--cosmo-only", cosmo_only, "only the share of mini-apps/cosmo that its pictures take");
  app.add_option("--json", json, "write {context, results} to this file");
  app.add_option("--particles", counts, "numbers of particles (default 1000000 and 10000000)");
  app.add_option("--scenes", scenes, "uniform, clustered")->capture_default_str();
  app.add_option("--repetitions", frames.repetitions, "of which the median counts")->capture_default_str();
  frames.ao_reach = std::numeric_limits<double>::infinity();
  app.add_option("--ao-reach", frames.ao_reach, "length of occlusion rays; the cloud has size 1 (default: infinite)");
  app.add_option("--treelet-share", frames.treelet_share, "memory for treelets, as a part of that of the positions")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (frames.quick) {
    frames.repetitions = std::min(frames.repetitions, 3);
    frames.image_edge_px = 448;
  }
  if (counts.empty())
    counts = frames.quick ? std::vector<std::uint64_t>{1000000} : std::vector<std::uint64_t>{1000000, 10000000};
  constexpr std::uint64_t large_count = 100000000;
  if (large) counts.push_back(large_count);

  bench::Report report(argc, argv);
  report.context()["image_edge_px"] = frames.image_edge_px;
  std::vector<insitu::Workers> teams;
  teams.emplace_back(1);
  teams.emplace_back(2);
  bench::FrameMetrics metrics;
  bench::VariantSpeeds variants;
  const bench::BuildOptions builds{frames.quick, frames.repetitions};
  const auto note = [&metrics](const std::map<std::string, double>& speeds) {
    for (const auto& [metric, value] : speeds) metrics.note_speed(metric, value);
  };
  const bool other_only = counts_only || cosmo_only;
  const bool with_builds = !frames_only && !variants_only && !filters_only && !other_only;
  if (other_only) counts.clear();
  for (const std::uint64_t count : counts) {
    for (const std::string& name : scenes) {
      const bench::ParticleScene scene = bench::make_scene(name, count);
      if (count >= large_count) {
        // Memory is for one comparison at a time.
        if (!builds_only && !filters_only && !variants_only)
          measure_frames(frames, scene, teams, metrics, report.context()["frames"]);
        continue;
      }
      if (with_builds) {
        note(measure_builds(builds, scene, teams, report.context()["builds"]));
        if (name == "uniform")
          note(measure_displaced_rebuild(builds, scene, teams.back(), report.context()["rebuilds"]));
      }
      if (builds_only) continue;
      if (!variants_only) measure_filters(frames, scene, teams.back(), metrics, report.context()["filtered_particles"]);
      if (filters_only) continue;
      if (!variants_only) {
        measure_frames(frames, scene, teams, metrics, report.context()["frames"]);
        measure_mixed_radii(frames, scene, teams.back(), metrics, report.context()["mixed_radii"]);
      }
      measure_paper_variants(frames, scene, teams.back(), variants, report.context()["paper_variants"]);
    }
  }
  // Neither fits into 45 seconds.
  const bool whole = !frames.quick && !builds_only && !frames_only && !variants_only && !filters_only;
  if ((whole && !cosmo_only) || counts_only)
    measure_frames_vs_count(frames, scenes, large ? large_count : 10000000, teams.back(), metrics,
                            report.context()["frames_vs_log_n"]);
  if ((whole && !counts_only) || cosmo_only)
    for (const auto& [metric, value] : bench::measure_cosmo_steps(report.context()["cosmo"]))
      metrics.note_cost(metric, value);
  if (with_builds) note(measure_melt_rebuild(builds, teams.back(), report.context()["rebuilds"]));

  std::printf("\n");
  for (const auto& values : {metrics.most, metrics.worst, variants.metrics()})
    for (const auto& [name, value] : values) {
      std::printf("%-45s %.3f\n", name.c_str(), value);
      report.results()[name] = value;
    }
  if (!report.write(json)) {
    std::fprintf(stderr, "%s could not be written\n", json.c_str());
    return 1;
  }
}
