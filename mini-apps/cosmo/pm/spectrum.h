// The power spectrum that particles have.
#pragma once

#include <cstdint>
#include <vector>

#include "density.h"
#include "workers.h"

namespace cosmo {

// Modes whose wave number is about k.
struct PowerBin {
  double k = 0.0;      // their mean, in h/Mpc
  double power = 0.0;  // mean of |delta_k|^2, in (Mpc/h)^3, the smoothing by the clouds taken out
  std::uint64_t modes = 0;
};

// Bins one lowest wave number wide, from the lowest to that of the mesh. Shot noise is not taken out: a lattice that
// was moved a little has none.
std::vector<PowerBin> measure_power(const Density& density, double side, Workers& workers);

}  // namespace cosmo
