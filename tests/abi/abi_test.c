/* The binary interface on LP64 machines, in numbers. A program compiled against an older header calls the newest
 * library, so sizes only grow, offsets stay, and constants never change their value. Whoever changes a number here
 * breaks programs that are already compiled. */
#include <insitu/insitu.h>
#include <stdio.h>

static int failures = 0;

static void check(const char *what, long long is, long long must_be) {
  if (is == must_be) return;
  ++failures;
  printf("%s is %lld, must be %lld\n", what, is, must_be);
}

#define SIZE(type, bytes) check("size of " #type, (long long)sizeof(type), bytes)
#define OFFSET(type, member, bytes) check("offset of " #type "::" #member, (long long)offsetof(type, member), bytes)
#define VALUE(constant, number) check(#constant, (long long)(constant), number)

static void check_structs(void) {
  SIZE(insitu_context_desc, 32);
  OFFSET(insitu_context_desc, struct_size, 0);
  OFFSET(insitu_context_desc, abi, 4);
  OFFSET(insitu_context_desc, max_threads, 8);
  OFFSET(insitu_context_desc, check_level, 12);
  OFFSET(insitu_context_desc, max_extra_bytes, 16);
  OFFSET(insitu_context_desc, flags, 24);
  OFFSET(insitu_context_desc, reserved, 28);

  SIZE(insitu_array, 72);
  OFFSET(insitu_array, struct_size, 0);
  OFFSET(insitu_array, type, 4);
  OFFSET(insitu_array, components, 8);
  OFFSET(insitu_array, flags, 12);
  OFFSET(insitu_array, count, 16);
  OFFSET(insitu_array, stride_bytes, 24);
  OFFSET(insitu_array, component, 32);
  OFFSET(insitu_array, tail_bytes, 64);

  SIZE(insitu_array_report, 280);
  OFFSET(insitu_array_report, struct_size, 0);
  OFFSET(insitu_array_report, status, 4);
  OFFSET(insitu_array_report, borrowed_bytes, 8);
  OFFSET(insitu_array_report, copied_bytes, 16);
  OFFSET(insitu_array_report, reason, 24);

  SIZE(insitu_geometry, 8);
  OFFSET(insitu_geometry, id, 0);

  SIZE(insitu_colormap, 8);
  OFFSET(insitu_colormap, id, 0);

  SIZE(insitu_view, 8);
  OFFSET(insitu_view, id, 0);

  SIZE(insitu_image, 8);
  OFFSET(insitu_image, id, 0);

  SIZE(insitu_attribute, 16);
  OFFSET(insitu_attribute, name, 0);
  OFFSET(insitu_attribute, values, 8);

  SIZE(insitu_particles_desc, 200);
  OFFSET(insitu_particles_desc, struct_size, 0);
  OFFSET(insitu_particles_desc, order, 4);
  OFFSET(insitu_particles_desc, name, 8);
  OFFSET(insitu_particles_desc, position, 16);
  OFFSET(insitu_particles_desc, position_scale, 24);
  OFFSET(insitu_particles_desc, position_origin, 32);
  OFFSET(insitu_particles_desc, radius, 56);
  OFFSET(insitu_particles_desc, type, 64);
  OFFSET(insitu_particles_desc, type_radius, 72);
  OFFSET(insitu_particles_desc, type_radius_count, 80);
  OFFSET(insitu_particles_desc, radius_default, 88);
  OFFSET(insitu_particles_desc, radius_scale, 96);
  OFFSET(insitu_particles_desc, attributes, 104);
  OFFSET(insitu_particles_desc, attribute_count, 112);
  OFFSET(insitu_particles_desc, payload, 120);
  OFFSET(insitu_particles_desc, payload_count, 128);
  OFFSET(insitu_particles_desc, flags, 136);
  OFFSET(insitu_particles_desc, reserved, 140);
  OFFSET(insitu_particles_desc, treelet_share, 144);
  OFFSET(insitu_particles_desc, radius_attribute, 152);
  OFFSET(insitu_particles_desc, radius_map, 160);
  OFFSET(insitu_particles_desc, radius_map_count, 168);
  OFFSET(insitu_particles_desc, radius_range, 176);
  OFFSET(insitu_particles_desc, radius_component, 192);
  OFFSET(insitu_particles_desc, reserved_2, 196);

  SIZE(insitu_filter_term, 136);
  OFFSET(insitu_filter_term, struct_size, 0);
  OFFSET(insitu_filter_term, kind, 4);
  OFFSET(insitu_filter_term, flags, 8);
  OFFSET(insitu_filter_term, component, 12);
  OFFSET(insitu_filter_term, attribute, 16);
  OFFSET(insitu_filter_term, range, 24);
  OFFSET(insitu_filter_term, set, 40);
  OFFSET(insitu_filter_term, lower, 48);
  OFFSET(insitu_filter_term, upper, 72);
  OFFSET(insitu_filter_term, plane, 96);
  OFFSET(insitu_filter_term, alternative, 128);
  OFFSET(insitu_filter_term, reserved, 132);

  SIZE(insitu_filter, 16);
  OFFSET(insitu_filter, struct_size, 0);
  OFFSET(insitu_filter, term_count, 4);
  OFFSET(insitu_filter, terms, 8);

  SIZE(insitu_style, 104);
  OFFSET(insitu_style, struct_size, 0);
  OFFSET(insitu_style, color_by, 4);
  OFFSET(insitu_style, attribute, 8);
  OFFSET(insitu_style, component, 16);
  OFFSET(insitu_style, range_mode, 20);
  OFFSET(insitu_style, range, 24);
  OFFSET(insitu_style, colormap, 40);
  OFFSET(insitu_style, own_map, 48);
  OFFSET(insitu_style, color, 56);
  OFFSET(insitu_style, opacity, 80);
  OFFSET(insitu_style, opacity_map, 88);
  OFFSET(insitu_style, opacity_map_count, 96);

  SIZE(insitu_colormap_desc, 24);
  OFFSET(insitu_colormap_desc, struct_size, 0);
  OFFSET(insitu_colormap_desc, kind, 4);
  OFFSET(insitu_colormap_desc, rgba, 8);
  OFFSET(insitu_colormap_desc, count, 16);

  SIZE(insitu_camera, 112);
  OFFSET(insitu_camera, struct_size, 0);
  OFFSET(insitu_camera, kind, 4);
  OFFSET(insitu_camera, eye, 8);
  OFFSET(insitu_camera, look_at, 32);
  OFFSET(insitu_camera, up, 56);
  OFFSET(insitu_camera, fov_y_deg, 80);
  OFFSET(insitu_camera, height, 88);
  OFFSET(insitu_camera, near_clip, 96);
  OFFSET(insitu_camera, far_clip, 104);

  SIZE(insitu_light, 72);
  OFFSET(insitu_light, struct_size, 0);
  OFFSET(insitu_light, kind, 4);
  OFFSET(insitu_light, direction, 8);
  OFFSET(insitu_light, color, 32);
  OFFSET(insitu_light, intensity, 56);
  OFFSET(insitu_light, flags, 64);
  OFFSET(insitu_light, reserved, 68);

  SIZE(insitu_effects, 24);
  OFFSET(insitu_effects, struct_size, 0);
  OFFSET(insitu_effects, flags, 4);
  OFFSET(insitu_effects, ao_samples, 8);
  OFFSET(insitu_effects, seed, 12);
  OFFSET(insitu_effects, ao_radius, 16);

  SIZE(insitu_view_desc, 64);
  OFFSET(insitu_view_desc, struct_size, 0);
  OFFSET(insitu_view_desc, light_count, 4);
  OFFSET(insitu_view_desc, camera, 8);
  OFFSET(insitu_view_desc, effects, 16);
  OFFSET(insitu_view_desc, lights, 24);
  OFFSET(insitu_view_desc, background, 32);

  SIZE(insitu_image_desc, 40);
  OFFSET(insitu_image_desc, struct_size, 0);
  OFFSET(insitu_image_desc, width, 4);
  OFFSET(insitu_image_desc, height, 8);
  OFFSET(insitu_image_desc, samples_per_pixel, 12);
  OFFSET(insitu_image_desc, channels, 16);
  OFFSET(insitu_image_desc, reserved, 20);
  OFFSET(insitu_image_desc, max_samples_per_pixel, 24);
  OFFSET(insitu_image_desc, reserved_2, 28);
  OFFSET(insitu_image_desc, pixel_error, 32);

  SIZE(insitu_stats, 184);
  OFFSET(insitu_stats, struct_size, 0);
  OFFSET(insitu_stats, reserved, 4);
  OFFSET(insitu_stats, step, 8);
  OFFSET(insitu_stats, borrowed_bytes, 16);
  OFFSET(insitu_stats, copied_bytes, 24);
  OFFSET(insitu_stats, owned_bytes, 32);
  OFFSET(insitu_stats, peak_bytes, 40);
  OFFSET(insitu_stats, items, 48);
  OFFSET(insitu_stats, items_skipped, 56);
  OFFSET(insitu_stats, rays, 64);
  OFFSET(insitu_stats, build_s, 72);
  OFFSET(insitu_stats, render_s, 80);
  OFFSET(insitu_stats, write_s, 88);
  OFFSET(insitu_stats, total_s, 96);
  OFFSET(insitu_stats, pixels, 104);
  OFFSET(insitu_stats, samples, 112);
  OFFSET(insitu_stats, pixels_over_error, 120);
  OFFSET(insitu_stats, trees_built, 128);
  OFFSET(insitu_stats, trees_repaired, 136);
  OFFSET(insitu_stats, trees_reused, 144);
  OFFSET(insitu_stats, items_moved, 152);
  OFFSET(insitu_stats, treelets, 160);
  OFFSET(insitu_stats, treelet_bytes, 168);
  OFFSET(insitu_stats, items_filtered, 176);

  SIZE(insitu_cell, 152);
  OFFSET(insitu_cell, struct_size, 0);
  OFFSET(insitu_cell, flags, 4);
  OFFSET(insitu_cell, origin, 8);
  OFFSET(insitu_cell, vectors, 32);
  OFFSET(insitu_cell, replicate, 104);
  OFFSET(insitu_cell, reserved, 116);
  OFFSET(insitu_cell, outline_radius, 120);
  OFFSET(insitu_cell, outline_color, 128);

  SIZE(insitu_bonds_desc, 56);
  OFFSET(insitu_bonds_desc, struct_size, 0);
  OFFSET(insitu_bonds_desc, flags, 4);
  OFFSET(insitu_bonds_desc, name, 8);
  OFFSET(insitu_bonds_desc, particles, 16);
  OFFSET(insitu_bonds_desc, pairs, 24);
  OFFSET(insitu_bonds_desc, cutoff, 32);
  OFFSET(insitu_bonds_desc, cutoff_by_radius, 40);
  OFFSET(insitu_bonds_desc, radius, 48);

  SIZE(insitu_vectors_desc, 64);
  OFFSET(insitu_vectors_desc, struct_size, 0);
  OFFSET(insitu_vectors_desc, flags, 4);
  OFFSET(insitu_vectors_desc, name, 8);
  OFFSET(insitu_vectors_desc, particles, 16);
  OFFSET(insitu_vectors_desc, attribute, 24);
  OFFSET(insitu_vectors_desc, scale, 32);
  OFFSET(insitu_vectors_desc, radius, 40);
  OFFSET(insitu_vectors_desc, head_radius, 48);
  OFFSET(insitu_vectors_desc, head_length, 56);
}

static void check_constants(void) {
  VALUE(INSITU_ABI, 1);
  VALUE(sizeof(insitu_status), 4);

  VALUE(INSITU_OK, 0);
  VALUE(INSITU_ERROR_INVALID_ARGUMENT, 1);
  VALUE(INSITU_ERROR_INVALID_HANDLE, 2);
  VALUE(INSITU_ERROR_WRONG_STATE, 3);
  VALUE(INSITU_ERROR_UNSUPPORTED, 4);
  VALUE(INSITU_ERROR_OUT_OF_MEMORY, 5);
  VALUE(INSITU_ERROR_OVER_BUDGET, 6);
  VALUE(INSITU_ERROR_IO, 7);
  VALUE(INSITU_ERROR_COMM, 8);
  VALUE(INSITU_ERROR_ABI, 9);
  VALUE(INSITU_ERROR_INTERNAL, 10);

  VALUE(INSITU_CHECK_POINTERS, 0);
  VALUE(INSITU_CHECK_VALUES, 1);
  VALUE(INSITU_CHECK_CHECKSUM, 2);

  VALUE(INSITU_CONTEXT_NULL, 1);

  VALUE(INSITU_LOG_ERROR, 1);
  VALUE(INSITU_LOG_WARNING, 2);
  VALUE(INSITU_LOG_INFO, 3);

  VALUE(INSITU_F32, 1);
  VALUE(INSITU_F64, 2);
  VALUE(INSITU_I32, 3);
  VALUE(INSITU_I64, 4);
  VALUE(INSITU_U8, 5);
  VALUE(INSITU_U32, 6);
  VALUE(INSITU_U64, 7);

  VALUE(INSITU_ARRAY_PERMUTABLE, 1);
  VALUE(INSITU_ARRAY_SAME_VALUES, 2);
  VALUE(INSITU_ARRAY_ROWS, 4);

  VALUE(INSITU_USE_POSITION, 1);
  VALUE(INSITU_USE_RADIUS, 2);
  VALUE(INSITU_USE_TYPE, 3);
  VALUE(INSITU_USE_ATTRIBUTE, 4);
  VALUE(INSITU_USE_PAIRS, 5);

  VALUE(INSITU_CELL_PERIODIC_A, 1);
  VALUE(INSITU_CELL_PERIODIC_B, 2);
  VALUE(INSITU_CELL_PERIODIC_C, 4);
  VALUE(INSITU_CELL_PERIODIC, 7);
  VALUE(INSITU_CELL_WRAP, 8);
  VALUE(INSITU_CELL_OUTLINE, 16);

  VALUE(INSITU_BONDS_FLAT_ENDS, 1);
  VALUE(INSITU_BONDS_OWN_STYLE, 2);
  VALUE(INSITU_BONDS_PERIODIC, 4);

  VALUE(INSITU_VECTORS_CENTRED, 1);

  VALUE(INSITU_ORDER_INDEX, 0);
  VALUE(INSITU_ORDER_PERMUTE, 1);
  VALUE(INSITU_ORDER_COPY, 2);
  VALUE(INSITU_PARTICLES_KEEP_PERMUTATION, 1);

  VALUE(INSITU_FILTER_RANGE, 1);
  VALUE(INSITU_FILTER_SET, 2);
  VALUE(INSITU_FILTER_BOX, 3);
  VALUE(INSITU_FILTER_PLANE, 4);
  VALUE(INSITU_FILTER_NOT, 1);

  VALUE(INSITU_COLOR_UNIFORM, 0);
  VALUE(INSITU_COLOR_ATTRIBUTE, 1);

  VALUE(INSITU_RANGE_AUTO, 0);
  VALUE(INSITU_RANGE_FIXED, 1);

  VALUE(INSITU_COLORMAP_CONTINUOUS, 0);
  VALUE(INSITU_COLORMAP_CATEGORICAL, 1);

  VALUE(INSITU_CAMERA_PERSPECTIVE, 0);
  VALUE(INSITU_CAMERA_ORTHOGRAPHIC, 1);

  VALUE(INSITU_LIGHT_AMBIENT, 0);
  VALUE(INSITU_LIGHT_DIRECTIONAL, 1);

  VALUE(INSITU_LIGHT_IN_CAMERA_SPACE, 1);

  VALUE(INSITU_EFFECT_SHADOWS, 1);
  VALUE(INSITU_EFFECT_AMBIENT_OCCLUSION, 2);

  VALUE(INSITU_CHANNEL_COLOR, 1);
  VALUE(INSITU_CHANNEL_DEPTH, 2);
  VALUE(INSITU_CHANNEL_POSITION, 4);
  VALUE(INSITU_CHANNEL_NORMAL, 8);
  VALUE(INSITU_CHANNEL_ITEM, 16);
}

int main(void) {
  check_structs();
  check_constants();
  check("insitu_abi_version()", insitu_abi_version(), INSITU_ABI);
  if (failures == 0) printf("the binary interface is as promised\n");
  return failures != 0;
}
