// Arrays that cannot be meant: a status and a text that names the array, nothing touched, and the next step works.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::fails;
using testing::Studio;
using testing::works;

constexpr std::uint64_t items = 40;

// A set with one array of each kind, all good.
struct Input {
  Input() {
    testing::SplitMix64 random(1);
    for (double& x : xyz) x = random.unit();
    for (std::uint64_t i = 0; i < items; ++i) {
      radii[i] = 0.05f;
      types[i] = static_cast<std::int32_t>(i % 3);
      values[i] = random.unit();
      table[i] = xyz + 3 * i;
    }
    position = insitu_array_records(INSITU_F64, 3, xyz, items, 0);
    radius = insitu_array_records(INSITU_F32, 1, radii, items, 0);
    type = insitu_array_records(INSITU_I32, 1, types, items, 0);
    value = insitu_array_records(INSITU_F64, 1, values, items, 0);
    id = insitu_array_records(INSITU_U8, 8, values, items, 0);
    attribute[0] = {"heat", &value};
    attribute[1] = {"speed", &value};
    insitu_particles_desc_init(&desc);
    desc.position = &position;
    desc.radius = &radius;
    desc.type = &type;
    desc.attributes = attribute;
    desc.attribute_count = 1;
    desc.payload = payload;
    desc.payload_count = 1;
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  // Radii by the value of an attribute, and in no other way.
  void map_radii(const char* attribute_name) {
    desc.radius = nullptr;
    desc.radius_attribute = attribute_name;
    desc.radius_map = type_radius;
    desc.radius_map_count = 3;
    desc.radius_range[1] = 1.0;
  }

  double xyz[3 * items];
  float radii[items];
  std::int32_t types[items];
  double values[items];
  double* table[items];
  insitu_array position, radius, type, value, id;
  insitu_attribute attribute[2];
  const insitu_array* payload[1] = {&id};
  double type_radius[3] = {0.1, 0.2, 0.3};
  insitu_particles_desc desc;
};

struct Case {
  const char* name;
  std::function<void(Input&)> spoil;
  insitu_status status;
  std::initializer_list<std::string> words;
};

void* shifted(void* pointer, int bytes) { return static_cast<char*>(pointer) + bytes; }

const Case cases[] = {
    {"no position", [](Input& i) { i.desc.position = nullptr; }, INSITU_ERROR_INVALID_ARGUMENT, {"position", "NULL"}},
    {"null position",
     [](Input& i) { i.position.component[0] = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "component[0]", "NULL"}},
    {"null radius",
     [](Input& i) { i.radius.component[0] = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius", "NULL"}},
    {"null type", [](Input& i) { i.type.component[0] = nullptr; }, INSITU_ERROR_INVALID_ARGUMENT, {"type", "NULL"}},
    {"null attribute",
     [](Input& i) { i.value.component[0] = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"heat", "NULL"}},
    {"null payload",
     [](Input& i) { i.id.component[0] = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"payload number 0", "NULL"}},
    {"null attribute array",
     [](Input& i) { i.attribute[0].values = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"heat", "NULL"}},
    {"null payload array",
     [](Input& i) { i.payload[0] = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"payload number 0", "NULL"}},
    {"an attribute array without its size",
     [](Input& i) { i.value.struct_size = 0; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"heat", "struct_size"}},
    {"null list of attributes",
     [](Input& i) { i.desc.attributes = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"attributes", "NULL"}},
    {"null list of payload",
     [](Input& i) { i.desc.payload = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"payload", "NULL"}},
    {"one column of three",
     [](Input& i) { i.position.component[1] = i.xyz; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "component"}},
    {"the last column is missing",
     [](Input& i) {
       i.position.component[1] = i.xyz;
       i.position.component[2] = nullptr;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "component"}},
    {"misaligned f64",
     [](Input& i) {
       i.position.component[0] = shifted(i.xyz, 4);
       i.position.count = i.radius.count = i.type.count = i.value.count = i.id.count = 3;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "aligned", "8"}},
    {"misaligned f32",
     [](Input& i) { i.radius.component[0] = shifted(i.radii, 2); },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius", "aligned", "4"}},
    {"misaligned second column",
     [](Input& i) { i.position = insitu_array_columns(INSITU_F32, i.radii, shifted(i.radii, 1), i.radii, items); },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "component[1]", "aligned"}},
    {"misaligned table of rows",
     [](Input& i) {
       i.position = insitu_array_records(INSITU_F32, 3, shifted(i.table, 4), items, 0);
       i.position.flags = INSITU_ARRAY_ROWS;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "aligned"}},
    {"a row that is not there",
     [](Input& i) {
       i.table[items - 1] = nullptr;
       i.position = insitu_array_records(INSITU_F64, 3, i.table, items, 0);
       i.position.flags = INSITU_ARRAY_ROWS;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "row pointer", "NULL"}},
    {"a stride that misaligns",
     [](Input& i) { i.position.stride_bytes = 28; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "stride_bytes", "28"}},
    {"a stride that misaligns, backwards",
     [](Input& i) { i.position.stride_bytes = -28; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "stride_bytes", "-28"}},
    {"items that overlap",
     [](Input& i) { i.position.stride_bytes = 16; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "stride_bytes", "16", "overlap"}},
    {"items that overlap, backwards",
     [](Input& i) { i.position.stride_bytes = -8; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "stride_bytes", "-8", "overlap"}},
    {"rows and columns at once",
     [](Input& i) {
       i.position = insitu_array_columns(INSITU_F64, i.table, i.table, i.table, items);
       i.position.flags = INSITU_ARRAY_ROWS;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "rows"}},
    {"the smallest stride there is",
     [](Input& i) { i.position.stride_bytes = std::numeric_limits<std::int64_t>::min(); },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position"}},
    {"the largest stride there is",
     [](Input& i) { i.position.stride_bytes = std::numeric_limits<std::int64_t>::max() - 7; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position"}},
    {"more items than bytes in the world",
     [](Input& i) { i.position.count = std::uint64_t{1} << 61; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "count"}},
    {"the largest count there is",
     [](Input& i) { i.position.count = ~std::uint64_t{0}; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "count"}},
    {"fewer radii",
     [](Input& i) { i.radius.count = items - 1; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius", "39", "40"}},
    {"more types", [](Input& i) { i.type.count = items + 1; }, INSITU_ERROR_INVALID_ARGUMENT, {"type", "41", "40"}},
    {"fewer values", [](Input& i) { i.value.count = 0; }, INSITU_ERROR_INVALID_ARGUMENT, {"heat", "0", "40"}},
    {"fewer in the payload",
     [](Input& i) { i.id.count = 1; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"payload number 0", "1", "40"}},
    {"two coordinates",
     [](Input& i) { i.position.components = 2; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "3", "2"}},
    {"no components",
     [](Input& i) { i.value.components = 0; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"heat", "components", "0"}},
    {"five components",
     [](Input& i) { i.value.components = 5; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"heat", "components", "5"}},
    {"radii with two components",
     [](Input& i) { i.radius.components = 2; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius", "components", "2"}},
    {"no scalar type",
     [](Input& i) { i.position.type = 0; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position", "scalar type 0"}},
    {"a scalar type of another world",
     [](Input& i) { i.value.type = 99; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"heat", "scalar type 99"}},
    {"positions of a type that is not there yet",
     [](Input& i) { i.position.type = INSITU_I64; },
     INSITU_ERROR_UNSUPPORTED,
     {"position", "i64"}},
    {"whole radii", [](Input& i) { i.radius.type = INSITU_I32; }, INSITU_ERROR_UNSUPPORTED, {"radius", "i32"}},
    {"types with fractions", [](Input& i) { i.type.type = INSITU_F32; }, INSITU_ERROR_UNSUPPORTED, {"type", "f32"}},
    {"unknown array flags",
     [](Input& i) { i.value.flags = 1u << 20; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"heat", "flags"}},
    {"an attribute without a name",
     [](Input& i) { i.attribute[0].name = nullptr; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"attribute number 0", "name"}},
    {"an attribute with an empty name",
     [](Input& i) { i.attribute[0].name = ""; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"attribute number 0", "name"}},
    {"two attributes of one name",
     [](Input& i) {
       i.attribute[1].name = "heat";
       i.desc.attribute_count = 2;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"two attributes", "heat"}},
    {"a table of radii that is not there",
     [](Input& i) { i.desc.type_radius_count = 3; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"type_radius", "NULL"}},
    {"a table of radii without types",
     [](Input& i) {
       i.desc.type = nullptr;
       i.desc.type_radius = i.type_radius;
       i.desc.type_radius_count = 3;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"type_radius", "type array"}},
    {"a map of radii without an attribute",
     [](Input& i) { i.desc.radius_map = i.type_radius; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_map", "radius_attribute"}},
    {"a map of radii beside an array of them",
     [](Input& i) {
       i.map_radii("heat");
       i.desc.radius = &i.radius;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_attribute", "radius array"}},
    {"a map of radii of an attribute that is not there",
     [](Input& i) { i.map_radii("cold"); },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_attribute", "'cold'"}},
    {"a map of radii of a component that is not there",
     [](Input& i) {
       i.map_radii("heat");
       i.desc.radius_component = 2;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_component is 2", "1 components"}},
    {"a map of radii with one entry",
     [](Input& i) {
       i.map_radii("heat");
       i.desc.radius_map_count = 1;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_map_count"}},
    {"a map of radii that is not there",
     [](Input& i) {
       i.map_radii("heat");
       i.desc.radius_map = nullptr;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_map is NULL"}},
    {"a map of radii over nothing",
     [](Input& i) {
       i.map_radii("heat");
       i.desc.radius_range[1] = i.desc.radius_range[0];
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_range"}},
    {"a map of radii over everything",
     [](Input& i) {
       i.map_radii("heat");
       i.desc.radius_range[1] = std::numeric_limits<double>::infinity();
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_range"}},
    {"a map with a negative radius",
     [](Input& i) {
       i.map_radii("heat");
       i.type_radius[1] = -0.1;
     },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_map", "negative"}},
    {"a scale for floating point positions",
     [](Input& i) { i.desc.position_scale = 2.0; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position_scale"}},
    {"an origin for floating point positions",
     [](Input& i) { i.desc.position_origin[2] = 1.0; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"position_origin"}},
    {"a negative share for treelets",
     [](Input& i) { i.desc.treelet_share = -0.1; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"treelet_share"}},
    {"a share for treelets that is no number",
     [](Input& i) { i.desc.treelet_share = std::numeric_limits<double>::quiet_NaN(); },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"treelet_share"}},
    {"a negative radius for all",
     [](Input& i) { i.desc.radius_default = -1.0; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_default"}},
    {"a radius for all that is no number",
     [](Input& i) { i.desc.radius_default = std::numeric_limits<double>::quiet_NaN(); },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_default"}},
    {"a negative factor",
     [](Input& i) { i.desc.radius_scale = -2.0; },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_scale"}},
    {"an infinite factor",
     [](Input& i) { i.desc.radius_scale = std::numeric_limits<double>::infinity(); },
     INSITU_ERROR_INVALID_ARGUMENT,
     {"radius_scale"}},
};

TEST(BadArrays, AreRefusedByName) {
  Input good;
  const Input untouched;
  Studio studio;
  ASSERT_TRUE(works(studio.context, studio.step(good.desc)));
  const testing::Picture picture = studio.picture();
  ASSERT_GT(picture.hits(), 0u);
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.name);
    Input input;
    bad.spoil(input);
    ASSERT_TRUE(works(studio.context, insitu_step_begin(studio.context, 1, 0.0)));
    EXPECT_TRUE(fails(studio.context, insitu_particles_update(studio.context, studio.geometry, &input.desc), bad.status,
                      bad.words));
    EXPECT_TRUE(fails(studio.context, insitu_step_end(studio.context), bad.status, bad.words));
    EXPECT_EQ(std::memcmp(input.xyz, untouched.xyz, sizeof input.xyz), 0);
    EXPECT_EQ(std::memcmp(input.radii, untouched.radii, sizeof input.radii), 0);
    EXPECT_EQ(std::memcmp(input.types, untouched.types, sizeof input.types), 0);
    EXPECT_EQ(std::memcmp(input.values, untouched.values, sizeof input.values), 0);
    ASSERT_TRUE(works(studio.context, studio.step(good.desc))) << "the next step";
    EXPECT_EQ(studio.picture(), picture);
  }
}

// The name that the host gave the set is in the text.
TEST(BadArrays, TheSetIsNamed) {
  const testing::Context context;
  const insitu_geometry gas = testing::make_particles(context, INSITU_ORDER_INDEX, 0, "hot gas");
  Input input;
  input.radius.count = 7;
  insitu_step_begin(context, 0, 0.0);
  EXPECT_TRUE(fails(context, insitu_particles_update(context, gas, &input.desc), INSITU_ERROR_INVALID_ARGUMENT,
                    {"hot gas", "radius"}));
}

// The scale and the origin of integer positions.
TEST(BadArrays, Lattices) {
  std::uint32_t lattice[3] = {1, 2, 3};
  const insitu_array position = insitu_array_records(INSITU_U32, 3, lattice, 1, 0);
  Studio studio;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {-1.0, infinity, std::numeric_limits<double>::quiet_NaN()}) {
    insitu_particles_desc desc;
    insitu_particles_desc_init(&desc);
    desc.position = &position;
    desc.position_scale = bad;
    insitu_step_begin(studio.context, 0, 0.0);
    EXPECT_TRUE(fails(studio.context, insitu_particles_update(studio.context, studio.geometry, &desc),
                      INSITU_ERROR_INVALID_ARGUMENT, {"position_scale"}));
    insitu_step_end(studio.context);
  }
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.position = &position;
  desc.position_origin[1] = infinity;
  insitu_step_begin(studio.context, 0, 0.0);
  EXPECT_TRUE(fails(studio.context, insitu_particles_update(studio.context, studio.geometry, &desc),
                    INSITU_ERROR_INVALID_ARGUMENT, {"position_origin"}));
  insitu_step_end(studio.context);
}

TEST(BadArrays, PermuteNeedsConsentOfEveryArray) {
  struct Member {
    insitu_array Input::*array;
    const char* name;
  };
  const Member members[] = {{&Input::position, "position"},
                            {&Input::radius, "radius"},
                            {&Input::type, "type"},
                            {&Input::value, "heat"},
                            {&Input::id, "payload number 0"}};
  Studio studio(INSITU_ORDER_PERMUTE);
  for (const Member& without : members) {
    SCOPED_TRACE(without.name);
    Input input;
    std::uint64_t ids[items] = {};
    input.id = insitu_array_records(INSITU_U64, 1, ids, items, 0);
    for (const Member& member : members) (input.*member.array).flags = INSITU_ARRAY_PERMUTABLE;
    ASSERT_TRUE(works(studio.context, studio.step(input.desc)));
    (input.*without.array).flags = 0;
    insitu_step_begin(studio.context, 0, 0.0);
    EXPECT_TRUE(fails(studio.context, insitu_particles_update(studio.context, studio.geometry, &input.desc),
                      INSITU_ERROR_INVALID_ARGUMENT, {without.name, "INSITU_ARRAY_PERMUTABLE"}));
    insitu_step_end(studio.context);
  }
}

// Two views of the same bytes that run differently through them cannot be permuted together.
TEST(BadArrays, PermuteRefusesViewsThatCross) {
  const Input original;
  Input input;
  input.position.flags = input.value.flags = INSITU_ARRAY_PERMUTABLE;
  input.desc.radius = input.desc.type = nullptr;
  input.desc.payload_count = 0;
  input.value.component[0] = input.xyz;  // x of the first third, packed: not with the records
  Studio studio(INSITU_ORDER_PERMUTE);
  insitu_step_begin(studio.context, 0, 0.0);
  EXPECT_TRUE(fails(studio.context, insitu_particles_update(studio.context, studio.geometry, &input.desc),
                    INSITU_ERROR_INVALID_ARGUMENT, {"heat", "overlap"}));
  insitu_step_end(studio.context);
  EXPECT_EQ(std::memcmp(input.xyz, original.xyz, sizeof input.xyz), 0);
  // The same column within the records is fine.
  input.value.stride_bytes = 3 * sizeof(double);
  EXPECT_TRUE(works(studio.context, studio.step(input.desc)));
}

// insitu_array_check says the same as an update, without a context.
TEST(BadArrays, CheckSaysTheSame) {
  Input input;
  const auto check = [](const insitu_array& array, std::uint32_t use) {
    insitu_array_report report;
    insitu_array_report_init(&report);
    const insitu_status status = insitu_array_check(&array, use, &report);
    EXPECT_EQ(report.status, status);
    EXPECT_EQ(insitu_array_check(&array, use, nullptr), status);
    EXPECT_EQ(report.copied_bytes, 0u);
    EXPECT_NE(report.reason[0], '\0');
    if (status != INSITU_OK) {
      EXPECT_EQ(report.borrowed_bytes, 0u);
    }
    return std::pair(report, status);
  };
  const auto good = check(input.position, INSITU_USE_POSITION);
  EXPECT_EQ(good.second, INSITU_OK);
  EXPECT_EQ(good.first.borrowed_bytes, sizeof input.xyz);

  input.position.stride_bytes = 28;
  EXPECT_EQ(check(input.position, INSITU_USE_POSITION).second, INSITU_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(check(input.position, INSITU_USE_POSITION).first.reason).find("28"), std::string::npos);
  EXPECT_EQ(check(input.type, INSITU_USE_RADIUS).second, INSITU_ERROR_UNSUPPORTED);
  EXPECT_EQ(check(input.radius, INSITU_USE_TYPE).second, INSITU_ERROR_UNSUPPORTED);
  EXPECT_EQ(check(input.radius, 0).second, INSITU_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(check(input.radius, 77).second, INSITU_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(check(input.radius, INSITU_USE_RADIUS).second, INSITU_OK);
  EXPECT_EQ(insitu_array_check(nullptr, INSITU_USE_RADIUS, nullptr), INSITU_ERROR_INVALID_ARGUMENT);

  insitu_array nothing = insitu_array_records(INSITU_F32, 3, nullptr, 0, 0);
  EXPECT_EQ(check(nothing, INSITU_USE_POSITION).second, INSITU_OK);
  nothing.struct_size = 0;
  EXPECT_EQ(check(nothing, INSITU_USE_POSITION).second, INSITU_ERROR_INVALID_ARGUMENT);
  input.value.stride_bytes = std::numeric_limits<std::int64_t>::min();
  EXPECT_EQ(check(input.value, INSITU_USE_ATTRIBUTE).second, INSITU_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace insitu
