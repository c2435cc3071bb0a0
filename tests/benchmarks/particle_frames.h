// How fast particles are traced, beside Embree's spheres in the same process.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/workers.h"
#include "particle_scenes.h"

namespace bench {

struct FrameOptions {
  bool quick = false;
  int repetitions = 5;
  std::uint32_t image_edge_px = 1024;
  double ao_reach = 0.0;        // length of occlusion rays
  double treelet_share = 0.15;  // memory for treelets, as a part of that of the positions
};

struct FrameMetrics {
  std::map<std::string, double> worst;  // speeds: the smallest counts
  std::map<std::string, double> most;   // bytes, slowdowns: the largest counts

  void note_speed(const std::string& name, double value) {
    const auto [at, is_new] = worst.emplace(name, value);
    if (!is_new) at->second = std::min(at->second, value);
  }
  void note_cost(const std::string& name, double value) {
    const auto [at, is_new] = most.emplace(name, value);
    if (!is_new) at->second = std::max(at->second, value);
  }
};

// Camera rays from afar and from within, and an occlusion ray from every hit, with 1 to teams.size() threads. A row for
// people goes to stdout, one for machines to `rows`.
void measure_frames(const FrameOptions& options, const ParticleScene& scene, std::vector<insitu::Workers>& teams,
                    FrameMetrics& metrics, nlohmann::ordered_json& rows);

}  // namespace bench
