// Tracing rays through a P-k-d tree with treelets: as kernels/pkd_traverse.h says, with the same hits to the last bit.
#pragma once

#include <cstddef>
#include <vector>

#include "kernels/pkd_tree.h"
#include "kernels/treelets.h"

namespace insitu::kernels {

void treelet_first_hits(const PkdTree& tree, const Treelets& treelets, const Ray* rays, Hit* hits, std::size_t count);
void treelet_any_hits(const PkdTree& tree, const Treelets& treelets, const Ray* rays, std::uint8_t* occluded,
                      std::size_t count);

}  // namespace insitu::kernels
