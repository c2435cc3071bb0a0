// Reads the syntax of CIF; what the items mean is left to gemmi.
#pragma once

#include <gemmi/cifdoc.hpp>

#include "line_reader.h"

namespace replay {

// The first data block of the file, with what atoms and their cell need. Coordinates are checked to be numbers, "?" or
// ".", since only here their lines are known. Throws InputError.
gemmi::cif::Block read_cif_block(LineReader& lines);

}  // namespace replay
