/* lib/row_gain/row_gain_private.h: what is inside a pupil_row_gain. */
#ifndef PUPIL_ROW_GAIN_ROW_GAIN_PRIVATE_H
#define PUPIL_ROW_GAIN_ROW_GAIN_PRIVATE_H

#include "pupil/row_gain.h"

enum {
    PUPIL_ROW_GAIN_GROUPS = 8,   /* of columns */
    PUPIL_ROW_GAIN_SEGMENTS = 8, /* of bands: a tile is a group's part in one */
    PUPIL_ROW_GAIN_PARTS = PUPIL_ROW_GAIN_GROUPS + PUPIL_ROW_GAIN_SEGMENTS,
    PUPIL_ROW_GAIN_HARMONICS = 4,
    PUPIL_ROW_GAIN_TERMS = 2 * PUPIL_ROW_GAIN_HARMONICS /* cosine and sine of each */
};
#define PUPIL_ROW_GAIN_DARK  (-10.0) /* log2: darker light is not used */
#define PUPIL_ROW_GAIN_DRIFT 0.05    /* of drift: 0.5 Hz, more than mains wander, at 10 frames a second */
#define PUPIL_ROW_GAIN_PRIOR 10.0    /* 1 / (0.3 EV)^2: what coefficients are like before there are frames */

typedef struct pupil_row_gain_tile { /* normal equations of its own fundamental */
    double matrix[2][PUPIL_ROW_GAIN_TERMS], side[2];
    double bands; /* that were looked at, lately */
} pupil_row_gain_tile;

typedef struct pupil_row_gain_object {
    uint64_t magic;
    pupil_row_gain_config config;
    pupil_t meter;
    pupil_stats stats; /* of one group at a time */
    pupil_row_gain_result result;

    /* the frame before */
    uint32_t width, height;
    uint32_t stamped; /* timestamp_ns is of a frame, and what follows is filled in */
    uint32_t reserved;
    int64_t timestamp_ns;
    double exposure_s;                     /* 0: unknown */
    double left[PUPIL_ROW_GAIN_HARMONICS]; /* of each harmonic, as exposure and band average it */
    double turn;                           /* the light's phase in the first row, 0..1 */

    /* the wave: log2 of the light is the sum of coefficient times term, for exposures that are short */
    double coefficient[PUPIL_ROW_GAIN_TERMS];
    double matrix[PUPIL_ROW_GAIN_TERMS][PUPIL_ROW_GAIN_TERMS], side[PUPIL_ROW_GAIN_TERMS];
    double known_s; /* seconds of frames that it was learned from */
    double moving;  /* how much of the wave's power moves from frame to frame, 0..1 */
    double drift;   /* recent corrections of the phase, turns a frame; 0 where light_hz is right */
    double faded;   /* result.strength, before the last frame's own check */
    /* how much of the expected wave was found, 1 being all: in the groups and the segments of the last frame (wave^2;
     * wave times the rest), and lately */
    double heard, heard_lately; /* the least of them */
    double part_wave[PUPIL_ROW_GAIN_PARTS], part_rest[PUPIL_ROW_GAIN_PARTS], part_lately[PUPIL_ROW_GAIN_PARTS];
    pupil_row_gain_tile tile[PUPIL_ROW_GAIN_GROUPS][PUPIL_ROW_GAIN_SEGMENTS];

    double row_rest[PUPIL_BANDS], row_wave[PUPIL_BANDS]; /* of all groups: what is left times the wave; wave^2 */

    double place[PUPIL_BANDS]; /* where the rows that are metered are on average, 0..1 from top to bottom */
    /* terms (not averaged by an exposure) and light (log2) by band, and their means over the last frames */
    double term[PUPIL_BANDS][PUPIL_ROW_GAIN_TERMS], term_mean[PUPIL_BANDS][PUPIL_ROW_GAIN_TERMS];
    double light[PUPIL_ROW_GAIN_GROUPS][PUPIL_BANDS], light_mean[PUPIL_ROW_GAIN_GROUPS][PUPIL_BANDS];
} pupil_row_gain_object;

_Static_assert(sizeof(pupil_row_gain_object) <= sizeof(pupil_row_gain), "PUPIL_ROW_GAIN_OBJECT_BYTES is too small");

/* row_gain_wave.c */
/* What is left of the light's harmonic h when it is averaged over some seconds: sin(x) / x. */
double pupil_row_gain_averaged(double light_hz, int h, double seconds);
/* Fills in left for a frame of this exposure, and adjusts light_mean as if its frames had had it, too. */
void pupil_row_gain_expose(pupil_row_gain_object *o, double exposure_s);
/* term[][] of a frame whose first row has the phase o->turn. */
void pupil_row_gain_fill_terms(pupil_row_gain_object *o);
/* coefficient from matrix and side. */
void pupil_row_gain_solve(pupil_row_gain_object *o);

/* row_gain_judge.c: result, from what was learned; `heard`: part_wave and part_rest are of a new frame. */
void pupil_row_gain_judge(pupil_row_gain_object *o, int heard, double dt_s);

/* row_gain_fit.c */
/* Forgets every frame. */
void pupil_row_gain_forget(pupil_row_gain_object *o);
/* From light (filled in) to coefficient and result. */
void pupil_row_gain_learn(pupil_row_gain_object *o, const pupil_frame_info *info);

#endif
