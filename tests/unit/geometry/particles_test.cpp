// A set of particles: radii, bounds, lattices of integers, attributes, and one answer for every policy and layout.
#include "geometry/particles/particles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

kernels::Ray ray_along_z(double x, double y, double from) {
  kernels::Ray ray{};
  ray.origin[0] = x;
  ray.origin[1] = y;
  ray.origin[2] = from;
  ray.direction[2] = 1.0;
  return ray;
}

TEST(Particles, BoundsIncludeRadii) {
  const std::vector<double> x = {0, 0, 0, 10, 20, 30};
  const std::vector<double> radius = {1, 2};
  ParticleArrays arrays;
  arrays.position = positions_of(x);
  arrays.radius = view_of(radius, 1, INSITU_USE_RADIUS);
  arrays.radius_scale = 0.5;
  Particles particles("p", ParticleOrder::index, false);
  Budget budget(0);
  particles.bind(std::move(arrays));
  particles.build(budget);
  double lower[3];
  double upper[3];
  particles.bounds(lower, upper);
  EXPECT_LE(lower[0], -0.5);
  EXPECT_GE(lower[0], -1.0);
  EXPECT_GE(upper[2], 31.0);
  EXPECT_LE(upper[2], 31.0 + 1e-9);
  EXPECT_EQ(particles.radius(1), 1.0);
}

TEST(Particles, AutomaticRadiusIsHalfTheMeanSpacing) {
  std::vector<double> x;
  for (int i = 0; i < 1000; ++i) x.insert(x.end(), {1.0 * (i % 10), 1.0 * (i / 10 % 10), 1.0 * (i / 100)});
  const auto radius_of = [](const std::vector<double>& positions, double scale) {
    ParticleArrays arrays;
    arrays.position = positions_of(positions);
    arrays.radius_scale = scale;
    Particles particles("p", ParticleOrder::index, false);
    Budget budget(0);
    particles.bind(std::move(arrays));
    particles.build(budget);
    return particles.radius(0);
  };
  EXPECT_NEAR(radius_of(x, 1.0), 0.5 * 0.9, 1e-12);  // edge 9, ten particles along it
  EXPECT_NEAR(radius_of(x, 2.0), 0.9, 1e-12);
  // A flat and a straight set: only the directions that have an extent count.
  for (std::size_t i = 0; i < x.size(); i += 3) x[i + 2] = 5.0;
  EXPECT_NEAR(radius_of(x, 1.0), 0.5 * std::sqrt(81.0 / 1000.0), 1e-12);
  for (std::size_t i = 0; i < x.size(); i += 3) x[i + 1] = 5.0;
  EXPECT_NEAR(radius_of(x, 1.0), 0.5 * 9.0 / 1000.0, 1e-12);
  // A point has none: 1.
  EXPECT_EQ(radius_of({2, 2, 2, 2, 2, 2}, 1.0), 1.0);
}

TEST(Particles, TypesOutsideOfTheTableAreSkipped) {
  const std::vector<double> x = {0, 0, 0, 5, 0, 0, 10, 0, 0, 15, 0, 0};
  const std::vector<std::int32_t> type = {0, 1, 2, -1};
  ParticleArrays arrays;
  arrays.position = positions_of(x);
  arrays.type = view_of(type, 1, INSITU_USE_TYPE);
  arrays.type_radius = {1.0, 2.0};
  Particles particles("p", ParticleOrder::index, false);
  Budget budget(0);
  particles.bind(std::move(arrays));
  particles.build(budget);
  EXPECT_EQ(particles.drawn_count(), 2u);
  kernels::Ray rays[4];
  kernels::Hit hits[4];
  for (int i = 0; i < 4; ++i) rays[i] = ray_along_z(5.0 * i, 0.0, -10.0);
  particles.first_hits(rays, hits, 4);
  EXPECT_EQ(hits[0].t, 9.0);
  EXPECT_EQ(hits[1].t, 8.0);
  EXPECT_EQ(hits[1].item, 1u);
  EXPECT_FALSE(hits[2].found());
  EXPECT_FALSE(hits[3].found());
}

TEST(Particles, RadiiThatAreAllTheSameAreOneForAll) {
  const std::vector<double> x = {0, 0, 0, 5, 0, 0, 10, 0, 0};
  Budget budget(0);
  const auto built = [&](const std::vector<float>& radius, Particles& particles) {
    ParticleArrays arrays;
    arrays.position = positions_of(x);
    arrays.radius = view_of(radius, 1, INSITU_USE_RADIUS);
    arrays.radius_scale = 0.5;
    particles.bind(std::move(arrays));
    particles.build(budget);
    kernels::Ray rays[3];
    kernels::Hit hits[3];
    for (int i = 0; i < 3; ++i) rays[i] = ray_along_z(5.0 * i, 0.0, -10.0);
    particles.first_hits(rays, hits, 3);
    return std::vector<double>{hits[0].t, hits[1].t, hits[2].t};
  };
  const std::vector<float> same = {2.0f, 2.0f, 2.0f};
  Particles equal("p", ParticleOrder::index, false);
  EXPECT_THAT(built(same, equal), ::testing::ElementsAre(9.0, 9.0, 9.0));
  EXPECT_EQ(equal.tree().radius.kind, kernels::RadiusView::Kind::uniform);
  // One that is not drawn has no radius: it must not be given that of the others.
  const std::vector<float> holed = {2.0f, 0.0f, 2.0f};
  Particles some("p", ParticleOrder::index, false);
  EXPECT_THAT(built(holed, some), ::testing::ElementsAre(9.0, kernels::Hit{}.t, 9.0));
  EXPECT_EQ(some.tree().radius.kind, kernels::RadiusView::Kind::per_item);
}

// Against the radii worked out here: at entries, between them, beyond both ends, and where there is none.
TEST(Particles, RadiiFollowTheValuesOfAnAttribute) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> value = {-infinity, 0.0f, 1.0f, 1.5f, 2.0f, 2.25f, 3.0f, 9.0f, infinity, nan};
  const std::vector<double> expected = {0.5, 0.5, 1.0, 1.5, 2.0,
                                        1.5, 0.0, 0.0, 0.0, 0.0};  // as radii, before the scale
  const std::vector<double> table = {0.5, 1.0, 2.0, 0.0};          // at 0, 1, 2, 3
  for (const ParticleOrder order : {ParticleOrder::index, ParticleOrder::permute, ParticleOrder::copy}) {
    for (const std::uint32_t component : {0u, 2u}) {
      std::vector<double> x;
      std::vector<float> values;  // the scalar, or the second component of a vector
      for (std::size_t i = 0; i < value.size(); ++i) {
        x.insert(x.end(), {10.0 * static_cast<double>(i), 0.0, 0.0});
        if (component == 2) values.push_back(77.0f);
        values.push_back(value[i]);
      }
      ParticleArrays arrays;
      arrays.position = positions_of(x);
      arrays.radius_scale = 2.0;
      arrays.attributes.push_back({"heat", attribute_of(values, component == 2 ? 2 : 1)});
      arrays.radius_map = RadiusMap{arrays.attributes.back().view, component, {0.0, 3.0}, table};
      Particles particles("p", order, false);
      Budget budget(0);
      particles.bind(std::move(arrays));
      particles.build(budget);
      EXPECT_EQ(particles.drawn_count(), 6u);
      for (std::size_t i = 0; i < value.size(); ++i) {
        const kernels::Ray ray = ray_along_z(10.0 * static_cast<double>(i), 0.0, -10.0);
        kernels::Hit hit;
        particles.first_hits(&ray, &hit, 1);
        ASSERT_EQ(hit.found(), expected[i] > 0.0) << value[i];
        EXPECT_EQ(hit.t, hit.found() ? 10.0 - 2.0 * expected[i] : hit.t) << value[i];
      }
    }
  }
}

// The same points as f64 and as integers with a scale and an origin: the same items, and distances to rounding.
TEST(Particles, LatticesAgreeWithWorldCoordinates) {
  CounterRandom random(21);
  constexpr std::uint64_t count = 400;
  const double scale = 1.0 / 1048576.0;
  const double origin[3] = {100.0, -50.0, 1e5};
  std::vector<std::int32_t> lattice;
  std::vector<std::uint32_t> unsigned_lattice;
  std::vector<double> world;
  for (std::uint64_t i = 0; i < 3 * count; ++i) {
    lattice.push_back(static_cast<std::int32_t>(random.below(1 << 22)));
    unsigned_lattice.push_back(static_cast<std::uint32_t>(lattice.back()) + 3000000000u);
    world.push_back(origin[i % 3] + scale * lattice.back());
  }
  const auto build = [&](Particles& particles, ParticleArrays arrays) {
    static Budget budget(0);
    arrays.radius_default = 0.1;
    particles.bind(std::move(arrays));
    particles.build(budget);
  };
  Particles truth("world", ParticleOrder::index, false);
  Particles as_i32("i32", ParticleOrder::index, false);
  Particles as_u32("u32", ParticleOrder::copy, false);
  ParticleArrays arrays;
  arrays.position = positions_of(world);
  build(truth, arrays);
  arrays.position_scale = scale;
  std::copy_n(origin, 3, arrays.position_origin);
  arrays.position = positions_of(lattice);
  build(as_i32, arrays);
  for (double& o : arrays.position_origin) o -= scale * 3000000000.0;
  arrays.position = positions_of(unsigned_lattice);
  build(as_u32, arrays);

  std::uint64_t hits = 0;
  for (std::uint64_t i = 0; i < 600; ++i) {  // more than one batch of rays
    kernels::Ray ray{};
    random.direction(ray.direction);
    for (std::uint64_t c = 0; c < 3; ++c) ray.origin[c] = world[3 * (i % count) + c] - 7.0 * ray.direction[c];
    kernels::Hit expected;
    truth.first_hits(&ray, &expected, 1);
    for (const Particles* particles : {&as_i32, &as_u32}) {
      kernels::Hit hit;
      particles->first_hits(&ray, &hit, 1);
      EXPECT_EQ(hit.item, expected.item);
      EXPECT_NEAR(hit.t, expected.t, 1e-9);
      std::uint8_t occluded = 0;
      particles->any_hits(&ray, &occluded, 1);
      EXPECT_EQ(occluded != 0, expected.found());
      const std::vector<kernels::Span> spans = particles->all_hits(ray);
      ASSERT_FALSE(spans.empty());
      EXPECT_NEAR(spans[0].t_enter, expected.t, 1e-9);
      double centre[3];
      particles->centre(hit.item, centre);
      for (std::uint64_t c = 0; c < 3; ++c) EXPECT_NEAR(centre[c], world[3 * hit.item + c], 1e-9);
      EXPECT_NEAR(particles->radius(hit.item), 0.1, 1e-15);
    }
    hits += expected.found() ? 1 : 0;
  }
  EXPECT_EQ(hits, 600u);
}

// The three policies and several layouts of the same numbers give the same hits, bit for bit.
TEST(Particles, PoliciesAndLayoutsAgree) {
  CounterRandom random(22);
  constexpr std::uint64_t count = 3000;
  std::vector<double> x = make_cloud(Shape::clustered, count, 1.0, random);
  for (double& v : x) v = static_cast<float>(v);
  std::vector<kernels::Ray> rays(500);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    random.direction(rays[i].direction);
    for (std::size_t c = 0; c < 3; ++c) rays[i].origin[c] = x[3 * i + c] - 2.0 * rays[i].direction[c];
  }
  std::vector<std::vector<double>> distances;
  std::vector<std::vector<double>> ids;
  for (const ParticleOrder order : {ParticleOrder::index, ParticleOrder::permute, ParticleOrder::copy}) {
    for (const int layout : {0, 1, 2}) {
      std::vector<double> wide = x;
      std::vector<float> narrow(x.begin(), x.end());
      std::vector<double> columns[3];
      for (std::size_t i = 0; i < x.size(); ++i) columns[i % 3].push_back(x[i]);
      std::vector<double> id(count);
      for (std::uint64_t i = 0; i < count; ++i) id[i] = static_cast<double>(i);
      ParticleArrays arrays;
      arrays.position = layout == 0   ? positions_of(wide)
                        : layout == 1 ? positions_of(narrow)
                                      : checked_view(insitu_array_columns(INSITU_F64, columns[0].data(),
                                                                          columns[1].data(), columns[2].data(), count),
                                                     INSITU_USE_POSITION, "");
      arrays.attributes.push_back({"id", attribute_of(id)});
      arrays.radius_default = 0.01;
      Particles particles("p", order, false);
      Budget budget(0);
      particles.bind(std::move(arrays));
      particles.build(budget);
      std::vector<kernels::Hit> hits(rays.size());
      particles.first_hits(rays.data(), hits.data(), rays.size());
      distances.emplace_back();
      ids.emplace_back();
      for (const kernels::Hit& hit : hits) {
        ASSERT_TRUE(hit.found());
        distances.back().push_back(hit.t);
        ids.back().push_back(particles.attribute("id")->value(hit.item));
      }
      EXPECT_EQ(distances.back(), distances.front());
      EXPECT_EQ(ids.back(), ids.front());
    }
  }
}

// Coincident particles: larger radius first, then the values of attributes; not the place in the arrays.
TEST(Particles, WhoIsShownDoesNotDependOnTheOrder) {
  const std::vector<double> value = {3, 1, 2};
  for (const std::uint64_t twins : {3u, 60u}) {  // within a leaf, and a whole run of them
    for (int turn = 0; turn < 3; ++turn) {
      std::vector<double> x;
      std::vector<double> values;
      for (std::uint64_t i = 0; i < twins; ++i) {
        x.insert(x.end(), {0.5, 0.5, 0.5});
        values.push_back(value[(i + static_cast<std::uint64_t>(turn)) % 3]);
      }
      ParticleArrays arrays;
      arrays.position = positions_of(x);
      arrays.attributes.push_back({"v", attribute_of(values)});
      arrays.radius_default = 0.25;
      Particles particles("p", ParticleOrder::index, false);
      Budget budget(0);
      particles.bind(std::move(arrays));
      particles.build(budget);
      const kernels::Ray ray = ray_along_z(0.5, 0.5, -1.0);
      kernels::Hit hit;
      particles.first_hits(&ray, &hit, 1);
      EXPECT_EQ(hit.t, 1.25);
      EXPECT_EQ(values.at(hit.item), 1.0) << twins << " twins, turned by " << turn;
    }
  }
}

TEST(StyledValue, IsAComponentOrALength) {
  const std::vector<double> v = {3, 4, 0, 1e300, 1e300, 0, 1e-300, 0, 0, 0, 0, 0};
  const kernels::ArrayView view = attribute_of(v, 3);
  EXPECT_EQ(kernels::attribute_value(view, 0, 1), 3.0);
  EXPECT_EQ(kernels::attribute_value(view, 0, 2), 4.0);
  EXPECT_DOUBLE_EQ(kernels::attribute_value(view, 0, 0), 5.0);
  EXPECT_DOUBLE_EQ(kernels::attribute_value(view, 1, 0), std::sqrt(2.0) * 1e300);  // its square overflows
  EXPECT_DOUBLE_EQ(kernels::attribute_value(view, 2, 0), 1e-300);                  // its square vanishes
  EXPECT_EQ(kernels::attribute_value(view, 3, 0), 0.0);
  const std::vector<float> scalar = {-7.0f};
  EXPECT_EQ(kernels::attribute_value(attribute_of(scalar), 0, 0), -7.0);
}

// A length with a NaN in it is none, wherever it stands.
TEST(StyledValue, NaNStaysNaN) {
  for (std::size_t at = 0; at < 3; ++at) {
    for (const double other : {0.0, 1.0}) {
      std::vector<double> v(3, other);
      v[at] = nan;
      EXPECT_TRUE(std::isnan(kernels::attribute_value(attribute_of(v, 3), 0, 0)))
          << "NaN at " << at << ", others " << other;
    }
    std::vector<double> v(3, 1.0);
    v[at] = -infinity;
    EXPECT_EQ(kernels::attribute_value(attribute_of(v, 3), 0, 0), infinity);
  }
}

TEST(ValueRange, IsThatOfTheFiniteValues) {
  const std::vector<double> v = {1, nan, -2, infinity, 5, -infinity};
  const ValueRange range = value_range(attribute_of(v), 0);
  EXPECT_EQ(range.low, -2.0);
  EXPECT_EQ(range.high, 5.0);
  EXPECT_FALSE(range.empty());
  const std::vector<double> hopeless = {nan, infinity};
  EXPECT_TRUE(value_range(attribute_of(hopeless), 0).empty());
  const std::vector<std::int32_t> vectors = {3, 4, -6, 8};
  EXPECT_EQ(value_range(attribute_of(vectors, 2), 0).high, 10.0);
  EXPECT_EQ(value_range(attribute_of(vectors, 2), 1).low, -6.0);
}

TEST(Particles, AttributesAreFoundByName) {
  const std::vector<double> x = {0, 0, 0};
  const std::vector<double> mass = {1};
  const std::vector<std::uint8_t> type = {6};
  ParticleArrays arrays;
  arrays.position = positions_of(x);
  arrays.type = view_of(type, 1, INSITU_USE_TYPE);
  arrays.attributes.push_back({"mass", attribute_of(mass)});
  Particles particles("p", ParticleOrder::index, false);
  EXPECT_EQ(particles.attribute("mass"), nullptr);
  EXPECT_EQ(particles.attribute_names(), "none");
  particles.bind(std::move(arrays));
  ASSERT_NE(particles.attribute("mass"), nullptr);
  ASSERT_NE(particles.attribute("type"), nullptr);
  EXPECT_EQ(particles.attribute("type")->value(0), 6.0);
  EXPECT_EQ(particles.attribute("charge"), nullptr);
  EXPECT_EQ(particles.attribute_names(), "mass, type");
  particles.release();
  EXPECT_EQ(particles.attribute("mass"), nullptr);
}

// One bit, anywhere, changes the sum; the order of the records does not.
TEST(Particles, ChecksumSeesEveryBitAndNoOrder) {
  CounterRandom random(30);
  std::vector<double> x = make_cloud(Shape::uniform, 100, 1.0, random);
  std::vector<std::uint8_t> payload(100 * 7);
  for (std::uint8_t& b : payload) b = static_cast<std::uint8_t>(random.next());
  const auto checksum = [&] {
    ParticleArrays arrays;
    arrays.position = positions_of(x);
    arrays.payload.push_back(view_of(payload, 7, use_payload));
    Particles particles("p", ParticleOrder::index, false);
    particles.bind(std::move(arrays));
    return particles.checksum();
  };
  const std::uint64_t before = checksum();
  payload[450] ^= 1;
  EXPECT_NE(checksum(), before);
  payload[450] ^= 1;
  std::swap_ranges(x.begin(), x.begin() + 3, x.begin() + 30);
  EXPECT_NE(checksum(), before) << "records torn apart";
  std::swap_ranges(payload.begin(), payload.begin() + 7, payload.begin() + 70);
  EXPECT_EQ(checksum(), before);
}

}  // namespace
}  // namespace insitu::testing
