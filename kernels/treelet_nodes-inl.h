// Walks over the nodes of treelets. Included once per SIMD target.
#if defined(INSITU_KERNELS_TREELET_NODES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_TREELET_NODES_INL_H_
#undef INSITU_KERNELS_TREELET_NODES_INL_H_
#else
#define INSITU_KERNELS_TREELET_NODES_INL_H_
#endif

#include <bit>

#include "kernels/child_order.h"
#include "kernels/node_planes-inl.h"
#include "kernels/particle_runs-inl.h"
#include "kernels/treelets.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// The Nodes of walk-inl.h.
class TreeletNodes {
 public:
  static constexpr bool has_inner_particles = false;
  static constexpr bool is_indirect = false;
  static constexpr unsigned most_levels = Treelets::most_levels;

  struct Place {
    TreeletRun run;
    std::uint64_t node;  // within its level
  };
  struct Node {
    Place place;
    std::uint32_t flip;
    unsigned bits;
    std::uint32_t filled;
  };

  TreeletNodes(const PkdTree& tree, const Treelets& treelets)
      : treelets_(treelets), places_(tree.count), is_filtered_(!tree.selected.all()), before_(tree.copies.before) {}

  unsigned levels() const { return treelets_.levels; }
  Place Root() const { return {treelets_.root(), 0}; }
  bool are_copied() const { return before_ != nullptr; }
  HWY_INLINE std::uint64_t Begin(const Place& place) const {
    return HWY_UNLIKELY(are_copied()) ? before_[place.node] : place.run.begin;
  }
  HWY_INLINE std::uint64_t End(const Place& place) const {
    return HWY_UNLIKELY(are_copied()) ? before_[place.node + 1] : std::min(place.run.begin + place.run.span, places_);
  }

  HWY_INLINE void Prefetch(const Place& place, unsigned level) const {
    prefetch_line(treelets_.nodes + treelets_.level_begin[level] + place.node);
  }
  HWY_INLINE void PrefetchBehind(const Place&, unsigned) const {}

  // Decodes the boxes of the children.
  HWY_INLINE void Open(const Place& place, unsigned level, std::uint32_t octant, Node& out, NodePlanes& planes,
                       ParticlePick&) const {
    const hn::CappedTag<float, node_fanout> d;
    const hn::Rebind<std::int32_t, decltype(d)> i;
    const hn::Rebind<std::uint8_t, decltype(d)> b;
    const TreeletNode& node = treelets_.nodes[treelets_.level_begin[level] + place.node];
    out.place = place;
    out.bits = treelets_.bits_at(level);
    out.flip = child_flip(node.axes, octant, out.bits);
    out.filled = HWY_UNLIKELY(is_filtered_) ? WithParticles(node) : (1u << (1u << out.bits)) - 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const bool is_down = (octant >> c & 1) != 0;
      const std::uint8_t* const q_near = is_down ? node.upper[c] : node.lower[c];
      const std::uint8_t* const q_far = is_down ? node.lower[c] : node.upper[c];
      const auto step = hn::Set(d, std::bit_cast<float>(std::uint32_t{node.exponent[c]} << 23));
      const auto from = hn::Set(d, node.origin[c]);
      for (std::size_t k = 0; k < node_fanout; k += hn::Lanes(d)) {
        hn::Store(hn::MulAdd(hn::ConvertTo(d, hn::PromoteTo(i, hn::LoadU(b, q_near + k))), step, from), d,
                  planes.near[c] + k);
        hn::Store(hn::MulAdd(hn::ConvertTo(d, hn::PromoteTo(i, hn::LoadU(b, q_far + k))), step, from), d,
                  planes.far[c] + k);
      }
    }
  }
  // Children that are there. A box without particles is met by no ray, but perhaps by a wide beam; under a filter,
  // which leaves many of them, they are told apart.
  std::uint32_t Filled(const Node& node) const { return node.filled; }
  std::uint32_t Flip(const Node& node) const { return node.flip; }
  HWY_INLINE Place Child(const Node& node, unsigned k) const {
    return {child_run(node.place.run, node.bits, k), (node.place.node << node.bits) + k};
  }

 private:
  static HWY_INLINE std::uint32_t WithParticles(const TreeletNode& node) {
    std::uint32_t filled = 0;
    for (unsigned k = 0; k < node_fanout; ++k) filled |= node.lower[0][k] <= node.upper[0][k] ? 1u << k : 0u;
    return filled;
  }

  const Treelets& treelets_;
  std::uint64_t places_;
  bool is_filtered_;
  const std::uint32_t* before_;  // copies before those of a treelet; or null
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
