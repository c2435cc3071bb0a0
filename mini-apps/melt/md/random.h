// Random numbers as a function of (seed, index): no state, so that they depend on no order of calls.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace melt {

// SplitMix64 (Steele, Lea & Flood, OOPSLA 2014): output number `index` of the stream that starts at `seed`.
inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t z = seed + (index + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

// In (0, 1]: never zero, so that its logarithm is finite.
inline double random_unit(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>((random_bits(seed, index) >> 11) + 1) * 0x1.0p-53;
}

// Normal with mean 0 and variance 1 (Box & Muller 1958).
inline double random_normal(std::uint64_t seed, std::uint64_t index) {
  const double radius = std::sqrt(-2.0 * std::log(random_unit(seed, 2 * index)));
  return radius * std::cos(2.0 * std::numbers::pi * random_unit(seed, 2 * index + 1));
}

}  // namespace melt
