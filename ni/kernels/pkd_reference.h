// The reference that the tree traversal is held against: every item is tested, in plain double arithmetic, one by one.
#pragma once

#include <vector>

#include "kernels/pkd_tree.h"

namespace insitu::kernels {

Hit reference_first_hit(const PkdTree& tree, const Ray& ray);
bool reference_any_hit(const PkdTree& tree, const Ray& ray);
std::vector<Span> reference_all_hits(const PkdTree& tree, const Ray& ray);

// Checks the order of tree.h over all places: split planes, axes and boxes. Returns the first place that breaks an
// invariant, or no_item.
std::uint64_t find_broken_invariant(const PkdTree& tree);

}  // namespace insitu::kernels
