// A set of integers that values are looked up in.
#pragma once

#include <cmath>
#include <vector>

#include "core/budget.h"
#include "geometry/filter/whole_number.h"

namespace insitu {

class MemberSet {
 public:
  MemberSet() = default;
  // The values of an array of integers, copied. Throws Error(over_budget).
  MemberSet(Budget& budget, const kernels::ArrayView& members);

  // Numbers that are not whole are in no set.
  bool contains(double value) const {
    if (!(value >= -0x1p63 && value < 0x1p64) || value != std::floor(value)) return false;
    if (value < 0.0) return contains_negative(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)));
    return contains_natural(static_cast<std::uint64_t>(value));
  }
  template <class T>
  bool contains_integer(T value) const {
    return value < T{0} ? contains_negative(static_cast<std::uint64_t>(value))
                        : contains_natural(static_cast<std::uint64_t>(value));
  }
  bool contains(const WholeNumber& value) const {
    return value.negative ? contains_negative(value.bits) : contains_natural(value.bits);
  }

 private:
  bool contains_natural(std::uint64_t value) const {
    if (!bits_.empty()) {
      const std::uint64_t at = value - first_;  // below `first_`: wraps to a large number
      return at / 64 < bits_.size() && (bits_.data()[at / 64] >> at % 64 & 1) != 0;
    }
    return contains_listed(natural_, value);
  }
  bool contains_negative(std::uint64_t value) const { return contains_listed(negative_, value); }
  static bool contains_listed(const BudgetVector<std::uint64_t>& list, std::uint64_t value);

  // Ascending, each once. Where a bit for every number from the first to the last is no more memory than the list, the
  // bits stand instead: types, and numbers without large gaps.
  BudgetVector<std::uint64_t> natural_;
  BudgetVector<std::uint64_t> negative_;  // as std::int64_t has them
  BudgetVector<std::uint64_t> bits_;
  std::uint64_t first_ = 0;
};

}  // namespace insitu
