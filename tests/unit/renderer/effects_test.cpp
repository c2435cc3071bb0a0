// Only what is asked for is done, and it changes only what it should.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "unit/kernels/test_tree.h"
#include "unit/renderer/scenes.h"

namespace insitu::testing {
namespace {

std::vector<Sphere> cloud(std::uint64_t count, double radius) {
  CounterRandom random(count);
  const std::vector<double> x = make_cloud(Shape::uniform, count, 2.0, random);
  std::vector<Sphere> spheres;
  for (std::uint64_t i = 0; i < count; ++i) spheres.push_back({{x[3 * i], x[3 * i + 1], x[3 * i + 2]}, radius});
  return spheres;
}

RenderSettings lit() {
  RenderSettings settings = orthographic(2.5);
  settings.lights = {ambient_light(0.4), light_towards({0.5, 1.0, 1.0}, 0.6)};
  return settings;
}

TEST(Effects, NotAskedForCostNothing) {
  const SphereScene scene({cloud(200, 0.1)});
  const Picture picture = render(scene.scene(), lit(), 40, 30);
  EXPECT_EQ(picture.costs.camera.rays, 40u * 30u);
  EXPECT_EQ(picture.costs.shadows.rays, 0u);
  EXPECT_EQ(picture.costs.ambient_occlusion.rays, 0u);
  EXPECT_EQ(picture.costs.shadows.seconds, 0.0);
  EXPECT_EQ(picture.costs.ambient_occlusion.seconds, 0.0);
}

TEST(Effects, CostWhatTheyNeed) {
  const SphereScene scene({cloud(200, 0.1)});
  RenderSettings settings = lit();
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 5;
  settings.effects.shadows = true;
  settings.samples_per_pixel = 3;
  const Picture picture = render(scene.scene(), settings, 40, 30);
  EXPECT_EQ(picture.costs.camera.rays, 3u * 40u * 30u);
  EXPECT_GT(picture.costs.ambient_occlusion.rays, 0u);
  EXPECT_EQ(picture.costs.ambient_occlusion.rays % 5, 0u);
  const std::uint64_t hits = picture.costs.ambient_occlusion.rays / 5;
  EXPECT_LT(hits, picture.costs.camera.rays);
  EXPECT_GT(picture.costs.shadows.rays, 0u);
  EXPECT_LE(picture.costs.shadows.rays, hits);  // only points that face the light ask for their shadow
}

TEST(Effects, NeedSomethingToWorkOn) {
  RenderSettings settings = lit();
  settings.effects.shadows = true;
  settings.effects.ambient_occlusion = true;
  const auto plan = [&] { return plan_effects(settings.effects, settings.lights, settings.camera, Bounds{}); };
  EXPECT_TRUE(plan().shadows);
  EXPECT_EQ(plan().ao_samples, 8u);
  settings.lights = {ambient_light(1.0)};
  EXPECT_FALSE(plan().shadows) << "no light casts any";
  settings.lights = {light_towards({0, 0, 1}, 1.0)};
  EXPECT_EQ(plan().ao_samples, 0u) << "no ambient light to dim";
  settings.lights = {light_towards({0, 0, 1}, 0.0), ambient_light(0.0)};
  EXPECT_FALSE(plan().shadows) << "a black light";
  EXPECT_EQ(plan().ao_samples, 0u);
}

TEST(Effects, AoRadiusDefaultsToATenthOfTheScene) {
  const Bounds bounds{{0, 0, 0}, {1, 2, 2}};
  EXPECT_DOUBLE_EQ(plan_effects({}, {}, {}, bounds).ao_radius, 0.3);
  Effects effects;
  effects.ao_radius = 7.0;
  EXPECT_EQ(plan_effects(effects, {}, {}, bounds).ao_radius, 7.0);
}

// Spheres far apart, none in another's light or sky: the effects change not one bit.
TEST(Effects, ThatTouchNothingChangeNothing) {
  std::vector<Sphere> apart;
  for (int i = 0; i < 5; ++i) apart.push_back({{-2.0 + i, 0.3 * i - 0.6, 0.0}, 0.2});
  const SphereScene scene({apart});
  RenderSettings settings = lit();
  settings.camera.height = 5.0;
  settings.lights.back() = light_towards({0.0, 0.1, 1.0}, 0.6);
  const Picture plain = render(scene.scene(), settings, 100, 60);
  settings.effects.shadows = true;
  EXPECT_EQ(render(scene.scene(), settings, 100, 60).frame.color, plain.frame.color);
  settings.effects.shadows = false;
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 16;
  settings.effects.ao_radius = 0.3;
  const Picture occluded = render(scene.scene(), settings, 100, 60);
  EXPECT_GT(occluded.costs.ambient_occlusion.rays, 0u);
  EXPECT_EQ(occluded.frame.color, plain.frame.color);
}

TEST(Effects, ASmallAoRadiusSeesNoOccluder) {
  const SphereScene scene({{{{0.0, 0.0, 0.0}, 1.0}, {{0.0, 0.0, 1.5}, 0.4}}});
  RenderSettings settings = lit();
  const Picture plain = render(scene.scene(), settings, 64, 64);
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 32;
  settings.effects.ao_radius = 0.05;
  EXPECT_EQ(render(scene.scene(), settings, 64, 64).frame.color, plain.frame.color);
  settings.effects.ao_radius = 2.0;
  EXPECT_NE(render(scene.scene(), settings, 64, 64).frame.color, plain.frame.color);
}

// Shadows darken and never brighten, and pixels of the background stay as they are.
TEST(Effects, OnlyDarken) {
  const SphereScene scene({cloud(300, 0.15)});
  RenderSettings settings = lit();
  const Picture plain = render(scene.scene(), settings, 64, 64);
  settings.effects.shadows = true;
  settings.effects.ambient_occlusion = true;
  const Picture full = render(scene.scene(), settings, 64, 64);
  std::size_t darker = 0;
  std::size_t same = 0;
  for (std::size_t i = 0; i < plain.frame.color.size(); ++i) {
    EXPECT_LE(full.frame.color[i], plain.frame.color[i]);
    (full.frame.color[i] < plain.frame.color[i] ? darker : same) += 1;
  }
  EXPECT_GT(darker, 1000u);
  EXPECT_GT(same, 1000u);
  EXPECT_EQ(full.frame.depth, plain.frame.depth);
  EXPECT_EQ(full.frame.item, plain.frame.item);
}

TEST(Effects, SeedsGiveOtherNoiseOfTheSameMean) {
  const SphereScene scene({cloud(300, 0.15)});
  RenderSettings settings = lit();
  settings.effects.ambient_occlusion = true;
  settings.effects.seed = 1;
  const Picture one = render(scene.scene(), settings, 64, 64);
  const Picture again = render(scene.scene(), settings, 64, 64);
  settings.effects.seed = 2;
  const Picture two = render(scene.scene(), settings, 64, 64);
  EXPECT_EQ(one.frame.color, again.frame.color);
  EXPECT_NE(one.frame.color, two.frame.color);
  double mean_one = 0.0;
  double mean_two = 0.0;
  for (std::size_t i = 0; i < one.frame.color.size(); ++i) {
    mean_one += one.frame.color[i];
    mean_two += two.frame.color[i];
  }
  EXPECT_NEAR(mean_one / mean_two, 1.0, 0.005);
}

// A sphere that is there twice looks as if it were there once: it neither shades nor shadows itself. Points on its
// surface are only as exact as the largest number that went into them, so large spheres near the origin count too.
TEST(Effects, CoincidentTwinsLookLikeOne) {
  const Sphere spheres[] = {{{0.3, -0.2, 0.1}, 1.0}, {{1e3, 2e3, -3e3}, 1.0}, {{0.0, 0.0, -1e4 + 1.0}, 1e4}};
  for (const Sphere& sphere : spheres) {
    const SphereScene once({{sphere}});
    const SphereScene twice({{sphere, sphere}});
    const SphereScene in_two_sets({{sphere}, {sphere}});
    RenderSettings settings = lit();
    const double look = std::min(sphere.radius, 3.0);
    settings.camera.look_at = sphere.centre + glm::dvec3(0.0, 0.0, sphere.radius);
    settings.camera.eye = settings.camera.look_at + glm::dvec3(0.0, 0.0, 5.0);
    settings.camera.height = 2.2 * look;
    settings.effects.shadows = true;
    settings.effects.ambient_occlusion = true;
    settings.effects.ao_samples = 64;
    settings.effects.ao_radius = 10.0;
    const Picture expected = render(once.scene(), settings, 64, 64);
    const auto differing = [&](const SphereScene& scene) {
      const Picture picture = render(scene.scene(), settings, 64, 64);
      std::size_t count = 0;
      for (std::size_t i = 0; i < expected.frame.color.size(); i += 4)
        count += picture.frame.color[i] != expected.frame.color[i] ? 1 : 0;
      return count;
    };
    EXPECT_EQ(differing(twice), 0u) << "radius " << sphere.radius << " at " << sphere.centre.x;
    EXPECT_EQ(differing(in_two_sets), 0u) << "radius " << sphere.radius << " at " << sphere.centre.x;
  }
}

TEST(MakeEffects, RefusesWhatCannotBeMeant) {
  const auto refused = [](const insitu_effects& effects) {
    try {
      make_effects(effects);
      return false;
    } catch (const Error& error) {
      return error.status() == INSITU_ERROR_INVALID_ARGUMENT;
    }
  };
  insitu_effects effects;
  insitu_effects_init(&effects);
  EXPECT_FALSE(refused(effects));
  EXPECT_EQ(make_effects(effects).ao_samples, 8u);
  effects.flags = 4;
  EXPECT_TRUE(refused(effects));
  effects.flags = INSITU_EFFECT_SHADOWS;
  effects.ao_samples = 65537;
  EXPECT_TRUE(refused(effects));
  effects.ao_samples = 65536;
  EXPECT_FALSE(refused(effects));
  for (const double bad : {-1.0, std::nan("")}) {
    effects.ao_radius = bad;
    EXPECT_TRUE(refused(effects));
  }
}

}  // namespace
}  // namespace insitu::testing
