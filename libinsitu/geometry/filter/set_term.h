// Values that are members of a set of integers: types, ids.
#pragma once

#include "geometry/filter/filter_block.h"
#include "geometry/filter/member_set.h"

namespace insitu {

struct SetTerm {
  kernels::ArrayView values;
  std::uint32_t component = 0;  // as in insitu_style
  const MemberSet* members = nullptr;

  // Floating point values are members where they are whole numbers.
  std::uint64_t word(const FilterBlock& block) const;
  bool accepts(std::uint64_t item) const;
};

}  // namespace insitu
