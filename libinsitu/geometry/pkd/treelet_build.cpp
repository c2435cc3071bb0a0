#include "geometry/pkd/treelet_build.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/float_environment.h"
#include "kernels/pkd_margin.h"
#include "kernels/pkd_positions.h"

namespace insitu {
namespace {

using kernels::node_fanout;
using kernels::PkdTree;
using kernels::TreeletNode;
using kernels::TreeletRun;
using kernels::Treelets;

struct Box {
  double lower[3];
  double upper[3];

  static Box none() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  }
  bool is_empty() const { return !(lower[0] <= upper[0]); }
  void include(const Box& other) {
    for (int c = 0; c < 3; ++c) {
      lower[c] = std::min(lower[c], other.lower[c]);
      upper[c] = std::max(upper[c], other.upper[c]);
    }
  }
};

// Calls action(place) for every place of the run that is drawn.
template <class Action>
void each_drawn(const PkdTree& tree, std::uint64_t begin, std::uint64_t end, const Action& action) {
  if (tree.selected.all()) {
    for (std::uint64_t place = begin; place < end; ++place) action(place);
    return;
  }
  for (; begin < end; begin += 64)
    for (std::uint64_t bits = tree.selected.bits(begin, std::min<std::uint64_t>(64, end - begin)); bits != 0;
         bits &= bits - 1)
      action(begin + static_cast<std::uint64_t>(std::countr_zero(bits)));
}

// Of the spheres around the centres, in the coordinates of the tree.
template <class Positions>
Box box_of_run(const PkdTree& tree, const Positions& positions, const TreeletRun& run, double margin) {
  using Key = typename Positions::Key;
  const std::uint64_t end = std::min(run.begin + run.span, tree.count);
  Box box = Box::none();
  if (tree.radius.kind == kernels::RadiusView::Kind::uniform) {
    Key lower[3];
    Key upper[3];
    std::fill_n(lower, 3, std::numeric_limits<Key>::infinity());
    std::fill_n(upper, 3, -std::numeric_limits<Key>::infinity());
    each_drawn(tree, run.begin, end, [&](std::uint64_t place) {
      for (int c = 0; c < 3; ++c) {
        const Key key = positions.key(place, c);
        lower[c] = std::min(lower[c], key);
        upper[c] = std::max(upper[c], key);
      }
    });
    const double wide = tree.radius.uniform + margin;
    for (int c = 0; c < 3; ++c) {
      box.lower[c] = static_cast<double>(lower[c]) - wide;
      box.upper[c] = static_cast<double>(upper[c]) + wide;
    }
    return box;
  }
  each_drawn(tree, run.begin, end, [&](std::uint64_t place) {
    const double wide = tree.radius.value(tree.item(place)) + margin;
    double centre[3];
    positions.centre(place, centre);
    for (int c = 0; c < 3; ++c) {
      box.lower[c] = std::min(box.lower[c], centre[c] - wide);
      box.upper[c] = std::max(box.upper[c], centre[c] + wide);
    }
  });
  return box;
}

float rounded_down(double value) {
  const auto near = static_cast<float>(value);
  return static_cast<double>(near) <= value ? near : std::nextafter(near, -std::numeric_limits<float>::infinity());
}

// Along which axis the halves of the children are farthest apart, level by level: the split axes of the k-d tree, or as
// good as these to say which side comes first.
std::uint8_t axes_of(const Box* children, unsigned bits) {
  unsigned axes = 1u << 6;
  for (unsigned level = 0; level < bits; ++level) {
    const unsigned half = 1u << (bits - 1 - level);
    double apart[3] = {};
    for (unsigned k = 0; k < 1u << bits; ++k) {
      if ((k & half) != 0 || children[k].is_empty() || children[k + half].is_empty()) continue;
      for (int c = 0; c < 3; ++c)
        apart[c] += std::abs(children[k + half].lower[c] + children[k + half].upper[c] - children[k].lower[c] -
                             children[k].upper[c]);
    }
    const auto axis = static_cast<unsigned>(std::max_element(apart, apart + 3) - apart);
    axes |= axis << 2 * (level + 3 - bits);
  }
  return static_cast<std::uint8_t>(axes);
}

// Encodes the boxes of the children, outwards; returns the box around them.
Box encode(const Box* children, unsigned bits, TreeletNode& node) {
  Box around = Box::none();
  for (unsigned k = 0; k < 1u << bits; ++k)
    if (!children[k].is_empty()) around.include(children[k]);
  node.axes = axes_of(children, bits);
  for (int c = 0; c < 3; ++c) {
    std::fill_n(node.lower[c], node_fanout, std::uint8_t{255});
    std::fill_n(node.upper[c], node_fanout, std::uint8_t{0});
    node.origin[c] = around.is_empty() ? 0.0f : rounded_down(around.lower[c]);
    const double from = static_cast<double>(node.origin[c]);
    // The smallest power of two of which 255 reach from end to end. Where there is nothing, near planes have to be
    // behind far ones by more than any rounding.
    int exponent = around.is_empty() ? 40 : -126;
    if (!around.is_empty() && around.upper[c] > from) {
      exponent = std::clamp(std::ilogb((around.upper[c] - from) / 255.0), -126, 126);
      if (std::ldexp(255.0, exponent) < around.upper[c] - from) ++exponent;
    }
    node.exponent[c] = static_cast<std::uint8_t>(exponent + 127);
    const double step = std::ldexp(1.0, exponent);
    for (unsigned k = 0; k < 1u << bits; ++k) {
      if (children[k].is_empty()) continue;
      node.lower[c][k] =
          static_cast<std::uint8_t>(std::clamp(std::floor((children[k].lower[c] - from) / step), 0.0, 255.0));
      node.upper[c][k] =
          static_cast<std::uint8_t>(std::clamp(std::ceil((children[k].upper[c] - from) / step), 0.0, 255.0));
    }
  }
  return around;
}

template <class Positions>
void build(const PkdTree& tree, const Treelets& shape, TreeletNode* nodes) {
  const Positions positions(tree);
  const double margin = kernels::TreeMargin(tree).value;
  const auto for_nodes = [](std::uint64_t count, const auto& body) {
    tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 64), [&](const auto& range) {
      const FloatEnvironment guard;
      for (std::uint64_t node = range.begin(); node < range.end(); ++node) body(node);
    });
  };
  const unsigned last = shape.levels - 1;
  std::vector<Box> boxes(shape.nodes_at(last));
  for_nodes(boxes.size(), [&](std::uint64_t index) {
    const TreeletRun run = shape.run_of_node(last, index);
    const unsigned bits = shape.bits_at(last);
    Box children[node_fanout];
    for (unsigned k = 0; k < 1u << bits; ++k)
      children[k] = box_of_run(tree, positions, child_run(run, bits, k), margin);
    boxes[index] = encode(children, bits, nodes[shape.level_begin[last] + index]);
  });
  for (unsigned level = last; level-- > 0;) {
    std::vector<Box> above(shape.nodes_at(level));
    const unsigned bits = shape.bits_at(level);
    for_nodes(above.size(), [&](std::uint64_t index) {
      above[index] = encode(&boxes[index << bits], bits, nodes[shape.level_begin[level] + index]);
    });
    boxes.swap(above);
  }
}

}  // namespace

Treelets treelet_shape(std::uint64_t particles, unsigned depth) {
  Treelets shape;
  if (depth == 0) return shape;
  shape.levels = (depth + 2) / 3;
  shape.root_bits = depth - 3 * (shape.levels - 1);
  shape.count = std::uint64_t{1} << depth;
  shape.particles = particles;
  for (unsigned level = 1; level < shape.levels; ++level)
    shape.level_begin[level] = shape.level_begin[level - 1] + shape.nodes_at(level - 1);
  return shape;
}

std::uint64_t treelet_bytes(std::uint64_t particles, unsigned depth) {
  return treelet_shape(particles, depth).node_count() * sizeof(TreeletNode);
}

unsigned treelet_depth(std::uint64_t particles, double particles_per_treelet, std::uint64_t most_bytes) {
  unsigned depth = 0;
  while (depth < 3 * Treelets::most_levels && particles >> (depth + 1) != 0 &&
         static_cast<double>(particles >> depth) > particles_per_treelet)
    ++depth;
  while (depth > 0 && treelet_bytes(particles, depth) > most_bytes) --depth;
  return depth;
}

void build_treelets(const PkdTree& tree, const Treelets& shape, TreeletNode* nodes) {
  switch (layout_of(tree)) {
    case kernels::PkdLayout::placed_f32:
      return build<kernels::PlacedPositions<float>>(tree, shape, nodes);
    case kernels::PkdLayout::placed_f64:
      return build<kernels::PlacedPositions<double>>(tree, shape, nodes);
    case kernels::PkdLayout::indexed_f32:
      return build<kernels::IndexedPositions<float>>(tree, shape, nodes);
    case kernels::PkdLayout::indexed_f64:
      return build<kernels::IndexedPositions<double>>(tree, shape, nodes);
    case kernels::PkdLayout::general:
      return build<kernels::GeneralPositions>(tree, shape, nodes);
  }
}

}  // namespace insitu
