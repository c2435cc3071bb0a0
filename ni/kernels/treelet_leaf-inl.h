// The particles of a treelet against one ray, in the frame of the whole tree. Included once per SIMD target.
#if defined(INSITU_KERNELS_TREELET_LEAF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_TREELET_LEAF_INL_H_
#undef INSITU_KERNELS_TREELET_LEAF_INL_H_
#else
#define INSITU_KERNELS_TREELET_LEAF_INL_H_
#endif

#include "kernels/pkd_leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <class Positions>
class TreeletLeaf {
 public:
  static constexpr std::size_t most_lanes = 16;

  TreeletLeaf(const PkdTree& tree, double margin)
      : tree_(tree), margin_(margin), uniform_(tree.radius.kind == RadiusView::Kind::uniform) {
    const double wide = tree.radius.uniform + margin;
    radius_ = static_cast<float>(wide * (1.0 + 4.0 * f32_unit));
    radius2_ = static_cast<float>(wide * wide * (1.0 + 8.0 * f32_unit));
  }

  // Of records, a line of memory holds five.
  HWY_INLINE void Prefetch(const Positions& positions, std::uint64_t begin, std::uint64_t end) const {
    for (std::uint64_t place = begin; place < end; place += 5) positions.prefetch(place);
    positions.prefetch(end - 1);
  }

  // Calls confirm(ray, place) for the pairs that may hit; where it returns true the ray needs no more.
  template <class Rays, class ConfirmHit>
  HWY_INLINE void VisitTogether(const Positions& positions, std::uint64_t begin, std::uint64_t end, const Rays* rays,
                                const std::uint32_t* list, std::size_t list_size, const ConfirmHit& confirm) const {
    const hn::CappedTag<float, most_lanes> d;
    using V = hn::Vec<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    for (; begin < end; begin += lanes) {
      const std::size_t count = std::min<std::size_t>(end - begin, lanes);
      V x, y, z;
      Load(positions, begin, count, x, y, z);
      V r2 = hn::Set(d, radius2_);
      if (HWY_UNLIKELY(!uniform_)) {
        HWY_ALIGN float radii2[most_lanes] = {};
        for (std::size_t i = 0; i < count; ++i) {
          const double wide = tree_.radius.value(tree_.item(begin + i)) + margin_;
          radii2[i] = static_cast<float>(wide * wide * (1.0 + 8.0 * f32_unit));
        }
        r2 = hn::Load(d, radii2);
      }
      const std::uint32_t valid = ~std::uint32_t{0} >> (32 - count);
      for (std::size_t i = 0; i < list_size; ++i) {
        const auto& ray = rays[list[i]];
        const auto [b, distance2] =
            ApproachOf(hn::Sub(x, hn::Set(d, ray.origin[0])), hn::Sub(y, hn::Set(d, ray.origin[1])),
                       hn::Sub(z, hn::Set(d, ray.origin[2])), hn::Set(d, ray.direction[0]),
                       hn::Set(d, ray.direction[1]), hn::Set(d, ray.direction[2]));
        const auto close = hn::Le(distance2, r2);
        if (HWY_LIKELY(hn::AllFalse(d, close))) continue;
        const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
        const auto in_time =
            hn::And(hn::Le(hn::Sub(b, s), hn::Set(d, ray.t_high)), hn::Ge(hn::Add(b, s), hn::Set(d, ray.t_low)));
        std::uint32_t bits = MaskBits(d, hn::And(close, in_time)) & valid;
        for (; bits != 0; bits &= bits - 1)
          if (confirm(list[i], begin + hwy::Num0BitsBelowLS1Bit_Nonzero32(bits))) break;
      }
    }
  }

  // Calls visit(place, radius with margin) for the particles that the beam can touch up to the distance `latest`.
  template <class Beam, class VisitParticle>
  HWY_INLINE void VisitWithinBeam(const Positions& positions, std::uint64_t begin, std::uint64_t end, const Beam& beam,
                                  float latest, const VisitParticle& visit) const {
    const hn::CappedTag<float, most_lanes> d;
    using V = hn::Vec<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    for (; begin < end; begin += lanes) {
      const std::size_t count = std::min<std::size_t>(end - begin, lanes);
      V x, y, z;
      Load(positions, begin, count, x, y, z);
      V r = hn::Set(d, radius_);
      HWY_ALIGN float radii[most_lanes];
      if (HWY_UNLIKELY(!uniform_)) {
        for (std::size_t i = 0; i < count; ++i)
          radii[i] = static_cast<float>((tree_.radius.value(tree_.item(begin + i)) + margin_) * (1.0 + 4.0 * f32_unit));
        for (std::size_t i = count; i < most_lanes; ++i) radii[i] = 0.0f;
        r = hn::Load(d, radii);
      }
      const auto [b, distance2] =
          ApproachOf(hn::Sub(x, hn::Set(d, beam.origin[0])), hn::Sub(y, hn::Set(d, beam.origin[1])),
                     hn::Sub(z, hn::Set(d, beam.origin[2])), hn::Set(d, beam.direction[0]),
                     hn::Set(d, beam.direction[1]), hn::Set(d, beam.direction[2]));
      const V wide = hn::Add(r, hn::Set(d, beam.start));
      const V t = hn::Mul(hn::Max(hn::Add(b, wide), hn::Zero(d)), hn::Set(d, beam.stretch));
      const V reach = hn::MulAdd(hn::Set(d, beam.growth), t, wide);
      const auto meets =
          hn::And(hn::Le(distance2, hn::Mul(reach, reach)), hn::Le(hn::Sub(b, reach), hn::Set(d, latest)));
      std::uint32_t bits = MaskBits(d, meets) & ~std::uint32_t{0} >> (32 - count);
      for (; bits != 0; bits &= bits - 1) {
        const auto i = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits));
        visit(begin + i, uniform_ ? radius_ : radii[i]);
      }
    }
  }

 private:
  template <class V>
  HWY_INLINE void Load(const Positions& positions, std::uint64_t begin, std::size_t count, V& x, V& y, V& z) const {
    const hn::CappedTag<float, most_lanes> d;
    if constexpr (std::is_same_v<Positions, PlacedPositions<float>>) {
      // What stands behind the treelet is read along, as far as there is something, and left alone.
      if (HWY_LIKELY(begin + hn::Lanes(d) <= tree_.position.count)) {
        if (HWY_LIKELY(positions.packed_records()))
          return hn::LoadInterleaved3(d, positions.scalars(begin, 0), x, y, z);
        if (positions.packed_columns()) {
          x = hn::LoadU(d, positions.scalars(begin, 0));
          y = hn::LoadU(d, positions.scalars(begin, 1));
          z = hn::LoadU(d, positions.scalars(begin, 2));
          return;
        }
      }
    }
    HWY_ALIGN float staged[3][most_lanes] = {};
    for (std::size_t i = 0; i < count; ++i) {
      float centre[3];
      positions.centre_f32(begin + i, centre);
      for (std::size_t c = 0; c < 3; ++c) staged[c][i] = centre[c];
    }
    x = hn::Load(d, staged[0]);
    y = hn::Load(d, staged[1]);
    z = hn::Load(d, staged[2]);
  }

  const PkdTree& tree_;
  double margin_;
  bool uniform_;
  float radius_;
  float radius2_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
