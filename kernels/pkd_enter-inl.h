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
  static constexpr std::size_t count = 8;
  HWY_ALIGN double columns[count][size];

  const double* origin(std::size_t c) const { return columns[c]; }
  const double* direction(std::size_t c) const { return columns[3 + c]; }
  const double* t_min() const { return columns[6]; }
  const double* t_max() const { return columns[7]; }

  // rays[0 .. n), at most `size`; lanes behind them repeat the first. Whole vectors are transposed by hand: left alone,
  // compilers gather, which takes several times as long, and vectors that were stored in parts are slow to be read.
  HWY_INLINE void Load(const Ray* rays, std::size_t n) {
    static_assert(offsetof(Ray, direction) == 3 * sizeof(double) && offsetof(Ray, t_min) == 6 * sizeof(double) &&
                  offsetof(Ray, t_max) == 7 * sizeof(double));
    const hn::CappedTag<double, count> d;
    const std::size_t lanes = hn::Lanes(d);
    const double* rows[count];
    for (std::size_t i = 0; i < size; i += lanes) {
      for (std::size_t k = 0; k < lanes; ++k)
        rows[k] = reinterpret_cast<const double*>(&rays[HWY_LIKELY(i + k < n) ? i + k : 0]);
      for (std::size_t c = 0; c < count; c += lanes) Transpose(d, rows, c, i);
    }
  }

  // Every coordinate of every origin is nearer to zero.
  HWY_INLINE bool StartWithin(double distance) const {
    const hn::CappedTag<double, size> d;
    auto largest = hn::Zero(d);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < size; i += hn::Lanes(d))
        largest = hn::Max(largest, hn::Abs(hn::Load(d, origin(c) + i)));
    return hn::AllTrue(d, hn::Lt(largest, hn::Set(d, distance)));
  }

 private:
  // Columns c .. c + lanes of as many rays, to lanes i and following.
#if HWY_TARGET == HWY_SCALAR
  template <class D>
  HWY_INLINE void Transpose(D, const double* const* rows, std::size_t c, std::size_t i) {
    columns[c][i] = rows[0][c];
  }
#else
  template <class D>
  HWY_INLINE void Transpose(D d, const double* const* rows, std::size_t c, std::size_t i) {
    // Pairs of rays first; of each pair, block b holds columns 2 b (even) and 2 b + 1 (odd).
    constexpr std::size_t pairs = hn::MaxLanes(D()) / 2;
    hn::Vec<D> even[pairs];
    hn::Vec<D> odd[pairs];
    for (std::size_t k = 0; k < pairs; ++k) {
      const auto a = hn::LoadU(d, rows[2 * k] + c);
      const auto b = hn::LoadU(d, rows[2 * k + 1] + c);
      even[k] = hn::InterleaveLower(d, a, b);
      odd[k] = hn::InterleaveUpper(d, a, b);
    }
    TransposeBlocks(d, even, columns + c, i);
    TransposeBlocks(d, odd, columns + c + 1, i);
  }
  // Block b of all pairs, to to[2 b].
  template <class D>
  static HWY_INLINE void TransposeBlocks(D d, const hn::Vec<D>* pairs, double (*to)[size], std::size_t i) {
    if constexpr (hn::MaxLanes(D()) == 2) {
      hn::Store(pairs[0], d, to[0] + i);
    } else if constexpr (hn::MaxLanes(D()) == 4) {
      hn::Store(hn::ConcatLowerLower(d, pairs[1], pairs[0]), d, to[0] + i);
      hn::Store(hn::ConcatUpperUpper(d, pairs[1], pairs[0]), d, to[2] + i);
    } else {
      static_assert(hn::MaxLanes(D()) == 8);
      const auto even_01 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(pairs[1]), pairs[0]);
      const auto even_23 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(pairs[3]), pairs[2]);
      const auto odd_01 = hn::OddEvenBlocks(pairs[1], hn::SwapAdjacentBlocks(pairs[0]));
      const auto odd_23 = hn::OddEvenBlocks(pairs[3], hn::SwapAdjacentBlocks(pairs[2]));
      hn::Store(hn::ConcatLowerLower(d, even_23, even_01), d, to[0] + i);
      hn::Store(hn::ConcatLowerLower(d, odd_23, odd_01), d, to[2] + i);
      hn::Store(hn::ConcatUpperUpper(d, even_23, even_01), d, to[4] + i);
      hn::Store(hn::ConcatUpperUpper(d, odd_23, odd_01), d, to[6] + i);
    }
  }
#endif
};

// Rays where they enter the tree. Lanes of rays that miss it, and lanes without a ray, hold harmless numbers, and an
// interval that is empty.
struct EnteredRays {
  static constexpr std::size_t size = RayColumns::size;

  HWY_ALIGN float origin[3][size];  // the point from which distances count
  HWY_ALIGN float direction[3][size];
  HWY_ALIGN float inverse[3][size];
  HWY_ALIGN float t_low[size];  // candidates end above it
  HWY_ALIGN float t_high[size];
  HWY_ALIGN double t_shift[size];  // of `origin` along the ray
  std::uint32_t inside;            // bit i: ray i enters the tree

  bool is_inside(std::size_t lane) const { return (inside >> lane & 1) != 0; }
};

// Of ray i nothing behind t_limits[i] counts: minus infinity for lanes without a ray. Where all rays enter the tree
// close to each other, as camera rays do, their distances count from the same number, the nearest entry; else each
// counts from its own. Returns true for the former.
HWY_INLINE bool EnterTree(const PkdTree& tree, const TreeMargin& margin, const RayColumns& columns,
                          const double* HWY_RESTRICT t_limits, bool may_share_shift, EnteredRays& out) {
  constexpr std::size_t size = EnteredRays::size;
  constexpr double parallel = 1e-18;  // slower directions count as this: products stay finite in f32, the signs right
  const hn::CappedTag<double, size> d;
  const hn::Rebind<float, decltype(d)> f;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);

  HWY_ALIGN double enter[size];
  HWY_ALIGN double leave[size];
  const double wide = tree.radius_max + margin.value;
  const V never = hn::Set(d, std::numeric_limits<double>::infinity());
  V nearest = never;
  V farthest = hn::Neg(never);
  out.inside = 0;
  for (std::size_t i = 0; i < size; i += lanes) {
    V from = hn::Load(d, columns.t_min() + i);
    V to = hn::Load(d, t_limits + i);
    for (std::size_t c = 0; c < 3; ++c) {
      const V o = hn::Load(d, columns.origin(c) + i);
      const V along = hn::Load(d, columns.direction(c) + i);
      const V inverse = hn::Div(hn::Set(d, 1.0), hn::CopySign(hn::Max(hn::Abs(along), hn::Set(d, parallel)), along));
      const V at_lower = hn::Mul(hn::Sub(hn::Set(d, tree.lower[c] - wide), o), inverse);
      const V at_upper = hn::Mul(hn::Sub(hn::Set(d, tree.upper[c] + wide), o), inverse);
      from = hn::Max(from, hn::Min(at_lower, at_upper));
      to = hn::Min(to, hn::Max(at_lower, at_upper));
      hn::Store(hn::DemoteTo(f, inverse), f, out.inverse[c] + i);
    }
    hn::Store(from, d, enter + i);
    hn::Store(to, d, leave + i);
    const auto is_inside = hn::Le(from, to);
    nearest = hn::Min(nearest, hn::IfThenElse(is_inside, from, never));
    farthest = hn::Max(farthest, hn::IfThenElse(is_inside, from, hn::Neg(never)));
    out.inside |= MaskBits(d, is_inside) << i;
  }

  nearest = hn::MinOfLanes(d, nearest);
  farthest = hn::MaxOfLanes(d, farthest);
  const bool share_shift =
      may_share_shift && out.inside != 0 && hn::GetLane(hn::Sub(farthest, nearest)) <= margin.extent;
  for (std::size_t i = 0; i < size; i += lanes) {
    const auto is_inside = hn::Le(hn::Load(d, enter + i), hn::Load(d, leave + i));
    const V from = hn::IfThenElseZero(is_inside, hn::Load(d, enter + i));
    const V shift = share_shift ? nearest : from;
    hn::Store(shift, d, out.t_shift + i);
    for (std::size_t c = 0; c < 3; ++c) {
      const V along = hn::IfThenElseZero(is_inside, hn::Load(d, columns.direction(c) + i));
      const V o = hn::IfThenElseZero(is_inside, hn::Load(d, columns.origin(c) + i));
      hn::Store(hn::DemoteTo(f, hn::MulAdd(shift, along, o)), f, out.origin[c] + i);
      hn::Store(hn::DemoteTo(f, along), f, out.direction[c] + i);
    }
    const V rounding = hn::Set(d, margin.value);
    const V low = hn::Sub(hn::Sub(hn::Load(d, columns.t_min() + i), shift), rounding);
    const V high = hn::Add(hn::Sub(hn::Load(d, leave + i), shift), rounding);
    hn::Store(hn::DemoteTo(f, low), f, out.t_low + i);
    hn::Store(hn::DemoteTo(f, hn::IfThenElse(is_inside, high, hn::Set(d, -1.0))), f, out.t_high + i);
  }
  return share_shift;
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
