// The reference that the tree traversal is held against: every item is tested, in plain double arithmetic, one by one.
#pragma once

#include <vector>

#include "kernels/nearest_entries.h"
#include "kernels/opacity.h"
#include "kernels/pkd_tree.h"

namespace insitu::kernels {

Hit reference_first_hit(const PkdTree& tree, const Ray& ray);
bool reference_any_hit(const PkdTree& tree, const Ray& ray);
std::vector<Span> reference_all_hits(const PkdTree& tree, const Ray& ray);
// All layers of a ray, nearest first, as items of geometry 0: up to the first opaque one, which ends it.
std::vector<EnteredItem> reference_entries(const PkdTree& tree, const Ray& ray, const ItemOpacity& opacity);
OpticalDepth reference_optical_depth(const PkdTree& tree, const Ray& ray, const ItemOpacity& opacity);

// Checks the order of tree.h over all places: split planes, axes and boxes. Returns the first place that breaks an
// invariant, or no_item.
std::uint64_t find_broken_invariant(const PkdTree& tree);

}  // namespace insitu::kernels
