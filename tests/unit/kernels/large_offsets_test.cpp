// Trees of more than 2^32 particles, of which all but a few thousand stand in pages that were never written: places,
// items and byte offsets on both sides of 2^32, against the brute force over those few thousand.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "geometry/pkd/treelet_build.h"
#include "kernels/pkd_reference.h"
#include "kernels/pkd_traverse.h"
#include "kernels/treelet_traverse.h"
#include "unit/kernels/counter_random.h"
#include "unit/kernels/huge_memory.h"
#include "unit/kernels/simd_guard.h"

namespace insitu::testing {
namespace {

using kernels::Hit;
using kernels::PkdTree;
using kernels::Ray;
using kernels::Scalar;
using kernels::Span;
using kernels::TreeletNode;
using kernels::TreeletRun;

constexpr std::uint64_t two_to_32 = std::uint64_t{1} << 32;
constexpr std::uint64_t window_size = 4000;

enum class Kind { records_f32, records_f64, strided_f32, columns_f32, records_i32, index32, index64 };

struct HugeCase {
  const char* name;
  Kind kind;
  bool each_radius;  // an array of radii instead of one for all
  bool thin;         // radii too small for f32 tests of the whole tree
};
std::ostream& operator<<(std::ostream& out, const HugeCase& c) { return out << c.name; }

// Particles sorted along x, which is the order of a tree for any number of them: at zero up to the window, which begins
// at `begin`; within it from 100 to 200, and so near the axis that x is the longest side down to the leaves. The window
// ends with the tree.
class HugeTree {
 public:
  explicit HugeTree(const HugeCase& c)
      : kind_(c.kind),
        is_indexed_(c.kind == Kind::index32 || c.kind == Kind::index64),
        begin_(c.kind == Kind::index32 ? two_to_32 - window_size : two_to_32 - window_size / 2),
        unit_(c.kind == Kind::records_i32 ? 1e4 : 1.0) {
    const std::uint64_t count = begin_ + window_size;
    kernels::ArrayView& view = tree_.position;
    view.type = c.kind == Kind::records_f64 ? Scalar::f64 : c.kind == Kind::records_i32 ? Scalar::i32 : Scalar::f32;
    const std::size_t size = kernels::size_of(view.type);
    const bool columns = c.kind == Kind::columns_f32;
    view.stride = static_cast<std::ptrdiff_t>(c.kind == Kind::strided_f32 ? 20 : columns ? size : 3 * size);
    view.components = 3;
    view.count = tree_.count = count;
    const std::uint64_t bytes = count * static_cast<std::uint64_t>(view.stride);
    for (std::uint32_t axis = 0; axis < (columns ? 3u : 1u); ++axis) allocate(bytes);
    std::byte* const index = is_indexed_ ? allocate(count * (c.kind == Kind::index32 ? 4 : 8)) : nullptr;
    std::byte* const radii = c.each_radius ? allocate(count * sizeof(float)) : nullptr;
    treelets_ = treelet_shape(count, 28);
    std::byte* const nodes = allocate(treelets_.node_count() * sizeof(TreeletNode));
    for (const auto& memory : memory_)
      if (!memory->exists()) return;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
      view.base[axis] = columns ? memory_[axis]->data() : memory_[0]->data() + axis * size;

    radius_ = (c.thin ? 2e-4 : 0.05) * unit_;
    tree_.radius_max = tree_.radius.uniform = radius_;
    if (c.each_radius) {
      tree_.radius.kind = kernels::RadiusView::Kind::per_item;
      tree_.radius.array.base[0] = radii;
      tree_.radius.array.stride = sizeof(float);
      tree_.radius.array.count = count;
      tree_.radius.array.components = 1;
    }
    if (is_indexed_) tree_.position_by_place = false;
    if (c.kind == Kind::index32) tree_.index32 = reinterpret_cast<const std::uint32_t*>(index);
    if (c.kind == Kind::index64) tree_.index64 = reinterpret_cast<const std::uint64_t*>(index);
    CounterRandom random(7);
    for (std::uint64_t i = 0; i < window_size; ++i) {
      // Through an index the items of the window run backwards.
      const std::uint64_t place = begin_ + i;
      const std::uint64_t item = is_indexed_ ? count - 1 - i : place;
      if (c.kind == Kind::index32) reinterpret_cast<std::uint32_t*>(index)[place] = static_cast<std::uint32_t>(item);
      if (c.kind == Kind::index64) reinterpret_cast<std::uint64_t*>(index)[place] = item;
      if (c.each_radius)
        reinterpret_cast<float*>(radii)[item] = static_cast<float>(radius_ * random.between(0.3, 0.999));
      const double x[3] = {100.0 + 100.0 * static_cast<double>(i + 1) / static_cast<double>(window_size),
                           random.between(-0.05, 0.05), random.between(-0.05, 0.05)};
      for (std::uint32_t axis = 0; axis < 3; ++axis) store(view, item, axis, x[axis] * unit_);
    }
    for (int axis = 0; axis < 3; ++axis) {
      tree_.lower[axis] = axis == 0 ? 0.0 : -0.05 * unit_;
      tree_.upper[axis] = (axis == 0 ? 200.0 : 0.05) * unit_;
    }
    treelets_.nodes = reinterpret_cast<const TreeletNode*>(nodes);
    fill_nodes(reinterpret_cast<TreeletNode*>(nodes), 0, 0, treelets_.root());
    exists_ = true;
  }

  bool exists() const { return exists_; }
  const PkdTree& tree() const { return tree_; }
  const kernels::Treelets& treelets() const { return treelets_; }
  double unit() const { return unit_; }
  double radius() const { return radius_; }
  std::uint64_t begin() const { return begin_; }

  // The particles of the window alone; without an index they are items from 0 on.
  PkdTree window() const {
    PkdTree window = tree_;
    window.count = window_size;
    if (kind_ == Kind::index32) window.index32 += begin_;
    if (kind_ == Kind::index64) window.index64 += begin_;
    if (is_indexed_) return window;
    for (const std::byte*& base : window.position.base)
      if (base != nullptr) base += static_cast<std::ptrdiff_t>(begin_) * window.position.stride;
    window.position.count = window_size;
    if (tree_.radius.array.base[0] != nullptr) window.radius.array.base[0] += begin_ * sizeof(float);
    return window;
  }
  std::uint64_t first_item() const { return is_indexed_ ? 0 : begin_; }

 private:
  std::byte* allocate(std::uint64_t bytes) {
    memory_.push_back(std::make_unique<HugeMemory>(bytes));
    return memory_.back()->data();
  }

  static void store(const kernels::ArrayView& view, std::uint64_t item, std::uint32_t axis, double value) {
    const auto put = [&](auto scalar) {
      std::memcpy(const_cast<std::byte*>(view.base[axis]) + static_cast<std::ptrdiff_t>(item) * view.stride, &scalar,
                  sizeof scalar);
    };
    if (view.type == Scalar::f64) return put(value);
    if (view.type == Scalar::i32) return put(static_cast<std::int32_t>(std::floor(value)));
    put(static_cast<float>(value));
  }

  // Nodes on the way to the window get boxes around all of it; all others stay zero and are never met.
  void fill_nodes(TreeletNode* nodes, unsigned level, std::uint64_t number, const TreeletRun& run) {
    TreeletNode& node = nodes[treelets_.level_begin[level] + number];
    const unsigned bits = treelets_.bits_at(level);
    node.axes = 1u << 6;
    for (int axis = 0; axis < 3; ++axis) {
      node.origin[axis] = static_cast<float>((axis == 0 ? 99.0 : -60.0) * unit_);
      node.exponent[axis] = static_cast<std::uint8_t>(127 + std::ilogb(unit_));  // 255 steps of more than half a unit
    }
    for (unsigned k = 0; k < kernels::node_fanout; ++k) {
      const bool is_child = k < 1u << bits;
      const TreeletRun child = is_child ? child_run(run, bits, k) : TreeletRun{0, 0};
      const bool is_met = is_child && child.begin + child.span > begin_;
      for (int axis = 0; axis < 3; ++axis) {
        node.lower[axis][k] = is_met ? 0 : 255;
        node.upper[axis][k] = is_met ? 255 : 0;
      }
      if (is_met && level + 1 < treelets_.levels) fill_nodes(nodes, level + 1, (number << bits) + k, child);
    }
  }

  Kind kind_;
  bool is_indexed_;
  std::uint64_t begin_;
  double unit_;
  double radius_ = 0.0;
  bool exists_ = false;
  PkdTree tree_;
  kernels::Treelets treelets_;
  std::vector<std::unique_ptr<HugeMemory>> memory_;
};

// Bundles of 16 that go nearly the same way, at particles of the window: across, and along x both ways. None gets as
// near to zero as half way.
std::vector<Ray> make_rays(const HugeTree& huge) {
  CounterRandom random(8);
  const PkdTree window = huge.window();
  std::vector<Ray> rays;
  for (int bundle = 0; bundle < 30; ++bundle) {
    double ahead[3] = {bundle % 3 == 1 ? 1.0 : -1.0, 0.0, 0.0};
    if (bundle % 3 == 0) random.direction(ahead);
    const std::uint64_t middle = random.below(window.count - 64);
    for (int i = 0; i < 16; ++i) {
      const std::uint64_t place = middle + random.below(64);
      double aim[3];
      window.centre(place, aim);
      Ray ray{};
      double length = 0.0;
      for (int c = 0; c < 3; ++c) {
        ray.direction[c] = ahead[c] + 1e-3 * random.between(-1.0, 1.0);
        length += ray.direction[c] * ray.direction[c];
      }
      const double distance = huge.unit() * random.between(0.5, 30.0);
      for (int c = 0; c < 3; ++c) {
        ray.direction[c] /= std::sqrt(length);
        ray.origin[c] = aim[c] + 0.7 * huge.radius() * random.between(-1.0, 1.0) - distance * ray.direction[c];
      }
      if (ray.direction[0] < 0.0) ray.t_max = (60.0 * huge.unit() - ray.origin[0]) / ray.direction[0];
      if (i % 5 == 0 && bundle % 2 == 0) ray.exclude = window.item(place) + huge.first_item();
      rays.push_back(ray);
    }
  }
  return rays;
}

bool is_same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

class HugeTrees : public ::testing::TestWithParam<HugeCase> {};

TEST_P(HugeTrees, AreTracedOnBothSidesOf32Bits) {
  const HugeTree huge(GetParam());
  if (!huge.exists()) GTEST_SKIP() << no_address_space;
  const std::vector<Ray> rays = make_rays(huge);
  const PkdTree window = huge.window();
  std::vector<Hit> expected;
  std::vector<std::vector<Span>> expected_spans;
  std::size_t hits_below = 0;
  std::size_t hits_above = 0;
  const auto by_item = [](const Span& a, const Span& b) { return a.item < b.item; };
  for (Ray ray : rays) {
    if (ray.exclude != kernels::no_item) ray.exclude -= huge.first_item();
    expected.push_back(kernels::reference_first_hit(window, ray));
    expected_spans.push_back(kernels::reference_all_hits(window, ray));
    for (Span& span : expected_spans.back()) span.item += huge.first_item();
    std::sort(expected_spans.back().begin(), expected_spans.back().end(), by_item);
    if (!expected.back().found()) continue;
    expected.back().item += huge.first_item();
    ++(expected.back().item < two_to_32 ? hits_below : hits_above);
  }
  EXPECT_GT(hits_below, rays.size() / 10);
  // An index of 32 bits ends where 2^32 begins.
  EXPECT_GE(hits_above, GetParam().kind == Kind::index32 ? 0 : rays.size() / 10);

  for_each_simd_target([&](const char* target) {
    const auto check = [&](const char* what, const auto& first_hits, const auto& any_hits) {
      std::vector<Hit> hits(rays.size());
      std::vector<std::uint8_t> occluded(rays.size(), 0);
      first_hits(hits.data());
      any_hits(occluded.data());
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < rays.size(); ++i)
        wrong += is_same(hits[i].t, expected[i].t) && hits[i].item == expected[i].item &&
                         (occluded[i] != 0) == expected[i].found()
                     ? 0
                     : 1;
      EXPECT_EQ(wrong, 0u) << what << ", " << target;
    };
    check(
        "tree", [&](Hit* hits) { kernels::pkd_first_hits(huge.tree(), rays.data(), hits, rays.size()); },
        [&](std::uint8_t* occluded) { kernels::pkd_any_hits(huge.tree(), rays.data(), occluded, rays.size()); });
    check(
        "treelets",
        [&](Hit* hits) { kernels::treelet_first_hits(huge.tree(), huge.treelets(), rays.data(), hits, rays.size()); },
        [&](std::uint8_t* occluded) {
          kernels::treelet_any_hits(huge.tree(), huge.treelets(), rays.data(), occluded, rays.size());
        });
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); i += 7) {
      std::vector<Span> spans;
      kernels::pkd_all_hits(huge.tree(), rays[i], spans);
      std::sort(spans.begin(), spans.end(), by_item);
      wrong += std::equal(spans.begin(), spans.end(), expected_spans[i].begin(), expected_spans[i].end(),
                          [](const Span& a, const Span& b) {
                            return a.item == b.item && is_same(a.t_enter, b.t_enter) && is_same(a.t_leave, b.t_leave);
                          })
                   ? 0
                   : 1;
    }
    EXPECT_EQ(wrong, 0u) << "all hits, " << target;
  });
}

INSTANTIATE_TEST_SUITE_P(Kinds, HugeTrees,
                         ::testing::Values(HugeCase{"records_f32", Kind::records_f32, false, false},
                                           HugeCase{"records_f32_each_radius", Kind::records_f32, true, false},
                                           HugeCase{"records_f32_thin", Kind::records_f32, false, true},
                                           HugeCase{"records_f64", Kind::records_f64, false, false},
                                           HugeCase{"records_f64_thin", Kind::records_f64, false, true},
                                           HugeCase{"strided_f32", Kind::strided_f32, true, false},
                                           HugeCase{"columns_f32", Kind::columns_f32, false, false},
                                           HugeCase{"records_i32", Kind::records_i32, false, false},
                                           HugeCase{"index32_full", Kind::index32, true, false},
                                           HugeCase{"index64", Kind::index64, false, false},
                                           HugeCase{"index64_each_radius", Kind::index64, true, false}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace insitu::testing
