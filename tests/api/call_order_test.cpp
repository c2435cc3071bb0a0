// Calls outside of their place, the first error of a step that sticks, and the step after it.
#include <gtest/gtest.h>

#include <functional>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Cloud;
using testing::Context;
using testing::fails;
using testing::Studio;
using testing::TemporaryFolder;
using testing::works;

constexpr insitu_status wrong_state = INSITU_ERROR_WRONG_STATE;

struct NamedCall {
  const char* name;
  std::function<insitu_status()> call;
};

// What may only be called between step_begin and step_end, and of it what may only follow a commit.
struct CallsOfAStep {
  explicit CallsOfAStep(Studio& studio, const Cloud& cloud) {
    const insitu_context c = studio.context;
    in_step = {{"insitu_particles_update",
                [c, &studio, &cloud] { return insitu_particles_update(c, studio.geometry, &cloud.desc); }},
               {"insitu_commit", [c] { return insitu_commit(c); }}};
    after_commit = {{"insitu_render", [c, &studio] { return insitu_render(c, studio.view, studio.image); }},
                    {"insitu_view_fit", [c, &studio] { return insitu_view_fit(c, studio.view, 1.0); }},
                    {"insitu_geometry_bounds",
                     [c, &studio, this] { return insitu_geometry_bounds(c, studio.geometry, lower, upper); }},
                    {"insitu_particles_permutation",
                     [c, &studio, this] { return insitu_particles_permutation(c, studio.geometry, original, 64); }},
                    {"insitu_particles_restore_order",
                     [c, &studio] { return insitu_particles_restore_order(c, studio.geometry); }}};
  }
  CallsOfAStep(const CallsOfAStep&) = delete;
  CallsOfAStep& operator=(const CallsOfAStep&) = delete;

  double lower[3];
  double upper[3];
  std::uint64_t original[64];
  std::vector<NamedCall> in_step;
  std::vector<NamedCall> after_commit;
};

TEST(CallOrder, OutsideOfAStep) {
  Studio studio;
  const Cloud cloud(10);
  const CallsOfAStep calls(studio, cloud);
  const auto expect_refused = [&] {
    for (const auto* list : {&calls.in_step, &calls.after_commit})
      for (const NamedCall& call : *list)
        EXPECT_TRUE(fails(studio.context, call.call(), wrong_state, {call.name, "insitu_step_begin"}));
    EXPECT_TRUE(fails(studio.context, insitu_step_end(studio.context), wrong_state, {"insitu_step_end"}));
    insitu_geometry out = {5};
    EXPECT_TRUE(fails(studio.context, insitu_particles_create(studio.context, &cloud.desc, &out), wrong_state,
                      {"insitu_step_begin"}));
    EXPECT_EQ(out.id, 0u);
  };
  expect_refused();
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc))) << "errors outside of a step do not stick";
  expect_refused();
}

TEST(CallOrder, BeforeTheCommit) {
  Studio studio;
  const Cloud cloud(10);
  const CallsOfAStep calls(studio, cloud);
  for (const NamedCall& call : calls.after_commit) {
    insitu_step_begin(studio.context, 0, 0.0);
    insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
    EXPECT_TRUE(fails(studio.context, call.call(), wrong_state, {call.name, "insitu_commit"}));
    EXPECT_EQ(insitu_step_end(studio.context), wrong_state);
    EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  }
}

TEST(CallOrder, TwoBegins) {
  Studio studio;
  const Cloud cloud(10);
  insitu_step_begin(studio.context, 3, 1.5);
  EXPECT_TRUE(fails(studio.context, insitu_step_begin(studio.context, 4, 2.0), wrong_state, {"insitu_step_end"}));
  EXPECT_EQ(studio.context.stats().step, 3u) << "the open step goes on";
  EXPECT_EQ(insitu_step_end(studio.context), wrong_state);
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
}

// An update after the commit takes another commit, not a picture of something that was not built.
TEST(CallOrder, AnUpdateAfterTheCommit) {
  Studio studio;
  const Cloud cloud(10);
  const Cloud other(10, 2);
  insitu_step_begin(studio.context, 0, 0.0);
  insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
  insitu_commit(studio.context);
  EXPECT_TRUE(works(studio.context, insitu_particles_update(studio.context, studio.geometry, &other.desc)));
  EXPECT_TRUE(fails(studio.context, insitu_render(studio.context, studio.view, studio.image), wrong_state, {"commit"}));
  EXPECT_EQ(insitu_step_end(studio.context), wrong_state);

  ASSERT_TRUE(works(studio.context, studio.step(other.desc)));
  const testing::Picture expected = studio.picture();
  insitu_step_begin(studio.context, 0, 0.0);
  insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
  insitu_commit(studio.context);
  insitu_particles_update(studio.context, studio.geometry, &other.desc);
  insitu_commit(studio.context);
  insitu_render(studio.context, studio.view, studio.image);
  ASSERT_TRUE(works(studio.context, insitu_step_end(studio.context)));
  EXPECT_EQ(studio.picture(), expected);
}

// A set that is not updated is not in the picture: no pointer survives its step.
TEST(CallOrder, NothingIsKept) {
  Studio studio;
  {
    const Cloud cloud(10);
    ASSERT_TRUE(works(studio.context, studio.step(cloud.desc)));
    EXPECT_GT(studio.picture().hits(), 0u);
  }
  insitu_step_begin(studio.context, 1, 0.0);
  insitu_commit(studio.context);
  EXPECT_TRUE(works(studio.context, insitu_render(studio.context, studio.view, studio.image)));
  double lower[3];
  double upper[3];
  EXPECT_TRUE(works(studio.context, insitu_geometry_bounds(studio.context, studio.geometry, lower, upper)));
  EXPECT_GT(lower[0], upper[0]);
  EXPECT_TRUE(works(studio.context, insitu_step_end(studio.context)));
  EXPECT_EQ(studio.picture().hits(), 0u);
  EXPECT_EQ(studio.context.stats().items, 0u);
}

TEST(CallOrder, WhatAPermutationNeeds) {
  std::uint64_t original[20];
  const auto begin = [](Studio& studio, Cloud& cloud) {
    cloud.position.flags = INSITU_ARRAY_PERMUTABLE;
    insitu_step_begin(studio.context, 0, 0.0);
    insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
    EXPECT_TRUE(works(studio.context, insitu_commit(studio.context)));
  };
  {
    Studio studio(INSITU_ORDER_PERMUTE);  // without KEEP_PERMUTATION
    Cloud cloud(20);
    begin(studio, cloud);
    EXPECT_TRUE(fails(studio.context, insitu_particles_permutation(studio.context, studio.geometry, original, 20),
                      wrong_state, {"INSITU_PARTICLES_KEEP_PERMUTATION"}));
    EXPECT_EQ(insitu_step_end(studio.context), wrong_state);
    begin(studio, cloud);
    EXPECT_TRUE(fails(studio.context, insitu_particles_restore_order(studio.context, studio.geometry), wrong_state,
                      {"INSITU_PARTICLES_KEEP_PERMUTATION"}));
    EXPECT_EQ(insitu_step_end(studio.context), wrong_state);
  }
  Studio studio(INSITU_ORDER_INDEX);
  Cloud cloud(20);
  begin(studio, cloud);
  EXPECT_TRUE(fails(studio.context, insitu_particles_permutation(studio.context, studio.geometry, original, 19),
                    INSITU_ERROR_INVALID_ARGUMENT, {"19", "20"}));
  insitu_step_end(studio.context);
  begin(studio, cloud);
  EXPECT_TRUE(fails(studio.context, insitu_particles_permutation(studio.context, studio.geometry, nullptr, 20),
                    INSITU_ERROR_INVALID_ARGUMENT, {"original", "NULL"}));
  insitu_step_end(studio.context);
  begin(studio, cloud);
  EXPECT_TRUE(fails(studio.context, insitu_particles_restore_order(studio.context, studio.geometry), wrong_state,
                    {"INSITU_ORDER_PERMUTE"}));
  insitu_step_end(studio.context);
}

// After the order is restored the set is absent, and cannot be restored again.
TEST(CallOrder, RestoredTwice) {
  const Context context;
  const insitu_geometry geometry =
      testing::make_particles(context, INSITU_ORDER_PERMUTE, INSITU_PARTICLES_KEEP_PERMUTATION);
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 16, 16);
  Cloud cloud(200);
  cloud.position.flags = INSITU_ARRAY_PERMUTABLE;
  const std::vector<double> before = cloud.xyz;
  insitu_step_begin(context, 0, 0.0);
  insitu_particles_update(context, geometry, &cloud.desc);
  insitu_commit(context);
  EXPECT_NE(cloud.xyz, before);
  EXPECT_TRUE(works(context, insitu_particles_restore_order(context, geometry)));
  EXPECT_EQ(cloud.xyz, before);
  EXPECT_TRUE(works(context, insitu_render(context, view, image)));
  EXPECT_EQ(testing::read_picture(context, image).hits(), 0u);
  EXPECT_TRUE(fails(context, insitu_particles_restore_order(context, geometry), wrong_state, {}));
  EXPECT_EQ(cloud.xyz, before);
  EXPECT_EQ(insitu_step_end(context), wrong_state);
}

TEST(CallOrder, AnImageWithoutAPicture) {
  Studio studio;
  const TemporaryFolder folder;
  EXPECT_TRUE(fails(studio.context, insitu_image_write(studio.context, studio.image, folder.file("a.png").c_str()),
                    wrong_state, {"rendered"}));
  EXPECT_TRUE(folder.names().empty());
  // Its pixels can be looked at all the same: background.
  EXPECT_EQ(studio.picture().hits(), 0u);
}

TEST(CallOrder, TheFirstErrorSticks) {
  Studio studio;
  const Cloud cloud(10);
  const TemporaryFolder folder;
  ASSERT_TRUE(works(studio.context, studio.step(cloud.desc)));
  const testing::Picture picture = studio.picture();

  insitu_step_begin(studio.context, 1, 0.0);
  EXPECT_TRUE(
      fails(studio.context, insitu_render(studio.context, studio.view, {0}), INSITU_ERROR_INVALID_HANDLE, {"image"}));
  const std::string text = studio.context.error();
  // Everything else returns the same, and does nothing.
  EXPECT_EQ(insitu_particles_update(studio.context, studio.geometry, nullptr), INSITU_ERROR_INVALID_HANDLE);
  EXPECT_EQ(insitu_particles_update(studio.context, studio.geometry, &cloud.desc), INSITU_ERROR_INVALID_HANDLE);
  EXPECT_EQ(insitu_commit(studio.context), INSITU_ERROR_INVALID_HANDLE);
  EXPECT_EQ(insitu_render(studio.context, studio.view, studio.image), INSITU_ERROR_INVALID_HANDLE);
  EXPECT_EQ(insitu_image_write(studio.context, studio.image, folder.file("a.png").c_str()),
            INSITU_ERROR_INVALID_HANDLE);
  insitu_view view = {9};
  EXPECT_EQ(insitu_view_create(studio.context, nullptr, &view), INSITU_ERROR_INVALID_HANDLE);
  EXPECT_EQ(view.id, 0u);
  EXPECT_EQ(insitu_step_begin(studio.context, 2, 0.0), INSITU_ERROR_INVALID_HANDLE);
  EXPECT_EQ(studio.context.error(), text);
  EXPECT_TRUE(folder.names().empty());
  EXPECT_EQ(studio.context.stats().items, 0u);
  EXPECT_EQ(studio.context.stats().step, 1u);

  EXPECT_EQ(insitu_step_end(studio.context), INSITU_ERROR_INVALID_HANDLE);
  EXPECT_EQ(studio.context.error(), text) << "the text of the first error, once more";
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc))) << "and then it is over";
  EXPECT_EQ(studio.picture(), picture);
}

// Destroying works after an error too: a host that gives up can clean up.
TEST(CallOrder, DestroyingAfterAnError) {
  Studio studio;
  insitu_step_begin(studio.context, 0, 0.0);
  EXPECT_NE(insitu_render(studio.context, studio.view, studio.image), INSITU_OK);
  EXPECT_TRUE(works(studio.context, insitu_geometry_destroy(studio.context, studio.geometry)));
  EXPECT_TRUE(works(studio.context, insitu_view_destroy(studio.context, studio.view)));
  EXPECT_TRUE(works(studio.context, insitu_image_destroy(studio.context, studio.image)));
  EXPECT_EQ(insitu_step_end(studio.context), wrong_state);
}

// insitu.h: the text is valid until the next call that fails, so calls that succeed leave it alone.
TEST(CallOrder, TheTextOutlivesSuccess) {
  Studio studio;
  const Cloud cloud(10);
  EXPECT_NE(insitu_commit(studio.context), INSITU_OK);
  const char* text = insitu_error_text(studio.context);
  const std::string copy = text;
  ASSERT_FALSE(copy.empty());
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  EXPECT_EQ(copy, insitu_error_text(studio.context));
  EXPECT_EQ(copy, text);
}

// Messages come on the calling thread, up to the level that was asked for; errors are told once.
TEST(CallOrder, Messages) {
  struct Log {
    std::vector<std::pair<int, std::string>> lines;
  } log;
  const auto note = [](void* user, std::int32_t level, const char* text) {
    static_cast<Log*>(user)->lines.emplace_back(level, text);
  };
  Studio studio;
  Cloud cloud(10);
  cloud.xyz[4] = 1.0 / 0.0;
  EXPECT_TRUE(works(studio.context, insitu_context_set_log(studio.context, note, &log, INSITU_LOG_WARNING)));
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  ASSERT_EQ(log.lines.size(), 1u);
  EXPECT_EQ(log.lines[0].first, INSITU_LOG_WARNING);
  EXPECT_NE(log.lines[0].second.find("1 of 10"), std::string::npos) << log.lines[0].second;

  EXPECT_TRUE(works(studio.context, insitu_context_set_log(studio.context, note, &log, INSITU_LOG_ERROR)));
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  EXPECT_EQ(log.lines.size(), 1u);
  insitu_step_begin(studio.context, 0, 0.0);
  insitu_render(studio.context, studio.view, studio.image);
  insitu_render(studio.context, studio.view, studio.image);
  insitu_step_end(studio.context);
  ASSERT_EQ(log.lines.size(), 2u);
  EXPECT_EQ(log.lines[1].first, INSITU_LOG_ERROR);

  EXPECT_TRUE(works(studio.context, insitu_context_set_log(studio.context, nullptr, nullptr, INSITU_LOG_INFO)));
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  EXPECT_EQ(log.lines.size(), 2u);
}

// The two higher levels of checks find what the host did wrong.
TEST(CallOrder, Checks) {
  Cloud cloud(50);
  std::vector<double> values(50, 1.0);
  const insitu_array value = insitu_array_records(INSITU_F64, 1, values.data(), 50, 0);
  const insitu_attribute attribute = {"heat", &value};
  cloud.desc.attributes = &attribute;
  cloud.desc.attribute_count = 1;
  std::string warning;
  const auto note = [](void* user, std::int32_t, const char* text) { *static_cast<std::string*>(user) = text; };
  for (const std::uint32_t level : {INSITU_CHECK_POINTERS, INSITU_CHECK_VALUES, INSITU_CHECK_CHECKSUM}) {
    SCOPED_TRACE(level);
    const Context context(0, 0, 0, level);
    insitu_context_set_log(context, note, &warning, INSITU_LOG_WARNING);
    const insitu_geometry geometry = testing::make_particles(context);
    values[3] = values[9] = 0.0 / 0.0;
    warning.clear();
    insitu_step_begin(context, 0, 0.0);
    EXPECT_TRUE(works(context, insitu_particles_update(context, geometry, &cloud.desc)));
    EXPECT_TRUE(works(context, insitu_commit(context)));
    EXPECT_TRUE(works(context, insitu_step_end(context)));
    if (level >= INSITU_CHECK_VALUES) {
      EXPECT_NE(warning.find("'heat' has 2"), std::string::npos) << warning;
    } else {
      EXPECT_EQ(warning, "");
    }

    insitu_step_begin(context, 0, 0.0);
    insitu_particles_update(context, geometry, &cloud.desc);
    insitu_commit(context);
    cloud.xyz[17] += 1e-9;  // the host forgot that the array is lent
    const insitu_status status = insitu_step_end(context);
    if (level >= INSITU_CHECK_CHECKSUM) {
      EXPECT_TRUE(fails(context, status, wrong_state, {"changed"}));
    } else {
      EXPECT_TRUE(works(context, status));
    }
  }
}

}  // namespace
}  // namespace insitu
