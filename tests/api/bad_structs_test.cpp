// Descriptors: their sizes, members that this version does not know, and values that are not in any list.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "api_test_tools.h"
#include "guarded_memory.h"

namespace insitu {
namespace {

using testing::Context;
using testing::fails;
using testing::Studio;
using testing::works;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// A struct as a later header may have it, with members behind those of today.
template <class T>
struct Later {
  T now;
  unsigned char more[24];
};

template <class T>
Later<T> later(const T& now, unsigned char surplus) {
  Later<T> result;
  std::memset(&result, 0, sizeof result);
  result.now = now;
  result.now.struct_size = static_cast<std::uint32_t>(sizeof result);
  result.more[11] = surplus;
  return result;
}

// How a call that reads a struct treats sizes: as all of them have to.
template <class T>
void expect_sizes_are_honoured(insitu_context context, const char* name, const T& good,
                               const std::function<insitu_status(const T*)>& call) {
  SCOPED_TRACE(name);
  EXPECT_TRUE(works(context, call(&good)));
  EXPECT_TRUE(fails(context, call(nullptr), INSITU_ERROR_INVALID_ARGUMENT, {name, "NULL"}));

  T without_size = good;
  without_size.struct_size = 0;
  EXPECT_TRUE(fails(context, call(&without_size), INSITU_ERROR_INVALID_ARGUMENT, {name, "struct_size"}));

  // What was in memory before, taken for a size.
  T not_initialised = good;
  not_initialised.struct_size = 0x5A5A5A5A;
  EXPECT_TRUE(fails(context, call(&not_initialised), INSITU_ERROR_INVALID_ARGUMENT, {name, "struct_size"}));

  const Later<T> zero_surplus = later(good, 0);
  EXPECT_TRUE(works(context, call(&zero_surplus.now)));
  const Later<T> surplus = later(good, 1);
  EXPECT_TRUE(fails(context, call(&surplus.now), INSITU_ERROR_ABI, {name}));

  // Not one byte behind the size that the struct claims is read.
  const testing::GuardedMemory memory(sizeof(T));
  std::byte* at_end = memory.flush(sizeof(T), true);
  std::memcpy(at_end, &good, sizeof(T));
  EXPECT_TRUE(works(context, call(reinterpret_cast<const T*>(at_end))));
}

TEST(BadStructs, SizesOfWhatIsRead) {
  Studio studio;
  const insitu_context context = studio.context;

  insitu_style style;
  insitu_style_init(&style);
  expect_sizes_are_honoured<insitu_style>(context, "insitu_style", style, [&](const insitu_style* s) {
    return insitu_geometry_set_style(context, studio.geometry, s);
  });
  insitu_camera camera;
  insitu_camera_init(&camera);
  expect_sizes_are_honoured<insitu_camera>(context, "insitu_camera", camera, [&](const insitu_camera* c) {
    return insitu_view_set_camera(context, studio.view, c);
  });
  insitu_effects effects;
  insitu_effects_init(&effects);
  expect_sizes_are_honoured<insitu_effects>(context, "insitu_effects", effects, [&](const insitu_effects* e) {
    return insitu_view_set_effects(context, studio.view, e);
  });
  insitu_image_desc image;
  insitu_image_desc_init(&image);
  image.width = image.height = 2;
  expect_sizes_are_honoured<insitu_image_desc>(context, "insitu_image_desc", image, [&](const insitu_image_desc* d) {
    insitu_image out;
    return insitu_image_create(context, d, &out);
  });
  const double gold[4] = {1.0, 0.8, 0.0, 1.0};
  insitu_colormap_desc colormap;
  insitu_colormap_desc_init(&colormap);
  colormap.rgba = gold;
  colormap.count = 1;
  expect_sizes_are_honoured<insitu_colormap_desc>(context, "insitu_colormap_desc", colormap,
                                                  [&](const insitu_colormap_desc* d) {
                                                    insitu_colormap out;
                                                    return insitu_colormap_create(context, d, &out);
                                                  });
  insitu_particles_desc particles;
  insitu_particles_desc_init(&particles);
  expect_sizes_are_honoured<insitu_particles_desc>(context, "insitu_particles_desc", particles,
                                                   [&](const insitu_particles_desc* d) {
                                                     insitu_geometry out;
                                                     return insitu_particles_create(context, d, &out);
                                                   });
}

TEST(BadStructs, SizesOfAView) {
  const Context context;
  insitu_view out;
  EXPECT_TRUE(works(context, insitu_view_create(context, nullptr, &out))) << "NULL stands for all defaults";
  insitu_view_desc desc;
  insitu_view_desc_init(&desc);
  EXPECT_TRUE(works(context, insitu_view_create(context, &desc, &out)));
  desc.struct_size = 0;
  EXPECT_TRUE(fails(context, insitu_view_create(context, &desc, &out), INSITU_ERROR_INVALID_ARGUMENT,
                    {"insitu_view_desc", "struct_size"}));
  EXPECT_EQ(out.id, 0u);
  insitu_view_desc_init(&desc);
  const Later<insitu_view_desc> surplus = later(desc, 7);
  EXPECT_TRUE(fails(context, insitu_view_create(context, &surplus.now, &out), INSITU_ERROR_ABI, {"insitu_view_desc"}));

  // Structs within: lights stand as far apart as their own size says.
  Later<insitu_light> lights[2];
  for (auto& light : lights) {
    insitu_light now;
    insitu_light_init(&now);
    now.kind = INSITU_LIGHT_DIRECTIONAL;
    now.direction[1] = -1.0;
    light = later(now, 0);
  }
  EXPECT_TRUE(works(context, insitu_view_create(context, &desc, &out)));
  EXPECT_TRUE(works(context, insitu_view_set_lights(context, out, &lights[0].now, 2)));
  lights[1].more[3] = 1;
  EXPECT_TRUE(
      fails(context, insitu_view_set_lights(context, out, &lights[0].now, 2), INSITU_ERROR_ABI, {"insitu_light"}));
  lights[0].now.struct_size = 0;
  EXPECT_TRUE(fails(context, insitu_view_set_lights(context, out, &lights[0].now, 2), INSITU_ERROR_INVALID_ARGUMENT,
                    {"insitu_light", "struct_size"}));
}

// What an older program does not know of is zero, and means what it meant then.
TEST(BadStructs, ShorterOnesOfOlderPrograms) {
  Studio studio;
  insitu_camera camera;
  insitu_camera_init(&camera);
  camera.eye[2] = 9.0;
  camera.fov_y_deg = 50.0;
  camera.near_clip = -1.0;  // never read
  camera.struct_size = offsetof(insitu_camera, near_clip);
  EXPECT_TRUE(works(studio.context, insitu_view_set_camera(studio.context, studio.view, &camera)));
  insitu_camera_init(&camera);
  EXPECT_TRUE(works(studio.context, insitu_view_get_camera(studio.context, studio.view, &camera)));
  EXPECT_EQ(camera.fov_y_deg, 50.0);
  EXPECT_EQ(camera.near_clip, 0.0);

  // Results: as much as there is room for.
  insitu_stats stats;
  std::memset(&stats, 0x5a, sizeof stats);
  const insitu_stats untouched = stats;
  stats.struct_size = offsetof(insitu_stats, copied_bytes);
  EXPECT_TRUE(works(studio.context, insitu_stats_get(studio.context, &stats)));
  EXPECT_EQ(stats.struct_size, offsetof(insitu_stats, copied_bytes));
  EXPECT_EQ(stats.step, 0u);
  EXPECT_EQ(stats.copied_bytes, untouched.copied_bytes);
  stats.struct_size = 0;
  EXPECT_TRUE(fails(studio.context, insitu_stats_get(studio.context, &stats), INSITU_ERROR_INVALID_ARGUMENT,
                    {"insitu_stats", "struct_size"}));
  EXPECT_TRUE(fails(studio.context, insitu_stats_get(studio.context, nullptr), INSITU_ERROR_INVALID_ARGUMENT,
                    {"insitu_stats", "NULL"}));
}

TEST(BadStructs, Contexts) {
  insitu_context context = nullptr;
  insitu_context_desc desc;
  const auto refused = [&](insitu_status expected, const char* word) {
    context = reinterpret_cast<insitu_context>(&desc);
    const insitu_status status = insitu_context_create(&desc, &context);
    EXPECT_EQ(context, nullptr);
    return fails(nullptr, status, expected, {word});
  };
  insitu_context_desc_init(&desc);
  desc.abi = INSITU_ABI + 1;
  EXPECT_TRUE(refused(INSITU_ERROR_ABI, "interface"));
  std::memset(&desc, 0, sizeof desc);
  EXPECT_TRUE(refused(INSITU_ERROR_INVALID_ARGUMENT, "struct_size"));
  insitu_context_desc_init(&desc);
  desc.check_level = 3;
  EXPECT_TRUE(refused(INSITU_ERROR_INVALID_ARGUMENT, "check_level"));
  insitu_context_desc_init(&desc);
  desc.flags = 1u << 31;
  EXPECT_TRUE(refused(INSITU_ERROR_INVALID_ARGUMENT, "flags"));
  insitu_context_desc_init(&desc);
  desc.max_threads = ~0u;
  EXPECT_TRUE(refused(INSITU_ERROR_INVALID_ARGUMENT, "max_threads"));
  insitu_context_desc_init(&desc);
  Later<insitu_context_desc> surplus = later(desc, 1);
  EXPECT_TRUE(fails(nullptr, insitu_context_create(&surplus.now, &context), INSITU_ERROR_ABI, {"insitu_context_desc"}));
  EXPECT_TRUE(fails(nullptr, insitu_context_create(nullptr, nullptr), INSITU_ERROR_INVALID_ARGUMENT, {"out"}));

  EXPECT_EQ(insitu_context_create(nullptr, &context), INSITU_OK);
  insitu_context_destroy(context);
  insitu_context_destroy(nullptr);
}

// A null context is told from a good one by every function.
TEST(BadStructs, NullContext) {
  insitu_geometry geometry = {1};
  insitu_view view = {1};
  insitu_image image = {1};
  insitu_colormap colormap = {1};
  double three[3];
  std::uint64_t number;
  insitu_array array;
  insitu_camera camera;
  insitu_stats stats;
  const insitu_status statuses[] = {
      insitu_context_set_log(nullptr, nullptr, nullptr, 0),
      insitu_context_set_report(nullptr, "x"),
      insitu_particles_create(nullptr, nullptr, &geometry),
      insitu_particles_update(nullptr, geometry, nullptr),
      insitu_particles_permutation(nullptr, geometry, &number, 1),
      insitu_particles_restore_order(nullptr, geometry),
      insitu_geometry_set_style(nullptr, geometry, nullptr),
      insitu_geometry_bounds(nullptr, geometry, three, three),
      insitu_geometry_destroy(nullptr, geometry),
      insitu_colormap_create(nullptr, nullptr, &colormap),
      insitu_colormap_destroy(nullptr, colormap),
      insitu_view_create(nullptr, nullptr, &view),
      insitu_view_set_camera(nullptr, view, nullptr),
      insitu_view_get_camera(nullptr, view, &camera),
      insitu_view_set_effects(nullptr, view, nullptr),
      insitu_view_set_lights(nullptr, view, nullptr, 0),
      insitu_view_set_background(nullptr, view, nullptr),
      insitu_view_fit(nullptr, view, 1.0),
      insitu_view_turn(nullptr, view, 1.0),
      insitu_view_destroy(nullptr, view),
      insitu_image_create(nullptr, nullptr, &image),
      insitu_render(nullptr, view, image),
      insitu_image_write(nullptr, image, "x.png"),
      insitu_image_channel(nullptr, image, INSITU_CHANNEL_COLOR, &array),
      insitu_image_destroy(nullptr, image),
      insitu_step_begin(nullptr, 0, 0.0),
      insitu_commit(nullptr),
      insitu_step_end(nullptr),
      insitu_stats_get(nullptr, &stats),
  };
  for (const insitu_status status : statuses) EXPECT_EQ(status, INSITU_ERROR_INVALID_HANDLE);
}

// Functions with a place for a result say so when there is none, and leave 0 in it when they fail.
TEST(BadStructs, NoPlaceForTheResult) {
  Studio studio;
  const insitu_context context = studio.context;
  insitu_particles_desc particles;
  insitu_particles_desc_init(&particles);
  insitu_image_desc image_desc;
  insitu_image_desc_init(&image_desc);
  const double gold[4] = {1.0, 0.8, 0.0, 1.0};
  insitu_colormap_desc colormap_desc;
  insitu_colormap_desc_init(&colormap_desc);
  colormap_desc.rgba = gold;
  colormap_desc.count = 1;
  constexpr insitu_status bad = INSITU_ERROR_INVALID_ARGUMENT;
  EXPECT_TRUE(fails(context, insitu_particles_create(context, &particles, nullptr), bad, {"out", "NULL"}));
  EXPECT_TRUE(fails(context, insitu_view_create(context, nullptr, nullptr), bad, {"out", "NULL"}));
  EXPECT_TRUE(fails(context, insitu_image_create(context, &image_desc, nullptr), bad, {"out", "NULL"}));
  EXPECT_TRUE(fails(context, insitu_colormap_create(context, &colormap_desc, nullptr), bad, {"out", "NULL"}));
  EXPECT_TRUE(fails(context, insitu_view_get_camera(context, studio.view, nullptr), bad, {"insitu_camera", "NULL"}));
  EXPECT_TRUE(fails(context, insitu_image_channel(context, studio.image, INSITU_CHANNEL_COLOR, nullptr), bad,
                    {"insitu_array", "NULL"}));
  EXPECT_TRUE(fails(context, insitu_view_set_background(context, studio.view, nullptr), bad, {"background", "NULL"}));
  EXPECT_TRUE(fails(context, insitu_view_set_lights(context, studio.view, nullptr, 2), bad, {"lights", "NULL"}));
  EXPECT_TRUE(fails(context, insitu_image_write(context, studio.image, nullptr), bad, {"pattern"}));
  EXPECT_TRUE(fails(context, insitu_image_write(context, studio.image, ""), bad, {"pattern"}));

  insitu_geometry geometry = {77};
  particles.order = 3;
  EXPECT_TRUE(fails(context, insitu_particles_create(context, &particles, &geometry), bad, {"order", "PERMUTE"}));
  EXPECT_EQ(geometry.id, 0u);
  insitu_image image = {77};
  image_desc.width = 1u << 30;
  EXPECT_TRUE(fails(context, insitu_image_create(context, &image_desc, &image), bad, {"image", "pixels"}));
  EXPECT_EQ(image.id, 0u);
  insitu_colormap colormap = {77};
  colormap_desc.count = 0;
  EXPECT_TRUE(fails(context, insitu_colormap_create(context, &colormap_desc, &colormap), bad, {"colormap"}));
  EXPECT_EQ(colormap.id, 0u);
}

template <class T>
struct Spoiled {
  const char* word;  // in the text
  std::function<void(T&)> spoil;
};

template <class T>
void expect_refused(insitu_context context, const T& good, const std::vector<Spoiled<T>>& cases,
                    const std::function<insitu_status(const T*)>& call) {
  for (const auto& bad : cases) {
    T desc = good;
    bad.spoil(desc);
    EXPECT_TRUE(fails(context, call(&desc), INSITU_ERROR_INVALID_ARGUMENT, {bad.word}));
  }
  EXPECT_TRUE(works(context, call(&good)));
}

TEST(BadStructs, CamerasThatCannotBe) {
  Studio studio;
  insitu_camera camera;
  insitu_camera_init(&camera);
  camera.eye[2] = 5.0;
  expect_refused<insitu_camera>(
      studio.context, camera,
      {{"kind", [](insitu_camera& c) { c.kind = 2; }},
       {"eye", [](insitu_camera& c) { c.eye[1] = nan; }},
       {"look_at", [](insitu_camera& c) { c.look_at[0] = infinity; }},
       {"up", [](insitu_camera& c) { c.up[2] = nan; }},
       {"fov_y_deg", [](insitu_camera& c) { c.fov_y_deg = -1.0; }},
       {"fov_y_deg", [](insitu_camera& c) { c.fov_y_deg = 180.0; }},
       {"fov_y_deg", [](insitu_camera& c) { c.fov_y_deg = nan; }},
       {"height", [](insitu_camera& c) { c.height = -1.0; }},
       {"height", [](insitu_camera& c) { c.height = infinity; }},
       {"near_clip", [](insitu_camera& c) { c.near_clip = -1.0; }},
       {"near_clip", [](insitu_camera& c) { c.near_clip = nan; }},
       {"far_clip", [](insitu_camera& c) { c.far_clip = -1.0; }},
       {"far_clip", [](insitu_camera& c) { c.far_clip = nan; }},
       {"far_clip",
        [](insitu_camera& c) {
          c.near_clip = 2.0;
          c.far_clip = 1.0;
        }}},
      [&](const insitu_camera* c) { return insitu_view_set_camera(studio.context, studio.view, c); });
}

TEST(BadStructs, EffectsLightsAndBackgroundsThatCannotBe) {
  Studio studio;
  insitu_effects effects;
  insitu_effects_init(&effects);
  expect_refused<insitu_effects>(
      studio.context, effects,
      {{"flags", [](insitu_effects& e) { e.flags = 1u << 30; }},
       {"ao_samples", [](insitu_effects& e) { e.ao_samples = ~0u; }},
       {"ao_radius", [](insitu_effects& e) { e.ao_radius = -1.0; }},
       {"ao_radius", [](insitu_effects& e) { e.ao_radius = nan; }}},
      [&](const insitu_effects* e) { return insitu_view_set_effects(studio.context, studio.view, e); });
  insitu_light light;
  insitu_light_init(&light);
  light.kind = INSITU_LIGHT_DIRECTIONAL;
  light.direction[2] = -1.0;
  expect_refused<insitu_light>(
      studio.context, light,
      {{"kind", [](insitu_light& l) { l.kind = 7; }},
       {"direction", [](insitu_light& l) { l.direction[2] = 0.0; }},
       {"direction", [](insitu_light& l) { l.direction[0] = nan; }},
       {"colour", [](insitu_light& l) { l.color[1] = -1.0; }},
       {"colour", [](insitu_light& l) { l.color[1] = infinity; }},
       {"intensity", [](insitu_light& l) { l.intensity = -1.0; }},
       {"intensity", [](insitu_light& l) { l.intensity = nan; }},
       {"flags", [](insitu_light& l) { l.flags = 8; }}},
      [&](const insitu_light* l) { return insitu_view_set_lights(studio.context, studio.view, l, 1); });
  for (const double bad : {-1.0, nan, infinity}) {
    const double color[4] = {bad, 0.0, 0.0, 1.0};
    EXPECT_TRUE(fails(studio.context, insitu_view_set_background(studio.context, studio.view, color),
                      INSITU_ERROR_INVALID_ARGUMENT, {"background"}));
    const double opacity[4] = {0.0, 0.0, 0.0, bad == infinity ? 1.5 : bad};
    EXPECT_TRUE(fails(studio.context, insitu_view_set_background(studio.context, studio.view, opacity),
                      INSITU_ERROR_INVALID_ARGUMENT, {"background"}));
  }
  for (const double bad : {nan, infinity})
    EXPECT_TRUE(fails(studio.context, insitu_view_turn(studio.context, studio.view, bad), INSITU_ERROR_INVALID_ARGUMENT,
                      {"angle"}));
}

TEST(BadStructs, StylesThatCannotBe) {
  Studio studio;
  const insitu_style style = testing::make_style("heat", 0.0, 1.0);
  expect_refused<insitu_style>(
      studio.context, style,
      {{"color_by", [](insitu_style& s) { s.color_by = 2; }},
       {"attribute", [](insitu_style& s) { s.attribute = nullptr; }},
       {"attribute", [](insitu_style& s) { s.attribute = ""; }},
       {"component", [](insitu_style& s) { s.component = 5; }},
       {"range_mode", [](insitu_style& s) { s.range_mode = 2; }},
       {"range", [](insitu_style& s) { s.range[0] = nan; }},
       {"range", [](insitu_style& s) { s.range[1] = infinity; }},
       {"color", [](insitu_style& s) { s.color[0] = -1.0; }},
       {"opacity", [](insitu_style& s) { s.opacity = -0.5; }},
       {"opacity", [](insitu_style& s) { s.opacity = 1.5; }},
       {"opacity", [](insitu_style& s) { s.opacity = nan; }},
       {"opacity_map", [](insitu_style& s) { s.opacity_map_count = 3; }}},
      [&](const insitu_style* s) { return insitu_geometry_set_style(studio.context, studio.geometry, s); });
}

TEST(BadStructs, AnUnknownColourMapIsToldTheValidOnes) {
  Studio studio;
  insitu_style style;
  insitu_style_init(&style);
  style.colormap = "viridiss";
  EXPECT_TRUE(fails(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style),
                    INSITU_ERROR_INVALID_ARGUMENT,
                    {"viridiss", "viridis", "inferno", "coolwarm", "categorical", "elements"}));
}

TEST(BadStructs, AnUnknownAttributeIsToldTheValidOnes) {
  Studio studio;
  testing::Cloud cloud(20);
  std::vector<double> values(20);
  const std::vector<std::int32_t> types(20);
  const insitu_array value = insitu_array_records(INSITU_F64, 1, values.data(), 20, 0);
  const insitu_array type = insitu_array_records(INSITU_I32, 1, types.data(), 20, 0);
  const insitu_attribute attributes[2] = {{"heat", &value}, {"speed", &value}};
  cloud.desc.attributes = attributes;
  cloud.desc.attribute_count = 2;
  cloud.desc.type = &type;

  // Before there are arrays nobody can know: the next commit tells.
  insitu_style style = testing::make_style("hea", 0.0, 1.0);
  EXPECT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
  insitu_step_begin(studio.context, 0, 0.0);
  insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
  EXPECT_TRUE(fails(studio.context, insitu_commit(studio.context), INSITU_ERROR_INVALID_ARGUMENT,
                    {"'hea'", "heat", "speed", "type"}));
  EXPECT_EQ(insitu_step_end(studio.context), INSITU_ERROR_INVALID_ARGUMENT);

  // With arrays bound, the call itself; and the style stays what it was.
  style.attribute = "speed";
  ASSERT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
  insitu_step_begin(studio.context, 1, 0.0);
  insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
  style.attribute = "sped";
  EXPECT_TRUE(fails(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style),
                    INSITU_ERROR_INVALID_ARGUMENT, {"'sped'", "heat", "speed", "type"}));
  EXPECT_EQ(insitu_step_end(studio.context), INSITU_ERROR_INVALID_ARGUMENT);
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));

  // A component that the attribute does not have.
  style = testing::make_style("heat", 0.0, 1.0);
  style.component = 2;
  ASSERT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
  EXPECT_TRUE(fails(studio.context, studio.step(cloud.desc), INSITU_ERROR_INVALID_ARGUMENT, {"heat", "component"}));
}

// An error that could have been found first leaves the order of the arrays alone.
TEST(BadStructs, AnUnknownAttributeMovesNothing) {
  Studio studio(INSITU_ORDER_PERMUTE);
  testing::Cloud cloud(500);
  cloud.position.flags = INSITU_ARRAY_PERMUTABLE;
  const std::vector<double> before = cloud.xyz;
  const insitu_style style = testing::make_style("heat", 0.0, 1.0);
  ASSERT_TRUE(works(studio.context, insitu_geometry_set_style(studio.context, studio.geometry, &style)));
  EXPECT_TRUE(fails(studio.context, studio.step(cloud.desc), INSITU_ERROR_INVALID_ARGUMENT, {"heat"}));
  EXPECT_EQ(cloud.xyz, before);
}

TEST(BadStructs, ImagesThatCannotBe) {
  Studio studio;
  insitu_image_desc desc;
  insitu_image_desc_init(&desc);
  desc.width = desc.height = 4;
  expect_refused<insitu_image_desc>(
      studio.context, desc,
      {{"pixels", [](insitu_image_desc& d) { d.width = 65537; }},
       {"pixels", [](insitu_image_desc& d) { d.height = ~0u; }},
       {"samples", [](insitu_image_desc& d) { d.samples_per_pixel = ~0u; }},
       {"max_samples", [](insitu_image_desc& d) { d.max_samples_per_pixel = 65537; }},
       {"below samples_per_pixel, 4", [](insitu_image_desc& d) { d.max_samples_per_pixel = 3; }},
       {"2 samples_per_pixel",
        [](insitu_image_desc& d) {
          d.samples_per_pixel = 1;
          d.max_samples_per_pixel = 3;
        }},
       {"pixel_error", [](insitu_image_desc& d) { d.pixel_error = 0.01; }},
       {"pixel_error",
        [](insitu_image_desc& d) {
          d.max_samples_per_pixel = 64;
          d.pixel_error = -0.01;
        }},
       {"pixel_error",
        [](insitu_image_desc& d) {
          d.max_samples_per_pixel = 64;
          d.pixel_error = std::nan("");
        }},
       {"pixel_error",
        [](insitu_image_desc& d) {
          d.max_samples_per_pixel = 64;
          d.pixel_error = std::numeric_limits<double>::infinity();
        }},
       {"channels", [](insitu_image_desc& d) { d.channels = 1u << 9; }}},
      [&](const insitu_image_desc* d) {
        insitu_image out;
        return insitu_image_create(studio.context, d, &out);
      });
  insitu_array array;
  insitu_array_init(&array);
  for (const std::uint32_t bad : {0u, 3u, 1u << 9})
    EXPECT_TRUE(fails(studio.context, insitu_image_channel(studio.context, studio.image, bad, &array),
                      INSITU_ERROR_INVALID_ARGUMENT, {"channel"}));
  EXPECT_TRUE(fails(studio.context, insitu_image_channel(studio.context, studio.image, INSITU_CHANNEL_NORMAL, &array),
                    INSITU_ERROR_INVALID_ARGUMENT, {"channel"}));
}

TEST(BadStructs, NamesOfStatuses) {
  EXPECT_STREQ(insitu_status_name(INSITU_OK), "ok");
  EXPECT_STREQ(insitu_status_name(INSITU_ERROR_INTERNAL), "internal");
  for (const insitu_status unknown : {-1, 11, std::numeric_limits<insitu_status>::min()})
    EXPECT_STREQ(insitu_status_name(unknown), "unknown");
  EXPECT_EQ(insitu_abi_version(), INSITU_ABI);
  EXPECT_NE(std::string(insitu_version_text()).find("0.1.0"), std::string::npos);
}

}  // namespace
}  // namespace insitu
