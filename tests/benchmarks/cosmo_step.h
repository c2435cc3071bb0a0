// What pictures cost a simulation: mini-apps/cosmo as a whole, drawing while it runs.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace bench {

// 128^3 particles, 100 steps, a picture of 1024 x 1024 pixels with ambient occlusion at the start and every ten steps,
// as the program has it by default, with permuted arrays. Pictures go to a folder that is removed.
//   cosmo_step_share         wall time in calls of the library over that of the run
//   cosmo_peak_extra_share   the library's memory at its highest, frame buffers aside, over the simulation's
std::map<std::string, double> measure_cosmo_steps(nlohmann::ordered_json& row);

}  // namespace bench
