// What it costs that a filter leaves a tenth of the particles, and that it is changed.
#pragma once

#include "particle_frames.h"

namespace bench {

// Frames of a tree under a filter that leaves a tenth of its particles, by a smooth field and by chance, beside those
// of a tree over these particles alone: seconds of the latter over seconds of the former, with treelets, the worst of
// both fields and both views (`filter_10pct_speed`; of chance alone `filter_10pct_random_speed`), and with the tree
// alone
// (`filter_10pct_bare_speed`, `filter_10pct_bare_random_speed`). `filter_change_speed_vs_build`: seconds of a build
// with treelets over seconds of a change of the filter. `filter_pass_ns_per_particle`: wall time of such a change
// without treelets, which is one pass over all particles.
void measure_filters(const FrameOptions& options, const ParticleScene& scene, insitu::Workers& workers,
                     FrameMetrics& metrics, nlohmann::ordered_json& rows);

}  // namespace bench
