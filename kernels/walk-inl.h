// Walks of many items through a tree of nodes with eight children: all items of a walk that meet a node visit it
// together, so that its boxes are made once, and what is done for a node is shared. Items are rays, or packets of rays;
// nodes those of treelets, or splits of a P-k-d tree. Included once per SIMD target.
//
// A walk holds items of one octant, for which near and far planes are the same everywhere. The list of a child is drawn
// up when it is its turn, from a mask of met children per item. Several walks take turns, a step each: what a step
// reads has been asked for from memory some steps before. (Streams of rays that are filtered on the way down: Tsakok,
// "Faster incoherent rays: Multi-BVH ray stream tracing", HPG 2009; lists per child: Fuetterling et al., "Accelerated
// single ray tracing for wide vector units", HPG 2017.)
#if defined(INSITU_KERNELS_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_WALK_INL_H_
#undef INSITU_KERNELS_WALK_INL_H_
#else
#define INSITU_KERNELS_WALK_INL_H_
#endif

#include <memory>

#include "kernels/child_order.h"
#include "kernels/node_planes-inl.h"
#include "kernels/particle_runs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Those of `items` whose mask has bit `child` set, in their order; returns how many. Whole vectors are read and
// written: there has to be room for 16 more behind each array.
HWY_INLINE std::size_t ListChild(const std::uint32_t* HWY_RESTRICT items, const std::uint8_t* HWY_RESTRICT masks,
                                 std::size_t count, unsigned child, std::uint32_t* HWY_RESTRICT list) {
  const hn::CappedTag<std::uint32_t, 16> d;
  const hn::Rebind<std::uint8_t, decltype(d)> b;
  const auto bit = hn::Set(d, 1u << child);
  std::size_t listed = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    auto has = hn::TestBit(hn::PromoteTo(d, hn::LoadU(b, masks + i)), bit);
    if (count - i < hn::Lanes(d)) has = hn::And(has, hn::FirstN(d, count - i));
    hn::StoreU(hn::Compress(hn::LoadU(d, items + i), has), d, list + listed);
    listed += hn::CountTrue(d, has);
  }
  return listed;
}

// Nodes:
//   Place Root(), levels()                            leaves stand at level levels()
//   Open(place, level, octant, node, planes, inner)   the boxes of the children, and the particles of no child
//   Child(node, k), Filled(node), Flip(node)
//   Begin(place), End(place)                          of a leaf: places, or numbers of copies when are_copied()
//   Prefetch(place, level), PrefetchBehind(...)       what Open will read; the second where that takes two reads
// Items:
//   uint32 Meet(planes, item, is_last)                children met, a bit each; is_last: they are leaves
//   Visit(begin, end, list, count)                    the items of the list, in a leaf; the list is theirs from then on
//   VisitPick(inner, list, count)                     the same with a few particles
//   Prefetch(begin, end), PrefetchBehind(begin, end)
//   done()                                            how many items need no more, so far; only grows
//   KeepOpen(list, count)                             leaves them out of a list, and returns how many are left
template <class Nodes, class Items>
class Walks {
 public:
  static constexpr std::size_t most_walks = 8;

  // Room for all walks together: `most_items`.
  Walks(const Nodes& nodes, Items& items, std::size_t most_items)
      : nodes_(nodes), items_(items), levels_(nodes.levels()), walks_(new Walk[most_walks]) {
    const std::size_t slots = (most_items + most_walks * padding) * (levels_ + 1);
    lists_.reset(new std::uint32_t[slots]);
    masks_.reset(new std::uint8_t[slots]);
    if constexpr (Nodes::has_inner_particles) at_inner_.reset(new std::uint32_t[most_items + padding]);
  }

  // One more walk, of `octant`; its list is to be filled in with `count` items. At most most_walks before each Run().
  std::uint32_t* Add(std::uint32_t octant, std::size_t count) {
    Walk& walk = walks_[added_];
    walk.octant = octant;
    walk.room = count + padding;
    walk.lists = lists_.get() + used_;
    walk.masks = masks_.get() + used_;
    walk.level = 0;
    walk.next = nodes_.Root();
    walk.next_count = count;
    walk.done = 0;
    walk.is_looked_up = false;
    used_ += walk.room * (levels_ + 1);
    active_[added_++] = &walk;
    return walk.lists;
  }

  void Run() {
    std::size_t active = added_;
    for (std::size_t next = 0; active != 0;) {
      if (Step(*active_[next])) {
        ++next;
      } else {
        active_[next] = active_[--active];
      }
      if (next >= active) next = 0;
    }
    added_ = used_ = 0;
  }

 private:
  static constexpr std::size_t padding = 16;
  using Place = typename Nodes::Place;

  struct Level {
    typename Nodes::Node node;
    std::size_t count;   // items, in the list of the level
    std::size_t done;    // of the walk, when the masks were made
    std::uint32_t left;  // children still to be visited
  };
  struct Walk {
    std::uint32_t octant;
    unsigned level;  // of `next`
    Place next;
    std::size_t next_count;
    std::size_t done;   // items that need no more
    bool is_looked_up;  // only where what is read stands behind an index
    std::size_t room;   // of a list
    std::uint32_t* lists;
    std::uint8_t* masks;
    Level levels[Nodes::most_levels];

    std::uint32_t* list(unsigned at) { return lists + at * room; }
    std::uint8_t* mask(unsigned at) { return masks + at * room; }
  };

  // Visits what has been chosen the turn before, and chooses what is next. False: this walk is done.
  HWY_INLINE bool Step(Walk& walk) {
    if constexpr (Items::is_indirect) {
      walk.is_looked_up = !walk.is_looked_up;
      if (walk.is_looked_up) {
        if (walk.level == levels_) {
          items_.PrefetchBehind(nodes_.Begin(walk.next), nodes_.End(walk.next));
        } else {
          nodes_.PrefetchBehind(walk.next, walk.level);
        }
        return true;
      }
    }
    const std::size_t done = items_.done();
    if (walk.level == levels_) {
      items_.Visit(nodes_.Begin(walk.next), nodes_.End(walk.next), walk.list(walk.level), walk.next_count);
      --walk.level;
    } else {
      VisitNode(walk);
    }
    walk.done += items_.done() - done;
    return Choose(walk);
  }

  HWY_INLINE void VisitNode(Walk& walk) {
    Level& level = walk.levels[walk.level];
    level.count = walk.next_count;
    level.done = walk.done;
    NodePlanes planes;
    ParticlePick inner;
    nodes_.Open(walk.next, walk.level, walk.octant, level.node, planes, inner);
    const bool is_last = walk.level + 1 == levels_;
    const std::uint32_t* const list = walk.list(walk.level);
    std::uint8_t* const masks = walk.mask(walk.level);
    std::uint32_t left = 0;
    std::size_t at_inner = 0;
    for (std::size_t i = 0; i < level.count; ++i) {
      const std::uint32_t met = items_.Meet(planes, list[i], is_last);
      masks[i] = static_cast<std::uint8_t>(met);
      left |= met;
      if constexpr (Nodes::has_inner_particles) {
        at_inner_[at_inner] = list[i];
        at_inner += (met & (met - 1)) != 0 ? 1 : 0;
      }
    }
    level.left = left & nodes_.Filled(level.node);
    if constexpr (Nodes::has_inner_particles)
      if (at_inner != 0) items_.VisitPick(inner, at_inner_.get(), at_inner);
  }

  HWY_INLINE bool Choose(Walk& walk) {
    unsigned at = walk.level;
    for (;;) {
      while (walk.levels[at].left == 0) {
        if (at == 0) return false;
        --at;
      }
      Level& level = walk.levels[at];
      const unsigned k = nearest_child(level.left, nodes_.Flip(level.node));
      level.left &= ~(1u << k);
      std::uint32_t* const list = walk.list(at + 1);
      walk.next_count = ListChild(walk.list(at), walk.mask(at), level.count, k, list);
      // Items may have been done since, in children visited before.
      if (level.done != walk.done) walk.next_count = items_.KeepOpen(list, walk.next_count);
      if (walk.next_count == 0) continue;
      walk.level = at + 1;
      walk.next = nodes_.Child(level.node, k);
      if (walk.level == levels_) {
        items_.Prefetch(nodes_.Begin(walk.next), nodes_.End(walk.next));
      } else {
        nodes_.Prefetch(walk.next, walk.level);
      }
      return true;
    }
  }

  const Nodes& nodes_;
  Items& items_;
  const unsigned levels_;
  std::size_t added_ = 0;
  std::size_t used_ = 0;
  std::unique_ptr<std::uint32_t[]> lists_;
  std::unique_ptr<std::uint8_t[]> masks_;
  std::unique_ptr<std::uint32_t[]> at_inner_;
  std::unique_ptr<Walk[]> walks_;
  Walk* active_[most_walks];
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
