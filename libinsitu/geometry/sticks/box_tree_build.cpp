#include "geometry/sticks/box_tree_build.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace insitu {
namespace {

using kernels::BoxNode;
using kernels::BoxTree;

constexpr ItemBox nothing{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};

void include(ItemBox& box, const ItemBox& other) {
  for (int c = 0; c < 3; ++c) {
    box.lower[c] = std::min(box.lower[c], other.lower[c]);
    box.upper[c] = std::max(box.upper[c], other.upper[c]);
  }
}

class Builder {
 public:
  Builder(const BoxTree& tree, BoxNode* nodes, const std::vector<ItemBox>& boxes, std::vector<std::uint32_t>& order)
      : tree_(tree), nodes_(nodes), boxes_(boxes), order_(order) {}

  // Sorts the places of node i of a level among its children, and returns its box.
  ItemBox build(unsigned level, std::uint64_t i) {
    if (level == tree_.levels) {
      ItemBox box = nothing;
      for (std::uint64_t p = tree_.place(level, i); p < tree_.place(level, i + 1); ++p) include(box, boxes_[order_[p]]);
      return box;
    }
    deal(level + 1, 8 * i, kernels::box_fanout);
    ItemBox children[kernels::box_fanout];
    if (tree_.place(level, i + 1) - tree_.place(level, i) > 4096) {
      tbb::parallel_for(0u, kernels::box_fanout, [&](unsigned k) { children[k] = build(level + 1, 8 * i + k); });
    } else {
      for (unsigned k = 0; k < kernels::box_fanout; ++k) children[k] = build(level + 1, 8 * i + k);
    }
    ItemBox box = nothing;
    BoxNode& node = nodes_[BoxTree::level_begin(level) + i];
    for (unsigned k = 0; k < kernels::box_fanout; ++k) {
      include(box, children[k]);
      for (int c = 0; c < 3; ++c) {
        node.lower[c][k] = rounded((children[k].lower[c] - tree_.centre[c]) * tree_.scale, -1.0);
        node.upper[c][k] = rounded((children[k].upper[c] - tree_.centre[c]) * tree_.scale, 1.0);
      }
    }
    return box;
  }

 private:
  static float rounded(double value, double towards) {
    if (std::abs(value) > 2.0) return static_cast<float>(value > 0.0 ? 2.0 : -2.0);  // of an empty child
    const auto nearest = static_cast<float>(value);
    return (static_cast<double>(nearest) - value) * towards >= 0.0
               ? nearest
               : std::nextafter(nearest, static_cast<float>(3.0 * towards));
  }

  // Sorts the places of `nodes` nodes of a level among them, by halving.
  void deal(unsigned level, std::uint64_t first, unsigned nodes) {
    if (nodes == 1) return;
    const unsigned half = nodes / 2;
    const std::uint64_t begin = tree_.place(level, first);
    const std::uint64_t end = tree_.place(level, first + nodes);
    halve(begin, tree_.place(level, first + half), end);
    const auto low = [&] { deal(level, first, half); };
    const auto high = [&] { deal(level, first + half, half); };
    if (end - begin > 4096) {
      tbb::parallel_invoke(low, high);
    } else {
      low();
      high();
    }
  }

  // Puts those with the smaller middles, along the axis on which middles differ most, before `mid`.
  void halve(std::uint64_t begin, std::uint64_t mid, std::uint64_t end) {
    if (mid <= begin || mid >= end) return;
    const auto middle = [this](std::uint32_t item, int axis) {
      return boxes_[item].lower[axis] + boxes_[item].upper[axis];
    };
    int axis = 0;
    double widest = -1.0;
    for (int c = 0; c < 3; ++c) {
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      for (std::uint64_t p = begin; p < end; ++p) {
        low = std::min(low, middle(order_[p], c));
        high = std::max(high, middle(order_[p], c));
      }
      if (high - low <= widest) continue;
      widest = high - low;
      axis = c;
    }
    const auto at = [this](std::uint64_t p) { return order_.begin() + static_cast<std::ptrdiff_t>(p); };
    std::nth_element(at(begin), at(mid), at(end), [&](std::uint32_t a, std::uint32_t b) {
      const double x = middle(a, axis);
      const double y = middle(b, axis);
      return x != y ? x < y : a < b;
    });
  }

  const BoxTree& tree_;
  BoxNode* nodes_;
  const std::vector<ItemBox>& boxes_;
  std::vector<std::uint32_t>& order_;
};

}  // namespace

void BoxTreeStore::clear() {
  tree_ = {};
  bounds_ = nothing;
}

void BoxTreeStore::build(Budget& budget, const std::vector<ItemBox>& boxes, const std::vector<std::uint32_t>& ids,
                         const char* what) {
  clear();
  const std::uint64_t count = boxes.size();
  const BudgetShare scratch(budget, count * (sizeof(ItemBox) + 2 * sizeof(std::uint32_t)), what);
  for (const ItemBox& box : boxes) include(bounds_, box);
  tree_.count = count;
  tree_.levels = kernels::box_tree_levels(count);
  double extent = 0.0;
  for (int c = 0; c < 3 && count > 0; ++c) {
    tree_.centre[c] = 0.5 * bounds_.lower[c] + 0.5 * bounds_.upper[c];
    extent = std::max(extent, 0.5 * bounds_.upper[c] - 0.5 * bounds_.lower[c]);
  }
  tree_.scale = extent > 0.0 ? 1.0 / extent : 1.0;
  nodes_.reset(budget, tree_.node_count(), what);
  ids_.reset(budget, count, what);
  tree_.nodes = nodes_.data();
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  Builder(tree_, nodes_.data(), boxes, order).build(0, 0);
  for (std::uint64_t p = 0; p < count; ++p) ids_.data()[p] = ids[order[p]];
}

}  // namespace insitu
