// How fast trees are built and rebuilt, beside Embree's builders and std::nth_element in the same process.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/workers.h"
#include "particle_scenes.h"

namespace bench {

struct BuildOptions {
  bool quick = false;
  int repetitions = 5;
};

// Metrics by name, each the better the larger. `teams`: Workers of 1, 2, ... threads; the last ones build. A row for
// people goes to stdout, one for machines to `rows`.
std::map<std::string, double> measure_builds(const BuildOptions& options, const ParticleScene& scene,
                                             std::vector<insitu::Workers>& teams, nlohmann::ordered_json& rows);

}  // namespace bench
