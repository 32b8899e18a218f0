/* apps/run/options.h: the command line of `pupil run`. */
#ifndef PUPIL_APPS_RUN_OPTIONS_H
#define PUPIL_APPS_RUN_OPTIONS_H

#include "live/colour.h"
#include "live/live.h"
#include "options/values.h"
#include "pupil/error.h"

typedef enum run_mode {
    RUN_DIGITAL = 0, /* the picture is adapted to; no control is touched, unless by hand */
    RUN_SENSOR,      /* the camera's exposure and gain are steered; the picture is the camera's own */
    RUN_BOTH,        /* steered, and what is shown is adapted to on its own */
    RUN_BEST         /* RUN_BOTH, or RUN_DIGITAL where the camera has no controls */
} run_mode;

/* Whether the camera's values are proportional to light. */
typedef enum run_curve {
    RUN_CURVE_AUTO = 0, /* as pupil_live_is_linear has it */
    RUN_CURVE_LINEAR,
    RUN_CURVE_UNKNOWN
} run_curve;

typedef struct run_options {
    frame_options shown; /* what a replay has, too; its only input is the camera */
    const char *device;  /* NULL: the first camera */
    pupil_live_options live;
    pupil_colour_options colour; /* of raw frames */
    uint32_t mode, curve;
    double exposure_s, gain; /* by hand; 0: not */
    const char *resume;      /* a file with the total to begin with; NULL: with what the camera has */
    const char *key_at;      /* what the key is by the light of the scene; NULL: one key */
    double seconds;          /* to run; 0: until it is stopped */
    int mains_off;           /* live.mains_hz is 0 because there are none; else it is found from the frames */
    int any_frame_rate;      /* in the dark the exposure may be longer than a frame */
    int row_gains;           /* lamps' bands in exposures below a period are taken out row by row */
    double readout_s;        /* from the first row to the last; 0: as the driver tells */
} run_options;

/* As replay_options_parse; argv stays as it is. */
int run_options_parse(run_options *options, int argc, char **argv, pupil_why *why);

/* --- what options are given --- */

/* "10ms", "250us", "1/100", "2s", "1min"; a plain number is in units of `plain_s`. */
int run_value_time(const value_text *c, double plain_s, double low_s, double high_s, const char *right,
                   double *seconds);
int run_value_mode(const value_text *c, uint32_t *mode);
int run_value_key_at(const value_text *c, const char **key_at);
int run_value_curve(const value_text *c, uint32_t *curve);
int run_value_mains(const value_text *c, uint32_t *mains_hz, int *off);
int run_value_period(const value_text *c, uint32_t *mains_hz);
int run_value_side(const value_text *c, uint32_t *side);
int run_value_format(const value_text *c, uint32_t *fourcc);

extern const char run_help[];

#endif
