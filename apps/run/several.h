/* apps/run/several.h: several cameras with one exposure. Each has a process of its own, so that none can block or end
 * another; they share a page of memory. One camera leads: its loop decides by its own frames. The others follow with
 * the same exposure time x gain, each split for its own limits and steps.
 *
 * Statistics of several cameras are not merged, because a loop learns its camera from frame to frame: its delays, how
 * strongly it responds, where it saturates. Two cameras with different delays would look like one that responds twice.
 *
 * The first camera leads. If it is lost, the next one leads from the last wanted total, until the first is back. The
 * leader stays within the limits of all cameras.
 *
 * Threads: the one that takes the frames.
 */
#ifndef PUPIL_APPS_RUN_SEVERAL_H
#define PUPIL_APPS_RUN_SEVERAL_H

#include "options.h"
#include "pupil/pupil.h"
#include "pupil/sensor.h"

typedef struct run_several {
    struct run_shared *shared; /* NULL: one camera alone, and all calls do nothing */
    uint32_t index;            /* of this camera */
    double ev;                 /* stops by which it is more sensitive than the first */
    double seen_ev;            /* sum of the differences: how much more light it sees than the leader */
    uint64_t seen;             /* frames in seen_ev */
} run_several;

/* The leader's values for a frame, for another camera: the leader's sensitivity is divided out. */
typedef struct run_led {
    int64_t at_ns;   /* of its frame */
    double total_s;  /* wanted: exposure time x gain */
    double shown_s;  /* total with which its frame is shown */
    double set_s;    /* of the last asked setting: it changes with each step */
    double scene_ev; /* the scene's light as the leader sees it */
    pupil_t pupil;   /* the picture's adaptation */
} run_led;

/* With more than one --device: whether the outputs have a place for each camera. OPTIONS_RUN, or OPTIONS_USAGE. */
int run_several_check(const run_options *options, pupil_why *why);

/* Replaces the options of all cameras by the device and outputs of one. */
void run_several_paths(run_options *options, uint32_t index);

/* Starts a process for each camera. Returns -1 in each of them, with its own device and outputs in `options`; in the
 * first process, when all have ended, the exit status. */
int run_several_begin(run_several *s, run_options *options);

/* The first process got a signal to end. */
int run_several_is_over(const run_several *s);

/* Publishes this camera's range of exposure time x gain. */
void run_several_offer(run_several *s, double least_s, double most_s);

/* Restricts the leader's limits to those of all cameras. */
void run_several_limit(const run_several *s, pupil_sensor_config *config);

/* With each frame: whether this camera leads. `frame_s`: the time to its next one. */
int run_several_leads(run_several *s, double frame_s);

/* After the leader has metered a frame; `led` in its own sensitivity. */
void run_several_publish(run_several *s, const run_led *led);
/* For a frame of a camera that follows: the leader's values of that moment. If they are due, waits for them, at most as
 * long as a camera's queue holds frames (QUEUE_FRAMES). 0: nobody has led yet. */
int run_several_read(run_several *s, const pupil_frame_info *info, double frame_s, run_led *led);

/* A time on the clock that the processes share: the frame's timestamp if it is of that clock, else now. */
int64_t run_several_stamp(const pupil_frame_info *info);

/* "; sees 0.98 EV more light than the first camera ...", or nothing. */
void run_several_tell(const run_several *s, char *text, size_t text_bytes);

/* This camera takes no more frames. */
void run_several_end(run_several *s);

#endif
