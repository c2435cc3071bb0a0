// Descriptors, good and bad: what is accepted, what is refused, and that the reason says why.
#include "geometry/array_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "core/error.h"
#include "unit/geometry/arrays.h"

namespace insitu::testing {
namespace {

using ::testing::HasSubstr;

alignas(8) std::byte memory[4096];

insitu_array packed(std::uint32_t type, std::uint32_t components, std::uint64_t count = 10) {
  return insitu_array_records(type, components, memory, count, 0);
}

insitu_array rows_of(std::array<const std::byte*, 10>& table) {
  insitu_array array = insitu_array_records(INSITU_F64, 3, table.data(), table.size(), 0);
  array.flags = INSITU_ARRAY_ROWS;
  return array;
}

// Rows of 64 bytes, from the last to the first but for two that have changed places.
std::array<const std::byte*, 10> row_table() {
  std::array<const std::byte*, 10> table;
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = memory + 64 * (table.size() - i);
  std::swap(table[3], table[5]);
  return table;
}

struct Verdict {
  const char* what;
  insitu_array array;
  std::uint32_t use;
  insitu_status status;
  const char* reason;  // part of it
  std::uint64_t borrowed_bytes = 0;
};

insitu_array with(insitu_array array, const std::function<void(insitu_array&)>& change) {
  change(array);
  return array;
}

std::vector<Verdict> verdicts() {
  constexpr auto bad = INSITU_ERROR_INVALID_ARGUMENT;
  constexpr auto unsupported = INSITU_ERROR_UNSUPPORTED;
  const auto base = packed(INSITU_F64, 3);
  static auto good_table = row_table();
  static auto table_with_null = row_table();
  table_with_null[7] = nullptr;
  static auto table_with_odd = row_table();
  table_with_odd[9] += 4;
  return {
      {"packed f64", base, INSITU_USE_POSITION, INSITU_OK, "packed records of f64", 240},
      {"packed f32", packed(INSITU_F32, 3), INSITU_USE_POSITION, INSITU_OK, "packed records of f32", 120},
      {"i32 lattice", packed(INSITU_I32, 3), INSITU_USE_POSITION, INSITU_OK, "i32", 120},
      {"u32 lattice", packed(INSITU_U32, 3), INSITU_USE_POSITION, INSITU_OK, "u32", 120},
      {"strided", insitu_array_records(INSITU_F64, 3, memory, 10, 64), INSITU_USE_POSITION, INSITU_OK, "strided", 240},
      {"backwards", insitu_array_records(INSITU_F64, 3, memory + 640, 10, -64), INSITU_USE_POSITION, INSITU_OK,
       "strided", 240},
      {"columns", insitu_array_columns(INSITU_F32, memory, memory + 400, memory + 800, 10), INSITU_USE_POSITION,
       INSITU_OK, "columns of f32", 120},
      {"columns within records",
       with(insitu_array_columns(INSITU_F32, memory, memory + 4, memory + 8, 10),
            [](insitu_array& a) { a.stride_bytes = 12; }),
       INSITU_USE_POSITION, INSITU_OK, "columns", 120},
      {"rows", rows_of(good_table), INSITU_USE_POSITION, INSITU_OK, "rows", 240},
      {"rows with a NULL among them", rows_of(table_with_null), INSITU_USE_POSITION, bad, "row pointer 7 is NULL"},
      {"rows with an odd one among them", rows_of(table_with_odd), INSITU_USE_POSITION, bad,
       "row pointer 9 is not aligned"},
      {"empty", insitu_array_records(INSITU_F64, 3, nullptr, 0, 0), INSITU_USE_POSITION, INSITU_OK, "empty", 0},
      {"radius", packed(INSITU_F32, 1), INSITU_USE_RADIUS, INSITU_OK, "f32", 40},
      {"u8 type", packed(INSITU_U8, 1), INSITU_USE_TYPE, INSITU_OK, "u8", 10},
      {"i64 type", packed(INSITU_I64, 1), INSITU_USE_TYPE, INSITU_OK, "i64", 80},
      {"4-vector", packed(INSITU_F64, 4), INSITU_USE_ATTRIBUTE, INSITU_OK, "f64", 320},
      {"u64 attribute", packed(INSITU_U64, 1), INSITU_USE_ATTRIBUTE, INSITU_OK, "u64", 80},
      {"bytes", packed(INSITU_U8, 57), use_payload, INSITU_OK, "u8", 570},
      {"one item with a short stride", insitu_array_records(INSITU_F64, 3, memory, 1, 8), INSITU_USE_POSITION,
       INSITU_OK, "", 24},

      {"no pointer", insitu_array_records(INSITU_F64, 3, nullptr, 10, 0), INSITU_USE_POSITION, bad, "component[0]"},
      {"two components", packed(INSITU_F64, 2), INSITU_USE_POSITION, bad, "components"},
      {"four components", packed(INSITU_F64, 4), INSITU_USE_POSITION, bad, "components"},
      {"no components", packed(INSITU_F64, 0), INSITU_USE_ATTRIBUTE, bad, "components"},
      {"five components", packed(INSITU_F64, 5), INSITU_USE_ATTRIBUTE, bad, "components"},
      {"radius vector", packed(INSITU_F64, 3), INSITU_USE_RADIUS, bad, "components"},
      {"no scalar type", packed(0, 3), INSITU_USE_POSITION, bad, "scalar type 0"},
      {"unknown scalar type", packed(8, 3), INSITU_USE_POSITION, bad, "scalar type 8"},
      {"unknown use", base, 99, bad, "use 99"},
      {"no use", base, 0, bad, "use 0"},
      {"unknown flags", with(base, [](insitu_array& a) { a.flags = 8; }), INSITU_USE_POSITION, bad, "flags"},
      {"i64 positions", packed(INSITU_I64, 3), INSITU_USE_POSITION, unsupported, "i64"},
      {"u8 positions", packed(INSITU_U8, 3), INSITU_USE_POSITION, unsupported, "u8"},
      {"integer radii", packed(INSITU_I32, 1), INSITU_USE_RADIUS, unsupported, "i32"},
      {"float types", packed(INSITU_F32, 1), INSITU_USE_TYPE, unsupported, "f32"},
      {"misaligned", insitu_array_records(INSITU_F64, 3, memory + 4, 10, 0), INSITU_USE_POSITION, bad, "aligned"},
      {"odd pointer", insitu_array_records(INSITU_F32, 3, memory + 1, 10, 0), INSITU_USE_POSITION, bad, "aligned"},
      {"misaligned second column", insitu_array_columns(INSITU_F32, memory, memory + 402, memory + 800, 10),
       INSITU_USE_POSITION, bad, "component[1]"},
      {"stride no multiple", insitu_array_records(INSITU_F64, 3, memory, 10, 28), INSITU_USE_POSITION, bad, "multiple"},
      {"stride too short", insitu_array_records(INSITU_F64, 3, memory, 10, 16), INSITU_USE_POSITION, bad, "overlap"},
      {"stride too short, backwards", insitu_array_records(INSITU_F64, 3, memory + 400, 10, -16), INSITU_USE_POSITION,
       bad, "overlap"},
      {"only two columns",
       with(insitu_array_columns(INSITU_F32, memory, memory + 400, memory + 800, 10),
            [](insitu_array& a) { a.component[2] = nullptr; }),
       INSITU_USE_POSITION, bad, "all component pointers"},
      {"rows with columns",
       with(insitu_array_columns(INSITU_F32, memory, memory + 400, memory + 800, 10),
            [](insitu_array& a) { a.flags = INSITU_ARRAY_ROWS; }),
       INSITU_USE_POSITION, bad, "rows"},
      {"rows, misaligned table",
       with(insitu_array_records(INSITU_F32, 3, memory + 4, 10, 0),
            [](insitu_array& a) { a.flags = INSITU_ARRAY_ROWS; }),
       INSITU_USE_POSITION, bad, "aligned"},
      {"count beyond memory", packed(INSITU_F64, 3, ~std::uint64_t{0}), INSITU_USE_POSITION, bad, "memory"},
      {"count that wraps around", packed(INSITU_F64, 3, std::uint64_t{1} << 61), INSITU_USE_POSITION, bad, "memory"},
      {"largest stride", insitu_array_records(INSITU_F64, 3, memory, 3, std::numeric_limits<std::int64_t>::max() - 7),
       INSITU_USE_POSITION, bad, "memory"},
      {"smallest stride", insitu_array_records(INSITU_F64, 3, memory, 3, std::numeric_limits<std::int64_t>::min()),
       INSITU_USE_POSITION, bad, ""},
  };
}

TEST(JudgeArray, KnowsGoodFromBad) {
  for (const Verdict& v : verdicts()) {
    const ArrayVerdict verdict = judge_array(v.array, v.use);
    EXPECT_EQ(verdict.status, v.status) << v.what << ": " << verdict.reason;
    EXPECT_THAT(verdict.reason, HasSubstr(v.reason)) << v.what;
    EXPECT_FALSE(verdict.reason.empty()) << v.what;
    EXPECT_LT(verdict.reason.size(), 250u) << v.what;
    EXPECT_EQ(verdict.borrowed_bytes, v.borrowed_bytes) << v.what;
  }
}

TEST(CheckedView, ThrowsWithTheNameOfTheArray) {
  try {
    checked_view(packed(INSITU_F64, 2), INSITU_USE_POSITION, "galaxy");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), INSITU_ERROR_INVALID_ARGUMENT);
    EXPECT_THAT(error.what(), HasSubstr("galaxy"));
  }
}

TEST(CheckedView, ReadsWhatTheDescriptorSays) {
  const std::vector<double> records = {0, 1, 2, 99, 10, 11, 12, 99, 20, 21, 22, 99};
  const auto expect_rows = [](const kernels::ArrayView& view, std::array<int, 3> rows) {
    ASSERT_EQ(view.count, 3u);
    for (std::uint64_t i = 0; i < 3; ++i)
      for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(view.value(i, c), 10.0 * rows[i] + c);
  };
  expect_rows(checked_view(insitu_array_records(INSITU_F64, 3, records.data(), 3, 32), INSITU_USE_POSITION, ""),
              {0, 1, 2});
  expect_rows(checked_view(insitu_array_records(INSITU_F64, 3, records.data() + 8, 3, -32), INSITU_USE_POSITION, ""),
              {2, 1, 0});
  const float x[] = {0, 10, 20};
  const float y[] = {1, 11, 21};
  const float z[] = {2, 12, 22};
  expect_rows(checked_view(insitu_array_columns(INSITU_F32, x, y, z, 3), INSITU_USE_POSITION, ""), {0, 1, 2});
  const double* table[] = {&records[4], &records[8], &records[0]};
  insitu_array rows = insitu_array_records(INSITU_F64, 3, table, 3, 0);
  rows.flags = INSITU_ARRAY_ROWS;
  expect_rows(checked_view(rows, INSITU_USE_POSITION, ""), {1, 2, 0});
}

TEST(CheckedView, TakesRowsAtEqualDistancesAsRecords) {
  for (const bool backwards : {false, true}) {
    std::array<const std::byte*, 10> table;
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = memory + 64 * (backwards ? table.size() - i : i);
    const kernels::ArrayView view = checked_view(rows_of(table), INSITU_USE_POSITION, "");
    EXPECT_FALSE(view.rows);
    EXPECT_EQ(view.stride, backwards ? -64 : 64);
    for (std::uint32_t c = 0; c < 3; ++c)
      for (std::uint64_t i = 0; i < table.size(); ++i) EXPECT_EQ(view.address(i, c), table[i] + 8 * c);
  }
}

TEST(CheckedView, LeavesOtherRowsBehindTheirTable) {
  std::array<const std::byte*, 10> table = row_table();
  EXPECT_TRUE(checked_view(rows_of(table), INSITU_USE_POSITION, "").rows);
  table.fill(memory);  // one row for all
  EXPECT_TRUE(checked_view(rows_of(table), INSITU_USE_POSITION, "").rows);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = memory + 8 * i;  // rows that overlap
  EXPECT_TRUE(checked_view(rows_of(table), INSITU_USE_POSITION, "").rows);
}

TEST(CheckedView, EmptyArraysNeedNoMemory) {
  const kernels::ArrayView view =
      checked_view(insitu_array_records(INSITU_F64, 3, nullptr, 0, 0), INSITU_USE_POSITION, "");
  EXPECT_EQ(view.count, 0u);
}

}  // namespace
}  // namespace insitu::testing
