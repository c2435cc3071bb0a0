// Adaptive sampling against coverages that are known in closed form, and the estimates that it goes by.
#include "renderer/adaptive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <numbers>

#include "scene/srgb.h"
#include "unit/kernels/counter_random.h"
#include "unit/renderer/scenes.h"

namespace insitu::testing {
namespace {

TEST(DisplayedValue, IsSrgb) {
  for (int i = 0; i <= 100000; ++i) {
    const double linear = i * 1e-5;
    ASSERT_NEAR(displayed_value(linear), srgb_of_linear(linear), 1e-5) << linear;
  }
  for (double small = 1e-12; small < 0.1; small *= 1.5)
    ASSERT_NEAR(displayed_value(small), srgb_of_linear(small), 1e-5) << small;
  EXPECT_EQ(displayed_value(-1.0), 0.0);
  EXPECT_EQ(displayed_value(0.0), 0.0);
  EXPECT_EQ(displayed_value(std::nan("")), 0.0);
  EXPECT_EQ(displayed_value(7.0), 1.0);
  EXPECT_EQ(displayed_value(std::numeric_limits<double>::infinity()), 1.0);
}

PixelSamples samples_of(const std::vector<double>& values) {
  PixelSamples pixel;
  for (const double v : values) pixel.add({v, 0.5, 0.0, 1.0});
  return pixel;
}

TEST(PixelSamples, AddUp) {
  const PixelSamples pixel = samples_of({1.0, 2.0, 4.0, 5.0});
  EXPECT_EQ(pixel.count, 4u);
  EXPECT_EQ(pixel.mean(), glm::dvec4(3.0, 0.5, 0.0, 1.0));
  EXPECT_EQ(pixel.scatter(), glm::dvec4(10.0, 0.0, 0.0, 0.0));
  // No cancellation: a large value in common leaves no trace.
  EXPECT_EQ(samples_of(std::vector<double>(1000, 0.1)).scatter().x, 0.0);
  EXPECT_NEAR(samples_of({1e6 + 1.0, 1e6 + 2.0, 1e6 + 4.0, 1e6 + 5.0}).scatter().x, 10.0, 1e-9);
}

// 16 x 16 pixels of four samples; one of them saw a particle.
TEST(EstimateVariances, TakeWhatThePixelDoesNotKnowFromItsSurroundings) {
  std::vector<PixelSamples> tile(256, samples_of({0.0, 0.0, 0.0, 0.0}));
  std::vector<glm::dvec4> variances;
  estimate_variances(tile, 16, variances);
  for (const glm::dvec4& v : variances) EXPECT_EQ(v, glm::dvec4(0.0));
  tile[16 * 8 + 8] = samples_of({0.0, 1.0, 0.0, 0.0});
  estimate_variances(tile, 16, variances);
  const double own = variances[16 * 8 + 8].x;
  const double beside = variances[16 * 8 + 9].x;
  const double far = variances[0].x;
  EXPECT_LT(own, 0.25) << "its own scatter is 3/4 in 3 degrees of freedom";
  EXPECT_GT(own, beside);
  EXPECT_GT(beside, 5.0 * far);
  EXPECT_GT(far, 0.0) << "there are particles in this tile";
  // With many samples of its own a pixel is its own judge.
  std::vector<double> many;
  for (int i = 0; i < 10000; ++i) many.push_back(i % 2);
  tile[0] = samples_of(many);
  estimate_variances(tile, 16, variances);
  EXPECT_NEAR(variances[0].x, 0.25, 0.001);
  // Rows and columns at the edge of a tile that is cut off.
  estimate_variances(std::vector<PixelSamples>(3, samples_of({0.0, 1.0})), 1, variances);
  EXPECT_EQ(variances.size(), 3u);
  for (const glm::dvec4& v : variances) EXPECT_DOUBLE_EQ(v.x, 0.5);
}

TEST(DisplayedError, IsThatOfTheWorstChannel) {
  PixelSamples pixel;
  for (int i = 0; i < 4; ++i) pixel.add({0.5, 0.01, 0.0, 1.0});
  // A standard error of 0.005 shifts a dark value by more than a bright one.
  const double bright = displayed_error(pixel, {1e-4, 0.0, 0.0, 0.0});
  const double dark = displayed_error(pixel, {0.0, 1e-4, 0.0, 0.0});
  EXPECT_NEAR(bright, srgb_of_linear(0.5) - srgb_of_linear(0.495), 1e-5);
  EXPECT_NEAR(dark, srgb_of_linear(0.01) - srgb_of_linear(0.005), 1e-5);
  EXPECT_EQ(displayed_error(pixel, {1e-4, 1e-4, 0.0, 0.0}), dark);
  EXPECT_NEAR(displayed_error(pixel, {0.0, 0.0, 0.0, 0.04}), 0.1, 1e-12) << "opacity is shown as it is";
  PixelSamples overexposed;
  for (int i = 0; i < 4; ++i) overexposed.add({5.0, 5.0, 5.0, 1.0});
  EXPECT_EQ(displayed_error(overexposed, {1.0, 1.0, 1.0, 0.0}), 0.0) << "white whatever the noise";
}

TEST(NextCount, AimsAtTheError) {
  const SamplingRule rule{1000, 0.01};
  PixelSamples pixel;
  for (int i = 0; i < 16; ++i) pixel.add({0.5, 0.5, 0.5, 1.0});
  const auto next = [&](double error) {  // by means of opacity, which is not curved
    return next_count(rule, pixel, {0.0, 0.0, 0.0, 16.0 * error * error});
  };
  EXPECT_EQ(next(0.0), 16u);
  EXPECT_EQ(next(0.0099), 16u);
  EXPECT_EQ(next(0.0101), 20u) << "not one by one";
  EXPECT_EQ(next(0.02), 64u);
  EXPECT_EQ(next(0.5), 128u) << "no farther than the estimate is good for";
  EXPECT_EQ(next(std::numeric_limits<double>::infinity()), 128u);
  EXPECT_EQ(next_count({20, 0.01}, pixel, {0.0, 0.0, 0.0, 1.0}), 20u);
  EXPECT_EQ(next_count({16, 0.01}, pixel, {0.0, 0.0, 0.0, 1.0}), 16u);
}

RenderSettings adaptive(double height, std::uint32_t max_samples, double pixel_error) {
  RenderSettings settings = orthographic(height);
  settings.lights = {ambient_light(1.0)};
  settings.samples_per_pixel = 4;
  settings.max_samples_per_pixel = max_samples;
  settings.pixel_error = pixel_error;
  return settings;
}

TEST(Adaptive, EvenPixelsTakeTheLeast) {
  const SphereScene empty(std::vector<std::vector<Sphere>>(1));
  const SphereScene full({{{{0.0, 0.0, 0.0}, 5.0}}});
  for (const SphereScene* scene : {&empty, &full}) {
    const Picture picture = render(scene->scene(), adaptive(2.0, 256, 0.01), 37, 21);
    EXPECT_EQ(picture.costs.pixels, 37u * 21u);
    EXPECT_EQ(picture.costs.camera.rays, 4u * 37u * 21u);
    EXPECT_EQ(picture.costs.pixels_over_error, 0u);
  }
}

struct Errors {
  double rms = 0.0;     // of displayed values
  double mean = 0.0;    // likewise, with signs
  double within = 0.0;  // share of pixels within 1.96 standard errors
};

Errors judge(const Picture& picture, double standard_error,
             const std::function<double(std::uint32_t, std::uint32_t)>& truth) {
  Errors errors;
  const double n = static_cast<double>(picture.frame.pixel_count());
  for (std::uint32_t y = 0; y < picture.frame.height; ++y) {
    for (std::uint32_t x = 0; x < picture.frame.width; ++x) {
      const double off = srgb_of_linear(picture.color(x, y).x) - srgb_of_linear(truth(x, y));
      errors.rms += off * off / n;
      errors.mean += off / n;
      errors.within += std::abs(off) <= 1.96 * standard_error ? 1.0 / n : 0.0;
    }
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

// Spheres side by side, `across` x `across` in a pixel, of one radius per pixel: they cover a share that is known.
struct Grains {
  static constexpr std::uint32_t size_px = 32;
  Grains(std::uint32_t across, double least_share, double largest_share, std::uint32_t edge_px = size_px)
      : width(edge_px) {
    CounterRandom random(across);
    const double cell = 1.0 / across;
    for (std::uint32_t y = 0; y < width; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        const double part = random.between(least_share, largest_share);
        share.push_back(part);
        const double radius = cell * std::sqrt(part / std::numbers::pi);
        const glm::dvec3 middle = pixel_place(x, y, width, width, width);
        for (std::uint32_t i = 0; i < across * across; ++i) {
          const glm::dvec3 corner = middle + glm::dvec3(i % across * cell - 0.5, i / across * cell - 0.5, 0.0);
          spheres.push_back(
              {corner + glm::dvec3(random.between(radius, cell - radius), random.between(radius, cell - radius), 0.0),
               radius});
        }
      }
    }
  }
  double at(std::uint32_t x, std::uint32_t y) const { return share[y * width + x]; }

  std::uint32_t width;
  std::vector<double> share;
  std::vector<Sphere> spheres;
};

// What is said of the error holds: at least 95 % of the pixels are within 1.96 standard errors, and no side is
// favoured.
TEST(Adaptive, KeepsToItsErrorWithGrainsInEveryPixel) {
  struct Case {
    double least_share;
    double largest_share;
    std::vector<double> tolerated;
  };
  for (const Case& c : {Case{0.02, 0.75, {0.04, 0.02}}, Case{0.002, 0.05, {0.04}}}) {
    const Grains grains(7, c.least_share, c.largest_share);
    const SphereScene scene({grains.spheres});
    const auto truth = [&](std::uint32_t x, std::uint32_t y) { return grains.at(x, y); };
    for (const double tolerated : c.tolerated) {
      const Picture picture =
          render(scene.scene(), adaptive(Grains::size_px, 16384, tolerated), Grains::size_px, Grains::size_px);
      const Errors errors = judge(picture, tolerated, truth);
      EXPECT_EQ(picture.costs.pixels_over_error, 0u);
      EXPECT_GE(errors.within, 0.95) << c.largest_share << ' ' << tolerated;
      EXPECT_LT(errors.rms, tolerated);
      EXPECT_LT(std::abs(errors.mean), 0.25 * tolerated);
      RenderSettings fixed = orthographic(Grains::size_px);
      fixed.lights = {ambient_light(1.0)};
      fixed.samples_per_pixel = 4;
      EXPECT_LT(judge(render(scene.scene(), fixed, Grains::size_px, Grains::size_px), tolerated, truth).within, 0.6)
          << "four samples would do";
      std::cout << "shares up to " << c.largest_share << ", tolerated " << tolerated << ": rms " << errors.rms << ", "
                << 100.0 * errors.within << " % within, bias " << errors.mean << ", "
                << static_cast<double>(picture.costs.camera.rays) / static_cast<double>(picture.costs.pixels)
                << " samples per pixel\n";
    }
  }
}

// The part of the unit square about `middle` in which dot(place, normal) < offset: the square is cut by a line.
double share_below(const glm::dvec3& middle, const glm::dvec3& normal, double offset) {
  const glm::dvec3 corners[] = {{-0.5, -0.5, 0.0}, {0.5, -0.5, 0.0}, {0.5, 0.5, 0.0}, {-0.5, 0.5, 0.0}};
  std::vector<glm::dvec3> kept;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 a = middle + corners[i];
    const glm::dvec3 b = middle + corners[(i + 1) % 4];
    const double da = glm::dot(a, normal) - offset;
    const double db = glm::dot(b, normal) - offset;
    if (da < 0.0) kept.push_back(a);
    if ((da < 0.0) != (db < 0.0)) kept.push_back(a + da / (da - db) * (b - a));
  }
  double area = 0.0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const glm::dvec3& a = kept[i];
    const glm::dvec3& b = kept[(i + 1) % kept.size()];
    area += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return area;
}

// The edge of a sphere so large that it is straight: pixels on it take more samples than others and are as good as
// said.
TEST(Adaptive, SpendsItsSamplesOnEdges) {
  constexpr std::uint32_t size_px = 48;
  constexpr double radius = 1e7;
  const glm::dvec3 normal = glm::normalize(glm::dvec3(1.0, 0.3, 0.0));
  const SphereScene scene({{{-radius * normal + glm::dvec3(0.0, 0.0, -radius), radius}}});
  const auto truth = [&](std::uint32_t x, std::uint32_t y) {
    return share_below(pixel_place(x, y, size_px, size_px, size_px), normal, 0.0);
  };
  RenderSettings settings = adaptive(size_px, 1024, 0.02);
  settings.camera.eye.z = 1e3;
  std::size_t edges = 0;
  for (std::uint32_t i = 0; i < size_px * size_px; ++i) {
    const double share = truth(i % size_px, i / size_px);
    edges += share > 0.01 && share < 0.99 ? 1 : 0;
  }
  const Picture picture = render(scene.scene(), settings, size_px, size_px);
  const Errors errors = judge(picture, settings.pixel_error, truth);
  EXPECT_GE(errors.within, 0.998) << "of " << edges << " edge pixels in " << size_px * size_px;
  // That black beside the edge is black takes hundreds of samples: one white one in 600 would show.
  EXPECT_LT(picture.costs.camera.rays, 4u * picture.costs.pixels + 1500u * edges);
  EXPECT_GT(picture.costs.camera.rays, 4u * picture.costs.pixels + 100u * edges);
  // With as many samples each, all pixels would be much worse.
  settings.samples_per_pixel = static_cast<std::uint32_t>(picture.costs.camera.rays / picture.costs.pixels);
  settings.max_samples_per_pixel = 0;
  EXPECT_GT(judge(render(scene.scene(), settings, size_px, size_px), 0.02, truth).rms, 2.0 * errors.rms);
}

TEST(Adaptive, SaysWhereTheErrorIsNotReached) {
  const Grains grains(7, 0.2, 0.6);
  const SphereScene scene({grains.spheres});
  const Picture picture = render(scene.scene(), adaptive(Grains::size_px, 8, 0.01), Grains::size_px, Grains::size_px);
  EXPECT_EQ(picture.costs.pixels_over_error, picture.costs.pixels);
  EXPECT_EQ(picture.costs.camera.rays, 8u * picture.costs.pixels);
}

// A particle here and there, which four samples of a pixel and those of its neighbours mostly miss.
TEST(Adaptive, DoesNotOverlookRareParticles) {
  const Grains grains(1, 0.01, 0.01);
  const SphereScene scene({grains.spheres});
  const auto truth = [&](std::uint32_t x, std::uint32_t y) { return grains.at(x, y); };
  const Picture picture =
      render(scene.scene(), adaptive(Grains::size_px, 16384, 0.02), Grains::size_px, Grains::size_px);
  const Errors errors = judge(picture, 0.02, truth);
  EXPECT_GE(errors.within, 0.95);
  EXPECT_LT(std::abs(errors.mean), 0.005);
}

// A camera that moves by a part of a pixel, over thousands of grains in each: what covers a third of every pixel before
// covers a third of it after.
TEST(Adaptive, DoesNotShimmer) {
  constexpr std::uint32_t size_px = 8;
  const Grains grains(45, 0.33, 0.33, 10);
  const SphereScene scene({grains.spheres});
  const auto flicker = [&](RenderSettings settings) {
    Picture frames[2];
    for (Picture& frame : frames) {
      frame = render(scene.scene(), settings, size_px, size_px);
      settings.camera.eye += glm::dvec3(0.37, -0.21, 0.0);
      settings.camera.look_at += glm::dvec3(0.37, -0.21, 0.0);
    }
    return judge(frames[1], 0.0, [&](std::uint32_t x, std::uint32_t y) { return frames[0].color(x, y).x; }).rms;
  };
  RenderSettings settings = adaptive(size_px, 4096, 0.02);
  const double tamed = flicker(settings);
  settings.max_samples_per_pixel = 0;
  const double plain = flicker(settings);
  std::cout << "from frame to frame: " << tamed << ", with four samples " << plain << '\n';
  EXPECT_LT(tamed, 1.5 * 0.02) << "two frames, each off by 0.02";
  EXPECT_GT(plain, 0.2);
}

// Depth and the like do not depend on how many samples there are.
TEST(Adaptive, KeepsTheChannelsOfTheFirstSample) {
  const Grains grains(2, 0.2, 0.6);
  const SphereScene scene({grains.spheres});
  RenderSettings settings = adaptive(Grains::size_px, 64, 0.02);
  const Picture many = render(scene.scene(), settings, 40, 30);
  settings.samples_per_pixel = 1;
  settings.max_samples_per_pixel = 0;
  const Picture one = render(scene.scene(), settings, 40, 30);
  EXPECT_NE(many.frame.color, one.frame.color);
  EXPECT_EQ(many.frame.depth, one.frame.depth);
  EXPECT_EQ(many.frame.position, one.frame.position);
  EXPECT_EQ(many.frame.normal, one.frame.normal);
  EXPECT_EQ(many.frame.item, one.frame.item);
}

// Noise of ambient occlusion is noise of the pixel: between two spheres that touch, where no edge is.
TEST(Adaptive, CountsTheNoiseOfOcclusion) {
  const SphereScene scene({{{{0.0, 0.0, 0.0}, 1.0}, {{2.0, 0.0, 0.0}, 1.0}}});
  RenderSettings settings = adaptive(0.5, 512, 0.01);
  settings.camera.eye.x = settings.camera.look_at.x = 0.6;
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_radius = 100.0;
  const Picture picture = render(scene.scene(), settings, 24, 24);
  EXPECT_EQ(picture.costs.pixels_over_error, 0u);
  EXPECT_GT(picture.costs.camera.rays, 8u * picture.costs.pixels);
  EXPECT_EQ(picture.costs.ambient_occlusion.rays,
            8u * 4u * picture.costs.pixels + 2u * (picture.costs.camera.rays - 4u * picture.costs.pixels));
  RenderSettings fine = settings;
  fine.samples_per_pixel = 64;
  fine.max_samples_per_pixel = 0;
  fine.effects.ao_samples = 64;
  const Picture truth = render(scene.scene(), fine, 24, 24);
  const Errors errors = judge(picture, 0.01, [&](std::uint32_t x, std::uint32_t y) { return truth.color(x, y).x; });
  EXPECT_GE(errors.within, 0.95);
  EXPECT_LT(std::abs(errors.mean), 0.0025);
}

}  // namespace
}  // namespace insitu::testing
