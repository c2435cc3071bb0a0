#include "geometry/filter/set_term.h"

#include <type_traits>

namespace insitu {

std::uint64_t SetTerm::word(const FilterBlock& block) const {
  return with_scalars(values, [&](const auto& column) -> std::uint64_t {
    using T = decltype(column(0)(0));
    if (component == 0 && values.components > 1)
      return word_of_lengths(values, column, block, [&](double length) { return members->contains(length); });
    const auto value = column(component > 0 ? component - 1 : 0);
    return word_of(block, [&](std::uint64_t item) {
      if constexpr (std::is_integral_v<T>) {
        return members->contains_integer(value(item));
      } else {
        return members->contains(static_cast<double>(value(item)));
      }
    });
  });
}

bool SetTerm::accepts(std::uint64_t item) const {
  if (is_float(values.type) || (component == 0 && values.components > 1))
    return members->contains(kernels::attribute_value(values, item, component));
  return members->contains(whole_number(values, item, component > 0 ? component - 1 : 0));
}

}  // namespace insitu
