// The structure of the paper (Wald et al., "CPU Ray Tracing Large Particle Data with Balanced P-k-d Trees", IEEE Vis
// 2015, sections 3.1 to 3.4), for comparison only: a balanced k-d tree with a particle in every node, down to single
// particles, split round robin or along the longest side, traced by single rays or by packets.
//
// Two deviations. Split axes stand in an array of their own, a byte each, where the paper hides them in mantissa bits:
// data is never changed here. And a hit is decided as in the library: f32 finds candidates, double confirms, so that
// hits are those of kernels/pkd_reference.h to the last bit and times can be compared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/pkd_tree.h"
#include "kernels/ray.h"

namespace bench {

// heap: children of i at 2i+1 and 2i+2, as in the paper. in_order: as in kernels/pkd_tree.h, which tells the influence
// of the layout from that of everything else.
enum class TreeLayout { heap, in_order };
enum class AxisRule { round_robin, longest_side };
// single: a ray after another, in plain scalar code. packet: 16 rays share one stack, with a mask of active lanes, as
// the paper's ISPC kernels do.
enum class RayWay { single, packet };

// Places below the lower child of the root of a complete tree of `count` nodes, count > 0: all levels but the last are
// full, and the last is filled from the left.
std::uint64_t left_subtree_size(std::uint64_t count);

class PaperTree {
 public:
  // Positions x y z x y z ... are copied into tree order, with as many threads as the caller's TBB arena has. Items of
  // hits are indices into `position`, for four bytes a particle, or places in the tree.
  enum class Items { by_index, by_place };
  PaperTree(const std::vector<float>& position, double radius, TreeLayout layout, AxisRule rule, Items items);
  PaperTree(const PaperTree&) = delete;
  PaperTree& operator=(const PaperTree&) = delete;

  TreeLayout layout() const { return layout_; }
  AxisRule rule() const { return rule_; }
  // The particles by their places, for brute force and checks.
  const insitu::kernels::PkdTree& tree() const { return tree_; }
  const std::vector<float>& position() const { return position_; }
  const std::vector<std::uint8_t>& axes() const { return axes_; }

  // As pkd_first_hits and pkd_any_hits of kernels/pkd_traverse.h.
  void first_hits(RayWay way, const insitu::kernels::Ray* rays, insitu::kernels::Hit* hits, std::size_t count) const;
  void any_hits(RayWay way, const insitu::kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const;

  // The library's own traversal, its packets, streams and leaves of 32, over round robin axes: for trees that are
  // in_order and round_robin.
  void library_first_hits(const insitu::kernels::Ray* rays, insitu::kernels::Hit* hits, std::size_t count) const;
  void library_any_hits(const insitu::kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const;

 private:
  TreeLayout layout_;
  AxisRule rule_;
  std::vector<float> position_;
  std::vector<std::uint8_t> axes_;    // by place; round robin traversals count levels instead
  std::vector<std::uint32_t> items_;  // by place
  insitu::kernels::PkdTree tree_;
};

}  // namespace bench
