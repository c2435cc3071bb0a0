// A plain view of foreign memory, as the kernels see it: pointers, stride and type; nothing is owned or checked here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace insitu::kernels {

enum class Scalar : std::uint8_t { f32, f64, i32, i64, u8, u32, u64 };

constexpr std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::u8:
      return 1;
    case Scalar::f32:
    case Scalar::i32:
    case Scalar::u32:
      return 4;
    default:
      return 8;
  }
}

template <class T>
inline T load(const std::byte* address) {
  T value;
  std::memcpy(&value, address, sizeof value);
  return value;
}

inline double load_as_double(Scalar type, const std::byte* address) {
  switch (type) {
    case Scalar::f32:
      return static_cast<double>(load<float>(address));
    case Scalar::f64:
      return load<double>(address);
    case Scalar::i32:
      return static_cast<double>(load<std::int32_t>(address));
    case Scalar::i64:
      return static_cast<double>(load<std::int64_t>(address));
    case Scalar::u8:
      return static_cast<double>(load<std::uint8_t>(address));
    case Scalar::u32:
      return static_cast<double>(load<std::uint32_t>(address));
    case Scalar::u64:
      return static_cast<double>(load<std::uint64_t>(address));
  }
  return 0.0;
}

// Up to four scalars per item, each component with its own base. `rows`: base[0] is a table of row pointers instead,
// `stride` bytes from entry to entry, and component c stands c scalars into the row.
struct ArrayView {
  const std::byte* base[4] = {};
  std::ptrdiff_t stride = 0;  // bytes from item to item
  std::uint64_t count = 0;
  std::uint32_t components = 0;
  Scalar type = Scalar::f32;
  bool rows = false;

  const std::byte* address(std::uint64_t item, std::uint32_t component) const {
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(item) * stride;
    if (rows) return load<const std::byte*>(base[0] + offset) + component * size_of(type);
    return base[component] + offset;
  }
  double value(std::uint64_t item, std::uint32_t component = 0) const {
    return load_as_double(type, address(item, component));
  }
};

}  // namespace insitu::kernels
