// The command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "md/simulation.h"
#include "picture.h"

namespace melt {

struct Options {
  SimulationDesc simulation;
  PictureDesc picture;
  std::uint64_t steps = 400;
  std::optional<std::uint64_t> thermostat_steps;  // default: the first half
  std::uint64_t every = 50;
  bool images = true;
  std::string energy_file;  // empty = none

  std::uint64_t heated_steps() const { return thermostat_steps.value_or(steps / 2); }
};

enum ExitCode {
  exit_success = 0,
  exit_incomplete = 1,  // the run blew up, or files are missing
  exit_usage = 2,
};

// The exit code when the program should end at once: after --help or a usage error, which are printed here.
std::optional<int> parse_options(int argc, char** argv, Options& options);

}  // namespace melt
