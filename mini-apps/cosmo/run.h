// The time loop.
#pragma once

#include "options.h"

namespace cosmo {

struct RunCost;

// Runs the simulation, draws, and reports on standard output; `cost` may be null. Returns an ExitCode. Throws
// std::invalid_argument when the simulation cannot be set up as asked.
int run(const Options& options, RunCost* cost = nullptr);

}  // namespace cosmo
