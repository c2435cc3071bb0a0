// Streams of rays that go all ways (occlusion, shadows) through treelets: SIMD runs over the eight children of a node
// and over the particles of a treelet, the loop over rays; neither has a branch that depends on a single box test.
// Included once per SIMD target.
#if defined(INSITU_KERNELS_TREELET_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_TREELET_STREAM_INL_H_
#undef INSITU_KERNELS_TREELET_STREAM_INL_H_
#else
#define INSITU_KERNELS_TREELET_STREAM_INL_H_
#endif

#include <memory>

#include "kernels/pkd_enter-inl.h"
#include "kernels/pkd_single-inl.h"
#include "kernels/treelet_leaf-inl.h"
#include "kernels/treelet_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

constexpr std::size_t longest_treelet_stream = 4096;

// The items of a walk: single rays.
template <class Positions>
class TreeletRays {
 public:
  static constexpr std::uint8_t no_octant = 8;

  TreeletRays(const PkdTree& tree, const Positions& positions, const TreeMargin& margin, std::size_t most_rays)
      : tree_(tree),
        positions_(positions),
        margin_(margin),
        leaf_(tree, margin.value),
        rays_(new TreeletRay[most_rays]) {}

  // rays[0 .. count) that are not occluded yet; octants[i] is no_octant when there is nothing left to trace.
  void Enter(const Ray* rays, std::uint8_t* occluded, std::size_t count, std::uint8_t* octants) {
    source_ = rays;
    occluded_ = occluded;
    for (std::size_t i = 0; i < count; i += EnteredRays::size)
      EnterSome(i, std::min(count - i, EnteredRays::size), octants + i);
  }

  HWY_INLINE std::uint32_t Meet(const NearFarPlanes& planes, std::uint32_t ray, bool) const {
    return planes.Meet(rays_[ray]);
  }

  HWY_INLINE void Prefetch(std::uint64_t begin, std::uint64_t end) const { leaf_.Prefetch(positions_, begin, end); }

  HWY_INLINE void Visit(std::uint64_t begin, std::uint64_t end, const std::uint32_t* list, std::size_t count) {
    leaf_.VisitTogether(positions_, begin, end, rays_.get(), list, count,
                        [&](std::uint32_t ray, std::uint64_t place) HWY_ATTR { return Confirm(ray, place); });
  }

 private:
  void EnterSome(std::size_t first, std::size_t count, std::uint8_t* octants) {
    double t_limits[EnteredRays::size];
    for (std::size_t i = 0; i < count; ++i) {
      const Ray& ray = source_[first + i];
      const bool is_left = occluded_[first + i] == 0;
      t_limits[i] = is_left ? ray.t_max : -std::numeric_limits<double>::infinity();
      if (is_left && HWY_UNLIKELY(!margin_.Fits(ray))) {
        AnyHitVisitor visitor(ray);
        TraverseTree(tree_, positions_, ray, visitor);
        occluded_[first + i] = visitor.found ? 1 : 0;
        t_limits[i] = -std::numeric_limits<double>::infinity();
      }
    }
    EnteredRays entered;
    EnterTree(tree_, margin_, source_ + first, t_limits, count, false, entered);
    for (std::size_t i = 0; i < count; ++i) {
      TreeletRay& ray = rays_[first + i];
      int octant = 0;
      for (int c = 0; c < 3; ++c) {
        ray.origin[c] = entered.origin[c][i];
        ray.direction[c] = entered.direction[c][i];
        ray.inverse[c] = entered.inverse[c][i];
        ray.start[c] = -ray.origin[c] * ray.inverse[c];
        octant |= ray.inverse[c] < 0.0f ? 1 << c : 0;
      }
      ray.t_low = entered.t_low[i];
      ray.t_high = entered.t_high[i];
      octants[i] = entered.is_inside(i) ? static_cast<std::uint8_t>(octant) : no_octant;
    }
  }

  // True: the ray is occluded.
  HWY_NOINLINE bool Confirm(std::uint32_t number, std::uint64_t place) {
    TreeletRay& ray = rays_[number];
    if (ray.t_high == -std::numeric_limits<float>::infinity()) return true;
    AnyHitVisitor visitor(source_[number]);
    if (!visitor.visit(tree_, positions_, place, source_[number])) return false;
    occluded_[number] = 1;
    ray.t_high = -std::numeric_limits<float>::infinity();
    return true;
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const TreeMargin& margin_;
  const TreeletLeaf<Positions> leaf_;
  const Ray* source_ = nullptr;
  std::uint8_t* occluded_ = nullptr;
  std::unique_ptr<TreeletRay[]> rays_;
};

template <class Positions>
class TreeletStream {
 public:
  TreeletStream(const PkdTree& tree, const Positions& positions, const Treelets& treelets, const TreeMargin& margin,
                std::size_t most_rays)
      : rays_(tree, positions, margin, most_rays), walks_(treelets, tree.count, rays_, most_rays) {}

  // Traces rays[0 .. count), at most longest_treelet_stream: a walk per octant.
  void Run(const Ray* rays, std::uint8_t* occluded, std::size_t count) {
    std::uint8_t octants[longest_treelet_stream];
    std::size_t sizes[9] = {};
    rays_.Enter(rays, occluded, count, octants);
    for (std::size_t i = 0; i < count; ++i) ++sizes[octants[i]];
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      if (sizes[octant] == 0) continue;
      std::uint32_t* list = walks_.Add(octant, sizes[octant]);
      for (std::size_t i = 0; i < count; ++i)
        if (octants[i] == octant) *list++ = static_cast<std::uint32_t>(i);
    }
    walks_.Run();
  }

 private:
  using Rays = TreeletRays<Positions>;
  Rays rays_;
  TreeletWalks<Rays> walks_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
