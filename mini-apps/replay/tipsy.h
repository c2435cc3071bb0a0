// The header of TIPSY snapshots.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

namespace replay {

constexpr std::size_t tipsy_header_bytes = 32;  // of which the last 4 are padding

struct TipsyHeader {
  std::endian order = std::endian::big;
  double time = 0.0;                        // or the scale factor
  std::array<std::uint64_t, 3> count = {};  // gas, dark matter, stars
  bool padding_is_zero = false;             // the last 4 bytes, which some writers leave out
};

// Nothing when the bytes are no such header in either byte order.
std::optional<TipsyHeader> tipsy_header(std::string_view first_bytes);

}  // namespace replay
