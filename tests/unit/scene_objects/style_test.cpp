// What a style comes to with data: ranges, components, categories, and messages that help.
#include "scene/style.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "unit/geometry/arrays.h"

namespace insitu::testing {
namespace {

using ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

insitu_style by(const char* attribute, const char* map = nullptr) {
  insitu_style style;
  insitu_style_init(&style);
  style.color_by = INSITU_COLOR_ATTRIBUTE;
  style.attribute = attribute;
  style.colormap = map;
  return style;
}

// Five particles with a scalar, a vector and a type.
class Coloured : public ::testing::Test {
 protected:
  Coloured() : particles("gas", ParticleOrder::index, false) {
    ParticleArrays arrays;
    arrays.position = positions_of(x);
    arrays.type = view_of(type, 1, INSITU_USE_TYPE);
    arrays.attributes.push_back({"value", attribute_of(value)});
    arrays.attributes.push_back({"velocity", attribute_of(velocity, 3)});
    arrays.attributes.push_back({"constant", attribute_of(constant)});
    arrays.attributes.push_back({"bad", attribute_of(bad)});
    arrays.attributes.push_back({"huge", attribute_of(huge)});
    particles.bind(std::move(arrays));
  }
  Colors colors(const insitu_style& description) const {
    const Style style = make_style(description);
    return Colors(style, particles, *builtin_colormap(style.colormap_name));
  }

  std::vector<double> x = std::vector<double>(15, 0.0);
  std::vector<std::int32_t> type = {0, 1, 6, 8, -1};
  std::vector<double> value = {2.0, 4.0, 3.0, nan, infinity};
  std::vector<double> velocity = {3, 4, 0, 0, 0, 0, 1e300, 1e300, 0, 1, 2, 2, nan, 0, 0};
  std::vector<double> constant = {7, 7, 7, 7, 7};
  std::vector<double> bad = {nan, nan, nan, nan, nan};
  std::vector<double> huge = {-1.7e308, 1.7e308, 0.0, 0.0, 0.0};
  Particles particles;
  const Colormap& viridis = *builtin_colormap("viridis");
};

TEST_F(Coloured, AutomaticRangeSpansTheFiniteValues) {
  const Colors c = colors(by("value"));
  EXPECT_EQ(c.range().low, 2.0);
  EXPECT_EQ(c.range().high, 4.0);
  EXPECT_EQ(c.of(0), viridis.lookup(0.0));
  EXPECT_EQ(c.of(1), viridis.lookup(1.0));
  EXPECT_EQ(c.of(2), viridis.lookup(0.5));
  EXPECT_EQ(c.of(3), Colormap::bad_value);
  EXPECT_EQ(c.of(4), viridis.lookup(1.0));
}

TEST_F(Coloured, FixedRangeClampsAndMayFall) {
  insitu_style style = by("value");
  style.range_mode = INSITU_RANGE_FIXED;
  style.range[0] = 3.0;
  style.range[1] = 3.5;
  EXPECT_EQ(colors(style).of(0), viridis.lookup(0.0));
  EXPECT_EQ(colors(style).of(1), viridis.lookup(1.0));
  style.range[0] = 4.0;
  style.range[1] = 2.0;
  EXPECT_EQ(colors(style).of(0), viridis.lookup(1.0));
  EXPECT_EQ(colors(style).of(1), viridis.lookup(0.0));
}

TEST_F(Coloured, OneValueEverywhereIsTheMiddle) { EXPECT_EQ(colors(by("constant")).of(0), viridis.lookup(0.5)); }

TEST_F(Coloured, AllBadIsBad) { EXPECT_EQ(colors(by("bad")).of(2), Colormap::bad_value); }

TEST_F(Coloured, TheWidestRangeDoesNotOverflow) {
  const Colors c = colors(by("huge"));
  EXPECT_EQ(c.of(0), viridis.lookup(0.0));
  EXPECT_EQ(c.of(1), viridis.lookup(1.0));
  EXPECT_EQ(c.of(2), viridis.lookup(0.5));
}

TEST_F(Coloured, VectorsByLengthOrComponent) {
  insitu_style style = by("velocity");
  style.range_mode = INSITU_RANGE_FIXED;
  style.range[1] = 10.0;
  EXPECT_EQ(colors(style).of(0), viridis.lookup(0.5));
  EXPECT_EQ(colors(style).of(2), viridis.lookup(1.0));
  EXPECT_EQ(colors(style).of(4), Colormap::bad_value);
  style.component = 2;
  EXPECT_EQ(colors(style).of(0), viridis.lookup(0.4));
  insitu_style automatic = by("velocity");
  EXPECT_DOUBLE_EQ(colors(automatic).range().high, std::sqrt(2.0) * 1e300);
  EXPECT_EQ(colors(automatic).range().low, 0.0);
}

TEST_F(Coloured, CategoriesIgnoreRanges) {
  insitu_style style = by("type", "elements");
  style.range_mode = INSITU_RANGE_FIXED;
  style.range[1] = 100.0;
  const Colormap& elements = *builtin_colormap("elements");
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ(colors(style).of(i), elements.lookup(type[i]));
  EXPECT_FALSE(colors(style).of(2) == colors(style).of(3)) << "carbon and oxygen";
}

TEST_F(Coloured, UniformNeedsNoAttribute) {
  insitu_style style;
  insitu_style_init(&style);
  EXPECT_EQ(colors(style).of(0), (Rgba{0.8f, 0.8f, 0.8f, 1.0f}));
  style.color[1] = 0.5;
  EXPECT_EQ(colors(style).of(0), (Rgba{0.0f, 0.5f, 0.0f, 1.0f}));
}

// The style's factor, its map by value, and the opacity of the colours, multiplied; missing data stay opaque.
TEST_F(Coloured, OpacitiesMultiply) {
  insitu_style style = by("value");
  EXPECT_FALSE(colors(style).are_transparent());
  EXPECT_EQ(colors(style).of(0).a, 1.0f);
  style.opacity = 0.5;
  const double by_value[] = {0.25, 1.0, 0.5};
  style.opacity_map = by_value;
  style.opacity_map_count = 3;
  const Colors c = colors(style);
  EXPECT_TRUE(c.are_transparent());
  EXPECT_EQ(c.of(0).a, 0.125f);
  EXPECT_EQ(c.of(1).a, 0.25f);
  EXPECT_EQ(c.of(2).a, 0.5f);
  EXPECT_EQ(c.of(3), Colormap::bad_value);
  EXPECT_EQ(c.of(4).a, 0.25f);
  EXPECT_EQ(c.of(2).g, viridis.lookup(0.5).g);
  EXPECT_EQ(c.opacity().of(1), 0.25f);
  const double opaque[] = {1.0, 1.0};
  style.opacity = 1.0;
  style.opacity_map = opaque;
  style.opacity_map_count = 2;
  EXPECT_FALSE(colors(style).are_transparent());
  style.opacity_map = by_value;
  style.opacity_map_count = 1;
  EXPECT_EQ(colors(style).of(0).a, 0.25f);
  EXPECT_EQ(colors(style).of(1).a, 0.25f);
}

TEST_F(Coloured, TheOpacityOfAnOwnMapCounts) {
  const std::vector<double> rgba = {1, 0, 0, 0.2, 0, 1, 0, 1};
  const Colormap half = Colormap::from_srgb(ColormapKind::continuous, rgba);
  Style style = make_style(by("value"));
  EXPECT_TRUE(Colors(style, particles, half).are_transparent());
  EXPECT_FLOAT_EQ(Colors(style, particles, half).of(0).a, 0.2f);
  EXPECT_FLOAT_EQ(Colors(style, particles, half).of(2).a, 0.6f);
  style.opacity = 0.5f;
  EXPECT_FLOAT_EQ(Colors(style, particles, half).of(2).a, 0.3f);
  const Colormap categories = Colormap::from_srgb(ColormapKind::categorical, rgba);
  style = make_style(by("type"));
  EXPECT_FLOAT_EQ(Colors(style, particles, categories).of(2).a, 0.2f);
  EXPECT_EQ(Colors(style, particles, categories).of(1).a, 1.0f);
  insitu_style uniform;
  insitu_style_init(&uniform);
  uniform.opacity = 0.25;
  EXPECT_TRUE(colors(uniform).are_transparent());
  EXPECT_EQ(colors(uniform).of(3).a, 0.25f);
}

TEST_F(Coloured, UnknownAttributesListTheKnown) {
  try {
    colors(by("temperature"));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), INSITU_ERROR_INVALID_ARGUMENT);
    for (const char* part : {"gas", "temperature", "value", "velocity", "type"})
      EXPECT_THAT(error.what(), HasSubstr(part));
  }
  insitu_style style = by("velocity");
  style.component = 4;
  EXPECT_THROW(colors(style), Error);
  style.component = 3;
  EXPECT_NO_THROW(colors(style));
}

TEST(MakeStyle, RefusesWhatCannotBeMeant) {
  const auto message = [](const insitu_style& style) -> std::string {
    try {
      make_style(style);
      return "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), INSITU_ERROR_INVALID_ARGUMENT);
      return error.what();
    }
  };
  EXPECT_EQ(message(by("a")), "accepted");
  EXPECT_THAT(message(by(nullptr)), HasSubstr("name"));
  EXPECT_THAT(message(by("")), HasSubstr("name"));
  const std::string unknown = message(by("a", "rainbow"));
  for (const char* part : {"rainbow", "viridis", "inferno", "coolwarm", "categorical", "elements"})
    EXPECT_THAT(unknown, HasSubstr(part));
  insitu_style style = by("a");
  style.component = 5;
  EXPECT_THAT(message(style), HasSubstr("component"));
  style = by("a");
  style.range_mode = 2;
  EXPECT_THAT(message(style), HasSubstr("range_mode"));
  style = by("a");
  style.color_by = 2;
  EXPECT_THAT(message(style), HasSubstr("color_by"));
  for (const double bad : {nan, infinity}) {
    style = by("a");
    style.range_mode = INSITU_RANGE_FIXED;
    style.range[0] = bad;
    EXPECT_THAT(message(style), HasSubstr("range"));
    style = by("a");
    style.color[2] = bad;
    EXPECT_THAT(message(style), HasSubstr("color"));
  }
  style = by("a");
  style.color[0] = -0.1;
  EXPECT_THAT(message(style), HasSubstr("color"));
  for (const double bad : {-0.1, 1.1, nan, infinity}) {
    style = by("a");
    style.opacity = bad;
    EXPECT_THAT(message(style), HasSubstr("opacity is not between 0 and 1"));
    const double map[] = {0.5, bad};
    style = by("a");
    style.opacity_map = map;
    style.opacity_map_count = 2;
    EXPECT_THAT(message(style), HasSubstr("opacity_map"));
  }
  const double map[] = {0.5};
  style = by("a");
  style.opacity_map_count = 1;
  EXPECT_THAT(message(style), HasSubstr("do not fit"));
  style.opacity_map = map;
  EXPECT_EQ(message(style), "accepted");
  style.opacity_map_count = 0;
  EXPECT_THAT(message(style), HasSubstr("do not fit"));
  style.opacity_map_count = 65537;
  EXPECT_THAT(message(style), HasSubstr("65536"));
  style.opacity_map_count = 1;
  style.color_by = INSITU_COLOR_UNIFORM;
  EXPECT_THAT(message(style), HasSubstr("INSITU_COLOR_ATTRIBUTE"));
}

}  // namespace
}  // namespace insitu::testing
