#include "scene/scene.h"

#include <algorithm>

#include "scene/embree_bridge.h"

namespace insitu {
namespace {

constexpr std::size_t batch = 256;

kernels::Ray ray_for(const SceneRay& ray, std::uint32_t geometry) {
  kernels::Ray own = ray.ray;
  if (ray.exclude_geometry != geometry) own.exclude = kernels::no_item;
  return own;
}

struct FirstHitQuery {
  const std::vector<Scene::Entry>* entries;
  const SceneRay* ray;
  SceneHit* hit;
};

double visit_first(void* state, std::uint32_t geometry) {
  const auto* query = static_cast<const FirstHitQuery*>(state);
  kernels::Hit hit;
  SceneHit& best = *query->hit;
  kernels::Ray ray = ray_for(*query->ray, geometry);
  ray.t_max = std::min(ray.t_max, best.t);
  (*query->entries)[geometry].particles->first_hits(&ray, &hit, 1);
  if (hit.found() && (hit.t < best.t || (hit.t == best.t && geometry < best.geometry)))
    best = {hit.t, hit.item, geometry};
  return best.t;
}

struct AnyHitQuery {
  const std::vector<Scene::Entry>* entries;
  const SceneRay* ray;
  std::uint8_t occluded;
};

double visit_any(void* state, std::uint32_t geometry) {
  auto* query = static_cast<AnyHitQuery*>(state);
  const kernels::Ray ray = ray_for(*query->ray, geometry);
  (*query->entries)[geometry].particles->any_hits(&ray, &query->occluded, 1);
  return query->occluded != 0 ? -1.0 : ray.t_max;
}

}  // namespace

Scene::Scene() = default;
Scene::~Scene() = default;

void Scene::clear() {
  entries_.clear();
  bounds_ = {};
}

void Scene::add(const Particles& particles, const Colors& colors) {
  Entry entry{&particles, colors, {}};
  double lower[3];
  double upper[3];
  particles.bounds(lower, upper);
  entry.bounds = {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
  bounds_.include(entry.bounds);
  entries_.push_back(entry);
}

void Scene::commit() {
  if (entries_.size() < 2) return;
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
  if (entries_.size() > 1) {
    for (std::size_t i = 0; i < count; ++i) {
      hits[i] = {};
      FirstHitQuery query{&entries_, &rays[i], &hits[i]};
      embree_->trace(rays[i].ray, visit_first, &query);
    }
    return;
  }
  std::fill_n(hits, count, SceneHit{});
  if (entries_.empty()) return;
  kernels::Ray own[batch];
  kernels::Hit found[batch];
  for (std::size_t begin = 0; begin < count; begin += batch) {
    const std::size_t n = std::min(batch, count - begin);
    for (std::size_t i = 0; i < n; ++i) own[i] = ray_for(rays[begin + i], 0);
    std::fill_n(found, n, kernels::Hit{});
    entries_[0].particles->first_hits(own, found, n);
    for (std::size_t i = 0; i < n; ++i)
      if (found[i].found()) hits[begin + i] = {found[i].t, found[i].item, 0};
  }
}

void Scene::any_hits(const SceneRay* rays, std::uint8_t* occluded, std::size_t count) const {
  std::fill_n(occluded, count, std::uint8_t{0});
  if (entries_.size() > 1) {
    for (std::size_t i = 0; i < count; ++i) {
      AnyHitQuery query{&entries_, &rays[i], 0};
      embree_->trace(rays[i].ray, visit_any, &query);
      occluded[i] = query.occluded;
    }
    return;
  }
  if (entries_.empty()) return;
  kernels::Ray own[batch];
  for (std::size_t begin = 0; begin < count; begin += batch) {
    const std::size_t n = std::min(batch, count - begin);
    for (std::size_t i = 0; i < n; ++i) own[i] = ray_for(rays[begin + i], 0);
    entries_[0].particles->any_hits(own, occluded + begin, n);
  }
}

}  // namespace insitu
