#include "paper_tree.h"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>

#include "paper_traverse.h"

namespace bench {
namespace {

using insitu::kernels::PkdBox;

struct Record {
  float x[3];
  std::uint32_t item;
};

// Where a built tree goes.
struct Target {
  TreeLayout layout;
  AxisRule rule;
  float* position;
  std::uint8_t* axes;
  std::uint32_t* items;

  void put(std::uint64_t place, const Record& record, int axis) const {
    std::copy_n(record.x, 3, position + 3 * place);
    axes[place] = static_cast<std::uint8_t>(axis);
    items[place] = record.item;
  }
};

int longest_side(const PkdBox<float>& box) {
  int axis = 0;
  for (int c = 1; c < 3; ++c)
    if (box.upper[c] - box.lower[c] > box.upper[axis] - box.lower[axis]) axis = c;
  return axis;
}

// Recursive median selection. `node` is the place of the root in the heap; in order it is `first` and half the count.
void build(const Target& target, Record* records, std::uint64_t count, std::uint64_t first, std::uint64_t node,
           int cyclic_axis, const PkdBox<float>& box) {
  if (count == 0) return;
  const int axis = target.rule == AxisRule::round_robin ? cyclic_axis : longest_side(box);
  const std::uint64_t left = target.layout == TreeLayout::heap ? left_subtree_size(count) : count / 2;
  if (box.is_point()) {
    // Of particles at one point the smallest item stands first, as the library's traversal expects.
    std::sort(records, records + count, [](const Record& a, const Record& b) { return a.item < b.item; });
  } else {
    std::nth_element(records, records + left, records + count,
                     [axis](const Record& a, const Record& b) { return a.x[axis] < b.x[axis]; });
  }
  target.put(target.layout == TreeLayout::heap ? node : first + left, records[left], axis);
  PkdBox<float> below = box;
  PkdBox<float> above = box;
  below.upper[axis] = above.lower[axis] = records[left].x[axis];
  const int next_axis = cyclic_axis == 2 ? 0 : cyclic_axis + 1;
  const auto build_below = [&] { build(target, records, left, first, 2 * node + 1, next_axis, below); };
  const auto build_above = [&] {
    build(target, records + left + 1, count - left - 1, first + left + 1, 2 * node + 2, next_axis, above);
  };
  constexpr std::uint64_t fewest_for_a_task = 1 << 14;
  if (count < fewest_for_a_task) {
    build_below();
    build_above();
  } else {
    tbb::parallel_invoke(build_below, build_above);
  }
}

}  // namespace

std::uint64_t left_subtree_size(std::uint64_t count) {
  if (count <= 1) return 0;
  const auto levels = static_cast<int>(std::bit_width(count)) - 1;  // full ones, that of the root included
  const std::uint64_t full = (std::uint64_t{1} << levels) - 1;
  const std::uint64_t half_of_last = std::uint64_t{1} << (levels - 1);
  return full / 2 + std::min(count - full, half_of_last);
}

PaperTree::PaperTree(const std::vector<float>& position, double radius, TreeLayout layout, AxisRule rule, Items items)
    : layout_(layout),
      rule_(rule),
      position_(position.size()),
      axes_(position.size() / 3),
      items_(position.size() / 3) {
  const std::uint64_t count = axes_.size();
  std::vector<Record> records(count);
  PkdBox<float> box = {};
  for (std::uint64_t i = 0; i < count; ++i) {
    for (std::uint64_t c = 0; c < 3; ++c) {
      const float x = records[i].x[c] = position[3 * i + c];
      box.lower[c] = i == 0 ? x : std::min(box.lower[c], x);
      box.upper[c] = i == 0 ? x : std::max(box.upper[c], x);
    }
    records[i].item = static_cast<std::uint32_t>(i);
  }
  build({layout, rule, position_.data(), axes_.data(), items_.data()}, records.data(), count, 0, 0, 0, box);

  insitu::kernels::ArrayView& view = tree_.position;
  view.type = insitu::kernels::Scalar::f32;
  view.components = 3;
  view.count = tree_.count = count;
  view.stride = 3 * sizeof(float);
  for (std::uint32_t c = 0; c < 3; ++c) {
    view.base[c] = reinterpret_cast<const std::byte*>(position_.data() + c);
    tree_.lower[c] = static_cast<double>(box.lower[c]);
    tree_.upper[c] = static_cast<double>(box.upper[c]);
  }
  tree_.radius.uniform = tree_.radius_max = radius;
  if (items == Items::by_index) {
    tree_.index32 = items_.data();
  } else {
    items_ = {};
  }
}

void PaperTree::first_hits(RayWay way, const insitu::kernels::Ray* rays, insitu::kernels::Hit* hits,
                           std::size_t count) const {
  paper_first_hits({tree_, axes_.data(), layout_, rule_, way}, rays, hits, count);
}

void PaperTree::any_hits(RayWay way, const insitu::kernels::Ray* rays, std::uint8_t* occluded,
                         std::size_t count) const {
  paper_any_hits({tree_, axes_.data(), layout_, rule_, way}, rays, occluded, count);
}

void PaperTree::library_first_hits(const insitu::kernels::Ray* rays, insitu::kernels::Hit* hits,
                                   std::size_t count) const {
  round_robin_first_hits(tree_, rays, hits, count);
}

void PaperTree::library_any_hits(const insitu::kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const {
  round_robin_any_hits(tree_, rays, occluded, count);
}

}  // namespace bench
