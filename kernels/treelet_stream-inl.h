// Streams of rays through treelets: all rays of a stream that meet a node visit it together, so that its boxes are
// decoded once and what is done for a node, and not for a ray, is shared. Included once per SIMD target.
//
// A stream holds the rays of one octant, for which near and far planes are the same everywhere. SIMD runs over the
// eight children of a node and over the particles of a treelet, the loop over the rays; neither has a branch that
// depends on a single ray's box tests. The list of a child is drawn up when it is its turn. The streams of the eight
// octants take turns, a step each: what a step reads has been asked for from memory some steps before. (Tsakok, "Faster
// incoherent rays: Multi-BVH ray stream tracing", HPG 2009; Fuetterling et al., "Accelerated single ray tracing for wide
// vector units", HPG 2017, for lists per child.)
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
#include "kernels/treelet_node-inl.h"
#include "kernels/treelet_order.h"
#include "kernels/treelets.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Those of `rays` whose mask has bit `child` set, in their order; returns how many. Writes up to 16 entries more.
HWY_INLINE std::size_t ListChild(const std::uint32_t* HWY_RESTRICT rays, const std::uint8_t* HWY_RESTRICT masks,
                                 std::size_t count, unsigned child, std::uint32_t* HWY_RESTRICT list) {
  const hn::CappedTag<std::uint32_t, 16> d;
  const hn::Rebind<std::uint8_t, decltype(d)> b;
  const auto bit = hn::Set(d, 1u << child);
  std::size_t listed = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    auto has = hn::TestBit(hn::PromoteTo(d, hn::LoadU(b, masks + i)), bit);
    if (count - i < hn::Lanes(d)) has = hn::And(has, hn::FirstN(d, count - i));
    hn::StoreU(hn::Compress(hn::LoadU(d, rays + i), has), d, list + listed);
    listed += hn::CountTrue(d, has);
  }
  return listed;
}

constexpr std::size_t longest_treelet_stream = 4096;

template <class Positions, class Visitor>
class TreeletStreams {
 public:
  static constexpr bool is_first = std::is_same_v<Visitor, FirstHitVisitor>;

  TreeletStreams(const PkdTree& tree, const Positions& positions, const Treelets& treelets, const TreeMargin& margin,
                 std::size_t most_rays)
      : tree_(tree),
        positions_(positions),
        treelets_(treelets),
        margin_(margin),
        leaf_(tree, margin.value),
        rays_(new TreeletRay[most_rays]),
        t_shift_(new double[most_rays]),
        walks_(new Walk[8]) {
    // Per octant and level a list and its masks; a vector may be written behind each.
    slots_ = (most_rays + 8 * padding) * (treelets.levels + 1);
    lists_.reset(new std::uint32_t[slots_]);
    masks_.reset(new std::uint8_t[slots_]);
  }

  // Traces rays[0 .. count) for their visitors.
  void Run(const Ray* rays, Visitor* visitors, std::size_t count) {
    source_ = rays;
    visitors_ = visitors;
    std::uint8_t octants[longest_treelet_stream];
    std::size_t sizes[8] = {};
    for (std::size_t i = 0; i < count; i += EnteredRays::size)
      Prepare(i, std::min(count - i, EnteredRays::size), octants + i);
    for (std::size_t i = 0; i < count; ++i)
      if (octants[i] != no_octant) ++sizes[octants[i]];
    Walk* active[8];
    std::size_t active_count = 0;
    std::size_t used = 0;
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      if (sizes[octant] == 0) continue;
      Walk& walk = walks_[octant];
      walk.octant = octant;
      walk.room = sizes[octant] + padding;
      walk.lists = lists_.get() + used;
      walk.masks = masks_.get() + used;
      used += walk.room * (treelets_.levels + 1);
      walk.level = 0;
      walk.next = {treelets_.root(), 0, 0};
      for (std::size_t i = 0; i < count; ++i)
        if (octants[i] == octant) walk.lists[walk.next.count++] = static_cast<std::uint32_t>(i);
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
  static constexpr std::size_t padding = 16;
  static constexpr std::uint8_t no_octant = 8;

  struct Place {
    TreeletRun run;
    std::uint64_t node;  // within its level
    std::size_t count;   // rays, of lists[level]
  };
  struct Level {
    Place place;
    std::uint32_t left;  // children still to be visited
    std::uint32_t flip;
  };
  struct Walk {
    std::uint32_t octant;
    unsigned level;  // of `next`; treelets stand at level treelets_.levels
    Place next;
    std::size_t room;  // of a list
    std::uint32_t* lists;
    std::uint8_t* masks;
    Level levels[Treelets::most_levels];

    std::uint32_t* list(unsigned at) { return lists + at * room; }
    std::uint8_t* mask(unsigned at) { return masks + at * room; }
  };

  void Prepare(std::size_t first, std::size_t count, std::uint8_t* octants) {
    double t_limits[EnteredRays::size];
    for (std::size_t i = 0; i < count; ++i) {
      Visitor& visitor = visitors_[first + i];
      t_limits[i] = visitor.t_limit();
      if (HWY_UNLIKELY(!margin_.Fits(source_[first + i]))) {
        TraverseTree(tree_, positions_, source_[first + i], visitor);
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
      t_shift_[first + i] = entered.t_shift[i];
      octants[i] = entered.is_inside(i) ? static_cast<std::uint8_t>(octant) : no_octant;
    }
  }

  // Visits what has been chosen the turn before, and chooses what is next. False: this stream is done.
  HWY_INLINE bool Step(Walk& walk) {
    if (walk.level == treelets_.levels) {
      VisitTreelet(walk);
      --walk.level;
    } else {
      VisitNode(walk);
    }
    return Choose(walk);
  }

  HWY_INLINE void VisitNode(Walk& walk) {
    const TreeletNode& node = treelets_.nodes[treelets_.level_begin[walk.level] + walk.next.node];
    Level& level = walk.levels[walk.level];
    level.place = walk.next;
    level.flip = treelet_flip(node, walk.octant, treelets_.bits_at(walk.level));
    NearFarPlanes planes;
    planes.Decode(node, walk.octant);
    const std::uint32_t* const list = walk.list(walk.level);
    std::uint8_t* const masks = walk.mask(walk.level);
    std::uint32_t left = 0;
    for (std::size_t i = 0; i < walk.next.count; ++i) {
      const std::uint32_t met = planes.Meet(rays_[list[i]]);
      masks[i] = static_cast<std::uint8_t>(met);
      left |= met;
    }
    level.left = left;
  }

  HWY_INLINE bool Choose(Walk& walk) {
    unsigned at = walk.level;
    while (walk.levels[at].left == 0) {
      if (at == 0) return false;
      --at;
    }
    Level& level = walk.levels[at];
    const unsigned k = nearest_child(level.left, level.flip);
    level.left &= ~(1u << k);
    const unsigned bits = treelets_.bits_at(at);
    walk.level = at + 1;
    walk.next.run = child_run(level.place.run, bits, k);
    walk.next.node = (level.place.node << bits) + k;
    if (walk.level == treelets_.levels) {
      const std::uint64_t end = walk.next.run.begin + walk.next.run.span;
      for (std::uint64_t place = walk.next.run.begin; place < end; place += 5) positions_.prefetch(place);
      positions_.prefetch(end - 1);
    } else {
      __builtin_prefetch(treelets_.nodes + treelets_.level_begin[walk.level] + walk.next.node);
    }
    walk.next.count = ListChild(walk.list(at), walk.mask(at), level.place.count, k, walk.list(walk.level));
    return true;
  }

  HWY_INLINE void VisitTreelet(Walk& walk) {
    const std::uint64_t end = std::min(walk.next.run.begin + walk.next.run.span, tree_.count);
    leaf_.VisitTogether(positions_, walk.next.run.begin, end, rays_.get(), walk.list(walk.level), walk.next.count,
                        [&](std::uint32_t ray, std::uint64_t place) HWY_ATTR { return Confirm(ray, place); });
  }

  // True: the ray needs no more.
  HWY_NOINLINE bool Confirm(std::uint32_t number, std::uint64_t place) {
    TreeletRay& ray = rays_[number];
    Visitor& visitor = visitors_[number];
    if (ray.t_high == -std::numeric_limits<float>::infinity()) return true;
    if (visitor.visit(tree_, positions_, place, source_[number])) {
      ray.t_high = -std::numeric_limits<float>::infinity();
      return true;
    }
    if constexpr (is_first)
      ray.t_high = std::min(ray.t_high, static_cast<float>(visitor.t_limit() - t_shift_[number] + margin_.value));
    return false;
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const Treelets& treelets_;
  const TreeMargin margin_;
  const TreeletLeaf<Positions> leaf_;
  const Ray* source_ = nullptr;
  Visitor* visitors_ = nullptr;
  std::size_t slots_;
  std::unique_ptr<TreeletRay[]> rays_;
  std::unique_ptr<double[]> t_shift_;
  std::unique_ptr<std::uint32_t[]> lists_;
  std::unique_ptr<std::uint8_t[]> masks_;
  std::unique_ptr<Walk[]> walks_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
