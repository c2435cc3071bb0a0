// Cameras: what the fit leaves in the image, turning, and where rays go.
#include "scene/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

#include "core/error.h"
#include "unit/kernels/counter_random.h"

namespace insitu::testing {
namespace {

// Where a point appears: -1 to 1 from the left to the right border and from the lower to the upper one. Written from
// the definition of the cameras, not from their code.
glm::dvec2 projected(const Camera& camera, double aspect, const glm::dvec3& point) {
  const glm::dvec3 ahead = glm::normalize(camera.look_at - camera.eye);
  const glm::dvec3 side = glm::normalize(glm::cross(ahead, camera.up));
  const glm::dvec3 top = glm::cross(side, ahead);
  const glm::dvec3 offset = point - camera.eye;
  constexpr double pi = 3.14159265358979323846;
  const bool perspective = camera.kind == INSITU_CAMERA_PERSPECTIVE;
  const double depth = glm::dot(offset, ahead);
  EXPECT_GT(depth, 0.0) << "behind the camera";
  const double half = perspective ? depth * std::tan(camera.fov_y_deg * pi / 360.0) : 0.5 * camera.height;
  return {glm::dot(offset, side) / (half * aspect), glm::dot(offset, top) / half};
}

glm::dvec3 corner(const Bounds& bounds, int i) {
  return {(i & 1) != 0 ? bounds.upper.x : bounds.lower.x, (i & 2) != 0 ? bounds.upper.y : bounds.lower.y,
          (i & 4) != 0 ? bounds.upper.z : bounds.lower.z};
}

Camera random_camera(CounterRandom& random, std::uint32_t kind) {
  Camera camera;
  camera.kind = kind;
  double direction[3];
  random.direction(direction);
  camera.look_at = {0.0, 0.0, 0.0};
  camera.eye = {direction[0], direction[1], direction[2]};
  random.direction(direction);
  camera.up = {direction[0], direction[1], direction[2]};
  camera.fov_y_deg = random.between(5.0, 120.0);
  return camera;
}

class EveryKind : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(EveryKind, FitShowsEverythingAndWastesLittle) {
  int limited = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    CounterRandom random(seed);
    Camera camera = random_camera(random, GetParam());
    if (glm::length(glm::cross(camera.up, camera.eye)) < 0.05) continue;
    const double size = random.magnitude(-6.0, 6.0);
    Bounds bounds;
    for (int c = 0; c < 3; ++c) {
      // Flat boxes as well, in one or two directions.
      const double half = seed % 5 == static_cast<std::uint64_t>(c) ? 0.0 : size * random.unit();
      const double at = size * random.between(-10.0, 10.0);
      bounds.lower[c] = at - half;
      bounds.upper[c] = at + half;
    }
    const double aspect = random.magnitude(-2.0, 2.0);
    fit_camera(camera, bounds, aspect);
    double largest = 0.0;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec2 at = projected(camera, aspect, corner(bounds, i));
      largest = std::max({largest, std::abs(at.x), std::abs(at.y)});
    }
    EXPECT_LE(largest, 1.0) << "seed " << seed;
    // Boxes that are deep and thin end at the camera, which stays a little outside of them.
    const glm::dvec3 ahead = glm::normalize(camera.look_at - camera.eye);
    double nearest = std::numeric_limits<double>::infinity();
    double farthest = 0.0;
    for (int i = 0; i < 8; ++i) {
      const double depth = glm::dot(corner(bounds, i) - camera.eye, ahead);
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
    const bool at_the_box = GetParam() == INSITU_CAMERA_PERSPECTIVE && nearest <= 0.0201 * (farthest - nearest);
    limited += at_the_box ? 1 : 0;
    EXPECT_TRUE(largest >= 0.9 || at_the_box) << "seed " << seed << ": only " << largest << " of the image is used";
    EXPECT_NEAR(glm::length(camera.look_at - bounds.centre()), 0.0, 1e-12 * size);
  }
  EXPECT_LT(limited, 100);
}

TEST_P(EveryKind, FitKeepsTheDirection) {
  CounterRandom random(1);
  Camera camera = random_camera(random, GetParam());
  const glm::dvec3 before = camera.forward();
  const Bounds bounds{{100.0, 200.0, 300.0}, {101.0, 203.0, 300.5}};
  fit_camera(camera, bounds, 1.5);
  EXPECT_LT(glm::length(camera.forward() - before), 1e-12);
  const Camera fitted = camera;
  fit_camera(camera, Bounds{}, 1.5);
  EXPECT_EQ(camera.eye, fitted.eye) << "nothing to fit, nothing moves";
}

TEST_P(EveryKind, AFullTurnIsNone) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CounterRandom random(seed + 10000);
    Camera camera = random_camera(random, GetParam());
    camera.look_at = {3.0, -2.0, 1.0};
    camera.eye = camera.look_at + camera.eye * 5.0;
    const Camera before = camera;
    turn_camera(camera, 360.0);
    EXPECT_LT(glm::length(camera.eye - before.eye), 1e-12 * 10.0) << seed;
    for (int i = 0; i < 36; ++i) turn_camera(camera, 10.0);
    EXPECT_LT(glm::length(camera.eye - before.eye), 1e-12 * 10.0) << seed;
    EXPECT_EQ(camera.look_at, before.look_at);
    turn_camera(camera, 90.0);
    EXPECT_NEAR(glm::length(camera.eye - camera.look_at), 5.0, 1e-12);
  }
}

TEST_P(EveryKind, AxesAreRightAngled) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    CounterRandom random(seed + 20000);
    Camera camera = random_camera(random, GetParam());
    camera.eye = camera.eye * random.magnitude(-150.0, 150.0);
    camera.up = camera.up * random.magnitude(-150.0, 150.0);
    const glm::dvec3 axes[3] = {camera.right(), camera.true_up(), camera.forward()};
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(glm::length(axes[i]), 1.0, 1e-12) << seed;
      EXPECT_NEAR(glm::dot(axes[i], axes[(i + 1) % 3]), 0.0, 1e-9) << seed;
    }
    EXPECT_NEAR(glm::dot(glm::cross(axes[0], axes[1]), -axes[2]), 1.0, 1e-9) << "right-handed, looking along -z";
  }
}

TEST_P(EveryKind, LookingAlongUpHasAnImage) {
  for (const glm::dvec3& up : {glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0)}) {
    for (const double sign : {-1.0, 1.0}) {
      Camera camera;
      camera.kind = GetParam();
      camera.up = up;
      camera.eye = up * sign;
      camera.look_at = {};
      EXPECT_NEAR(glm::length(camera.right()), 1.0, 1e-12);
      EXPECT_NEAR(glm::dot(camera.right(), camera.forward()), 0.0, 1e-12);
    }
  }
}

TEST_P(EveryKind, RaysGoThroughTheCorners) {
  CounterRandom random(3);
  for (int i = 0; i < 100; ++i) {
    Camera camera = random_camera(random, GetParam());
    camera.height = 4.0;
    const double aspect = random.magnitude(-1.0, 1.0);
    const CameraRays rays(camera, aspect);
    for (const double x : {0.0, 0.25, 1.0}) {
      for (const double y : {0.0, 0.75, 1.0}) {
        glm::dvec3 origin;
        glm::dvec3 direction;
        rays.ray(x, y, origin, direction);
        EXPECT_NEAR(glm::length(direction), 1.0, 1e-15);
        const glm::dvec2 at = projected(camera, aspect, origin + 7.0 * direction);
        EXPECT_NEAR(at.x, 2.0 * x - 1.0, 1e-9);
        EXPECT_NEAR(at.y, 1.0 - 2.0 * y, 1e-9);
        if (GetParam() == INSITU_CAMERA_PERSPECTIVE) {
          EXPECT_EQ(origin, camera.eye);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryKind, ::testing::Values(INSITU_CAMERA_PERSPECTIVE, INSITU_CAMERA_ORTHOGRAPHIC),
                         [](const auto& info) { return info.param == 0 ? "perspective" : "orthographic"; });

insitu_camera described() {
  insitu_camera camera;
  insitu_camera_init(&camera);
  camera.eye[2] = 5.0;
  return camera;
}

TEST(MakeCamera, FillsInDefaults) {
  insitu_camera description;
  insitu_camera_init(&description);
  const Camera camera = make_camera(description);
  EXPECT_EQ(camera.fov_y_deg, 35.0);
  EXPECT_EQ(camera.forward(), glm::dvec3(0.0, 0.0, -1.0));
  EXPECT_EQ(camera.true_up(), glm::dvec3(0.0, 1.0, 0.0));
}

TEST(MakeCamera, AndDescribeCameraAreInverse) {
  insitu_camera description = described();
  description.kind = INSITU_CAMERA_ORTHOGRAPHIC;
  description.look_at[0] = 1.0;
  description.up[2] = 1.0;
  description.height = 12.0;
  description.near_clip = 0.5;
  description.far_clip = 20.0;
  description.fov_y_deg = 50.0;
  const insitu_camera again = describe_camera(make_camera(description));
  EXPECT_EQ(std::memcmp(&again, &description, sizeof again), 0);
}

TEST(MakeCamera, RefusesWhatCannotBeMeant) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](const insitu_camera& camera) {
    try {
      make_camera(camera);
      return false;
    } catch (const Error& error) {
      return error.status() == INSITU_ERROR_INVALID_ARGUMENT;
    }
  };
  EXPECT_FALSE(refused(described()));
  for (const double bad : {nan, infinity, -infinity}) {
    for (int c = 0; c < 3; ++c) {
      insitu_camera camera = described();
      camera.eye[c] = bad;
      EXPECT_TRUE(refused(camera));
      camera = described();
      camera.look_at[c] = bad;
      EXPECT_TRUE(refused(camera));
      camera = described();
      camera.up[c] = bad;
      EXPECT_TRUE(refused(camera));
    }
  }
  for (const double bad : {nan, -1.0, 180.0, 400.0}) {
    insitu_camera camera = described();
    camera.fov_y_deg = bad;
    EXPECT_TRUE(refused(camera)) << bad;
  }
  for (const double bad : {nan, infinity, -1.0}) {
    insitu_camera camera = described();
    camera.height = bad;
    EXPECT_TRUE(refused(camera)) << bad;
    camera = described();
    camera.near_clip = bad;
    EXPECT_TRUE(refused(camera)) << bad;
  }
  for (const double bad : {nan, -1.0, 1.0, 2.0}) {
    insitu_camera camera = described();
    camera.near_clip = 2.0;
    camera.far_clip = bad;
    EXPECT_TRUE(refused(camera)) << bad;
  }
  insitu_camera camera = described();
  camera.kind = 2;
  EXPECT_TRUE(refused(camera));
}

TEST(Bounds, IncludeAndMeasure) {
  Bounds bounds;
  EXPECT_TRUE(bounds.empty());
  EXPECT_EQ(bounds.diagonal(), 0.0);
  bounds.include(Bounds{});
  EXPECT_TRUE(bounds.empty());
  bounds.include({{0, 0, 0}, {1, 2, 2}});
  EXPECT_EQ(bounds.diagonal(), 3.0);
  bounds.include(Bounds{});
  EXPECT_EQ(bounds.diagonal(), 3.0);
  bounds.include({{-3, 0, 0}, {-2, 0, 0}});
  EXPECT_EQ(bounds.lower.x, -3.0);
  EXPECT_EQ(bounds.upper.x, 1.0);
  EXPECT_EQ(bounds.centre(), glm::dvec3(-1.0, 1.0, 1.0));
}

}  // namespace
}  // namespace insitu::testing
