// The kernels of the build against their plain references, on every SIMD target and every length around a vector.
#include "kernels/pkd_partition.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "kernels/pkd_partition_reference.h"
#include "unit/kernels/key_patterns.h"
#include "unit/kernels/simd_guard.h"

namespace insitu::testing {
namespace {

using kernels::KeyRun;
using kernels::ListedPlace;
using kernels::PkdItem;
using kernels::Relation;

template <class Key>
class Partition : public ::testing::Test {};
using Keys = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Partition, Keys);

// Records with exactly the memory they need, unless padded: a read behind them is a fault under AddressSanitizer.
template <class Key>
struct Run {
  std::vector<Key> memory;
  KeyRun<Key> run;

  Run(Pattern pattern, std::size_t count, int components, bool may_be_padded, std::uint64_t seed) {
    CounterRandom random(seed);
    const bool padded = may_be_padded || components == 4;
    const auto step = static_cast<std::size_t>(components);
    memory.resize(count * step + (padded ? kernels::run_padding : 0), std::numeric_limits<Key>::quiet_NaN());
    const std::size_t axis = seed % step;
    for (std::size_t i = 0; i < count * step; ++i)
      memory[i] = static_cast<Key>(i % step == axis ? value_of(pattern, i / step, count, random) : random.unit());
    run = components == 3 ? KeyRun<Key>{memory.data(), 3, padded, static_cast<int>(axis)}
                          : KeyRun<Key>{memory.data() + axis, components, padded};
  }
};

constexpr std::size_t lengths[] = {0,  1,  2,  3,  4,  5,  7,  8,  9,   15,  16,  17,
                                   18, 31, 32, 33, 47, 48, 49, 64, 100, 256, 1000};

TYPED_TEST(Partition, ListsAreThoseOfTheReference) {
  using Key = TypeParam;
  for_each_simd_target([](const char* target) {
    std::uint64_t seed = 0;
    for (const std::size_t count : lengths)
      for (const Pattern pattern : all_patterns)
        for (const int components : {1, 3, 4}) {
          ++seed;
          const Run<Key> of(pattern, count, components, seed % 2 == 0, seed);
          const Key pivot = count == 0 ? Key{0} : kernels::key_of_run(of.run, seed % count);
          for (const Relation relation :
               {Relation::less, Relation::not_greater, Relation::greater, Relation::not_less}) {
            std::vector<ListedPlace<Key>> places(count + kernels::list_slack);
            places.resize(kernels::list_places(of.run, count, relation, pivot, places.data()));
            ASSERT_EQ(places, kernels::reference_list_places(of.run, count, relation, pivot)) << target << count;
          }
          const Key other = count == 0 ? Key{0} : kernels::key_of_run(of.run, (7 * seed) % count);
          const Key low = std::min(pivot, other);
          const Key high = seed % 5 == 0 ? std::numeric_limits<Key>::infinity() : std::max(pivot, other);
          std::vector<Key> keys(count + kernels::list_slack);
          std::vector<ListedPlace<Key>> places(count + kernels::list_slack);
          const kernels::BandCount found =
              kernels::list_band(of.run, count, low, high, 1000, keys.data(), places.data());
          std::vector<Key> expected_keys;
          std::vector<ListedPlace<Key>> expected_places;
          const kernels::BandCount expected =
              kernels::reference_list_band<Key>(of.run, count, low, high, 1000, expected_keys, expected_places);
          ASSERT_EQ(found.below, expected.below) << target << count;
          keys.resize(found.inside);
          places.resize(found.inside);
          ASSERT_EQ(keys, expected_keys) << target << count;
          ASSERT_EQ(places, expected_places) << target << count;
        }
  });
}

TYPED_TEST(Partition, SelectsTheRankOfALists) {
  using Key = TypeParam;
  for_each_simd_target([](const char* target) {
    std::uint64_t seed = 0;
    for (const std::size_t count : {1u, 2u, 16u, 31u, 32u, 33u, 34u, 64u, 100u, 999u, 1000u, 5000u})
      for (const Pattern pattern : all_patterns)
        for (const std::size_t rank : {std::size_t{0}, count / 7, count / 2, count - 1}) {
          const Run<Key> of(pattern, count, 1, false, ++seed);
          std::vector<Key> sorted = of.memory;
          std::sort(sorted.begin(), sorted.end());
          std::vector<Key> keys = of.memory;
          keys.resize(count + kernels::list_slack);
          std::vector<ListedPlace<Key>> places(count + kernels::list_slack);
          std::iota(places.begin(), places.end(), ListedPlace<Key>{0});
          const auto found = kernels::select_listed(keys.data(), places.data(), count, rank);
          ASSERT_EQ(found.key, sorted[rank]) << target << " rank " << rank << " of " << count;
          ASSERT_EQ(of.memory.at(found.place), found.key) << target << " rank " << rank << " of " << count;
        }
  });
}

TYPED_TEST(Partition, BoundsAreExact) {
  using Key = TypeParam;
  for_each_simd_target([](const char* target) {
    for (const std::size_t count : lengths) {
      CounterRandom random(count);
      std::vector<Key> x(3 * count);
      for (Key& v : x) v = static_cast<Key>(random.sign() * random.magnitude(-30.0, 30.0));
      Key found[6];
      Key expected[6];
      ASSERT_TRUE(kernels::bounds_of_records(x.data(), count, found, found + 3));
      ASSERT_TRUE(kernels::reference_bounds_of_records(x.data(), count, expected, expected + 3));
      for (int i = 0; i < 6; ++i) ASSERT_EQ(found[i], expected[i]) << target << " " << count;
      kernels::bounds_of_finite_records(x.data(), count, found, found + 3);
      for (int i = 0; i < 6; ++i) ASSERT_EQ(found[i], expected[i]) << target << " " << count;
      for (const Key bad : {std::numeric_limits<Key>::quiet_NaN(), std::numeric_limits<Key>::infinity(),
                            -std::numeric_limits<Key>::infinity()})
        for (std::size_t at = 0; at < std::min<std::size_t>(x.size(), 150); ++at) {
          const Key before = std::exchange(x[at], bad);
          ASSERT_FALSE(kernels::bounds_of_records(x.data(), count, found, found + 3)) << target << " " << at;
          x[at] = before;
        }
    }
  });
}

// The rules of pkd_tree.h. Split planes are exact medians: without equal coordinates both orders have the same ones.
template <class Key>
void expect_order(const std::vector<PkdItem<Key>>& a, const std::vector<PkdItem<Key>>& b, bool same_planes,
                  std::size_t begin, std::size_t end, kernels::PkdBox<Key> box) {
  if (end - begin <= kernels::pkd_leaf_size || box.is_point()) return;
  const std::size_t mid = begin + (end - begin) / 2;
  const int axis = box.split_axis();
  if (same_planes) {
    ASSERT_EQ(a[mid].x[axis], b[mid].x[axis]) << mid;
  }
  for (std::size_t i = begin; i < mid; ++i) ASSERT_LE(a[i].x[axis], a[mid].x[axis]);
  for (std::size_t i = mid; i < end; ++i) ASSERT_GE(a[i].x[axis], a[mid].x[axis]);
  kernels::PkdBox<Key> left = box;
  left.upper[axis] = box.lower[axis] = a[mid].x[axis];
  expect_order(a, b, same_planes, begin, mid, left);
  expect_order(a, b, same_planes, mid + 1, end, box);
}

TYPED_TEST(Partition, OrdersBlocksLikeTheReference) {
  using Key = TypeParam;
  for_each_simd_target([](const char* target) {
    std::uint64_t seed = 0;
    for (const std::size_t count : {1u, 32u, 33u, 34u, 64u, 65u, 66u, 67u, 100u, 129u, 500u, 1000u, 3000u, 20000u})
      for (const Pattern pattern : all_patterns) {
        CounterRandom random(++seed);
        std::vector<PkdItem<Key>> items(count + kernels::run_padding / 4);
        kernels::PkdBox<Key> box;
        for (int c = 0; c < 3; ++c) {
          for (std::size_t i = 0; i < count; ++i)
            items[i].x[c] =
                static_cast<Key>(value_of(c == 1 && seed % 3 != 0 ? Pattern::random : pattern, i, count, random));
          const auto [low, high] =
              std::minmax_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(count),
                                  [c](const auto& a, const auto& b) { return a.x[c] < b.x[c]; });
          box.lower[c] = low->x[c];
          box.upper[c] = high->x[c];
        }
        for (std::size_t i = 0; i < count; ++i) items[i].local = static_cast<ListedPlace<Key>>(i);
        const std::vector<PkdItem<Key>> before = items;
        std::vector<PkdItem<Key>> expected = items;
        std::vector<Key> keys(count + kernels::list_slack);
        std::vector<ListedPlace<Key>> places(count + kernels::list_slack);
        const kernels::OrderScratch<Key> scratch = {
            keys.data(), places.data(), [](const void*, std::uint64_t a, std::uint64_t b) { return a > b; }, nullptr};
        kernels::order_items(items.data(), count, box, scratch);
        kernels::reference_order_items(expected.data(), count, box, scratch);
        SCOPED_TRACE(std::string(target) + ", " + std::to_string(count) + " items, pattern " +
                     std::to_string(static_cast<int>(pattern)));
        const bool distinct = pattern == Pattern::sorted || pattern == Pattern::reversed || pattern == Pattern::random;
        expect_order(items, expected, distinct, 0, count, box);
        if (box.is_point() && count > kernels::pkd_leaf_size) {
          ASSERT_EQ(items[0].local, count - 1);
        }
        std::vector<bool> seen(count, false);
        for (std::size_t i = 0; i < count; ++i) {
          const std::size_t who = static_cast<std::size_t>(items[i].local);
          ASSERT_LT(who, count);
          ASSERT_FALSE(seen[who]);
          seen[who] = true;
          for (int c = 0; c < 3; ++c) ASSERT_EQ(items[i].x[c], before[who].x[c]);
        }
        // What is in order stays as it is.
        const std::vector<PkdItem<Key>> once = items;
        kernels::order_items(items.data(), count, box, scratch);
        for (std::size_t i = 0; i < count && pattern == Pattern::random; ++i) ASSERT_EQ(items[i].local, once[i].local);
        if (::testing::Test::HasFatalFailure()) return;
      }
  });
}

}  // namespace
}  // namespace insitu::testing
