// Prints what is in a file, for --list.
#pragma once

#include <iosfwd>
#include <string>

#include "options.h"

namespace replay {

// `first_step` counts the steps of the files before; returns that of the file behind. Throws InputError.
std::uint64_t print_listing(std::ostream& out, const std::string& path, const Options& options,
                            std::uint64_t first_step);

}  // namespace replay
