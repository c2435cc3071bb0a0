// The boxes of a treelet node against rays: SIMD over its children. Included once per SIMD target.
#if defined(INSITU_KERNELS_TREELET_NODE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_TREELET_NODE_INL_H_
#undef INSITU_KERNELS_TREELET_NODE_INL_H_
#else
#define INSITU_KERNELS_TREELET_NODE_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>

#include "kernels/pkd_leaf-inl.h"
#include "kernels/treelets.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// A ray in f32, relative to the point where it enters the tree (see TreeMargin): one cache line.
struct alignas(64) TreeletRay {
  float start[3];  // - origin / direction
  float inverse[3];
  float origin[3];
  float direction[3];
  float t_low;
  float t_high;  // nothing behind it counts; -infinity once the ray needs no more
};

// The planes of the boxes of a node, as rays of one octant meet them.
struct NearFarPlanes {
  HWY_ALIGN float near[3][treelet_fanout];
  HWY_ALIGN float far[3][treelet_fanout];

  HWY_NOINLINE void Decode(const TreeletNode& node, std::uint32_t octant) {
    const hn::CappedTag<float, treelet_fanout> d;
    const hn::Rebind<std::int32_t, decltype(d)> i;
    const hn::Rebind<std::uint8_t, decltype(d)> b;
    for (std::size_t c = 0; c < 3; ++c) {
      const bool is_down = (octant >> c & 1) != 0;
      const std::uint8_t* const q_near = is_down ? node.upper[c] : node.lower[c];
      const std::uint8_t* const q_far = is_down ? node.lower[c] : node.upper[c];
      const auto step = hn::Set(d, std::bit_cast<float>(std::uint32_t{node.exponent[c]} << 23));
      const auto from = hn::Set(d, node.origin[c]);
      for (std::size_t k = 0; k < treelet_fanout; k += hn::Lanes(d)) {
        hn::Store(hn::MulAdd(hn::ConvertTo(d, hn::PromoteTo(i, hn::LoadU(b, q_near + k))), step, from), d, near[c] + k);
        hn::Store(hn::MulAdd(hn::ConvertTo(d, hn::PromoteTo(i, hn::LoadU(b, q_far + k))), step, from), d, far[c] + k);
      }
    }
  }

  // The children whose boxes the ray meets.
  HWY_INLINE std::uint32_t Meet(const TreeletRay& ray) const {
    const hn::CappedTag<float, treelet_fanout> d;
    using V = hn::Vec<decltype(d)>;
    const V ix = hn::Set(d, ray.inverse[0]);
    const V iy = hn::Set(d, ray.inverse[1]);
    const V iz = hn::Set(d, ray.inverse[2]);
    const V sx = hn::Set(d, ray.start[0]);
    const V sy = hn::Set(d, ray.start[1]);
    const V sz = hn::Set(d, ray.start[2]);
    std::uint32_t met = 0;
    for (std::size_t k = 0; k < treelet_fanout; k += hn::Lanes(d)) {
      const V enter =
          hn::Max(hn::Max(hn::MulAdd(hn::Load(d, near[0] + k), ix, sx), hn::Set(d, ray.t_low)),
                  hn::Max(hn::MulAdd(hn::Load(d, near[1] + k), iy, sy), hn::MulAdd(hn::Load(d, near[2] + k), iz, sz)));
      const V leave =
          hn::Min(hn::Min(hn::MulAdd(hn::Load(d, far[0] + k), ix, sx), hn::Set(d, ray.t_high)),
                  hn::Min(hn::MulAdd(hn::Load(d, far[1] + k), iy, sy), hn::MulAdd(hn::Load(d, far[2] + k), iz, sz)));
      met |= MaskBits(d, hn::Le(enter, leave)) << k;
    }
    return met;
  }
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
