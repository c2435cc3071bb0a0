// A bounding volume hierarchy over anything with boxes: a complete tree of nodes with eight children, without pointers.
//
// The places [0, count) are dealt to the nodes evenly: node i of level l has [count i / 8^l, count (i + 1) / 8^l), and
// its children are 8 i to 8 i + 7 of the next level. Boxes are f32, rounded outwards, in a frame that takes the box of
// everything to [-1, 1]: the whole range of double fits. Rays are met in double.
#pragma once

#include <cstdint>

#include "kernels/slabs.h"

namespace insitu::kernels {

constexpr unsigned box_fanout = 8;
constexpr unsigned box_tree_most_levels = 10;

struct BoxNode {
  float lower[3][box_fanout];  // of the children; lower > upper where there is nothing
  float upper[3][box_fanout];
};

struct BoxTree {
  const BoxNode* nodes = nullptr;  // level by level from the root
  unsigned levels = 0;             // of nodes; 0: everything is one leaf
  std::uint64_t count = 0;         // at most 2^32
  double centre[3] = {};           // of the frame
  double scale = 1.0;              // world to frame

  static std::uint64_t level_begin(unsigned level) { return ((std::uint64_t{1} << 3 * level) - 1) / 7; }
  std::uint64_t node_count() const { return level_begin(levels); }
  // First place of node i of a level; that of node i + 1 is its end.
  std::uint64_t place(unsigned level, std::uint64_t i) const { return count * i >> 3 * level; }
};

// Levels for leaves of one to eight places.
inline unsigned box_tree_levels(std::uint64_t count) {
  unsigned levels = 0;
  while (levels < box_tree_most_levels && (count >> 3 * levels) >= box_fanout) ++levels;
  return levels;
}

// Calls visit(begin, end) for the places of every leaf that the ray may meet between its t_min and t_limit(), near ones
// first; ends when visit returns true.
template <class Limit, class Visit>
void walk_box_tree(const BoxTree& tree, const Ray& ray, Limit&& t_limit, Visit&& visit) {
  if (tree.count == 0) return;
  double from[3];
  for (int c = 0; c < 3; ++c) from[c] = (ray.origin[c] - tree.centre[c]) * tree.scale;
  const RaySlabs slabs(from, ray.direction);
  // The frame's own roundings: 1e-6 of the box of everything is far more than f32 and the two subtractions lose.
  constexpr double margin = 1e-6;
  struct Entry {
    double enter;  // in the frame
    std::uint64_t node;
    unsigned level;
  };
  Entry stack[box_tree_most_levels * (box_fanout - 1) + 1];
  unsigned size = 0;
  stack[size++] = {-std::numeric_limits<double>::infinity(), 0, 0};
  while (size > 0) {
    const Entry entry = stack[--size];
    const double near = ray.t_min * tree.scale;
    const double far = t_limit() * tree.scale * (1.0 + 1e-14);
    if (entry.enter > far) continue;
    if (entry.level == tree.levels) {
      if (visit(tree.place(entry.level, entry.node), tree.place(entry.level, entry.node + 1))) return;
      continue;
    }
    const BoxNode& node = tree.nodes[BoxTree::level_begin(entry.level) + entry.node];
    const unsigned below = size;
    for (unsigned k = 0; k < box_fanout; ++k) {
      if (!(node.lower[0][k] <= node.upper[0][k])) continue;
      double lower[3];
      double upper[3];
      for (int c = 0; c < 3; ++c) {
        lower[c] = static_cast<double>(node.lower[c][k]) - margin;
        upper[c] = static_cast<double>(node.upper[c][k]) + margin;
      }
      const double enter = slabs.enter(lower, upper, near, far);
      if (enter == std::numeric_limits<double>::infinity()) continue;
      // The nearest one on top. Roundings of `enter` must not hide what begins right there.
      unsigned at = size++;
      for (; at > below && stack[at - 1].enter < enter; --at) stack[at] = stack[at - 1];
      stack[at] = {enter > 0.0 ? enter * (1.0 - 1e-12) : enter * (1.0 + 1e-12), 8 * entry.node + k, entry.level + 1};
    }
  }
}

}  // namespace insitu::kernels
