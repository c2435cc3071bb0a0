// Sixteen rays with what the paper's packets need of them. Included once per SIMD target.
#if defined(INSITU_BENCH_PAPER_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_BENCH_PAPER_PACKET_INL_H_
#undef INSITU_BENCH_PAPER_PACKET_INL_H_
#else
#define INSITU_BENCH_PAPER_PACKET_INL_H_
#endif

#include "kernels/pkd_enter-inl.h"
#include "kernels/pkd_single-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

constexpr std::size_t packet_size = EnteredRays::size;

// By how much a split plane is widened on either side, times the slowness of a ray: by the largest radius and the
// rounding.
HWY_INLINE float WideningOf(const PkdTree& tree, const TreeMargin& margin) {
  return static_cast<float>((tree.radius_max + margin.value) * (1.0 + 8.0 * f32_unit));
}

class PaperPacket {
 public:
  static constexpr std::size_t size = packet_size;

  // Of ray i nothing behind t_limits[i] counts: minus infinity for lanes without a ray.
  void Load(const PkdTree& tree, const TreeMargin& margin, const RayColumns& rays, const double* t_limits) {
    margin_ = margin.value;
    EnterTree(tree, margin, rays, t_limits, true, lanes_);
    const D d;
    const auto wide = hn::Set(d, WideningOf(tree, margin));
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < size; i += hn::Lanes(d))
        hn::Store(hn::Mul(wide, hn::Abs(hn::Load(d, lanes_.inverse[c] + i))), d, widening_[c] + i);
      std::uint32_t negative = 0;
      for (std::size_t i = 0; i < size; i += hn::Lanes(d))
        negative |= MaskBits(d, hn::Lt(hn::Load(d, lanes_.inverse[c] + i), hn::Zero(d))) << i;
      negative &= lanes_.inside;
      negative_[c] = 2 * hwy::PopCount(negative) > hwy::PopCount(lanes_.inside);
      uniform_sign_[c] = negative == 0 || negative == lanes_.inside;
    }
  }

  // Most rays go down this axis.
  bool negative(int axis) const { return negative_[axis]; }
  // All of them go the same way.
  bool uniform_sign(int axis) const { return uniform_sign_[axis]; }

  double margin() const { return margin_; }
  const float* origin(int axis) const { return lanes_.origin[axis]; }
  const float* direction(int axis) const { return lanes_.direction[axis]; }
  const float* inverse(int axis) const { return lanes_.inverse[axis]; }
  const float* widening(int axis) const { return widening_[axis]; }
  const float* t_low() const { return lanes_.t_low; }
  const float* t_high() const { return lanes_.t_high; }  // nothing behind it counts: shrinks with every hit

  void LimitLane(std::size_t lane, double t) {
    lanes_.t_high[lane] = std::min(lanes_.t_high[lane], static_cast<float>(t - lanes_.t_shift[lane] + margin_));
  }
  void EndLane(std::size_t lane) { lanes_.t_high[lane] = -1e30f; }

 private:
  using D = hn::CappedTag<float, size>;

  EnteredRays lanes_;
  HWY_ALIGN float widening_[3][size];
  double margin_;
  bool negative_[3];
  bool uniform_sign_[3];
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
