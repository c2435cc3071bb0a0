#include "elements.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "element_table.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Elements, TableIsComplete) {
  ASSERT_EQ(std::size(element_table), static_cast<std::size_t>(element_count) + 1);
  for (int z = 1; z <= element_count; ++z) {
    EXPECT_EQ(element_of_symbol(element_symbol(z)), z);
    EXPECT_GT(element_table[z].mass, 0.9 * z) << z;
    EXPECT_GT(vdw_radius(z), 1.0) << z;
    EXPECT_LT(vdw_radius(z), 3.6) << z;
  }
  EXPECT_STREQ(element_symbol(118), "Og");
}

TEST(Elements, SymbolsMayCarryCaseNumbersAndCharges) {
  EXPECT_EQ(element_of_symbol("na"), 11);
  EXPECT_EQ(element_of_symbol("NA"), 11);
  EXPECT_EQ(element_of_symbol("Si4+"), 14);
  EXPECT_EQ(element_of_symbol("C1"), 6);
  EXPECT_EQ(element_of_symbol("D"), 1);
  EXPECT_EQ(element_of_symbol("Xx"), 0);
  EXPECT_EQ(element_of_symbol("OW"), 0);
  EXPECT_EQ(element_of_symbol(""), 0);
  EXPECT_EQ(element_of_symbol("7"), 0);
}

TEST(Elements, UnknownOnesHaveARadius) {
  EXPECT_EQ(vdw_radius(0), vdw_radius(-5));
  EXPECT_EQ(vdw_radius(0), vdw_radius(500));
  EXPECT_GT(vdw_radius(0), 1.0);
}

TEST(Elements, MassesTellElements) {
  EXPECT_THAT(elements_of_masses({12.01115, 14.0067, 1.00797, 15.9994}), ElementsAre(6, 7, 1, 8));
  EXPECT_THAT(elements_of_masses({12.0, 18.99}), ElementsAre(6, 9));
  EXPECT_THAT(elements_of_masses({58.6934}), ElementsAre(28));
  EXPECT_THAT(elements_of_masses({58.933}), ElementsAre(27));
}

TEST(Elements, ReducedUnitsAreNoElements) {
  EXPECT_THAT(elements_of_masses({1.0}), IsEmpty());
  EXPECT_THAT(elements_of_masses({1.0, 4.0}), IsEmpty());
  EXPECT_THAT(elements_of_masses({0.2, 0.1}), IsEmpty());
  EXPECT_THAT(elements_of_masses({72.0, 54.0}), IsEmpty());
  EXPECT_THAT(elements_of_masses({12.011, 13.3}), IsEmpty());
  EXPECT_THAT(elements_of_masses({}), IsEmpty());
}

}  // namespace
}  // namespace replay::test
