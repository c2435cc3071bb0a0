// Who is near whom: Verlet lists.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "box.h"
#include "cell_list.h"
#include "workers.h"

namespace melt {

// For every atom the list of all others within cutoff + skin. It stays good until some atom has moved half a skin
// (Verlet, Phys. Rev. 159, 98 (1967)).
//
// The list speaks of *slots*: atoms sorted by (cell, id) at the build. Slots depend on positions and ids alone, not on
// the place of a record in memory, so a list outlives a permutation of the records, and sums along it have the same
// last bit with and without one.
class NeighbourList {
 public:
  NeighbourList(const Box& box, double reach, std::size_t atoms);

  // `points` by id, inside the box.
  void build(std::span<const Vec3> points, Workers& workers);

  // Slot to id.
  std::span<const std::uint32_t> ids() const { return cells_.order(); }
  // Slots of the neighbours of the atom in `slot`. Both atoms of a pair have each other, so that one thread sums all of
  // an atom's force, in a fixed order. Half lists (each pair once) were measured 1.3 times as fast on one thread; on
  // two, where they would need a force array per thread, full lists are 1.5 times as fast as half lists on one.
  std::span<const std::uint32_t> of(std::size_t slot) const {
    const Block& block = blocks_[slot / Workers::block];
    const std::size_t i = slot % Workers::block;
    return std::span(block.slots).subspan(block.first[i], block.first[i + 1] - block.first[i]);
  }
  std::uint64_t builds() const { return builds_; }

 private:
  // Lists of Workers::block consecutive slots, grown by one thread without knowing the sizes of the others.
  struct Block {
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> slots;  // the lists end to end; room for more behind them
  };
  void build_block(Block& block, std::size_t begin, std::size_t end) const;

  Box box_;
  double reach_square_;
  CellList cells_;
  std::vector<Vec3> points_;  // by slot
  std::vector<std::uint32_t> cell_of_slot_;
  std::vector<Block> blocks_;
  std::uint64_t builds_ = 0;
};

}  // namespace melt
