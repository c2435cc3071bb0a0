// Bonds, arrows and the box of a step, beside the particles.
#pragma once

#include "insitu/insitu.h"

#include "frame.h"
#include "options.h"

namespace replay {

// What --radius-scale comes to together with --ball-and-stick.
double ball_scale(const Options& options);

// What the options ask for in this step. Throws UsageError when the frame does not have it.
// With `known` the set has a cell that is not the default.
struct CellChoice {
  bool known = false;
  insitu_cell cell;
};
CellChoice choose_cell(const Frame& frame, const Options& options);

struct BondChoice {
  bool wanted = false;
  insitu_bonds_desc bonds;  // without name and particles
};
BondChoice choose_bonds(const Frame& frame, const Options& options);

// Throws UsageError unless the attribute is there and has three components.
void check_vectors(const Frame& frame, const Options& options);

}  // namespace replay
