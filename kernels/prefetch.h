// Asking for memory some time before it is read.
#pragma once

#include <cstddef>
#include <cstdint>

namespace insitu::kernels {

constexpr std::ptrdiff_t memory_line = 64;  // bytes

// The line that `address` is in; it may be outside of everything. GCC 12 takes a function that does nothing but
// prefetch for one without effects, and drops the calls of it that it has not inlined by then; the empty statement is
// an effect (tests/unit/kernels/compiler_test.cpp).
[[gnu::always_inline]] inline void prefetch_line(const void* address) {
  __builtin_prefetch(address);
  asm volatile("");
}

// All lines of `bytes` > 0 bytes.
inline void prefetch_bytes(const void* address, std::size_t bytes) {
  const auto* const first = static_cast<const std::byte*>(address);
  const std::byte* const last = first + bytes - 1;
  for (const std::byte* at = first; at < last; at += memory_line) prefetch_line(at);
  prefetch_line(last);
}

// `count` > 0 items of `size` bytes that stand `stride` bytes apart.
inline void prefetch_items(const std::byte* first, std::uint64_t count, std::ptrdiff_t stride, std::size_t size) {
  const auto reach = static_cast<std::ptrdiff_t>(count - 1) * stride;
  if (stride < 0) {
    first += reach;
    stride = -stride;
  }
  const std::byte* const last = first + (reach < 0 ? -reach : reach) + size - 1;
  for (const std::ptrdiff_t step = stride < memory_line ? memory_line : stride; first < last; first += step)
    prefetch_line(first);
  prefetch_line(last);
}

}  // namespace insitu::kernels
