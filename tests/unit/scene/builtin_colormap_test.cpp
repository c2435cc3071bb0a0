// The maps that the library brings, against published values.
#include "scene/colormap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace insitu {
namespace {

using Bytes = std::array<int, 3>;

double encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

Bytes srgb_bytes(const Rgba& color) {
  const auto byte = [](float linear) { return static_cast<int>(std::lround(255.0 * encode(linear))); };
  return {byte(color.r), byte(color.g), byte(color.b)};
}

int largest_difference(const Bytes& a, const Bytes& b) {
  int largest = 0;
  for (size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a[c] - b[c]));
  return largest;
}

// CIELAB lightness.
double lightness(const Rgba& color) {
  const double y = 0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b;
  return y > 216.0 / 24389.0 ? 116.0 * std::cbrt(y) - 16.0 : y * 24389.0 / 27.0;
}

struct Published {
  int index;  // of 0 to 255
  Bytes color;
};

void expect_published(const char* name, const std::vector<Published>& values) {
  const Colormap& map = *builtin_colormap(name);
  for (const auto& [index, color] : values) {
    const Bytes bytes = srgb_bytes(map.lookup(index / 255.0));
    EXPECT_LE(largest_difference(bytes, color), 1)
        << name << ' ' << index << ": " << bytes[0] << ' ' << bytes[1] << ' ' << bytes[2];
  }
}

TEST(BuiltinColormap, Names) {
  const std::vector<std::string> names{"viridis", "inferno", "coolwarm", "categorical", "elements"};
  EXPECT_EQ(builtin_colormap_names(), names);
  for (const std::string& name : names) {
    ASSERT_NE(builtin_colormap(name), nullptr) << name;
    EXPECT_EQ(builtin_colormap(name), builtin_colormap(name));
  }
  for (const char* name : {"", "Viridis", "viridis ", "jet"}) EXPECT_EQ(builtin_colormap(name), nullptr);
  EXPECT_EQ(builtin_colormap("viridis")->kind(), ColormapKind::continuous);
  EXPECT_EQ(builtin_colormap("categorical")->kind(), ColormapKind::categorical);
  EXPECT_EQ(builtin_colormap("elements")->table_size(), 119u);
}

TEST(BuiltinColormap, ViridisAsPublished) {
  expect_published("viridis", {{0, {68, 1, 84}},
                               {3, {69, 5, 89}},
                               {17, {72, 26, 108}},
                               {32, {71, 45, 123}},
                               {64, {59, 82, 139}},
                               {96, {44, 114, 142}},
                               {127, {33, 144, 141}},
                               {128, {33, 145, 140}},
                               {160, {40, 174, 128}},
                               {191, {92, 200, 99}},
                               {222, {168, 219, 52}},
                               {239, {213, 226, 26}},
                               {253, {248, 230, 33}},
                               {255, {253, 231, 37}}});
  const Colormap& map = *builtin_colormap("viridis");
  EXPECT_EQ(srgb_bytes(map.lookup(0.0)), (Bytes{68, 1, 84}));
  EXPECT_LE(largest_difference(srgb_bytes(map.lookup(0.5)), {33, 145, 140}), 1);
  EXPECT_EQ(srgb_bytes(map.lookup(1.0)), (Bytes{253, 231, 37}));
}

TEST(BuiltinColormap, InfernoAsPublished) {
  expect_published("inferno", {{0, {0, 0, 4}},
                               {3, {1, 1, 8}},
                               {17, {12, 8, 38}},
                               {32, {33, 12, 74}},
                               {64, {87, 16, 110}},
                               {96, {138, 34, 106}},
                               {127, {186, 54, 85}},
                               {128, {188, 55, 84}},
                               {160, {228, 90, 49}},
                               {191, {249, 140, 10}},
                               {222, {249, 199, 47}},
                               {239, {242, 232, 101}},
                               {253, {249, 252, 157}},
                               {255, {252, 255, 164}}});
  const Colormap& map = *builtin_colormap("inferno");
  EXPECT_EQ(srgb_bytes(map.lookup(0.0)), (Bytes{0, 0, 4}));
  EXPECT_EQ(srgb_bytes(map.lookup(1.0)), (Bytes{252, 255, 164}));
}

TEST(BuiltinColormap, SequentialMapsBecomeLighterAllTheWay) {
  for (const char* name : {"viridis", "inferno"}) {
    double last = -1.0;
    for (int i = 0; i <= 2000; ++i) {
      const double l = lightness(builtin_colormap(name)->lookup(i / 2000.0));
      ASSERT_GT(l, last) << name << ' ' << i;
      last = l;
    }
  }
}

TEST(BuiltinColormap, CoolwarmAsPublished) {
  // The 33 colours of the paper's supplement.
  constexpr std::array<Bytes, 33> published{
      {{59, 76, 192},   {68, 90, 204},   {77, 104, 215},  {87, 117, 225},  {98, 130, 234},  {108, 142, 241},
       {119, 154, 247}, {130, 165, 251}, {141, 176, 254}, {152, 185, 255}, {163, 194, 255}, {174, 201, 253},
       {184, 208, 249}, {194, 213, 244}, {204, 217, 238}, {213, 219, 230}, {221, 221, 221}, {229, 216, 209},
       {236, 211, 197}, {241, 204, 185}, {245, 196, 173}, {247, 187, 160}, {247, 177, 148}, {247, 166, 135},
       {244, 154, 123}, {241, 141, 111}, {236, 127, 99},  {229, 112, 88},  {222, 96, 77},   {213, 80, 66},
       {203, 62, 56},   {192, 40, 47},   {180, 4, 38}}};
  const Colormap& map = *builtin_colormap("coolwarm");
  for (size_t i = 0; i < published.size(); ++i) {
    const Bytes bytes = srgb_bytes(map.lookup(static_cast<double>(i) / 32.0));
    EXPECT_LE(largest_difference(bytes, published[i]), 1)
        << i << ": " << bytes[0] << ' ' << bytes[1] << ' ' << bytes[2];
  }
  EXPECT_EQ(srgb_bytes(map.lookup(0.0)), published.front());
  EXPECT_EQ(srgb_bytes(map.lookup(0.5)), published[16]);
  EXPECT_EQ(srgb_bytes(map.lookup(1.0)), published.back());
}

TEST(BuiltinColormap, ContinuousMapsHaveNoSteps) {
  for (const char* name : {"viridis", "inferno", "coolwarm"}) {
    const Colormap& map = *builtin_colormap(name);
    Bytes last = srgb_bytes(map.lookup(0.0));
    for (int i = 1; i <= 3000; ++i) {
      const Bytes now = srgb_bytes(map.lookup(i / 3000.0));
      ASSERT_LE(largest_difference(now, last), 1) << name << ' ' << i;
      last = now;
    }
  }
}

// Colours as people without long or medium wave cones see them: H. Brettel, F. Vienot, J. Mollon as simplified by
// Vienot, Brettel and Mollon, 1999, for linear sRGB.
Rgba as_seen(const Rgba& color, bool protan) {
  const double r = color.r, g = color.g, b = color.b;
  const double red = protan ? 0.11238 * r + 0.88762 * g : 0.29275 * r + 0.70725 * g;
  const double blue = protan ? 0.00401 * r - 0.00401 * g + b : -0.02234 * r + 0.02234 * g + b;
  return {static_cast<float>(red), static_cast<float>(red), static_cast<float>(blue), 1.0f};
}

std::array<double, 3> lab(const Rgba& color) {
  const auto root = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
  const double r = color.r, g = color.g, b = color.b;
  const double x = root((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
  const double y = root(0.2126 * r + 0.7152 * g + 0.0722 * b);
  const double z = root((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double distance(const Rgba& a, const Rgba& b) {
  const auto p = lab(a), q = lab(b);
  return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

TEST(BuiltinColormap, CategoriesCanBeToldApartByEveryone) {
  const Colormap& map = *builtin_colormap("categorical");
  for (double i = 0; i < 10; ++i) {
    for (double j = 0; j < i; ++j) {
      const Rgba a = map.lookup(i), b = map.lookup(j);
      EXPECT_GT(distance(a, b), 20.0) << i << ' ' << j;
      for (const bool protan : {false, true}) {
        EXPECT_GT(distance(as_seen(a, protan), as_seen(b, protan)), 12.0) << i << ' ' << j << ' ' << protan;
      }
    }
  }
}

TEST(BuiltinColormap, ElementsFollowTheConvention) {
  const Colormap& map = *builtin_colormap("elements");
  const auto color = [&](double number) { return srgb_bytes(map.lookup(number)); };
  const auto [hr, hg, hb] = color(1);
  EXPECT_TRUE(hr > 230 && hg > 230 && hb > 230) << "hydrogen is white";
  const auto [cr, cg, cb] = color(6);
  EXPECT_TRUE(cr == cg && cg == cb && cr > 60 && cr < 180) << "carbon is grey";
  const auto [nr, ng, nb] = color(7);
  EXPECT_TRUE(nb > 200 && nr < 100 && ng < 130) << "nitrogen is blue";
  const auto [oxr, oxg, oxb] = color(8);
  EXPECT_TRUE(oxr > 200 && oxg < 60 && oxb < 60) << "oxygen is red";
  const auto [pr, pg, pb] = color(15);
  EXPECT_TRUE(pr > 220 && pg > 90 && pg < 170 && pb < 60) << "phosphorus is orange";
  const auto [sr, sg, sb] = color(16);
  EXPECT_TRUE(sr > 220 && sg > 190 && sb < 80) << "sulphur is yellow";
  const auto [clr, clg, clb] = color(17);
  EXPECT_TRUE(clg > 200 && clr < 100 && clb < 100) << "chlorine is green";

  std::set<std::tuple<float, float, float>> different;
  for (double i = 0; i < 119; ++i) {
    const Rgba c = map.lookup(i);
    different.insert({c.r, c.g, c.b});
    EXPECT_EQ(c.a, 1.0f);
  }
  EXPECT_EQ(different.size(), 119u);
  EXPECT_EQ(map.lookup(119), map.lookup(0)) << "past the last element: unknown";
}

TEST(BuiltinColormap, NoMapContainsTheColorOfBadValues) {
  const Bytes bad = srgb_bytes(Colormap::bad_value);
  for (const std::string& name : builtin_colormap_names()) {
    const Colormap& map = *builtin_colormap(name);
    for (int i = 0; i <= 1000; ++i) {
      const double value = map.kind() == ColormapKind::continuous ? i / 1000.0 : i;
      ASSERT_GT(largest_difference(srgb_bytes(map.lookup(value)), bad), 8) << name << ' ' << value;
    }
  }
}

}  // namespace
}  // namespace insitu
