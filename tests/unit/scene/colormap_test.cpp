#include "scene/colormap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

namespace insitu {
namespace {

TEST(Colormap, ContinuousLookupAtAndBeyondTheEnds) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const char* name : {"viridis", "inferno", "coolwarm"}) {
    const Colormap& map = *builtin_colormap(name);
    for (const double low : {-0.0, -1e-300, -1.0, -1e300, -infinity}) EXPECT_EQ(map.lookup(low), map.lookup(0.0));
    for (const double high : {1.0 + 1e-15, 2.0, 1e300, infinity}) EXPECT_EQ(map.lookup(high), map.lookup(1.0));
    EXPECT_EQ(map.lookup(std::numeric_limits<double>::quiet_NaN()), Colormap::bad_value);
    EXPECT_NEAR(map.lookup(std::nextafter(1.0, 0.0)).r, map.lookup(1.0).r, 1e-6);
  }
}

TEST(Colormap, CategoricalLookupWraps) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Colormap& map = *builtin_colormap("categorical");
  const double count = static_cast<double>(map.table_size());
  ASSERT_EQ(map.table_size(), 10u);
  for (double i = 0; i < count; ++i) {
    for (const double other : {i + 0.75, i + count, i + 1000 * count, i - count, i - 7 * count}) {
      EXPECT_EQ(map.lookup(other), map.lookup(i)) << i << ' ' << other;
    }
  }
  EXPECT_EQ(map.lookup(-1), map.lookup(count - 1));
  EXPECT_EQ(map.lookup(-0.5), map.lookup(count - 1));
  EXPECT_EQ(map.lookup(9007199254740993.0), map.lookup(2));  // 2^53 + 1 is 2^53 as a double: 9007199254740992
  EXPECT_EQ(map.lookup(-1e300).a, 1.0f);
  for (const double bad : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(map.lookup(bad), Colormap::bad_value);
  }
}

TEST(Colormap, OwnContinuousMap) {
  const std::vector<double> rgba{0, 0, 0, 0, /**/ 1, 0.5, 0, 1, /**/ 1, 1, 1, 0.5};
  const Colormap map = Colormap::from_srgb(ColormapKind::continuous, rgba);
  EXPECT_GE(map.table_size(), 1024u);
  EXPECT_EQ(map.lookup(0.0), (Rgba{0, 0, 0, 0}));
  EXPECT_EQ(map.lookup(1.0), (Rgba{1, 1, 1, 0.5f}));
  EXPECT_EQ(map.lookup(0.5).r, 1.0f) << "given colours are met exactly";
  EXPECT_EQ(map.lookup(0.5).a, 1.0f);
  // Mixed as sRGB: half way from 0 to 1 is 127.5 of 255, whose linear value is 0.214.
  EXPECT_NEAR(map.lookup(0.25).r, 0.2140411, 1e-6);
  EXPECT_NEAR(map.lookup(0.25).a, 0.5, 1e-6);
  EXPECT_NEAR(map.lookup(0.75).a, 0.75, 1e-6);
}

TEST(Colormap, OwnMapOfManyOrOneColor) {
  std::vector<double> rgba;
  for (int i = 0; i < 5000; ++i) rgba.insert(rgba.end(), {i % 2 ? 1.0 : 0.0, 0.5, i / 4999.0, 1.0});
  const Colormap many = Colormap::from_srgb(ColormapKind::continuous, rgba);
  EXPECT_EQ(many.table_size(), 5000u);
  EXPECT_NEAR(many.lookup(1234.0 / 4999.0).r, 0.0, 1e-6);
  EXPECT_NEAR(many.lookup(1235.0 / 4999.0).r, 1.0, 1e-6);

  for (const ColormapKind kind : {ColormapKind::continuous, ColormapKind::categorical}) {
    const Colormap one = Colormap::from_srgb(kind, std::vector<double>{1, 0, 0, 0.25});
    for (const double value : {-3.0, 0.0, 0.5, 1.0, 7.0}) EXPECT_EQ(one.lookup(value), (Rgba{1, 0, 0, 0.25f}));
  }
}

TEST(Colormap, OwnCategoricalMap) {
  const std::vector<double> rgba{1, 0, 0, 1, /**/ 0, 1, 0, 0.5, /**/ 0, 0, 1, 1};
  const Colormap map = Colormap::from_srgb(ColormapKind::categorical, rgba);
  EXPECT_EQ(map.table_size(), 3u);
  EXPECT_EQ(map.lookup(1), (Rgba{0, 1, 0, 0.5f}));
  EXPECT_EQ(map.lookup(5), (Rgba{0, 0, 1, 1}));
  EXPECT_EQ(map.lookup(-3), (Rgba{1, 0, 0, 1}));
}

TEST(Colormap, WrongColorsOfTheCaller) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Colormap map = Colormap::from_srgb(ColormapKind::categorical, std::vector<double>{-1, 2, nan, nan});
  EXPECT_EQ(map.lookup(0), (Rgba{0, 1, 0, 0}));
  for (const size_t size : {0u, 1u, 3u, 5u}) {
    const std::vector<double> rgba(size, 0.5);
    EXPECT_THROW(Colormap::from_srgb(ColormapKind::continuous, rgba), std::invalid_argument) << size;
  }
}

}  // namespace
}  // namespace insitu
