// The header of Gadget's binary snapshots, and how the records behind it are laid out (Springel 2005, "User guide for
// GADGET-2", section 6).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

#include "byte_reader.h"

namespace replay {

constexpr std::size_t gadget_types = 6;  // gas, halo, disk, bulge, stars, boundary

struct GadgetHeader {
  std::array<std::uint32_t, gadget_types> count = {};        // in this file
  std::array<double, gadget_types> mass = {};                // 0: each particle has its own
  std::array<std::uint32_t, gadget_types> total_count = {};  // of all files, modulo 2^32
  double time = 0.0;                                         // or the scale factor
  std::uint32_t files = 1;
  bool cooling = false;
  bool star_formation = false;
  double box_size = 0.0;

  std::uint64_t all() const;
};

struct GadgetLayout {
  std::endian order = std::endian::little;
  bool tagged = false;  // format 2: a record with a name before each block
};

// By the first record's marker: 256 bytes of header, or 8 bytes of a tag, in one of the byte orders.
std::optional<GadgetLayout> gadget_layout(std::string_view first_bytes);

// Which particles have the values of a block, bit t for type t.
using TypeSet = std::uint32_t;
constexpr TypeSet all_types = 0x3F;
constexpr TypeSet gas_type = 1u << 0;
constexpr TypeSet star_type = 1u << 4;

std::uint64_t count_in(const GadgetHeader& header, TypeSet types);

// Size of a block's values, 4 or 8 bytes each, by the marker of its record, which holds the size modulo 2^32; nothing
// when it is neither. The same marker may stand for both: then the file does not have more than 2^32 bytes, or 4 it is.
std::optional<std::uint32_t> scalar_bytes(std::uint64_t values, std::uint32_t marker);

}  // namespace replay
