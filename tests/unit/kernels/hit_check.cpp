#include "unit/kernels/hit_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "geometry/pkd/treelet_build.h"
#include "kernels/pkd_reference.h"
#include "kernels/pkd_traverse.h"
#include "kernels/treelet_traverse.h"
#include "unit/kernels/simd_guard.h"

namespace insitu::testing {
namespace {

using kernels::Hit;
using kernels::PkdTree;
using kernels::Ray;
using kernels::Span;

bool is_same(const Hit& a, const Hit& b) {
  return std::bit_cast<std::uint64_t>(a.t) == std::bit_cast<std::uint64_t>(b.t) && a.item == b.item;
}

bool is_same(const Span& a, const Span& b) {
  return a.item == b.item && std::bit_cast<std::uint64_t>(a.t_enter) == std::bit_cast<std::uint64_t>(b.t_enter) &&
         std::bit_cast<std::uint64_t>(a.t_leave) == std::bit_cast<std::uint64_t>(b.t_leave);
}

std::string describe(const Ray& ray) {
  std::ostringstream out;
  out << std::hexfloat << "origin " << ray.origin[0] << ' ' << ray.origin[1] << ' ' << ray.origin[2] << " direction "
      << ray.direction[0] << ' ' << ray.direction[1] << ' ' << ray.direction[2] << " limits " << ray.t_min << ' '
      << ray.t_max << " exclude " << ray.exclude;
  return out.str();
}

std::string describe(const Hit& hit) {
  std::ostringstream out;
  out << std::setprecision(17) << "t " << hit.t << " item " << hit.item;
  return out.str();
}

// Treelets, and under a filter, if wanted, copies of what it leaves.
class TestTreelets {
 public:
  TestTreelets(const PkdTree& tree, unsigned depth)
      : nodes_(treelet_bytes(tree.count, depth) / sizeof(kernels::TreeletNode)),
        treelets_(treelet_shape(tree.count, depth)) {
    build_treelets(tree, treelets_, nodes_.data());
    treelets_.nodes = nodes_.data();
  }
  void copy(const PkdTree& tree) {
    std::uint64_t next = 0;
    for (std::uint64_t number = 0; number < treelets_.count; ++number) {
      before_.push_back(static_cast<std::uint32_t>(place_of_.size()));
      const kernels::TreeletRun run = treelets_.run_of_treelet(number);
      EXPECT_EQ(run.begin, next);
      next = run.begin + run.span;
      for (std::uint64_t place = run.begin; place < std::min(next, tree.count); ++place) {
        if (!tree.selected.has(place)) continue;
        place_of_.push_back(static_cast<std::uint32_t>(place));
        double centre[3];
        tree.centre(place, centre);
        for (const double x : centre) centres_.push_back(static_cast<float>(x));
      }
    }
    EXPECT_EQ(next, tree.count + 1);
    before_.push_back(static_cast<std::uint32_t>(place_of_.size()));
    centres_.resize(centres_.size() + std::size_t{3} * 16);
  }
  const kernels::Treelets& treelets() const { return treelets_; }
  kernels::SelectedCopies copies() const {
    return before_.empty() ? kernels::SelectedCopies()
                           : kernels::SelectedCopies{centres_.data(), place_of_.data(), before_.data()};
  }

 private:
  std::vector<kernels::TreeletNode> nodes_;
  kernels::Treelets treelets_;
  std::vector<float> centres_;
  std::vector<std::uint32_t> place_of_;
  std::vector<std::uint32_t> before_;
};

void normalise(double v[3]) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int c = 0; c < 3; ++c) v[c] /= length;
}

// A unit vector at right angles to `d`.
void across(const double d[3], CounterRandom& random, double out[3]) {
  double other[3];
  do {
    random.direction(other);
    out[0] = d[1] * other[2] - d[2] * other[1];
    out[1] = d[2] * other[0] - d[0] * other[2];
    out[2] = d[0] * other[1] - d[1] * other[0];
  } while (std::abs(out[0]) + std::abs(out[1]) + std::abs(out[2]) < 0.1);
  normalise(out);
}

void set_axis(Ray& ray, std::uint64_t choice) {
  const std::uint64_t axis = choice % 3;
  for (std::uint64_t c = 0; c < 3; ++c) ray.direction[c] = (choice >> (c + 4) & 1) != 0 ? 0.0 : -0.0;
  ray.direction[axis] = (choice >> 8 & 1) != 0 ? 1.0 : -1.0;
}

}  // namespace

std::vector<Ray> make_rays(const TestTree& test_tree, std::size_t count, CounterRandom& random) {
  const PkdTree& tree = test_tree.tree();
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    Ray ray{};
    double aim[3] = {};
    double radius = test_tree.size();
    std::uint64_t item = kernels::no_item;
    if (tree.count > 0) {
      const std::uint64_t place = random.below(tree.count);
      item = tree.item(place);
      tree.centre(place, aim);
      radius = tree.radius.value(item);
    }
    const double extent = test_tree.size() + 2.0 * tree.radius_max;
    random.direction(ray.direction);
    const auto start = [&](double distance) {
      for (int c = 0; c < 3; ++c) ray.origin[c] = aim[c] - distance * ray.direction[c];
    };
    switch (i % 12) {
      case 0:  // at a particle, from outside
        start(1.5 * extent);
        break;
      case 1:  // at its rim, a little inside or outside
      case 2: {
        double side[3];
        across(ray.direction, random, side);
        const double off = radius * (1.0 + random.sign() * random.magnitude(-16.0, -1.0));
        for (int c = 0; c < 3; ++c) aim[c] += off * side[c];
        start(random.magnitude(0.0, 1.5) * extent);
        break;
      }
      case 3:  // along an axis, through a centre
        set_axis(ray, random.next());
        start(2.0 * extent);
        break;
      case 4:  // along an axis, from the middle of the cloud, in a plane of equal coordinates
        set_axis(ray, random.next());
        start(0.25 * extent);
        break;
      case 5: {  // two components, the third zero
        const auto zero = static_cast<std::size_t>(random.below(3));
        ray.direction[zero] = random.below(2) == 0 ? 0.0 : -0.0;
        if (std::abs(ray.direction[(zero + 1) % 3]) + std::abs(ray.direction[(zero + 2) % 3]) < 0.1)
          ray.direction[(zero + 1) % 3] = 1.0;
        normalise(ray.direction);
        start(1.1 * extent);
        break;
      }
      case 6:  // from the centre of a particle
        start(0.0);
        break;
      case 7:  // from anywhere near
        for (double& o : ray.origin) o = random.between(-0.6, 0.6) * extent;
        for (int c = 0; c < 3; ++c) ray.origin[c] += 0.5 * tree.lower[c] + 0.5 * tree.upper[c];
        break;
      case 8:  // leaving a surface, as secondary rays do
        start(-radius);
        if (random.below(2) == 0) ray.exclude = item;
        ray.t_min = 1e-13 * extent;
        break;
      case 9:  // from far away, relative to the size of the scene
        for (double& a : aim) a += 1e-3 * extent * random.between(-1.0, 1.0);
        start(random.magnitude(1.0, 7.0) * extent);
        break;
      case 10:  // from 1e7 length units away, whatever the size of the scene
        start(1e7);
        break;
      case 11:  // a limited stretch
        start(extent * random.between(0.0, 1.0));
        ray.t_min = extent * random.between(0.0, 0.5);
        ray.t_max = ray.t_min + extent * random.between(0.0, 1.0);
        break;
    }
    rays.push_back(ray);
  }
  return rays;
}

std::vector<Ray> limit_rays(const PkdTree& tree, const std::vector<Ray>& rays) {
  std::vector<Ray> limited;
  for (const Ray& ray : rays) {
    const Hit hit = kernels::reference_first_hit(tree, ray);
    if (!hit.found()) continue;
    Ray at_hit = ray;
    at_hit.t_max = hit.t;
    limited.push_back(at_hit);
    Ray before = ray;
    before.t_max = std::nextafter(hit.t, -1.0);
    limited.push_back(before);
    Ray behind = ray;
    behind.t_min = hit.t;
    limited.push_back(behind);
    Ray from_before = ray;
    from_before.t_min = std::nextafter(hit.t, 0.0);
    limited.push_back(from_before);
    Ray without = ray;
    without.exclude = hit.item;
    limited.push_back(without);
  }
  return limited;
}

HitCounts expect_brute_force_hits(const PkdTree& tree, const std::vector<Ray>& rays, std::size_t all_hits_every,
                                  const std::string& what) {
  HitCounts counts;
  std::vector<Hit> expected;
  std::vector<std::vector<Span>> expected_spans;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    expected.push_back(kernels::reference_first_hit(tree, rays[i]));
    ++counts.rays;
    counts.hits += expected.back().found() ? 1 : 0;
    if (i % all_hits_every == 0) expected_spans.push_back(kernels::reference_all_hits(tree, rays[i]));
  }
  const auto by_item = [](const Span& a, const Span& b) { return a.item < b.item; };
  for (std::vector<Span>& spans : expected_spans) std::sort(spans.begin(), spans.end(), by_item);

  // Of one level, of two, and as many as there can be, where the particles are enough.
  std::vector<TestTreelets> treelets;
  const auto deepest = static_cast<unsigned>(std::bit_width(tree.count));
#ifdef __SANITIZE_ADDRESS__
  const std::vector<unsigned> depths = {4u, deepest - 1};
#else
  const std::vector<unsigned> depths = {1u, 4u, deepest - 1};
#endif
  for (const unsigned depth : depths) {
    if (depth < 1 || depth >= deepest) continue;
    treelets.emplace_back(tree, depth);
    if (tree.selected.all()) continue;
    treelets.emplace_back(tree, depth);
    treelets.back().copy(tree);
  }

  for_each_simd_target([&](const char* target) {
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size(), 0);
    kernels::pkd_first_hits(tree, rays.data(), hits.data(), rays.size());
    kernels::pkd_any_hits(tree, rays.data(), occluded.data(), rays.size());
    std::size_t wrong = 0;
    std::string first_wrong;
    const auto complain = [&](std::size_t i, const std::string& text) {
      if (wrong++ == 0) first_wrong = "ray " + std::to_string(i) + ", " + describe(rays[i]) + ": " + text;
    };
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!is_same(hits[i], expected[i]))
        complain(i, "first hit " + describe(hits[i]) + " instead of " + describe(expected[i]));
      if ((occluded[i] != 0) != expected[i].found())
        complain(i, std::string("any hit says ") + (occluded[i] != 0 ? "yes" : "no"));
      if (i % all_hits_every != 0) continue;
      std::vector<Span> spans;
      kernels::pkd_all_hits(tree, rays[i], spans);
      std::sort(spans.begin(), spans.end(), by_item);
      const std::vector<Span>& truth = expected_spans[i / all_hits_every];
      if (!std::equal(spans.begin(), spans.end(), truth.begin(), truth.end(),
                      [](const Span& a, const Span& b) { return is_same(a, b); }))
        complain(i, std::to_string(spans.size()) + " spans differ from the " + std::to_string(truth.size()) +
                        " of the brute force");
    }
    for (const TestTreelets& own : treelets) {
      std::fill(hits.begin(), hits.end(), Hit{});
      std::fill(occluded.begin(), occluded.end(), 0);
      PkdTree with_copies = tree;
      with_copies.copies = own.copies();
      kernels::treelet_first_hits(with_copies, own.treelets(), rays.data(), hits.data(), rays.size());
      kernels::treelet_any_hits(with_copies, own.treelets(), rays.data(), occluded.data(), rays.size());
      const std::string with = " with " + std::to_string(own.treelets().count) + " treelets" +
                               (with_copies.copies.exist() ? " and copies" : "");
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!is_same(hits[i], expected[i]))
          complain(i, "first hit " + describe(hits[i]) + " instead of " + describe(expected[i]) + with);
        if ((occluded[i] != 0) != expected[i].found())
          complain(i, std::string("any hit says ") + (occluded[i] != 0 ? "yes" : "no") + with);
      }
    }
    EXPECT_EQ(wrong, 0u) << what << ", target " << target << ", " << rays.size() << " rays. First: " << first_wrong;
  });
  return counts;
}

}  // namespace insitu::testing
