// Streams of rays that go all ways (occlusion, shadows): SIMD runs over the eight children of a node
// and over the particles of a leaf, the loop over rays; neither has a branch that depends on a single box test.
// Included once per SIMD target.
#if defined(INSITU_KERNELS_RAY_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_RAY_STREAM_INL_H_
#undef INSITU_KERNELS_RAY_STREAM_INL_H_
#else
#define INSITU_KERNELS_RAY_STREAM_INL_H_
#endif

#include <memory>

#include "kernels/particle_tests-inl.h"
#include "kernels/pkd_enter-inl.h"
#include "kernels/pkd_single-inl.h"
#include "kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

constexpr std::size_t longest_stream = 4096;

// The items of a walk: single rays.
template <class Positions>
class StreamRays {
 public:
  static constexpr std::uint8_t no_octant = 8;
  static constexpr bool is_indirect = Positions::is_indirect;

  StreamRays(const PkdTree& tree, const Positions& positions, const TreeMargin& margin, bool copied,
             std::size_t most_rays)
      : tree_(tree),
        positions_(positions),
        margin_(margin),
        copied_(copied),
        tests_(tree, margin),
        rays_(new WalkRay[most_rays]) {}

  // rays[0 .. count) that are not occluded yet; octants[i] is no_octant when there is nothing left to trace.
  void Enter(const Ray* rays, std::uint8_t* occluded, std::size_t count, std::uint8_t* octants) {
    source_ = rays;
    occluded_ = occluded;
    for (std::size_t i = 0; i < count; i += EnteredRays::size)
      EnterSome(i, std::min(count - i, EnteredRays::size), octants + i);
  }

  HWY_INLINE std::uint32_t Meet(const NodePlanes& planes, std::uint32_t ray, bool) const {
    return planes.Meet(rays_[ray]);
  }

  std::size_t done() const { return done_; }
  HWY_INLINE std::size_t KeepOpen(std::uint32_t* HWY_RESTRICT list, std::size_t count) const {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t number = list[i];
      list[kept] = number;
      kept += occluded_[number] == 0 ? 1 : 0;
    }
    return kept;
  }

  HWY_INLINE void Prefetch(std::uint64_t begin, std::uint64_t end) const {
    if (HWY_UNLIKELY(!tree_.selected.all())) return PrefetchDrawn(tree_, positions_, begin, end, copied_);
    positions_.prefetch_run(begin, end);
  }
  HWY_INLINE void PrefetchBehind(std::uint64_t begin, std::uint64_t end) const {
    if (HWY_UNLIKELY(!tree_.selected.all())) return PrefetchDrawnBehind(tree_, positions_, begin, end, copied_);
    PrefetchRunBehind(positions_, begin, end);
  }

  HWY_INLINE void Visit(std::uint64_t begin, std::uint64_t end, std::uint32_t* list, std::size_t count) {
    if (HWY_UNLIKELY(!tree_.selected.all())) return VisitFiltered(begin, end, list, count);
    Visit(ParticleRun<Positions>(tree_, positions_, begin, end), list, count);
  }
  HWY_INLINE void VisitPick(const ParticlePick& pick, std::uint32_t* list, std::size_t count) {
    Visit(pick, list, count);
  }

 private:
  // Not inlined: without a filter it is never called.
  HWY_NOINLINE void VisitFiltered(std::uint64_t begin, std::uint64_t end, std::uint32_t* list, std::size_t count) {
    VisitDrawn(tree_, positions_, begin, end, copied_,
               [&](const auto& particles) HWY_ATTR { Visit(particles, list, count); });
  }

  template <class Particles>
  HWY_INLINE void Visit(const Particles& particles, std::uint32_t* list, std::size_t count) {
    tests_.VisitTogether(
        particles, rays_.get(), list, count,
        [&](std::uint32_t ray, std::uint64_t place, bool is_certain)
            HWY_ATTR { return is_certain ? Occlude(ray, place) : Confirm(ray, place); },
        [&](std::uint32_t* left, std::size_t size) HWY_ATTR { return KeepOpen(left, size); });
  }

  void EnterSome(std::size_t first, std::size_t count, std::uint8_t* octants) {
    constexpr double never = -std::numeric_limits<double>::infinity();
    if (std::find(occluded_ + first, occluded_ + first + count, 0) == occluded_ + first + count) {
      std::fill_n(octants, count, no_octant);
      return;
    }
    RayColumns columns;
    columns.Load(source_ + first, count);
    HWY_ALIGN double t_limits[EnteredRays::size];
    for (std::size_t i = 0; i < EnteredRays::size; ++i)
      t_limits[i] = i < count && occluded_[first + i] == 0 ? columns.t_max()[i] : never;
    if (HWY_UNLIKELY(!columns.StartWithin(margin_.farthest))) {
      for (std::size_t i = 0; i < count; ++i) {
        const Ray& ray = source_[first + i];
        if (occluded_[first + i] != 0 || margin_.Fits(ray)) continue;
        AnyHitVisitor visitor(ray);
        TraverseTree(tree_, positions_, ray, visitor);
        occluded_[first + i] = visitor.found ? 1 : 0;
        t_limits[i] = never;
      }
    }
    EnteredRays entered;
    EnterTree(tree_, margin_, columns, t_limits, false, entered);
    for (std::size_t i = 0; i < count; ++i) {
      WalkRay& ray = rays_[first + i];
      int octant = 0;
      double o[3], d[3];
      for (int c = 0; c < 3; ++c) {
        o[c] = static_cast<double>(entered.origin[c][i]);
        d[c] = static_cast<double>(entered.direction[c][i]);
        ray.direction[c] = entered.direction[c][i];
        ray.inverse[c] = entered.inverse[c][i];
        ray.start[c] = -entered.origin[c][i] * ray.inverse[c];
        octant |= ray.inverse[c] < 0.0f ? 1 << c : 0;
      }
      for (int c = 0; c < 3; ++c) {
        const int next = (c + 1) % 3, last = (c + 2) % 3;
        ray.moment[c] = static_cast<float>(o[next] * d[last] - o[last] * d[next]);
      }
      ray.foot = static_cast<float>(o[0] * d[0] + o[1] * d[1] + o[2] * d[2]);
      ray.t_low = entered.t_low[i];
      ray.t_high = entered.t_high[i];
      octants[i] = entered.is_inside(i) ? static_cast<std::uint8_t>(octant) : no_octant;
    }
  }

  // A hit that needs no confirmation. True: the ray is occluded.
  HWY_INLINE bool Occlude(std::uint32_t number, std::uint64_t place) {
    if (tree_.item(place) == source_[number].exclude) return false;
    return Finish(number);
  }

  // True: the ray is occluded.
  HWY_NOINLINE bool Confirm(std::uint32_t number, std::uint64_t place) {
    WalkRay& ray = rays_[number];
    if (ray.t_high == -std::numeric_limits<float>::infinity()) return true;
    AnyHitVisitor visitor(source_[number]);
    if (!visitor.visit(tree_, positions_, place, source_[number])) return false;
    return Finish(number);
  }

  HWY_INLINE bool Finish(std::uint32_t number) {
    occluded_[number] = 1;
    rays_[number].t_high = -std::numeric_limits<float>::infinity();
    ++done_;
    return true;
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const TreeMargin& margin_;
  const bool copied_;  // the leaves of the walk are runs of copies
  const ParticleTests tests_;
  const Ray* source_ = nullptr;
  std::uint8_t* occluded_ = nullptr;
  std::size_t done_ = 0;
  std::unique_ptr<WalkRay[]> rays_;
};

template <class Nodes, class Positions>
class AnyHitStream {
 public:
  AnyHitStream(const PkdTree& tree, const Positions& positions, const Nodes& nodes, const TreeMargin& margin,
               std::size_t most_rays)
      : rays_(tree, positions, margin, nodes.are_copied(), most_rays), walks_(nodes, rays_, most_rays) {}

  // Traces rays[0 .. count), at most longest_stream: a walk per octant.
  void Run(const Ray* rays, std::uint8_t* occluded, std::size_t count) {
    constexpr std::size_t octants_and_none = StreamRays<Positions>::no_octant + 1;
    std::uint8_t octants[longest_stream];
    std::size_t sizes[octants_and_none] = {};
    rays_.Enter(rays, occluded, count, octants);
    for (std::size_t i = 0; i < count; ++i) ++sizes[octants[i]];
    std::uint32_t nowhere[longest_stream];
    std::uint32_t* lists[octants_and_none];
    lists[StreamRays<Positions>::no_octant] = nowhere;
    for (std::uint32_t octant = 0; octant < StreamRays<Positions>::no_octant; ++octant)
      lists[octant] = sizes[octant] != 0 ? walks_.Add(octant, sizes[octant]) : nullptr;
    for (std::size_t i = 0; i < count; ++i) *lists[octants[i]]++ = static_cast<std::uint32_t>(i);
    walks_.Run();
  }

 private:
  StreamRays<Positions> rays_;
  Walks<Nodes, StreamRays<Positions>> walks_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
