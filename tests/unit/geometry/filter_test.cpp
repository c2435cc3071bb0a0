// A set of particles under a filter: what is hit, where it ends, what it costs, and that its tree stays.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "geometry/particles/particle_image.h"
#include "geometry/particles/particles.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/counter_random.h"

namespace insitu::testing {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::shared_ptr<const Filter> between(const std::string& attribute, double low, double high, bool negated = false) {
  std::vector<FilterTerm> terms(1);
  terms[0].attribute = attribute;
  terms[0].range[0] = low;
  terms[0].range[1] = high;
  terms[0].negated = negated;
  return std::make_shared<const Filter>(std::move(terms));
}

struct Cloud {
  std::vector<double> x;
  std::vector<double> radius;
  std::vector<double> value;

  explicit Cloud(std::size_t count) {
    CounterRandom random(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (int c = 0; c < 3; ++c) x.push_back(random.unit());
      radius.push_back(0.02 + 0.05 * random.unit());
      value.push_back(random.unit());
    }
  }
  // The particles with a value up to that, alone.
  Cloud up_to(double high) const {
    Cloud left(0);
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (!(value[i] <= high)) continue;
      left.x.insert(left.x.end(), &x[3 * i], &x[3 * i] + 3);
      left.radius.push_back(radius[i]);
      left.value.push_back(value[i]);
    }
    return left;
  }
  ParticleArrays arrays(double treelet_share, bool each_radius) {
    ParticleArrays arrays;
    arrays.position = positions_of(x);
    if (each_radius) arrays.radius = view_of(radius, 1, INSITU_USE_RADIUS);
    arrays.radius_default = 0.05;
    arrays.attributes.push_back({"value", attribute_of(value)});
    arrays.treelet_share = treelet_share;
    return arrays;
  }
};

std::vector<kernels::Ray> some_rays() {
  std::vector<kernels::Ray> rays(400);
  CounterRandom random(4);
  for (kernels::Ray& ray : rays) {
    random.direction(ray.direction);
    for (int c = 0; c < 3; ++c) ray.origin[c] = 0.5 + 0.3 * random.between(-1, 1) - 2.0 * ray.direction[c];
  }
  return rays;
}

// The same distances as those of the particles that are left, alone: for every order, with treelets and without.
void expect_as_alone(const Particles& filtered, const Cloud& all, Cloud left, bool each_radius) {
  Budget budget(0);
  Particles alone("alone", ParticleOrder::index, false);
  alone.bind(left.arrays(0.0, each_radius));
  alone.build(budget);
  const std::vector<kernels::Ray> rays = some_rays();
  std::vector<kernels::Hit> hits(rays.size());
  std::vector<kernels::Hit> expected(rays.size());
  std::vector<std::uint8_t> occluded(rays.size(), 0);
  filtered.first_hits(rays.data(), hits.data(), rays.size());
  filtered.any_hits(rays.data(), occluded.data(), rays.size());
  alone.first_hits(rays.data(), expected.data(), rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits[i].t, expected[i].t);
    EXPECT_EQ(occluded[i] != 0, expected[i].found());
    const auto spans = filtered.all_hits(rays[i]);
    EXPECT_EQ(spans.size(), alone.all_hits(rays[i]).size());
  }
  double bounds[4][3];
  filtered.bounds(bounds[0], bounds[1]);
  alone.bounds(bounds[2], bounds[3]);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(bounds[0][c], bounds[2][c]);
    EXPECT_EQ(bounds[1][c], bounds[3][c]);
  }
  EXPECT_EQ(filtered.shown_count(), left.value.size());
  EXPECT_EQ(filtered.drawn_count(), all.value.size());
}

TEST(ParticleFilter, IsTheParticlesThatAreLeft) {
  for (const std::size_t count : {1u, 50u, 5000u}) {
    for (const ParticleOrder order : {ParticleOrder::index, ParticleOrder::permute, ParticleOrder::copy}) {
      for (const double share : {0.0, 0.3}) {
        for (const bool each_radius : {false, true}) {
          const Cloud given(count);
          Cloud cloud = given;
          Budget budget(0);
          Particles particles("p", order, true);
          particles.bind(cloud.arrays(share, each_radius));
          particles.set_filter(between("value", -infinity, 0.3));
          particles.build(budget);
          expect_as_alone(particles, given, given.up_to(0.3), each_radius);
          // Changed, opened and closed in the same tree.
          const PkdBuilt::How how = particles.how_built().how;
          for (const double high : {0.9, 0.05, -1.0, 2.0, 0.5}) {
            particles.set_filter(between("value", -infinity, high));
            particles.select(budget);
            expect_as_alone(particles, given, given.up_to(high), each_radius);
            if (count == 5000) {
              EXPECT_EQ(particles.tree().copies.exist(), share > 0.0 && high > 0.0 && high < 0.5) << high;
              EXPECT_EQ(particles.treelets().exist(), share > 0.0);
            }
          }
          EXPECT_EQ(particles.how_built().how, how);
          particles.set_filter(nullptr);
          particles.select(budget);
          expect_as_alone(particles, given, given.up_to(infinity), each_radius);
        }
      }
    }
  }
}

// Treelets hold as many particles that are drawn as they hold without a filter: 16, or half as many, because their
// number is a power of two. Of very few particles they are shorter than that.
TEST(ParticleFilter, LeavesTreeletsFull) {
  Cloud cloud(150000);
  Budget budget(0);
  Particles particles("p", ParticleOrder::permute, true);
  particles.bind(cloud.arrays(0.3, false));
  particles.build(budget);
  const std::uint64_t all = particles.treelets().count;
  for (const double high : {0.5, 0.1, 0.02}) {
    particles.set_filter(between("value", -infinity, high));
    particles.select(budget);
    const double held = static_cast<double>(particles.shown_count()) / static_cast<double>(particles.treelets().count);
    EXPECT_GT(held, 8.0) << high;
    EXPECT_LE(held, 16.5) << high;
  }
  particles.set_filter(between("value", -infinity, 0.0001));
  particles.select(budget);
  EXPECT_GE(particles.treelets().count, cloud.value.size() / 4096);
  particles.set_filter(nullptr);
  particles.select(budget);
  EXPECT_EQ(particles.treelets().count, all);
}

TEST(ParticleFilter, ItsBitsAreCountedAndGivenBack) {
  Cloud cloud(100000);
  Budget budget(0);
  Particles particles("p", ParticleOrder::permute, false);
  particles.bind(cloud.arrays(0.0, false));
  particles.build(budget);
  EXPECT_EQ(budget.owned(), 0u);
  particles.set_filter(between("value", 0.0, 0.5));
  particles.select(budget);
  EXPECT_GE(budget.owned(), 100000u / 8);
  EXPECT_LE(budget.owned(), 100000u / 8 + 100000u / 400 + 64);
  particles.set_filter(nullptr);
  particles.select(budget);
  EXPECT_EQ(budget.owned(), 0u);

  Budget small(1000);
  particles.set_filter(between("value", 0.0, 0.5));
  try {
    particles.select(small);
    FAIL() << "over the budget";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), INSITU_ERROR_OVER_BUDGET);
    EXPECT_NE(std::string(error.what()).find("filter"), std::string::npos);
  }
}

// Treelets and copies of what is left share what was granted for treelets; without a grant there are none.
TEST(ParticleFilter, CopiesStayWithinTheShareOfTreelets) {
  for (const double share : {0.0, 0.001, 0.01, 0.03, 0.1, 0.3}) {
    Cloud cloud(20000);
    Budget budget(0);
    Particles particles("p", ParticleOrder::permute, false);
    particles.bind(cloud.arrays(share, false));
    particles.build(budget);
    bool copied = false;
    for (const double high : {1.0, 0.4, 0.1, 0.02, 0.9, 0.0}) {
      particles.set_filter(between("value", 0.0, high));
      particles.select(budget);
      EXPECT_LE(static_cast<double>(budget.owned()), share * 24.0 * 20000.0 + 20000.0 / 8 + 20000.0 / 400 + 64.0);
      EXPECT_LE(particles.particles_per_treelet(), share >= 0.1 && high == 1.0 ? 16.0 : 1e9);
      copied = copied || particles.tree().copies.exist();
    }
    EXPECT_EQ(copied, share >= 0.03) << share;
  }
}

TEST(ParticleFilter, LastsFromStepToStep) {
  Budget budget(0);
  Particles particles("p", ParticleOrder::index, false);
  particles.set_filter(between("value", 0.0, 0.5));
  for (const std::size_t count : {3000u, 2000u}) {
    Cloud cloud(count);
    const Cloud given = cloud;
    particles.bind(cloud.arrays(0.2, false));
    particles.build(budget);
    expect_as_alone(particles, given, given.up_to(0.5), false);
    particles.release();
  }
}

TEST(ParticleFilter, NamesWhatIsMissing) {
  Cloud cloud(3);
  Particles particles("stars", ParticleOrder::index, false);
  particles.bind(cloud.arrays(0.0, false));
  EXPECT_NO_THROW(particles.check_filter(*between("value", 0, 1)));
  try {
    particles.check_filter(*between("speed", 0, 1));
    FAIL() << "there is no speed";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("stars"), std::string::npos) << text;
    EXPECT_NE(text.find("'speed'"), std::string::npos) << text;
    EXPECT_NE(text.find("there are: value"), std::string::npos) << text;
  }
}

// Wrapped into a cell, a set has images only where particles are left.
TEST(ParticleFilter, LeavesImagesOfTheCellOut) {
  std::vector<double> x = {0.5, 0.5, 0.5, 1.5, 0.5, 0.5, 2.5, 0.5, 0.5};
  std::vector<double> value = {0.0, 1.0, 2.0};
  ParticleArrays arrays;
  arrays.position = positions_of(x);
  arrays.radius_default = 0.1;
  arrays.attributes.push_back({"value", attribute_of(value)});
  Budget budget(0);
  Particles particles("p", ParticleOrder::index, false);
  particles.bind(std::move(arrays));
  particles.build(budget);
  Cell cell;
  for (int i = 0; i < 3; ++i) cell.edge[i][i] = 1.0;
  for (bool& p : cell.periodic) p = true;
  cell.prepare();
  EXPECT_EQ(occupied_images(particles, cell).size(), 3u);
  particles.set_filter(between("value", 1.0, 1.0, true));
  particles.select(budget);
  EXPECT_EQ(occupied_images(particles, cell).size(), 2u);
}

}  // namespace
}  // namespace insitu::testing
