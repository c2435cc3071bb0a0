// Splitting large ranges: the median is exact, the sides are right, records stay whole, and reading is enough.
#include "geometry/pkd/pkd_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>

#include "core/workers.h"
#include "unit/kernels/key_patterns.h"

namespace insitu::testing {
namespace {

struct Record {
  float x[3];
  std::uint32_t id;
};

// Counts the keys that are read, and the pairs that move.
class CountingStore {
 public:
  using Key = float;
  using Place = std::uint32_t;
  explicit CountingStore(std::vector<Record>& records) : records_(records) {}

  KeyRun<float> keys(std::uint64_t begin, std::size_t count, int axis, float* buffer) const {
    reads += count;
    for (std::size_t i = 0; i < count; ++i) buffer[i] = records_[begin + i].x[axis];
    return {buffer, 1, true};
  }
  float key(std::uint64_t place, int axis) const { return records_[place].x[axis]; }
  std::size_t list(std::uint64_t begin, std::size_t count, int axis, kernels::Relation relation, float pivot,
                   Place* places) const {
    return list_in_store(*this, begin, count, axis, relation, pivot, places);
  }
  void exchange(std::uint64_t left, const Place* left_places, std::uint64_t right, const Place* right_places,
                std::size_t count) {
    moves += count;
    for (std::size_t i = 0; i < count; ++i)
      std::swap(records_[left + left_places[i]], records_[right + right_places[i]]);
  }
  void swap(std::uint64_t a, std::uint64_t b) { std::swap(records_[a], records_[b]); }

  mutable std::atomic<std::uint64_t> reads{0};
  std::atomic<std::uint64_t> moves{0};

 private:
  std::vector<Record>& records_;
};

std::vector<Record> make_records(Pattern pattern, std::uint64_t n, int axis, std::uint64_t seed) {
  CounterRandom random(seed);
  std::vector<Record> records(n);
  for (std::uint64_t i = 0; i < n; ++i) {
    for (float& x : records[i].x) x = static_cast<float>(random.unit());
    records[i].x[axis] = static_cast<float>(value_of(pattern, i, n, random));
    records[i].id = static_cast<std::uint32_t>(i);
  }
  return records;
}

TEST(Split, IsExactAtEveryRank) {
  Workers workers(2);
  std::uint64_t seed = 0;
  for (const Pattern pattern : all_patterns) {
    for (const std::uint64_t n : {1000u, 70000u, 400000u}) {
      for (const std::uint64_t wanted : {n / 2, n / 50}) {
        const int axis = static_cast<int>(seed % 3);
        const std::vector<Record> before = make_records(pattern, n, axis, ++seed);
        std::vector<Record> records = before;
        std::vector<float> values;
        for (const Record& r : records) values.push_back(r.x[axis]);
        std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(wanted), values.end());
        CountingStore store(records);
        std::atomic<std::uint64_t> moved{0};
        const float median = workers.run([&] { return split_range(store, {0, n}, wanted, axis, moved); });
        const auto what = "pattern " + std::to_string(static_cast<int>(pattern)) + ", place " + std::to_string(wanted) +
                          " of " + std::to_string(n);
        ASSERT_EQ(median, values[wanted]) << what;
        ASSERT_EQ(records[wanted].x[axis], median) << what;
        for (std::uint64_t i = 0; i < wanted; ++i) ASSERT_LE(records[i].x[axis], median) << what;
        for (std::uint64_t i = wanted; i < n; ++i) ASSERT_GE(records[i].x[axis], median) << what;
        std::vector<bool> seen(n, false);
        for (const Record& r : records) {
          ASSERT_FALSE(seen.at(r.id)) << what;
          seen[r.id] = true;
          for (int c = 0; c < 3; ++c) ASSERT_EQ(r.x[c], before[r.id].x[c]) << what;
        }
        // One reading finds the median, two more the misplaced; bad luck and equal keys take some more.
        EXPECT_LE(store.reads, 8 * n) << what;
        EXPECT_LE(store.moves, n / 2) << what;
        EXPECT_LE(moved, 2 * store.moves + 2) << what;
      }
    }
  }
}

TEST(Split, MovesNothingThatIsInPlace) {
  for (const Pattern pattern : {Pattern::sorted, Pattern::equal}) {
    std::vector<Record> records = make_records(pattern, 300000, 1, 3);
    CountingStore store(records);
    std::atomic<std::uint64_t> moved{0};
    split_range(store, {0, records.size()}, records.size() / 2, 1, moved);
    EXPECT_EQ(store.moves, 0u);
    EXPECT_LE(moved, 2u);
    EXPECT_LE(store.reads, 5 * records.size());
  }
}

TEST(Split, StaysWithinItsRange) {
  std::vector<Record> records = make_records(Pattern::random, 100000, 1, 42);
  const std::vector<Record> before = records;
  CountingStore store(records);
  std::atomic<std::uint64_t> moved{0};
  split_range(store, {300, 90000}, 45000, 1, moved);
  for (std::size_t i = 0; i < 300; ++i) ASSERT_EQ(records[i].id, before[i].id);
  for (std::size_t i = 90000; i < records.size(); ++i) ASSERT_EQ(records[i].id, before[i].id);
}

// More keys within the band of the sample than lists have room for: the search narrows it, and ends.
TEST(Split, EndsWhereListsOverflow) {
  constexpr std::uint64_t n = 3000000;
  for (const bool steps : {false, true}) {
    std::vector<Record> records(n);
    CounterRandom random(5);
    // Nearly all keys within a sliver: the sample cannot tell them apart. In steps: each of them many times.
    for (std::uint64_t i = 0; i < n; ++i)
      records[i] = {{steps ? static_cast<float>(random.below(7)) : 1.0f + 1e-7f * static_cast<float>(random.below(3)),
                     0.0f, 0.0f},
                    static_cast<std::uint32_t>(i)};
    std::vector<float> values;
    for (const Record& r : records) values.push_back(r.x[0]);
    std::nth_element(values.begin(), values.begin() + n / 2, values.end());
    CountingStore store(records);
    std::atomic<std::uint64_t> moved{0};
    EXPECT_EQ(split_range(store, {0, n}, n / 2, 0, moved), values[n / 2]);
    for (std::uint64_t i = 0; i < n; ++i)
      ASSERT_TRUE(i < n / 2 ? records[i].x[0] <= values[n / 2] : records[i].x[0] >= values[n / 2]);
    EXPECT_LE(store.reads, 8 * n);
  }
}

}  // namespace
}  // namespace insitu::testing
