/* lib/gles/gles_private.h: what is inside a pupil_gles, and the interfaces between its files. */
#ifndef PUPIL_GLES_GLES_PRIVATE_H
#define PUPIL_GLES_GLES_PRIVATE_H

#include "base/versioned.h"
#include "core/object.h"
#include "core/read.h"
#include "gl_functions.h"
#include "gles_variant.h"
#include "pupil/error.h"

/* As in shaders/regions.glsl. 64 bands and 16 rows of the grid have 79 boundaries at most, the frame's first row among
 * them. */
#define GLES_REGION_COLUMNS PUPIL_GRID_SIDE
#define GLES_REGION_ROWS    80
#define GLES_PARTS_X        8 /* meter.frag */
#define GLES_PARTS_Y        4
#define GLES_RING           3
#define GLES_PLANES         3 /* pupil_image: data, chroma, cr */

/* A row of regions, as the shaders take it. */
typedef struct gles_region_row {
    int32_t first, end; /* rows of pixels, or of quads */
    int32_t grid_row, band;
} gles_region_row;

/* What comes back of a frame; as in shaders/statistics.glsl. Words of a region: shaders/regions.glsl, pack_sums. */
typedef struct gles_statistics {
    uint32_t region[GLES_REGION_ROWS][GLES_REGION_COLUMNS][4];
    uint32_t level[4]; /* ADAPT_GPU: lower and upper word of 2^-56 stops, whether a frame has set it, 0 */
    uint32_t peak[4];  /* bits of the brightest channel, 0, 0, 0 */
    uint32_t bin[PUPIL_HISTOGRAM_BINS + PUPIL_PEAK_BINS][2]; /* lower and upper word */
    uint32_t peaks[GLES_REGION_COLUMNS][4];                  /* ES 3.0, in place of peak: one for each column */
} gles_statistics;

/* A frame whose statistics are in flight. */
typedef struct gles_slot {
    GLuint buffer;
    GLsync fence;
    pupil_frame_info info;
} gles_slot;

typedef enum gles_program_name {
    GLES_METER = 0,
    GLES_REDUCE,  /* ES 3.0 */
    GLES_SCATTER, /* ES 3.0, histogram */
    GLES_COUNT,   /* ES 3.0, histogram */
    GLES_WEIGH,   /* ES 3.0, ADAPT_GPU */
    GLES_ADAPT,   /* ADAPT_GPU */
    GLES_MAP,
    GLES_MAP_SCALED,
    GLES_PROGRAM_COUNT
} gles_program_name;

/* 0 where a use needs none. The rest: the locations of the uniforms that change from frame to frame. */
typedef struct gles_programs {
    GLuint name[GLES_PROGRAM_COUNT];
    struct {
        GLint step_weight, minus_divisor, level_limits, given;
    } adapt;
    struct {
        GLint scale, inverse_white_squared, gamut, dither, turn, shift, knots, knot_scale, knot_levels, direct,
            has_to_picture, to_picture;
    } map[2]; /* GLES_MAP, GLES_MAP_SCALED */
} gles_programs;

/* Texture units. */
enum {
    GLES_UNIT_FRAME = 0,
    GLES_UNIT_CHROMA,
    GLES_UNIT_CR,
    GLES_UNIT_LIGHT,
    GLES_UNIT_ENCODER,
    GLES_UNIT_STATE,
    GLES_UNIT_VEIL,
    GLES_UNIT_COUNT
};

/* Both tables, of light and of an encoder, have rows of 256: ES 3.0 has textures of 2048. 16 rows are 32 octaves of an
 * encoder, more than any transfer needs, and 4096 codes of light, more than any curve has. */
enum { GLES_TABLE_WIDTH = 256, GLES_TABLE_HEIGHT = 16 };

/* Targets of ES 3.0's chain. */
enum {
    GLES_PARTS = 0,
    GLES_REGIONS,
    GLES_COLUMNS, /* ADAPT_GPU */
    GLES_STATE_0,
    GLES_STATE_1,
    GLES_BINS, /* histogram */
    GLES_COUNTS,
    GLES_TARGET_COUNT
};

/* ES 3.0's histogram: one of `step` rows, or rows of quads, has a row of bins, or one for each of `columns` parts. */
typedef struct gles_bins {
    uint32_t columns, step, groups;
} gles_bins;

typedef struct gles_object {
    uint64_t magic;
    gl_functions gl;
    pupil_gles_config config; /* its coding is NULL */
    pupil_coding coding;
    gles_variant variant;
    void *context; /* eglGetCurrentContext's, or NULL */
    GLint largest_side;
    uint32_t has_half_targets; /* R16F can be drawn into, with blending */

    /* settings, from the pupil_t */
    pupil_config settings;
    float luma[3], metered_luma[3]; /* of the picture; of what is metered */
    float to_picture[9];            /* as in pupil_object */
    uint32_t has_to_picture;
    float rods_to_picture[9];
    uint32_t has_rods;
    uint32_t rods_are_mixed[2]; /* into the uniforms of GLES_MAP and GLES_MAP_SCALED */
    pupil_cones cones;
    pupil_coder coder;
    float code_light; /* of stats */
    uint32_t histogram;
    pupil_tone curve;        /* ADAPT_GPU: its white and gamut; the scale is 1 */
    uint32_t unit;           /* rows of a mosaic's quad, or 1 */
    uint32_t cells_together; /* columns of the metering grid in one of regions */
    gles_bins bins;
    uint32_t region_rows;
    gles_region_row region_row[GLES_REGION_ROWS];

    /* objects of GL */
    gles_programs programs;
    GLuint vertex_array, sampler, light, encoder, veil;
    GLuint frame[2][GLES_PLANES]; /* MEMORY: two frames in turn, so that an upload need not wait for the one before */
    GLuint target[GLES_TARGET_COUNT], framebuffer[GLES_TARGET_COUNT]; /* ES 3.0 */
    GLuint state;                                                     /* ES 3.1, ADAPT_GPU: a buffer */
    gles_slot slot[GLES_RING];

    /* as frames come */
    GLuint source[GLES_PLANES]; /* textures at hand; 0: none yet */
    uint32_t turn;              /* of frame[] */
    uint32_t oldest, under_way;
    float direct; /* of the light, under a veil; below 0: none has come yet */
    uint64_t metered, unmetered;
    int64_t level_q24;
    uint32_t level_known;

    /* ADAPT_GPU: the clock and the exposure, as pupil_adapt keeps them */
    pupil_adaptation adaptation;
    uint32_t given;        /* the next frame is to take over adaptation.level, or that there is none */
    double exposure_log2;  /* of the frame at hand, metered or not */
    double weight_rest[2]; /* toward more light, toward less: rounding errors of earlier frames, 2^-32 */
    uint32_t newest_state;

    pupil_stats stats; /* that were fetched last */
} gles_object;

_Static_assert(sizeof(gles_object) <= sizeof(pupil_gles), "PUPIL_GLES_OBJECT_BYTES is too small");
_Static_assert(sizeof(gles_statistics) == 16 * (GLES_REGION_ROWS + 1) * GLES_REGION_COLUMNS + 32 + 8 * 768,
               "no padding");

#define GLES_MAGIC (UINT64_C(0x676c657300000000) + sizeof(gles_object))

static inline gles_object *gles_object_of(pupil_gles *gles)
{
    return (gles_object *)(void *)gles;
}

/* --- gles.c --- */

/* PUPIL_OK where the object is open and its context is current and not lost. */
int pupil_gles_check(const pupil_gles *gles);
/* The factors of o->coding, for frames of o->config. */
void pupil_gles_coder_set(gles_object *o);
/* GL's error since the last one was read: PUPIL_OK or an error. */
int pupil_gles_error(const gles_object *o);
/* Puts sentences together, cut where the buffer ends; up to a NULL. */
void pupil_gles_say(pupil_why *why, const char *const parts[]);

/* --- gles_programs.c --- */

/* Compiles and links what the variant needs; after an error nothing is left. */
int pupil_gles_programs_make(const gles_object *o, const gles_variant *variant, gles_programs *programs,
                             pupil_why *why);
void pupil_gles_programs_delete(const gles_object *o, gles_programs *programs);
/* Uniforms that stay as they are from frame to frame, by the settings. */
void pupil_gles_programs_set(gles_object *o);
/* Those of them that depend on a mosaic's white balance. */
void pupil_gles_programs_balance(gles_object *o);
/* Makes a program current, with the state of GL that all of pupil_gles draws with. */
void pupil_gles_begin(const gles_object *o, uint32_t program);

/* --- gles_textures.c --- */

int pupil_gles_textures_make(gles_object *o, pupil_why *why);
void pupil_gles_textures_delete(gles_object *o);
/* The table of the transfer that the settings name. */
void pupil_gles_textures_set(const gles_object *o);
/* The nodes of the veil (pupil/veil.h). */
void pupil_gles_textures_veil(const gles_object *o, const float *nodes);
/* Texture and nearest sampler at a unit. */
void pupil_gles_bind(const gles_object *o, uint32_t unit, GLenum target, GLuint texture);
/* The frame and its tables, for a program that loads it; and none at all. */
void pupil_gles_bind_frame(const gles_object *o);
void pupil_gles_unbind(const gles_object *o);

/* A target of this size, which replaces the one before. */
int pupil_gles_target_make(gles_object *o, int target, GLenum internal, GLsizei width, GLsizei height, pupil_why *why);

/* --- gles_bins.c: the histogram of ES 3.0 --- */

/* Which rows, in how many parts. */
gles_bins pupil_gles_bins_plan(const gles_object *o, const pupil_config *settings);
/* Its targets, for o->bins. */
int pupil_gles_bins_make(gles_object *o, pupil_why *why);
/* Leaves GLES_COUNTS as the framebuffer to be read. Needs GLES_PARTS of the same frame. */
void pupil_gles_bins_meter(const gles_object *o);

/* --- gles_bins_scale.c --- */

/* Bins of some rows as those of all. */
void pupil_gles_bins_scale(pupil_stats *stats);

/* --- gles_regions.c --- */

uint32_t pupil_gles_regions_make(uint32_t units_y, gles_region_row rows[GLES_REGION_ROWS]);
/* Columns that may be metered as one: 4 where that makes no difference, or 1. */
uint32_t pupil_gles_regions_together(const gles_object *o);
/* Statistics of the whole frame from what came back. */
void pupil_gles_regions_add_up(const gles_object *o, const gles_statistics *from, pupil_stats *stats);

/* --- gles_meter.c --- */

void pupil_gles_meter_make(gles_object *o);
void pupil_gles_meter_delete(gles_object *o);
/* Forgets frames that are in progress. */
void pupil_gles_meter_drop(gles_object *o);
/* pupil_gles_collect into o->stats. `info` may be NULL. */
int pupil_gles_fetch(gles_object *o, uint64_t timeout_ns, pupil_frame_info *info);

/* --- gles_map.c --- */

/* The caller's target as one of this version, if it can be drawn to. */
int pupil_gles_target_read(const gles_object *o, pupil_gles_target *ours, const pupil_gles_target *theirs);

/* --- gles_adapt.c --- */

/* PUPIL_OK, or PUPIL_ERR_CONFIG and a sentence: the GPU cannot adapt by these settings. */
int pupil_gles_adapt_check(const pupil_config *settings, pupil_why *why);
/* The level of a pupil_t is that of the GPU from the next frame on. */
void pupil_gles_adapt_take(gles_object *o, const pupil_object *pupil);
/* Uniforms of GLES_ADAPT, which is current: those that stay, and those of a frame's step. */
void pupil_gles_adapt_set(const gles_object *o, GLuint program);
void pupil_gles_adapt_step(gles_object *o, const pupil_frame_info *info);
/* For map.vert: key, compensation and exposure in 2^-24. */
int32_t pupil_gles_adapt_scale_base(const gles_object *o);

#endif
