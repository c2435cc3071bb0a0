// insitu_array descriptors of test data, as a host would write them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/array_view.h"
#include "insitu/insitu.h"

namespace insitu::testing {

template <class T>
constexpr std::uint32_t scalar_type() {
  if constexpr (std::is_same_v<T, float>) return INSITU_F32;
  if constexpr (std::is_same_v<T, double>) return INSITU_F64;
  if constexpr (std::is_same_v<T, std::int32_t>) return INSITU_I32;
  if constexpr (std::is_same_v<T, std::int64_t>) return INSITU_I64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return INSITU_U8;
  if constexpr (std::is_same_v<T, std::uint32_t>) return INSITU_U32;
  if constexpr (std::is_same_v<T, std::uint64_t>) return INSITU_U64;
}

template <class T>
kernels::ArrayView view_of(const std::vector<T>& values, std::uint32_t components, std::uint32_t use) {
  const insitu_array array =
      insitu_array_records(scalar_type<T>(), components, values.data(), values.size() / components, 0);
  return checked_view(array, use, "test data");
}

template <class T>
kernels::ArrayView positions_of(const std::vector<T>& values) {
  return view_of(values, 3, INSITU_USE_POSITION);
}
template <class T>
kernels::ArrayView attribute_of(const std::vector<T>& values, std::uint32_t components = 1) {
  return view_of(values, components, INSITU_USE_ATTRIBUTE);
}

}  // namespace insitu::testing
