// What a few large particles among many small ones cost.
#pragma once

#include "particle_frames.h"

namespace bench {

// One particle in a hundred with twenty times the radius of the others, against equal radii that cover as much: the sum
// of the squares is the same. `mixed_radii_slowdown`: seconds of a frame over seconds of a frame, the larger of both
// views, with treelets; `mixed_radii_slowdown_pkd` with the tree alone.
void measure_mixed_radii(const FrameOptions& options, const ParticleScene& scene, insitu::Workers& workers,
                         FrameMetrics& metrics, nlohmann::ordered_json& rows);

}  // namespace bench
