// How the frame rate falls with the number of particles (the paper's figure 8).
#pragma once

#include <nlohmann/json.hpp>

#include "particle_frames.h"

namespace bench {

// Frames of one camera ray per pixel and one occlusion ray per hit, for the tree alone and with treelets, of
// `most_particles` and every count before it in steps of half a power of ten, from 10^5 on. A row per count, scene and
// view for people goes to stdout, for machines to `rows`; the metrics `frames_vs_log_n_<5..8>` are the frames per
// second of treelets at whole powers of ten, the worst of scenes and views. Beside them how long the build took and
// what the process held at most.
void measure_frames_vs_count(const FrameOptions& options, const std::vector<std::string>& scenes,
                             std::uint64_t most_particles, insitu::Workers& workers, FrameMetrics& metrics,
                             nlohmann::ordered_json& rows);

}  // namespace bench
