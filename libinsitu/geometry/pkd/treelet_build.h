// Treelets over a P-k-d tree that has been built: what they are says kernels/treelets.h.
#pragma once

#include <cstdint>

#include "core/budget.h"
#include "kernels/pkd_tree.h"
#include "kernels/treelets.h"

namespace insitu {

// How many particles a treelet holds at most: measured, docs/results. Through an index every particle is a read of its
// own, so that fewer boxes with more particles would cost more.
constexpr double most_per_treelet = 16.0;

// The shape of the nodes over 2^depth treelets; `nodes` is not set.
kernels::Treelets treelet_shape(std::uint64_t particles, unsigned depth);
std::uint64_t treelet_bytes(std::uint64_t particles, unsigned depth);

// The depth whose treelets hold about `particles_per_treelet`, or fewer levels where more than `most_bytes` would be
// needed. 0: none fit, or there are too few particles.
unsigned treelet_depth(std::uint64_t particles, double particles_per_treelet, std::uint64_t most_bytes);

// Computes all nodes of `shape`, around the particles that tree.selected leaves, with as many threads as the caller's
// TBB arena has. The tree must have been built with leaves at most as long as its treelets, or the boxes are correct
// but large.
void build_treelets(const kernels::PkdTree& tree, const kernels::Treelets& shape, kernels::TreeletNode* nodes);

}  // namespace insitu
