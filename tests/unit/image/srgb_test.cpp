#include "image/srgb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace insitu {
namespace {

// The standard's formula, in a wider type and in the other direction than the table was made.
long double srgb_times_255(float linear) {
  const long double x = linear;
  return 255.0L * (x <= 0.0031308L ? 12.92L * x : 1.055L * std::pow(x, 1.0L / 2.4L) - 0.055L);
}

TEST(Srgb, FollowsTheFormulaOverAllMagnitudes) {
  int checked = 0;
  for (float x = 1e-6f; x < 1.0f; x *= 1.00002f, ++checked) {
    const long double exact = srgb_times_255(x);
    if (std::abs(exact - std::floor(exact) - 0.5L) < 1e-4L) continue;  // the formula's two pieces do not quite meet
    ASSERT_EQ(linear_to_srgb8(x), std::lround(exact)) << x;
  }
  EXPECT_GT(checked, 500000);
}

TEST(Srgb, EveryByteIsReachedInOrder) {
  int last = 0;
  int steps = 0;
  for (float x = 1e-5f; x < 1.1f; x *= 1.00002f) {
    const int byte = linear_to_srgb8(x);
    ASSERT_TRUE(byte == last || byte == last + 1) << x;
    steps += byte - last;
    last = byte;
  }
  EXPECT_EQ(steps, 255);
}

TEST(Srgb, BytesComeBackFromTheirOwnColor) {
  for (int byte = 0; byte <= 255; ++byte) {
    const double s = byte / 255.0;
    const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    EXPECT_EQ(linear_to_srgb8(static_cast<float>(linear)), byte);
  }
}

TEST(Srgb, KnownValues) {
  EXPECT_EQ(linear_to_srgb8(0.0f), 0);
  EXPECT_EQ(linear_to_srgb8(1.0f), 255);
  EXPECT_EQ(linear_to_srgb8(0.5f), 188);          // a power of 1 / 2.2 would give 186
  EXPECT_EQ(linear_to_srgb8(0.18f), 118);         // middle grey
  EXPECT_EQ(linear_to_srgb8(0.214041144f), 128);  // half way in sRGB: 127.5, the larger byte
  EXPECT_EQ(linear_to_srgb8(0.001f), 3);          // the straight piece: 12.92 * 0.255
}

TEST(Srgb, ValuesThatAreNoColors) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const auto convert : {linear_to_srgb8, linear_to_unorm8}) {
    EXPECT_EQ(convert(-1.0f), 0);
    EXPECT_EQ(convert(-0.0f), 0);
    EXPECT_EQ(convert(-infinity), 0);
    EXPECT_EQ(convert(std::numeric_limits<float>::quiet_NaN()), 0);
    EXPECT_EQ(convert(-std::numeric_limits<float>::quiet_NaN()), 0);
    EXPECT_EQ(convert(std::numeric_limits<float>::denorm_min()), 0);
    EXPECT_EQ(convert(std::numeric_limits<float>::min()), 0);
    EXPECT_EQ(convert(1.5f), 255);
    EXPECT_EQ(convert(std::numeric_limits<float>::max()), 255);
    EXPECT_EQ(convert(infinity), 255);
  }
}

TEST(Srgb, AlphaStaysLinear) {
  for (int byte = 0; byte <= 255; ++byte) {
    EXPECT_EQ(linear_to_unorm8(static_cast<float>(byte) / 255.0f), byte);
  }
  EXPECT_EQ(linear_to_unorm8(0.5f), 128);
}

}  // namespace
}  // namespace insitu
