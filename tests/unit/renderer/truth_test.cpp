// Pictures against closed forms: light on a sphere, the edge of a shadow, depths, and the share of the sky that is
// seen.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "unit/renderer/scenes.h"

namespace insitu::testing {
namespace {

constexpr std::uint32_t size_px = 128;

TEST(Lambert, OnASphereSeenFromFarAway) {
  const SphereScene scene({{{{0.0, 0.0, 0.0}, 1.0}}}, {0.5f, 0.25f, 1.0f, 1.0f});
  RenderSettings settings = orthographic(2.2);
  const glm::dvec3 towards = glm::normalize(glm::dvec3(0.3, 0.7, 0.5));
  settings.lights = {ambient_light(0.25), light_towards(towards, 0.75)};
  const Picture picture = render(scene.scene(), settings, size_px, size_px);
  std::size_t inside = 0;
  for (std::uint32_t y = 0; y < size_px; ++y) {
    for (std::uint32_t x = 0; x < size_px; ++x) {
      const glm::dvec3 place = pixel_place(x, y, size_px, size_px, 2.2);
      const double height2 = 1.0 - place.x * place.x - place.y * place.y;
      if (height2 < 0.0) {
        EXPECT_EQ(picture.color(x, y), glm::dvec3(0.0));
        EXPECT_EQ(picture.frame.item[picture.at(x, y)], FrameBuffer::no_item);
        continue;
      }
      ++inside;
      const glm::dvec3 normal(place.x, place.y, std::sqrt(height2));
      const double light = 0.25 + 0.75 * std::max(0.0, glm::dot(normal, towards));
      const glm::dvec3 expected = glm::dvec3(0.5, 0.25, 1.0) * light;
      EXPECT_LT(glm::length(picture.color(x, y) - expected), 2e-7) << x << ' ' << y;
      EXPECT_EQ(picture.alpha(x, y), 1.0);
    }
  }
  EXPECT_NEAR(static_cast<double>(inside) / (size_px * size_px), std::numbers::pi / (2.2 * 2.2), 0.005);
}

TEST(Lambert, OfSeveralLightsAddsUp) {
  const SphereScene scene({{{{0.0, 0.0, 0.0}, 1.0}}});
  RenderSettings settings = orthographic(2.2);
  const std::vector<Light> lights = {light_towards({1, 0, 0.2}, 0.3), light_towards({0, 1, 0.2}, 0.4),
                                     ambient_light(0.1), ambient_light(0.05)};
  settings.lights = lights;
  const Picture all = render(scene.scene(), settings, size_px, size_px);
  std::vector<Picture> single;
  for (const Light& light : lights) {
    settings.lights = {light};
    single.push_back(render(scene.scene(), settings, size_px, size_px));
  }
  for (std::uint32_t y = 0; y < size_px; ++y) {
    for (std::uint32_t x = 0; x < size_px; ++x) {
      glm::dvec3 sum(0.0);
      for (const Picture& picture : single) sum += picture.color(x, y);
      EXPECT_LT(glm::length(all.color(x, y) - sum), 3e-7);
    }
  }
}

// Depth, place and normal of both cameras, from the geometry of the sphere.
TEST(Channels, AreThoseOfTheSphere) {
  const glm::dvec3 centre(0.25, -0.5, -3.0);
  constexpr double radius = 1.5;
  const SphereScene scene({{{centre, radius}}});
  RenderSettings settings = orthographic(5.0);
  settings.lights = {ambient_light(1.0)};
  for (const std::uint32_t kind : {INSITU_CAMERA_ORTHOGRAPHIC, INSITU_CAMERA_PERSPECTIVE}) {
    settings.camera.kind = kind;
    settings.camera.fov_y_deg = 30.0;
    const Picture picture = render(scene.scene(), settings, size_px, size_px);
    std::size_t inside = 0;
    for (std::uint32_t y = 0; y < size_px; ++y) {
      for (std::uint32_t x = 0; x < size_px; ++x) {
        glm::dvec3 origin = settings.camera.eye;
        glm::dvec3 direction(0.0, 0.0, -1.0);
        if (kind == INSITU_CAMERA_PERSPECTIVE) {
          const double half = std::tan(15.0 * std::numbers::pi / 180.0);
          direction = glm::normalize(pixel_place(x, y, size_px, size_px, 2.0 * half) + direction);
        } else {
          origin += pixel_place(x, y, size_px, size_px, 5.0);
        }
        // The distance by the law of cosines.
        const glm::dvec3 to_centre = centre - origin;
        const double along = glm::dot(to_centre, direction);
        const double under_root = radius * radius - glm::dot(to_centre, to_centre) + along * along;
        const std::size_t at = picture.at(x, y);
        if (std::abs(under_root) < 1e-6) continue;
        if (under_root < 0.0) {
          EXPECT_EQ(picture.frame.depth[at], std::numeric_limits<float>::infinity());
          continue;
        }
        ++inside;
        const double depth = along - std::sqrt(under_root);
        const glm::dvec3 point = origin + depth * direction;
        EXPECT_NEAR(picture.frame.depth[at], depth, 1e-6 * depth);
        EXPECT_EQ(picture.frame.item[at], 0u);
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(picture.frame.position[3 * at + static_cast<std::size_t>(c)], point[c], 1e-6);
          EXPECT_NEAR(picture.frame.normal[3 * at + static_cast<std::size_t>(c)], (point[c] - centre[c]) / radius,
                      1e-6);
        }
      }
    }
    EXPECT_GT(inside, 1000u);
  }
}

TEST(Clipping, CutsNearAndFar) {
  const SphereScene scene({{{{0.0, 0.0, 0.0}, 1.0}}});
  RenderSettings settings = orthographic(0.01);  // all pixels at the pole
  settings.lights = {ambient_light(1.0)};
  const auto depth = [&](double near_clip, double far_clip) {
    settings.camera.near_clip = near_clip;
    settings.camera.far_clip = far_clip;
    return render(scene.scene(), settings, 1, 1).frame.depth[0];
  };
  EXPECT_FLOAT_EQ(depth(0.0, 0.0), 9.0f);
  EXPECT_FLOAT_EQ(depth(8.9, 0.0), 9.0f);
  EXPECT_FLOAT_EQ(depth(9.5, 0.0), 11.0f);  // the inside of the far half
  EXPECT_FLOAT_EQ(depth(0.0, 9.1), 9.0f);
  EXPECT_EQ(depth(0.0, 8.9), std::numeric_limits<float>::infinity());
  EXPECT_EQ(depth(11.5, 0.0), std::numeric_limits<float>::infinity());
}

// A small sphere above a large one: a point is in shadow when its line to the light passes through the small one.
TEST(Shadow, OfASphereOnASphereIsExact) {
  const glm::dvec3 ground(0.0, 0.0, -20.0);
  constexpr double ground_radius = 20.0;
  const glm::dvec3 ball(0.6, 0.4, 1.5);
  constexpr double ball_radius = 0.5;
  const glm::dvec3 towards = glm::normalize(glm::dvec3(0.5, 0.3, 1.0));
  RenderSettings settings = orthographic(5.0);
  settings.lights = {light_towards(towards, 1.0)};
  settings.effects.shadows = true;
  for (const bool two_sets : {false, true}) {
    const SphereScene scene(two_sets
                                ? std::vector<std::vector<Sphere>>{{{ground, ground_radius}}, {{ball, ball_radius}}}
                                : std::vector<std::vector<Sphere>>{{{ground, ground_radius}, {ball, ball_radius}}});
    const Picture picture = render(scene.scene(), settings, 256, 256);
    std::size_t lit = 0;
    std::size_t dark = 0;
    for (std::uint32_t y = 0; y < 256; ++y) {
      for (std::uint32_t x = 0; x < 256; ++x) {
        const glm::dvec3 place = pixel_place(x, y, 256, 256, 5.0);
        if (glm::length(glm::dvec3(place.x - ball.x, place.y - ball.y, 0.0)) < ball_radius + 1e-9) continue;
        const double z = ground.z + std::sqrt(ground_radius * ground_radius - place.x * place.x - place.y * place.y);
        const glm::dvec3 point(place.x, place.y, z);
        const double off = glm::length(glm::cross(ball - point, towards));
        if (std::abs(off - ball_radius) < 1e-9) continue;  // on the edge itself
        const bool in_shadow = off < ball_radius && glm::dot(ball - point, towards) > 0.0;
        (in_shadow ? dark : lit) += 1;
        const double expected = in_shadow ? 0.0 : std::max(0.0, glm::dot((point - ground) / ground_radius, towards));
        ASSERT_NEAR(picture.color(x, y).x, expected, 1e-6) << x << ' ' << y;
      }
    }
    EXPECT_GT(dark, 1000u);
    EXPECT_GT(lit, 10000u);
  }
}

// The cosine-weighted share of the sky that the only other sphere covers, for a point of a sphere so large that it is a
// plane. With d the distance of the centre, sin(a) = r / d and the angle b between the normal and the centre:
//   above the horizon   cos(b) sin^2(a)
//   cut in half by it   (a - sin(a) cos(a)) / pi
struct Sky {
  const char* what;
  double angle_deg;  // b
  double sine;       // sin(a)
};

TEST(AmbientOcclusion, SeesTheShareOfTheSkyThatIsOpen) {
  const Sky skies[] = {{"overhead, small", 0.0, 0.1},    {"overhead, large", 0.0, 0.9},
                       {"slanted", 40.0, 0.5},           {"low", 70.0, 0.3},
                       {"half, small", 90.0, 0.3},       {"half, large", 90.0, 0.95},
                       {"half, nearly all", 90.0, 0.999}};
  constexpr double plane_radius = 1e7;
  for (const Sky& sky : skies) {
    const double b = sky.angle_deg * std::numbers::pi / 180.0;
    const double a = std::asin(sky.sine);
    const double covered =
        sky.angle_deg < 90.0 ? std::cos(b) * sky.sine * sky.sine : (a - std::sin(a) * std::cos(a)) / std::numbers::pi;
    // The point of the plane under the camera is the origin; the camera stands below the other sphere.
    const double distance = 10.0;
    const glm::dvec3 centre = distance * glm::dvec3(std::sin(b), 0.0, std::cos(b));
    const SphereScene scene({{{{0.0, 0.0, -plane_radius}, plane_radius}, {centre, sky.sine * distance}}});
    RenderSettings settings = orthographic(1e-9);
    settings.camera.eye = {0.0, 0.0, 1e-3};
    settings.lights = {ambient_light(1.0)};
    settings.effects.ambient_occlusion = true;
    settings.effects.ao_samples = 65536;
    settings.effects.ao_radius = 1e6;
    const Picture picture = render(scene.scene(), settings, 1, 1);
    ASSERT_NEAR(picture.frame.depth[0], 1e-3, 1e-6) << sky.what;
    const double open = picture.color(0, 0).x;
    const double sigma = std::sqrt(covered * (1.0 - covered) / 65536.0);
    // The sequence is evenly spread: five standard deviations of random numbers are far more than it may need.
    EXPECT_NEAR(open, 1.0 - covered, 5.0 * sigma) << sky.what;
    std::cout << sky.what << ": covered " << covered << ", found " << 1.0 - open << '\n';
  }
}

// With the samples of random pixels: the mean over many noisy pixels meets the truth in a z-test.
TEST(AmbientOcclusion, FewSamplesAreRightOnAverage) {
  const SphereScene scene({{{{0.0, 0.0, -1e7}, 1e7}, {{5.0, 0.0, 5.0}, 4.0}}});
  RenderSettings settings = orthographic(1e-6);
  settings.camera.eye = {0.0, 0.0, 1e-3};
  settings.lights = {ambient_light(1.0)};
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 4;
  settings.effects.ao_radius = 1e6;
  const double covered = std::sqrt(0.5) * 16.0 / 50.0;
  for (const std::uint32_t seed : {0u, 1u, 12345u}) {
    settings.effects.seed = seed;
    const Picture picture = render(scene.scene(), settings, 64, 64);
    double sum = 0.0;
    double squares = 0.0;
    for (std::uint32_t i = 0; i < 64 * 64; ++i) {
      const double open = picture.color(i % 64, i / 64).x;
      sum += open;
      squares += open * open;
    }
    const double n = 64.0 * 64.0;
    const double mean = sum / n;
    const double sigma = std::sqrt((squares / n - mean * mean) / n);
    EXPECT_GT(sigma, 0.0) << "pixels share their samples";
    EXPECT_LT(std::abs(mean - (1.0 - covered)), 4.0 * sigma) << "seed " << seed;
  }
}

// Spheres that touch: the point of contact is dark, the far side open.
TEST(AmbientOcclusion, GrowsTowardsAContact) {
  const SphereScene scene({{{{0.0, 0.0, 0.0}, 1.0}, {{2.0, 0.0, 0.0}, 1.0}}});
  RenderSettings settings = orthographic(2.0);
  settings.lights = {ambient_light(1.0)};
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 256;
  settings.effects.ao_radius = 100.0;
  const Picture picture = render(scene.scene(), settings, 64, 64);
  const auto open = [&](std::uint32_t x) { return picture.color(x, 32).x; };
  EXPECT_GT(open(32), 0.9);
  EXPECT_LT(open(63), 0.6);
  EXPECT_GT(open(40), open(50));
  EXPECT_GT(open(50), open(60));
  // A point turned away from the other sphere sees the whole sky: no sample may be wrong.
  EXPECT_EQ(open(4), 1.0);
}

}  // namespace
}  // namespace insitu::testing
