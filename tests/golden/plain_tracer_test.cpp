// The library's pictures against those of a ray tracer that shares no line with it.
#include "plain_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "picture.h"

namespace insitu::golden {
namespace {

class PlainTracerScenes : public ::testing::TestWithParam<const char*> {};

TEST_P(PlainTracerScenes, DrawsTheSamePicture) {
  const Scene scene = scene_named(GetParam());
  const std::filesystem::path folder = INSITU_GOLDEN_RESULTS;
  std::filesystem::create_directories(folder);
  const std::string plain_path = (folder / (scene.name + ".plain.png")).string();
  const std::string library_path = (folder / (scene.name + ".library.png")).string();
  const Picture plain = encoded(width, height, trace_plainly(scene));
  draw(scene, Variant{}, library_path);
  const Difference off = difference(plain, read_png(library_path));
  if (off.max > 1) write_png(plain_path, plain);
  EXPECT_LE(off.max, 1) << "mean " << off.mean << "\n  plain   " << plain_path << "\n  library " << library_path;
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlainTracerScenes, ::testing::Values("shadows", "orthographic", "bubbles"),
                         [](const auto& info) { return std::string(info.param); });

// Spheres anywhere, of any size and opacity, pixel by pixel; some stand within others, or are not there at all.
Scene random_spheres(std::uint64_t seed) {
  Scene scene = scene_named(seed % 2 == 0 ? "orthographic" : "shadows");
  scene.effects.flags = INSITU_EFFECT_SHADOWS;
  scene.samples_per_pixel = 1;
  // A linear congruential generator (Knuth, MMIX), of which the upper bits are used.
  std::uint64_t state = seed + 1;
  const auto random = [&state](double low, double high) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double unit = static_cast<double>(state >> 40) / 16777216.0;
    return std::round((low + (high - low) * unit) * 1024.0) / 1024.0;
  };
  scene.sets.clear();
  for (int k = 0; k < 2; ++k) {
    Set set;
    for (int i = 0; i < 150; ++i) {
      const auto type = static_cast<std::int32_t>(random(0.0, 8.999));
      set.add(random(-2.0, 6.0), random(-2.0, 4.0), random(-5.0, 2.0), random(0.125, 1.0), i, type);
    }
    for (int i = 0; i < 8; ++i)
      set.own_colors.insert(set.own_colors.end(),
                            {random(0.0, 1.0), random(0.0, 1.0), random(0.0, 1.0), random(0.0, 1.0)});
    set.own_colors[3] = 0.0;
    set.own_colors[7] = 1.0;
    set.color_by = "type";
    set.opacity = k == 0 ? 0.25 : 0.0;
    scene.sets.push_back(set);
  }
  return scene;
}

TEST(PlainTracer, DrawsTheSameRandomSpheres) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Scene scene = random_spheres(seed);
    const std::vector<float> plain = trace_plainly(scene);
    const std::vector<float> library =
        draw(scene, Variant{.f32 = seed % 2 == 0, .order = static_cast<std::uint32_t>(seed % 3)});
    ASSERT_EQ(plain.size(), library.size());
    float most = 0.0f;
    for (std::size_t i = 0; i < plain.size(); ++i) most = std::max(most, std::abs(plain[i] - library[i]));
    EXPECT_LT(most, 2e-6f) << "seed " << seed;
  }
}

}  // namespace
}  // namespace insitu::golden
