// Streams of rays through a P-k-d tree, for rays that go all ways (occlusion, shadows): all rays of a stream that reach
// a subtree visit it together, so that its planes and particles are loaded once. Included once per SIMD target.
//
// A stream holds the rays of one octant, for which near and far are the same sides everywhere. At a split the list of
// rays is divided into those that enter the near and those that enter the far side, without a branch on the data; in a
// leaf SIMD runs over particles and the loop over rays. The streams of the eight octants take turns, a step each: what
// a step reads has been asked for from memory seven steps before. (Streams of rays that are filtered on the way down:
// Tsakok, "Faster incoherent rays: Multi-BVH ray stream tracing", HPG 2009; there in a BVH.)
#if defined(INSITU_KERNELS_PKD_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_STREAM_INL_H_
#undef INSITU_KERNELS_PKD_STREAM_INL_H_
#else
#define INSITU_KERNELS_PKD_STREAM_INL_H_
#endif

#include <memory>

#include "kernels/pkd_enter-inl.h"
#include "kernels/pkd_single-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

constexpr std::size_t longest_stream = 4096;
constexpr std::uint8_t no_octant = 8;

// What a subtree needs of a ray; rays themselves stay where they are.
struct StreamEntry {
  float t_enter;
  float t_leave;
  std::uint32_t ray;
};

template <class Positions>
class AnyHitStream {
 public:
  using Key = typename Positions::Key;

  // `rays` and `occluded` belong to the caller; a tree of `tree.count` particles.
  AnyHitStream(const PkdTree& tree, const Positions& positions, const TreeMargin& margin, const Ray* rays,
               std::uint8_t* occluded, std::size_t most_rays)
      : tree_(tree),
        positions_(positions),
        margin_(margin),
        rays_(rays),
        occluded_(occluded),
        lists_(Levels(tree.count) + 3),
        lanes_(new RayLanes[most_rays]),
        entries_(new StreamEntry[most_rays * lists_]),
        crossing_(new std::uint32_t[most_rays]),
        walks_(new Walk[8]) {
    uniform_ = tree.radius.kind == RadiusView::Kind::uniform;
  }

  // Rays begin .. begin + count of the caller's, of which those not yet occluded are traced.
  void Run(std::size_t begin, std::size_t count) {
    // One pass puts every ray's octant down, one more per octant collects its rays.
    std::uint8_t octants[longest_stream];
    std::size_t sizes[8] = {};
    for (std::size_t i = 0; i < count; i += EnteredRays::size)
      Prepare(begin + i, i, std::min(count - i, EnteredRays::size), octants + i);
    for (std::size_t i = 0; i < count; ++i)
      if (octants[i] != no_octant) ++sizes[octants[i]];
    first_ray_ = begin;
    Walk* active[8];
    std::size_t active_count = 0;
    StreamEntry* entries = entries_.get();
    for (std::uint8_t octant = 0; octant < 8; ++octant) {
      if (sizes[octant] == 0) continue;
      Walk& walk = walks_[octant];
      walk.height = 0;
      walk.is_looked_up = false;
      walk.now = {0, tree_.count, RootBox<Key>(tree_), entries, 0};
      for (int c = 0; c < 3; ++c) walk.negative[c] = (octant >> c & 1) != 0;
      for (std::size_t i = 0; i < count; ++i)
        if (octants[i] == octant)
          entries[walk.now.ray_count++] = {0.0f, lanes_[i].t_high, static_cast<std::uint32_t>(i)};
      entries += sizes[octant] * lists_;
      active[active_count++] = &walk;
    }
    for (std::size_t next = 0; active_count != 0;) {
      if (Step(*active[next])) {
        ++next;
      } else {
        active[next] = active[--active_count];
      }
      if (next >= active_count) next = 0;
    }
  }

 private:
  // A ray in f32, relative to the point where it enters the tree (see TreeMargin): one cache line.
  struct alignas(64) RayLanes {
    float origin[3];
    float direction[3];
    float inverse[3];
    float widening[3];
    float t_low;
    float t_high;  // -infinity once the ray is occluded
  };

  struct Node {
    std::uint64_t begin;
    std::uint64_t end;
    PkdBox<Key> box;
    StreamEntry* rays;
    std::size_t ray_count;
  };

  // Where a stream is on its way through the tree.
  struct Walk {
    Node stack[64];
    int height;
    Node now;
    bool negative[3];
    bool is_looked_up;  // only where centres are read through an index
  };

  static std::size_t Levels(std::uint64_t particles) {
    std::size_t levels = 0;
    for (; particles > pkd_leaf_size; particles /= 2) ++levels;
    return levels;
  }

  // Up to EnteredRays::size rays: their lanes from first_lane on, and their octants.
  HWY_INLINE void Prepare(std::size_t first_ray, std::size_t first_lane, std::size_t count, std::uint8_t* octants) {
    const Ray* const rays = rays_ + first_ray;
    double t_limits[EnteredRays::size];
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_left = occluded_[first_ray + i] == 0;
      t_limits[i] = is_left ? rays[i].t_max : -std::numeric_limits<double>::infinity();
      if (is_left && HWY_UNLIKELY(!margin_.Fits(rays[i]))) {
        AnyHitVisitor visitor(rays[i]);
        TraverseTree(tree_, positions_, rays[i], visitor);
        occluded_[first_ray + i] = visitor.found ? 1 : 0;
        t_limits[i] = -std::numeric_limits<double>::infinity();
      }
    }
    EnteredRays entered;
    EnterTree(tree_, margin_, rays, t_limits, count, false, entered);
    for (std::size_t i = 0; i < count; ++i) {
      RayLanes& lanes = lanes_[first_lane + i];
      int octant = 0;
      for (int c = 0; c < 3; ++c) {
        lanes.origin[c] = entered.origin[c][i];
        lanes.direction[c] = entered.direction[c][i];
        lanes.inverse[c] = entered.inverse[c][i];
        lanes.widening[c] = entered.widening[c][i];
        octant |= lanes.inverse[c] < 0.0f ? 1 << c : 0;
      }
      lanes.t_low = entered.t_low[i];
      lanes.t_high = entered.t_high[i];
      octants[i] = entered.is_inside(i) ? static_cast<std::uint8_t>(octant) : no_octant;
    }
  }

  // A split, or a leaf and the way back from it; before them, a look into the index where there is one. False: this
  // stream has seen the whole tree.
  HWY_INLINE bool Step(Walk& walk) {
    Node& now = walk.now;
    if constexpr (Positions::is_indirect) {
      walk.is_looked_up = !walk.is_looked_up;
      if (walk.is_looked_up) {
        PrefetchBehind(now.begin, now.end);
        return true;
      }
    }
    if (now.ray_count != 0 && now.end - now.begin > pkd_leaf_size && !now.box.is_point()) {
      const int axis = now.box.split_axis();
      const std::uint64_t mid = now.begin + (now.end - now.begin) / 2;
      const Key plane = positions_.key(mid, axis);
      Node far = now;
      std::size_t crossing = 0;
      Split(now, static_cast<float>(plane), axis, far, crossing);
      if (walk.negative[axis]) {
        far.end = mid;
        far.box.upper[axis] = plane;
        now.begin = mid + 1;
        now.box.lower[axis] = plane;
      } else {
        far.begin = mid + 1;
        far.box.lower[axis] = plane;
        now.end = mid;
        now.box.upper[axis] = plane;
      }
      if (crossing != 0) VisitCrossed(mid, crossing);
      if (now.ray_count == 0) {
        now = far;
      } else if (far.ray_count != 0) {
        walk.stack[walk.height++] = far;
      }
    } else {
      if (now.ray_count != 0 && now.end > now.begin) VisitRun(now);
      if (walk.height == 0) return false;
      now = walk.stack[--walk.height];
    }
    Prefetch(now.begin, now.end);
    return true;
  }

  // What a subtree reads first: the particle in the middle, or a whole leaf.
  HWY_INLINE void Prefetch(std::uint64_t begin, std::uint64_t end) const {
    if (end - begin > pkd_leaf_size) {
      positions_.prefetch(begin + (end - begin) / 2);
    } else {
      constexpr std::uint64_t per_line = Positions::is_indirect ? 16 : 5;  // of 4 bytes each, of 12
      for (std::uint64_t place = begin; place < end; place += per_line) positions_.prefetch(place);
    }
  }
  HWY_INLINE void PrefetchBehind(std::uint64_t begin, std::uint64_t end) const {
    if (end - begin > pkd_leaf_size) {
      positions_.prefetch_behind(begin + (end - begin) / 2);
    } else {
      for (std::uint64_t place = begin; place < end; ++place) positions_.prefetch_behind(place);
    }
  }

  // Divides the rays of `now` between its far side, whose list takes the place of that of `now`, and its near side,
  // whose list stands behind it: lists never get longer on the way down, so that those of all levels fit into
  // `entries_`.
  HWY_INLINE void Split(Node& now, float plane, int axis, Node& far, std::size_t& crossing) {
    std::size_t near_count = 0;
    std::size_t far_count = 0;
    std::size_t crossing_count = 0;
    StreamEntry* const near_rays = now.rays + now.ray_count;
    for (std::size_t i = 0; i < now.ray_count; ++i) {
      const StreamEntry entry = now.rays[i];
      const RayLanes& ray = lanes_[entry.ray];
      const float at_plane = (plane - ray.origin[axis]) * ray.inverse[axis];
      const float near_leave = at_plane + ray.widening[axis];
      const float far_enter = std::max(at_plane - ray.widening[axis], entry.t_enter);
      const float leave = std::min(entry.t_leave, ray.t_high);
      const float leave_near = std::min(leave, near_leave);
      const bool goes_near = entry.t_enter <= leave_near;
      const bool goes_far = far_enter <= leave;
      near_rays[near_count] = {entry.t_enter, leave_near, entry.ray};
      far.rays[far_count] = {far_enter, leave, entry.ray};
      crossing_[crossing_count] = entry.ray;
      near_count += goes_near ? 1 : 0;
      far_count += goes_far ? 1 : 0;
      crossing_count += goes_near && goes_far ? 1 : 0;
    }
    now.rays = near_rays;
    now.ray_count = near_count;
    far.ray_count = far_count;
    crossing = crossing_count;
  }

  // The particle on a plane, against the rays that cross the widened plane.
  HWY_INLINE void VisitCrossed(std::uint64_t place, std::size_t count) {
    float centre[3];
    positions_.centre_f32(place, centre);
    const double wide = tree_.radius.value(uniform_ ? 0 : tree_.item(place)) + margin_.value;
    const float radius2 = static_cast<float>(wide * wide * (1.0 + 8.0 * f32_unit));
    for (std::size_t i = 0; i < count; ++i) {
      const RayLanes& ray = lanes_[crossing_[i]];
      const float mx = centre[0] - ray.origin[0];
      const float my = centre[1] - ray.origin[1];
      const float mz = centre[2] - ray.origin[2];
      const float b = mx * ray.direction[0] + my * ray.direction[1] + mz * ray.direction[2];
      const float px = mx - b * ray.direction[0];
      const float py = my - b * ray.direction[1];
      const float pz = mz - b * ray.direction[2];
      if (px * px + py * py + pz * pz <= radius2) Confirm(place, crossing_[i]);
    }
  }

  // True: the ray is occluded.
  HWY_NOINLINE bool Confirm(std::uint64_t place, std::uint32_t ray) {
    RayLanes& lanes = lanes_[ray];
    if (lanes.t_high < 0.0f) return true;
    const Ray& exact = rays_[first_ray_ + ray];
    AnyHitVisitor visitor(exact);
    if (!visitor.visit(tree_, positions_, place, exact)) return false;
    occluded_[first_ray_ + ray] = 1;
    lanes.t_high = -std::numeric_limits<float>::infinity();
    return true;
  }

  HWY_INLINE void VisitRun(const Node& run) {
    std::uint64_t end = run.end;
    // Of equal spheres at one point two stand for all: a ray may start on one of them.
    if (HWY_UNLIKELY(end - run.begin > pkd_leaf_size) && uniform_) end = run.begin + 2;
    for (std::uint64_t begin = run.begin; begin < end; begin += pkd_leaf_size)
      VisitLeafTogether(begin, static_cast<std::size_t>(std::min(end - begin, pkd_leaf_size)), run);
  }

  HWY_INLINE void VisitLeafTogether(std::uint64_t begin, std::size_t count, const Node& run) {
    const hn::CappedTag<float, pkd_leaf_size> d;
    using V = hn::Vec<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    constexpr std::size_t padded = 2 * pkd_leaf_size;
    HWY_ALIGN float radius2[padded];
    const LeafCentres<Positions> centres(positions_, begin, count);
    if (!uniform_) {
      for (std::size_t i = 0; i < count; ++i) {
        const double wide = tree_.radius.value(tree_.item(begin + i)) + margin_.value;
        radius2[i] = static_cast<float>(wide * wide * (1.0 + 8.0 * f32_unit));
      }
    }
    const double wide = tree_.radius.uniform + margin_.value;
    const V uniform_radius2 = hn::Set(d, static_cast<float>(wide * wide * (1.0 + 8.0 * f32_unit)));
    for (std::size_t done = 0; done < count; done += lanes) {
      const std::size_t first = centres.first_of(d, done);
      V x, y, z;
      centres.load(d, first, x, y, z);
      const V r2 = uniform_ ? uniform_radius2 : hn::LoadU(d, radius2 + first);
      const std::size_t valid = std::min(lanes, count - first);
      for (std::size_t i = 0; i < run.ray_count; ++i) {
        const RayLanes& ray = lanes_[run.rays[i].ray];
        const V dx = hn::Set(d, ray.direction[0]);
        const V dy = hn::Set(d, ray.direction[1]);
        const V dz = hn::Set(d, ray.direction[2]);
        const V mx = hn::Sub(x, hn::Set(d, ray.origin[0]));
        const V my = hn::Sub(y, hn::Set(d, ray.origin[1]));
        const V mz = hn::Sub(z, hn::Set(d, ray.origin[2]));
        const auto [b, distance2] = ApproachOf(mx, my, mz, dx, dy, dz);
        const auto close = hn::Le(distance2, r2);
        if (HWY_LIKELY(hn::AllFalse(d, close))) continue;
        const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
        const auto in_time =
            hn::And(hn::Le(hn::Sub(b, s), hn::Set(d, ray.t_high)), hn::Ge(hn::Add(b, s), hn::Set(d, ray.t_low)));
        std::uint32_t bits = MaskBits(d, hn::And(close, in_time)) & ~std::uint32_t{0} >> (32 - valid);
        for (; bits != 0; bits &= bits - 1)
          if (Confirm(begin + first + hwy::Num0BitsBelowLS1Bit_Nonzero32(bits), run.rays[i].ray)) break;
      }
    }
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const TreeMargin margin_;
  const Ray* rays_;
  std::uint8_t* occluded_;
  const std::size_t lists_;  // as many as there are levels, each of at most all rays
  std::unique_ptr<RayLanes[]> lanes_;
  std::unique_ptr<StreamEntry[]> entries_;
  std::unique_ptr<std::uint32_t[]> crossing_;
  std::unique_ptr<Walk[]> walks_;
  std::size_t first_ray_ = 0;
  bool uniform_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
