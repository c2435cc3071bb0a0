// Sticks through their tree against every stick one by one; bonds by distance against every pair.
#include "geometry/sticks/sticks.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "core/workers.h"
#include "geometry/sticks/arrows.h"
#include "geometry/sticks/bonds.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/counter_random.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {
namespace {

ParticlePoints points_of(const std::vector<double>& x) {
  ParticlePoints points;
  points.position = positions_of(x);
  return points;
}

template <class Source>
void expect_brute_force(const Source& source, std::uint64_t end, double size, double distance, std::uint64_t seed) {
  Budget budget(0);
  Sticks<Source> sticks;
  sticks.build(budget, source, end, "test");
  std::vector<kernels::Stick> all;
  std::vector<std::uint64_t> ids;
  kernels::Stick stick{};
  for (std::uint64_t id = 0; id < end; ++id) {
    if (!source.stick(id, stick)) continue;
    all.push_back(stick);
    ids.push_back(id);
  }
  ASSERT_EQ(sticks.drawn_count(), all.size());
  ASSERT_FALSE(all.empty());
  CounterRandom random(seed);
  std::size_t found = 0;
  constexpr std::size_t rays = 400;
  for (std::size_t i = 0; i < rays; ++i) {
    kernels::Ray ray{};
    random.direction(ray.direction);
    if (i % 9 == 0) {
      for (double& d : ray.direction) d = random.below(2) == 0 ? 0.0 : -0.0;
      ray.direction[random.below(3)] = random.sign();
    }
    const kernels::Stick& aim = all[random.below(all.size())];
    const double along = random.unit();
    for (int c = 0; c < 3; ++c)
      ray.origin[c] = aim.a[c] + along * (aim.b[c] - aim.a[c]) + 1.5 * aim.radius * random.between(-1.0, 1.0) -
                      distance * ray.direction[c];
    if (i % 5 == 0) ray.t_max = distance + size * random.between(-0.5, 0.5);
    if (i % 7 == 0) ray.t_min = distance * random.unit();
    if (i % 3 == 0) ray.exclude = ids[random.below(ids.size())];
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < all.size(); ++k)
      if (ids[k] != ray.exclude)
        nearest = std::min(nearest, kernels::stick_first_hit(ray.origin, ray.direction, all[k], ray.t_min));
    if (nearest > ray.t_max) nearest = std::numeric_limits<double>::infinity();
    kernels::Hit hit;
    std::uint8_t occluded = 0;
    sticks.first_hits(&ray, &hit, 1);
    sticks.any_hits(&ray, &occluded, 1);
    EXPECT_EQ(hit.t, nearest) << "ray " << i << " distance " << distance;
    EXPECT_EQ(occluded != 0, std::isfinite(nearest));
    if (!hit.found()) continue;
    ++found;
    EXPECT_TRUE(source.stick(hit.item, stick));
    EXPECT_EQ(kernels::stick_first_hit(ray.origin, ray.direction, stick, ray.t_min), nearest);
    // Of equal ones the preferred one.
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (ids[k] == ray.exclude || ids[k] == hit.item) continue;
      if (kernels::stick_first_hit(ray.origin, ray.direction, all[k], ray.t_min) == nearest) {
        EXPECT_FALSE(source.prefer(ids[k], hit.item));
      }
    }
    // A hit at the same distance that was there before stays.
    kernels::Hit before{nearest, 12345};
    sticks.first_hits(&ray, &before, 1);
    EXPECT_EQ(before.item, 12345u);
  }
  EXPECT_GT(found, rays / 5);
}

TEST(Sticks, AgreeWithEveryStickOneByOne) {
  for (const double size : {1e-60, 1e-6, 1.0, 1e6, 1e60}) {
    for (const std::size_t count : {1u, 7u, 9u, 500u}) {
      CounterRandom random(count);
      const std::vector<double> x = make_cloud(Shape::uniform, 2 * count, size, random);
      std::vector<std::int32_t> pairs(2 * count);
      for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = static_cast<std::int32_t>(i);
      BondSource source;
      source.points = points_of(x);
      source.pairs.base[0] = reinterpret_cast<const std::byte*>(pairs.data());
      source.pairs.base[1] = source.pairs.base[0] + 4;
      source.pairs.stride = 8;
      source.pairs.count = count;
      source.pairs.components = 2;
      source.pairs.type = kernels::Scalar::i32;
      source.radius = 0.02 * size;
      for (const kernels::StickEnds ends : {kernels::StickEnds::flat, kernels::StickEnds::round}) {
        source.ends = ends;
        for (const double distance : {0.0, 2.0, 1e5}) expect_brute_force(source, 2 * count, size, distance * size, 3);
      }
    }
  }
}

// Chains: the round ends of neighbours are the same half balls, so that many hits are at exactly the same distance.
TEST(Sticks, OfBallsThatCoincideOneIsShown) {
  std::vector<double> x;
  for (int i = 0; i < 60; ++i) x.insert(x.end(), {double(i % 4), double(i / 4 % 4), double(i / 16)});
  BondSource source;
  source.points = points_of(x);
  source.radius = 0.2;
  Budget budget(0);
  BudgetVector<FoundBond> pairs;
  BondSearch search;
  search.cutoff = 1.1;
  find_bonds(budget, source.points, search, pairs);
  source.found = pairs.data();
  source.found_count = pairs.size();
  expect_brute_force(source, 2 * pairs.size(), 4.0, 9.0, 4);
}

TEST(Sticks, ArrowsAgreeOneByOne) {
  CounterRandom random(5);
  const std::vector<double> x = make_cloud(Shape::uniform, 300, 1.0, random);
  std::vector<double> v = make_cloud(Shape::uniform, 300, 1.0, random);
  for (std::size_t i = 0; i < 30; ++i) v[i] = 0.0;  // ten that have no length
  ArrowSource source;
  source.points = points_of(x);
  source.vectors = positions_of(v);
  source.scale = 0.2;
  source.radius = 0.01;
  source.head_radius = 0.025;
  source.head_length = 0.06;
  for (const bool centred : {false, true}) {
    source.centred = centred;
    expect_brute_force(source, 600, 1.0, 3.0, 6);
  }
}

Cell some_cell(bool tilted, double edge) {
  Cell cell;
  for (int i = 0; i < 3; ++i) {
    cell.origin[i] = -0.3 * edge;
    cell.edge[i][i] = edge * (1.0 + 0.2 * i);
    cell.periodic[i] = true;
  }
  if (tilted) {
    cell.edge[1][0] = 0.45 * edge;
    cell.edge[2][0] = -0.4 * edge;
    cell.edge[2][1] = 0.3 * edge;
  }
  cell.prepare();
  return cell;
}

// The shortest of the difference and its images, two cells to every side.
double shortest(const Cell& cell, const double d[3]) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 125; ++k) {
    const double count[3] = {k % 5 - 2.0, k / 5 % 5 - 2.0, k / 25 - 2.0};
    double offset[3];
    cell.offset_of(count, offset);
    best = std::min(best, std::hypot(d[0] - offset[0], d[1] - offset[1], d[2] - offset[2]));
  }
  return best;
}

TEST(BondSearch, FindsEveryPair) {
  for (const Shape shape : {Shape::uniform, Shape::clustered}) {
    for (const int cell_kind : {0, 1, 2, 3}) {  // none, straight, tilted, tilted and smaller than the longest bond
      for (const double cutoff : {0.02, 0.1, 0.37}) {
        CounterRandom random(11);
        std::vector<double> x = make_cloud(shape, 90, 1.0, random);
        x[30] = std::numeric_limits<double>::quiet_NaN();
        for (int c = 0; c < 3; ++c) x[60 + c] = x[90 + c];  // two at one place: no bond
        ParticlePoints points = points_of(x);
        BondSearch search;
        search.cutoff = cutoff;
        if (cell_kind > 0) {
          if (cell_kind == 3)
            for (double& v : x) v *= 0.4;
          points.cell = some_cell(cell_kind >= 2, cell_kind == 3 ? 0.35 : 0.9);
          search.periodic = true;
        }
        // Each bond from either end, with the vector between the ends.
        using Bond = std::tuple<std::uint32_t, std::uint32_t, int, int, int>;
        std::set<Bond> expected;
        for (std::uint32_t i = 0; i < 90; ++i) {
          for (std::uint32_t j = 0; j < 90; ++j) {
            for (int k = 0; k < (search.periodic ? 343 : 1); ++k) {
              const int n[3] = {search.periodic ? k % 7 - 3 : 0, search.periodic ? k / 7 % 7 - 3 : 0,
                                search.periodic ? k / 49 - 3 : 0};
              double square = 0.0;
              for (std::uint32_t c = 0; c < 3; ++c) {
                double d = x[3 * j + c] - x[3 * i + c];
                for (int v = 0; v < 3 && search.periodic; ++v) d += n[v] * points.cell->edge[v][c];
                square += d * d;
              }
              if (square > 0.0 && square < cutoff * cutoff) expected.insert({i, j, n[0], n[1], n[2]});
            }
          }
        }
        Budget budget(0);
        BudgetVector<FoundBond> pairs;
        find_bonds(budget, points, search, pairs);
        std::set<Bond> found;
        for (std::uint64_t k = 0; k < pairs.size(); ++k) {
          const FoundBond& bond = pairs.data()[k];
          EXPECT_LE(bond.a, bond.b);
          found.insert({bond.a, bond.b, bond.image[0], bond.image[1], bond.image[2]});
          found.insert({bond.b, bond.a, -bond.image[0], -bond.image[1], -bond.image[2]});
        }
        EXPECT_EQ(found.size(), 2 * pairs.size()) << "twice the same bond";
        EXPECT_EQ(found, expected) << cell_kind << ' ' << cutoff;
        if (cutoff > 0.05) {
          EXPECT_GT(expected.size(), 10u);
        }
        pairs.clear();
        EXPECT_EQ(budget.owned(), 0u);
      }
    }
  }
}

TEST(BondSearch, RadiiSayHowNear) {
  const std::vector<double> x = {0, 0, 0, 1, 0, 0, 3, 0, 0};
  const std::vector<double> radius = {0.5, 0.5, 1.6};
  ParticlePoints points = points_of(x);
  BondSearch search;
  search.radius.kind = kernels::RadiusView::Kind::per_item;
  search.radius.array = attribute_of(radius);
  search.radius_max = 1.6;
  Budget budget(0);
  BudgetVector<FoundBond> pairs;
  for (const auto& [factor, count] : {std::pair{0.9, 0u}, {1.01, 2u}, {1.5, 3u}}) {
    search.by_radius = factor;
    find_bonds(budget, points, search, pairs);
    EXPECT_EQ(pairs.size(), count) << factor;
  }
}

TEST(BondSearch, RefusesWhatHasNoEnd) {
  const std::vector<double> x = {0, 0, 0, 1, 0, 0};
  ParticlePoints points = points_of(x);
  points.cell = some_cell(true, 2.0);
  BondSearch search;
  search.cutoff = 30.0;
  search.periodic = true;
  Budget budget(0);
  BudgetVector<FoundBond> pairs;
  EXPECT_THROW(find_bonds(budget, points, search, pairs), Error);
  Budget small(100);
  search.periodic = false;
  points.cell.reset();
  std::vector<double> many(3000, 0.5);
  points.position = positions_of(many);
  EXPECT_THROW(find_bonds(small, points, search, pairs), Error);
  EXPECT_EQ(small.owned(), 0u);
}

TEST(Cell, FractionsAndImages) {
  for (const bool tilted : {false, true}) {
    const Cell cell = some_cell(tilted, 3.0);
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
      CounterRandom random(seed + 1);
      const double fraction[3] = {random.between(-3, 3), random.between(-3, 3), random.between(-3, 3)};
      double point[3];
      double back[3];
      double image[3];
      cell.offset_of(fraction, point);
      for (int c = 0; c < 3; ++c) point[c] += cell.origin[c];
      cell.fraction_of(point, back);
      cell.image_of(point, image);
      double d[3];
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(back[c], fraction[c], 1e-13);
        EXPECT_EQ(image[c], std::floor(fraction[c]));
        d[c] = point[c];
      }
      double opposite[3] = {-d[0], -d[1], -d[2]};
      const double least = shortest(cell, d);
      cell.nearest_image(d);
      cell.nearest_image(opposite);
      for (int c = 0; c < 3; ++c) EXPECT_EQ(d[c], -opposite[c]);
      double height = cell.height(0);
      for (int i = 1; i < 3; ++i) height = std::min(height, cell.height(i));
      if (least < 0.5 * height) {
        EXPECT_NEAR(std::hypot(d[0], d[1], d[2]), least, 1e-12);
      }
    }
  }
  Cell flat;
  flat.edge[0][0] = flat.edge[1][1] = 1.0;
  flat.edge[2][0] = flat.edge[2][1] = 1.0;
  EXPECT_THROW(flat.prepare(), Error);
  flat.edge[2][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(flat.prepare(), Error);
}

}  // namespace
}  // namespace insitu::testing
