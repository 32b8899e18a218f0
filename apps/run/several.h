/* apps/run/several.h: several cameras with one exposure. Each has a process of its own, so that none can hold up or end
 * another one; they share a page of memory. One camera leads: its loop decides, by its own frames. The others follow
 * with the same exposure time x gain, each split for its own limits and steps.
 *
 * One leads, and not their merged statistics, because a loop learns its camera from frame to frame: its delays, how
 * strongly it answers, where it is full. Two cameras with different delays would look like one that answers twice.
 *
 * The first camera leads. Where it is lost, the next one does, from the total that was wanted last; and the first one
 * again once it is back. The leader stays within what all can.
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
    uint32_t index;            /* of this one */
    double ev;                 /* it is so much more sensitive than the first */
    double seen_ev;            /* sum of the light by which it sees more than the leader */
    uint64_t seen;             /* frames in that */
} run_several;

/* What the leader has for a frame, for a camera: its own sensitivity is divided out. */
typedef struct run_led {
    int64_t at_ns;   /* of its frame */
    double total_s;  /* wanted: exposure time x gain */
    double shown_s;  /* what its frame is shown with */
    double set_s;    /* of the setting that was asked for: another one is another step */
    double scene_ev; /* the light that the leader sees */
    pupil_t pupil;   /* the picture's adaptation */
} run_led;

/* With more than one --device: whether the outputs have a place for each camera. OPTIONS_RUN, or OPTIONS_USAGE. */
int run_several_check(const run_options *options, pupil_why *why);

/* The device and the outputs of one of several cameras, in place of the options of all. */
void run_several_paths(run_options *options, uint32_t index);

/* A process for each camera. -1, in each of these: its options have its device and outputs. In the first process, when
 * all are over: the exit status. */
int run_several_begin(run_several *s, run_options *options);

/* The first process got a signal to end. */
int run_several_is_over(const run_several *s);

/* What this camera can: exposure time x gain. */
void run_several_offer(run_several *s, double least_s, double most_s);

/* Brings the leader's limits into what all can. */
void run_several_limit(const run_several *s, pupil_sensor_config *config);

/* With each frame: whether this camera leads. `frame_s`: the time to its next one. */
int run_several_leads(run_several *s, double frame_s);

/* Of the frame that the leader has just metered; `led` as that camera has it. */
void run_several_publish(run_several *s, const run_led *led);
/* For a frame of a camera that follows: the leader's of that moment. It is waited for if it is due, at most as long as
 * a camera's queue holds frames (QUEUE_FRAMES). 0: nobody has led yet. */
int run_several_read(run_several *s, const pupil_frame_info *info, double frame_s, run_led *led);

/* On the clock that the processes share: the frame's timestamp where it is of that clock, or now. */
int64_t run_several_stamp(const pupil_frame_info *info);

/* "; sees 0.98 EV more light than the first camera ...", or nothing. */
void run_several_tell(const run_several *s, char *text, size_t text_bytes);

/* This camera takes no more frames. */
void run_several_end(run_several *s);

#endif
