// Copies of the centres that a filter leaves, where it leaves few: a vector of them is one read, and not a line of
// memory for each.
#pragma once

#include <bit>
#include <cstdint>

#include "kernels/selected_places.h"

namespace insitu::kernels {

// Views the arrays; they belong to whoever selected. In the order of the places.
struct SelectedCopies {
  const float* centres = nullptr;           // x y z x y z ..., rounded; a vector more can be read
  const std::uint32_t* place_of = nullptr;  // where each stands in the tree
  const std::uint32_t* before = nullptr;    // copies before those of each word of places; and how many there are

  bool exist() const { return centres != nullptr; }
  // Copies before that of the first drawn place from `place` on.
  std::uint64_t rank(const SelectedPlaces& places, std::uint64_t place) const {
    const std::uint64_t below = places.level[0][place / 64] & ((std::uint64_t{1} << place % 64) - 1);
    return before[place / 64] + static_cast<std::uint64_t>(std::popcount(below));
  }
};

}  // namespace insitu::kernels
