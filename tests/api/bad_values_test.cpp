// Particles that cannot be drawn are skipped and counted; all others are drawn, whatever their size and place.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Studio;
using testing::works;

constexpr std::uint32_t every_order[] = {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY};
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double denormal = std::numeric_limits<double>::denorm_min();

// Any number of balls, each with a radius of its own.
struct Balls {
  std::vector<double> xyz;
  std::vector<double> radii;

  void add(double x, double y, double z, double radius) {
    xyz.insert(xyz.end(), {x, y, z});
    radii.push_back(radius);
  }
  std::size_t size() const { return radii.size(); }
};

struct Outcome {
  insitu_stats stats;
  testing::Picture picture;
  double lower[3];
  double upper[3];
};

// One step; the arrays stay bit for bit what they are.
template <class Scalar>
Outcome draw(const Balls& balls, std::uint32_t order, double radius_default = 0.0) {
  std::vector<Scalar> xyz(balls.xyz.begin(), balls.xyz.end());
  std::vector<Scalar> radii(balls.radii.begin(), balls.radii.end());
  const std::vector<Scalar> xyz_before = xyz;
  const std::uint32_t type = sizeof(Scalar) == 4 ? INSITU_F32 : INSITU_F64;
  insitu_array position = insitu_array_records(type, 3, xyz.data(), balls.size(), 0);
  insitu_array radius = insitu_array_records(type, 1, radii.data(), balls.size(), 0);
  position.flags = radius.flags = INSITU_ARRAY_PERMUTABLE;
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.position = &position;
  desc.radius_default = radius_default;
  if (radius_default == 0.0) desc.radius = &radius;

  Studio studio(order);
  Outcome outcome;
  insitu_step_begin(studio.context, 0, 0.0);
  EXPECT_TRUE(works(studio.context, insitu_particles_update(studio.context, studio.geometry, &desc)));
  EXPECT_TRUE(works(studio.context, insitu_commit(studio.context)));
  EXPECT_TRUE(
      works(studio.context, insitu_geometry_bounds(studio.context, studio.geometry, outcome.lower, outcome.upper)));
  EXPECT_TRUE(works(studio.context, insitu_render(studio.context, studio.view, studio.image)));
  EXPECT_TRUE(works(studio.context, insitu_step_end(studio.context)));
  outcome.stats = studio.context.stats();
  outcome.picture = studio.picture();
  if (order != INSITU_ORDER_PERMUTE && !xyz.empty()) {
    EXPECT_EQ(std::memcmp(xyz.data(), xyz_before.data(), xyz.size() * sizeof(Scalar)), 0);
  }
  for (const float value : outcome.picture.color) {
    if (!std::isfinite(value)) {
      ADD_FAILURE() << "a colour is not finite";
      break;
    }
  }
  return outcome;
}

template <class Test>
void in_every_order(const Test& test) {
  for (const std::uint32_t order : every_order) {
    SCOPED_TRACE(order);
    test(order);
  }
}

TEST(BadValues, PositionsThatAreNotFinite) {
  in_every_order([](std::uint32_t order) {
    Balls balls;
    balls.add(0, 0, 0, 1);
    balls.add(nan, 0, 0, 1);
    balls.add(0, infinity, 0, 1);
    balls.add(0, 0, -infinity, 1);
    balls.add(nan, nan, nan, 1);
    balls.add(2e100, 0, 0, 1);
    balls.add(3, 0, 0, 1);
    for (const Outcome& outcome : {draw<double>(balls, order), draw<float>(balls, order)}) {
      EXPECT_EQ(outcome.stats.items, 7u);
      EXPECT_EQ(outcome.stats.items_skipped, 5u);
      EXPECT_GT(outcome.picture.hits(), 0u);
      EXPECT_EQ(outcome.lower[0], -1.0);
      EXPECT_EQ(outcome.upper[0], 4.0);
    }
  });
}

TEST(BadValues, RadiiThatCannotBe) {
  in_every_order([](std::uint32_t order) {
    Balls balls;
    for (const double radius : {0.0, -0.0, -1.0, nan, infinity, -infinity, -denormal}) balls.add(0, 0, 0, radius);
    balls.add(1, 2, 3, 0.5);
    for (const Outcome& outcome : {draw<double>(balls, order), draw<float>(balls, order)}) {
      EXPECT_EQ(outcome.stats.items, 8u);
      EXPECT_EQ(outcome.stats.items_skipped, 7u);
      EXPECT_GT(outcome.picture.hits(), 0u);
      EXPECT_EQ(outcome.lower[2], 2.5);
      EXPECT_EQ(outcome.upper[2], 3.5);
    }
  });
}

TEST(BadValues, NothingIsLeftToDraw) {
  in_every_order([](std::uint32_t order) {
    Balls balls;
    for (int i = 0; i < 100; ++i) balls.add(nan, i, i, 1);
    const Outcome outcome = draw<double>(balls, order);
    EXPECT_EQ(outcome.stats.items, 100u);
    EXPECT_EQ(outcome.stats.items_skipped, 100u);
    EXPECT_EQ(outcome.picture.hits(), 0u);
    EXPECT_GT(outcome.lower[0], outcome.upper[0]);
  });
}

TEST(BadValues, RadiiByType) {
  const double table[3] = {1.0, 0.0, nan};
  const double xyz[18] = {};
  const std::int32_t types[6] = {0, 1, 2, 3, -1, 0};
  const insitu_array position = insitu_array_records(INSITU_F64, 3, xyz, 6, 0);
  const insitu_array type = insitu_array_records(INSITU_I32, 1, types, 6, 0);
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.position = &position;
  desc.type = &type;
  desc.type_radius = table;
  desc.type_radius_count = 3;
  Studio studio;
  ASSERT_TRUE(works(studio.context, studio.step(desc)));
  EXPECT_EQ(studio.context.stats().items_skipped, 4u) << "all but those of type 0";
  EXPECT_GT(studio.picture().hits(), 0u);
}

TEST(BadValues, NoParticles) {
  in_every_order([](std::uint32_t order) {
    insitu_array nothing = insitu_array_records(INSITU_F32, 3, nullptr, 0, 0);
    insitu_array no_values = insitu_array_records(INSITU_F64, 1, nullptr, 0, 0);
    nothing.flags = no_values.flags = INSITU_ARRAY_PERMUTABLE;
    const insitu_attribute attribute = {"heat", &no_values};
    insitu_particles_desc desc;
    insitu_particles_desc_init(&desc);
    desc.position = &nothing;
    desc.radius = &no_values;
    desc.attributes = &attribute;
    desc.attribute_count = 1;
    Studio studio(order);
    const insitu_style style = testing::make_style("heat", 0.0, 1.0);
    ASSERT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
    ASSERT_TRUE(works(studio.context, studio.step(desc)));
    EXPECT_EQ(studio.context.stats().items, 0u);
    EXPECT_EQ(studio.picture().hits(), 0u);
    // And then some again.
    testing::Cloud cloud(10);
    cloud.position.flags = INSITU_ARRAY_PERMUTABLE;
    insitu_style plain;
    insitu_style_init(&plain);
    ASSERT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &plain)));
    EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
    EXPECT_EQ(studio.context.stats().items, 10u);
  });
}

TEST(BadValues, OneParticle) {
  in_every_order([](std::uint32_t order) {
    Balls ball;
    ball.add(5, -3, 2, 0.25);
    for (const Outcome& outcome : {draw<double>(ball, order), draw<float>(ball, order)}) {
      EXPECT_GT(outcome.picture.hits(), 20u);
      EXPECT_EQ(outcome.lower[0], 4.75);
      EXPECT_EQ(outcome.upper[1], -2.75);
    }
    EXPECT_GT(draw<double>(ball, order, 1.0).picture.hits(), 20u);
  });
}

// The radius that the library picks is a matter of the world, not of the numbers that a coordinate is stored in.
TEST(BadValues, AutomaticRadiusInEveryLayout) {
  const double f64[6] = {0.25, 0.5, 0.75, 0.5, 0.5, 0.25};
  std::uint32_t u32[6];
  for (int i = 0; i < 6; ++i) u32[i] = static_cast<std::uint32_t>(f64[i] * 4294967296.0);
  for (const std::uint64_t count : {1u, 2u}) {
    SCOPED_TRACE(count);
    double upper[2][3];
    for (int integers = 0; integers < 2; ++integers) {
      const insitu_array position = integers == 1 ? insitu_array_records(INSITU_U32, 3, u32, count, 0)
                                                  : insitu_array_records(INSITU_F64, 3, f64, count, 0);
      insitu_particles_desc desc;
      insitu_particles_desc_init(&desc);
      desc.position = &position;
      desc.position_scale = integers == 1 ? 0x1p-32 : 0.0;
      Studio studio;
      double lower[3];
      insitu_step_begin(studio.context, 0, 0.0);
      insitu_particles_update(studio.context, studio.geometry, &desc);
      insitu_commit(studio.context);
      EXPECT_TRUE(
          works(studio.context, insitu_geometry_bounds(studio.context, studio.geometry, lower, upper[integers])));
      insitu_step_end(studio.context);
    }
    for (int c = 0; c < 3; ++c) EXPECT_DOUBLE_EQ(upper[0][c], upper[1][c]);
  }
}

TEST(BadValues, AllAtOnePoint) {
  in_every_order([](std::uint32_t order) {
    for (const int count : {2, 32, 33, 100, testing::sanitized ? 10000 : 100000}) {
      SCOPED_TRACE(count);
      Balls balls;
      for (int i = 0; i < count; ++i) balls.add(1.5, -2.5, 3.5, 0.5);
      const auto start = std::chrono::steady_clock::now();
      const Outcome each_radius = draw<double>(balls, order);
      const Outcome one_radius = draw<float>(balls, order, 0.5);
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      EXPECT_LT(seconds, 20.0);
      for (const Outcome* outcome : {&each_radius, &one_radius}) {
        EXPECT_EQ(outcome->stats.items_skipped, 0u);
        EXPECT_EQ(outcome->lower[0], 1.0);
        EXPECT_EQ(outcome->upper[2], 4.0);
        EXPECT_GT(outcome->picture.hits(), 20u);
      }
    }
  });
}

// One large point beside many small ones: radii from 1e-8 to 1e3.
TEST(BadValues, RadiiOfEveryMagnitude) {
  in_every_order([](std::uint32_t order) {
    Balls balls;
    testing::SplitMix64 random(5);
    for (int i = 0; i < 3000; ++i) {
      const double radius = std::pow(10.0, -8.0 + 11.0 * i / 2999.0);
      balls.add(1000 * random.unit(), 1000 * random.unit(), 1000 * random.unit(), radius);
    }
    for (const Outcome& outcome : {draw<double>(balls, order), draw<float>(balls, order)}) {
      EXPECT_EQ(outcome.stats.items_skipped, 0u);
      EXPECT_GT(outcome.picture.hits(), 20u);
    }
  });
}

// The same scene in units from the smallest to the largest.
TEST(BadValues, EveryUnitOfLength) {
  in_every_order([](std::uint32_t order) {
    for (const double unit : {1e-100, 1e-30, 1e-8, 1.0, 1e8, 1e30, 1e99}) {
      SCOPED_TRACE(unit);
      Balls balls;
      testing::SplitMix64 random(6);
      for (int i = 0; i < 200; ++i)
        balls.add(unit * random.unit(), unit * random.unit(), unit * random.unit(), 0.1 * unit);
      const Outcome outcome = draw<double>(balls, order);
      EXPECT_EQ(outcome.stats.items_skipped, 0u);
      EXPECT_GT(outcome.picture.hits(), 20u);
      EXPECT_GT(draw<double>(balls, order, 0.1 * unit).picture.hits(), 20u);
      if (unit >= 1e-30 && unit <= 1e30) {
        EXPECT_GT(draw<float>(balls, order).picture.hits(), 20u);
      }
    }
  });
}

// The radius is found from the spacing in every unit as well.
TEST(BadValues, AutomaticRadiusInEveryUnit) {
  for (const double unit : {1e-150, 1e-100, 1e-30, 1.0, 1e30, 1e99}) {
    SCOPED_TRACE(unit);
    double xyz[24];
    for (int i = 0; i < 8; ++i)
      for (int c = 0; c < 3; ++c) xyz[3 * i + c] = (i >> c & 1) != 0 ? unit : 0.0;
    const insitu_array position = insitu_array_records(INSITU_F64, 3, xyz, 8, 0);
    insitu_particles_desc desc;
    insitu_particles_desc_init(&desc);
    desc.position = &position;
    Studio studio;
    double lower[3];
    double upper[3];
    insitu_step_begin(studio.context, 0, 0.0);
    insitu_particles_update(studio.context, studio.geometry, &desc);
    insitu_commit(studio.context);
    EXPECT_TRUE(works(studio.context, insitu_geometry_bounds(studio.context, studio.geometry, lower, upper)));
    EXPECT_TRUE(works(studio.context, insitu_render(studio.context, studio.view, studio.image)));
    EXPECT_TRUE(works(studio.context, insitu_step_end(studio.context)));
    // Eight particles in a cube: each has a cube of half the edge, and a quarter of it as its radius.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(upper[c], 1.25 * unit, 1e-9 * unit);
    EXPECT_GT(studio.picture().hits(), 20u);
  }
}

TEST(BadValues, DenormalNumbers) {
  in_every_order([](std::uint32_t order) {
    Balls balls;
    for (int i = 0; i < 100; ++i) balls.add(i * denormal, 2 * i * denormal, 0, (i + 1) * denormal);
    EXPECT_EQ(draw<double>(balls, order).stats.items_skipped, 0u);
    balls.add(1, 1, 1, 1);
    const Outcome outcome = draw<double>(balls, order);
    EXPECT_EQ(outcome.stats.items_skipped, 0u);
    EXPECT_GT(outcome.picture.hits(), 20u);
  });
}

// Far away from the origin, and from each other.
TEST(BadValues, OneFarAway) {
  in_every_order([](std::uint32_t order) {
    Balls balls;
    for (int i = 0; i < 50; ++i) balls.add(i % 5, i / 5, 0, 0.5);
    balls.add(1e30, 0, 0, 0.5);
    balls.add(0, -1e30, 1e-30, 1e29);
    const Outcome outcome = draw<double>(balls, order);
    EXPECT_EQ(outcome.stats.items_skipped, 0u);
    EXPECT_GT(outcome.picture.hits(), 0u);
  });
}

// Values that colours come from may be anything.
TEST(BadValues, AttributesThatAreNotFinite) {
  testing::Cloud cloud(60);
  std::vector<double> values(60, nan);
  values[1] = infinity;
  values[2] = -infinity;
  const insitu_array value = insitu_array_records(INSITU_F64, 1, values.data(), 60, 0);
  const insitu_attribute attribute = {"heat", &value};
  cloud.desc.attributes = &attribute;
  cloud.desc.attribute_count = 1;
  cloud.desc.radius_default = 0.2;
  Studio studio;
  insitu_style style;
  insitu_style_init(&style);
  style.color_by = INSITU_COLOR_ATTRIBUTE;
  style.attribute = "heat";
  for (const char* map : {"viridis", "inferno", "coolwarm", "categorical", "elements"}) {
    SCOPED_TRACE(map);
    style.colormap = map;
    ASSERT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
    ASSERT_TRUE(works(studio.context, studio.step(cloud.desc)));
    const testing::Picture picture = studio.picture();
    EXPECT_GT(picture.hits(), 20u);
    for (const float channel : picture.color) ASSERT_TRUE(std::isfinite(channel));
  }
}

}  // namespace
}  // namespace insitu
