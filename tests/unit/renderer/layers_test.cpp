// Transparent particles against closed forms and against a plain sum over all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "unit/kernels/counter_random.h"
#include "unit/renderer/scenes.h"

namespace insitu::testing {
namespace {

struct Ball {
  glm::dvec3 centre;
  double radius;
  double value;  // place in the colour map
};

// Sets of balls by one colour map of sRGB and opacity, over values of 0 to 1.
class MappedScene {
 public:
  MappedScene(std::vector<double> rgba, const std::vector<std::vector<Ball>>& sets, double opacity = 1.0,
              ParticleOrder order = ParticleOrder::index, double treelet_share = 0.0)
      : map_(Colormap::from_srgb(ColormapKind::continuous, rgba)) {
    static Budget budget(0);
    Style style;
    style.by_attribute = true;
    style.attribute = "value";
    style.fixed_range = true;
    style.opacity = static_cast<float>(opacity);
    for (const std::vector<Ball>& balls : sets) {
      data_.push_back(std::make_unique<Data>(order));
      Data& data = *data_.back();
      for (const Ball& ball : balls) {
        data.x.insert(data.x.end(), {ball.centre.x, ball.centre.y, ball.centre.z});
        data.radius.push_back(ball.radius);
        data.value.push_back(ball.value);
      }
      ParticleArrays arrays;
      arrays.position = positions_of(data.x);
      arrays.radius = view_of(data.radius, 1, INSITU_USE_RADIUS);
      arrays.attributes.push_back({"value", attribute_of(data.value)});
      arrays.treelet_share = treelet_share;
      data.particles.bind(std::move(arrays));
      data.particles.build(budget);
      scene_.add(data.particles, Colors(style, data.particles, map_));
    }
    scene_.commit();
  }
  const Scene& scene() const { return scene_; }
  const Colormap& map() const { return map_; }

 private:
  struct Data {
    explicit Data(ParticleOrder order) : particles("balls", order, false) {}
    std::vector<double> x;
    std::vector<double> radius;
    std::vector<double> value;
    Particles particles;
  };
  Colormap map_;
  std::vector<std::unique_ptr<Data>> data_;
  Scene scene_;
};

// From opaque red to transparent blue, by way of a green in between.
const std::vector<double> red_to_blue = {0.9, 0.2, 0.1, 1.0, 0.3, 0.8, 0.2, 0.5, 0.1, 0.2, 0.9, 0.0};
const std::vector<double> faint = {0.9, 0.2, 0.1, 0.03, 0.1, 0.2, 0.9, 0.005};

// One ray, down the z axis from z = 10, in white light from everywhere.
RenderSettings down_the_axis() {
  RenderSettings settings = orthographic(1e-6);
  settings.lights = {ambient_light(1.0)};
  settings.background = {0.25, 0.5, 0.75, 1.0};
  return settings;
}

struct Expected {
  glm::dvec3 color{0.0};
  double transmittance = 1.0;
  std::uint64_t layers = 0;

  void over(const Rgba& layer) {
    if (layer.a == 0.0f || transmittance == 0.0) return;
    ++layers;
    double passed = transmittance * (1.0 - static_cast<double>(layer.a));
    if (passed < 1.0 / 1024.0) passed = 0.0;
    color += (transmittance - passed) * glm::dvec3(layer.r, layer.g, layer.b);
    transmittance = passed;
  }
};

// Any number of balls that all stand on the axis, some within others: the over operator, sorted by where they begin.
TEST(Layers, OnAnAxisAreTheOverOperator) {
  for (const std::size_t count : {1u, 2u, 31u, 32u, 33u, 64u, 65u, 97u, 300u}) {
    CounterRandom random(count);
    std::vector<Ball> balls;
    for (std::size_t i = 0; i < count; ++i)
      balls.push_back({{0.0, 0.0, random.between(-5.0, 5.0)}, random.between(0.1, 3.0), random.unit()});
    std::vector<Ball> sorted = balls;
    std::sort(sorted.begin(), sorted.end(),
              [](const Ball& a, const Ball& b) { return a.centre.z + a.radius > b.centre.z + b.radius; });
    for (const bool two_sets : {false, true}) {
      for (const ParticleOrder order : {ParticleOrder::index, ParticleOrder::permute, ParticleOrder::copy}) {
        std::vector<std::vector<Ball>> sets = {balls};
        if (two_sets)
          sets = {{balls.begin(), balls.begin() + balls.size() / 2}, {balls.begin() + balls.size() / 2, balls.end()}};
        const MappedScene scene(faint, sets, 0.75, order, count % 2 == 0 ? 1.0 : 0.0);
        Expected expected;
        for (const Ball& ball : sorted) {
          Rgba layer = scene.map().lookup(ball.value);
          layer.a *= 0.75f;
          expected.over(layer);
        }
        const Picture picture = render(scene.scene(), down_the_axis(), 1, 1);
        const glm::dvec3 background(0.25, 0.5, 0.75);
        EXPECT_LT(glm::length(picture.color(0, 0) - (expected.color + expected.transmittance * background)), 2e-7);
        EXPECT_NEAR(picture.alpha(0, 0), 1.0, 1e-7);
        EXPECT_EQ(picture.costs.layers, expected.layers) << count;
        EXPECT_FLOAT_EQ(picture.frame.depth[0], static_cast<float>(10.0 - sorted[0].centre.z - sorted[0].radius));
      }
    }
  }
}

// Half of the light per layer: ten let 1/1024 pass, the eleventh takes the rest.
TEST(Layers, EndWhereNothingCanBeSeenAnyMore) {
  std::vector<Ball> balls;
  for (int i = 0; i < 40; ++i) balls.push_back({{0.0, 0.0, 5.0 - 0.25 * i}, 0.1, 0.0});
  RenderSettings settings = down_the_axis();
  settings.background = {0.0, 0.0, 0.0, 0.0};
  for (const std::size_t count : {9u, 10u, 11u, 40u}) {
    const MappedScene scene({1.0, 1.0, 1.0, 0.5},
                            {{balls.begin(), balls.begin() + static_cast<std::ptrdiff_t>(count)}});
    const Picture picture = render(scene.scene(), settings, 1, 1);
    const std::size_t layers = std::min<std::size_t>(count, 11);
    EXPECT_EQ(picture.costs.layers, layers);
    EXPECT_EQ(picture.alpha(0, 0), layers == 11 ? 1.0 : 1.0 - std::ldexp(1.0, -static_cast<int>(layers)));
  }
}

// A ray that starts inside of a transparent ball does not see it; an opaque one it sees from inside, as ever.
TEST(Layers, AreCountedWhereTheyAreEntered) {
  RenderSettings settings = down_the_axis();
  const std::vector<Ball> small_in_large = {{{0.0, 0.0, 10.0}, 3.0, 0.5}, {{0.0, 0.0, 0.0}, 1.0, 0.5}};
  const MappedScene transparent(red_to_blue, {small_in_large});
  Picture picture = render(transparent.scene(), settings, 1, 1);
  EXPECT_EQ(picture.costs.layers, 1u);
  EXPECT_EQ(picture.frame.item[0], 1u);
  EXPECT_FLOAT_EQ(picture.frame.depth[0], 9.0f);
  const MappedScene opaque(red_to_blue, {{{{0.0, 0.0, 10.0}, 3.0, 0.0}, {{0.0, 0.0, 0.0}, 1.0, 0.5}}});
  picture = render(opaque.scene(), settings, 1, 1);
  EXPECT_EQ(picture.frame.item[0], 0u);
  EXPECT_FLOAT_EQ(picture.frame.depth[0], 3.0f);
}

TEST(Layers, OfOpacityZeroAreNotThere) {
  const double nan = std::nan("");
  const MappedScene scene(
      red_to_blue, {{{{0.0, 0.0, 5.0}, 1.0, 1.0}, {{0.0, 0.0, 0.0}, 1.0, 0.5}, {{0.0, 0.0, -3.0}, 1.0, nan}}}, 0.5);
  const Picture picture = render(scene.scene(), down_the_axis(), 1, 1);
  EXPECT_EQ(picture.frame.item[0], 1u);
  EXPECT_FLOAT_EQ(picture.frame.depth[0], 9.0f);
  EXPECT_FLOAT_EQ(picture.frame.position[2], 1.0f);
  EXPECT_FLOAT_EQ(picture.frame.normal[2], 1.0f);
  Expected expected;
  Rgba green = scene.map().lookup(0.5);
  green.a *= 0.5f;
  expected.over(green);
  expected.over(Colormap::bad_value);  // opaque, whatever the style says
  EXPECT_LT(glm::length(picture.color(0, 0) - expected.color), 2e-7);
  EXPECT_EQ(picture.costs.layers, 2u);
}

// Integer positions: distances in the lattice are not those in the world. More layers than a list holds.
TEST(Layers, OfIntegerPositionsAreThoseOfTheWorld) {
  constexpr int count = 70;
  std::vector<std::int32_t> x;
  for (int i = 0; i < count; ++i) x.insert(x.end(), {7, -3, 4 * i});
  Particles particles("lattice", ParticleOrder::index, false);
  ParticleArrays arrays;
  arrays.position = positions_of(x);
  arrays.position_scale = 0.037;
  const double origin[3] = {-7 * 0.037, 3 * 0.037, -2.0};
  std::copy_n(origin, 3, arrays.position_origin);
  arrays.radius_default = 0.05;
  particles.bind(std::move(arrays));
  Budget budget(0);
  particles.build(budget);
  Style style;
  style.color = {1.0f, 1.0f, 1.0f, 1.0f};
  style.opacity = 0.03f;
  Scene scene;
  scene.add(particles, Colors(style, particles, *builtin_colormap("viridis")));
  scene.commit();
  RenderSettings settings = down_the_axis();
  settings.camera.eye = {0.0, 0.0, 12.0};
  settings.background = {0.0, 0.0, 0.0, 0.0};
  const Picture picture = render(scene, settings, 1, 1);
  EXPECT_EQ(picture.costs.layers, static_cast<std::uint64_t>(count));
  EXPECT_EQ(picture.frame.item[0], static_cast<std::uint64_t>(count - 1));
  EXPECT_FLOAT_EQ(picture.frame.depth[0], static_cast<float>(14.0 - 4 * (count - 1) * 0.037 - 0.05));
  EXPECT_NEAR(picture.alpha(0, 0), 1.0 - std::pow(1.0 - static_cast<double>(0.03f), count), 1e-6);
  EXPECT_NEAR(picture.color(0, 0).x, picture.alpha(0, 0), 1e-6);
}

// At the same distance: first the set that was made first, within a set what is preferred when it is opaque.
TEST(Layers, AtOnePlaceHaveAnOrder) {
  const Ball green{{0.0, 0.0, 0.0}, 1.0, 0.5};
  const Ball greenish{{0.0, 0.0, 0.0}, 1.0, 0.4};
  const auto color = [](const std::vector<std::vector<Ball>>& sets) {
    const MappedScene scene(red_to_blue, sets);
    return render(scene.scene(), down_the_axis(), 1, 1).color(0, 0);
  };
  EXPECT_EQ(color({{green, greenish}}), color({{greenish, green}}));
  EXPECT_EQ(color({{green, greenish}}), color({{greenish}, {green}}));  // the smaller value is preferred
  EXPECT_NE(color({{green}, {greenish}}), color({{greenish}, {green}}));
  // As many as do not fit into one list, in any order.
  std::vector<Ball> many;
  for (int i = 0; i < 100; ++i) many.push_back({{0.0, 0.0, 0.0}, 1.0, 0.98 + 0.0001 * i});
  std::vector<Ball> backwards(many.rbegin(), many.rend());
  EXPECT_EQ(color({many}), color({backwards}));
}

// A point of a large ball, with two balls over it that the camera, below them, does not see.
TEST(Layers, DimShadowsByTheProductOfWhatTheyLetPass) {
  const Ball ground{{0.0, 0.0, -1e4}, 1e4, 0.0};
  RenderSettings settings = orthographic(1e-9);
  settings.camera.eye = {0.0, 0.0, 1e-3};
  settings.lights = {light_towards({0, 0, 1}, 1.0)};
  settings.effects.shadows = true;
  for (const auto& [a, b] : {std::pair{0.25, 0.6}, std::pair{0.5, 0.5}, std::pair{0.7, 1.0}, std::pair{0.1, 0.0}}) {
    const Ball one{{0.0, 0.0, 3.0}, 1.0, a};
    const Ball other{{0.1, 0.1, 4.0}, 1.5, b};
    for (const bool two_sets : {false, true}) {
      const MappedScene scene(red_to_blue, two_sets ? std::vector<std::vector<Ball>>{{one}, {ground, other}}
                                                    : std::vector<std::vector<Ball>>{{other, one, ground}});
      const Picture picture = render(scene.scene(), settings, 1, 1);
      const double passed =
          (1.0 - static_cast<double>(scene.map().lookup(a).a)) * (1.0 - static_cast<double>(scene.map().lookup(b).a));
      const Rgba red = scene.map().lookup(0.0);
      EXPECT_LT(glm::length(picture.color(0, 0) - passed * glm::dvec3(red.r, red.g, red.b)), 1e-6) << a << ' ' << b;
      EXPECT_EQ(picture.costs.shadows.rays, 1u);
    }
  }
}

// The sky that a ball covers (truth_test.cpp has the formula) shines through by what the ball lets pass.
TEST(Layers, DimTheSkyByWhatTheyLetPass) {
  const double covered = 0.5 * 0.5 * std::cos(40.0 * std::numbers::pi / 180.0);
  const double angle = 40.0 * std::numbers::pi / 180.0;
  const Ball ground{{0.0, 0.0, -1e7}, 1e7, 0.0};
  const Ball ball{10.0 * glm::dvec3(std::sin(angle), 0.0, std::cos(angle)), 5.0, 0.5};
  const MappedScene scene(red_to_blue, {{ground, ball}});
  RenderSettings settings = orthographic(1e-9);
  settings.camera.eye = {0.0, 0.0, 1e-3};
  settings.lights = {ambient_light(1.0)};
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 65536;
  settings.effects.ao_radius = 1e6;
  const Picture picture = render(scene.scene(), settings, 1, 1);
  const double red = static_cast<double>(scene.map().lookup(0.0).r);
  const double passed = 1.0 - static_cast<double>(scene.map().lookup(0.5).a);
  const double sigma = std::sqrt(covered * (1.0 - covered) / 65536.0);
  EXPECT_NEAR(picture.color(0, 0).x / red, 1.0 - covered * (1.0 - passed), 5.0 * sigma);
}

// Where something could be seen through but nothing is, every bit is what it is without.
TEST(Layers, ThatAreAllOpaqueChangeNothing) {
  CounterRandom random(5);
  std::vector<Ball> balls;
  for (int i = 0; i < 400; ++i)
    balls.push_back({{random.between(-2.0, 2.0), random.between(-2.0, 2.0), random.between(-2.0, 2.0)},
                     random.between(0.1, 0.4),
                     0.0});
  for (int i = 0; i < 20; ++i) balls.push_back(balls[static_cast<std::size_t>(i)]);
  RenderSettings settings = orthographic(4.0);
  settings.camera.eye = {0.0, 0.0, 0.5};  // inside of some
  settings.samples_per_pixel = 2;
  settings.effects.shadows = settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 5;
  settings.lights = default_lights();
  for (const std::uint32_t adaptive : {0u, 16u}) {
    settings.max_samples_per_pixel = adaptive;
    const MappedScene opaque({0.9, 0.2, 0.1, 1.0, 0.1, 0.2, 0.9, 1.0}, {balls});
    const MappedScene maybe(red_to_blue, {balls});
    EXPECT_FALSE(opaque.scene().is_transparent());
    EXPECT_TRUE(maybe.scene().is_transparent());
    const Picture expected = render(opaque.scene(), settings, 50, 40);
    const Picture picture = render(maybe.scene(), settings, 50, 40);
    EXPECT_EQ(picture.frame.color, expected.frame.color);
    EXPECT_EQ(picture.frame.depth, expected.frame.depth);
    EXPECT_EQ(picture.frame.item, expected.frame.item);
    EXPECT_EQ(picture.frame.normal, expected.frame.normal);
    EXPECT_EQ(picture.costs.shadows.rays, expected.costs.shadows.rays);
    EXPECT_EQ(picture.costs.ambient_occlusion.rays, expected.costs.ambient_occlusion.rays);
    EXPECT_EQ(expected.costs.layers, 0u);
  }
}

// All layers of a ray together take hardly more occlusion rays than one opaque surface, and one for each of them.
TEST(Layers, ShareTheOcclusionRays) {
  std::vector<Ball> balls;
  for (int i = 0; i < 50; ++i) balls.push_back({{0.0, 0.0, 5.0 - 0.2 * i}, 1.0, 0.0});
  const MappedScene scene({1.0, 1.0, 1.0, 0.05}, {balls});
  RenderSettings settings = down_the_axis();
  settings.effects.ambient_occlusion = true;
  settings.effects.ao_samples = 64;
  const Picture picture = render(scene.scene(), settings, 1, 1);
  EXPECT_EQ(picture.costs.layers, 50u);
  EXPECT_GE(picture.costs.ambient_occlusion.rays, 58u);  // 64 (1 - 0.95^50)
  EXPECT_LE(picture.costs.ambient_occlusion.rays, 64u + 50u);
}

// Every pixel decides for itself; the mean of many samples is that of the same picture with a fixed number.
TEST(Layers, AreSampledAdaptively) {
  CounterRandom random(11);
  std::vector<Ball> balls;
  for (int i = 0; i < 3000; ++i)
    balls.push_back(
        {{random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0)}, 0.02, random.unit()});
  const MappedScene scene(red_to_blue, {balls});
  RenderSettings settings = orthographic(2.0);
  settings.lights = {ambient_light(1.0)};
  settings.samples_per_pixel = 256;
  const Picture reference = render(scene.scene(), settings, 16, 16);
  settings.samples_per_pixel = 4;
  settings.max_samples_per_pixel = 256;
  settings.pixel_error = 0.02;
  const Picture picture = render(scene.scene(), settings, 16, 16);
  EXPECT_GT(picture.costs.camera.rays, 16u * 16u * 8u);
  EXPECT_LT(picture.costs.camera.rays, 16u * 16u * 256u);
  double squares = 0.0;
  for (std::uint32_t i = 0; i < 256; ++i) {
    const double off = glm::length(picture.color(i % 16, i / 16) - reference.color(i % 16, i / 16));
    squares += off * off / 256.0;
  }
  EXPECT_LT(std::sqrt(squares), 0.06);
}

}  // namespace
}  // namespace insitu::testing
