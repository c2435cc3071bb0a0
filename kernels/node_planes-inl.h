// The boxes of the eight children of a node against rays: SIMD over the children. Included once per SIMD target.
#if defined(INSITU_KERNELS_NODE_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_NODE_PLANES_INL_H_
#undef INSITU_KERNELS_NODE_PLANES_INL_H_
#else
#define INSITU_KERNELS_NODE_PLANES_INL_H_
#endif

#include <hwy/highway.h>

#include "kernels/child_order.h"
#include "kernels/pkd_leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// A ray in f32, relative to the point where it enters the tree (see TreeMargin): one cache line.
struct alignas(64) WalkRay {
  float start[3];  // - origin / direction
  float inverse[3];
  float direction[3];
  float moment[3];  // origin x direction
  float foot;       // origin . direction
  float t_low;
  float t_high;  // nothing behind it counts; -infinity once the ray needs no more
};

// The planes of the boxes, as rays of one octant meet them.
struct NodePlanes {
  HWY_ALIGN float near[3][node_fanout];
  HWY_ALIGN float far[3][node_fanout];

  // The children whose boxes the ray meets.
  HWY_INLINE std::uint32_t Meet(const WalkRay& ray) const {
    const hn::CappedTag<float, node_fanout> d;
    using V = hn::Vec<decltype(d)>;
    const V ix = hn::Set(d, ray.inverse[0]);
    const V iy = hn::Set(d, ray.inverse[1]);
    const V iz = hn::Set(d, ray.inverse[2]);
    const V sx = hn::Set(d, ray.start[0]);
    const V sy = hn::Set(d, ray.start[1]);
    const V sz = hn::Set(d, ray.start[2]);
    std::uint32_t met = 0;
    for (std::size_t k = 0; k < node_fanout; k += hn::Lanes(d)) {
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
