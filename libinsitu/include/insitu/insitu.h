/* insitu.h - the C API of libinsitu: ray traced pictures of simulation data, straight from the simulation's arrays.
 *
 * Plain C99; needs nothing but the C library. Every struct starts with its own size, so that old programs keep working
 * with new libraries: call the insitu_*_init function of a struct before filling it in. Zero in a field always means
 * "the documented default".
 *
 * Units: a length without a suffix is in the simulation's own length unit; angles end in _deg, sizes in _bytes, pixel
 * sizes in _px, durations in _s. Times given to insitu_step_begin are in the simulation's time unit.
 *
 * Lifetime in one paragraph (the whole text: docs/lifetime.md): arrays handed over by an update between
 * insitu_step_begin and insitu_step_end are borrowed until that step's insitu_step_end; in that window the caller
 * neither writes, moves nor frees them. After it the library holds no pointer of the simulation. Descriptors and
 * strings are read during the call and not kept.
 *
 * Errors: every call returns a status. The first error of a step sticks: later calls of that step do nothing and return
 * it, insitu_step_end returns it once more and clears it, so one check per step is enough.
 *
 * Threads: one thread at a time per context; different contexts are independent.
 */
#ifndef INSITU_H
#define INSITU_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(_WIN32)
#define INSITU_API
#else
#define INSITU_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------- version and status -- */

#define INSITU_VERSION_MAJOR 0
#define INSITU_VERSION_MINOR 1
#define INSITU_VERSION_PATCH 0

/* Number of the binary interface. A context is refused when header and library disagree. */
#define INSITU_ABI 1u

typedef int32_t insitu_status;

enum {
  INSITU_OK = 0,
  INSITU_ERROR_INVALID_ARGUMENT = 1, /* a value or pointer in a descriptor cannot be meant */
  INSITU_ERROR_INVALID_HANDLE = 2,   /* destroyed, of another context or of another kind */
  INSITU_ERROR_WRONG_STATE = 3,      /* the call does not fit here, for example outside of a step */
  INSITU_ERROR_UNSUPPORTED = 4,      /* understood, but this version cannot do it */
  INSITU_ERROR_OUT_OF_MEMORY = 5,    /* the system had no memory left */
  INSITU_ERROR_OVER_BUDGET = 6,      /* it would need more than insitu_context_desc::max_extra_bytes */
  INSITU_ERROR_IO = 7,               /* a file could not be written */
  INSITU_ERROR_COMM = 8,             /* communication between ranks failed */
  INSITU_ERROR_ABI = 9,              /* header and library do not fit together */
  INSITU_ERROR_INTERNAL = 10         /* a defect of the library */
};

/* Version of the loaded library's binary interface; equals INSITU_ABI when header and library fit. */
INSITU_API uint32_t insitu_abi_version(void);
/* "0.1.0 (...)": version and the SIMD targets compiled in. Static storage. */
INSITU_API const char* insitu_version_text(void);
/* "invalid_argument" for INSITU_ERROR_INVALID_ARGUMENT and so on; "unknown" for other numbers. Static storage. */
INSITU_API const char* insitu_status_name(insitu_status status);

/* ------------------------------------------------------------------------------------------------------- context -- */

/* Everything lives in a context; contexts know nothing of each other and may live side by side. */
typedef struct insitu_context_s* insitu_context;

enum {
  INSITU_CHECK_POINTERS = 0, /* descriptors only (default). Non-finite positions are skipped at every level. */
  INSITU_CHECK_VALUES = 1,   /* also reads every attribute once and warns of non-finite values */
  INSITU_CHECK_CHECKSUM = 2  /* also hashes every borrowed array at update and at step_end */
};

enum {
  INSITU_CONTEXT_NULL = 1u /* all calls check their arguments and do nothing else: measures the cost of coupling */
};

typedef struct insitu_context_desc {
  uint32_t struct_size;
  uint32_t abi;             /* INSITU_ABI, set by insitu_context_desc_init */
  uint32_t max_threads;     /* 0 = as many as the machine has; the caller's own thread counts */
  uint32_t check_level;     /* INSITU_CHECK_* */
  uint64_t max_extra_bytes; /* cap on memory the library owns (trees, copies, frame buffers); 0 = no cap */
  uint32_t flags;           /* INSITU_CONTEXT_* */
  uint32_t reserved;        /* 0 */
} insitu_context_desc;

/* Creates a context. `desc` may be NULL (all defaults). On failure `*out` is NULL and insitu_error_text(NULL) has the
 * reason. Errors: invalid_argument, abi, out_of_memory. */
INSITU_API insitu_status insitu_context_create(const insitu_context_desc* desc, insitu_context* out);
/* Frees the context and all it owns; NULL is allowed. Borrowed arrays are not touched. */
INSITU_API void insitu_context_destroy(insitu_context context);

enum { INSITU_LOG_ERROR = 1, INSITU_LOG_WARNING = 2, INSITU_LOG_INFO = 3 };
typedef void (*insitu_log_fn)(void* user, int32_t level, const char* text);
/* Messages up to `level` go to `fn` on the calling thread; `fn` NULL switches them off (the default: the library never
 * prints). `text` lives for the duration of the callback. */
INSITU_API insitu_status insitu_context_set_log(insitu_context context, insitu_log_fn fn, void* user, int32_t level);

/* Text of the last error of this context, or with NULL of the last failed insitu_context_create of this thread. Never
 * NULL; valid until the next call that fails on this context. */
INSITU_API const char* insitu_error_text(insitu_context context);

/* One JSON object per step is appended to the file `path` at each insitu_step_end (docs/report.md lists its members);
 * NULL stops it. The file is opened, appended and closed per step. Errors: invalid_argument, io. */
INSITU_API insitu_status insitu_context_set_report(insitu_context context, const char* path);

/* -------------------------------------------------------------------------------------------------------- arrays -- */

enum { INSITU_F32 = 1, INSITU_F64 = 2, INSITU_I32 = 3, INSITU_I64 = 4, INSITU_U8 = 5, INSITU_U32 = 6, INSITU_U64 = 7 };

enum {
  INSITU_ARRAY_PERMUTABLE = 1u,  /* the library may change the order of the items (never their values) */
  INSITU_ARRAY_SAME_VALUES = 2u, /* promise: as in the previous step; saves a rebuild, never required */
  INSITU_ARRAY_ROWS = 4u         /* component[0] points to a table of row pointers, one per item (double **) */
};

/* A view of memory the caller owns: `count` items of `components` scalars each.
 *   records (AoS)   component[0] = first scalar of item 0; stride_bytes = sizeof(record); component[1..] = NULL
 *   columns (SoA)   component[0..] = one pointer each; stride_bytes = distance from item to item within a column
 *   rows            INSITU_ARRAY_ROWS; component[0] = table of pointers, stride_bytes = distance in that table
 * A permutation moves what rows hold; the table stays. Rows that stand anywhere must not be named twice in one set.
 * stride_bytes 0 means packed; it may be negative. Scalars are aligned to their own size. Nothing outside the scalars
 * is read, unless tail_bytes says how many bytes behind each component's last scalar are readable too. */
typedef struct insitu_array {
  uint32_t struct_size;
  uint32_t type;       /* INSITU_F32 ... INSITU_U64 */
  uint32_t components; /* 1 to 4; u8 payload may have any number: whole records as bytes */
  uint32_t flags;      /* INSITU_ARRAY_* */
  uint64_t count;      /* items; 0 with NULL pointers is a normal, empty array */
  int64_t stride_bytes;
  void* component[4]; /* constant data is passed through a cast: only PERMUTABLE arrays are ever written */
  uint64_t tail_bytes;
} insitu_array;

enum {
  INSITU_USE_POSITION = 1,
  INSITU_USE_RADIUS = 2,
  INSITU_USE_TYPE = 3,
  INSITU_USE_ATTRIBUTE = 4,
  INSITU_USE_PAIRS = 5
};

typedef struct insitu_array_report {
  uint32_t struct_size;
  insitu_status status;    /* what an update with this array would say of it */
  uint64_t borrowed_bytes; /* read in place */
  uint64_t copied_bytes;   /* 0 for every layout of this version: all are read in place */
  char reason[256];        /* one sentence, always ended by a NUL */
} insitu_array_report;

/* Says without side effects whether an array can be used for `use` (INSITU_USE_*) and at what cost. `out` may be NULL.
 * Returns the same status as out->status. */
INSITU_API insitu_status insitu_array_check(const insitu_array* array, uint32_t use, insitu_array_report* out);

/* ----------------------------------------------------------------------------------------------------- particles -- */

/* Children of a context. 0 is never a valid id. Stale and foreign ids are reported as invalid_handle. */
typedef struct insitu_geometry {
  uint64_t id;
} insitu_geometry;
typedef struct insitu_colormap {
  uint64_t id;
} insitu_colormap;
typedef struct insitu_view {
  uint64_t id;
} insitu_view;
typedef struct insitu_image {
  uint64_t id;
} insitu_image;

enum {
  INSITU_ORDER_INDEX = 0, /* nothing moves; a permutation index of 4 bytes per particle (8 past 2^32) beside the data */
  INSITU_ORDER_PERMUTE =
      1,                /* all arrays named in the descriptor are permuted together in place: 0 bytes per particle */
  INSITU_ORDER_COPY = 2 /* positions are copied in tree order: 16 bytes per particle (32 for f64), fastest */
};

enum {
  INSITU_PARTICLES_KEEP_PERMUTATION =
      1u /* with PERMUTE: keep who came from where (4 bytes per particle, 8 past 2^32) */
};

/* A named array with one item per particle; the struct itself never grows. */
typedef struct insitu_attribute {
  const char* name;
  const insitu_array* values;
} insitu_attribute;

typedef struct insitu_particles_desc {
  uint32_t struct_size;
  uint32_t order;               /* INSITU_ORDER_*; fixed at creation */
  const char* name;             /* for messages and the report; NULL = "particles"; fixed at creation */
  const insitu_array* position; /* 3 x f32 | f64 | i32 | u32; NULL at creation: only declares */
  double position_scale;        /* integer positions: world = origin + scale * value; 0 = 1 */
  double position_origin[3];    /* integer positions only */
  const insitu_array* radius;   /* 1 x f32 | f64, one per particle; or NULL */
  const insitu_array* type;     /* 1 x integer, one per particle; needed by type_radius; or NULL */
  const double* type_radius;    /* radius of type 0, 1, ...; used where `radius` is NULL; types outside are skipped */
  uint64_t type_radius_count;
  double radius_default; /* one radius for all; 0 = half the mean spacing in the bounding box */
  double radius_scale;   /* factor on every radius; 0 = 1 */
  const insitu_attribute* attributes;
  uint64_t attribute_count;
  const insitu_array* const* payload; /* arrays that only have to move along under PERMUTE (velocities, ids, ...) */
  uint64_t payload_count;
  uint32_t flags;    /* INSITU_PARTICLES_* */
  uint32_t reserved; /* 0 */
  /* Most memory for treelets, as a part of the bytes of the positions: 0 = none, 0.15 = for 1.8 bytes per particle in
   * f32. Treelets are boxes around runs of some 16 particles: rays take half to three quarters of the time, and a
   * few large particles among many small ones cost little. Fewer, or none, are made when the share is too small or
   * max_extra_bytes leaves no room; insitu_stats says what was made. Under a filter that leaves few particles of a run
   * the treelets are fewer, and the share also holds copies of their centres, 16 bytes each, if it can. */
  double treelet_share;
  /* Radii by the value of an attribute, where there are neither `radius` nor `type_radius`: radius_map holds radii
   * evenly spaced over the values from radius_range[0] to radius_range[1], linear in between, the first and the last
   * beyond; copied. What is not a number is skipped. */
  const char* radius_attribute; /* one of `attributes`, or "type"; NULL = no such map */
  const double* radius_map;
  uint64_t radius_map_count; /* 2 to 65536 */
  double radius_range[2];    /* ascending */
  uint32_t radius_component; /* 0 = the value, or the length of a vector; 1 to 4 = that component */
  uint32_t reserved_2;       /* 0 */
} insitu_particles_desc;

/* Declares a set of particles; with arrays in `desc` (inside a step) it also updates it.
 * With INSITU_ORDER_PERMUTE every array of the descriptor needs INSITU_ARRAY_PERMUTABLE.
 * Errors: invalid_argument, wrong_state (arrays outside of a step), out_of_memory. */
INSITU_API insitu_status insitu_particles_create(insitu_context context, const insitu_particles_desc* desc,
                                                 insitu_geometry* out);
/* Binds this step's arrays, borrowed until insitu_step_end. All arrays have position->count items. A set that is not
 * updated in a step is absent from that step's pictures. Particles with a non-finite position, a magnitude above 1e100,
 * or a negative, zero or non-finite radius are not drawn; they are counted and reported.
 * Errors: invalid_argument, invalid_handle, wrong_state. */
INSITU_API insitu_status insitu_particles_update(insitu_context context, insitu_geometry particles,
                                                 const insitu_particles_desc* desc);
/* After insitu_commit: original[i] = the place that the particle now at place i of the tree's order had when the step
 * began. With PERMUTE that is the order of the arrays (needs KEEP_PERMUTATION), otherwise that of the index or copy.
 * `count` is the number of entries of `original`; skipped particles stand at the end.
 * Errors: wrong_state (not committed, or not kept), invalid_argument (count too small). */
INSITU_API insitu_status insitu_particles_permutation(insitu_context context, insitu_geometry particles,
                                                      uint64_t* original, uint64_t count);
/* With PERMUTE and KEEP_PERMUTATION, after insitu_commit and before insitu_step_end: puts every record of every array
 * back where it was when the step began. The set is then absent until its next update. */
INSITU_API insitu_status insitu_particles_restore_order(insitu_context context, insitu_geometry particles);

enum { INSITU_FILTER_RANGE = 1, INSITU_FILTER_SET = 2, INSITU_FILTER_BOX = 3, INSITU_FILTER_PLANE = 4 };
enum { INSITU_FILTER_NOT = 1u /* holds where the term would not */ };

/* One condition on a particle. Members that its kind does not name are not read. */
typedef struct insitu_filter_term {
  uint32_t struct_size;
  uint32_t kind;           /* INSITU_FILTER_* */
  uint32_t flags;          /* INSITU_FILTER_NOT */
  uint32_t component;      /* RANGE, SET: 0 = the value, or the length of a vector; 1 to 4 = that component */
  const char* attribute;   /* RANGE, SET: name of the attribute; the type array is called "type" */
  double range[2];         /* RANGE: smallest and largest value, inclusive; may be infinite. NaN is in no range */
  const insitu_array* set; /* SET: 1 x integer, the values that are meant, in any order; copied during the call */
  double lower[3];         /* BOX: holds for centres within, faces included, in world space; may be infinite */
  double upper[3];
  double plane[4];      /* PLANE: holds for centres with plane[0] x + plane[1] y + plane[2] z >= plane[3] */
  uint32_t alternative; /* terms of the same number must all hold, of one number; all 0: every term must hold */
  uint32_t reserved;    /* 0 */
} insitu_filter_term;

typedef struct insitu_filter {
  uint32_t struct_size;
  uint32_t term_count; /* at most 1024; 0 = no filter */
  const insitu_filter_term* terms;
} insitu_filter;

/* Draws only those particles of a set for which the filter holds; NULL: all of them. Kept until changed, in force from
 * the next insitu_commit, which may be a second one in the same step: the tree is not built again (docs/filters.md).
 * Integers are compared as integers, whatever their size; floating point values are members of a set where they are
 * whole numbers. Bounds and fitted cameras are those of the particles that are left; automatic radii and colour ranges
 * those of all, so that nothing changes its look with a filter. Bonds are drawn where both ends are, arrows where their
 * particle is. An unknown attribute name is an error at the next commit or at this call when arrays are bound; the
 * message lists the valid names. Errors: invalid_argument, invalid_handle, unsupported (a set of floating point
 * numbers), over_budget. */
INSITU_API insitu_status insitu_particles_set_filter(insitu_context context, insitu_geometry particles,
                                                     const insitu_filter* filter);

enum { INSITU_COLOR_UNIFORM = 0, INSITU_COLOR_ATTRIBUTE = 1 };
enum { INSITU_RANGE_AUTO = 0, INSITU_RANGE_FIXED = 1 };

typedef struct insitu_style {
  uint32_t struct_size;
  uint32_t color_by;       /* INSITU_COLOR_* */
  const char* attribute;   /* name of the attribute that gives the colour; the type array is called "type" */
  uint32_t component;      /* 0 = the value, or the length of a vector; 1 to 4 = that component */
  uint32_t range_mode;     /* INSITU_RANGE_*; AUTO = smallest to largest finite value of the step */
  double range[2];         /* values at the two ends of the colour map, with INSITU_RANGE_FIXED */
  const char* colormap;    /* "viridis" (default), "inferno", "coolwarm", "categorical", "elements" */
  insitu_colormap own_map; /* used instead of `colormap` when its id is not 0 */
  double color[3];         /* linear RGB 0..1 of INSITU_COLOR_UNIFORM; all 0 = 0.8 grey */
  double opacity;          /* 0..1, factor on the opacity of the own map, or of the colour; 0 = 1: opaque */
  /* One more factor, by value: opacities of 0..1 evenly spaced over the colour map, linear in between; copied. For
   * maps that are continuous, the built-in ones too; NULL = 1 everywhere. */
  const double* opacity_map;
  uint64_t opacity_map_count; /* at most 65536 */
} insitu_style;

/* How a geometry looks; kept until changed. Particles of less than full opacity let through what is behind them
 * (docs/opacity.md): each counts once, where a ray enters it, in the order of distance; those of opacity 0 are not
 * there at all, those whose value is not a number are opaque. Bonds and vectors are opaque: for them a style with
 * another opacity, or with a colour map that has one, is unsupported. An unknown attribute name is an error at the next
 * commit or at this call when arrays are bound; the message lists the valid names. An unknown colour map likewise, at
 * this call. */
INSITU_API insitu_status insitu_geometry_set_style(insitu_context context, insitu_geometry geometry,
                                                   const insitu_style* style);
/* Bounds of the drawn items, radii included, after insitu_commit; lower > upper when nothing is drawn. */
INSITU_API insitu_status insitu_geometry_bounds(insitu_context context, insitu_geometry geometry, double lower[3],
                                                double upper[3]);
INSITU_API insitu_status insitu_geometry_destroy(insitu_context context, insitu_geometry geometry);

enum { INSITU_COLORMAP_CONTINUOUS = 0, INSITU_COLORMAP_CATEGORICAL = 1 };

typedef struct insitu_colormap_desc {
  uint32_t struct_size;
  uint32_t kind;      /* INSITU_COLORMAP_*: interpolated, or colour number (value mod count) */
  const double* rgba; /* 4 x count: sRGB 0..1 and opacity, evenly spaced; copied */
  uint64_t count;     /* at least 1 */
} insitu_colormap_desc;

/* A transfer function of the caller's own. */
INSITU_API insitu_status insitu_colormap_create(insitu_context context, const insitu_colormap_desc* desc,
                                                insitu_colormap* out);
INSITU_API insitu_status insitu_colormap_destroy(insitu_context context, insitu_colormap colormap);

/* ----------------------------------------------------------------------------------------- cells, bonds, vectors -- */

enum {
  INSITU_CELL_PERIODIC_A = 1u, /* the simulation repeats along vectors[0] */
  INSITU_CELL_PERIODIC_B = 2u, /* ... vectors[1] */
  INSITU_CELL_PERIODIC_C = 4u, /* ... vectors[2] */
  INSITU_CELL_PERIODIC = 7u,   /* along all three */
  INSITU_CELL_WRAP = 8u,       /* particles outside are shown at their periodic image inside; no value changes */
  INSITU_CELL_OUTLINE = 16u    /* its edges are drawn, as thin sticks */
};

/* The cell of a set of particles. Copies of the set are drawn as instances: they take a few hundred bytes each. */
typedef struct insitu_cell {
  uint32_t struct_size;
  uint32_t flags; /* INSITU_CELL_* */
  double origin[3];
  double vectors[3][3];    /* the three edges; any angles, but not in one plane */
  uint32_t replicate[3];   /* how often it is drawn along each vector, itself included; 0 = 1 */
  uint32_t reserved;       /* 0 */
  double outline_radius;   /* 0 = 1/400 of the longest edge */
  double outline_color[3]; /* linear RGB; all 0 = dark grey */
} insitu_cell;

/* Gives a set of particles a cell, or with NULL none; kept until changed, in force from the next insitu_commit. Bonds
 * and vectors of the set are drawn as often as its particles are. The item channel shows the particles' own items in
 * every copy, and all ones for the outline. Copies by INSITU_CELL_WRAP and `replicate` together are at most 2^20.
 * Errors: invalid_argument, invalid_handle; at insitu_commit unsupported, when particles that are to be wrapped lie in
 * more than 4096 images of the cell. */
INSITU_API insitu_status insitu_particles_set_cell(insitu_context context, insitu_geometry particles,
                                                   const insitu_cell* cell);

enum {
  INSITU_BONDS_FLAT_ENDS = 1u, /* bare cylinders; by default half balls close the ends */
  INSITU_BONDS_OWN_STYLE = 2u, /* coloured by the bonds' own style; by default each half as the particle at its end */
  INSITU_BONDS_PERIODIC = 4u   /* across borders of the set's cell, each as a half bond on either side: pairs between
                                  their nearest images (exact below half the smallest height of the cell), bonds by
                                  distance to every image that is near enough */
};

/* Sticks between particles of one set, by a list of pairs, or between all pairs nearer than some distance. */
typedef struct insitu_bonds_desc {
  uint32_t struct_size;
  uint32_t flags;            /* INSITU_BONDS_* */
  const char* name;          /* for messages and the report; NULL = "bonds"; fixed at creation */
  insitu_geometry particles; /* the set; fixed at creation */
  const insitu_array* pairs; /* 2 x i32 | i64 | u32 | u64: items of the set, counted from 0; or NULL. Read in place */
  double cutoff;             /* without `pairs`: all pairs nearer than this */
  double cutoff_by_radius; /* without `pairs` and `cutoff`: nearer than this times the sum of the two radii as drawn */
  double radius;           /* 0 = a quarter of the set's largest radius */
} insitu_bonds_desc;

/* Declares the bonds of a set; a descriptor with `pairs` inside a step also updates them. Bonds by distance are drawn
 * in every step in which their set is; those by `pairs` borrow the array and need an update in each step. Pairs with an
 * index out of range, twice the same item or place, or a position that is not finite are not drawn; they are counted
 * and warned of. Pairs cannot name particles of a set with INSITU_ORDER_PERMUTE, whose items change places. The item
 * channel shows the number of the pair, for bonds by distance the particle at the nearer end.
 * insitu_geometry_set_style, insitu_geometry_bounds and insitu_geometry_destroy work as for particles; the attributes
 * are those of the set, at the nearer end. Bonds are destroyed with their set. Errors: invalid_argument,
 * invalid_handle, wrong_state (pairs outside of a step), unsupported; at insitu_commit invalid_argument, when bonds by
 * distance across borders may be longer than half the cell. */
INSITU_API insitu_status insitu_bonds_create(insitu_context context, const insitu_bonds_desc* desc,
                                             insitu_geometry* out);
INSITU_API insitu_status insitu_bonds_update(insitu_context context, insitu_geometry bonds,
                                             const insitu_bonds_desc* desc);

enum { INSITU_VECTORS_CENTRED = 1u /* the particle is in the middle of its arrow; by default at the tail */ };

/* Arrows at the particles of a set. */
typedef struct insitu_vectors_desc {
  uint32_t struct_size;
  uint32_t flags;            /* INSITU_VECTORS_* */
  const char* name;          /* for messages and the report; NULL = "vectors"; fixed at creation */
  insitu_geometry particles; /* the set; fixed at creation */
  const char* attribute;     /* an attribute of the set with three components */
  double scale;              /* length of an arrow over that of its vector; 0 = the longest is twice the mean spacing */
  double radius;             /* of the shaft; 0 = a tenth of half the mean spacing */
  double head_radius;        /* 0 = 2.5 times `radius` */
  double head_length;        /* 0 = 2.5 times `head_radius`; shorter arrows are all head, smaller in proportion */
} insitu_vectors_desc;

/* Declares arrows; they are drawn in every step in which their set is, without an update. Coloured by their length,
 * until insitu_geometry_set_style says otherwise. Vectors that are not finite are not drawn, but counted and warned of.
 * The item channel shows the particle. Vectors are destroyed with their set. Errors: invalid_argument, invalid_handle;
 * at insitu_commit invalid_argument for an attribute that is not there. */
INSITU_API insitu_status insitu_vectors_create(insitu_context context, const insitu_vectors_desc* desc,
                                               insitu_geometry* out);
INSITU_API insitu_status insitu_vectors_update(insitu_context context, insitu_geometry vectors,
                                               const insitu_vectors_desc* desc);

/* ---------------------------------------------------------------------------------------------------------- view -- */

enum { INSITU_CAMERA_PERSPECTIVE = 0, INSITU_CAMERA_ORTHOGRAPHIC = 1 };

typedef struct insitu_camera {
  uint32_t struct_size;
  uint32_t kind; /* INSITU_CAMERA_* */
  double eye[3];
  double look_at[3]; /* equal to eye: the view direction defaults to -z */
  double up[3];      /* 0 0 0 = the y axis, or z where the view goes along y */
  double fov_y_deg;  /* perspective: full vertical angle; 0 = 35 */
  double height;     /* orthographic: world height of the image; 0 = as high as the data */
  double near_clip;  /* along the ray; 0 = at the eye */
  double far_clip;   /* along the ray; 0 = none */
} insitu_camera;

enum { INSITU_LIGHT_AMBIENT = 0, INSITU_LIGHT_DIRECTIONAL = 1 };
enum { INSITU_LIGHT_IN_CAMERA_SPACE = 1u };

typedef struct insitu_light {
  uint32_t struct_size;
  uint32_t kind;       /* INSITU_LIGHT_* */
  double direction[3]; /* directional: where the light goes, in world space, or in camera space (right, up, forward) */
  double color[3];     /* linear RGB; all 0 = white */
  double intensity;    /* 0 = 1 */
  uint32_t flags;      /* INSITU_LIGHT_IN_CAMERA_SPACE */
  uint32_t reserved;   /* 0 */
} insitu_light;

enum { INSITU_EFFECT_SHADOWS = 1u, INSITU_EFFECT_AMBIENT_OCCLUSION = 2u };

/* What is simulated besides local shading; what is not asked for costs nothing. */
typedef struct insitu_effects {
  uint32_t struct_size;
  uint32_t flags;      /* INSITU_EFFECT_* */
  uint32_t ao_samples; /* rays per hit; 0 = 8 */
  uint32_t seed;       /* of all random numbers; the same seed gives the same picture */
  double ao_radius;    /* occluders farther away do not count; 0 = a tenth of the diagonal of the scene */
} insitu_effects;

typedef struct insitu_view_desc {
  uint32_t struct_size;
  uint32_t light_count;          /* 0 = a key light from above the camera and ambient light */
  const insitu_camera* camera;   /* NULL = fitted to the data at the first render */
  const insitu_effects* effects; /* NULL = none */
  const insitu_light* lights;
  double background[4]; /* linear RGB and opacity; all 0 = opaque white */
} insitu_view_desc;

/* `desc` may be NULL: a fitted perspective camera, default lights, no effects, white background. */
INSITU_API insitu_status insitu_view_create(insitu_context context, const insitu_view_desc* desc, insitu_view* out);
INSITU_API insitu_status insitu_view_set_camera(insitu_context context, insitu_view view, const insitu_camera* camera);
INSITU_API insitu_status insitu_view_get_camera(insitu_context context, insitu_view view, insitu_camera* camera);
INSITU_API insitu_status insitu_view_set_effects(insitu_context context, insitu_view view,
                                                 const insitu_effects* effects);
/* Replaces all lights; count 0 brings the default ones back. */
INSITU_API insitu_status insitu_view_set_lights(insitu_context context, insitu_view view, const insitu_light* lights,
                                                uint64_t count);
/* Linear RGB and opacity (0: the background is left out and the image carries alpha). */
INSITU_API insitu_status insitu_view_set_background(insitu_context context, insitu_view view, const double rgba[4]);
/* After insitu_commit: moves the camera along its direction, and sets what it looks at, so that all data fill the
 * image whose width is `aspect` times its height (0 = 1). */
INSITU_API insitu_status insitu_view_fit(insitu_context context, insitu_view view, double aspect);
/* Turns the camera about the up axis through what it looks at: a turntable in steps of `angle_deg`. */
INSITU_API insitu_status insitu_view_turn(insitu_context context, insitu_view view, double angle_deg);
INSITU_API insitu_status insitu_view_destroy(insitu_context context, insitu_view view);

/* --------------------------------------------------------------------------------------------------------- image -- */

enum {
  INSITU_CHANNEL_COLOR = 1u,    /* 4 x f32, linear RGB premultiplied by alpha; always there */
  INSITU_CHANNEL_DEPTH = 2u,    /* 1 x f32, distance along the ray from the eye; +inf for the background */
  INSITU_CHANNEL_POSITION = 4u, /* 3 x f32, world position of the hit; 0 for the background */
  INSITU_CHANNEL_NORMAL = 8u,   /* 3 x f32, unit normal towards the viewer; 0 for the background */
  INSITU_CHANNEL_ITEM = 16u     /* 1 x u64, item index in the caller's arrays as they stand; all ones = background */
};

typedef struct insitu_image_desc {
  uint32_t struct_size;
  uint32_t width;             /* pixels; 0 = 1024 */
  uint32_t height;            /* pixels; 0 = 768 */
  uint32_t samples_per_pixel; /* 0 = 4 */
  uint32_t channels;          /* INSITU_CHANNEL_*; colour is always there */
  uint32_t reserved;          /* 0 */
  /* Adaptive sampling (docs/antialiasing.md): a pixel takes samples_per_pixel, at least 2, and then goes on until the
   * standard error of its displayed value is estimated to be below pixel_error, or it has this many; 0 = every pixel
   * takes samples_per_pixel. Channels other than colour are those of the first sample. */
  uint32_t max_samples_per_pixel;
  uint32_t reserved_2; /* 0 */
  double pixel_error;  /* of sRGB values and opacity of 0..1; 0 = 0.02; only with max_samples_per_pixel */
} insitu_image_desc;

/* Errors: invalid_argument, over_budget, out_of_memory. */
INSITU_API insitu_status insitu_image_create(insitu_context context, const insitu_image_desc* desc, insitu_image* out);
/* Renders all committed geometries. The picture depends on the data, the view and the image alone: not on the number of
 * threads, the SIMD target of the machine or the order of the particles. Errors: wrong_state (nothing committed). */
INSITU_API insitu_status insitu_render(insitu_context context, insitu_view view, insitu_image image);
/* Writes ".png" (sRGB, colour only) or ".exr" (linear, every channel of the image). `pattern` may hold {step}, or
 * {step:6} for zero padding to six digits, {time} or {time:3} for three digits behind the point, and {{ for a brace.
 * The file appears under a temporary name in the same folder and is renamed when it is complete. The first image of a
 * process loads the encoder, libinsitu_image. Errors: io (the text names the file and the reason), unsupported (other
 * endings, or no encoder). */
INSITU_API insitu_status insitu_image_write(insitu_context context, insitu_image image, const char* pattern);
/* A view of the library's own pixels, row by row from the top; valid until the next render into or destruction of this
 * image. `channel` is one INSITU_CHANNEL_*. */
INSITU_API insitu_status insitu_image_channel(insitu_context context, insitu_image image, uint32_t channel,
                                              insitu_array* out);
INSITU_API insitu_status insitu_image_destroy(insitu_context context, insitu_image image);

/* ---------------------------------------------------------------------------------------------------------- step -- */

/* Opens a step. `step` and `time` go into file names, image metadata and the report. */
INSITU_API insitu_status insitu_step_begin(insitu_context context, uint64_t step, double time);
/* Builds what changed; needed before render, fit, bounds and permutation. With INSITU_ORDER_PERMUTE this is the call
 * that permutes. */
INSITU_API insitu_status insitu_commit(insitu_context context);
/* Drops every borrowed pointer, appends the report line, and returns and clears the first error of the step. */
INSITU_API insitu_status insitu_step_end(insitu_context context);

typedef struct insitu_stats {
  uint32_t struct_size;
  uint32_t reserved;
  uint64_t step;           /* counters below: of the current step, or of the last one outside of a step */
  uint64_t borrowed_bytes; /* simulation memory read in place */
  uint64_t copied_bytes;   /* simulation memory copied (INSITU_ORDER_COPY) */
  uint64_t owned_bytes;    /* all memory the context holds now: trees, indices, copies, frame buffers */
  uint64_t peak_bytes;     /* highest owned_bytes since the context was created */
  uint64_t items;          /* particles handed over */
  uint64_t items_skipped;  /* of these not drawn: non-finite, out of range, or without a positive radius */
  uint64_t rays;           /* camera rays, shadow rays and ambient occlusion rays */
  double build_s;          /* wall time in seconds, summed over the step's calls */
  double render_s;
  double write_s;
  double total_s;             /* inside of library calls, from step_begin to step_end */
  uint64_t pixels;            /* rendered; counted again in each image */
  uint64_t samples;           /* camera rays through these pixels */
  uint64_t pixels_over_error; /* of these at max_samples_per_pixel with an estimated error above pixel_error */
  uint64_t trees_built;       /* trees made in this step from particles in no useful order */
  uint64_t trees_repaired;    /* from particles nearly in the order of the step before */
  uint64_t trees_reused;      /* their particles were in order already */
  uint64_t items_moved;       /* moves of particles, or of entries of an index, that this took */
  uint64_t treelets;          /* of all sets; 0 where they did not fit or were not asked for */
  uint64_t treelet_bytes;     /* what they occupy, a part of owned_bytes */
  uint64_t items_filtered;    /* particles that could be drawn, but that filters leave out */
} insitu_stats;

INSITU_API insitu_status insitu_stats_get(insitu_context context, insitu_stats* out);

/* --------------------------------------------------------------------------------------------------- initialisers --
 */
/* In the header, so that they set the size that the caller was compiled with. */

#define INSITU_DEFINE_INIT(type)                    \
  static inline void type##_init(type* object) {    \
    memset(object, 0, sizeof *object);              \
    object->struct_size = (uint32_t)sizeof *object; \
  }
INSITU_DEFINE_INIT(insitu_array)
INSITU_DEFINE_INIT(insitu_array_report)
INSITU_DEFINE_INIT(insitu_particles_desc)
INSITU_DEFINE_INIT(insitu_filter_term)
INSITU_DEFINE_INIT(insitu_filter)
INSITU_DEFINE_INIT(insitu_style)
INSITU_DEFINE_INIT(insitu_colormap_desc)
INSITU_DEFINE_INIT(insitu_camera)
INSITU_DEFINE_INIT(insitu_light)
INSITU_DEFINE_INIT(insitu_effects)
INSITU_DEFINE_INIT(insitu_view_desc)
INSITU_DEFINE_INIT(insitu_image_desc)
INSITU_DEFINE_INIT(insitu_stats)
INSITU_DEFINE_INIT(insitu_cell)
INSITU_DEFINE_INIT(insitu_bonds_desc)
INSITU_DEFINE_INIT(insitu_vectors_desc)
#undef INSITU_DEFINE_INIT

static inline void insitu_context_desc_init(insitu_context_desc* object) {
  memset(object, 0, sizeof *object);
  object->struct_size = (uint32_t)sizeof *object;
  object->abi = INSITU_ABI;
}

/* Records in memory, `stride_bytes` apart (0 = packed): insitu_array_records(INSITU_F64, 3, x, n, 0). */
static inline insitu_array insitu_array_records(uint32_t type, uint32_t components, const void* first, uint64_t count,
                                                int64_t stride_bytes) {
  insitu_array array;
  insitu_array_init(&array);
  array.type = type;
  array.components = components;
  array.count = count;
  array.stride_bytes = stride_bytes;
  array.component[0] = (void*)(uintptr_t)first;
  return array;
}

/* Three columns x, y, z of packed scalars. */
static inline insitu_array insitu_array_columns(uint32_t type, const void* x, const void* y, const void* z,
                                                uint64_t count) {
  insitu_array array = insitu_array_records(type, 3, x, count, 0);
  array.component[1] = (void*)(uintptr_t)y;
  array.component[2] = (void*)(uintptr_t)z;
  return array;
}

#ifdef __cplusplus
}
#endif

#endif /* INSITU_H */
