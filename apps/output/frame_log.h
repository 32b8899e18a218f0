/* apps/output/frame_log.h: the record of each frame of a run, for --stats, --plot and --report; and the list of
 * them. */
#ifndef PUPIL_APPS_OUTPUT_FRAME_LOG_H
#define PUPIL_APPS_OUTPUT_FRAME_LOG_H

#include <stddef.h>
#include <stdint.h>

typedef struct frame_log_entry {
    uint64_t frame;                /* 0, 1, 2 ... of the replayed frames */
    const char *name;              /* the source's name of the frame */
    double time_s;                 /* the frame's timestamp */
    double dt_s;                   /* the step that adaptation took */
    double metered_ev;             /* log2 of the frame's (trimmed) log-average luminance */
    double adapted_ev;             /* log2 of the adapted level */
    double scale;                  /* X of the curve that mapped this frame */
    double white;                  /* W of that curve; 0: none */
    double p01_ev, p50_ev, p99_ev; /* quantiles of log2 luminance */
    double output_level;           /* log-average of the display frame's luminance, linear 0..1 */
    double key;                    /* the wanted scaled log-average, with the compensation */
    double black_share;            /* of the metered pixels, 0..1 */
    double clipped_share;
    double bad_share;
    double output_black_share; /* share of 8-bit samples at 0 */
    double output_white_share; /* share of 8-bit samples at 255 */
    double read_us;            /* microseconds spent on reading, on meter + adapt + map, on writing */
    double process_us;
    double write_us;
    double held_back_ev; /* stops by which the highlights make the picture darker */
    double aimed_level;  /* the wanted output_level: the frame's light as its curve shows it, once adapted */
    const char *state;   /* "adapting", "settled", "limited", "locked", "empty" */
    const char *reason;  /* of the state, or "" */

    /* of a live camera; NaN: unknown */
    int live;
    uint64_t sequence;            /* the driver's number */
    uint64_t lost, flagged, late; /* since the frame before: missing; damaged; left out for a newer one */
    double exposure_s, gain;      /* in force for this frame */
    double asked_exposure_s;      /* last asked of the camera */
    double asked_gain;
    uint64_t in_force_from; /* the first frame with the setting that the camera took last */
    double digital;         /* the factor for this frame's values that the sensor's setting leaves */
    double scene_ev;        /* log2 of the scene's light, as the sensor's controller sees it */
    double camera_key;      /* the wanted log-average of the camera's own frame */
    double latency_us;      /* from the driver's timestamp to the mapped frame */
    const char *sensor;     /* "searching", "converged", ...; "" without a controller */
    const char *sensor_reason;
    const char *day_night; /* "unknown", "day", "night"; "" unless it is looked for */
} frame_log_entry;

#define FRAME_LOG_BOUND 32000 /* entries of a bounded log; even, so that every second one can be dropped */

typedef struct frame_log {
    frame_log_entry *entry;
    size_t count, capacity;
    int is_bounded;
    uint64_t every, seen; /* one of `every` is kept */
} frame_log;

/* `bounded`, for a run that may never end: memory is allocated once, every second entry is dropped when it is full, and
 * names are left out. Otherwise all entries are kept, with their names. 0; -1: not enough memory. */
int frame_log_open(frame_log *log, int bounded);

/* A log that was not opened keeps nothing, and returns 0. -1: not enough memory. */
int frame_log_add(frame_log *log, const frame_log_entry *entry);
void frame_log_close(frame_log *log);

#endif
