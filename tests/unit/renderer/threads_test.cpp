// A picture is the same, bit for bit, for any number of threads.
#include <gtest/gtest.h>

#include "unit/kernels/test_tree.h"
#include "unit/renderer/scenes.h"

namespace insitu::testing {
namespace {

TEST(Threads, DoNotShowInThePicture) {
  CounterRandom random(78);
  const std::vector<double> x = make_cloud(Shape::clustered, 3000, 2.0, random);
  std::vector<Sphere> halves[2];
  for (std::size_t i = 0; i < 3000; ++i)
    halves[i % 2].push_back({{x[3 * i], x[3 * i + 1], x[3 * i + 2]}, random.between(0.01, 0.06)});
  RenderSettings settings = orthographic(2.2);
  settings.lights = {ambient_light(0.4), light_towards({0.5, 1.0, 1.0}, 0.6)};
  settings.effects.shadows = true;
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 4;
  settings.samples_per_pixel = 2;
  for (const bool two_sets : {false, true}) {
    settings.max_samples_per_pixel = two_sets ? 0 : 16;
    settings.pixel_error = 0.05;
    std::vector<std::vector<Sphere>> sets = {halves[0]};
    if (two_sets) sets.push_back(halves[1]);
    const SphereScene scene(sets);
    const Picture one = render(scene.scene(), settings, 75, 51, 1);
    for (const unsigned threads : {2u, 8u}) {
      const Picture many = render(scene.scene(), settings, 75, 51, threads);
      EXPECT_EQ(many.frame.color, one.frame.color);
      EXPECT_EQ(many.frame.depth, one.frame.depth);
      EXPECT_EQ(many.frame.normal, one.frame.normal);
      EXPECT_EQ(many.frame.item, one.frame.item);
      EXPECT_EQ(many.costs.camera.rays, one.costs.camera.rays);
      EXPECT_EQ(many.costs.pixels_over_error, one.costs.pixels_over_error);
      EXPECT_EQ(many.costs.shadows.rays, one.costs.shadows.rays);
      EXPECT_EQ(many.costs.ambient_occlusion.rays, one.costs.ambient_occlusion.rays);
    }
  }
}

}  // namespace
}  // namespace insitu::testing
