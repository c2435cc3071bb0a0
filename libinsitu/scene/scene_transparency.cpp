// Rays through the entries of a scene that can be seen through.
#include <algorithm>

#include "scene/embree_bridge.h"
#include "scene/entry_rays.h"
#include "scene/scene.h"

namespace insitu {
namespace {

struct LayersQuery {
  const std::vector<Scene::Entry>* entries;
  const SceneRay* ray;
  kernels::NearestEntries* layers;
};

double visit_layers(void* state, std::uint32_t geometry) {
  const auto* query = static_cast<const LayersQuery*>(state);
  const Scene::Entry& entry = (*query->entries)[geometry];
  if (entry.see_through != nullptr)
    entry.see_through->nearest_entries(ray_for(*query->ray, geometry, entry.shift), geometry, entry.colors.opacity(),
                                       *query->layers);
  return std::min(query->ray->ray.t_max, query->layers->t_limit());
}

struct DepthQuery {
  const std::vector<Scene::Entry>* entries;
  const SceneRay* ray;
  kernels::OpticalDepth depth;
};

double visit_depth(void* state, std::uint32_t geometry) {
  auto* query = static_cast<DepthQuery*>(state);
  const Scene::Entry& entry = (*query->entries)[geometry];
  if (entry.see_through != nullptr)
    query->depth = entry.see_through->optical_depth(ray_for(*query->ray, geometry, entry.shift), entry.colors.opacity(),
                                                    query->depth);
  return query->depth >= kernels::opaque_depth ? -1.0 : query->ray->ray.t_max;
}

constexpr std::size_t batch = 1024;

}  // namespace

void Scene::add_layers(const SceneRay& ray, kernels::NearestEntries& layers) const {
  LayersQuery query{&entries_, &ray, &layers};
  if (entries_.size() > most_in_turn) {
    // Boxes that end before the last layer are passed by.
    kernels::Ray rest = ray.ray;
    rest.t_min = std::max(rest.t_min, layers.behind().t);
    return embree_->trace(rest, visit_layers, &query);
  }
  for (std::uint32_t g = 0; g < entries_.size(); ++g) {
    const Entry& entry = entries_[g];
    if (entry.see_through == nullptr || entry.bounds.empty()) continue;
    if (meets(ray, entry.bounds, std::min(ray.ray.t_max, layers.t_limit()))) visit_layers(&query, g);
  }
}

double Scene::transmittance(const SceneRay& ray) const {
  DepthQuery query{&entries_, &ray, 0};
  if (entries_.size() > most_in_turn) {
    embree_->trace(ray.ray, visit_depth, &query);
    return kernels::transmittance(query.depth);
  }
  for (std::uint32_t g = 0; g < entries_.size() && query.depth < kernels::opaque_depth; ++g) {
    const Entry& entry = entries_[g];
    if (entry.see_through == nullptr || entry.bounds.empty()) continue;
    if (meets(ray, entry.bounds, ray.ray.t_max)) visit_depth(&query, g);
  }
  return kernels::transmittance(query.depth);
}

void Scene::transmittances(const SceneRay* rays, double* arriving, std::size_t count) const {
  std::uint8_t occluded[batch];
  for (std::size_t begin = 0; begin < count; begin += batch) {
    const std::size_t n = std::min(batch, count - begin);
    any_hits(rays + begin, occluded, n);
    for (std::size_t i = 0; i < n; ++i)
      arriving[begin + i] = occluded[i] != 0 ? 0.0 : is_transparent_ ? transmittance(rays[begin + i]) : 1.0;
  }
}

}  // namespace insitu
