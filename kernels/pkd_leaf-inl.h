// Rays against the particles of one leaf: SIMD over particles for one ray. Included once per SIMD target.
#if defined(INSITU_KERNELS_PKD_LEAF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_LEAF_INL_H_
#undef INSITU_KERNELS_PKD_LEAF_INL_H_
#else
#define INSITU_KERNELS_PKD_LEAF_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "kernels/pkd_margin.h"
#include "kernels/pkd_positions.h"
#include "kernels/pkd_visitors.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Bit i is lane i, of at most 32. The bytes are read back as wide as they were written: a wider load would have to wait
// until the store has reached memory.
template <class D, class Mask>
HWY_INLINE std::uint32_t MaskBits(D d, Mask mask) {
  std::uint8_t bytes[8];
  hn::StoreMaskBits(d, mask, bytes);
  if constexpr (hn::MaxLanes(D()) <= 8) {
    return bytes[0];
  } else if constexpr (hn::MaxLanes(D()) <= 16) {
    std::uint16_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
  } else {
    std::uint32_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
  }
}

// Where lines pass points: how far along the line, and at what distance, squared.
template <class V>
struct Approach {
  V along;
  V distance2;
};

// `m` is the point relative to a point of the line, `d` the line's direction, of unit length. The foot of the
// perpendicular is subtracted before anything is squared, which keeps the digits that m.m - (m.d)^2 would lose.
template <class V>
HWY_INLINE Approach<V> ApproachOf(V mx, V my, V mz, V dx, V dy, V dz) {
  const V along = hn::MulAdd(mx, dx, hn::MulAdd(my, dy, hn::Mul(mz, dz)));
  const V px = hn::NegMulAdd(along, dx, mx);
  const V py = hn::NegMulAdd(along, dy, my);
  const V pz = hn::NegMulAdd(along, dz, mz);
  return {along, hn::MulAdd(px, px, hn::MulAdd(py, py, hn::Mul(pz, pz)))};
}

// What f32 tests of particles need of a ray: everything relative to a point q of the ray.
//
// A test computes m = c - q and p = m - (m.d) d for a centre c at most `reach` away from q. Each of the three
// components of p is off by at most 10 units of reach (one rounding each of c - q, of its correction, of d, of the
// product and sums of m.d, and of p itself), |p| by at most 18. Widening the radius by 32 units of reach therefore
// keeps every true hit, and moves its near intersection towards the ray's start by more than the error of m.d, so that
// the cull by distance keeps it as well.
struct RayFrame {
  double point[3];     // q
  float head[3];       // q rounded to f32
  float tail[3];       // q - head
  float direction[3];  // d rounded to f32
  double scale;        // a power of two that brings reach near 1 where f32 would overflow or underflow; mostly 1
  double margin;       // added to every radius
  double t_shift;      // of q along the ray
  float t_low;         // candidates end above it, relative to q, in units of 1 / scale
};

// For one leaf: q is where the ray enters it, so that a leaf far from the origin is as sharp as any other.
HWY_INLINE RayFrame MakeLeafFrame(const Ray& ray, double t_enter, double reach) {
  RayFrame frame;
  frame.t_shift = t_enter;
  frame.scale = 1.0;
  if (HWY_UNLIKELY(!(reach > 1e-12 && reach < 1e12))) frame.scale = std::ldexp(1.0, -std::ilogb(reach));
  for (int c = 0; c < 3; ++c) {
    frame.point[c] = ray.origin[c] + t_enter * ray.direction[c];
    frame.head[c] = static_cast<float>(frame.point[c]);
    frame.tail[c] = static_cast<float>(frame.point[c] - static_cast<double>(frame.head[c]));
    frame.direction[c] = static_cast<float>(ray.direction[c]);
  }
  // The second term is the rounding of q itself, in double, for rays that come from far away.
  double distance = std::abs(t_enter) + reach;
  for (int c = 0; c < 3; ++c) distance = std::max(distance, std::abs(ray.origin[c]));
  frame.margin = 32.0 * f32_unit * reach + 64.0 * f64_unit * distance;
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
HWY_INLINE void Stage(const Positions& positions, std::uint64_t begin, std::size_t count, const RayFrame& frame,
                      StagedLeaf& leaf) {
  for (std::size_t i = 0; i < count; ++i) {
    double centre[3];
    positions.centre(begin + i, centre);
    leaf.x[i] = static_cast<float>((centre[0] - frame.point[0]) * frame.scale);
    leaf.y[i] = static_cast<float>((centre[1] - frame.point[1]) * frame.scale);
    leaf.z[i] = static_cast<float>((centre[2] - frame.point[2]) * frame.scale);
  }
}

// Calls visitor.visit() for the particles that the ray may hit. True: the visitor needs no more.
template <class Positions, class Visitor>
HWY_INLINE bool VisitLeaf(const PkdTree& tree, const Positions& positions, std::uint64_t begin, std::uint64_t end,
                          const RayFrame& frame, const Ray& ray, Visitor& visitor) {
  const hn::CappedTag<float, pkd_leaf_size> d;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t count = static_cast<std::size_t>(end - begin);
  const std::uint64_t drawn = tree.selected.all() ? ~std::uint64_t{0} : tree.selected.bits(begin, count);
  if (drawn == 0) return false;
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
  const V radius = hn::Set(d, static_cast<float>((tree.radius.uniform + frame.margin) * frame.scale));
  if (!uniform) {
    for (std::size_t i = 0; i < count; ++i) {
      const double wide = tree.radius.value(tree.item(begin + i)) + frame.margin;
      radii[i] = static_cast<float>(wide * frame.scale);
    }
  }

  // One vector of particles, given relative to q.
  const auto visit = [&](V mx, V my, V mz, std::size_t first, std::size_t valid) HWY_ATTR -> bool {
    const V r = uniform ? radius : hn::LoadU(d, radii + first);
    const auto [b, distance2] = ApproachOf(mx, my, mz, dx, dy, dz);
    const V r2 = hn::Mul(r, r);
    auto candidate = hn::Le(distance2, r2);
    if (hn::AllFalse(d, candidate)) return false;
    const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
    candidate = hn::And(candidate, hn::And(hn::Le(hn::Sub(b, s), high), hn::Ge(hn::Add(b, s), low)));
    if (valid < lanes) candidate = hn::And(candidate, hn::FirstN(d, valid));
    if (hn::AllFalse(d, candidate)) return false;
    const auto drawn_here = static_cast<std::uint32_t>(drawn >> first);
    for (std::uint32_t bits = MaskBits(d, candidate) & drawn_here; bits != 0; bits &= bits - 1) {
      const std::uint64_t place = begin + first + hwy::Num0BitsBelowLS1Bit_Nonzero32(bits);
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
        x = hn::Sub(x, hx);
        y = hn::Sub(y, hy);
        z = hn::Sub(z, hz);
        x = hn::Sub(x, hn::Set(d, frame.tail[0]));
        y = hn::Sub(y, hn::Set(d, frame.tail[1]));
        z = hn::Sub(z, hn::Set(d, frame.tail[2]));
        if (visit(x, y, z, first, lanes)) return true;
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

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
