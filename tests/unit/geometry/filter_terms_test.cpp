// Terms of filters: words of 64 places against one look at each item, and both against what was written into the
// arrays.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "core/error.h"
#include "geometry/filter/filter.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/counter_random.h"

namespace insitu::testing {
namespace {

using kernels::ArrayView;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

enum class Lay { packed, strided, backwards, columns, rows };
constexpr std::array all_lays = {Lay::packed, Lay::strided, Lay::backwards, Lay::columns, Lay::rows};

// Values of one type in one of the layouts.
template <class T>
class Laid {
 public:
  Laid(const std::vector<T>& values, std::uint32_t components, Lay lay) {
    const std::size_t count = values.size() / components;
    const std::size_t record = lay == Lay::strided ? components * sizeof(T) + 3 * sizeof(T) : components * sizeof(T);
    memory_.resize(count * record + 8);
    view_.components = components;
    view_.count = count;
    view_.type = kernels::Scalar::f64;
    static constexpr kernels::Scalar types[] = {kernels::Scalar::f32, kernels::Scalar::f32, kernels::Scalar::f64,
                                                kernels::Scalar::i32, kernels::Scalar::i64, kernels::Scalar::u8,
                                                kernels::Scalar::u32, kernels::Scalar::u64};
    view_.type = types[scalar_type<T>()];
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = lay == Lay::backwards ? count - 1 - i : i;
      for (std::size_t c = 0; c < components; ++c) {
        std::byte* to =
            memory_.data() + (lay == Lay::columns ? (c * count + i) * sizeof(T) : at * record + c * sizeof(T));
        std::memcpy(to, &values[i * components + c], sizeof(T));
      }
      rows_.push_back(memory_.data() + i * record);
    }
    view_.stride = static_cast<std::ptrdiff_t>(lay == Lay::columns ? sizeof(T) : record);
    for (std::uint32_t c = 0; c < components; ++c)
      view_.base[c] = memory_.data() + (lay == Lay::columns ? c * count * sizeof(T) : c * sizeof(T));
    if (lay == Lay::backwards) {
      for (std::uint32_t c = 0; c < components; ++c) view_.base[c] += (count - 1) * record;
      view_.stride = -view_.stride;
    }
    if (lay == Lay::rows) {
      view_.rows = true;
      view_.stride = static_cast<std::ptrdiff_t>(sizeof(std::byte*));
      view_.base[0] = reinterpret_cast<const std::byte*>(rows_.data());
    }
  }
  const ArrayView& view() const { return view_; }

 private:
  std::vector<std::byte> memory_;
  std::vector<const std::byte*> rows_;
  ArrayView view_;
};

// A block of items in no order; `count` of them.
FilterBlock block_of(std::uint64_t items, std::uint64_t count, CounterRandom& random) {
  FilterBlock block;
  block.count = count;
  for (std::uint64_t i = 0; i < count; ++i) block.item[i] = random.below(items);
  return block;
}

// `truth(item)` is what was meant.
template <class Term, class Truth>
void expect_answers(const Term& term, std::uint64_t items, const Truth& truth, const std::string& what) {
  CounterRandom random(items);
  for (std::uint64_t item = 0; item < items; ++item) EXPECT_EQ(term.accepts(item), truth(item)) << what << " " << item;
  for (const std::uint64_t count : {1, 2, 63, 64}) {
    const FilterBlock block = block_of(items, count, random);
    std::uint64_t expected = 0;
    for (std::uint64_t i = 0; i < count; ++i) expected |= std::uint64_t{truth(block.item[i])} << i;
    EXPECT_EQ(term.word(block), expected) << what << ", " << count << " places";
  }
}

template <class T>
class FilterTerms : public ::testing::Test {
 public:
  // Of all magnitudes, with the smallest and largest that the type has, neighbours of 2^53, and NaN.
  static std::vector<T> values(std::size_t count) {
    CounterRandom random(17);
    std::vector<T> some = {T{0},
                           T{1},
                           T{2},
                           T{3},
                           std::numeric_limits<T>::max(),
                           std::numeric_limits<T>::lowest(),
                           static_cast<T>(std::numeric_limits<T>::max() - T{1})};
    if constexpr (sizeof(T) == 8)
      for (int d = -2; d <= 2; ++d) some.push_back(static_cast<T>((std::int64_t{1} << 53) + d));
    if constexpr (std::is_floating_point_v<T>)
      some.insert(some.end(), {T(nan), T(infinity), T(-infinity), T(0.5), T(-0.0), T(-2.5)});
    while (some.size() < count)
      some.push_back(std::is_floating_point_v<T> ? static_cast<T>(std::floor(random.between(-40, 40)) / 2)
                                                 : static_cast<T>(random.below(100)));
    return some;
  }
};

using AllScalars =
    ::testing::Types<float, double, std::int32_t, std::int64_t, std::uint8_t, std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(FilterTerms, AllScalars);

// v >= bound, where both are exact: long double holds every 64-bit integer here.
static_assert(std::numeric_limits<long double>::digits >= 64);

TYPED_TEST(FilterTerms, Ranges) {
  const std::vector<TypeParam> values = TestFixture::values(150);
  const double bounds[] = {-infinity, -1e300, -9.3e18, -0x1p63, -3.5,       -1.0,   0.0,    0.5,  1.0,   2.0,
                           2.5,       255.0,  4.3e9,   0x1p53,  0x1p53 + 2, 0x1p63, 0x1p64, 1e20, 1e300, infinity};
  for (const Lay lay : all_lays) {
    const Laid<TypeParam> laid(values, 1, lay);
    for (const double low : bounds) {
      for (const double high : bounds) {
        const RangeTerm term{laid.view(), 0, low, high};
        expect_answers(
            term, values.size(),
            [&](std::uint64_t item) {
              const auto v = static_cast<long double>(values[item]);
              return v >= static_cast<long double>(low) && v <= static_cast<long double>(high);
            },
            std::to_string(low) + " to " + std::to_string(high));
      }
    }
  }
}

TYPED_TEST(FilterTerms, Sets) {
  const std::vector<TypeParam> values = TestFixture::values(150);
  const std::vector<std::vector<std::int64_t>> sets = {
      {},
      {3},
      {2, 1, 2, 0, 3},
      {-3, -20, 7, 20, -20},
      {(std::int64_t{1} << 53) + 1, (std::int64_t{1} << 53) - 1},
      {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(), 99, -1, 254, 255}};
  Budget budget(0);
  for (const std::vector<std::int64_t>& members : sets) {
    const MemberSet set(budget, view_of(members, 1, INSITU_USE_TYPE));
    for (const Lay lay : all_lays) {
      const Laid<TypeParam> laid(values, 1, lay);
      const SetTerm term{laid.view(), 0, &set};
      expect_answers(
          term, values.size(),
          [&](std::uint64_t item) {
            const auto v = static_cast<long double>(values[item]);
            bool is_member = false;
            for (const std::int64_t m : members) is_member = is_member || v == static_cast<long double>(m);
            return is_member;
          },
          "set of " + std::to_string(members.size()));
    }
  }
}

// Of vectors: every component, and the length.
TYPED_TEST(FilterTerms, Components) {
  for (const std::uint32_t components : {2u, 3u, 4u}) {
    std::vector<TypeParam> values;
    CounterRandom random(components);
    for (std::size_t i = 0; i < 100 * components; ++i) values.push_back(static_cast<TypeParam>(random.below(5)));
    Budget budget(0);
    const std::vector<std::int32_t> members = {0, 2, 3, 5};
    const MemberSet set(budget, view_of(members, 1, INSITU_USE_TYPE));
    for (const Lay lay : all_lays) {
      const Laid<TypeParam> laid(values, components, lay);
      for (std::uint32_t component = 0; component <= components; ++component) {
        const auto value = [&](std::uint64_t item) {
          double squares = 0.0;
          for (std::uint32_t c = 0; c < components; ++c)
            if (component == 0 || c == component - 1) {
              const auto v = static_cast<double>(values[item * components + c]);
              squares += v * v;
            }
          return squares;
        };
        const RangeTerm range{laid.view(), component, 1.5, 3.9};
        expect_answers(
            range, 100, [&](std::uint64_t item) { return value(item) >= 2.25 && value(item) <= 15.21; }, "range");
        const SetTerm member{laid.view(), component, &set};
        // Lengths are computed by a root, whose last bit is not promised: of the single components only.
        if (component == 0) continue;
        expect_answers(
            member, 100,
            [&](std::uint64_t item) {
              const double root = std::sqrt(value(item));
              return root == 0.0 || root == 2.0 || root == 3.0 || root == 5.0;
            },
            "set");
      }
    }
  }
}

TEST(FilterSets, HugeAndUnsignedMembers) {
  const std::vector<std::uint64_t> members = {~std::uint64_t{0}, std::uint64_t{1} << 63, (std::uint64_t{1} << 53) + 1};
  const std::vector<std::uint64_t> values = {
      ~std::uint64_t{0},      ~std::uint64_t{0} - 1,        std::uint64_t{1} << 63,      (std::uint64_t{1} << 63) + 1,
      std::uint64_t{1} << 53, (std::uint64_t{1} << 53) + 1, (std::uint64_t{1} << 53) + 2};
  Budget budget(0);
  const MemberSet set(budget, view_of(members, 1, INSITU_USE_TYPE));
  const SetTerm term{attribute_of(values), 0, &set};
  expect_answers(
      term, values.size(),
      [&](std::uint64_t item) {
        return std::set<std::uint64_t>(members.begin(), members.end()).count(values[item]) > 0;
      },
      "u64");
  // The bits of a large unsigned number are not those of a negative one.
  const std::vector<std::int64_t> negative = {-1, std::numeric_limits<std::int64_t>::min(), 5};
  expect_answers(
      SetTerm{attribute_of(negative), 0, &set}, 3, [](std::uint64_t) { return false; }, "i64");
}

// Ids in a row become bits, ids here and there a list; both take no more memory than the list, and say the same.
TEST(FilterSets, MemoryIsCounted) {
  std::vector<std::int64_t> row;
  std::vector<std::int64_t> scattered;
  CounterRandom random(3);
  for (int i = 0; i < 5000; ++i) {
    row.push_back(1000000 + i + i / 100);
    scattered.push_back(static_cast<std::int64_t>(random.next() >> 2));
  }
  for (const std::vector<std::int64_t>* members : {&row, &scattered}) {
    Budget budget(0);
    {
      const MemberSet set(budget, view_of(*members, 1, INSITU_USE_TYPE));
      EXPECT_GT(budget.owned(), 0u);
      EXPECT_LE(budget.owned(), 8 * members->size() + 8);
      for (const std::int64_t m : *members) EXPECT_TRUE(set.contains_integer(m)) << m;
      const std::set<std::int64_t> plain(members->begin(), members->end());
      for (const std::int64_t m : *members)
        for (const std::int64_t other : {m - 1, m + 1})
          EXPECT_EQ(set.contains_integer(other), plain.count(other) > 0) << other;
      EXPECT_FALSE(set.contains(0.5 + static_cast<double>(members->front())));
      EXPECT_FALSE(set.contains(nan));
      EXPECT_FALSE(set.contains(infinity));
    }
    EXPECT_EQ(budget.owned(), 0u);
    Budget small(4096);
    EXPECT_THROW(MemberSet(small, view_of(*members, 1, INSITU_USE_TYPE)), Error);
    EXPECT_EQ(small.owned(), 0u);
  }
}

// Boxes and planes, in the world space of a lattice and of floating point positions; points on faces belong to them.
TEST(FilterPlaces, BoxesAndPlanes) {
  std::vector<std::int32_t> lattice;
  std::vector<double> direct;
  CounterRandom random(9);
  for (int i = 0; i < 600; ++i) {
    lattice.push_back(static_cast<std::int32_t>(random.below(9)) - 4);
    direct.push_back(1.0 + 0.25 * lattice.back());
  }
  direct[30] = nan;
  for (const bool integers : {true, false}) {
    WorldPositions world;
    world.position = integers ? positions_of(lattice) : positions_of(direct);
    if (integers) {
      world.scale = 0.25;
      for (double& o : world.origin) o = 1.0;
    }
    const auto x = [&](std::uint64_t item, std::uint64_t c) {
      return integers ? 1.0 + 0.25 * lattice[3 * item + c] : direct[3 * item + c];
    };
    BoxTerm box{world, {0.5, -infinity, 0.75}, {1.5, 1.0, 0.75}};
    expect_answers(
        box, 200,
        [&](std::uint64_t item) {
          return x(item, 0) >= 0.5 && x(item, 0) <= 1.5 && x(item, 1) <= 1.0 && x(item, 2) == 0.75;
        },
        "box");
    PlaneTerm plane{world, {1.0, -2.0, 0.5, -0.5}};
    expect_answers(
        plane, 200, [&](std::uint64_t item) { return x(item, 0) - 2.0 * x(item, 1) + 0.5 * x(item, 2) >= -0.5; },
        "plane");
  }
}

// Any formula in disjunctive normal form, against its truth item by item.
TEST(Filters, Formulas) {
  std::vector<double> values;
  CounterRandom random(21);
  for (int i = 0; i < 300; ++i) values.push_back(random.below(10) == 0 ? nan : random.unit());
  const ArrayView view = attribute_of(values);
  struct Part {
    double low, high;
    bool negated;
    std::uint32_t alternative;
  };
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Part> parts(1 + random.below(6));
    std::vector<FilterTerm> terms;
    for (Part& part : parts) {
      part = {random.between(-0.2, 0.8), random.between(0.2, 1.2), random.below(3) == 0,
              static_cast<std::uint32_t>(random.below(3) * 1000)};
      FilterTerm term;
      term.attribute = "v";
      term.range[0] = part.low;
      term.range[1] = part.high;
      term.negated = part.negated;
      term.alternative = part.alternative;
      terms.push_back(std::move(term));
    }
    const BoundFilter filter(std::make_shared<const Filter>(std::move(terms)), {}, [&](const std::string& name) {
      EXPECT_EQ(name, "v");
      return &view;
    });
    expect_answers(
        filter, values.size(),
        [&](std::uint64_t item) {
          for (const std::uint32_t alternative : {0u, 1000u, 2000u}) {
            bool exists = false;
            bool all = true;
            for (const Part& part : parts) {
              if (part.alternative != alternative) continue;
              exists = true;
              const bool inside = values[item] >= part.low && values[item] <= part.high;
              all = all && inside != part.negated;
            }
            if (exists && all) return true;
          }
          return false;
        },
        "formula");
  }
}

}  // namespace
}  // namespace insitu::testing
