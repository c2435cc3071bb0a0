// Random numbers as a function of (seed, index): no state, so that they depend on no order of calls.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace cosmo {

// Philox4x32-10, a bijection of 128-bit counters per 64-bit key that passes the usual batteries of tests (Salmon,
// Moraes, Dror & Shaw, Parallel random numbers: as easy as 1, 2, 3, SC 2011, section 3.3).
inline std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;  // the golden ratio and sqrt(3) - 1
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

// Normal with mean 0 and variance 1 (Box & Muller 1958).
inline double random_normal(std::uint64_t seed, std::uint64_t index) {
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
  const std::array<std::uint32_t, 4> bits = philox({low(index), high(index), 0, 0}, {low(seed), high(seed)});
  // In (0, 1), never zero, so that the logarithm is finite.
  const auto unit = [](std::uint32_t h, std::uint32_t l) {
    return (static_cast<double>((std::uint64_t{h} << 20) | (l >> 12)) + 0.5) * 0x1.0p-52;
  };
  return std::sqrt(-2.0 * std::log(unit(bits[0], bits[1]))) * std::cos(2.0 * std::numbers::pi * unit(bits[2], bits[3]));
}

}  // namespace cosmo
