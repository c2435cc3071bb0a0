// Small files of the binary formats, written from the published layouts and by none of the readers' code.
#pragma once

#include <bit>
#include <string>

namespace replay::test {

struct GadgetSample {
  std::endian order = std::endian::little;
  bool tagged = false;       // format 2
  bool wide = false;         // doubles and 64 bit ids
  std::uint32_t files = 1;   // of the snapshot
  std::uint32_t in_all = 1;  // how often this file's particles come in the snapshot
  std::uint32_t first_id = 1;
};
// Two gas particles, one of halo and two stars. Gas has masses 1, 2 and stars 4, 5 of their own, the halo 0.5 by the
// header. Positions 0, 1, 2, ...; velocities ten times as much; U 100, 200; RHO 1, 8; HSML 7, 8.
std::string gadget_sample(const GadgetSample& what);

struct TipsySample {
  std::endian order = std::endian::big;
  bool padding = true;
  bool wide_positions = false;
  bool wide_velocities = false;
};
// One gas particle, two of dark matter, one star: positions 0, 1, 2, ..., velocities -0, -1, -2, ...; the other values
// of the k-th particle (from 1) are k + 0.25, k + 0.5, ...
std::string tipsy_sample(const TipsySample& what);

struct DcdSample {
  std::endian order = std::endian::little;
  bool wide_markers = false;
  bool charmm = true;
  bool cell = true;
  bool fourth = false;
  int fixed = 0;  // the first so many of four atoms
};
// Four atoms, three steps numbered 10, 15, 20; atom i is at (i, 10 i, 100 i) plus the number of the step, counted from
// 0.
std::string dcd_sample(const DcdSample& what);

}  // namespace replay::test
