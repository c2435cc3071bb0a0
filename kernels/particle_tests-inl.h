// Some particles against rays and beams, in the frame of the whole tree: SIMD over particles. Included once per SIMD
// target.
#if defined(INSITU_KERNELS_PARTICLE_TESTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PARTICLE_TESTS_INL_H_
#undef INSITU_KERNELS_PARTICLE_TESTS_INL_H_
#else
#define INSITU_KERNELS_PARTICLE_TESTS_INL_H_
#endif

#include "kernels/particle_runs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// They know the radii of a tree, and the margin by which f32 may be off.
class ParticleTests {
 public:
  static constexpr std::size_t most_lanes = 16;

  ParticleTests(const PkdTree& tree, const TreeMargin& margin)
      : tree_(tree),
        margin_above_(static_cast<float>(margin.value * (1.0 + 2.0 * f32_unit))),
        uniform_(tree.radius.kind == RadiusView::Kind::uniform),
        shrink_(margin.twice()) {
    const ArrayView& radii = tree.radius.array;
    const bool by_place = tree.index32 == nullptr && tree.index64 == nullptr;
    if (tree.radius.kind == RadiusView::Kind::per_item && by_place && !radii.rows &&
        radii.stride == static_cast<std::ptrdiff_t>(size_of(radii.type)) &&
        (radii.type == Scalar::f32 || radii.type == Scalar::f64)) {
      packed_radii_ = radii.base[0];
      packed_in_f32_ = radii.type == Scalar::f32;
    }
    const double wide = tree.radius.uniform + margin.value;
    const double inner = std::max(tree.radius.uniform - margin.value, 0.0);
    inner2_ = static_cast<float>(inner * inner * (1.0 - 8.0 * f32_unit));
    radius_ = static_cast<float>(wide * (1.0 + 4.0 * f32_unit));
    radius2_ = static_cast<float>(wide * wide * (1.0 + 8.0 * f32_unit));
  }

  // Calls confirm(ray, place, is_certain) for the pairs that may hit; where it returns true the ray needs no more, and
  // keep_open(list, size) leaves such rays out of the list.
  //
  // What is certain is hit in truth, behind the start and before the end of the ray. The sphere without its margin is
  // hit, and either from outside: the one with it begins behind t_low and two margins (which is the start of the ray
  // and one), and the hit lies before the middle, b, which is nearer than t_high less two margins. Or it is at least
  // left in time: with its margin it ends before t_high less two margins, and the middle, or the end without the
  // margin, is behind t_low and two margins.
  template <class Particles, class Rays, class ConfirmHit, class KeepOpen>
  HWY_INLINE void VisitTogether(const Particles& particles, const Rays* rays, std::uint32_t* list,
                                std::size_t list_size, const ConfirmHit& confirm, const KeepOpen& keep_open) const {
    const hn::CappedTag<float, most_lanes> d;
    using V = hn::Vec<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t first = 0; first < particles.size(); first += lanes) {
      const std::size_t count = std::min(particles.size() - first, lanes);
      const std::uint32_t drawn = particles.Drawn(first, count);
      if (Particles::is_filtered && drawn == 0) continue;
      V x, y, z;
      particles.Load(d, first, count, x, y, z);
      V r2 = hn::Set(d, radius2_);
      V inner2 = hn::Set(d, inner2_);
      if (HWY_UNLIKELY(!uniform_)) {
        const V radius = RadiiOf(d, particles, first, count);
        const V wide = Wide(d, radius);
        const V inner = hn::Max(hn::Sub(hn::Mul(radius, hn::Set(d, below_)), hn::Set(d, margin_above_)), hn::Zero(d));
        r2 = hn::Mul(hn::Mul(wide, wide), hn::Set(d, above_));
        inner2 = hn::Mul(hn::Mul(inner, inner), hn::Set(d, below_));
      }
      bool any_done = false;
      for (std::size_t i = 0; i < list_size; ++i) {
        const auto& ray = rays[list[i]];
        // By the moment of the line (docs/math/particles.md): less to do than ApproachOf() for what is not close.
        const V dx = hn::Set(d, ray.direction[0]);
        const V dy = hn::Set(d, ray.direction[1]);
        const V dz = hn::Set(d, ray.direction[2]);
        const V px = hn::NegMulAdd(z, dy, hn::MulSub(y, dz, hn::Set(d, ray.moment[0])));
        const V py = hn::NegMulAdd(x, dz, hn::MulSub(z, dx, hn::Set(d, ray.moment[1])));
        const V pz = hn::NegMulAdd(y, dx, hn::MulSub(x, dy, hn::Set(d, ray.moment[2])));
        const V distance2 = hn::MulAdd(px, px, hn::MulAdd(py, py, hn::Mul(pz, pz)));
        const auto close = hn::Le(distance2, r2);
        if (HWY_LIKELY(hn::AllFalse(d, close))) continue;
        const V b = hn::MulAdd(x, dx, hn::MulAdd(y, dy, hn::MulSub(z, dz, hn::Set(d, ray.foot))));
        const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
        const V enter = hn::Sub(b, s);
        const V leave = hn::Add(b, s);
        const auto in_time = hn::And(hn::Le(enter, hn::Set(d, ray.t_high)), hn::Ge(leave, hn::Set(d, ray.t_low)));
        std::uint32_t possible = MaskBits(d, hn::And(close, in_time)) & drawn;
        if (possible == 0) continue;
        const V begin = hn::Set(d, ray.t_low + shrink_);
        const V end = hn::Set(d, ray.t_high - shrink_);
        const std::uint32_t is_hit = possible & MaskBits(d, hn::Lt(distance2, inner2));
        std::uint32_t certain = is_hit & MaskBits(d, hn::Or(hn::And(hn::Gt(enter, begin), hn::Lt(b, end)),
                                                            hn::And(hn::Gt(b, begin), hn::Lt(leave, end))));
        if (certain == 0 && is_hit != 0) {
          const V inner_leave = hn::Add(b, hn::Sqrt(hn::Max(hn::Sub(inner2, distance2), hn::Zero(d))));
          certain = is_hit & MaskBits(d, hn::And(hn::Gt(inner_leave, begin), hn::Lt(leave, end)));
        }
        possible &= ~certain;
        bool done = false;
        for (; certain != 0 && !done; certain &= certain - 1)
          done = confirm(list[i], particles.place(first + hwy::Num0BitsBelowLS1Bit_Nonzero32(certain)), true);
        for (; possible != 0 && !done; possible &= possible - 1)
          done = confirm(list[i], particles.place(first + hwy::Num0BitsBelowLS1Bit_Nonzero32(possible)), false);
        any_done |= done;
      }
      if (any_done && first + lanes < particles.size()) list_size = keep_open(list, list_size);
    }
  }

  // Calls visit(place, centre, radius with margin) for the particles that the beam can touch up to the distance
  // beam.latest, and update() now and then, which may make that less.
  template <class Particles, class Beam, class VisitParticle, class Update>
  HWY_INLINE void VisitWithinBeam(const Particles& particles, const Beam& beam, const VisitParticle& visit,
                                  const Update& update) const {
    const hn::CappedTag<float, most_lanes> d;
    using V = hn::Vec<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t first = 0; first < particles.size(); first += lanes) {
      const std::size_t count = std::min(particles.size() - first, lanes);
      const std::uint32_t drawn = particles.Drawn(first, count);
      if (Particles::is_filtered && drawn == 0) continue;
      V x, y, z;
      particles.Load(d, first, count, x, y, z);
      V r = hn::Set(d, radius_);
      HWY_ALIGN float radii[most_lanes];
      if (HWY_UNLIKELY(!uniform_)) {
        r = Wide(d, RadiiOf(d, particles, first, count));
        hn::Store(r, d, radii);
      }
      const auto [b, distance2] =
          ApproachOf(hn::Sub(x, hn::Set(d, beam.origin[0])), hn::Sub(y, hn::Set(d, beam.origin[1])),
                     hn::Sub(z, hn::Set(d, beam.origin[2])), hn::Set(d, beam.direction[0]),
                     hn::Set(d, beam.direction[1]), hn::Set(d, beam.direction[2]));
      const V wide = hn::Add(r, hn::Set(d, beam.start));
      const V t = hn::Mul(hn::Max(hn::Add(b, wide), hn::Zero(d)), hn::Set(d, beam.stretch));
      const V reach = hn::MulAdd(hn::Set(d, beam.growth), t, wide);
      const V latest = hn::Set(d, beam.latest);
      const auto meets = hn::And(hn::Le(distance2, hn::Mul(reach, reach)), hn::Le(hn::Sub(b, reach), latest));
      std::uint32_t bits = MaskBits(d, meets) & drawn;
      if (bits == 0) continue;
      // What holds all rays from their begin to behind the latest distance is not hit before. A sphere, less what the
      // rays are off the axis, holds a piece of the axis when it holds its ends.
      const V off =
          hn::MulAdd(hn::Set(d, beam.growth), latest, hn::Set(d, beam.start + beam.uncertain + 2.0f * shrink_));
      const V inner = hn::Max(hn::Sub(hn::Mul(r, hn::Set(d, below_)), off), hn::Zero(d));
      const V far = hn::Max(hn::Abs(hn::Sub(b, hn::Set(d, beam.begin))), hn::Abs(hn::Sub(latest, b)));
      bits &= ~MaskBits(d, hn::Lt(hn::MulAdd(far, far, distance2), hn::Mul(inner, inner)));
      for (; bits != 0; bits &= bits - 1) {
        const auto i = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits));
        float centre[3];
        particles.Centre(first + i, centre);
        visit(particles.place(first + i), centre, uniform_ ? radius_ : radii[i]);
      }
      update();
    }
  }

 private:
  // In f32, off by at most four units each: one for the radius, one for the scale, one for each operation. Lanes behind
  // `count` hold anything.
  template <class D, class Particles>
  HWY_INLINE hn::Vec<D> RadiiOf(D d, const Particles& particles, std::size_t first, std::size_t count) const {
    if constexpr (Particles::is_run) {
      const std::uint64_t begin = particles.place(first);
      if (packed_radii_ != nullptr && begin + hn::Lanes(d) <= tree_.position.count) {
        const hn::Vec<D> scale = hn::Set(d, static_cast<float>(tree_.radius.scale));
        return hn::Mul(scale, packed_in_f32_ ? LoadColumn(d, reinterpret_cast<const float*>(packed_radii_) + begin)
                                             : LoadColumn(d, reinterpret_cast<const double*>(packed_radii_) + begin));
      }
    }
    HWY_ALIGN float radii[most_lanes] = {};
    for (std::size_t i = 0; i < count; ++i)
      radii[i] = static_cast<float>(tree_.radius.value(tree_.item(particles.place(first + i))));
    return hn::Load(d, radii);
  }
  // Not less than radius and margin in truth.
  template <class D, class V>
  HWY_INLINE V Wide(D d, V radius) const {
    return hn::Mul(hn::Add(radius, hn::Set(d, margin_above_)), hn::Set(d, above_));
  }

  const PkdTree& tree_;
  float margin_above_;
  float above_ = static_cast<float>(1.0 + 8.0 * f32_unit);
  float below_ = static_cast<float>(1.0 - 8.0 * f32_unit);
  bool uniform_;
  const std::byte* packed_radii_ = nullptr;  // by place, where the arrays have them so
  bool packed_in_f32_ = false;
  float radius_;
  float radius2_;
  float inner2_;  // of the sphere without its margin
  float shrink_;  // two margins
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
