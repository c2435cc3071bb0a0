// One ray through a P-k-d tree, or through a subtree of it. Included once per SIMD target.
#if defined(INSITU_KERNELS_PKD_SINGLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_SINGLE_INL_H_
#undef INSITU_KERNELS_PKD_SINGLE_INL_H_
#else
#define INSITU_KERNELS_PKD_SINGLE_INL_H_
#endif

#include "kernels/pkd_leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Places [begin, end), what the ray sees of them, and the box of their centres.
template <class Key>
struct Subtree {
  std::uint64_t begin;
  std::uint64_t end;
  double t_enter;
  double t_leave;
  PkdBox<Key> box;
};

// The ray as split planes see it: slopes, and by how much a plane is widened to both sides along the ray: by the
// largest radius, and a little for the rounding of the plane's distance.
struct SlabRay {
  double origin[3];
  double inverse[3];
  double widening[3];
  bool negative[3];
};

// Every leaf has a frame of its own: for rays and trees of any magnitude.
template <class Key>
HWY_INLINE RayFrame FrameOfRun(const PkdTree& tree, const Ray& ray, const Subtree<Key>& run) {
  double reach = 2.0 * tree.radius_max;
  for (int c = 0; c < 3; ++c) reach += static_cast<double>(run.box.upper[c]) - static_cast<double>(run.box.lower[c]);
  return MakeLeafFrame(ray, run.t_enter, reach);
}

// Tests the particles below the last split: a leaf, or any number of particles at one point.
template <class Positions, class Visitor>
HWY_INLINE bool VisitRun(const PkdTree& tree, const Positions& positions, const Subtree<typename Positions::Key>& run,
                         const Ray& ray, Visitor& visitor) {
  if (HWY_UNLIKELY(run.end - run.begin > pkd_leaf_size) && Visitor::one_of_coincident &&
      tree.radius.kind == RadiusView::Kind::uniform && tree.selected.all() && tree.item(run.begin) != ray.exclude)
    return visitor.visit(tree, positions, run.begin, ray);  // equal spheres: the build puts the one to be shown first
  const RayFrame frame = FrameOfRun(tree, ray, run);
  for (std::uint64_t begin = run.begin; begin < run.end; begin += pkd_leaf_size)
    if (VisitLeaf(tree, positions, begin, std::min(run.end, begin + pkd_leaf_size), frame, ray, visitor)) return true;
  return false;
}

// Visits the subtree `now` front to back. True: the visitor needs no more.
template <class Positions, class Visitor>
HWY_INLINE bool TraverseSubtree(const PkdTree& tree, const Positions& positions, const SlabRay& slab,
                                Subtree<typename Positions::Key> now, const Ray& ray, Visitor& visitor) {
  using Key = typename Positions::Key;
  // The tree is balanced: 2^64 particles would be 59 levels above the leaves.
  Subtree<Key> stack[64];
  int height = 0;
  for (;;) {
    while (now.end - now.begin > pkd_leaf_size && !now.box.is_point()) {
      if (!tree.selected.all() && !tree.selected.any(now.begin, now.end)) {
        now.end = now.begin;
        break;
      }
      const int axis = now.box.split_axis();
      const std::uint64_t mid = now.begin + (now.end - now.begin) / 2;
      const Key plane = positions.key(mid, axis);
      // What comes next, whichever side it is.
      positions.prefetch(now.begin + (mid - now.begin) / 2);
      positions.prefetch(mid + 1 + (now.end - mid - 1) / 2);
      const double at_plane = (static_cast<double>(plane) - slab.origin[axis]) * slab.inverse[axis];
      const double near_leave = at_plane + slab.widening[axis];
      const double far_enter = at_plane - slab.widening[axis];
      const bool go_near = now.t_enter <= near_leave;
      const bool go_far = far_enter <= now.t_leave;
      const bool near_is_lower = !slab.negative[axis];
      bool go_lower = go_near == near_is_lower;  // when only one side is entered
      if (go_near && go_far) {
        // The ray crosses the widened plane within the subtree: the particle on the plane may be hit.
        if (tree.selected.has(mid) && visitor.visit(tree, positions, mid, ray)) return true;
        Subtree<Key>& far = stack[height++];
        far = now;
        far.t_enter = std::max(now.t_enter, far_enter);
        if (near_is_lower) {
          far.begin = mid + 1;
          far.box.lower[axis] = plane;
        } else {
          far.end = mid;
          far.box.upper[axis] = plane;
        }
        now.t_leave = std::min(now.t_leave, near_leave);
        go_lower = near_is_lower;
      }
      if (go_lower) {
        now.end = mid;
        now.box.upper[axis] = plane;
      } else {
        now.begin = mid + 1;
        now.box.lower[axis] = plane;
      }
    }
    if (now.end > now.begin && VisitRun(tree, positions, now, ray, visitor)) return true;
    do {
      if (height == 0) return false;
      now = stack[--height];
      now.t_leave = std::min(now.t_leave, visitor.t_limit());
    } while (now.t_enter > now.t_leave);
  }
}

template <class Key>
HWY_INLINE PkdBox<Key> RootBox(const PkdTree& tree) {
  PkdBox<Key> box;
  for (int c = 0; c < 3; ++c) {
    box.lower[c] = static_cast<Key>(tree.lower[c]);
    box.upper[c] = static_cast<Key>(tree.upper[c]);
  }
  return box;
}

// A ray through the whole tree, whatever its magnitude.
template <class Positions, class Visitor>
HWY_INLINE void TraverseTree(const PkdTree& tree, const Positions& positions, const Ray& ray, Visitor& visitor) {
  constexpr double parallel = 1e-200;  // slower directions count as this: products stay finite, the signs right
  SlabRay slab;
  Subtree<typename Positions::Key> root;
  root.begin = 0;
  root.end = tree.count;
  root.t_enter = ray.t_min;
  root.t_leave = visitor.t_limit();
  root.box = RootBox<typename Positions::Key>(tree);
  for (int c = 0; c < 3; ++c) {
    const double direction = ray.direction[c];
    slab.origin[c] = ray.origin[c];
    slab.negative[c] = direction < 0.0;
    slab.inverse[c] = std::abs(direction) > parallel ? 1.0 / direction : (direction < 0.0 ? -1.0 : 1.0) / parallel;
    const double extent = std::abs(tree.lower[c]) + std::abs(tree.upper[c]) + std::abs(ray.origin[c]);
    slab.widening[c] = (tree.radius_max * (1.0 + 1e-12) + extent * 4e-15) * std::abs(slab.inverse[c]);
    const double at_lower = (tree.lower[c] - slab.origin[c]) * slab.inverse[c];
    const double at_upper = (tree.upper[c] - slab.origin[c]) * slab.inverse[c];
    root.t_enter = std::max(root.t_enter, std::min(at_lower, at_upper) - slab.widening[c]);
    root.t_leave = std::min(root.t_leave, std::max(at_lower, at_upper) + slab.widening[c]);
  }
  if (tree.count != 0 && root.t_enter <= root.t_leave) TraverseSubtree(tree, positions, slab, root, ray, visitor);
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
