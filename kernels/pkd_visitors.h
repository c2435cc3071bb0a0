// What a traversal does with a particle that may be hit: the confirmation in double arithmetic, and when to stop.
// visit() returns true when the traversal may end; t_limit() is the distance behind which nothing matters any more.
#pragma once

#include <algorithm>
#include <vector>

#include "kernels/pkd_tree.h"
#include "kernels/sphere.h"

namespace insitu::kernels {

// Before it is traced: the hit counts as one of this tree.
inline bool is_own_hit(const PkdTree& tree, const Hit& hit) { return tree.continues && hit.found(); }

class FirstHitVisitor {
 public:
  static constexpr bool one_of_coincident = true;

  FirstHitVisitor() = default;
  // `is_here`: the hit is one of this tree.
  FirstHitVisitor(const Ray& ray, Hit& hit, bool is_here)
      : hit_(&hit), limit_(std::min(ray.t_max, hit.t)), here_(is_here) {}

  double t_limit() const { return limit_; }
  bool is_here() const { return here_; }

  template <class Positions>
  bool visit(const PkdTree& tree, const Positions& positions, std::uint64_t place, const Ray& ray) {
    const std::uint64_t item = tree.item(place);
    if (item == ray.exclude) return false;
    double centre[3];
    positions.centre(place, centre);
    offer(tree, item, sphere_first_hit(ray.origin, ray.direction, centre, tree.radius.value(item), ray.t_min));
    return false;
  }

  // `item` is hit at t, as sphere_first_hit has it.
  void offer(const PkdTree& tree, std::uint64_t item, double t) {
    if (!(t <= limit_)) return;
    if (t == limit_ && hit_->t == t && !is_preferred(tree, item)) return;
    limit_ = t;
    *hit_ = {t, item};
    here_ = true;
  }

 private:
  // At exactly the same distance: a hit of another tree stays, one of this tree is weighed by the tree's own rule.
  bool is_preferred(const PkdTree& tree, std::uint64_t item) const {
    if (!here_ || item == hit_->item) return false;
    return tree.prefer != nullptr ? tree.prefer(tree.prefer_context, item, hit_->item) : item < hit_->item;
  }

  Hit* hit_ = nullptr;
  double limit_ = 0.0;
  bool here_ = false;  // *hit_ is of this tree
};

class AnyHitVisitor {
 public:
  static constexpr bool one_of_coincident = true;

  AnyHitVisitor() = default;
  explicit AnyHitVisitor(const Ray& ray) : limit_(ray.t_max) {}

  double t_limit() const { return limit_; }

  template <class Positions>
  bool visit(const PkdTree& tree, const Positions& positions, std::uint64_t place, const Ray& ray) {
    const std::uint64_t item = tree.item(place);
    if (item == ray.exclude) return false;  // first, because it is the most frequent: rays start on what they exclude
    double centre[3];
    positions.centre(place, centre);
    const double t = sphere_first_hit(ray.origin, ray.direction, centre, tree.radius.value(item), ray.t_min);
    found = t <= limit_ && t != std::numeric_limits<double>::infinity();
    return found;
  }

  bool found = false;

 private:
  double limit_ = 0.0;
};

class AllHitsVisitor {
 public:
  static constexpr bool one_of_coincident = false;

  AllHitsVisitor(const Ray& ray, std::vector<Span>& spans) : spans_(spans), first_(spans.size()), limit_(ray.t_max) {}

  double t_limit() const { return limit_; }

  template <class Positions>
  bool visit(const PkdTree& tree, const Positions& positions, std::uint64_t place, const Ray& ray) {
    const std::uint64_t item = tree.item(place);
    if (item == ray.exclude) return false;
    double centre[3];
    positions.centre(place, centre);
    const SphereRoots roots = sphere_roots(ray.origin, ray.direction, centre, tree.radius.value(item));
    if (!(roots.hit && roots.leave > ray.t_min && roots.enter <= limit_)) return false;
    // The last vector of a leaf may overlap the one before it.
    for (std::size_t i = spans_.size(); i > first_ && spans_.size() - i < 2 * pkd_leaf_size; --i)
      if (spans_[i - 1].item == item) return false;
    spans_.push_back({roots.enter, roots.leave, item});
    return false;
  }

 private:
  std::vector<Span>& spans_;
  std::size_t first_;
  double limit_;
};

}  // namespace insitu::kernels
