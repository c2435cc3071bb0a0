#include "frames_vs_count.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "own_frame.h"

namespace bench {
namespace {

using insitu::kernels::Ray;

// VmHWM of Linux: the most memory that the process has held so far.
double peak_gigabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != "VmHWM:") continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return kilobytes * 1024.0 / 1e9;
  }
  return 0.0;
}

struct Rates {
  double build_s;
  double extra_bytes;                          // of the built set, beside its data
  std::map<std::string, double> frames_per_s;  // by view
};

Rates measure_one(const FrameOptions& options, const ParticleScene& scene, double share, insitu::Workers& workers) {
  OwnParticles own(scene, insitu::ParticleOrder::permute, share);
  const auto start = std::chrono::steady_clock::now();
  workers.run([&] { own.build(); });
  Rates rates;
  rates.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  rates.extra_bytes = static_cast<double>(own.set().treelet_bytes());
  for (const char* view : {"far", "close"}) {
    const std::vector<Ray> camera = camera_rays(view, options.image_edge_px);
    OwnFrame frame(own, camera, options.ao_reach);
    const double seconds = take_turns({frame.contender("frame", workers)}, options.repetitions)[0];
    rates.frames_per_s[view] = 1.0 / seconds;
  }
  return rates;
}

}  // namespace

void measure_frames_vs_count(const FrameOptions& options, const std::vector<std::string>& scenes,
                             std::uint64_t most_particles, insitu::Workers& workers, FrameMetrics& metrics,
                             nlohmann::ordered_json& rows) {
  for (int half = 10; half <= 18; ++half) {
    const auto count = static_cast<std::uint64_t>(std::llround(std::pow(10.0, 0.5 * half)));
    if (count > most_particles) break;
    for (const std::string& name : scenes) {
      const ParticleScene scene = make_scene(name, count);
      const Rates tree = measure_one(options, scene, 0.0, workers);
      const Rates treelets = measure_one(options, scene, options.treelet_share, workers);
      for (const auto& [view, frames_per_s] : treelets.frames_per_s) {
        const double tree_frames_per_s = tree.frames_per_s.at(view);
        std::printf("%-9s %9.0f %-5s  frames/s: tree %7.2f  treelets %7.2f | build %.3f s, with treelets %.3f s\n",
                    name.c_str(), static_cast<double>(count), view.c_str(), tree_frames_per_s, frames_per_s,
                    tree.build_s, treelets.build_s);
        rows.push_back({{"scene", name},
                        {"particles", count},
                        {"view", view},
                        {"tree_frames_per_s", tree_frames_per_s},
                        {"treelet_frames_per_s", frames_per_s},
                        {"tree_build_s", tree.build_s},
                        {"treelet_build_s", treelets.build_s},
                        {"treelet_bytes", treelets.extra_bytes},
                        {"peak_gigabytes", peak_gigabytes()}});
        if (half % 2 == 0) {
          const std::string power = std::to_string(half / 2);
          metrics.note_speed("frames_vs_log_n_" + power, frames_per_s);
          metrics.note_speed("frames_vs_log_n_pkd_" + power, tree_frames_per_s);
        }
      }
      std::fflush(stdout);
    }
  }
  metrics.note_cost("frames_vs_log_n_peak_gigabytes", peak_gigabytes());
}

}  // namespace bench
