// Walks over a P-k-d tree as it is: nodes of eight children are three levels of splits, put together when they are
// visited. Included once per SIMD target.
//
// The particles of the seven splits belong to no child. A particle stands on the plane of its split, within the box of
// some child on either side of it; so a ray that hits it meets at least two of the children's boxes.
#if defined(INSITU_KERNELS_PKD_NODES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_NODES_INL_H_
#undef INSITU_KERNELS_PKD_NODES_INL_H_
#else
#define INSITU_KERNELS_PKD_NODES_INL_H_
#endif

#include <bit>

#include "kernels/child_order.h"
#include "kernels/node_planes-inl.h"
#include "kernels/particle_runs-inl.h"
#include "kernels/treelets.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// The split axis of the tree, as PkdBox::split_axis has it. Splits at a depth of `depth` levels.
struct LongSide {
  template <class Key>
  static HWY_INLINE unsigned Axis(const Key* lower, const Key* upper, unsigned /*depth*/) {
    return static_cast<unsigned>(split_axis_of(upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]));
  }
};

// The Nodes of walk-inl.h.
template <class Positions, class SplitRule = LongSide>
class PkdNodes {
 public:
  using Key = typename Positions::Key;
  static constexpr bool has_inner_particles = true;
  static constexpr bool is_indirect = Positions::is_indirect;
  static constexpr unsigned most_levels = 22;

  // Boxes as rows of four, of which the last is not used.
  struct Box {
    HWY_ALIGN Key lower[4];
    HWY_ALIGN Key upper[4];
  };
  struct Place {
    std::uint64_t begin;
    std::uint64_t end;
    Box box;
  };
  struct Node {
    TreeletRun run;  // child k holds the places of its part but for the last, which is that of a split
    unsigned bits;
    std::uint32_t filled;
    std::uint32_t flip;
    HWY_ALIGN Key lower[2 * node_fanout][4];  // of the node and its parts, level by level from 1; children are the last
    HWY_ALIGN Key upper[2 * node_fanout][4];
  };

  // `longest`: leaves hold at most so many particles, or about as many that are drawn. `few_for_all`: of equal spheres
  // at one point two may stand for all, the first of which is the one to be shown (the second: a ray may start on the
  // first); not under a filter, which may leave out just these.
  PkdNodes(const PkdTree& tree, const Positions& positions, const TreeMargin& margin, std::uint64_t longest,
           bool few_for_all)
      : tree_(tree),
        positions_(positions),
        wide_(static_cast<float>((tree.radius_max + margin.value) * (1.0 + 4.0 * f32_unit))),
        few_for_all_(few_for_all && tree.radius.kind == RadiusView::Kind::uniform && tree.selected.all()) {
    unsigned depth = 1;
    // With one more place the levels would be shared out evenly: the smallest subtree has its share, rounded down, less
    // that place.
    while (((tree.count + 1) >> depth) - 1 > longest << tree.selected.thinning) ++depth;
    levels_ = (depth + 2) / 3;
    root_bits_ = depth - 3 * (levels_ - 1);
  }

  unsigned levels() const { return levels_; }
  Place Root() const {
    Place place = {0, tree_.count, {}};
    for (int c = 0; c < 3; ++c) {
      place.box.lower[c] = static_cast<Key>(tree_.lower[c]);
      place.box.upper[c] = static_cast<Key>(tree_.upper[c]);
    }
    return place;
  }
  static constexpr bool are_copied() { return false; }
  std::uint64_t Begin(const Place& place) const { return place.begin; }
  std::uint64_t End(const Place& place) const { return place.end; }

  // The seven splits of a node.
  HWY_INLINE void Prefetch(const Place& place, unsigned) const {
    const std::uint64_t eighth = (place.end - place.begin) / 8;
    for (unsigned i = 1; i < 8; ++i) positions_.prefetch(place.begin + i * eighth);
  }
  HWY_INLINE void PrefetchBehind(const Place& place, unsigned) const {
    if constexpr (is_indirect) {
      const std::uint64_t eighth = (place.end - place.begin) / 8;
      for (unsigned i = 1; i < 8; ++i) positions_.prefetch_behind(place.begin + i * eighth);
    }
  }

  HWY_INLINE void Open(const Place& place, unsigned level, std::uint32_t octant, Node& node, NodePlanes& planes,
                       ParticlePick& inner) const {
    const hn::CappedTag<Key, 4> d;
    const unsigned bits = level == 0 ? root_bits_ : 3;
    const unsigned children = 1u << bits;
    const unsigned depth = level == 0 ? 0 : root_bits_ + 3 * (level - 1);
    node.bits = bits;
    std::uint64_t end = place.end;
    if (HWY_UNLIKELY(IsPoint(place.box)) && few_for_all_) end = std::min(place.begin + 2, end);
    node.run = {place.begin, end - place.begin + 1};
    node.filled = 0;
    std::uint64_t begins[node_fanout];
    for (unsigned k = 0; k < children; ++k) {
      const TreeletRun part = child_run(node.run, bits, k);
      begins[k] = part.begin;
      node.filled |= part.span > 1 ? 1u << k : 0u;
    }
    for (std::size_t i = 0; i < 4; i += hn::Lanes(d)) {
      hn::Store(hn::Load(d, place.box.lower + i), d, node.lower[1] + i);
      hn::Store(hn::Load(d, place.box.upper + i), d, node.upper[1] + i);
    }
    // Part `at` is split by the particle before the first child of its upper half. Parts without particles are split
    // anywhere: nothing is below them.
    inner.clear();
    unsigned axes = 0;
    for (unsigned at = 1, row = children / 2, first = 1; at < children; ++at) {
      if (at == 2 * first) {
        first = at;
        row /= 2;
      }
      const unsigned middle = row + 2 * row * (at - first);
      const std::uint64_t mid = std::min(begins[middle] - 1, end - 1);
      const unsigned axis =
          SplitRule::Axis(node.lower[at], node.upper[at], depth + static_cast<unsigned>(std::bit_width(at)) - 1);
      if (at == first) axes |= axis << 2 * (static_cast<unsigned>(std::bit_width(at)) - 1 + 3 - bits);
      const auto plane = hn::Set(d, positions_.key(mid, static_cast<int>(axis)));
      for (std::size_t i = 0; i < 4; i += hn::Lanes(d)) {
        const auto is_axis = hn::Eq(hn::Iota(d, static_cast<Key>(i)), hn::Set(d, static_cast<Key>(axis)));
        const auto lower = hn::Load(d, node.lower[at] + i);
        const auto upper = hn::Load(d, node.upper[at] + i);
        hn::Store(lower, d, node.lower[2 * at] + i);
        hn::Store(hn::IfThenElse(is_axis, plane, upper), d, node.upper[2 * at] + i);
        hn::Store(hn::IfThenElse(is_axis, plane, lower), d, node.lower[2 * at + 1] + i);
        hn::Store(upper, d, node.upper[2 * at + 1] + i);
      }
      float centre[3];
      positions_.centre_f32(mid, centre);
      inner.add(mid, centre);
    }
    if (HWY_UNLIKELY(!tree_.selected.all())) DropUndrawn(tree_.selected, node, inner);
    node.flip = child_flip(axes, octant, bits);
    MakePlanes(node, octant, planes);
  }
  std::uint32_t Filled(const Node& node) const { return node.filled; }
  std::uint32_t Flip(const Node& node) const { return node.flip; }
  HWY_INLINE Place Child(const Node& node, unsigned k) const {
    const hn::CappedTag<Key, 4> d;
    const TreeletRun part = child_run(node.run, node.bits, k);
    Place place = {part.begin, part.begin + part.span - 1, {}};
    const unsigned row = (1u << node.bits) + k;
    for (std::size_t i = 0; i < 4; i += hn::Lanes(d)) {
      hn::Store(hn::Load(d, node.lower[row] + i), d, place.box.lower + i);
      hn::Store(hn::Load(d, node.upper[row] + i), d, place.box.upper + i);
    }
    return place;
  }

 private:
  // Children of which the filter has left nothing, and splits that it has left out.
  static HWY_NOINLINE void DropUndrawn(const SelectedPlaces& selected, Node& node, ParticlePick& inner) {
    inner.KeepDrawn(selected);
    for (unsigned k = 0; k < 1u << node.bits; ++k) {
      const TreeletRun part = child_run(node.run, node.bits, k);
      if (part.span > 1 && !selected.any(part.begin, part.begin + part.span - 1)) node.filled &= ~(1u << k);
    }
  }
  static bool IsPoint(const Box& box) {
    return box.lower[0] == box.upper[0] && box.lower[1] == box.upper[1] && box.lower[2] == box.upper[2];
  }

  // The boxes of the children, grown.
  HWY_INLINE void MakePlanes(const Node& node, std::uint32_t octant, NodePlanes& planes) const {
    const hn::CappedTag<float, node_fanout> f;
    using V = hn::Vec<decltype(f)>;
    const unsigned children = 1u << node.bits;
    const V wide = hn::Set(f, wide_);
    HWY_ALIGN float rows[2][node_fanout][4];
    const float* lower_rows;
    const float* upper_rows;
    if constexpr (std::is_same_v<Key, float>) {
      lower_rows = node.lower[children];
      upper_rows = node.upper[children];
    } else {
      for (unsigned k = 0; k < children; ++k) {
        for (unsigned c = 0; c < 3; ++c) {
          rows[0][k][c] = static_cast<float>(node.lower[children + k][c]);
          rows[1][k][c] = static_cast<float>(node.upper[children + k][c]);
        }
      }
      lower_rows = rows[0][0];
      upper_rows = rows[1][0];
    }
    if (HWY_UNLIKELY(children < node_fanout)) {
      for (unsigned k = 0; k < node_fanout; ++k) {
        for (unsigned c = 0; c < 3; ++c) {
          // A child that is not there has a box that nothing meets.
          const float lower = k < children ? lower_rows[4 * k + c] - wide_ : 1e30f;
          const float upper = k < children ? upper_rows[4 * k + c] + wide_ : -1e30f;
          const bool is_down = (octant >> c & 1) != 0;
          planes.near[c][k] = is_down ? upper : lower;
          planes.far[c][k] = is_down ? lower : upper;
        }
      }
      return;
    }
    for (std::size_t k = 0; k < node_fanout; k += hn::Lanes(f)) {
      V lower[3], upper[3], none;
      hn::LoadInterleaved4(f, lower_rows + 4 * k, lower[0], lower[1], lower[2], none);
      hn::LoadInterleaved4(f, upper_rows + 4 * k, upper[0], upper[1], upper[2], none);
      for (std::size_t c = 0; c < 3; ++c) {
        const bool is_down = (octant >> c & 1) != 0;
        hn::Store(hn::Sub(lower[c], wide), f, (is_down ? planes.far[c] : planes.near[c]) + k);
        hn::Store(hn::Add(upper[c], wide), f, (is_down ? planes.near[c] : planes.far[c]) + k);
      }
    }
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const float wide_;  // by which boxes of centres are grown
  const bool few_for_all_;
  unsigned levels_;
  unsigned root_bits_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
