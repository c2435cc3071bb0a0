// Orders of keys that are hard for a selection or a partition.
#pragma once

#include <algorithm>
#include <cstdint>

#include "unit/kernels/counter_random.h"

namespace insitu::testing {

enum class Pattern {
  random,
  sorted,
  reversed,
  equal,
  two_values,
  organ_pipe,
  sawtooth,
  one_small,
  one_large,
  few,
  tiny
};
inline constexpr Pattern all_patterns[] = {
    Pattern::random,   Pattern::sorted,    Pattern::reversed,  Pattern::equal, Pattern::two_values, Pattern::organ_pipe,
    Pattern::sawtooth, Pattern::one_small, Pattern::one_large, Pattern::few,   Pattern::tiny};

inline double value_of(Pattern pattern, std::uint64_t i, std::uint64_t n, CounterRandom& random) {
  const auto value = [](std::uint64_t v) { return static_cast<double>(v); };
  switch (pattern) {
    case Pattern::random:
      return static_cast<double>(static_cast<float>(random.between(-1.0, 1.0)));
    case Pattern::sorted:
      return value(i);
    case Pattern::reversed:
      return value(n - i);
    case Pattern::equal:
      return 1.5;
    case Pattern::two_values:
      return value(random.below(2));
    case Pattern::organ_pipe:
      return value(std::min(i, n - i));
    case Pattern::sawtooth:
      return value(i % 64);
    case Pattern::one_small:
      return i == n / 3 ? -1.0 : 1.0;
    case Pattern::one_large:
      return i == n / 3 ? 2.0 : 1.0;
    case Pattern::few:
      return value(random.below(5));
    case Pattern::tiny:  // denormal in f32, and zeros of both signs
      return random.sign() * 0x1p-149 * value(random.below(4));
  }
  return 0.0;
}

}  // namespace insitu::testing
