/* apps/run/sensor.h: the camera's side of a run: frame statistics control its exposure and gain. */
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
    double digital;       /* of a camera that follows: the factor from its setting in force to the leader's total */
    double shown_share;   /* of a camera that leads: shown total over wanted total; 0: not seen yet */
    double first_total_s; /* total to begin with; 0: the camera's own */
    pupil_camera_loop loop;
} run_sensor;

/* For a live source. The mode is options->mode, which is no longer RUN_BEST. `several`: NULL: it is the only camera. */
void run_sensor_begin(run_sensor *s, const run_options *options, pupil_source *source, const run_several *several);

/* Before each frame: looks for the camera's controls. New ones are taken into the loop, starting from their level or
 * from first_total_s. -1 and a sentence: they cannot be controlled. */
int run_sensor_take(run_sensor *s, pupil_why *why);

/* Before each frame is metered: with RUN_BOTH the limit of amplification is set as for the camera's largest setting. So
 * the camera's steps stay hidden while it can still brighten the picture. */
void run_sensor_limit(const run_sensor *s, const pupil_frame_info *info, frame_pipeline *p);

/* Between metering and mapping: the setting follows the frame's statistics, and is asked for if it has changed. With
 * RUN_SENSOR `curve` becomes the one that shows the camera's own picture. */
void run_sensor_frame(run_sensor *s, const pupil_stats *stats, const pupil_frame_info *info, pupil_curve *curve);

/* Announces that the light will change by `ev` stops within so many frames, by a pupil_sensor_change. 0, or -1 and a
 * sentence: nothing can follow it. */
int run_sensor_announce(run_sensor *s, double ev, uint32_t within_frames, uint32_t change, pupil_why *why);

/* Whether the exposure stays as it is in this light: converged, or at a limit of the camera. */
int run_sensor_is_at_rest(const pupil_sensor_setting *setting);

/* After a frame of a camera that follows: takes over what the leader has for that moment. */
void run_sensor_follow(run_sensor *s, const pupil_frame_info *info, const run_led *led);

/* Of the camera that leads: the total with which its frames are shown once its setting is in force. It differs from the
 * wanted total if the camera does not respond as its numbers say. */
double run_sensor_total_s(run_sensor *s, const pupil_frame_info *info);
/* The total with which this frame is shown: while the setting moves, it is some steps behind the wanted total. */
double run_sensor_shown_s(const run_sensor *s, const pupil_frame_info *info);

/* 1: the picture is the camera's own, and `curve` is the last frame's; 0: the pupil_t has the curve. */
int run_sensor_curve(const run_sensor *s, pupil_curve *curve);

/* "; settings refused by the camera: 3 (Device or resource busy)", or nothing. */
void run_sensor_tell(const run_sensor *s, char *text, size_t text_bytes);

/* Fills in the record of the last frame. */
void run_sensor_describe(const run_sensor *s, const pupil_frame_info *info, frame_log_entry *record);

#endif
