#include "geometry/filter/range_term.h"

#include <cmath>
#include <limits>
#include <type_traits>

#include "geometry/filter/whole_number.h"
#include "kernels/attribute_value.h"

namespace insitu {
namespace {

// The integers of type T between two numbers; low > high when there are none.
template <class T>
struct IntegerRange {
  T low;
  T high;

  IntegerRange(double from, double to) : low(std::numeric_limits<T>::max()), high(std::numeric_limits<T>::min()) {
    // Bounds of T that double holds: the smallest value, and one above the largest.
    const double least = static_cast<double>(std::numeric_limits<T>::min());
    const double beyond = std::ldexp(1.0, std::numeric_limits<T>::digits);
    from = std::ceil(from);
    to = std::floor(to);
    if (!(from <= to && from < beyond && to >= least)) return;
    low = from <= least ? std::numeric_limits<T>::min() : static_cast<T>(from);
    high = to >= beyond ? std::numeric_limits<T>::max() : static_cast<T>(to);
  }
};

}  // namespace

std::uint64_t RangeTerm::word(const FilterBlock& block) const {
  return with_scalars(values, [&](const auto& column) -> std::uint64_t {
    using T = decltype(column(0)(0));
    if (component == 0 && values.components > 1)
      return word_of_lengths(values, column, block, [&](double v) -> bool { return v >= low && v <= high; });
    const auto value = column(component > 0 ? component - 1 : 0);
    if constexpr (std::is_integral_v<T>) {
      const IntegerRange<T> range(low, high);
      return word_of(block, [&](std::uint64_t item) -> bool {
        const T v = value(item);
        return (v >= range.low) & (v <= range.high);
      });
    } else {
      return word_of(block, [&](std::uint64_t item) -> bool {
        const auto v = static_cast<double>(value(item));
        return (v >= low) & (v <= high);
      });
    }
  });
}

bool RangeTerm::accepts(std::uint64_t item) const {
  if (is_float(values.type) || (component == 0 && values.components > 1)) {
    const double v = kernels::attribute_value(values, item, component);
    return v >= low && v <= high;
  }
  const WholeNumber v = whole_number(values, item, component > 0 ? component - 1 : 0);
  return !v.is_below(low) && !v.is_above(high);
}

}  // namespace insitu
