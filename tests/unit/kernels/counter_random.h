// Random numbers for tests: the same on every machine, and a function of a seed (the index of the loop) and a counter.
#pragma once

#include <cmath>
#include <cstdint>

namespace insitu::testing {

class CounterRandom {
 public:
  explicit CounterRandom(std::uint64_t seed) : seed_(stir(seed + 0x632be59bd9b4e019)) {}

  std::uint64_t next() { return stir(seed_ + 0x9e3779b97f4a7c15 * ++drawn_); }
  std::uint64_t below(std::uint64_t n) { return next() % n; }
  double sign() { return (next() & 1) != 0 ? 1.0 : -1.0; }
  // In [0, 1).
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  // Between 10^low and 10^high, evenly in the exponent.
  double magnitude(double low, double high) { return std::pow(10.0, between(low, high)); }

  // Evenly over the unit sphere.
  void direction(double out[3]) {
    for (;;) {
      double squares = 0.0;
      for (int c = 0; c < 3; ++c) {
        out[c] = between(-1.0, 1.0);
        squares += out[c] * out[c];
      }
      if (squares < 0.01 || squares > 1.0) continue;
      const double length = std::sqrt(squares);
      for (int c = 0; c < 3; ++c) out[c] /= length;
      return;
    }
  }

 private:
  // The finaliser of SplitMix64 (Steele, Lea, Flood, 2014).
  static std::uint64_t stir(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
  }

  std::uint64_t seed_;
  std::uint64_t drawn_ = 0;
};

}  // namespace insitu::testing
