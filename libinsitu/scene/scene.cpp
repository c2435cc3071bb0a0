#include "scene/scene.h"

#include <algorithm>
#include <cmath>

#include "scene/embree_bridge.h"
#include "scene/entry_rays.h"

namespace insitu {
namespace {

// Rays that go through a geometry together: all samples of a tile, and four occlusion rays of each. Frames with 256,
// 1024 and 4096 differed by less than what repeated runs do, with one and with a few sets; with 27, 256 took a sixth
// longer.
constexpr std::size_t batch = 1024;

// Nearer, or as near and of an entry that was added earlier.
void keep_better(SceneHit& best, const kernels::Hit& hit, std::uint32_t geometry) {
  if (hit.found() && (hit.t < best.t || (hit.t == best.t && geometry < best.geometry)))
    best = {hit.t, hit.item, geometry};
}

struct FirstHitQuery {
  const std::vector<Scene::Entry>* entries;
  const SceneRay* ray;
  SceneHit* hit;
};

double visit_first(void* state, std::uint32_t geometry) {
  const auto* query = static_cast<const FirstHitQuery*>(state);
  const Scene::Entry& entry = (*query->entries)[geometry];
  if (entry.see_through != nullptr) return query->hit->t;
  kernels::Hit hit;
  kernels::Ray ray = ray_for(*query->ray, geometry, entry.shift);
  ray.t_max = std::min(ray.t_max, query->hit->t);
  entry.geometry->first_hits(&ray, &hit, 1);
  keep_better(*query->hit, hit, geometry);
  return query->hit->t;
}

struct AnyHitQuery {
  const std::vector<Scene::Entry>* entries;
  const SceneRay* ray;
  std::uint8_t occluded;
};

double visit_any(void* state, std::uint32_t geometry) {
  auto* query = static_cast<AnyHitQuery*>(state);
  const Scene::Entry& entry = (*query->entries)[geometry];
  if (entry.see_through != nullptr) return query->ray->ray.t_max;
  const kernels::Ray ray = ray_for(*query->ray, geometry, entry.shift);
  entry.geometry->any_hits(&ray, &query->occluded, 1);
  return query->occluded != 0 ? -1.0 : ray.t_max;
}

double distance2(const Bounds& box, const double from[3]) {
  double sum = 0.0;
  for (int c = 0; c < 3; ++c) {
    const double off = std::max({box.lower[c] - from[c], from[c] - box.upper[c], 0.0});
    sum += off * off;
  }
  return sum;
}

// The entries, those near the start of the first ray first: what they hide is then not looked for. An order of visits
// alone; which hit is kept does not depend on it.
class VisitOrder {
 public:
  VisitOrder(const std::vector<Scene::Entry>& entries, const double from[3]) : count_(entries.size()) {
    double far[Scene::most_in_turn];
    for (std::uint32_t g = 0; g < count_; ++g) {
      order_[g] = g;
      far[g] = distance2(entries[g].bounds, from);
    }
    std::stable_sort(order_, order_ + count_, [&far](std::uint32_t a, std::uint32_t b) { return far[a] < far[b]; });
  }
  const std::uint32_t* begin() const { return order_; }
  const std::uint32_t* end() const { return order_ + count_; }

 private:
  std::size_t count_;
  std::uint32_t order_[Scene::most_in_turn];
};

// A batch of rays through every entry, or those of them that meet its box.
class InTurn {
 public:
  explicit InTurn(const std::vector<Scene::Entry>& entries) : entries_(entries) {}

  void first_hits(const SceneRay* rays, SceneHit* hits, std::size_t count) {
    for (const std::uint32_t g : VisitOrder(entries_, rays[0].ray.origin)) {
      const auto wanted = [&](std::size_t i) {
        return meets(rays[i], entries_[g].bounds, std::min(rays[i].ray.t_max, hits[i].t));
      };
      const std::size_t n = gather(g, rays, count, wanted);
      for (std::size_t k = 0; k < n; ++k) own_[k].t_max = std::min(own_[k].t_max, hits[place_[k]].t);
      std::fill_n(found_, n, kernels::Hit{});
      if (n > 0) entries_[g].geometry->first_hits(own_, found_, n);
      for (std::size_t k = 0; k < n; ++k) keep_better(hits[place_[k]], found_[k], g);
    }
  }

  void any_hits(const SceneRay* rays, std::uint8_t* occluded, std::size_t count) {
    for (const std::uint32_t g : VisitOrder(entries_, rays[0].ray.origin)) {
      const auto wanted = [&](std::size_t i) {
        return occluded[i] == 0 && meets(rays[i], entries_[g].bounds, rays[i].ray.t_max);
      };
      const std::size_t n = gather(g, rays, count, wanted);
      std::fill_n(hit_, n, std::uint8_t{0});
      if (n > 0) entries_[g].geometry->any_hits(own_, hit_, n);
      for (std::size_t k = 0; k < n; ++k) occluded[place_[k]] = hit_[k];
    }
  }

 private:
  template <class Wanted>
  std::size_t gather(std::uint32_t g, const SceneRay* rays, std::size_t count, Wanted&& wanted) {
    // One geometry alone finds out faster itself.
    const bool alone = entries_.size() == 1;
    if (entries_[g].bounds.empty() || entries_[g].see_through != nullptr) return 0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (!alone && !wanted(i)) continue;
      own_[n] = ray_for(rays[i], g, entries_[g].shift);
      place_[n++] = static_cast<std::uint32_t>(i);
    }
    return n;
  }

  const std::vector<Scene::Entry>& entries_;
  kernels::Ray own_[batch];
  kernels::Hit found_[batch];
  std::uint8_t hit_[batch];
  std::uint32_t place_[batch];
};

}  // namespace

Scene::Scene() = default;
Scene::~Scene() = default;

void Scene::clear() {
  entries_.clear();
  bounds_ = {};
  is_transparent_ = false;
}

void Scene::add(const Geometry& geometry, const Colors& colors, const glm::dvec3& shift) {
  Entry entry{&geometry, colors, {}, shift, nullptr};
  double lower[3];
  double upper[3];
  geometry.bounds(lower, upper);
  entry.bounds = {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
  if (!entry.bounds.empty() && shift != glm::dvec3(0.0)) {
    // Sums round, here and where rays are shifted back: by parts of the numbers that go in, not of what comes out.
    double largest = 0.0;
    for (int c = 0; c < 3; ++c)
      largest = std::max({largest, std::abs(lower[c]), std::abs(upper[c]), std::abs(shift[c])});
    entry.bounds.lower += shift - 1e-14 * largest;
    entry.bounds.upper += shift + 1e-14 * largest;
  }
  bounds_.include(entry.bounds);
  if (colors.are_transparent()) entry.see_through = geometry.transparent();
  is_transparent_ = is_transparent_ || entry.see_through != nullptr;
  entries_.push_back(entry);
}

void Scene::commit() {
  if (entries_.size() <= most_in_turn) return;
  std::vector<Bounds> boxes;
  for (const Entry& entry : entries_) boxes.push_back(entry.bounds);
  if (!embree_) embree_ = std::make_unique<EmbreeBridge>();
  try {
    embree_->build(boxes);
  } catch (...) {
    embree_.reset();  // a device that has run out of memory is not used again
    throw;
  }
}

void Scene::first_hits(const SceneRay* rays, SceneHit* hits, std::size_t count) const {
  std::fill_n(hits, count, SceneHit{});
  if (entries_.empty()) return;
  if (entries_.size() > most_in_turn) {
    for (std::size_t i = 0; i < count; ++i) {
      FirstHitQuery query{&entries_, &rays[i], &hits[i]};
      embree_->trace(rays[i].ray, visit_first, &query);
    }
    return;
  }
  InTurn in_turn(entries_);
  for (std::size_t begin = 0; begin < count; begin += batch)
    in_turn.first_hits(rays + begin, hits + begin, std::min(batch, count - begin));
}

void Scene::any_hits(const SceneRay* rays, std::uint8_t* occluded, std::size_t count) const {
  std::fill_n(occluded, count, std::uint8_t{0});
  if (entries_.empty()) return;
  if (entries_.size() > most_in_turn) {
    for (std::size_t i = 0; i < count; ++i) {
      AnyHitQuery query{&entries_, &rays[i], 0};
      embree_->trace(rays[i].ray, visit_any, &query);
      occluded[i] = query.occluded;
    }
    return;
  }
  InTurn in_turn(entries_);
  for (std::size_t begin = 0; begin < count; begin += batch)
    in_turn.any_hits(rays + begin, occluded + begin, std::min(batch, count - begin));
}

}  // namespace insitu
