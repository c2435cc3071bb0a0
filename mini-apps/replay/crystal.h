// Crystals in CIF: the unit cell, filled by its symmetry.
#pragma once

#include <gemmi/cifdoc.hpp>

#include "frame.h"

namespace replay {

// With the attributes element, site (1, 2, ... in the order of the file) and occupancy. Throws std::runtime_error.
Frame crystal_frame(gemmi::cif::Block& block);

}  // namespace replay
