#include "neighbour_list.h"

namespace melt {

NeighbourList::NeighbourList(const Box& box, double reach, std::size_t atoms)
    : box_(box),
      reach_square_(reach * reach),
      cells_(box, reach, atoms),
      points_(atoms),
      cell_of_slot_(atoms),
      blocks_(Workers::blocks(atoms)) {}

void NeighbourList::build(std::span<const Vec3> points, Workers& workers) {
  cells_.sort(points);
  const std::span<const std::uint32_t> order = cells_.order();
  workers.for_each(points.size(), [&](std::size_t slot) { points_[slot] = points[order[slot]]; });
  for (std::size_t c = 0; c < cells_.cells(); ++c) {
    for (std::uint32_t s = cells_.first(c); s < cells_.first(c + 1); ++s) {
      cell_of_slot_[s] = static_cast<std::uint32_t>(c);
    }
  }
  workers.for_each_block(points.size(), [&](std::size_t number, std::size_t begin, std::size_t end) {
    build_block(blocks_[number], begin, end);
  });
  ++builds_;
}

void NeighbourList::build_block(Block& block, std::size_t begin, std::size_t end) const {
  const Box box = box_;
  const double reach_square = reach_square_;
  const Vec3* const points = points_.data();
  block.first.assign(1, 0u);
  std::size_t size = 0;
  std::vector<std::size_t> around;
  std::size_t cell = cells_.cells();  // none yet
  for (std::size_t i = begin; i < end; ++i) {
    if (cell_of_slot_[i] != cell) {
      cell = cell_of_slot_[i];
      cells_.neighbours(cell, around);
    }
    const Vec3 p = points[i];
    for (const std::size_t c : around) {
      const std::uint32_t last = cells_.first(c + 1);
      const std::size_t room = size + last - cells_.first(c);
      if (block.slots.size() < room) block.slots.resize(2 * room);
      std::uint32_t* const slots = block.slots.data();
      for (std::uint32_t j = cells_.first(c); j < last; ++j) {
        const double dx = box.nearest(p[0] - points[j][0]);
        const double dy = box.nearest(p[1] - points[j][1]);
        const double dz = box.nearest(p[2] - points[j][2]);
        // One candidate in six is a neighbour, in no order a branch predictor could learn: write all, keep some.
        slots[size] = j;
        size += static_cast<std::size_t>(dx * dx + dy * dy + dz * dz < reach_square && j != i);
      }
    }
    block.first.push_back(static_cast<std::uint32_t>(size));
  }
}

}  // namespace melt
