// How large the particles of a snapshot are drawn: they have no surface, so spheres that just touch their neighbours.
#pragma once

#include "frame.h"

namespace replay {

// Half of the mean distance between neighbours where most particles are: in the box that leaves out the outer quarters
// along each axis, so that a few particles far out, or the space between galaxies, do not count. But no less than a
// quarter of the same in the box of all, or clusters would be dust. 0: there is none.
double common_radius(const Frame& frame);

// Adds "radius" when some particles have mass and density: half of (mass / density)^(1/3), the spacing there, and
// common_radius() for the others. Otherwise that is the radius for all. A radius of the file stays.
void choose_snapshot_radii(Frame& frame);

}  // namespace replay
