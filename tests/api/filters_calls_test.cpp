// Statuses of insitu_particles_set_filter for whatever can be wrong, and when they come.
#include <gtest/gtest.h>

#include <limits>

#include "filter_terms.h"

namespace insitu::testing {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(FilterCalls, EveryBadMemberIsNamed) {
  const Studio studio;
  const insitu_context context = studio.context;
  const auto refuses = [&](const insitu_filter_term& term, std::initializer_list<std::string> words,
                           insitu_status status = INSITU_ERROR_INVALID_ARGUMENT) {
    // As the second of two: the number of the term is part of the text.
    const insitu_filter_term good = range_term("heat", -infinity, infinity);
    EXPECT_TRUE(fails(context, set_filter(context, studio.geometry, {good, term}), status, words));
    const std::string text = insitu_error_text(context);
    EXPECT_NE(text.find("term 1"), std::string::npos) << text;
  };
  insitu_filter_term term = range_term("heat", 0.0, 1.0);
  for (const std::uint32_t kind : {0u, 5u, ~0u}) {
    term.kind = kind;
    refuses(term, {"kind"});
  }
  for (const std::uint32_t kind : {INSITU_FILTER_RANGE, INSITU_FILTER_SET}) {
    term = filter_term(kind, "heat");
    const std::int32_t one = 1;
    const insitu_array members = insitu_array_records(INSITU_I32, 1, &one, 1, 0);
    term.set = &members;
    term.flags = 2;
    refuses(term, {"flags"});
    term.flags = 0;
    term.component = 5;
    refuses(term, {"component"});
    term.component = 0;
    term.attribute = nullptr;
    refuses(term, {"attribute"});
    term.attribute = "";
    refuses(term, {"attribute"});
  }
  for (const int end : {0, 1}) {
    term = range_term("heat", 0.0, 1.0);
    term.range[end] = nan;
    refuses(term, {"range", "not a number"});
  }
  for (int c = 0; c < 3; ++c) {
    term = filter_term(INSITU_FILTER_BOX);
    term.lower[c] = nan;
    refuses(term, {"lower", "not a number"});
    term.lower[c] = 0.0;
    term.upper[c] = nan;
    refuses(term, {"upper", "not a number"});
    term = filter_term(INSITU_FILTER_PLANE);
    term.plane[c] = infinity;
    refuses(term, {"normal", "finite"});
  }
  term = filter_term(INSITU_FILTER_PLANE);
  term.plane[3] = 1.0;
  refuses(term, {"normal", "length"});
  term.plane[0] = 1.0;
  term.plane[3] = nan;
  refuses(term, {"plane", "not a number"});

  term = filter_term(INSITU_FILTER_SET, "heat");
  refuses(term, {"set is NULL"});
  const double number = 1.0;
  insitu_array members = insitu_array_records(INSITU_F64, 1, &number, 1, 0);
  term.set = &members;
  refuses(term, {"set", "f64"}, INSITU_ERROR_UNSUPPORTED);
  members = insitu_array_records(INSITU_I32, 2, &number, 1, 0);
  refuses(term, {"set", "components"});
  members = insitu_array_records(INSITU_I32, 1, nullptr, 1, 0);
  refuses(term, {"set"});
  members.struct_size = 0;
  refuses(term, {"set", "insitu_array"});
  term = range_term("heat", 0.0, 1.0);
  term.struct_size = 0x5A5A5A5A;
  insitu_filter one_term = filter_of({});
  one_term.term_count = 1;
  one_term.terms = &term;
  EXPECT_TRUE(fails(context, insitu_particles_set_filter(context, studio.geometry, &one_term),
                    INSITU_ERROR_INVALID_ARGUMENT, {"insitu_filter_term"}));
}

TEST(FilterCalls, TheFilterAsAWhole) {
  const Studio studio;
  const insitu_context context = studio.context;
  insitu_filter filter = filter_of({});
  const auto set = [&] { return insitu_particles_set_filter(context, studio.geometry, &filter); };
  EXPECT_TRUE(works(context, set())) << "no terms: no filter";
  EXPECT_TRUE(works(context, insitu_particles_set_filter(context, studio.geometry, nullptr)));
  filter.term_count = 3;
  EXPECT_TRUE(fails(context, set(), INSITU_ERROR_INVALID_ARGUMENT, {"terms is NULL"}));
  const std::vector<insitu_filter_term> many(1025, filter_term(INSITU_FILTER_BOX));
  filter.terms = many.data();
  filter.term_count = 1025;
  EXPECT_TRUE(fails(context, set(), INSITU_ERROR_INVALID_ARGUMENT, {"1024"}));
  filter.term_count = 1024;
  EXPECT_TRUE(works(context, set()));
  filter.struct_size = 0;
  EXPECT_TRUE(fails(context, set(), INSITU_ERROR_INVALID_ARGUMENT, {"insitu_filter", "struct_size"}));
  filter = filter_of(many);
  filter.term_count = 1;
  EXPECT_TRUE(fails(context, insitu_particles_set_filter(context, {12345}, &filter), INSITU_ERROR_INVALID_HANDLE, {}));
  insitu_vectors_desc vectors;
  insitu_vectors_desc_init(&vectors);
  vectors.particles = studio.geometry;
  vectors.attribute = "speed";
  insitu_geometry arrows = {0};
  EXPECT_TRUE(works(context, insitu_vectors_create(context, &vectors, &arrows)));
  EXPECT_TRUE(fails(context, insitu_particles_set_filter(context, arrows, &filter), INSITU_ERROR_INVALID_HANDLE,
                    {"not a set of particles"}));
}

// Terms stand as far apart as the first one says; what a longer one has behind today's members must be zero.
TEST(FilterCalls, LongerTermsOfLaterHeaders) {
  const Studio studio;
  struct Longer {
    insitu_filter_term term;
    std::uint64_t more;
  };
  Longer terms[2] = {{range_term("heat", 0.0, 1.0), 0}, {filter_term(INSITU_FILTER_BOX), 0}};
  for (Longer& longer : terms) longer.term.struct_size = sizeof(Longer);
  insitu_filter filter = filter_of({});
  filter.term_count = 2;
  filter.terms = &terms[0].term;
  EXPECT_TRUE(works(studio.context, insitu_particles_set_filter(studio.context, studio.geometry, &filter)));
  terms[1].more = 1;
  EXPECT_TRUE(fails(studio.context, insitu_particles_set_filter(studio.context, studio.geometry, &filter),
                    INSITU_ERROR_ABI, {"insitu_filter_term"}));
}

// An attribute that is not there: at the call when arrays are bound, otherwise at the commit; and before anything
// moves.
TEST(FilterCalls, UnknownAttributes) {
  Studio studio(INSITU_ORDER_PERMUTE);
  const insitu_context context = studio.context;
  Cloud cloud(20);
  std::vector<float> heat(60, 1.0f);
  insitu_array values = insitu_array_records(INSITU_F32, 3, heat.data(), 20, 0);
  values.flags = cloud.position.flags = INSITU_ARRAY_PERMUTABLE;
  const insitu_attribute attribute = {"heat", &values};
  cloud.desc.attributes = &attribute;
  cloud.desc.attribute_count = 1;
  const std::vector<double> before = cloud.xyz;
  EXPECT_TRUE(works(context, set_filter(context, studio.geometry, {range_term("speed", 0.0, 1.0)})));
  EXPECT_TRUE(works(context, insitu_step_begin(context, 0, 0.0)));
  EXPECT_TRUE(works(context, insitu_particles_update(context, studio.geometry, &cloud.desc)));
  EXPECT_TRUE(fails(context, insitu_commit(context), INSITU_ERROR_INVALID_ARGUMENT, {"'speed'", "there are: heat"}));
  EXPECT_EQ(cloud.xyz, before);
  EXPECT_EQ(insitu_step_end(context), INSITU_ERROR_INVALID_ARGUMENT);

  // The call that fails leaves the filter that was there.
  EXPECT_TRUE(works(context, set_filter(context, studio.geometry, {range_term("heat", 2.0, 3.0)})));
  for (const auto& [name, component, word] :
       {std::tuple{"type", 0u, "there are: heat"}, std::tuple{"heat", 4u, "3 components"}}) {
    EXPECT_TRUE(works(context, insitu_step_begin(context, 1, 0.0)));
    EXPECT_TRUE(works(context, insitu_particles_update(context, studio.geometry, &cloud.desc)));
    insitu_filter_term term = range_term(name, 0.0, 1.0);
    term.component = component;
    EXPECT_TRUE(
        fails(context, set_filter(context, studio.geometry, {term}), INSITU_ERROR_INVALID_ARGUMENT, {name, word}));
    EXPECT_EQ(insitu_step_end(context), INSITU_ERROR_INVALID_ARGUMENT);
  }
  EXPECT_TRUE(works(context, studio.step(cloud.desc, 2)));
  EXPECT_EQ(studio.context.stats().items_filtered, 20u);
  EXPECT_EQ(studio.picture().hits(), 0u);
}

// Members of sets and bits of places count against max_extra_bytes; what does not fit is an error that names the
// filter.
TEST(FilterCalls, StaysWithinTheBudget) {
  Cloud cloud(200000);
  cloud.desc.order = INSITU_ORDER_PERMUTE;
  cloud.position.flags = INSITU_ARRAY_PERMUTABLE;
  Studio studio(INSITU_ORDER_PERMUTE, 1, 40000);
  const insitu_context context = studio.context;
  insitu_filter_term box = filter_term(INSITU_FILTER_BOX);
  for (double& x : box.upper) x = 0.5;
  EXPECT_TRUE(works(context, studio.step(cloud.desc, 0)));
  const std::uint64_t owned = studio.context.stats().owned_bytes;
  EXPECT_TRUE(works(context, set_filter(context, studio.geometry, {box})));
  EXPECT_TRUE(works(context, studio.step(cloud.desc, 1)));
  EXPECT_GE(studio.context.stats().owned_bytes, owned + 25000);
  EXPECT_LE(studio.context.stats().owned_bytes, owned + 25600);
  EXPECT_TRUE(works(context, set_filter(context, studio.geometry, {})));
  EXPECT_TRUE(works(context, studio.step(cloud.desc, 2)));
  EXPECT_EQ(studio.context.stats().owned_bytes, owned);

  const std::vector<std::int64_t> ids(10000, 5);
  const insitu_array members = insitu_array_records(INSITU_I64, 1, ids.data(), ids.size(), 0);
  insitu_filter_term set = filter_term(INSITU_FILTER_SET, "id");
  set.set = &members;
  EXPECT_TRUE(fails(context, set_filter(context, studio.geometry, {set}), INSITU_ERROR_OVER_BUDGET, {"filter"}));
  EXPECT_EQ(studio.context.stats().owned_bytes, owned);

  Studio small(INSITU_ORDER_PERMUTE, 1, owned + 20000);
  EXPECT_TRUE(works(small.context, set_filter(small.context, small.geometry, {box})));
  EXPECT_TRUE(fails(small.context, small.step(cloud.desc, 0), INSITU_ERROR_OVER_BUDGET, {"filter"}));
  EXPECT_TRUE(works(small.context, set_filter(small.context, small.geometry, {})));
  EXPECT_TRUE(works(small.context, small.step(cloud.desc, 1)));
}

// Set members are copied during the call, and nothing of a term is kept.
TEST(FilterCalls, NothingOfTheCallersIsKept) {
  Studio studio;
  const insitu_context context = studio.context;
  Cloud cloud(30);
  std::vector<std::int32_t> type(30, 4);
  const insitu_array types = insitu_array_records(INSITU_I32, 1, type.data(), 30, 0);
  cloud.desc.type = &types;
  {
    std::vector<std::int32_t> members = {9, 4, 4};
    const insitu_array array = insitu_array_records(INSITU_I32, 1, members.data(), 3, 0);
    std::string name = "type";
    insitu_filter_term term = filter_term(INSITU_FILTER_SET, name.c_str());
    term.set = &array;
    EXPECT_TRUE(works(context, set_filter(context, studio.geometry, {term})));
    std::fill(members.begin(), members.end(), 0);
    name = "nope";
    term.flags = INSITU_FILTER_NOT;
  }
  EXPECT_TRUE(works(context, studio.step(cloud.desc, 0)));
  EXPECT_EQ(studio.context.stats().items_filtered, 0u);
  EXPECT_GT(studio.picture().hits(), 0u);
}

}  // namespace
}  // namespace insitu::testing
