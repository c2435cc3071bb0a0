// Rays through several sets of particles at once: the nearest hit of all sets, as brute force over every particle says.
#include "scene/scene.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <memory>

#include "kernels/pkd_reference.h"
#include "kernels/sphere.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {
namespace {

struct Set {
  std::vector<double> x;
  std::unique_ptr<Particles> particles;

  Set(std::vector<double> positions, double radius, ParticleOrder order) : x(std::move(positions)) {
    static Budget budget(0);
    ParticleArrays arrays;
    arrays.position = positions_of(x);
    arrays.radius_default = radius;
    particles = std::make_unique<Particles>("set", order, false);
    particles->bind(std::move(arrays));
    particles->build(budget);
  }
};

std::vector<double> moved(std::vector<double> x, double by) {
  for (double& v : x) v += by;
  return x;
}

class SceneOfSets {
 public:
  explicit SceneOfSets(std::vector<Set> sets) : sets_(std::move(sets)) {
    for (const Set& set : sets_) scene_.add(*set.particles, Colors(Style{}, *set.particles, map_));
    scene_.commit();
  }
  const Scene& scene() const { return scene_; }
  const Particles& set(std::size_t i) const { return *sets_[i].particles; }
  std::size_t set_count() const { return sets_.size(); }

  SceneHit brute_force(const SceneRay& ray) const {
    SceneHit best;
    for (std::uint32_t g = 0; g < sets_.size(); ++g) {
      kernels::Ray own = ray.ray;
      if (ray.exclude_geometry != g) own.exclude = kernels::no_item;
      const kernels::Hit hit = kernels::reference_first_hit(sets_[g].particles->tree(), own);
      if (hit.found() && hit.t < best.t) best = {hit.t, hit.item, g};
    }
    return best;
  }

  // Returns how many rays hit something.
  std::size_t expect_brute_force(const std::vector<SceneRay>& rays, const char* what) const {
    std::vector<SceneHit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size(), 2);
    scene_.first_hits(rays.data(), hits.data(), rays.size());
    scene_.any_hits(rays.data(), occluded.data(), rays.size());
    std::size_t found = 0;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const SceneHit expected = brute_force(rays[i]);
      found += expected.found() ? 1 : 0;
      const bool same = std::bit_cast<std::uint64_t>(hits[i].t) == std::bit_cast<std::uint64_t>(expected.t) &&
                        hits[i].item == expected.item && hits[i].geometry == expected.geometry &&
                        occluded[i] == (expected.found() ? 1 : 0);
      if (same) continue;
      if (wrong++ == 0)
        ADD_FAILURE() << what << ", ray " << i << ": t " << hits[i].t << " set " << hits[i].geometry << " item "
                      << hits[i].item << " occluded " << int{occluded[i]} << " instead of t " << expected.t << " set "
                      << expected.geometry << " item " << expected.item;
    }
    EXPECT_EQ(wrong, 0u) << what << ", of " << rays.size();
    return found;
  }

 private:
  const Colormap& map_ = *builtin_colormap("viridis");
  std::vector<Set> sets_;
  Scene scene_;
};

std::vector<SceneRay> rays_at(const SceneOfSets& sets, std::size_t count, double distance, std::uint64_t seed) {
  std::vector<SceneRay> rays;
  CounterRandom random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    const Particles& particles = sets.set(random.below(sets.set_count()));
    double aim[3] = {};
    if (particles.item_count() > 0) particles.centre(random.below(particles.item_count()), aim);
    SceneRay ray;
    random.direction(ray.ray.direction);
    if (i % 7 == 0) {
      for (double& d : ray.ray.direction) d = random.below(2) == 0 ? 0.0 : -0.0;
      ray.ray.direction[random.below(3)] = random.sign();
    }
    const double off = particles.item_count() > 0 ? 1.3 * particles.radius(0) : 0.0;
    for (std::size_t c = 0; c < 3; ++c)
      ray.ray.origin[c] = aim[c] + off * random.between(-1.0, 1.0) - distance * ray.ray.direction[c];
    if (i % 5 == 0) ray.ray.t_max = distance * random.between(0.5, 1.5);
    if (i % 11 == 0) ray.ray.t_min = distance * random.between(0.0, 1.0);
    rays.push_back(ray);
  }
  return rays;
}

std::vector<Set> some_sets(std::size_t count, double apart, double size) {
  std::vector<Set> sets;
  constexpr ParticleOrder orders[] = {ParticleOrder::index, ParticleOrder::permute, ParticleOrder::copy};
  for (std::size_t i = 0; i < count; ++i) {
    CounterRandom random(i + 100);
    sets.emplace_back(moved(make_cloud(Shape::uniform, 200 + 50 * i, size, random), apart * static_cast<double>(i)),
                      0.03 * size, orders[i % 3]);
  }
  return sets;
}

TEST(Scene, SetsApartOverlappingAndNested) {
  for (const std::size_t count : {1u, 2u, 3u, 4u}) {
    for (const double apart : {0.0, 0.5, 3.0, 100.0}) {
      const SceneOfSets sets(some_sets(count, apart, 1.0));
      const std::size_t hits = sets.expect_brute_force(rays_at(sets, 700, 2.0, count), "near");
      EXPECT_GT(hits, 250u);
      EXPECT_LT(hits, 700u);
      sets.expect_brute_force(rays_at(sets, 300, 0.1, count + 50), "inside");
    }
  }
}

// More sets than are traced in turn: through Embree, with the same hits.
TEST(Scene, ManySets) {
  for (const std::size_t count : {Scene::most_in_turn, Scene::most_in_turn + 1}) {
    std::vector<Set> sets;
    for (std::size_t i = 0; i < count; ++i) {
      CounterRandom random(i + 300);
      const double apart = 0.7 * static_cast<double>(i % 5);
      sets.emplace_back(moved(make_cloud(Shape::uniform, 20 + i % 7, 1.0, random), apart), 0.05, ParticleOrder::index);
    }
    const SceneOfSets scene(std::move(sets));
    EXPECT_GT(scene.expect_brute_force(rays_at(scene, 1500, 3.0, 13), "many"), 500u) << count;
  }
}

// The same set drawn in many places, near and very far apart: as brute force over copies of it says, within what the
// shift of the rays rounds.
TEST(Scene, InstancesAreHitWhereTheyAreShifted) {
  for (const double apart : {0.5, 3.0, 1e6}) {
    for (const int edge : {2, 5}) {
      CounterRandom random(14);
      const Set set(make_cloud(Shape::uniform, 150, 1.0, random), 0.05, ParticleOrder::index);
      Scene scene;
      for (int i = 0; i < edge * edge * edge; ++i)
        scene.add(*set.particles, Colors(Style{}, *set.particles, *builtin_colormap("viridis")),
                  apart * glm::dvec3(i % edge, i / edge % edge, i / (edge * edge)));
      scene.commit();
      std::vector<SceneRay> rays(400);
      for (SceneRay& ray : rays) {
        random.direction(ray.ray.direction);
        const Scene::Entry& aim = scene.entries()[random.below(scene.entries().size())];
        double centre[3];
        set.particles->centre(random.below(150), centre);
        for (int c = 0; c < 3; ++c)
          ray.ray.origin[c] = centre[c] + aim.shift[c] + random.between(-0.06, 0.06) - 4.0 * ray.ray.direction[c];
      }
      std::vector<SceneHit> hits(rays.size());
      std::vector<std::uint8_t> occluded(rays.size());
      scene.first_hits(rays.data(), hits.data(), rays.size());
      scene.any_hits(rays.data(), occluded.data(), rays.size());
      std::size_t found = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Scene::Entry& entry : scene.entries()) {
          for (std::uint64_t item = 0; item < 150; ++item) {
            double centre[3];
            set.particles->centre(item, centre);
            for (int c = 0; c < 3; ++c) centre[c] += entry.shift[c];
            nearest = std::min(nearest, kernels::sphere_first_hit(rays[i].ray.origin, rays[i].ray.direction, centre,
                                                                  set.particles->radius(item), 0.0));
          }
        }
        ASSERT_EQ(hits[i].found(), std::isfinite(nearest)) << apart << " ray " << i;
        EXPECT_EQ(occluded[i], hits[i].found() ? 1 : 0);
        if (!hits[i].found()) continue;
        ++found;
        EXPECT_NEAR(hits[i].t, nearest, 1e-7) << apart << " ray " << i;  // at 1e6, a grazing hit, is the worst
      }
      EXPECT_GT(found, 150u);
    }
  }
}

TEST(Scene, ScenesOfAnyMagnitude) {
  for (const double size : {1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12}) {
    const SceneOfSets sets(some_sets(3, 0.7 * size, size));
    EXPECT_GT(sets.expect_brute_force(rays_at(sets, 400, 3.0 * size, 5), "near"), 150u) << size;
    EXPECT_GT(sets.expect_brute_force(rays_at(sets, 400, 1e3 * size, 6), "far"), 150u) << size;
  }
}

// Embree's single precision never sees these distances: rays enter its frame around the data.
TEST(Scene, FarOrigins) {
  const SceneOfSets sets(some_sets(3, 0.7, 1.0));
  for (const double distance : {1e4, 1e5, 1e6, 1e7})
    EXPECT_GT(sets.expect_brute_force(rays_at(sets, 400, distance, 7), "far"), 150u) << distance;
}

TEST(Scene, DataFarFromTheOrigin) {
  std::vector<Set> sets = some_sets(2, 0.5, 1.0);
  std::vector<Set> far;
  for (Set& set : sets) far.emplace_back(moved(set.x, 1e7), 0.03, ParticleOrder::index);
  const SceneOfSets scene(std::move(far));
  EXPECT_GT(scene.expect_brute_force(rays_at(scene, 400, 3.0, 8), "near"), 150u);
}

// A tiny set beside a huge one: its box is a grain in the frame.
TEST(Scene, SetsOfVeryDifferentSize) {
  std::vector<Set> sets;
  CounterRandom random(9);
  sets.emplace_back(make_cloud(Shape::uniform, 100, 1e6, random), 3e4, ParticleOrder::index);
  sets.emplace_back(make_cloud(Shape::uniform, 100, 1e-3, random), 1e-4, ParticleOrder::index);
  const SceneOfSets scene(std::move(sets));
  std::vector<SceneRay> rays;
  for (std::uint64_t i = 0; i < 300; ++i) {
    SceneRay ray;
    random.direction(ray.ray.direction);
    for (std::size_t c = 0; c < 3; ++c)
      ray.ray.origin[c] = 1e-3 * random.between(-0.5, 0.5) - (i % 2 == 0 ? 5e-3 : 1e3) * ray.ray.direction[c];
    rays.push_back(ray);
  }
  EXPECT_GT(scene.expect_brute_force(rays, "grain"), 100u);
}

TEST(Scene, EmptySetsTakeNoPart) {
  std::vector<Set> sets = some_sets(1, 0.0, 1.0);
  sets.emplace_back(std::vector<double>{}, 1.0, ParticleOrder::index);
  sets.emplace_back(std::vector<double>(3, std::numeric_limits<double>::quiet_NaN()), 1.0, ParticleOrder::index);
  CounterRandom random(10);
  sets.emplace_back(make_cloud(Shape::uniform, 50, 1.0, random), 0.05, ParticleOrder::index);
  const SceneOfSets scene(std::move(sets));
  std::vector<SceneRay> rays = rays_at(scene, 400, 2.0, 11);
  for (SceneRay& ray : rays)
    for (double& o : ray.ray.origin)
      if (std::isnan(o)) o = 0.25;
  EXPECT_GT(scene.expect_brute_force(rays, "with empty sets"), 100u);
}

TEST(Scene, NothingAtAllIsNeverHit) {
  Scene scene;
  scene.commit();
  SceneRay ray;
  ray.ray = {{0, 0, 0}, {0, 0, 1}};
  SceneHit hit;
  std::uint8_t occluded = 9;
  scene.first_hits(&ray, &hit, 1);
  scene.any_hits(&ray, &occluded, 1);
  EXPECT_FALSE(hit.found());
  EXPECT_EQ(occluded, 0);
  EXPECT_TRUE(scene.bounds().empty());

  std::vector<Set> sets;
  sets.emplace_back(std::vector<double>{}, 1.0, ParticleOrder::index);
  sets.emplace_back(std::vector<double>{}, 1.0, ParticleOrder::index);
  const SceneOfSets empty(std::move(sets));
  EXPECT_EQ(empty.expect_brute_force({ray}, "two empty sets"), 0u);
}

// Item 0 of one set is left out; item 0 of the others is not.
TEST(Scene, ExcludeCountsForItsOwnSet) {
  std::vector<Set> sets;
  for (int i = 0; i < 3; ++i) sets.emplace_back(std::vector<double>{0.0, 0.0, 10.0 * i}, 1.0, ParticleOrder::index);
  const SceneOfSets scene(std::move(sets));
  SceneRay ray;
  ray.ray = {{0, 0, -5}, {0, 0, 1}};
  ray.ray.exclude = 0;
  const double expected[] = {14.0, 4.0, 4.0, 4.0};
  for (std::uint32_t g = 0; g < 4; ++g) {
    ray.exclude_geometry = g;
    SceneHit hit;
    scene.scene().first_hits(&ray, &hit, 1);
    EXPECT_EQ(hit.t, expected[g]) << g;
  }
  // With only one set it is the same.
  std::vector<Set> one;
  one.emplace_back(std::vector<double>{0.0, 0.0, 0.0}, 1.0, ParticleOrder::index);
  const SceneOfSets single(std::move(one));
  SceneHit hit;
  ray.exclude_geometry = 0;
  single.scene().first_hits(&ray, &hit, 1);
  EXPECT_FALSE(hit.found());
  ray.exclude_geometry = 1;
  single.scene().first_hits(&ray, &hit, 1);
  EXPECT_EQ(hit.t, 4.0);
}

TEST(Scene, OfEqualHitsTheFirstSetIsShown) {
  std::vector<Set> sets;
  for (int i = 0; i < 4; ++i) sets.emplace_back(std::vector<double>{0.0, 0.0, 0.0}, 1.0, ParticleOrder::index);
  const SceneOfSets scene(std::move(sets));
  CounterRandom random(12);
  for (int i = 0; i < 100; ++i) {
    SceneRay ray;
    random.direction(ray.ray.direction);
    for (int c = 0; c < 3; ++c) ray.ray.origin[c] = -3.0 * ray.ray.direction[c];
    SceneHit hit;
    scene.scene().first_hits(&ray, &hit, 1);
    EXPECT_EQ(hit.geometry, 0u);
  }
}

TEST(Scene, IsBuiltAnewAfterClear) {
  const std::vector<Set> sets = some_sets(3, 1.0, 1.0);
  Scene scene;
  for (const std::size_t count : {3u, 2u, 1u, 0u, 3u}) {
    scene.clear();
    for (std::size_t i = 0; i < count; ++i)
      scene.add(*sets[i].particles, Colors(Style{}, *sets[i].particles, *builtin_colormap("viridis")));
    scene.commit();
    EXPECT_EQ(scene.entries().size(), count);
    EXPECT_EQ(scene.bounds().empty(), count == 0);
    SceneRay ray;
    double centre[3];
    sets[0].particles->centre(0, centre);
    ray.ray.direction[2] = 1.0;
    for (int c = 0; c < 3; ++c) ray.ray.origin[c] = centre[c];
    std::uint8_t occluded = 0;
    scene.any_hits(&ray, &occluded, 1);
    EXPECT_EQ(occluded, count == 0 ? 0 : 1);
  }
}

}  // namespace
}  // namespace insitu::testing
