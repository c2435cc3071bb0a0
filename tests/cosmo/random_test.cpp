// Random numbers: the published answers, and the moments of a normal distribution.
#include "pm/random.h"

#include <gtest/gtest.h>

namespace cosmo {
namespace {

// Known answers that come with the generator (Random123, kat_vectors, philox4x32-10): zeros, ones, digits of pi.
TEST(Random, PhiloxGivesThePublishedAnswers) {
  using Four = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Four{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t f = 0xffffffff;
  EXPECT_EQ(philox({f, f, f, f}, {f, f}), (Four{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Four{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, NormalsHaveTheirMoments) {
  constexpr int count = 400'000;
  double sum = 0.0, square = 0.0, fourth = 0.0, neighbours = 0.0, last = 0.0;
  for (int i = 0; i < count; ++i) {
    const double x = random_normal(7, static_cast<std::uint64_t>(i));
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
    neighbours += x * last;
    last = x;
  }
  // Five standard errors of each: 1, sqrt(2), sqrt(96), 1 over the root of the count.
  const double error = 5.0 / std::sqrt(static_cast<double>(count));
  EXPECT_NEAR(sum / count, 0.0, error);
  EXPECT_NEAR(square / count, 1.0, 1.5 * error);
  EXPECT_NEAR(fourth / count, 3.0, 10.0 * error);
  EXPECT_NEAR(neighbours / count, 0.0, error);
  EXPECT_NE(random_normal(7, 0), random_normal(8, 0));
  EXPECT_NE(random_normal(7, 0), random_normal(std::uint64_t{7} << 32, 0));
}

}  // namespace
}  // namespace cosmo
