#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "appearance.h"
#include "image_name.h"
#include "option_values.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <class Call>
std::string usage_error(Call call) {
  try {
    call();
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

TEST(Options, CameraKeysTakeNumbersUpToTheNextKey) {
  CameraOptions camera;
  parse_camera("eye=1,2,3,at=0,-1e1,.5,fov=40", camera);
  EXPECT_THAT(*camera.eye, ElementsAre(1, 2, 3));
  EXPECT_THAT(*camera.at, ElementsAre(0, -10, 0.5));
  EXPECT_EQ(camera.fov_deg, 40);
  EXPECT_FALSE(camera.up);
  parse_camera("fit", camera);
}

TEST(Options, WrongCamerasAreRefused) {
  const auto error = [](const std::string& text) {
    return usage_error([&] {
      CameraOptions camera;
      parse_camera(text, camera);
    });
  };
  EXPECT_THAT(error("eye=1,2"), HasSubstr("eye needs three numbers"));
  EXPECT_THAT(error("1,2,3"), HasSubstr("\"1\" has no key"));
  EXPECT_THAT(error("eye=a,2,3"), HasSubstr("\"a\" is no number"));
  EXPECT_THAT(error("zoom=2"), HasSubstr("\"zoom\" is no key"));
  EXPECT_THAT(error("fov=0"), HasSubstr("fov must be above 0"));
  EXPECT_THAT(error("fov=180"), HasSubstr("fov must be below 180"));
  EXPECT_THAT(error("at=1,2,3"), HasSubstr("at needs eye"));
  EXPECT_THAT(error("eye=1,2,3,at=1,2,3"), HasSubstr("are the same"));
  EXPECT_THAT(error(""), HasSubstr("expected fit or eye="));
}

TEST(Options, OpacityMapsAreStraightLinesBetweenPoints) {
  const std::vector<double> map = parse_opacity_map("0.25:0.2,0.5:0.4,0.5:1,1:0");
  ASSERT_EQ(map.size(), 1025u);
  EXPECT_EQ(map[0], 0.2);
  EXPECT_EQ(map[256], 0.2);
  EXPECT_DOUBLE_EQ(map[384], 0.3);
  EXPECT_EQ(map[512], 1.0);  // a step: what is behind it
  EXPECT_DOUBLE_EQ(map[768], 0.5);
  EXPECT_EQ(map[1024], 0.0);
  EXPECT_EQ(parse_opacity_map("0.7:0.5")[3], 0.5);
  for (const char* text : {"", "0.5", "0:2", "-1:0", "0:nan", "0:0:0", "0:0,", "a:1"})
    EXPECT_THAT(usage_error([text] { parse_opacity_map(text); }), HasSubstr("is no point")) << text;
  EXPECT_THAT(usage_error([] { parse_opacity_map("0.5:0,0.4:1"); }), HasSubstr("do not ascend"));
}

TEST(Options, RadiusMapsAreEvenlySpacedOverTheirValues) {
  const RadiusMap two = parse_radius_map("-1:0.5,3:2.5");
  EXPECT_THAT(two.range, testing::ElementsAre(-1.0, 3.0));
  EXPECT_THAT(two.radii, testing::ElementsAre(0.5, 2.5));
  const RadiusMap three = parse_radius_map("0:0,1:2,4:8");
  ASSERT_EQ(three.radii.size(), 1025u);
  EXPECT_EQ(three.radii[0], 0.0);
  EXPECT_DOUBLE_EQ(three.radii[128], 1.0);
  EXPECT_DOUBLE_EQ(three.radii[256], 2.0);
  EXPECT_DOUBLE_EQ(three.radii[640], 5.0);
  EXPECT_EQ(three.radii[1024], 8.0);
  for (const char* text : {"", "0.5", "0:-1", "inf:0", "0:nan", "0:0:0", "0:0,"})
    EXPECT_THAT(usage_error([text] { parse_radius_map(text); }), HasSubstr("is no point")) << text;
  EXPECT_THAT(usage_error([] { parse_radius_map("5:0,4:1"); }), HasSubstr("do not ascend"));
  EXPECT_THAT(usage_error([] { parse_radius_map("5:1"); }), HasSubstr("two values or more"));
  EXPECT_THAT(usage_error([] { parse_radius_map("5:1,5:2"); }), HasSubstr("two values or more"));
}

TEST(Options, BondsAndReplicas) {
  EXPECT_EQ(parse_bonds("auto"), 0.0);
  EXPECT_EQ(parse_bonds("1.6"), 1.6);
  for (const char* text : {"", "0", "-1", "nan", "inf", "long"})
    EXPECT_THAT(usage_error([text] { parse_bonds(text); }), HasSubstr("the longest bond")) << text;
  EXPECT_THAT(parse_replicate("3,2,1"), ElementsAre(3, 2, 1));
  for (const char* text : {"", "2", "2,2", "2,2,2,2", "0,1,1", "1,-1,1", "1,1,1.5", "1001,1,1"})
    EXPECT_THAT(usage_error([text] { parse_replicate(text); }), HasSubstr("expected NX,NY,NZ")) << text;
}

TEST(Options, ViewsAreNamesOrDirections) {
  CameraOptions camera;
  parse_view("-x", camera);
  EXPECT_THAT(camera.from, ElementsAre(-1, 0, 0));
  EXPECT_THAT(*camera.up, ElementsAre(0, 0, 1));
  camera.up.reset();
  parse_view("0,0,2", camera);
  EXPECT_THAT(*camera.up, ElementsAre(0, 1, 0));
  for (const char* text : {"w", "1,2", "0,0,0", "1,2,x", ""}) {
    EXPECT_THAT(usage_error([&] { parse_view(text, camera); }), HasSubstr("expected x, -x")) << text;
  }
}

TEST(Options, SizesAndSteps) {
  EXPECT_EQ(parse_size("1920x1080"), (std::pair<std::uint32_t, std::uint32_t>(1920, 1080)));
  for (const char* text : {"1920", "0x5", "5x-1", "1x2x3", "99999x1", "ax1"}) {
    EXPECT_THAT(usage_error([&] { parse_size(text); }), HasSubstr("expected WIDTHxHEIGHT")) << text;
  }
  const auto chosen = [](const std::string& text) {
    const StepSelection steps = parse_steps(text);
    std::vector<int> all;
    for (int i = 0; i < 12; ++i) {
      if (steps.contains(static_cast<std::uint64_t>(i))) all.push_back(i);
    }
    return all;
  };
  EXPECT_THAT(chosen("3"), ElementsAre(3));
  EXPECT_THAT(chosen("2:8:3"), ElementsAre(2, 5));
  EXPECT_THAT(chosen("::5"), ElementsAre(0, 5, 10));
  EXPECT_THAT(chosen("10:"), ElementsAre(10, 11));
  EXPECT_THAT(chosen(":2"), ElementsAre(0, 1));
  for (const char* text : {"", "a", "1:2:0", "5:5", "1:2:3:4", "-1"}) {
    EXPECT_THAT(usage_error([&] { parse_steps(text); }), HasSubstr("expected A:B:K")) << text;
  }
}

TEST(Options, ColorsAreSrgbAndBecomeLinear) {
  EXPECT_THAT(*parse_color("#ffffff"), ElementsAre(1, 1, 1));
  EXPECT_NEAR((*parse_color("#808080"))[0], 0.2159, 1e-4);
  EXPECT_TRUE(parse_color("red"));
  for (const char* text : {"#fff", "ffffff", "#gggggg", "nocolor", ""}) EXPECT_FALSE(parse_color(text)) << text;
  EXPECT_THAT(parse_background("black"), ElementsAre(0, 0, 0, 1));
  EXPECT_EQ(parse_background("transparent")[3], 0);
  EXPECT_THAT(usage_error([] { parse_background("x"); }), HasSubstr("expected #rrggbb"));
  EXPECT_THAT(parse_elements("O,h,Na"), ElementsAre(8, 1, 11));
  EXPECT_THAT(usage_error([] { parse_elements("O,Qq"); }), HasSubstr("\"Qq\" is no element"));
}

TEST(ImageName, FillsInStepAndAngle) {
  EXPECT_EQ(image_name("a_{step}.png", 42, 0), "a_42.png");
  EXPECT_EQ(image_name("a_{step:6}_{angle:3}.exr", 42, 90), "a_000042_090.exr");
  EXPECT_EQ(image_name("a_{angle:3}.png", 0, 7.5), "a_007.5.png");
  EXPECT_EQ(with_angle("a.png"), "a_{angle:3}.png");
  EXPECT_EQ(with_angle("{angle}.png"), "{angle}.png");
  EXPECT_TRUE(has_step("a_{step:2}.png"));
  EXPECT_FALSE(has_step("a.png"));
  EXPECT_TRUE(is_exr("a.EXR"));
  EXPECT_THAT(usage_error([] { check_image_pattern("a_{step:2}.png"); }), IsEmpty());
  for (const char* text : {"a_{frame}.png", "a_{step.png", "a_}.png", "a_{step:0}.png", "a_{step:99}.png"}) {
    EXPECT_THAT(usage_error([&] { check_image_pattern(text); }), HasSubstr("is no key, expected {step}")) << text;
  }
  for (const char* text : {"a.jpg", "a", ".png", ""}) {
    EXPECT_THAT(usage_error([&] { check_image_pattern(text); }), HasSubstr("ends in .png or .exr")) << text;
  }
}

class Appearance : public ::testing::Test {
 protected:
  Appearance() {
    frame_.position = {0, 0, 0, 1, 0, 0};
    frame_.add("q").values() = {-1, 1};
    frame_.add("velocity", 3).values() = {1, 2, 3, 4, 5, 6};
  }
  void add_element() { frame_.add("element", 1, true).values() = {1, 8}; }
  void add_type() { frame_.add("type", 1, true).values() = {1, 2}; }

  Frame frame_;
  Options options_;
};

TEST_F(Appearance, ColorsByElementThenByTypeThenUniform) {
  EXPECT_EQ(choose_color(frame_, options_).attribute, "");
  add_type();
  EXPECT_EQ(choose_color(frame_, options_).attribute, "type");
  EXPECT_EQ(choose_color(frame_, options_).colormap, "categorical");
  add_element();
  EXPECT_EQ(choose_color(frame_, options_).attribute, "element");
  EXPECT_EQ(choose_color(frame_, options_).colormap, "elements");
}

TEST_F(Appearance, ColorsAsAskedFor) {
  options_.color = "q";
  EXPECT_EQ(choose_color(frame_, options_).colormap, "viridis");
  options_.colormap = "coolwarm";
  EXPECT_EQ(choose_color(frame_, options_).colormap, "coolwarm");
  options_.color = "velocity.y";
  EXPECT_EQ(choose_color(frame_, options_).attribute, "velocity");
  EXPECT_EQ(choose_color(frame_, options_).component, 2u);
  options_.color = "#ff0000";
  EXPECT_EQ(choose_color(frame_, options_).attribute, "");
  EXPECT_THAT(choose_color(frame_, options_).color, ElementsAre(1, 0, 0));
}

TEST_F(Appearance, UnknownNamesListTheValidOnes) {
  for (const char* name : {"speeed", "velocity.w", "q.9", "q.x.y"}) {
    options_.color = name;
    EXPECT_THAT(usage_error([&] { choose_color(frame_, options_); }), HasSubstr("expected one of q, velocity")) << name;
  }
  options_.radius = "size";
  EXPECT_THAT(usage_error([&] { choose_radius(frame_, options_); }), HasSubstr("expected one of q, velocity"));
  options_.radius = "vdw";
  EXPECT_THAT(usage_error([&] { choose_radius(frame_, options_); }), HasSubstr("the file names no elements"));
  options_.radius = "-1";
  EXPECT_THAT(usage_error([&] { choose_radius(frame_, options_); }), HasSubstr("expected a length above 0"));
}

TEST_F(Appearance, RadiiComeFromTheFileThenFromTheElement) {
  EXPECT_THAT(choose_radius(frame_, options_).per_particle, IsEmpty());
  EXPECT_EQ(choose_radius(frame_, options_).for_all, 0);
  add_element();
  EXPECT_THAT(choose_radius(frame_, options_).per_particle, ElementsAre(1.2f, 1.52f));
  frame_.add("radius").values() = {5, 6};
  EXPECT_THAT(choose_radius(frame_, options_).per_particle, ElementsAre(5, 6));
  options_.radius = "vdw";
  EXPECT_THAT(choose_radius(frame_, options_).per_particle, ElementsAre(1.2f, 1.52f));
  options_.radius = "q";
  EXPECT_THAT(choose_radius(frame_, options_).per_particle, ElementsAre(-1, 1));
  options_.radius = "0.5";
  EXPECT_EQ(choose_radius(frame_, options_).for_all, 0.5);
  options_.radius = "auto";
  EXPECT_EQ(choose_radius(frame_, options_).for_all, 0);
}

TEST_F(Appearance, NothingIsExpectedOfAFrameWithoutParticles) {
  options_.color = "missing";
  options_.radius = "missing";
  EXPECT_EQ(choose_color(Frame(), options_).attribute, "");
  EXPECT_THAT(choose_radius(Frame(), options_).per_particle, IsEmpty());
}

TEST(Frame, TypesMayBeGivenElements) {
  Frame frame;
  frame.position.resize(9);
  frame.add("type").values() = {2, 1, 7};
  assign_elements(frame, {8, 1});
  EXPECT_THAT(frame.find("element")->values(), ElementsAre(1, 8, 0));
}

}  // namespace
}  // namespace replay::test
