// Treelets: a bounding volume hierarchy over short runs of a P-k-d tree's places, for a few bytes per treelet.
//
// A treelet is what a subtree at a chosen depth of the tree holds, and the particle of the split that follows it: the
// treelets divide all places among them, in order, so that no list of them has to be kept. Over them stands a complete
// tree of nodes with eight children each, which are three levels of the k-d tree; the root alone may have fewer. A node
// is one cache line: the boxes of its children, radii included, as 8-bit steps of a frame of its own (compressed wide
// nodes: Ylitie, Karras, Laine, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", HPG 2017).
// Topology and the places of a treelet follow from the number of particles, so that nothing of either is stored.
//
// What the P-k-d tree alone has not: boxes that fit, so that the space between clusters costs nothing, and radii that
// count only where they are, so that a few large particles do not widen everything (the paper's section 3.4 leaves
// that open).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "kernels/child_order.h"

namespace insitu::kernels {

struct alignas(64) TreeletNode {
  float origin[3];           // lower corner, relative to Treelets::frame
  std::uint8_t exponent[3];  // a step along axis c is 2^(exponent[c] - 127)
  std::uint8_t axes;         // split axes of the three levels, two bits each from bit 0, widest first; bit 6 is set
  std::uint8_t lower[3][node_fanout];  // a child without particles has lower > upper
  std::uint8_t upper[3][node_fanout];
};
static_assert(sizeof(TreeletNode) == 64);

// Places [begin, begin + span): those of a subtree, and the split behind it. Of the last run of a tree the last place
// does not exist.
struct TreeletRun {
  std::uint64_t begin;
  std::uint64_t span;
};

// Child k of 2^bits. Halving a run of `span` places, splits counted with their left halves, gives the left half the
// larger part; so after `bits` halvings span / 2^bits is dealt to each, and one more to those k whose bits, read
// backwards, are below the remainder.
inline TreeletRun child_run(const TreeletRun& run, unsigned bits, unsigned k) {
  // Bit k of row r: of eight children, those that get one more when the remainder is r. Fewer children are every second
  // or every fourth of them.
  constexpr std::uint8_t larger[8] = {0x00, 0x01, 0x11, 0x15, 0x55, 0x57, 0x77, 0x7f};
  constexpr std::uint8_t present[4] = {0x01, 0x11, 0x55, 0xff};
  const std::uint64_t each = run.span >> bits;
  const unsigned row = larger[run.span & ((std::uint64_t{1} << bits) - 1)] & present[bits];
  const unsigned place = k << (3 - bits);
  const auto before = static_cast<unsigned>(std::popcount(row & ((1u << place) - 1)));
  return {run.begin + k * each + before, each + (row >> place & 1)};
}

// Views the nodes; they belong to whoever built them.
struct Treelets {
  static constexpr unsigned most_levels = 14;

  const TreeletNode* nodes = nullptr;           // level by level from the root, in order within each
  unsigned levels = 0;                          // of nodes; 0: there are no treelets
  unsigned root_bits = 0;                       // the root has 2^root_bits children, all others eight
  std::uint64_t level_begin[most_levels] = {};  // first node of a level
  std::uint64_t count = 0;                      // of treelets
  std::uint64_t particles = 0;                  // of the tree

  bool exist() const { return levels != 0; }
  unsigned bits_at(unsigned level) const { return level == 0 ? root_bits : 3; }
  std::uint64_t nodes_at(unsigned level) const {
    return level == 0 ? 1 : std::uint64_t{1} << (root_bits + 3 * (level - 1));
  }
  std::uint64_t node_count() const { return exist() ? level_begin[levels - 1] + nodes_at(levels - 1) : 0; }
  TreeletRun root() const { return {0, particles + 1}; }
  // The places of a node: the digits of `index` to the base of eight are the way to it.
  TreeletRun run_of_node(unsigned level, std::uint64_t index) const {
    TreeletRun run = root();
    for (unsigned above = 0; above < level; ++above)
      run = child_run(run, bits_at(above), static_cast<unsigned>(index >> (3 * (level - 1 - above)) & 7));
    return run;
  }
  TreeletRun run_of_treelet(std::uint64_t number) const {
    const unsigned bits = bits_at(levels - 1);
    return child_run(run_of_node(levels - 1, number >> bits), bits, static_cast<unsigned>(number & ((1u << bits) - 1)));
  }
};

}  // namespace insitu::kernels
