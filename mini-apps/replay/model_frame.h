// From gemmi's model of a molecule to a frame.
#pragma once

#include <gemmi/model.hpp>
#include <gemmi/unitcell.hpp>

#include "frame.h"

namespace replay {

// Replaces positions and attributes by those of the model's atoms: element, id, bfactor, occupancy, chain (1, 2, ... in
// the order of the file), residue (its number) and hetatm. Of alternative locations the first one counts.
void frame_from_model(const gemmi::Model& model, bool hetatm, Frame& frame);

// No box when the file has no real unit cell.
Box box_from_cell(const gemmi::UnitCell& cell);

}  // namespace replay
