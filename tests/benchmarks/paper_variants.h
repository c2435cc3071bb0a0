// What the layout and the choice of split axes are worth: the paper's structure beside ours, in the same process.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/workers.h"
#include "particle_frames.h"
#include "particle_scenes.h"

namespace bench {

// Speeds of variants, as our seconds over theirs for the same frame: below 1, the variant is slower. One for every
// scene, number of particles and view.
//   heap_order_speed         the paper's structure and traversal at its best: round robin or longest side, single rays
//                            or packets of 16, chosen for camera and for occlusion rays apart; ours are the packets and
//                            streams over leaves of 32, without treelets
//   heap_order_camera_speed  the same for the camera rays of the frame alone
//   round_robin_speed        ours but for round robin axes
//   heap_over_in_order_speed the paper's traversal, packets for camera and single for occlusion rays, longest side: in
//                            its heap over in our order
class VariantSpeeds {
 public:
  void note(const std::string& name, double speed) { speeds_[name].push_back(speed); }
  // By name the variant's best, which is the worst for us; with _typical, the median.
  std::map<std::string, double> metrics() const;

 private:
  std::map<std::string, std::vector<double>> speeds_;
};

// A row for people goes to stdout, one for machines to `rows`. At most 512 x 512 camera rays; with options.quick
// 128 x 128, and no heap_over_in_order_speed.
void measure_paper_variants(const FrameOptions& options, const ParticleScene& scene, insitu::Workers& workers,
                            VariantSpeeds& speeds, nlohmann::ordered_json& rows);

}  // namespace bench
