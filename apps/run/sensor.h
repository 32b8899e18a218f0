/* apps/run/sensor.h: the camera's side of a run: what a frame's statistics ask of its exposure and gain. */
#ifndef PUPIL_APPS_RUN_SENSOR_H
#define PUPIL_APPS_RUN_SENSOR_H

#include "frame/pipeline.h"
#include "options.h"
#include "output/frame_log.h"
#include "pupil/camera_loop.h"
#include "pupil/error.h"
#include "several.h"

typedef struct run_sensor {
    const run_options *options;
    pupil_source *source;
    pupil_camera *camera; /* NULL: none (now) */
    const run_several *several;
    int follows;          /* another camera leads */
    double followed_s;    /* the total that was followed last; 0: none */
    double followed_set;  /* the leader's setting then */
    double digital;       /* of a camera that follows: what its setting in force leaves of the leader's total */
    double shown_share;   /* of a camera that leads: of the total that is wanted; 0: not seen yet */
    double first_total_s; /* to begin with; 0: with what the camera has */
    pupil_camera_loop loop;
} run_sensor;

/* Of a live source. Its mode is options->mode, which is no longer RUN_BEST. `several`: NULL: it is the only camera. */
void run_sensor_begin(run_sensor *s, const run_options *options, pupil_source *source, const run_several *several);

/* Before each frame: the camera's controls as they are now; new ones are taken into the loop, from the level that they
 * have, or first_total_s. -1 and a sentence: they cannot be steered. */
int run_sensor_take(run_sensor *s, pupil_why *why);

/* Before each frame is metered: with RUN_BOTH the limit of amplification is that of the camera's largest setting, so
 * that its steps remain hidden in a picture that it will be able to brighten. */
void run_sensor_limit(const run_sensor *s, const pupil_frame_info *info, frame_pipeline *p);

/* A frame's statistics, between metering and mapping: the setting follows, and is asked for where it has changed. With
 * RUN_SENSOR the curve becomes the one that shows the camera's own picture. */
void run_sensor_frame(run_sensor *s, const pupil_stats *stats, const pupil_frame_info *info, pupil_curve *curve);

/* Light that is known to change by `ev` stops within so many frames, by a pupil_sensor_change. 0, or -1 and a sentence:
 * nothing can follow it. */
int run_sensor_announce(run_sensor *s, double ev, uint32_t within_frames, uint32_t change, pupil_why *why);

/* Whether the exposure is where it remains in this light: converged, or at a limit of what the camera can. */
int run_sensor_is_at_rest(const pupil_sensor_setting *setting);

/* After a frame of a camera that follows: what the leader has for that moment. */
void run_sensor_follow(run_sensor *s, const pupil_frame_info *info, const run_led *led);

/* Of the camera that leads: the total that its frames are shown with, once its setting is in force. It is the one that
 * is wanted, but where the camera answers otherwise than its numbers say. */
double run_sensor_total_s(run_sensor *s, const pupil_frame_info *info);
/* What this frame is shown with: on its way the setting is steps behind the total. */
double run_sensor_shown_s(const run_sensor *s, const pupil_frame_info *info);

/* The curve of the last frame, where the picture is the camera's own: 1; 0: as the pupil_t has it. */
int run_sensor_curve(const run_sensor *s, pupil_curve *curve);

/* "; settings refused by the camera: 3 (Device or resource busy)", or nothing. */
void run_sensor_tell(const run_sensor *s, char *text, size_t text_bytes);

/* Into the record of the last frame. */
void run_sensor_describe(const run_sensor *s, const pupil_frame_info *info, frame_log_entry *record);

#endif
