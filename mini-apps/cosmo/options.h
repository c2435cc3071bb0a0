// The command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "picture.h"
#include "pm/simulation.h"

namespace cosmo {

struct Options {
  SimulationDesc simulation;
  PictureDesc picture;
  std::uint64_t every = 10;
  bool images = true;
  std::string summary_file;   // empty = none
  std::string spectrum_file;  // empty = none
};

enum ExitCode {
  exit_success = 0,
  exit_incomplete = 1,  // files are missing
  exit_usage = 2,
};

// The exit code when the program should end at once: after --help or a usage error, which are printed here.
std::optional<int> parse_options(int argc, char** argv, Options& options);

}  // namespace cosmo
