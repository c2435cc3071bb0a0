// Values between two bounds, both inclusive.
#pragma once

#include "geometry/filter/filter_block.h"

namespace insitu {

struct RangeTerm {
  kernels::ArrayView values;
  std::uint32_t component = 0;  // as in insitu_style
  double low = 0.0;
  double high = 0.0;

  // NaN lies in no range; integers are compared as integers.
  std::uint64_t word(const FilterBlock& block) const;
  bool accepts(std::uint64_t item) const;
};

}  // namespace insitu
