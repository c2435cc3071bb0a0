// The time loop.
#pragma once

#include "options.h"

namespace cosmo {

// Runs the simulation, draws, and reports on standard output. Returns an ExitCode. Throws std::invalid_argument when
// the simulation cannot be set up as asked.
int run(const Options& options);

}  // namespace cosmo
