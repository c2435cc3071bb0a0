// What a traversal does with particles that can be seen through. Such a particle counts once, where the ray enters it;
// a ray that starts inside does not see it. Particles of opacity 1 are hit as pkd_visitors.h has it, from inside too.
#pragma once

#include <algorithm>
#include <array>

#include "kernels/nearest_entries.h"
#include "kernels/opacity.h"
#include "kernels/pkd_tree.h"
#include "kernels/sphere.h"

namespace insitu::kernels {

struct SphereMeeting {
  double t;  // infinity: none
  bool from_inside;
};

template <class Positions>
SphereMeeting meet_sphere(const PkdTree& tree, const Positions& positions, std::uint64_t place, std::uint64_t item,
                          const Ray& ray, double t_min) {
  double centre[3];
  positions.centre(place, centre);
  const SphereRoots roots = sphere_roots(ray.origin, ray.direction, centre, tree.radius.value(item));
  if (roots.hit && roots.enter > t_min) return {roots.enter, false};
  if (roots.hit && roots.leave > t_min) return {roots.leave, true};
  return {std::numeric_limits<double>::infinity(), false};
}

// Fills a list of the nearest entries. The ray of the traversal may start at the last of the list before; `t_min` is
// where it really starts. Distances in the list are `scale` times those of the tree's space.
class NearestEntriesVisitor {
 public:
  static constexpr bool one_of_coincident = false;

  NearestEntriesVisitor(const Ray& ray, double scale, std::uint32_t geometry, const ItemOpacity& opacity,
                        NearestEntries& entries)
      : t_min_(ray.t_min),
        t_max_(ray.t_max),
        scale_(scale),
        geometry_(geometry),
        opacity_(opacity),
        entries_(entries) {}

  double t_limit() const { return std::min(t_max_, entries_.t_limit() / scale_ * rounding_up); }

  template <class Positions>
  bool visit(const PkdTree& tree, const Positions& positions, std::uint64_t place, const Ray& ray) {
    const std::uint64_t item = tree.item(place);
    if (item == ray.exclude) return false;
    const SphereMeeting met = meet_sphere(tree, positions, place, item, ray, t_min_);
    const double t = met.t * scale_;
    if (!(met.t <= t_max_ && t <= entries_.t_limit() && t >= entries_.behind().t)) return false;
    if (t == std::numeric_limits<double>::infinity()) return false;
    const float opacity = opacity_.of(item);
    if (!(opacity > 0.0f) || (met.from_inside && opacity < 1.0f)) return false;
    entries_.add({t, item, geometry_, opacity >= 1.0f}, [&tree](std::uint64_t a, std::uint64_t b) {
      return tree.prefer != nullptr ? tree.prefer(tree.prefer_context, a, b) : a < b;
    });
    return false;
  }

  // More than quotient and product round.
  static constexpr double rounding_up = 1.0 + 1e-15;
  static constexpr double rounding_down = 1.0 - 1e-15;

 private:
  double t_min_;
  double t_max_;
  double scale_;
  std::uint32_t geometry_;
  const ItemOpacity& opacity_;
  NearestEntries& entries_;
};

// Sums the optical depths of all particles that a ray enters, until nothing passes any more.
class TransmittanceVisitor {
 public:
  static constexpr bool one_of_coincident = false;

  TransmittanceVisitor(const Ray& ray, const ItemOpacity& opacity, OpticalDepth depth)
      : depth_(depth), t_max_(ray.t_max), opacity_(opacity) {}

  double t_limit() const { return t_max_; }
  OpticalDepth depth() const { return depth_; }

  template <class Positions>
  bool visit(const PkdTree& tree, const Positions& positions, std::uint64_t place, const Ray& ray) {
    const std::uint64_t item = tree.item(place);
    if (item == ray.exclude) return false;
    const SphereMeeting met = meet_sphere(tree, positions, place, item, ray, ray.t_min);
    if (!(met.t <= t_max_ && met.t != std::numeric_limits<double>::infinity())) return false;
    if (!is_new(item)) return false;
    const float opacity = opacity_.of(item);
    if (met.from_inside && opacity < 1.0f) return false;
    // Many particles have the opacity of the one before: logarithms are slow.
    if (opacity != last_opacity_) {
      last_opacity_ = opacity;
      last_depth_ = optical_depth(opacity);
    }
    depth_ += last_depth_;
    return depth_ >= opaque_depth;
  }

 private:
  // The last vector of a leaf may overlap the one before it: whoever comes twice does so within the length of a leaf.
  bool is_new(std::uint64_t item) {
    const auto end = counted_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, counted_.size()));
    if (std::find(counted_.begin(), end, item) != end) return false;
    counted_[count_++ % counted_.size()] = item;
    return true;
  }

  OpticalDepth depth_;
  double t_max_;
  const ItemOpacity& opacity_;
  std::array<std::uint64_t, pkd_leaf_size> counted_;
  std::size_t count_ = 0;
  float last_opacity_ = 0.0f;
  OpticalDepth last_depth_ = 0;
};

}  // namespace insitu::kernels
