// What a rebuild costs when the particles stand as the last step's tree has left them.
#pragma once

#include "particle_builds.h"

namespace bench {

// Particles of "uniform", displaced at random by one percent of the mean spacing.
std::map<std::string, double> measure_displaced_rebuild(const BuildOptions& options, const ParticleScene& scene,
                                                        insitu::Workers& workers, nlohmann::ordered_json& rows);

// Atoms of the mini-app melt, records of 80 bytes permuted as a whole: from one step to the next, and as many steps
// apart as it draws pictures (`rebuild_speedup_melt_50_steps`, which does not count for `rebuild_speedup`).
std::map<std::string, double> measure_melt_rebuild(const BuildOptions& options, insitu::Workers& workers,
                                                   nlohmann::ordered_json& rows);

}  // namespace bench
