// Which bytes a permutation moves: fields of one record join, and overlaps that no permutation can serve are refused.
#include <gtest/gtest.h>

#include "core/error.h"
#include "unit/geometry/arrays.h"

namespace insitu::testing {
namespace {

alignas(8) std::byte memory[4096];

kernels::ArrayView records(std::uint32_t type, std::uint32_t components, std::ptrdiff_t first, std::int64_t stride,
                           std::uint64_t count = 10) {
  return checked_view(insitu_array_records(type, components, memory + first, count, stride), use_payload, "records");
}

TEST(ColumnSet, PackedRecordsAreOneColumn) {
  ColumnSet set;
  set.add(records(INSITU_F64, 3, 0, 0), "position");
  ASSERT_EQ(set.columns().size(), 1u);
  EXPECT_EQ(set.columns()[0].base, memory);
  EXPECT_EQ(set.columns()[0].stride, 24);
  EXPECT_EQ(set.columns()[0].bytes, 24u);
}

TEST(ColumnSet, ColumnsStaySeparate) {
  ColumnSet set;
  set.add(
      checked_view(insitu_array_columns(INSITU_F32, memory, memory + 100, memory + 200, 10), INSITU_USE_POSITION, ""),
      "position");
  EXPECT_EQ(set.columns().size(), 3u);
  for (const MovedColumn& column : set.columns()) EXPECT_EQ(column.bytes, 4u);
}

// Fields of the same record that do not touch move apart; those that overlap become one.
TEST(ColumnSet, FieldsOfARecordJoinWhereTheyOverlap) {
  ColumnSet apart;
  apart.add(records(INSITU_F64, 3, 0, 64), "position");
  apart.add(records(INSITU_F64, 1, 32, 64), "mass");
  EXPECT_EQ(apart.columns().size(), 2u);

  for (const bool whole_first : {false, true}) {
    ColumnSet set;
    if (whole_first) set.add(records(INSITU_U8, 64, 0, 64), "whole record");
    set.add(records(INSITU_F64, 3, 8, 64), "position");
    set.add(records(INSITU_F32, 1, 40, 64), "radius");
    if (!whole_first) set.add(records(INSITU_U8, 64, 0, 64), "whole record");
    ASSERT_EQ(set.columns().size(), 1u);
    EXPECT_EQ(set.columns()[0].base, memory);
    EXPECT_EQ(set.columns()[0].bytes, 64u);
  }
}

TEST(ColumnSet, PartlyOverlappingFieldsBecomeTheirUnion) {
  ColumnSet set;
  set.add(records(INSITU_F32, 3, 8, 64), "a");   // bytes 8 to 20
  set.add(records(INSITU_F32, 3, 16, 64), "b");  // bytes 16 to 28
  ASSERT_EQ(set.columns().size(), 1u);
  EXPECT_EQ(set.columns()[0].base, memory + 8);
  EXPECT_EQ(set.columns()[0].bytes, 20u);
}

TEST(ColumnSet, TheSameArrayTwiceIsOneColumn) {
  ColumnSet set;
  set.add(records(INSITU_F32, 3, 0, 0), "position");
  set.add(records(INSITU_F32, 3, 0, 0), "attribute");
  EXPECT_EQ(set.columns().size(), 1u);
}

TEST(ColumnSet, ArraysSideBySideAreIndependent) {
  ColumnSet set;
  set.add(records(INSITU_F32, 3, 0, 0), "a");
  set.add(records(INSITU_F64, 1, 120, 0), "b");
  EXPECT_EQ(set.columns().size(), 2u);
}

struct Overlap {
  const char* what;
  kernels::ArrayView first;
  kernels::ArrayView second;
};

TEST(ColumnSet, OverlapsWithoutACommonRecordAreRefused) {
  const Overlap overlaps[] = {
      {"another stride", records(INSITU_F32, 3, 0, 12), records(INSITU_F32, 3, 0, 16)},
      {"another stride, further on", records(INSITU_F32, 3, 0, 12), records(INSITU_F64, 1, 64, 8)},
      {"another direction", records(INSITU_F32, 3, 0, 16), records(INSITU_F32, 3, 144, -16)},
      {"one record later", records(INSITU_F32, 3, 0, 16), records(INSITU_F32, 3, 16, 16)},
      {"three records later", records(INSITU_F32, 1, 0, 4), records(INSITU_F32, 1, 12, 4)},
      {"into the next record", records(INSITU_F32, 3, 0, 32), records(INSITU_F32, 3, 24, 32)},
      {"a union longer than the record", records(INSITU_U8, 12, 0, 32), records(INSITU_U8, 28, 8, 32)},
  };
  for (const Overlap& o : overlaps) {
    for (const bool swapped : {false, true}) {
      ColumnSet set;
      set.add(swapped ? o.second : o.first, "a");
      try {
        set.add(swapped ? o.first : o.second, "b");
        ADD_FAILURE() << o.what << (swapped ? ", swapped" : "") << ": accepted";
      } catch (const Error& error) {
        EXPECT_EQ(error.status(), INSITU_ERROR_INVALID_ARGUMENT) << o.what;
      }
    }
  }
}

TEST(ColumnSet, RowsMoveByTheirPointers) {
  float data[30] = {};
  float* table[10];
  for (int i = 0; i < 10; ++i) table[i] = &data[3 * (i * 7 % 10)];
  insitu_array rows = insitu_array_records(INSITU_F32, 3, table, 10, 0);
  rows.flags = INSITU_ARRAY_ROWS;
  ColumnSet set;
  set.add(checked_view(rows, INSITU_USE_POSITION, ""), "position");
  ASSERT_EQ(set.columns().size(), 1u);
  EXPECT_TRUE(set.columns()[0].rows);
  EXPECT_EQ(set.columns()[0].bytes, 12u);
}

TEST(ColumnSet, RowsOfOneBlockAreTheRecordsTheyStandIn) {
  double data[60] = {};
  double* table[10];
  for (int i = 0; i < 10; ++i) table[i] = &data[6 * i];
  insitu_array rows = insitu_array_records(INSITU_F64, 3, table, 10, 0);
  rows.flags = INSITU_ARRAY_ROWS;
  ColumnSet set;
  set.add(checked_view(rows, INSITU_USE_POSITION, ""), "position");
  // The same coordinates, and what stands behind them.
  set.add(checked_view(insitu_array_records(INSITU_F64, 3, data, 10, 48), INSITU_USE_ATTRIBUTE, ""), "x");
  set.add(checked_view(insitu_array_records(INSITU_F64, 3, data + 3, 10, 48), INSITU_USE_ATTRIBUTE, ""), "v");
  std::size_t bytes = 0;
  for (const MovedColumn& column : set.columns()) {
    EXPECT_FALSE(column.rows);
    bytes += column.bytes;
  }
  EXPECT_EQ(bytes, 48u);
}

TEST(ColumnSet, EmptyArraysAddNothing) {
  ColumnSet set;
  set.add(checked_view(insitu_array_records(INSITU_F64, 3, nullptr, 0, 0), INSITU_USE_POSITION, ""), "position");
  EXPECT_TRUE(set.columns().empty());
}

}  // namespace
}  // namespace insitu::testing
