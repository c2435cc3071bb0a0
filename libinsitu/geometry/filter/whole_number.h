// Integers of every type, without a rounding: 64 bits and a sign are more than double or one integer type has.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/array_view.h"

namespace insitu {

inline bool is_float(kernels::Scalar type) { return type == kernels::Scalar::f32 || type == kernels::Scalar::f64; }

struct WholeNumber {
  bool negative = false;
  std::uint64_t bits = 0;  // of negative ones as std::int64_t has them

  template <class T>
  static WholeNumber of(T value) {
    return {value < T{0}, static_cast<std::uint64_t>(value)};
  }

  bool is_below(double bound) const {
    const double up = std::ceil(bound);  // the same for whole numbers
    if (negative) return up > -0x1p63 && (up >= 0.0 || static_cast<std::int64_t>(bits) < static_cast<std::int64_t>(up));
    return up > 0.0 && (up >= 0x1p64 || bits < static_cast<std::uint64_t>(up));
  }
  bool is_above(double bound) const {
    const double down = std::floor(bound);
    if (negative)
      return down < 0.0 && (down < -0x1p63 || static_cast<std::int64_t>(bits) > static_cast<std::int64_t>(down));
    return down < 0.0 || (down < 0x1p64 && bits > static_cast<std::uint64_t>(down));
  }
};

// Of an array of integers.
inline WholeNumber whole_number(const kernels::ArrayView& view, std::uint64_t item, std::uint32_t component) {
  const std::byte* const at = view.address(item, component);
  switch (view.type) {
    case kernels::Scalar::i32:
      return WholeNumber::of(std::int64_t{kernels::load<std::int32_t>(at)});
    case kernels::Scalar::i64:
      return WholeNumber::of(kernels::load<std::int64_t>(at));
    case kernels::Scalar::u8:
      return {false, kernels::load<std::uint8_t>(at)};
    case kernels::Scalar::u32:
      return {false, kernels::load<std::uint32_t>(at)};
    case kernels::Scalar::u64:
      return {false, kernels::load<std::uint64_t>(at)};
    default:
      return {};
  }
}

}  // namespace insitu
