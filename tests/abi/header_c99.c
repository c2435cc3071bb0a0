/* Strict C99 must swallow the header, alone and twice, and every initialiser must do what the header says of it. */
#include <insitu/insitu.h>

#include <insitu/insitu.h>

#include <stdio.h>

static int failures = 0;

static void expect(int condition, const char *text) {
  if (condition) return;
  ++failures;
  printf("not true: %s\n", text);
}
#define EXPECT(condition) expect((condition) != 0, #condition)

/* Fills the object with ones first, so that a member the initialiser forgets is found. */
#define EXPECT_INITIALISED(type)                                         \
  do {                                                                   \
    type object;                                                         \
    const unsigned char *bytes = (const unsigned char *)&object;         \
    size_t i = sizeof object.struct_size;                                \
    memset(&object, 0xff, sizeof object);                                \
    type##_init(&object);                                                \
    expect(object.struct_size == sizeof(type), "struct_size of " #type); \
    while (i < sizeof object && bytes[i] == 0) ++i;                      \
    expect(i == sizeof object, "all zero behind struct_size: " #type);   \
  } while (0)

static void log_nothing(void *user, int32_t level, const char *text) {
  (void)user;
  (void)level;
  (void)text;
}

int main(void) {
  static const double positions[2][3] = {{0, 0, 0}, {1, 2, 3}};
  static const float x[2] = {0, 1}, y[2] = {2, 3}, z[2] = {4, 5};
  insitu_context_desc context_desc;
  insitu_array records, columns;
  insitu_log_fn log = log_nothing;

  EXPECT_INITIALISED(insitu_array);
  EXPECT_INITIALISED(insitu_array_report);
  EXPECT_INITIALISED(insitu_particles_desc);
  EXPECT_INITIALISED(insitu_filter_term);
  EXPECT_INITIALISED(insitu_filter);
  EXPECT_INITIALISED(insitu_style);
  EXPECT_INITIALISED(insitu_colormap_desc);
  EXPECT_INITIALISED(insitu_camera);
  EXPECT_INITIALISED(insitu_light);
  EXPECT_INITIALISED(insitu_effects);
  EXPECT_INITIALISED(insitu_view_desc);
  EXPECT_INITIALISED(insitu_image_desc);
  EXPECT_INITIALISED(insitu_stats);

  memset(&context_desc, 0xff, sizeof context_desc);
  insitu_context_desc_init(&context_desc);
  EXPECT(context_desc.struct_size == sizeof context_desc);
  EXPECT(context_desc.abi == INSITU_ABI);
  EXPECT(context_desc.max_threads == 0 && context_desc.max_extra_bytes == 0);
  EXPECT(context_desc.check_level == INSITU_CHECK_POINTERS && context_desc.flags == 0);

  records = insitu_array_records(INSITU_F64, 3, positions, 2, sizeof positions[0]);
  EXPECT(records.struct_size == sizeof records && records.type == INSITU_F64 && records.components == 3);
  EXPECT(records.count == 2 && records.stride_bytes == 24 && records.flags == 0 && records.tail_bytes == 0);
  EXPECT(records.component[0] == (const void *)positions && records.component[1] == NULL);

  columns = insitu_array_columns(INSITU_F32, x, y, z, 2);
  EXPECT(columns.type == INSITU_F32 && columns.components == 3 && columns.count == 2 && columns.stride_bytes == 0);
  EXPECT(columns.component[0] == (const void *)x && columns.component[1] == (const void *)y);
  EXPECT(columns.component[2] == (const void *)z && columns.component[3] == NULL);

  EXPECT(log != NULL);
  return failures != 0;
}
