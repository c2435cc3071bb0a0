// Splits of ranges that lie on both sides of place 2^32, and views of arrays of more than 4 GB, in memory of which only
// a few pages exist.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <vector>

#include "core/workers.h"
#include "geometry/array_view.h"
#include "geometry/pkd/pkd_split.h"
#include "unit/kernels/counter_random.h"
#include "unit/kernels/huge_memory.h"

namespace insitu::testing {
namespace {

using kernels::PkdTree;
using kernels::PlaceRange;

constexpr std::uint64_t two_to_32 = std::uint64_t{1} << 32;
// More than one chunk of the parallel split (pkd_split.h) on either side.
constexpr PlaceRange range = {two_to_32 - 100000, two_to_32 + 100001};
constexpr std::uint64_t range_size = range.end - range.begin;

struct Point {
  float x[3];
  bool operator==(const Point&) const = default;
};

// Positions of the range, each with its number in it, in memory as a tree over `range.end` particles has them.
struct HugePositions {
  HugePositions() : memory(range.end * sizeof(Point)) {
    if (!memory.exists()) return;
    CounterRandom random(3);
    points.resize(range_size);
    for (Point& point : points)
      for (float& x : point.x) x = static_cast<float>(random.between(0.0, 1.0));
    std::copy(points.begin(), points.end(), placed());
    tree.position.type = kernels::Scalar::f32;
    tree.position.components = 3;
    tree.position.count = tree.count = range.end;
    tree.position.stride = sizeof(Point);
    for (std::uint32_t c = 0; c < 3; ++c) tree.position.base[c] = memory.data() + c * sizeof(float);
  }
  Point* placed() const { return memory.as<Point>() + range.begin; }

  HugeMemory memory;
  std::vector<Point> points;
  PkdTree tree;
};

// `number_at(place)`: which of the points stands there. Splits off centre, then turns 1000 items beyond 2^32 by one.
template <class Store, class NumberAt>
void check_split(const HugePositions& huge, Store store, const NumberAt& number_at) {
  for (const std::uint64_t mid : {range.begin + range_size / 2, range.end - 20000}) {
    constexpr int axis = 1;
    std::vector<float> keys;
    for (const Point& point : huge.points) keys.push_back(point.x[axis]);
    const auto nth = keys.begin() + static_cast<std::ptrdiff_t>(mid - range.begin);
    std::nth_element(keys.begin(), nth, keys.end());
    Workers workers(2);
    std::atomic<std::uint64_t> moved{0};
    EXPECT_EQ(static_cast<float>(workers.run([&] { return split_range(store, range, mid, axis, moved); })), *nth);
    std::size_t wrong = 0;
    std::vector<bool> is_seen(range_size, false);
    for (std::uint64_t place = range.begin; place < range.end; ++place) {
      const std::uint64_t number = number_at(place);
      ASSERT_LT(number, range_size);
      ASSERT_FALSE(is_seen[number]);
      is_seen[number] = true;
      const float key = huge.points[number].x[axis];
      wrong += static_cast<float>(store.key(place, axis)) != key ? 1 : 0;
      wrong += (place < mid && key > *nth) || (place == mid && key != *nth) || (place > mid && key < *nth) ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0u);
  }

  constexpr std::uint64_t begin = two_to_32 + 7;
  constexpr std::size_t count = 1000;
  using Key = typename Store::Key;
  std::vector<std::uint64_t> before;
  std::vector<PkdItem<Key>> items(count);
  for (std::size_t i = 0; i < count; ++i) {
    before.push_back(number_at(begin + i));
    items[i].local = static_cast<ListedPlace<Key>>((i + 1) % count);
    for (int axis = 0; axis < 3; ++axis) items[i].x[axis] = store.key(begin + (i + 1) % count, axis);
  }
  std::vector<std::byte> scratch(count * std::max<std::size_t>(Store::bytes_per_item(), 1));
  store.apply(begin, items.data(), count, scratch.data());
  for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(number_at(begin + i), before[(i + 1) % count]);
}

TEST(LargeOffsets, IndicesOf64BitsAreSplit) {
  HugePositions huge;
  const HugeMemory index(range.end * sizeof(std::uint64_t));
  if (!huge.memory.exists() || !index.exists()) GTEST_SKIP() << no_address_space;
  auto* const items = index.as<std::uint64_t>();
  std::iota(items + range.begin, items + range.end, range.begin);
  huge.tree.index64 = items;
  huge.tree.position_by_place = false;
  check_split(huge, IndexStore<kernels::GeneralPositions, std::uint64_t>(huge.tree, items),
              [&](std::uint64_t place) { return items[place] - range.begin; });
}

// Without an index: who stands at a place is what its coordinates say.
TEST(LargeOffsets, PackedRecordsAreSplit) {
  const HugePositions huge;
  if (!huge.memory.exists()) GTEST_SKIP() << no_address_space;
  std::vector<std::uint64_t> by_x(range_size);
  std::iota(by_x.begin(), by_x.end(), 0);
  const auto before = [](const Point& a, const Point& b) {
    return std::lexicographical_compare(a.x, a.x + 3, b.x, b.x + 3);
  };
  std::sort(by_x.begin(), by_x.end(),
            [&](std::uint64_t a, std::uint64_t b) { return before(huge.points[a], huge.points[b]); });
  check_split(huge, PackedStore<float>(huge.tree, huge.memory.as<PkdRecord<float>>()), [&](std::uint64_t place) {
    const Point& point = huge.memory.as<Point>()[place];
    const auto at = std::lower_bound(by_x.begin(), by_x.end(), point,
                                     [&](std::uint64_t a, const Point& p) { return before(huge.points[a], p); });
    return at != by_x.end() && huge.points[*at] == point ? *at : range_size;
  });
}

TEST(LargeOffsets, ColumnsAreSplitTogether) {
  const HugePositions huge;
  const HugeMemory numbers(range.end * sizeof(std::uint32_t));
  if (!huge.memory.exists() || !numbers.exists()) GTEST_SKIP() << no_address_space;
  auto* const number = numbers.as<std::uint32_t>();
  std::iota(number + range.begin, number + range.end, 0u);
  const std::vector<MovedColumn> columns = {{huge.memory.data(), sizeof(Point), sizeof(Point), false},
                                            {numbers.data(), sizeof(std::uint32_t), sizeof(std::uint32_t), false}};
  check_split(huge, ColumnsStore<kernels::PlacedPositions<float>>(huge.tree, columns),
              [&](std::uint64_t place) { return std::uint64_t{number[place]}; });
}

insitu_array make_array(void* first, std::uint64_t count, std::int64_t stride) {
  insitu_array array = {};
  array.struct_size = sizeof array;
  array.type = INSITU_F32;
  array.count = count;
  array.components = 3;
  array.component[0] = first;
  array.stride_bytes = stride;
  array.flags = INSITU_ARRAY_PERMUTABLE;
  return array;
}

TEST(LargeOffsets, ViewsReachEveryItem) {
  constexpr std::uint64_t count = two_to_32 + 1000;
  const HugeMemory memory(count * sizeof(Point));
  if (!memory.exists()) GTEST_SKIP() << no_address_space;
  auto* const points = memory.as<Point>();
  const std::vector<std::uint64_t> written = {0, 1, two_to_32 / sizeof(Point), two_to_32 - 1, two_to_32, count - 1};
  for (const std::uint64_t place : written)
    for (std::uint64_t c = 0; c < 3; ++c) points[place].x[c] = static_cast<float>(place % 1000 + 10 * c + 1);
  for (const bool backwards : {false, true}) {
    const auto step = static_cast<std::int64_t>(sizeof(Point));
    const insitu_array array = make_array(points + (backwards ? count - 1 : 0), count, backwards ? -step : step);
    const ArrayVerdict verdict = judge_array(array, INSITU_USE_POSITION);
    EXPECT_EQ(verdict.status, INSITU_OK) << verdict.reason;
    EXPECT_EQ(verdict.borrowed_bytes, count * sizeof(Point));
    const kernels::ArrayView view = checked_view(array, INSITU_USE_POSITION, "position");
    ASSERT_EQ(view.count, count);
    ColumnSet columns;
    columns.add(view, "position");
    ASSERT_EQ(columns.columns().size(), 1u);
    for (const std::uint64_t place : written) {
      const std::uint64_t item = backwards ? count - 1 - place : place;
      for (std::uint32_t c = 0; c < 3; ++c)
        EXPECT_EQ(view.value(item, c), static_cast<double>(place % 1000 + 10 * c + 1)) << place;
      EXPECT_EQ(columns.columns()[0].at(item), reinterpret_cast<std::byte*>(points + place)) << place;
    }
  }
}

TEST(LargeOffsets, MoreThanAnyMemoryIsRefused) {
  float x[3] = {};
  for (const std::uint64_t count : {std::uint64_t{1} << 60, ~std::uint64_t{0}, ~std::uint64_t{0} / 12 + 2}) {
    const ArrayVerdict verdict = judge_array(make_array(x, count, 0), INSITU_USE_POSITION);
    EXPECT_EQ(verdict.status, INSITU_ERROR_INVALID_ARGUMENT) << count;
  }
}

}  // namespace
}  // namespace insitu::testing
