// Copies of the centres that a filter leaves, where it leaves few: a vector of them is one read, and not a line of
// memory for each.
#pragma once

#include <cstdint>

namespace insitu::kernels {

// Views the arrays; they belong to whoever selected. Treelet by treelet, in the order of the places.
struct SelectedCopies {
  const float* centres = nullptr;           // x y z x y z ..., rounded; a vector more can be read
  const std::uint32_t* place_of = nullptr;  // where each stands in the tree
  const std::uint32_t* before = nullptr;    // copies before those of each treelet; and how many there are

  bool exist() const { return centres != nullptr; }
};

}  // namespace insitu::kernels
