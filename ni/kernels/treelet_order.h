// The order in which a ray visits the children of a treelet node.
#pragma once

#include <array>
#include <cstdint>

#include "kernels/treelets.h"

namespace insitu::kernels {

namespace treelet_order_detail {

using Table = std::array<std::array<std::uint8_t, 256>, 8>;

constexpr Table make_table(bool nearest) {
  Table table{};
  for (unsigned flip = 0; flip < 8; ++flip)
    for (unsigned mask = 0; mask < 256; ++mask)
      for (unsigned i = 0; i < 8; ++i) {
        const unsigned child = (nearest ? 7 - i : i) ^ flip;
        if ((mask >> child & 1) != 0) table[flip][mask] = static_cast<std::uint8_t>(child);
      }
  return table;
}

inline constexpr Table nearest = make_table(true);
inline constexpr Table farthest = make_table(false);

}  // namespace treelet_order_detail

// Child k comes as number k ^ flip for rays of an octant: bit c of `octant` is set where they go down axis c. With the
// bits of the flip set where they go down the split axis of a level, near children come first.
inline std::uint32_t treelet_flip(const TreeletNode& node, std::uint32_t octant, unsigned bits) {
  const std::uint32_t flip = (octant >> (node.axes & 3) & 1) << 2 | (octant >> (node.axes >> 2 & 3) & 1) << 1 |
                             (octant >> (node.axes >> 4 & 3) & 1);
  return flip & ((1u << bits) - 1);
}

// Of the children in `mask`, not 0, the one that comes first, or last.
inline unsigned nearest_child(std::uint32_t mask, std::uint32_t flip) {
  return treelet_order_detail::nearest[flip][mask];
}
inline unsigned farthest_child(std::uint32_t mask, std::uint32_t flip) {
  return treelet_order_detail::farthest[flip][mask];
}

}  // namespace insitu::kernels
