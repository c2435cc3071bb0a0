#include "cell_list.h"

#include <algorithm>
#include <cmath>

namespace melt {

CellList::CellList(const Box& box, double reach, std::size_t points) : box_(box) {
  // More cells than points would only cost memory, in a thin gas.
  const double most = std::max(1.0, std::cbrt(static_cast<double>(points)));
  width_ = static_cast<std::size_t>(std::max(1.0, std::min(std::floor(box.side / reach), most)));
  first_.resize(width_ * width_ * width_ + 1);
  order_.resize(points);
  cell_.resize(points);
}

std::size_t CellList::cell_of(const Vec3& p) const {
  const double scale = static_cast<double>(width_) / box_.side;
  const auto along = [&](double x) { return std::min(static_cast<std::size_t>(x * scale), width_ - 1); };
  return (along(p[2]) * width_ + along(p[1])) * width_ + along(p[0]);
}

void CellList::sort(std::span<const Vec3> points) {
  std::fill(first_.begin(), first_.end(), 0u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    cell_[i] = static_cast<std::uint32_t>(cell_of(points[i]));
    ++first_[cell_[i] + 1];
  }
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  // first_[c] serves as the write cursor of cell c, which leaves it at the start of cell c + 1; then all move back.
  for (std::size_t i = 0; i < points.size(); ++i) order_[first_[cell_[i]]++] = static_cast<std::uint32_t>(i);
  for (std::size_t c = first_.size() - 1; c > 0; --c) first_[c] = first_[c - 1];
  first_[0] = 0;
}

void CellList::neighbours(std::size_t cell, std::vector<std::size_t>& out) const {
  const std::size_t at[3] = {cell % width_, cell / width_ % width_, cell / width_ / width_};
  std::size_t along[3][3];
  const std::size_t count = std::min<std::size_t>(width_, 3);
  for (std::size_t k = 0; k < 3; ++k) {
    // One cell back, itself, one ahead; with two cells only, the one ahead is the one back.
    for (std::size_t n = 0; n < count; ++n) along[k][n] = count < 3 ? n : (at[k] + width_ - 1 + n) % width_;
  }
  out.clear();
  for (std::size_t z = 0; z < count; ++z) {
    for (std::size_t y = 0; y < count; ++y) {
      for (std::size_t x = 0; x < count; ++x)
        out.push_back((along[2][z] * width_ + along[1][y]) * width_ + along[0][x]);
    }
  }
}

}  // namespace melt
