// What --filter says.
#include "filter_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "options.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Kind = FilterCondition::Kind;

std::string usage_error(const std::string& text) {
  try {
    parse_filter(text);
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

TEST(FilterText, Conditions) {
  const FilterChoice range = parse_filter("speed:0.5..2");
  ASSERT_EQ(range.size(), 1u);
  EXPECT_EQ(range[0].kind, Kind::range);
  EXPECT_EQ(range[0].attribute, "speed");
  EXPECT_THAT(range[0].range, ElementsAre(0.5, 2));
  EXPECT_FALSE(range[0].negated);
  EXPECT_THAT(parse_filter("v.x:-1e3..")[0].range, ElementsAre(-1000, std::numeric_limits<double>::infinity()));
  EXPECT_EQ(parse_filter("v.x:-1e3..")[0].attribute, "v.x");
  EXPECT_EQ(parse_filter("q : ..-.5")[0].range[1], -0.5);

  const FilterChoice set = parse_filter("not id = 17,-18, 9007199254740993");
  EXPECT_EQ(set[0].kind, Kind::set);
  EXPECT_TRUE(set[0].negated);
  EXPECT_EQ(set[0].attribute, "id");
  EXPECT_THAT(set[0].members, ElementsAre(17, -18, 9007199254740993));

  const FilterChoice either = parse_filter("box:0,0,0,1,2,3 or not plane:1,0,-1,0.5 or type=2");
  ASSERT_EQ(either.size(), 3u);
  EXPECT_EQ(either[0].kind, Kind::box);
  EXPECT_THAT(either[0].numbers, ElementsAre(0, 0, 0, 1, 2, 3));
  EXPECT_EQ(either[1].kind, Kind::plane);
  EXPECT_TRUE(either[1].negated);
  EXPECT_THAT(either[1].numbers, ElementsAre(1, 0, -1, 0.5));
  EXPECT_EQ(either[2].kind, Kind::set);
}

TEST(FilterText, WhatIsWrongIsNamed) {
  EXPECT_THAT(usage_error(""), HasSubstr("is no condition"));
  EXPECT_THAT(usage_error("speed"), HasSubstr("\"speed\" is no condition"));
  EXPECT_THAT(usage_error("=3"), HasSubstr("is no condition"));
  EXPECT_THAT(usage_error("speed:1"), HasSubstr("\"1\" is no range"));
  EXPECT_THAT(usage_error("speed:a..2"), HasSubstr("\"a\" is no number"));
  EXPECT_THAT(usage_error("speed:nan..2"), HasSubstr("\"nan\" is no number"));
  EXPECT_THAT(usage_error("speed:2..1"), HasSubstr("nothing is within"));
  EXPECT_THAT(usage_error("type=1.5"), HasSubstr("\"1.5\" is no whole number"));
  EXPECT_THAT(usage_error("type="), HasSubstr("is no whole number"));
  EXPECT_THAT(usage_error("box:1,2,3"), HasSubstr("six numbers"));
  EXPECT_THAT(usage_error("box:0,0,0,1,1,inf"), HasSubstr("is no number"));
  EXPECT_THAT(usage_error("plane:0,0,0,1"), HasSubstr("all 0"));
  EXPECT_THAT(usage_error("type=1 or "), HasSubstr("is no condition"));
  EXPECT_THAT(usage_error("type=1 and type=2"), HasSubstr("is no whole number"));
  EXPECT_THAT(usage_error("speed:1"), HasSubstr("expected NAME:LOW..HIGH"));
}

// (a or b) and (c or d) is ac or bc or ad or bd.
TEST(FilterText, TextsAreJoinedIntoAlternatives) {
  EXPECT_TRUE(alternatives_of({}).empty());
  const auto all = alternatives_of({parse_filter("a=1 or b=1"), parse_filter("c=1"), parse_filter("d=1 or e=1")});
  std::vector<std::string> names;
  for (const auto& together : all) {
    names.emplace_back();
    for (const FilterCondition& condition : together) names.back() += condition.attribute;
  }
  EXPECT_THAT(names, ElementsAre("acd", "bcd", "ace", "bce"));
  const std::vector<FilterChoice> too_many(12, parse_filter("a=1 or b=1"));
  EXPECT_THROW(alternatives_of(too_many), UsageError);
}

}  // namespace
}  // namespace replay::test
