#include "core/budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace insitu {
namespace {

TEST(Budget, CountsWhatIsHeldAndItsPeak) {
  Budget budget(0);
  {
    const BudgetShare a(budget, 100, "a");
    const BudgetShare b(budget, 50, "b");
    EXPECT_EQ(budget.owned(), 150u);
  }
  EXPECT_EQ(budget.owned(), 0u);
  EXPECT_EQ(budget.peak(), 150u);
  EXPECT_EQ(budget.left(), ~std::uint64_t{0});
}

TEST(Budget, RefusesWhatPassesTheCapAndCountsNothing) {
  Budget budget(100);
  const BudgetShare held(budget, 60, "held");
  try {
    budget.take(41, "the index");
    FAIL() << "given";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), INSITU_ERROR_OVER_BUDGET);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("the index"));
  }
  EXPECT_EQ(budget.owned(), 60u);
  EXPECT_EQ(budget.left(), 40u);
  budget.take(40, "exactly what is left");
  EXPECT_EQ(budget.left(), 0u);
  EXPECT_THROW(budget.take(~std::uint64_t{0}, "a number that would wrap around"), Error);
  EXPECT_EQ(budget.owned(), 100u);
  budget.give_back(40);
}

TEST(Budget, SharesMove) {
  Budget budget(0);
  BudgetShare a(budget, 10, "a");
  BudgetShare b = std::move(a);
  EXPECT_EQ(b.bytes(), 10u);
  EXPECT_EQ(budget.owned(), 10u);
  BudgetShare c(budget, 5, "c");
  c = std::move(b);
  EXPECT_EQ(c.bytes(), 10u);
  b = {};
  EXPECT_EQ(budget.owned(), 10u);
}

TEST(BudgetVector, HoldsExactlyItsBytes) {
  Budget budget(1000);
  BudgetVector<std::uint32_t> v;
  v.reset(budget, 100, "v");
  EXPECT_EQ(v.size(), 100u);
  EXPECT_EQ(budget.owned(), 400u);
  v.reset(budget, 50, "v");
  EXPECT_EQ(budget.owned(), 200u);
  EXPECT_THROW(v.reset(budget, 251, "v"), Error);
  EXPECT_EQ(v.size(), 0u);
  EXPECT_EQ(budget.owned(), 0u);
  v.reset(budget, 250, "v");
  EXPECT_EQ(budget.left(), 0u);
  v.clear();
  EXPECT_TRUE(v.empty());
  EXPECT_EQ(budget.owned(), 0u);
  EXPECT_EQ(budget.peak(), 1000u);
}

}  // namespace
}  // namespace insitu
