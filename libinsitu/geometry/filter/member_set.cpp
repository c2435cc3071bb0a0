#include "geometry/filter/member_set.h"

#include <algorithm>

namespace insitu {
namespace {

constexpr const char* what = "the members of a filter's set";

void keep(Budget& budget, const std::vector<std::uint64_t>& values, BudgetVector<std::uint64_t>& list) {
  list.reset(budget, values.size(), what);
  std::copy(values.begin(), values.end(), list.data());
}

void sort_once(std::vector<std::uint64_t>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

MemberSet::MemberSet(Budget& budget, const kernels::ArrayView& members) {
  const BudgetShare during(budget, members.count * sizeof(std::uint64_t), what);
  std::vector<std::uint64_t> natural;
  std::vector<std::uint64_t> negative;
  for (std::uint64_t i = 0; i < members.count; ++i) {
    const WholeNumber number = whole_number(members, i, 0);
    (number.negative ? negative : natural).push_back(number.bits);
  }
  sort_once(natural);
  sort_once(negative);  // two's complement keeps the order among negative numbers
  keep(budget, negative, negative_);
  if (!natural.empty() && (natural.back() - natural.front()) / 64 <= natural.size()) {
    first_ = natural.front();
    bits_.reset(budget, (natural.back() - first_) / 64 + 1, what);
    for (const std::uint64_t value : natural)
      bits_.data()[(value - first_) / 64] |= std::uint64_t{1} << (value - first_) % 64;
  } else {
    keep(budget, natural, natural_);
  }
}

bool MemberSet::contains_listed(const BudgetVector<std::uint64_t>& list, std::uint64_t value) {
  return std::binary_search(list.data(), list.data() + list.size(), value);
}

}  // namespace insitu
