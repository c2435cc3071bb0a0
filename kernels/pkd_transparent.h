// Rays through particles that can be seen through: one ray at a time, through the tree alone, which serves all layouts
// and orders, with treelets or without. The hits are those of brute force (pkd_reference.h) to the last bit.
#pragma once

#include "kernels/nearest_entries.h"
#include "kernels/opacity.h"
#include "kernels/pkd_tree.h"

namespace insitu::kernels {

// Offers `entries` the items of opacity above 0 that the ray enters with t_min < t <= t_max, as items of `geometry`.
// Distances there are `scale` times those of the tree's space, in which the ray is given.
void pkd_nearest_entries(const PkdTree& tree, const Ray& ray, double scale, std::uint32_t geometry,
                         const ItemOpacity& opacity, NearestEntries& entries);

// `depth` plus that of the items that the ray enters with t_min < t <= t_max; from opaque_depth on it may be less than
// the whole sum.
OpticalDepth pkd_optical_depth(const PkdTree& tree, const Ray& ray, const ItemOpacity& opacity, OpticalDepth depth);

}  // namespace insitu::kernels
