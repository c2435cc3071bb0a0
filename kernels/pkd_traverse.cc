#include "kernels/pkd_traverse.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "kernels/pkd_positions.h"
#include "kernels/pkd_visitors.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/pkd_traverse.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Half of the spacing of f32 numbers at 1: the relative error of one operation.
constexpr double f32_unit = 5.9604644775390625e-8;

// What a leaf needs of its ray, relative to a point near the leaf.
//
// The leaf test computes, in f32, m = c - q and p = m - (m.d) d for a point q of the ray at most `reach` away from
// every centre c of the leaf. Each of the three components of p is off by at most 10 units of reach (one rounding each
// of c - q, of its correction, of d, of the product and sums of m.d, and of p itself), |p| by at most 18. Widening the
// radius by 32 units of reach therefore keeps every true hit, and moves its near intersection towards the ray's start
// by more than the error of m.d, so that the cull by distance keeps it as well.
struct LeafFrame {
  double point[3];     // q, exact
  float head[3];       // q rounded to f32
  float tail[3];       // q - head
  float direction[3];  // d rounded to f32
  double scale;        // a power of two that brings reach near 1 where f32 would overflow or underflow; mostly 1
  double margin;       // added to every radius
  double t_shift;      // of q along the ray
  float t_low;         // candidates end above it, relative to q, in units of 1 / scale
};

HWY_INLINE LeafFrame MakeLeafFrame(const Ray& ray, double t_enter, double reach) {
  LeafFrame frame;
  frame.t_shift = t_enter;
  frame.scale = 1.0;
  if (HWY_UNLIKELY(!(reach > 1e-12 && reach < 1e12))) frame.scale = std::ldexp(1.0, -std::ilogb(reach));
  for (int c = 0; c < 3; ++c) {
    frame.point[c] = ray.origin[c] + t_enter * ray.direction[c];
    frame.head[c] = static_cast<float>(frame.point[c]);
    frame.tail[c] = static_cast<float>(frame.point[c] - static_cast<double>(frame.head[c]));
    frame.direction[c] = static_cast<float>(ray.direction[c]);
  }
  frame.margin = 32.0 * f32_unit * reach;
  frame.t_low = static_cast<float>((ray.t_min - t_enter - frame.margin) * frame.scale);
  return frame;
}

// Centres of a leaf relative to q, in f32, for the layouts that SIMD loads do not fit.
struct StagedLeaf {
  HWY_ALIGN float x[pkd_leaf_size];
  HWY_ALIGN float y[pkd_leaf_size];
  HWY_ALIGN float z[pkd_leaf_size];
};

template <class Positions>
HWY_INLINE void Stage(const Positions& positions, std::uint64_t begin, std::size_t count, const LeafFrame& frame,
                      StagedLeaf& leaf) {
  for (std::size_t i = 0; i < count; ++i) {
    double centre[3];
    positions.centre(begin + i, centre);
    leaf.x[i] = static_cast<float>((centre[0] - frame.point[0]) * frame.scale);
    leaf.y[i] = static_cast<float>((centre[1] - frame.point[1]) * frame.scale);
    leaf.z[i] = static_cast<float>((centre[2] - frame.point[2]) * frame.scale);
  }
}

// Tests the particles at places [begin, end), at most pkd_leaf_size. True: the visitor needs no more.
template <class Positions, class Visitor>
HWY_INLINE bool VisitLeaf(const PkdTree& tree, const Positions& positions, std::uint64_t begin, std::uint64_t end,
                          double t_enter, double reach, const Ray& ray, Visitor& visitor) {
  const hn::CappedTag<float, pkd_leaf_size> d;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t count = static_cast<std::size_t>(end - begin);
  const LeafFrame frame = MakeLeafFrame(ray, t_enter, reach);
  const auto limit = [&]() HWY_ATTR {
    return hn::Set(d, static_cast<float>((visitor.t_limit() - frame.t_shift + frame.margin) * frame.scale));
  };
  const V dx = hn::Set(d, frame.direction[0]);
  const V dy = hn::Set(d, frame.direction[1]);
  const V dz = hn::Set(d, frame.direction[2]);
  const V low = hn::Set(d, frame.t_low);
  V high = limit();

  const bool uniform = tree.radius.kind == RadiusView::Kind::uniform;
  HWY_ALIGN float radii[pkd_leaf_size];
  V radius = hn::Set(d, static_cast<float>((tree.radius.uniform + frame.margin) * frame.scale));
  if (!uniform) {
    for (std::size_t i = 0; i < count; ++i) {
      const double wide = tree.radius.value(tree.item(begin + i)) + frame.margin;
      radii[i] = static_cast<float>(wide * frame.scale);
    }
  }

  // One vector of particles, given relative to q.
  const auto visit = [&](V mx, V my, V mz, std::size_t first, std::size_t valid) HWY_ATTR -> bool {
    const V r = uniform ? radius : hn::LoadU(d, radii + first);
    const V b = hn::MulAdd(mx, dx, hn::MulAdd(my, dy, hn::Mul(mz, dz)));
    const V px = hn::NegMulAdd(b, dx, mx);
    const V py = hn::NegMulAdd(b, dy, my);
    const V pz = hn::NegMulAdd(b, dz, mz);
    const V distance2 = hn::MulAdd(px, px, hn::MulAdd(py, py, hn::Mul(pz, pz)));
    const V r2 = hn::Mul(r, r);
    auto candidate = hn::Le(distance2, r2);
    if (hn::AllFalse(d, candidate)) return false;
    const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
    candidate = hn::And(candidate, hn::And(hn::Le(hn::Sub(b, s), high), hn::Ge(hn::Add(b, s), low)));
    if (valid < lanes) candidate = hn::And(candidate, hn::FirstN(d, valid));
    if (hn::AllFalse(d, candidate)) return false;
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, candidate, bytes);
    std::uint64_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    for (; bits != 0; bits &= bits - 1) {
      const std::uint64_t place = begin + first + static_cast<std::uint64_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
      if (visitor.visit(tree, positions, place, ray)) return true;
    }
    high = limit();
    return false;
  };

  if constexpr (std::is_same_v<Positions, PlacedPositions<float>>) {
    // A vector that would end behind the leaf starts earlier instead: testing a particle twice does no harm, reading
    // behind the array would.
    const bool packed = positions.packed_records() || positions.packed_columns();
    if (HWY_LIKELY(packed && frame.scale == 1.0 && count >= lanes)) {
      const V hx = hn::Set(d, frame.head[0]);
      const V hy = hn::Set(d, frame.head[1]);
      const V hz = hn::Set(d, frame.head[2]);
      const V tx = hn::Set(d, frame.tail[0]);
      const V ty = hn::Set(d, frame.tail[1]);
      const V tz = hn::Set(d, frame.tail[2]);
      for (std::size_t done = 0; done < count; done += lanes) {
        const std::size_t first = std::min(done, count - lanes);
        V x, y, z;
        if (positions.packed_records()) {
          hn::LoadInterleaved3(d, positions.scalars(begin + first, 0), x, y, z);
        } else {
          x = hn::LoadU(d, positions.scalars(begin + first, 0));
          y = hn::LoadU(d, positions.scalars(begin + first, 1));
          z = hn::LoadU(d, positions.scalars(begin + first, 2));
        }
        if (visit(hn::Sub(hn::Sub(x, hx), tx), hn::Sub(hn::Sub(y, hy), ty), hn::Sub(hn::Sub(z, hz), tz), first, lanes))
          return true;
      }
      return false;
    }
  }
  StagedLeaf leaf;
  Stage(positions, begin, count, frame, leaf);
  for (std::size_t first = 0; first < count; first += lanes)
    if (visit(hn::Load(d, leaf.x + first), hn::Load(d, leaf.y + first), hn::Load(d, leaf.z + first), first,
              count - first))
      return true;
  return false;
}

// The ray's slopes, and by how much a split plane is widened to both sides along the ray: by the largest radius, and a
// little for the rounding of the plane's distance.
struct SlabRay {
  double origin[3];
  double inverse[3];
  double widening[3];
  bool negative[3];
};

HWY_INLINE SlabRay MakeSlabRay(const PkdTree& tree, const Ray& ray) {
  constexpr double parallel = 1e-200;  // slower directions count as this: products stay finite, the signs right
  SlabRay slab;
  for (int c = 0; c < 3; ++c) {
    const double direction = ray.direction[c];
    slab.origin[c] = ray.origin[c];
    slab.negative[c] = direction < 0.0;
    slab.inverse[c] = std::abs(direction) > parallel ? 1.0 / direction : (direction < 0.0 ? -1.0 : 1.0) / parallel;
    const double extent = std::abs(tree.lower[c]) + std::abs(tree.upper[c]) + std::abs(ray.origin[c]);
    slab.widening[c] = (tree.radius_max * (1.0 + 1e-12) + extent * 1e-15) * std::abs(slab.inverse[c]);
  }
  return slab;
}

template <class Key>
struct Subtree {
  std::uint64_t begin;
  std::uint64_t end;
  double t_enter;
  double t_leave;
  PkdBox<Key> box;
};

// Tests the particles below the last split: a leaf, or any number of particles at one point.
template <class Positions, class Visitor>
HWY_INLINE bool VisitRun(const PkdTree& tree, const Positions& positions, const Subtree<typename Positions::Key>& run,
                         const Ray& ray, Visitor& visitor) {
  if (HWY_UNLIKELY(run.end - run.begin > pkd_leaf_size) && Visitor::one_of_coincident &&
      tree.radius.kind == RadiusView::Kind::uniform)
    return visitor.visit(tree, positions, run.begin, ray);  // equal spheres: the build puts the one to be shown first
  double reach = 2.0 * tree.radius_max;
  for (int c = 0; c < 3; ++c) reach += static_cast<double>(run.box.upper[c]) - static_cast<double>(run.box.lower[c]);
  for (std::uint64_t begin = run.begin; begin < run.end; begin += pkd_leaf_size)
    if (VisitLeaf(tree, positions, begin, std::min(run.end, begin + pkd_leaf_size), run.t_enter, reach, ray, visitor))
      return true;
  return false;
}

template <class Positions, class Visitor>
HWY_INLINE void Traverse(const PkdTree& tree, const Positions& positions, const Ray& ray, Visitor& visitor) {
  using Key = typename Positions::Key;
  const SlabRay slab = MakeSlabRay(tree, ray);
  Subtree<Key> now;
  now.begin = 0;
  now.end = tree.count;
  now.t_enter = ray.t_min;
  now.t_leave = visitor.t_limit();
  for (int c = 0; c < 3; ++c) {
    now.box.lower[c] = static_cast<Key>(tree.lower[c]);
    now.box.upper[c] = static_cast<Key>(tree.upper[c]);
    const double at_lower = (tree.lower[c] - slab.origin[c]) * slab.inverse[c];
    const double at_upper = (tree.upper[c] - slab.origin[c]) * slab.inverse[c];
    now.t_enter = std::max(now.t_enter, std::min(at_lower, at_upper) - slab.widening[c]);
    now.t_leave = std::min(now.t_leave, std::max(at_lower, at_upper) + slab.widening[c]);
  }
  if (tree.count == 0 || !(now.t_enter <= now.t_leave)) return;

  // The tree is balanced: 2^64 particles would be 59 levels above the leaves.
  Subtree<Key> stack[64];
  int height = 0;
  for (;;) {
    while (now.end - now.begin > pkd_leaf_size && !now.box.is_point()) {
      const int axis = now.box.split_axis();
      const std::uint64_t mid = now.begin + (now.end - now.begin) / 2;
      const Key plane = positions.key(mid, axis);
      const double at_plane = (static_cast<double>(plane) - slab.origin[axis]) * slab.inverse[axis];
      const double near_leave = at_plane + slab.widening[axis];
      const double far_enter = at_plane - slab.widening[axis];
      const bool go_near = now.t_enter <= near_leave;
      const bool go_far = far_enter <= now.t_leave;
      const bool near_is_lower = !slab.negative[axis];
      bool go_lower = go_near == near_is_lower;  // when only one side is entered
      if (go_near && go_far) {
        // The ray crosses the widened plane within the subtree: the particle on the plane may be hit.
        if (visitor.visit(tree, positions, mid, ray)) return;
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
    if (now.end > now.begin && VisitRun(tree, positions, now, ray, visitor)) return;
    do {
      if (height == 0) return;
      now = stack[--height];
      now.t_leave = std::min(now.t_leave, visitor.t_limit());
    } while (now.t_enter > now.t_leave);
  }
}

template <class Positions>
void FirstHitsIn(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  const Positions positions(tree);
  for (std::size_t i = 0; i < count; ++i) {
    FirstHitVisitor visitor(rays[i], hits[i]);
    Traverse(tree, positions, rays[i], visitor);
  }
}

template <class Positions>
void AnyHitsIn(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const Positions positions(tree);
  for (std::size_t i = 0; i < count; ++i) {
    if (occluded[i] != 0) continue;
    AnyHitVisitor visitor(rays[i]);
    Traverse(tree, positions, rays[i], visitor);
    occluded[i] = visitor.found ? 1 : 0;
  }
}

void FirstHits(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return FirstHitsIn<PlacedPositions<float>>(tree, rays, hits, count);
    case PkdLayout::placed_f64:
      return FirstHitsIn<PlacedPositions<double>>(tree, rays, hits, count);
    case PkdLayout::indexed_f32:
      return FirstHitsIn<IndexedPositions<float>>(tree, rays, hits, count);
    case PkdLayout::indexed_f64:
      return FirstHitsIn<IndexedPositions<double>>(tree, rays, hits, count);
    case PkdLayout::general:
      return FirstHitsIn<GeneralPositions>(tree, rays, hits, count);
  }
}

void AnyHits(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return AnyHitsIn<PlacedPositions<float>>(tree, rays, occluded, count);
    case PkdLayout::placed_f64:
      return AnyHitsIn<PlacedPositions<double>>(tree, rays, occluded, count);
    case PkdLayout::indexed_f32:
      return AnyHitsIn<IndexedPositions<float>>(tree, rays, occluded, count);
    case PkdLayout::indexed_f64:
      return AnyHitsIn<IndexedPositions<double>>(tree, rays, occluded, count);
    case PkdLayout::general:
      return AnyHitsIn<GeneralPositions>(tree, rays, occluded, count);
  }
}

void AllHits(const PkdTree& tree, const Ray& ray, std::vector<Span>& spans) {
  AllHitsVisitor visitor(ray, spans);
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return Traverse(tree, PlacedPositions<float>(tree), ray, visitor);
    case PkdLayout::placed_f64:
      return Traverse(tree, PlacedPositions<double>(tree), ray, visitor);
    case PkdLayout::indexed_f32:
      return Traverse(tree, IndexedPositions<float>(tree), ray, visitor);
    case PkdLayout::indexed_f64:
      return Traverse(tree, IndexedPositions<double>(tree), ray, visitor);
    case PkdLayout::general:
      return Traverse(tree, GeneralPositions(tree), ray, visitor);
  }
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace insitu::kernels {

HWY_EXPORT(FirstHits);
HWY_EXPORT(AnyHits);
HWY_EXPORT(AllHits);

void pkd_first_hits(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FirstHits)(tree, rays, hits, count);
}

void pkd_any_hits(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(AnyHits)(tree, rays, occluded, count);
}

void pkd_all_hits(const PkdTree& tree, const Ray& ray, std::vector<Span>& spans) {
  HWY_DYNAMIC_DISPATCH(AllHits)(tree, ray, spans);
}

}  // namespace insitu::kernels
#endif
