// Where rays enter a P-k-d tree, and what f32 tests need of them from there on: SIMD over rays. Included once per SIMD
// target.
#if defined(INSITU_KERNELS_PKD_ENTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_ENTER_INL_H_
#undef INSITU_KERNELS_PKD_ENTER_INL_H_
#else
#define INSITU_KERNELS_PKD_ENTER_INL_H_
#endif

#include <cstddef>

#include "kernels/pkd_leaf-inl.h"
#include "kernels/pkd_margin.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Rays as they are, component by component, as far as ray.h gives them in doubles that follow each other.
struct RayColumns {
  static constexpr std::size_t size = 16;
  HWY_ALIGN double origin[3][size];
  HWY_ALIGN double direction[3][size];
  HWY_ALIGN double t_min[size];
  HWY_ALIGN double t_max[size];

  // rays[0 .. count), at most `size`; lanes behind them repeat the first.
  HWY_INLINE void Load(const Ray* rays, std::size_t count) {
    static_assert(offsetof(Ray, direction) == 3 * sizeof(double) && offsetof(Ray, t_min) == 6 * sizeof(double) &&
                  offsetof(Ray, t_max) == 7 * sizeof(double));
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < size; ++i) {
      const Ray& ray = rays[i < count ? i : 0];
      for (int c = 0; c < 3; ++c) {
        origin[c][i] = ray.origin[c];
        direction[c][i] = ray.direction[c];
      }
      t_min[i] = ray.t_min;
      t_max[i] = ray.t_max;
    }
#else
    // Two rays at a time, by hand: left alone, compilers gather, which takes several times as long.
    const hn::CappedTag<double, 2> d;
    for (std::size_t i = 0; i < size; i += 2) {
      const auto* const a = reinterpret_cast<const double*>(&rays[i < count ? i : 0]);
      const auto* const b = reinterpret_cast<const double*>(&rays[i + 1 < count ? i + 1 : 0]);
      const auto xy_a = hn::LoadU(d, a), zu_a = hn::LoadU(d, a + 2), vw_a = hn::LoadU(d, a + 4);
      const auto xy_b = hn::LoadU(d, b), zu_b = hn::LoadU(d, b + 2), vw_b = hn::LoadU(d, b + 4);
      hn::Store(hn::InterleaveLower(d, xy_a, xy_b), d, origin[0] + i);
      hn::Store(hn::InterleaveUpper(d, xy_a, xy_b), d, origin[1] + i);
      hn::Store(hn::InterleaveLower(d, zu_a, zu_b), d, origin[2] + i);
      hn::Store(hn::InterleaveUpper(d, zu_a, zu_b), d, direction[0] + i);
      hn::Store(hn::InterleaveLower(d, vw_a, vw_b), d, direction[1] + i);
      hn::Store(hn::InterleaveUpper(d, vw_a, vw_b), d, direction[2] + i);
      const auto limits_a = hn::LoadU(d, a + 6), limits_b = hn::LoadU(d, b + 6);
      hn::Store(hn::InterleaveLower(d, limits_a, limits_b), d, t_min + i);
      hn::Store(hn::InterleaveUpper(d, limits_a, limits_b), d, t_max + i);
    }
#endif
  }

  // The largest magnitude among the coordinates of the origins.
  HWY_INLINE double Distance() const {
    const hn::CappedTag<double, size> d;
    auto largest = hn::Zero(d);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < size; i += hn::Lanes(d))
        largest = hn::Max(largest, hn::Abs(hn::Load(d, origin[c] + i)));
    return hn::GetLane(hn::MaxOfLanes(d, largest));
  }
};

// Rays where they enter the tree. Lanes of rays that miss it, and lanes without a ray, hold harmless numbers, and an
// interval that is empty.
struct EnteredRays {
  static constexpr std::size_t size = RayColumns::size;

  HWY_ALIGN float origin[3][size];  // the point from which distances count
  HWY_ALIGN float direction[3][size];
  HWY_ALIGN float inverse[3][size];
  HWY_ALIGN float widening[3][size];  // of split planes along the ray, by the largest radius and the rounding
  HWY_ALIGN float t_low[size];        // candidates end above it
  HWY_ALIGN float t_enter[size];
  HWY_ALIGN float t_high[size];
  HWY_ALIGN double t_shift[size];  // of `origin` along the ray
  std::uint32_t inside;            // bit i: ray i enters the tree

  bool is_inside(std::size_t lane) const { return (inside >> lane & 1) != 0; }
};

// Takes the first `count` rays of `columns`, of which nothing behind t_limits counts. Where all of them enter the tree
// close to each other, as camera rays do, their distances count from the same number, the nearest entry; else each
// counts from its own. Returns true for the former.
HWY_NOINLINE bool EnterTree(const PkdTree& tree, const TreeMargin& margin, const RayColumns& columns,
                          const double* t_limits, std::size_t count, bool may_share_shift, EnteredRays& out) {
  constexpr std::size_t size = EnteredRays::size;
  constexpr double parallel = 1e-18;  // slower directions count as this: products stay finite in f32, the signs right
  const hn::CappedTag<double, size> d;
  const hn::Rebind<float, decltype(d)> f;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);
  const auto& origin = columns.origin;
  const auto& direction = columns.direction;
  const auto& t_min = columns.t_min;

  HWY_ALIGN double enter[size];
  HWY_ALIGN double leave[size];
  for (std::size_t i = 0; i < size; ++i) leave[i] = i < count ? t_limits[i] : -std::numeric_limits<double>::infinity();

  const double wide = tree.radius_max + margin.value;
  const V zero = hn::Zero(d);
  out.inside = 0;
  for (std::size_t i = 0; i < size; i += lanes) {
    V from = hn::Load(d, t_min + i);
    V to = hn::Load(d, leave + i);
    for (std::size_t c = 0; c < 3; ++c) {
      const V o = hn::Load(d, origin[c] + i);
      const V along = hn::Load(d, direction[c] + i);
      const V slow = hn::IfThenElse(hn::Lt(along, zero), hn::Set(d, -parallel), hn::Set(d, parallel));
      const V inverse =
          hn::Div(hn::Set(d, 1.0), hn::IfThenElse(hn::Gt(hn::Abs(along), hn::Set(d, parallel)), along, slow));
      const V widening = hn::Mul(hn::Set(d, wide), hn::Abs(inverse));
      const V at_lower = hn::Mul(hn::Sub(hn::Set(d, tree.lower[c]), o), inverse);
      const V at_upper = hn::Mul(hn::Sub(hn::Set(d, tree.upper[c]), o), inverse);
      from = hn::Max(from, hn::Sub(hn::Min(at_lower, at_upper), widening));
      to = hn::Min(to, hn::Add(hn::Max(at_lower, at_upper), widening));
      hn::Store(hn::DemoteTo(f, inverse), f, out.inverse[c] + i);
      hn::Store(hn::DemoteTo(f, hn::Mul(widening, hn::Set(d, 1.0 + 4.0 * f32_unit))), f, out.widening[c] + i);
    }
    hn::Store(from, d, enter + i);
    hn::Store(to, d, leave + i);
    out.inside |= MaskBits(d, hn::Le(from, to)) << i;
  }

  double nearest = std::numeric_limits<double>::infinity();
  double farthest = -nearest;
  for (std::size_t i = 0; i < size; ++i) {
    if (!out.is_inside(i)) continue;
    nearest = std::min(nearest, enter[i]);
    farthest = std::max(farthest, enter[i]);
  }
  const bool share_shift = may_share_shift && out.inside != 0 && farthest - nearest <= margin.extent;
  for (std::size_t i = 0; i < size; i += lanes) {
    const auto is_inside = hn::Le(hn::Load(d, enter + i), hn::Load(d, leave + i));
    const V from = hn::IfThenElseZero(is_inside, hn::Load(d, enter + i));
    const V shift = share_shift ? hn::Set(d, nearest) : from;
    hn::Store(shift, d, out.t_shift + i);
    for (std::size_t c = 0; c < 3; ++c) {
      const V along = hn::IfThenElseZero(is_inside, hn::Load(d, direction[c] + i));
      const V o = hn::IfThenElseZero(is_inside, hn::Load(d, origin[c] + i));
      hn::Store(hn::DemoteTo(f, hn::MulAdd(shift, along, o)), f, out.origin[c] + i);
      hn::Store(hn::DemoteTo(f, along), f, out.direction[c] + i);
    }
    const V rounding = hn::Set(d, margin.value);
    const V one = hn::Set(d, 1.0);
    const V low = hn::Sub(hn::Sub(hn::Load(d, t_min + i), shift), rounding);
    const V later = hn::Mul(hn::Sub(from, shift), hn::Set(d, 1.0 - 4.0 * f32_unit));
    const V high = hn::Add(hn::Sub(hn::Load(d, leave + i), shift), rounding);
    hn::Store(hn::DemoteTo(f, low), f, out.t_low + i);
    hn::Store(hn::DemoteTo(f, hn::IfThenElse(is_inside, later, one)), f, out.t_enter + i);
    hn::Store(hn::DemoteTo(f, hn::IfThenElse(is_inside, high, hn::Neg(one))), f, out.t_high + i);
  }
  return share_shift;
}

HWY_NOINLINE bool EnterTree(const PkdTree& tree, const TreeMargin& margin, const Ray* rays, const double* t_limits,
                          std::size_t count, bool may_share_shift, EnteredRays& out) {
  RayColumns columns;
  columns.Load(rays, count);
  return EnterTree(tree, margin, columns, t_limits, count, may_share_shift, out);
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
