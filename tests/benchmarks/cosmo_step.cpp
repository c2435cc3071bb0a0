#include "cosmo_step.h"

#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "run.h"
#include "summary.h"
#include "temporary_folder.h"

namespace bench {

std::map<std::string, double> measure_cosmo_steps(nlohmann::ordered_json& row) {
  const insitu::testing::TemporaryFolder folder;
  cosmo::Options options;
  options.picture.folder = folder.path().string();
  cosmo::RunCost cost;
  if (cosmo::run(options, &cost) != cosmo::exit_success) throw std::runtime_error("cosmo has not drawn all pictures");
  row = {{"particles_per_side", options.simulation.particles},
         {"steps", cost.steps},
         {"pictures", cost.pictures},
         {"seconds", cost.total_s},
         {"seconds_in_library", cost.library.calls_s},
         {"host_bytes", cost.host_bytes()},
         {"extra_bytes", cost.extra_bytes()}};
  return {{"cosmo_step_share", cost.share()}, {"cosmo_peak_extra_share", cost.extra_share()}};
}

}  // namespace bench
