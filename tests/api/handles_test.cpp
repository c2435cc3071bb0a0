// Ids that are stale, foreign, of another kind, or no ids at all: an error for every function, never a crash.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Context;
using testing::fails;
using testing::works;

// One object of each kind.
struct Objects {
  explicit Objects(insitu_context context)
      : geometry(testing::make_particles(context)),
        view(testing::make_view(context)),
        image(testing::make_image(context, 4, 4)) {
    const double gold[4] = {1.0, 0.8, 0.0, 1.0};
    insitu_colormap_desc desc;
    insitu_colormap_desc_init(&desc);
    desc.rgba = gold;
    desc.count = 1;
    EXPECT_TRUE(works(context, insitu_colormap_create(context, &desc, &colormap)));
  }
  insitu_geometry geometry;
  insitu_view view;
  insitu_image image;
  insitu_colormap colormap = {0};
};

struct Call {
  const char* name;
  const char* kind;  // of the id that it takes
  std::function<insitu_status(insitu_context, std::uint64_t id, const Objects&)> call;
};

// Every function that takes an id, with good arguments besides.
std::vector<Call> every_call() {
  static const double background[4] = {0.1, 0.2, 0.3, 1.0};
  static const testing::Cloud cloud(5);
  std::vector<Call> calls;
  const auto of_geometry = [&](const char* name, auto call) {
    calls.push_back({name, "geometry", [call](insitu_context c, std::uint64_t id, const Objects&) {
                       return call(c, insitu_geometry{id});
                     }});
  };
  const auto of_view = [&](const char* name, auto call) {
    calls.push_back({name, "view",
                     [call](insitu_context c, std::uint64_t id, const Objects&) { return call(c, insitu_view{id}); }});
  };
  const auto of_image = [&](const char* name, auto call) {
    calls.push_back({name, "image",
                     [call](insitu_context c, std::uint64_t id, const Objects&) { return call(c, insitu_image{id}); }});
  };
  of_geometry("update", [](insitu_context c, insitu_geometry g) { return insitu_particles_update(c, g, &cloud.desc); });
  of_geometry("permutation", [](insitu_context c, insitu_geometry g) {
    std::uint64_t original[8];
    return insitu_particles_permutation(c, g, original, 8);
  });
  of_geometry("restore_order", insitu_particles_restore_order);
  of_geometry("set_style", [](insitu_context c, insitu_geometry g) {
    insitu_style style;
    insitu_style_init(&style);
    return insitu_geometry_set_style(c, g, &style);
  });
  of_geometry("bounds", [](insitu_context c, insitu_geometry g) {
    double lower[3];
    double upper[3];
    return insitu_geometry_bounds(c, g, lower, upper);
  });
  of_geometry("geometry_destroy", insitu_geometry_destroy);
  of_view("set_camera", [](insitu_context c, insitu_view v) {
    insitu_camera camera;
    insitu_camera_init(&camera);
    return insitu_view_set_camera(c, v, &camera);
  });
  of_view("get_camera", [](insitu_context c, insitu_view v) {
    insitu_camera camera;
    insitu_camera_init(&camera);
    return insitu_view_get_camera(c, v, &camera);
  });
  of_view("set_effects", [](insitu_context c, insitu_view v) {
    insitu_effects effects;
    insitu_effects_init(&effects);
    return insitu_view_set_effects(c, v, &effects);
  });
  of_view("set_lights", [](insitu_context c, insitu_view v) { return insitu_view_set_lights(c, v, nullptr, 0); });
  of_view("set_background",
          [](insitu_context c, insitu_view v) { return insitu_view_set_background(c, v, background); });
  of_view("fit", [](insitu_context c, insitu_view v) { return insitu_view_fit(c, v, 1.0); });
  of_view("turn", [](insitu_context c, insitu_view v) { return insitu_view_turn(c, v, 1.0); });
  of_view("view_destroy", insitu_view_destroy);
  of_image("write", [](insitu_context c, insitu_image i) { return insitu_image_write(c, i, "never.png"); });
  of_image("channel", [](insitu_context c, insitu_image i) {
    insitu_array array;
    insitu_array_init(&array);
    return insitu_image_channel(c, i, INSITU_CHANNEL_COLOR, &array);
  });
  of_image("image_destroy", insitu_image_destroy);
  calls.push_back({"colormap_destroy", "colormap", [](insitu_context c, std::uint64_t id, const Objects&) {
                     return insitu_colormap_destroy(c, insitu_colormap{id});
                   }});
  calls.push_back({"own_map", "colormap", [](insitu_context c, std::uint64_t id, const Objects& objects) {
                     insitu_style style;
                     insitu_style_init(&style);
                     style.own_map.id = id;
                     return insitu_geometry_set_style(c, objects.geometry, &style);
                   }});
  calls.push_back({"render view", "view", [](insitu_context c, std::uint64_t id, const Objects& objects) {
                     return insitu_render(c, insitu_view{id}, objects.image);
                   }});
  calls.push_back({"render image", "image", [](insitu_context c, std::uint64_t id, const Objects& objects) {
                     return insitu_render(c, objects.view, insitu_image{id});
                   }});
  return calls;
}

// In and outside of a step: an id is judged before the state is.
void expect_refused(insitu_context context, const Call& call, std::uint64_t id, const Objects& objects,
                    const char* word) {
  SCOPED_TRACE(call.name);
  SCOPED_TRACE(word);
  if (id == 0 && std::string(call.name) == "own_map") return;  // 0 stands for "by name" there
  EXPECT_TRUE(fails(context, call.call(context, id, objects), INSITU_ERROR_INVALID_HANDLE, {call.kind, word}));
  insitu_step_begin(context, 0, 0.0);
  insitu_commit(context);
  EXPECT_TRUE(fails(context, call.call(context, id, objects), INSITU_ERROR_INVALID_HANDLE, {call.kind, word}));
  EXPECT_EQ(insitu_step_end(context), INSITU_ERROR_INVALID_HANDLE);
}

TEST(Handles, ThatNeverWere) {
  const Context context;
  const Objects objects(context);
  for (const Call& call : every_call()) {
    expect_refused(context, call, 0, objects, "0");
    expect_refused(context, call, 1, objects, "not that of");
    expect_refused(context, call, ~std::uint64_t{0}, objects, "not that of");
  }
}

TEST(Handles, OfAnotherKind) {
  const Context context;
  const Objects objects(context);
  for (const Call& call : every_call()) {
    const std::string kind = call.kind;
    if (kind != "geometry") expect_refused(context, call, objects.geometry.id, objects, "not that of");
    if (kind != "view") expect_refused(context, call, objects.view.id, objects, "not that of");
    if (kind != "image") expect_refused(context, call, objects.image.id, objects, "not that of");
    if (kind != "colormap") expect_refused(context, call, objects.colormap.id, objects, "not that of");
  }
}

TEST(Handles, OfAnotherContext) {
  const Context context;
  const Context other;
  const Objects objects(context);
  const Objects foreign(other);
  for (const Call& call : every_call()) {
    const std::string kind = call.kind;
    const std::uint64_t id = kind == "geometry" ? foreign.geometry.id
                             : kind == "view"   ? foreign.view.id
                             : kind == "image"  ? foreign.image.id
                                                : foreign.colormap.id;
    expect_refused(context, call, id, objects, "another context");
  }
  // They are all still there.
  EXPECT_TRUE(works(other, insitu_geometry_destroy(other, foreign.geometry)));
  EXPECT_TRUE(works(other, insitu_view_destroy(other, foreign.view)));
  EXPECT_TRUE(works(other, insitu_image_destroy(other, foreign.image)));
  EXPECT_TRUE(works(other, insitu_colormap_destroy(other, foreign.colormap)));
}

// A context that is made in the place of one that is gone does not take up its ids.
TEST(Handles, OfAContextThatIsGone) {
  insitu_geometry geometry;
  {
    const Context context;
    geometry = testing::make_particles(context);
  }
  const Context context;
  testing::make_particles(context);
  EXPECT_TRUE(fails(context, insitu_geometry_destroy(context, geometry), INSITU_ERROR_INVALID_HANDLE, {"geometry"}));
}

// There are 255 numbers for contexts within an id; the 256th context has that of the first.
TEST(Handles, OfAContextThatIsLongGone) {
  std::vector<insitu_geometry> gone;
  for (int i = 0; i < 255; ++i) {
    const Context context;
    gone.push_back(testing::make_particles(context));
  }
  const Context context;
  testing::make_particles(context);
  for (const insitu_geometry geometry : gone)
    EXPECT_TRUE(fails(context, insitu_geometry_destroy(context, geometry), INSITU_ERROR_INVALID_HANDLE, {"geometry"}));
}

TEST(Handles, OfWhatWasDestroyed) {
  const Context context;
  const Objects objects(context);
  // Once with the place empty, once with another object in it.
  for (const bool reused : {false, true}) {
    for (const Call& call : every_call()) {
      const std::string kind = call.kind;
      const Objects gone(context);
      EXPECT_TRUE(works(context, insitu_geometry_destroy(context, gone.geometry)));
      EXPECT_TRUE(works(context, insitu_view_destroy(context, gone.view)));
      EXPECT_TRUE(works(context, insitu_image_destroy(context, gone.image)));
      EXPECT_TRUE(works(context, insitu_colormap_destroy(context, gone.colormap)));
      if (reused) Objects{context};
      const std::uint64_t id = kind == "geometry" ? gone.geometry.id
                               : kind == "view"   ? gone.view.id
                               : kind == "image"  ? gone.image.id
                                                  : gone.colormap.id;
      expect_refused(context, call, id, objects, "destroyed");
    }
  }
}

// A style keeps the id of a colour map; when that is gone, the next commit says so.
TEST(Handles, AStyleWhoseColourMapIsGone) {
  testing::Studio studio;
  const Objects objects(studio.context);
  insitu_style style;
  insitu_style_init(&style);
  style.own_map = objects.colormap;
  ASSERT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
  const testing::Cloud cloud(10);
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  EXPECT_TRUE(works(studio.context, insitu_colormap_destroy(studio.context, objects.colormap)));
  EXPECT_TRUE(fails(studio.context, studio.step(cloud.desc), INSITU_ERROR_INVALID_HANDLE, {"colormap", "destroyed"}));
  style.own_map.id = 0;
  EXPECT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
}

// A set that is not updated takes no part in a step, and neither does what is wrong with its style.
TEST(Handles, AStyleOfASetThatIsAbsent) {
  testing::Studio studio;
  const Objects objects(studio.context);
  insitu_style style;
  insitu_style_init(&style);
  style.own_map = objects.colormap;
  ASSERT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, objects.geometry, &style)));
  EXPECT_TRUE(works(studio.context, insitu_colormap_destroy(studio.context, objects.colormap)));
  const testing::Cloud cloud(10);
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
}

// Objects may go in the middle of a step; what is left is drawn.
TEST(Handles, DestroyedInAStep) {
  const Context context;
  const insitu_geometry first = testing::make_particles(context);
  const insitu_geometry second = testing::make_particles(context);
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 16, 16);
  const testing::Cloud one(30, 1);
  const testing::Cloud two(30, 2);

  EXPECT_TRUE(works(context, run_step(context, first, one.desc, view, image)));
  const testing::Picture alone = testing::read_picture(context, image);
  insitu_step_begin(context, 1, 0.0);
  insitu_particles_update(context, first, &one.desc);
  insitu_particles_update(context, second, &two.desc);
  EXPECT_TRUE(works(context, insitu_commit(context)));
  EXPECT_TRUE(works(context, insitu_render(context, view, image)));
  EXPECT_FALSE(testing::read_picture(context, image) == alone);
  EXPECT_TRUE(works(context, insitu_geometry_destroy(context, second)));
  EXPECT_TRUE(works(context, insitu_render(context, view, image)));
  EXPECT_EQ(testing::read_picture(context, image), alone);
  EXPECT_TRUE(works(context, insitu_geometry_destroy(context, first)));
  EXPECT_TRUE(works(context, insitu_render(context, view, image)));
  EXPECT_EQ(testing::read_picture(context, image).hits(), 0u);
  EXPECT_TRUE(works(context, insitu_image_destroy(context, image)));
  EXPECT_TRUE(works(context, insitu_view_destroy(context, view)));
  EXPECT_TRUE(works(context, insitu_step_end(context)));
}

// A context goes in the middle of a step, with all that it has.
TEST(Handles, AContextDestroyedInAStep) {
  testing::Studio studio;
  const testing::Cloud cloud(30);
  insitu_context context = nullptr;
  ASSERT_EQ(insitu_context_create(nullptr, &context), INSITU_OK);
  const insitu_geometry geometry = testing::make_particles(context);
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 4, 4);
  insitu_step_begin(context, 0, 0.0);
  insitu_particles_update(context, geometry, &cloud.desc);
  insitu_commit(context);
  EXPECT_TRUE(works(context, insitu_render(context, view, image)));
  insitu_context_destroy(context);
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
}

}  // namespace
}  // namespace insitu
