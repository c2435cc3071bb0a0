#include "scene/light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/error.h"

namespace insitu {
namespace {

insitu_light directional(double x, double y, double z) {
  insitu_light light;
  insitu_light_init(&light);
  light.kind = INSITU_LIGHT_DIRECTIONAL;
  light.direction[0] = x;
  light.direction[1] = y;
  light.direction[2] = z;
  return light;
}

bool refused(const insitu_light& light) {
  try {
    make_light(light);
    return false;
  } catch (const Error& error) {
    return error.status() == INSITU_ERROR_INVALID_ARGUMENT;
  }
}

TEST(Light, ZerosAreWhiteAndOne) {
  insitu_light description;
  insitu_light_init(&description);
  const Light ambient = make_light(description);
  EXPECT_FALSE(ambient.directional);
  EXPECT_EQ(ambient.radiance, glm::dvec3(1.0));
}

TEST(Light, RadianceIsColourTimesIntensity) {
  insitu_light description = directional(0.0, 0.0, -1.0);
  description.color[0] = 0.5;
  description.color[2] = 0.25;
  description.intensity = 3.0;
  EXPECT_EQ(make_light(description).radiance, glm::dvec3(1.5, 0.0, 0.75));
}

TEST(Light, TowardsIsAgainstTheDirection) {
  const Light light = make_light(directional(0.0, -3.0, 4.0));
  EXPECT_NEAR(glm::length(light.towards - glm::dvec3(0.0, 0.6, -0.8)), 0.0, 1e-15);
}

// Any finite direction is one, whatever its length.
TEST(Light, DirectionsOfAnyLengthCount) {
  for (const double length : {1e-300, 1e-170, 1e-9, 1e9, 1e170, 1e300}) {
    const insitu_light description = directional(length, 0.0, -length);
    ASSERT_FALSE(refused(description)) << length;
    const Light light = make_light(description);
    EXPECT_NEAR(glm::length(light.towards - glm::dvec3(-std::sqrt(0.5), 0.0, std::sqrt(0.5))), 0.0, 1e-12) << length;
  }
}

TEST(Light, InCameraSpaceTurnsWithTheCamera) {
  insitu_light description = directional(0.0, 0.0, 1.0);  // forward: from the camera onto the scene
  description.flags = INSITU_LIGHT_IN_CAMERA_SPACE;
  const Light light = make_light(description);
  Camera camera;
  camera.eye = {10.0, 0.0, 0.0};
  camera.look_at = {0.0, 0.0, 0.0};
  EXPECT_NEAR(glm::length(direction_to(light, camera) - glm::dvec3(1.0, 0.0, 0.0)), 0.0, 1e-15);
  turn_camera(camera, 90.0);
  EXPECT_NEAR(glm::length(direction_to(light, camera) - glm::normalize(camera.eye)), 0.0, 1e-12);
  insitu_light from_the_right = directional(-1.0, 0.0, 0.0);
  from_the_right.flags = INSITU_LIGHT_IN_CAMERA_SPACE;
  EXPECT_NEAR(glm::length(direction_to(make_light(from_the_right), camera) - camera.right()), 0.0, 1e-15);
  insitu_light in_world = directional(-1.0, 0.0, 0.0);
  EXPECT_EQ(direction_to(make_light(in_world), camera), glm::dvec3(1.0, 0.0, 0.0));
}

TEST(Light, RefusesWhatCannotBeMeant) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refused(directional(0.0, 0.0, 0.0)));
  EXPECT_TRUE(refused(directional(nan, 0.0, 1.0)));
  EXPECT_TRUE(refused(directional(infinity, 0.0, 1.0)));
  for (const double bad : {nan, infinity, -1.0}) {
    insitu_light light = directional(0.0, 0.0, 1.0);
    light.color[1] = bad;
    EXPECT_TRUE(refused(light)) << bad;
    light = directional(0.0, 0.0, 1.0);
    light.intensity = bad;
    EXPECT_TRUE(refused(light)) << bad;
  }
  insitu_light light = directional(0.0, 0.0, 1.0);
  light.kind = 7;
  EXPECT_TRUE(refused(light));
}

TEST(Light, DefaultsAreOneOfEach) {
  const std::vector<Light> lights = default_lights();
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_FALSE(lights[0].directional);
  EXPECT_TRUE(lights[1].directional);
  EXPECT_TRUE(lights[1].in_camera_space);
  EXPECT_NEAR(glm::length(lights[1].towards), 1.0, 1e-15);
  // From above, the left and behind the camera.
  EXPECT_LT(lights[1].towards.x, 0.0);
  EXPECT_GT(lights[1].towards.y, 0.0);
  EXPECT_LT(lights[1].towards.z, 0.0);
}

}  // namespace
}  // namespace insitu
