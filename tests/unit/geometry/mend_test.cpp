// Mending where the number of levels whose bounds are kept is small: particles of a larger set than a test could hold
// go the same way, run after run.
#include "geometry/pkd/pkd_mend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "unit/kernels/counter_random.h"

namespace insitu::testing {
namespace {

using Record = PkdRecord<float>;
using Box = kernels::PkdBox<float>;

std::vector<Record> cloud(std::size_t count, std::uint64_t seed) {
  CounterRandom random(seed);
  std::vector<Record> records(count);
  for (Record& record : records)
    for (float& x : record.x) x = static_cast<float>(random.unit());
  return records;
}

void order(std::vector<Record>& records, std::size_t begin, std::size_t end, Box box, std::uint64_t leaf) {
  while (end - begin > leaf) {
    const int axis = box.split_axis();
    const std::size_t mid = begin + (end - begin) / 2;
    const auto at = [&records](std::size_t i) { return records.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(mid), at(end),
                     [axis](const Record& a, const Record& b) { return a.x[axis] < b.x[axis]; });
    Box left = box;
    left.upper[axis] = box.lower[axis] = records[mid].x[axis];
    order(records, begin, mid, left, leaf);
    begin = mid + 1;
  }
}

std::uint64_t out_of_order(const std::vector<Record>& records, std::size_t begin, std::size_t end, Box box,
                           std::uint64_t leaf) {
  std::uint64_t wrong = 0;
  while (end - begin > leaf) {
    const int axis = box.split_axis();
    const std::size_t mid = begin + (end - begin) / 2;
    const float plane = records[mid].x[axis];
    for (std::size_t i = begin; i < mid; ++i) wrong += records[i].x[axis] > plane ? 1 : 0;
    for (std::size_t i = mid + 1; i < end; ++i) wrong += records[i].x[axis] < plane ? 1 : 0;
    Box left = box;
    left.upper[axis] = box.lower[axis] = plane;
    wrong += out_of_order(records, begin, mid, left, leaf);
    begin = mid + 1;
  }
  return wrong;
}

std::vector<Record> sorted(std::vector<Record> records) {
  std::sort(records.begin(), records.end(),
            [](const Record& a, const Record& b) { return std::lexicographical_compare(a.x, a.x + 3, b.x, b.x + 3); });
  return records;
}

TEST(TreeMend, OrdersRunByRunWhereBoundsOfAllLevelsAreTooMany) {
  const Box box = {{-0.1f, -0.1f, -0.1f}, {1.1f, 1.1f, 1.1f}};
  for (const std::size_t count : {20000u, 70001u})
    for (const unsigned most_height : {1u, 3u, 20u})
      for (const float amount : {0.0f, 1e-4f, 3e-3f, 0.05f}) {
        const std::uint64_t leaf = 64;
        std::vector<Record> records = cloud(count, count);
        order(records, 0, count, box, leaf);
        CounterRandom random(count + most_height);
        for (Record& record : records)
          for (float& x : record.x) x = std::clamp(x + amount * static_cast<float>(random.sign()), 0.0f, 1.0f);
        const std::vector<Record> before = sorted(records);

        kernels::PkdTree tree;
        PackedStore<float> store(tree, records.data());
        std::uint64_t built = 0;
        const std::uint64_t moved = TreeMend<PackedStore<float>>(store, leaf, most_height)
                                        .mend(
                                            0, count, box,
                                            [&](std::uint64_t begin, std::uint64_t end, const Box& of) {
                                              built += end - begin;
                                              order(records, begin, end, of, leaf);
                                            },
                                            [](std::uint64_t, std::uint64_t) {});
        EXPECT_EQ(out_of_order(records, 0, count, box, leaf), 0u) << count << " " << most_height << " " << amount;
        const std::vector<Record> after = sorted(records);
        EXPECT_EQ(std::memcmp(before.data(), after.data(), count * sizeof(Record)), 0);
        if (amount == 0.0f) {
          EXPECT_EQ(moved, 0u);
        }
        if (amount < 1e-3f) {
          EXPECT_LT(built, count / 10);
        }
      }
}

}  // namespace
}  // namespace insitu::testing
