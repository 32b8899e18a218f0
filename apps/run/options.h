/* apps/run/options.h: the command line of `pupil run`. */
#ifndef PUPIL_APPS_RUN_OPTIONS_H
#define PUPIL_APPS_RUN_OPTIONS_H

#include "colour/white_balance.h"
#include "live/live.h"
#include "options/frame_options.h"

typedef enum run_mode {
    RUN_DIGITAL = 0, /* only the picture adapts; no control is touched, unless it is set manually */
    RUN_SENSOR,      /* the camera's exposure and gain are controlled; the picture is the camera's own */
    RUN_BOTH,        /* controlled, and the picture adapts */
    RUN_BEST         /* RUN_BOTH, or RUN_DIGITAL where the camera has no controls */
} run_mode;

/* Whether the camera's values are linear in light. */
typedef enum run_curve {
    RUN_CURVE_AUTO = 0, /* as pupil_live_is_linear has it */
    RUN_CURVE_LINEAR,
    RUN_CURVE_UNKNOWN
} run_curve;

#define RUN_MOST_CAMERAS 8

typedef struct run_options {
    frame_options shown; /* as for a replay; the camera is the only input */
    const char *device;  /* NULL: the first camera */
    const char *device_name[RUN_MOST_CAMERAS];
    uint32_t devices;                       /* number of named devices; several share their exposure */
    double camera_ev[RUN_MOST_CAMERAS - 1]; /* by how many stops those after the first are more sensitive */
    uint32_t camera_evs;                    /* how many of these were given */
    pupil_live_options live;
    pupil_colour_options colour; /* of raw frames */
    uint32_t mode, curve;
    double exposure_s, gain;         /* manual; 0: not */
    double exposure_max_s, gain_max; /* the most that is asked of the camera; 0: its own limit */
    const char *control;             /* a socket to change the run; NULL: none */
    double night_ev, day_ev;         /* of scene light */
    double day_night_s;              /* how long the light has to be beyond them; 0: not looked for */
    int locked;                      /* by `control`'s socket: exposure time and gain are held, too */
    const char *resume;              /* a file with the exposure to begin with; NULL: the usual one */
    int begins_cold;                 /* not with the exposure of the last run */
    double seconds;                  /* to run; 0: until it is stopped */
    int mains_off;                   /* live.mains_hz is 0 because there is no mains flicker; else 0 means that it is
                                      * found from the frames */
    int any_frame_rate;              /* in the dark the exposure may be longer than a frame */
    int row_gains;                   /* flicker bands in exposures below a period are corrected row by row */
    double readout_s;                /* from the first row to the last; 0: the driver's */
} run_options;

/* As options_parse, with the defaults set before; argv stays as it is. */
int run_options_parse(run_options *options, int argc, char **argv, pupil_why *why);

/* Rows that every command with a live camera has. Offsets are those of run_options. */
#define RUN_DEVICE_ROWS  1
#define RUN_REQUEST_ROWS 5
#define RUN_MANUAL_ROWS  2
#define RUN_END_ROWS     2
extern const option_row run_device_rows[RUN_DEVICE_ROWS];
extern const option_row run_request_rows[RUN_REQUEST_ROWS];
extern const option_row run_manual_rows[RUN_MANUAL_ROWS];
extern const option_row run_end_rows[RUN_END_ROWS];

#endif
