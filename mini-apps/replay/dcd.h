// How DCD trajectories are laid out, by their first record.
#pragma once

#include <bit>
#include <optional>
#include <string_view>

namespace replay {

struct DcdLayout {
  std::endian order = std::endian::little;
  bool wide_markers = false;  // record sizes of 8 bytes, as some Fortran compilers write them
  bool velocities = false;    // "VELD"
};

// Nothing when the bytes, 12 are enough, begin no such file.
std::optional<DcdLayout> dcd_layout(std::string_view first_bytes);

}  // namespace replay
