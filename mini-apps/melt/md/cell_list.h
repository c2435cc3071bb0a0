// Sorting points into the cells of a regular grid.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "box.h"

namespace melt {

// A grid of cubic cells over the periodic box, none narrower than `reach`: all points within `reach` of a point are in
// its cell or one of the 26 around it (Allen & Tildesley, chapter 5).
class CellList {
 public:
  CellList(const Box& box, double reach, std::size_t points);

  // Sorts points, all inside the box, by (cell, index). The order of points in memory other than by index, as well as
  // the number of threads, plays no role: sums over cells always run in the same order.
  void sort(std::span<const Vec3> points);

  // Indices of the points, cell after cell.
  std::span<const std::uint32_t> order() const { return order_; }
  std::size_t cells() const { return first_.size() - 1; }
  // Cell c holds order()[first(c)] to order()[first(c + 1) - 1].
  std::uint32_t first(std::size_t cell) const { return first_[cell]; }
  // The cells within reach of `cell`, itself included; each once, also where the grid is less than three cells wide.
  void neighbours(std::size_t cell, std::vector<std::size_t>& out) const;

 private:
  std::size_t cell_of(const Vec3& p) const;

  Box box_;
  std::size_t width_;  // cells along a side
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> cell_;  // of each point, kept between the two passes of the counting sort
};

}  // namespace melt
