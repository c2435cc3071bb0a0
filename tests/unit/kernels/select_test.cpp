// Selection along an axis against std::nth_element, on orders that are hard for it.
#include "kernels/pkd_select.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "unit/kernels/counter_random.h"

namespace insitu::testing {
namespace {

struct Record {
  float x[3];
  std::uint32_t id;
};

enum class Pattern { random, sorted, reversed, equal, two_values, organ_pipe, sawtooth, one_small, one_large, few };
constexpr Pattern all_patterns[] = {Pattern::random,     Pattern::sorted,     Pattern::reversed, Pattern::equal,
                                    Pattern::two_values, Pattern::organ_pipe, Pattern::sawtooth, Pattern::one_small,
                                    Pattern::one_large,  Pattern::few};

float value_of(Pattern pattern, std::uint64_t i, std::uint64_t n, CounterRandom& random) {
  const auto value = [](std::uint64_t v) { return static_cast<float>(v); };
  switch (pattern) {
    case Pattern::random:
      return static_cast<float>(random.between(-1.0, 1.0));
    case Pattern::sorted:
      return value(i);
    case Pattern::reversed:
      return value(n - i);
    case Pattern::equal:
      return 1.5f;
    case Pattern::two_values:
      return value(random.below(2));
    case Pattern::organ_pipe:
      return value(std::min(i, n - i));
    case Pattern::sawtooth:
      return value(i % 64);
    case Pattern::one_small:
      return i == n / 3 ? -1.0f : 1.0f;
    case Pattern::one_large:
      return i == n / 3 ? 2.0f : 1.0f;
    case Pattern::few:
      return value(random.below(5));
  }
  return 0.0f;
}

std::vector<Record> make_records(Pattern pattern, std::uint64_t n, int axis, std::uint64_t seed) {
  CounterRandom random(seed);
  std::vector<Record> records(n);
  for (std::uint64_t i = 0; i < n; ++i) {
    for (float& x : records[i].x) x = static_cast<float>(random.unit());
    records[i].x[axis] = value_of(pattern, i, n, random);
    records[i].id = static_cast<std::uint32_t>(i);
  }
  return records;
}

TEST(Select, PutsTheWantedRankInItsPlace) {
  std::uint64_t seed = 0;
  for (const Pattern pattern : all_patterns) {
    for (const std::uint64_t n : {1u, 2u, 3u, 12u, 13u, 14u, 33u, 199u, 200u, 201u, 2000u, 20001u}) {
      for (const std::uint64_t wanted : {std::uint64_t{0}, n / 7, n / 2, n - 1}) {
        const int axis = static_cast<int>(seed % 3);
        std::vector<Record> records = make_records(pattern, n, axis, ++seed);
        const std::vector<Record> before = records;
        std::vector<float> values;
        for (const Record& r : records) values.push_back(r.x[axis]);
        std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(wanted), values.end());

        kernels::RecordStore<Record> store(records.data());
        kernels::select_place(store, 0, n, wanted, axis);

        const auto what = "pattern " + std::to_string(static_cast<int>(pattern)) + ", place " + std::to_string(wanted) +
                          " of " + std::to_string(n);
        const float pivot = records[wanted].x[axis];
        ASSERT_EQ(pivot, values[wanted]) << what;
        for (std::uint64_t i = 0; i < wanted; ++i) ASSERT_LE(records[i].x[axis], pivot) << what;
        for (std::uint64_t i = wanted; i < n; ++i) ASSERT_GE(records[i].x[axis], pivot) << what;
        // Whole records moved, and every one is still there.
        std::vector<bool> seen(n, false);
        for (const Record& r : records) {
          ASSERT_FALSE(seen.at(r.id)) << what;
          seen[r.id] = true;
          for (int c = 0; c < 3; ++c) ASSERT_EQ(r.x[c], before[r.id].x[c]) << what;
        }
      }
    }
  }
}

TEST(Select, StaysWithinItsRange) {
  std::vector<Record> records = make_records(Pattern::random, 1000, 1, 42);
  const std::vector<Record> before = records;
  kernels::RecordStore<Record> store(records.data());
  kernels::select_place(store, 300, 700, 450, 1);
  for (const std::size_t i : {0u, 1u, 299u, 700u, 999u}) EXPECT_EQ(records[i].id, before[i].id);
  for (std::size_t i = 300; i < 450; ++i) EXPECT_LE(records[i].x[1], records[450].x[1]);
  for (std::size_t i = 450; i < 700; ++i) EXPECT_GE(records[i].x[1], records[450].x[1]);
}

// Counts what a selection touches: the work must stay near a few passes over the data, also where many are equal.
class CountingStore : public kernels::RecordStore<Record> {
 public:
  using kernels::RecordStore<Record>::RecordStore;
  template <class Below>
  std::uint64_t partition(std::uint64_t begin, std::uint64_t end, int axis, float pivot, Below below) {
    touched += end - begin;
    return kernels::RecordStore<Record>::partition(begin, end, axis, pivot, below);
  }
  std::uint64_t touched = 0;
};

TEST(Select, NeedsAFewPassesOnly) {
  constexpr std::uint64_t n = 200000;
  for (const Pattern pattern : all_patterns) {
    std::vector<Record> records = make_records(pattern, n, 0, 7);
    CountingStore store(records.data());
    kernels::select_place(store, 0, n, n / 2, 0);
    EXPECT_LE(store.touched, 8 * n) << "pattern " << static_cast<int>(pattern);
  }
}

TEST(Select, EqualKeysAreDoneWithInTwoPasses) {
  constexpr std::uint64_t n = 200000;
  std::vector<Record> records = make_records(Pattern::equal, n, 0, 8);
  CountingStore store(records.data());
  kernels::select_place(store, 0, n, n / 2, 0);
  EXPECT_LE(store.touched, 2 * n);
}

}  // namespace
}  // namespace insitu::testing
