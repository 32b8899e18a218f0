/* lib/core/object.h: what is inside a pupil_t. No pointers, so that memcpy saves and forks it. */
#ifndef PUPIL_CORE_OBJECT_H
#define PUPIL_CORE_OBJECT_H

#include "base/pixel.h"
#include "core/eye.h"
#include "flicker/temporal.h"
#include "kernels/kernels.h"

/* Our own mistakes stop here; a board may define its own way of stopping. */
#ifndef PUPIL_TRAP
#define PUPIL_TRAP() __builtin_trap()
#endif
#define PUPIL_ASSERT(condition) ((condition) ? (void)0 : (void)PUPIL_TRAP())

/* Levels in 2^-52 stops: the state of the log2 laws, whose recursion is exact at its end. A step is rounded away from
 * the old value, by up to a unit, so the state may lead the closed form by 1/w units: 4e-14 stops at w = 0.005. Every
 * level fits: 30 stops of luminance, 128 of exposure and gain, 1074 of calibration. */
typedef int64_t pupil_level_q52;
/* Sums of log2 in statistics have 40 fractional bits. */
#define PUPIL_Q40_ONE (INT64_C(1) << 40)
/* config.histogram_step is no larger. */
#define PUPIL_MOST_STEP 8

/* The curve as a table, in scene luminance. The roots are in 2^-31, so that they end on their targets. */
typedef struct pupil_knots {
    uint32_t seen;
    int32_t first_ev; /* log2 of the luminance of the first knot; whole stops */
    uint32_t root_q31[PUPIL_CURVE_KNOTS];
} pupil_knots;

typedef struct pupil_adaptation {
    uint32_t seen;           /* a valid frame has set the level */
    uint32_t stamped;        /* last_timestamp_ns is of a frame */
    pupil_level_q52 level;   /* log2 of the adapted scene luminance (laws in log2) */
    double linear;           /* formula 1: the adapted 1 / L; formula 2: the adapted L */
    uint32_t white_seen;     /* white is set: a frame has come since the white point follows */
    uint32_t exposure_known; /* exposure_log2 is of a frame */
    pupil_level_q52 white;   /* log2 of the adapted upper quantile */
    pupil_eye eye;           /* PUPIL_LAW_EYE */
    int64_t last_timestamp_ns;
    double exposure_log2; /* log2 of exposure_s * gain as last known */
    uint64_t turn;        /* frames taken, also those without light: it selects the rows of config.meter_rows */
    pupil_flicker flicker;
    pupil_exposure result;
    pupil_knots knots; /* only with config.curve */
} pupil_adaptation;

typedef struct pupil_in_progress {
    uint32_t active;
    uint32_t width, height;
    pupil_frame_info info;
} pupil_in_progress;

typedef struct pupil_object {
    uint64_t magic;
    pupil_config config;
    float luma[3];         /* weights of luminance, from config.primaries */
    float picture_luma[3]; /* the same of the picture, from config.output_primaries */
    float to_picture[9];   /* from the input's primaries to the picture's, row by row; only where has_to_picture */
    uint32_t has_to_picture;
    uint32_t has_rods;        /* the law is PUPIL_LAW_EYE */
    float rods_to_picture[9]; /* from the input's primaries to the rods' light in the picture's; only where has_rods */
    pupil_cones cones;        /* of the picture's primaries */
    uint32_t histogram;
    uint32_t level; /* a pupil_level */
    /* pupil_reset clears from here to the end */
    pupil_adaptation adaptation;
    pupil_in_progress progress;
    pupil_stats stats; /* of the last frame, or of the one in progress */
} pupil_object;

_Static_assert(sizeof(pupil_object) <= sizeof(pupil_t), "PUPIL_OBJECT_BYTES is too small");

/* "pupil" and the object's size: another version's object is refused. */
#define PUPIL_MAGIC (UINT64_C(0x707570696c000000) + sizeof(pupil_object))

static inline pupil_object *pupil_object_of(pupil_t *pupil)
{
    return (pupil_object *)(void *)pupil;
}

static inline const pupil_object *pupil_object_of_const(const pupil_t *pupil)
{
    return (const pupil_object *)(const void *)pupil;
}

/* PUPIL_OK, PUPIL_ERR_NULL or PUPIL_ERR_OBJECT. */
static inline int pupil_object_check(const pupil_t *pupil)
{
    if (!pupil)
        return PUPIL_ERR_NULL;
    return pupil_object_of_const(pupil)->magic == PUPIL_MAGIC ? PUPIL_OK : PUPIL_ERR_OBJECT;
}

/* The caller's configuration as one of this version: NULL, or a sentence. */
const char *pupil_config_read(pupil_config *ours, const pupil_config *theirs);

/* Fills in luma, picture_luma, to_picture, has_to_picture, rods_to_picture and has_rods from the configuration. */
void pupil_primaries_derive(pupil_object *object);
/* The matrix to the picture if rods have a share above 0. `to_picture` NULL: the primaries are the same. */
void pupil_mix_rods(const float *to_picture, const float rods_to_picture[9], float rods, float mixed[9]);

/* coding may be NULL; it has been checked. */
void pupil_coder_make(const pupil_coding *coding, uint32_t pixel, pupil_coder *coder);
/* For a mosaic that this job meters: fills in the coder's bounds of ordinary light. */
void pupil_coder_find_ordinary(pupil_coder *coder, const pupil_row_job *job);
void pupil_chroma_coder_make(const pupil_coding *coding, pupil_chroma_coder *coder);

/* Meters rows into stats (unless NULL) and maps them by curve to out (unless NULL); arguments already checked. */
void pupil_work_rows(const pupil_object *object, const pupil_image_const *in, uint32_t first_row, uint32_t frame_height,
                     pupil_stats *stats, const pupil_tone *curve, const pupil_image *out);

/* A job that maps blocks which are planes already (kernels.h: pupil_map_planes). `in` is the image that they were
 * loaded from; no mosaic. The job has pointers to itself, to object and to curve. */
typedef struct pupil_picture_job {
    pupil_row_job map, picture;
    pupil_coder coder;
    float mixed[9];
} pupil_picture_job;
void pupil_picture_job_make(const pupil_object *object, const pupil_image_const *in, const pupil_tone *curve,
                            uint32_t out_pixel, pupil_picture_job *job);

/* The metering grid: the first x whose pixel is in its column `cell` or right of it; its row that has y. */
uint32_t pupil_grid_first_in_cell(uint32_t cell, uint32_t width);
uint32_t pupil_grid_cell_of(uint32_t y, uint32_t height);
/* Light of a format's first code above black; 0: it has no codes. */
float pupil_code_light(const pupil_coder *coder, uint32_t pixel);
/* The value at which a channel counts as clipped. */
float pupil_clip_of(const pupil_config *config, uint32_t pixel, const pupil_coder *coder);
/* The weights of luminance for samples that are metered before a mosaic's matrix: they give the luminance after it. */
void pupil_metered_luma(const float luma[3], const pupil_coder *coder, float metered[3]);

/* PUPIL_OK, or PUPIL_ERR_STATS for statistics that no metering can have produced. The second checks only the sums, not
 * each bin and band: for rows that come one at a time. */
int pupil_stats_check(const pupil_stats *stats);
int pupil_stats_check_sums(const pupil_stats *stats);
/* Whether there are bins with a weight: rows of a frame may have none that is counted (config.histogram_step). */
int pupil_stats_are_counted(const pupil_stats *stats);
/* pupil_stats_quantile of several shares at once, of statistics that have been checked and are counted. */
void pupil_stats_quantiles(const pupil_stats *stats, const double *q, int count, double *log2_luminance);
/* The mean, over the weight between two shares, of the stops by which light is above `from_log2`, each at most `most`.
 * Here, too, statistics have been checked and are counted. */
double pupil_stats_excess(const pupil_stats *stats, double low, double high, double from_log2, double most);
/* pupil_stats_mean, without the black pixels of a frame of floats or halves: config.h, floor. At least 1/64 of a
 * frame's weight remains. So a lamp alone in black is white, and as the last light goes, the level does not jump. */
uint64_t pupil_least_light(uint64_t weight);
int pupil_stats_light_mean(const pupil_stats *stats, double floor_log2, double low, double high,
                           double *log2_luminance);
/* The share of a frame's weight that is at the share q of what remains, taken as an eighth if it is less; q itself
 * where nothing is left out. */
double pupil_stats_share_of_light(const pupil_stats *stats, double q);

/* log2 of the divisor from the frame's values to scene luminance; the last known one if info has none. */
double pupil_exposure_log2(const pupil_config *config, const pupil_adaptation *a, const pupil_frame_info *info);
/* The steps of pupil_adapt that do not depend on the light, for other code that adapts: the seconds since the frame
 * before (negative: the clock went back, and is set to this frame's), and the last known exposure. */
double pupil_adaptation_tick(const pupil_config *config, pupil_adaptation *a, const pupil_frame_info *info);
void pupil_adaptation_learn_exposure(pupil_adaptation *a, const pupil_frame_info *info);
/* The weight of a step toward the new frame. */
double pupil_weight_of_step(const pupil_config *config, double dt_s, int more_light);
/* The lowest level that config.amplification_ev allows for frames of such codes, log2 in frame units. */
double pupil_least_level_log2(const pupil_config *config, float code_light);
/* Stops as a level, to the nearest. */
pupil_level_q52 pupil_level_of(double stops);

/* log2 of X, the scale from scene luminance, at an adapted level. */
double pupil_scale_log2(const pupil_config *config, double adapted_ev);

/* The frame that the knots follow, all in scene luminance. */
typedef struct pupil_knots_frame {
    const pupil_stats *stats; /* with bins and a weight */
    double divisor_log2;      /* from the frame's values to scene luminance, flicker included */
    double target_ev, white_ev;
    double centre_ev; /* the level, around which the knots are kept */
    double weight;    /* of the step to this frame */
} pupil_knots_frame;
void pupil_knots_follow(const pupil_config *config, pupil_knots *knots, const pupil_knots_frame *frame);
/* knots, levels, knot_scale and knot[] of a curve for a frame with this divisor. */
void pupil_knots_get(const pupil_config *config, const pupil_knots *knots, double divisor_log2, pupil_curve *curve);

/* Carries the adapted level over from the old law to that of object->config. */
void pupil_adaptation_change_law(pupil_object *object, uint32_t old_law);

#endif
