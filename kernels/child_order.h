// The order in which rays visit the eight children of a node.
#pragma once

#include <array>
#include <cstdint>

namespace insitu::kernels {

constexpr unsigned node_fanout = 8;

namespace child_order_detail {

constexpr std::array<std::array<std::uint8_t, 256>, 8> make_table() {
  std::array<std::array<std::uint8_t, 256>, 8> table{};
  for (unsigned flip = 0; flip < 8; ++flip)
    for (unsigned mask = 0; mask < 256; ++mask)
      for (unsigned order = 8; order-- > 0;)
        if ((mask >> (order ^ flip) & 1) != 0) table[flip][mask] = static_cast<std::uint8_t>(order ^ flip);
  return table;
}

inline constexpr std::array<std::array<std::uint8_t, 256>, 8> nearest = make_table();

}  // namespace child_order_detail

// Child k comes as number k ^ flip for rays of an octant, whose bit c is set where they go down axis c. `axes` holds
// the split axes of the three levels, two bits each, widest first: with the bits of the flip set where the rays go down
// them, near children come first.
inline std::uint32_t child_flip(unsigned axes, std::uint32_t octant, unsigned bits) {
  const std::uint32_t flip =
      (octant >> (axes & 3) & 1) << 2 | (octant >> (axes >> 2 & 3) & 1) << 1 | (octant >> (axes >> 4 & 3) & 1);
  return flip & ((1u << bits) - 1);
}

// Of the children in `mask`, not 0, the one that comes first.
inline unsigned nearest_child(std::uint32_t mask, std::uint32_t flip) {
  return child_order_detail::nearest[flip][mask];
}

}  // namespace insitu::kernels
