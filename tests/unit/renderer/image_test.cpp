// Pixels: sizes that are no multiple of a tile, several samples, backgrounds.
#include <gtest/gtest.h>

#include <cmath>

#include "kernels/pkd_traverse.h"
#include "renderer/sampling.h"
#include "unit/kernels/simd_guard.h"
#include "unit/kernels/test_tree.h"
#include "unit/renderer/scenes.h"

namespace insitu::testing {
namespace {

std::vector<Sphere> cloud() {
  CounterRandom random(77);
  const std::vector<double> x = make_cloud(Shape::uniform, 400, 2.0, random);
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < 400; ++i)
    spheres.push_back({{x[3 * i], x[3 * i + 1], x[3 * i + 2]}, random.between(0.02, 0.12)});
  return spheres;
}

RenderSettings lit(double height) {
  RenderSettings settings = orthographic(height);
  settings.lights = {ambient_light(0.4), light_towards({0.5, 1.0, 1.0}, 0.6)};
  return settings;
}

struct Size {
  std::uint32_t width;
  std::uint32_t height;
};

// Every pixel is that of a picture of this pixel alone: tiles and their borders leave no trace.
TEST(Image, EveryPixelIsItsOwnCrop) {
  const SphereScene scene({cloud()});
  for (const Size size : {Size{1, 1}, Size{3, 5}, Size{16, 16}, Size{17, 33}, Size{33, 17}}) {
    constexpr double pixel = 0.0625;
    const Picture whole = render(scene.scene(), lit(pixel * size.height), size.width, size.height);
    std::size_t hits = 0;
    for (std::uint32_t y = 0; y < size.height; ++y) {
      for (std::uint32_t x = 0; x < size.width; ++x) {
        RenderSettings one = lit(pixel);
        const glm::dvec3 shift = pixel_place(x, y, size.width, size.height, pixel * size.height);
        one.camera.eye += shift;
        one.camera.look_at += shift;
        const Picture crop = render(scene.scene(), one, 1, 1, 1);
        const std::size_t at = whole.at(x, y);
        ASSERT_EQ(whole.frame.item[at], crop.frame.item[0]) << x << ' ' << y;
        if (whole.frame.item[at] == FrameBuffer::no_item) continue;
        ++hits;
        ASSERT_NEAR(whole.frame.depth[at], crop.frame.depth[0], 1e-5) << x << ' ' << y;
        ASSERT_LT(glm::length(whole.color(x, y) - crop.color(0, 0)), 1e-5) << x << ' ' << y;
      }
    }
    if (size.width * size.height > 100) {
      EXPECT_GT(hits, 100u);
    }
  }
}

TEST(Image, SamplesAreAveraged) {
  const SphereScene scene({cloud()});
  constexpr std::uint32_t samples = 5;
  RenderSettings settings = lit(2.0);
  settings.samples_per_pixel = samples;
  const Picture together = render(scene.scene(), settings, 40, 30);
  std::vector<glm::dvec3> sum(40 * 30, glm::dvec3(0.0));
  Picture first;
  for (std::uint32_t k = 0; k < samples; ++k) {
    // Moving the camera by the place of the sample within the pixel puts it in the middle.
    RenderSettings one = lit(2.0);
    const glm::dvec2 within = r2_point(k) - 0.5;
    const glm::dvec3 shift(within.x * 2.0 / 30.0, -within.y * 2.0 / 30.0, 0.0);
    one.camera.eye += shift;
    one.camera.look_at += shift;
    const Picture single = render(scene.scene(), one, 40, 30);
    if (k == 0) first = single;
    for (std::uint32_t i = 0; i < 40 * 30; ++i) sum[i] += single.color(i % 40, i / 40);
  }
  std::size_t mixed = 0;
  for (std::uint32_t i = 0; i < 40 * 30; ++i) {
    const glm::dvec3 mean = sum[i] / static_cast<double>(samples);
    EXPECT_LT(glm::length(together.color(i % 40, i / 40) - mean), 1e-5) << i;
    mixed += glm::length(mean - first.color(i % 40, i / 40)) > 0.01 ? 1 : 0;
  }
  EXPECT_GT(mixed, 100u) << "every sample is the same";
  // Depth and the like have no average: they are those of the sample in the middle.
  EXPECT_EQ(together.frame.depth, first.frame.depth);
  EXPECT_EQ(together.frame.item, first.frame.item);
}

TEST(Image, BackgroundsArePremultiplied) {
  const SphereScene scene({{{{0.0, 0.0, 0.0}, 0.47}}});
  RenderSettings settings = lit(2.0);
  settings.background = {0.5, 0.25, 1.0, 0.5};
  const Picture picture = render(scene.scene(), settings, 32, 32);
  EXPECT_EQ(picture.color(0, 0), glm::dvec3(0.25, 0.125, 0.5));
  EXPECT_EQ(picture.alpha(0, 0), 0.5);
  EXPECT_EQ(picture.alpha(16, 16), 1.0);
  settings.background = {1.0, 1.0, 1.0, 0.0};
  const Picture transparent = render(scene.scene(), settings, 32, 32);
  EXPECT_EQ(transparent.color(0, 0), glm::dvec3(0.0));
  EXPECT_EQ(transparent.alpha(0, 0), 0.0);
  // Edges carry the share of the samples that hit.
  settings.samples_per_pixel = 16;
  const Picture soft = render(scene.scene(), settings, 32, 32);
  std::size_t edges = 0;
  for (std::uint32_t x = 0; x < 32; ++x) edges += soft.alpha(x, 16) > 0.0 && soft.alpha(x, 16) < 1.0 ? 1 : 0;
  EXPECT_EQ(edges, 2u);
}

TEST(Image, AnEmptySceneIsBackground) {
  const SphereScene scene(std::vector<std::vector<Sphere>>(1));
  RenderSettings settings = lit(2.0);
  settings.background = {0.25, 0.5, 0.75, 1.0};
  const Picture picture = render(scene.scene(), settings, 20, 20);
  for (std::uint32_t i = 0; i < 400; ++i) EXPECT_EQ(picture.color(i % 20, i / 20), glm::dvec3(0.25, 0.5, 0.75));
}

TEST(Image, IsTheSameOnEverySimdTarget) {
  const SphereScene scene({cloud(), cloud()});
  RenderSettings settings = lit(2.0);
  settings.effects.shadows = true;
  settings.effects.ambient_occlusion = true;
  for (const std::uint32_t max_samples : {0u, 16u}) {  // fixed and adaptive
    settings.samples_per_pixel = max_samples == 0 ? 1 : 2;
    settings.max_samples_per_pixel = max_samples;
    const Picture expected = render(scene.scene(), settings, 50, 50);
    for_each_simd_target([&](const char* name) {
      EXPECT_EQ(render(scene.scene(), settings, 50, 50).frame.color, expected.frame.color) << name;
    });
  }
}

}  // namespace
}  // namespace insitu::testing
