#include "kernels/pkd_reference.h"

#include <algorithm>

#include "kernels/pkd_positions.h"
#include "kernels/sphere.h"

namespace insitu::kernels {
namespace {

struct Item {
  std::uint64_t id;
  double centre[3];
  double radius;
};

Item item_at(const PkdTree& tree, std::uint64_t place) {
  Item item{};
  item.id = tree.item(place);
  tree.centre(place, item.centre);
  item.radius = tree.radius.value(item.id);
  return item;
}

template <class Key>
std::uint64_t broken_below(const PkdTree& tree, std::uint64_t begin, std::uint64_t end, PkdBox<Key> box) {
  const auto key = [&](std::uint64_t place, int axis) {
    return static_cast<Key>(tree.position.value(tree.position_of_place(place), static_cast<std::uint32_t>(axis)));
  };
  for (std::uint64_t place = begin; place < end; ++place)
    for (int axis = 0; axis < 3; ++axis)
      if (!(key(place, axis) >= box.lower[axis] && key(place, axis) <= box.upper[axis])) return place;
  if (end - begin <= pkd_leaf_size || box.is_point()) return no_item;
  const std::uint64_t mid = begin + (end - begin) / 2;
  const int axis = box.split_axis();
  PkdBox<Key> left = box;
  PkdBox<Key> right = box;
  left.upper[axis] = right.lower[axis] = key(mid, axis);
  const std::uint64_t broken = broken_below(tree, begin, mid, left);
  return broken != no_item ? broken : broken_below(tree, mid + 1, end, right);
}

template <class Key>
std::uint64_t broken_in(const PkdTree& tree) {
  PkdBox<Key> box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = static_cast<Key>(tree.lower[axis]);
    box.upper[axis] = static_cast<Key>(tree.upper[axis]);
  }
  return broken_below(tree, 0, tree.count, box);
}

}  // namespace

Hit reference_first_hit(const PkdTree& tree, const Ray& ray) {
  Hit best;
  best.t = ray.t_max;
  for (std::uint64_t place = 0; place < tree.count; ++place) {
    const Item item = item_at(tree, place);
    if (item.id == ray.exclude || !tree.selected.has(place)) continue;
    const double t = sphere_first_hit(ray.origin, ray.direction, item.centre, item.radius, ray.t_min);
    if (t > best.t || t == std::numeric_limits<double>::infinity()) continue;
    if (t == best.t && best.found()) {
      const bool preferred =
          tree.prefer != nullptr ? tree.prefer(tree.prefer_context, item.id, best.item) : item.id < best.item;
      if (!preferred) continue;
    }
    best = {t, item.id};
  }
  return best.found() ? best : Hit{};
}

bool reference_any_hit(const PkdTree& tree, const Ray& ray) { return reference_first_hit(tree, ray).found(); }

std::vector<Span> reference_all_hits(const PkdTree& tree, const Ray& ray) {
  std::vector<Span> spans;
  for (std::uint64_t place = 0; place < tree.count; ++place) {
    const Item item = item_at(tree, place);
    if (item.id == ray.exclude || !tree.selected.has(place)) continue;
    const SphereRoots roots = sphere_roots(ray.origin, ray.direction, item.centre, item.radius);
    if (roots.hit && roots.leave > ray.t_min && roots.enter <= ray.t_max)
      spans.push_back({roots.enter, roots.leave, item.id});
  }
  return spans;
}

std::vector<EnteredItem> reference_entries(const PkdTree& tree, const Ray& ray, const ItemOpacity& opacity) {
  std::vector<EnteredItem> entries;
  for (std::uint64_t place = 0; place < tree.count; ++place) {
    const Item item = item_at(tree, place);
    const SphereRoots roots = sphere_roots(ray.origin, ray.direction, item.centre, item.radius);
    const bool is_opaque = opacity.of(item.id) >= 1.0f;
    if (item.id == ray.exclude || !roots.hit || !(opacity.of(item.id) > 0.0f)) continue;
    double t = roots.enter;
    if (is_opaque && !(t > ray.t_min)) t = roots.leave;
    if (t > ray.t_min && t <= ray.t_max) entries.push_back({t, item.id, 0, is_opaque});
  }
  std::sort(entries.begin(), entries.end(), [&tree](const EnteredItem& a, const EnteredItem& b) {
    if (a.t != b.t) return a.t < b.t;
    return tree.prefer != nullptr ? tree.prefer(tree.prefer_context, a.item, b.item) : a.item < b.item;
  });
  const auto end = std::find_if(entries.begin(), entries.end(), [](const EnteredItem& e) { return e.is_opaque; });
  if (end != entries.end()) entries.erase(end + 1, entries.end());
  return entries;
}

OpticalDepth reference_optical_depth(const PkdTree& tree, const Ray& ray, const ItemOpacity& opacity) {
  OpticalDepth sum = 0;
  for (std::uint64_t place = 0; place < tree.count; ++place) {
    const Item item = item_at(tree, place);
    const SphereRoots roots = sphere_roots(ray.origin, ray.direction, item.centre, item.radius);
    if (item.id == ray.exclude || !roots.hit) continue;
    const bool is_opaque = opacity.of(item.id) >= 1.0f;
    const double t = is_opaque && !(roots.enter > ray.t_min) ? roots.leave : roots.enter;
    if (t > ray.t_min && t <= ray.t_max) sum += optical_depth(opacity.of(item.id));
  }
  return sum;
}

std::uint64_t find_broken_invariant(const PkdTree& tree) {
  return compares_in_f32(layout_of(tree)) ? broken_in<float>(tree) : broken_in<double>(tree);
}

}  // namespace insitu::kernels
