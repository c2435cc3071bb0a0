// Walks of many items through treelets: all items of a walk that meet a node visit it together, so that its boxes are
// decoded once, and what is done for a node is shared. Items are rays, or packets of rays. Included once per SIMD
// target.
//
// A walk holds items of one octant, for which near and far planes are the same everywhere. The list of a child is drawn
// up when it is its turn, from a mask of met children per item. Several walks take turns, a step each: what a step
// reads has been asked for from memory some steps before. (Streams of rays that are filtered on the way down: Tsakok,
// "Faster incoherent rays: Multi-BVH ray stream tracing", HPG 2009; lists per child: Fuetterling et al., "Accelerated
// single ray tracing for wide vector units", HPG 2017.)
#if defined(INSITU_KERNELS_TREELET_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_TREELET_WALK_INL_H_
#undef INSITU_KERNELS_TREELET_WALK_INL_H_
#else
#define INSITU_KERNELS_TREELET_WALK_INL_H_
#endif

#include <memory>

#include "kernels/treelet_node-inl.h"
#include "kernels/treelet_order.h"
#include "kernels/treelets.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Those of `items` whose mask has bit `child` set, in their order; returns how many. Whole vectors are read and
// written: there has to be room for 16 more behind each array.
HWY_NOINLINE std::size_t ListChild(const std::uint32_t* HWY_RESTRICT items, const std::uint8_t* HWY_RESTRICT masks,
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

// Items:
//   uint32 Meet(planes, item, is_last)               children met, a bit each; is_last: they are treelets
//   void Visit(begin, end, list, count)              the items of the list, in the treelet of these places
//   void Prefetch(begin, end)                        asks for what Visit will read
template <class Items>
class TreeletWalks {
 public:
  static constexpr std::size_t most_walks = 8;

  // Room for all walks together: `most_items`.
  TreeletWalks(const Treelets& treelets, std::uint64_t places, Items& items, std::size_t most_items)
      : treelets_(treelets), places_(places), items_(items), walks_(new Walk[most_walks]) {
    const std::size_t slots = (most_items + most_walks * padding) * (treelets.levels + 1);
    lists_.reset(new std::uint32_t[slots]);
    masks_.reset(new std::uint8_t[slots]);
  }

  // One more walk, of `octant`; its list is to be filled in with `count` items. At most most_walks before each Run().
  std::uint32_t* Add(std::uint32_t octant, std::size_t count) {
    Walk& walk = walks_[added_];
    walk.octant = octant;
    walk.room = count + padding;
    walk.lists = lists_.get() + used_;
    walk.masks = masks_.get() + used_;
    walk.level = 0;
    walk.next = {treelets_.root(), 0, count};
    used_ += walk.room * (treelets_.levels + 1);
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

  struct Place {
    TreeletRun run;
    std::uint64_t node;  // within its level
    std::size_t count;   // items, in the list of the level
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

  // Visits what has been chosen the turn before, and chooses what is next. False: this walk is done.
  HWY_INLINE bool Step(Walk& walk) {
    if (walk.level == treelets_.levels) {
      items_.Visit(walk.next.run.begin, EndOf(walk.next.run), walk.list(walk.level), walk.next.count);
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
    const bool is_last = walk.level + 1 == treelets_.levels;
    const std::uint32_t* const list = walk.list(walk.level);
    std::uint8_t* const masks = walk.mask(walk.level);
    std::uint32_t left = 0;
    for (std::size_t i = 0; i < walk.next.count; ++i) {
      const std::uint32_t met = items_.Meet(planes, list[i], is_last);
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
      items_.Prefetch(walk.next.run.begin, EndOf(walk.next.run));
    } else {
      __builtin_prefetch(treelets_.nodes + treelets_.level_begin[walk.level] + walk.next.node);
    }
    walk.next.count = ListChild(walk.list(at), walk.mask(at), level.place.count, k, walk.list(walk.level));
    return true;
  }

  std::uint64_t EndOf(const TreeletRun& run) const { return std::min(run.begin + run.span, places_); }

  const Treelets& treelets_;
  std::uint64_t places_;
  Items& items_;
  std::size_t added_ = 0;
  std::size_t used_ = 0;
  std::unique_ptr<std::uint32_t[]> lists_;
  std::unique_ptr<std::uint8_t[]> masks_;
  std::unique_ptr<Walk[]> walks_;
  Walk* active_[most_walks];
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
