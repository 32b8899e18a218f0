/* apps/probe/probe.h: pupil probe: what a camera is, and what it really does. */
#ifndef PUPIL_APPS_PROBE_PROBE_H
#define PUPIL_APPS_PROBE_PROBE_H

#include <stdio.h>

#include "live/live.h"
#include "pupil/error.h"

#define PROBE_POINTS 8
#define PROBE_WORDS  192

/* A measured quantity: known, or why it is not. */
typedef struct probe_known {
    int known;
    pupil_why why;
} probe_known;

/* From the frame that is exposed while a control is written to the first that shows it. */
typedef struct probe_delay {
    probe_known is;
    unsigned frames, least, most; /* the usual delay of all steps, the smallest, the largest */
    unsigned steps;
} probe_delay;

typedef struct probe_point {
    double exposure_s, gain; /* as set by the driver */
    int64_t code;            /* of gain */
    double level_ev;         /* of the picture */
    double off_ev;           /* distance to the level expected from the first point */
} probe_point;

/* Whether the picture's level follows a control. */
typedef struct probe_law {
    probe_known is;
    int obeyed;      /* 0: the driver reports the value, but the picture does not change */
    double slope;    /* stops of the picture for a stop of the control */
    double off_ev;   /* the largest of the points', in magnitude */
    double drift_ev; /* the largest change of the picture at a constant setting, within a point or at a repeated one: it
                      * is the scene's, not the control's */
    int as_told;     /* off_ev is small, except for the drift */
    probe_point point[PROBE_POINTS];
    unsigned points;
} probe_law;

typedef struct probe_black {
    probe_known is;
    double share;      /* of full scale, raw: without the black level of the driver or a table */
    double exposure_s; /* the shortest, at which it was measured */
    int at_most;       /* only an upper bound: the scene is too bright */
} probe_black;

typedef struct probe_interval {
    probe_known is;
    double mean_s, jitter_s, least_s, most_s; /* jitter: standard deviation */
    uint64_t frames, lost, damaged;
} probe_interval;

typedef struct probe_latency {
    probe_known is;
    double median_s, most_s;
    uint32_t stamp; /* a pupil_live_stamp */
} probe_latency;

typedef struct probe_report {
    pupil_live_offers offers;
    pupil_live_stream stream; /* with which it was measured */
    double fps;

    probe_known has_controls; /* its `why`: the sentence of pupil_live_no_controls */
    pupil_camera_limits limits;

    double seconds; /* of the stream */
    probe_interval interval;
    probe_latency latency;
    probe_delay exposure_delay, gain_delay;
    probe_law exposure, gain;
    probe_black black;
} probe_report;

typedef struct probe_options {
    int quick;                                /* half the steps and points */
    double seconds;                           /* at most, of the stream */
    void (*say)(const char *now);             /* what is being measured */
    void (*source)(const pupil_source *live); /* called with the source while it is open; NULL: closed again */
    int (*stop)(void);
} probe_options;

/* Measures what only the stream shows: opens the camera, takes over its controls, and restores them. 0; 1: stopped; -1
 * and a sentence: no stream, or a control that could not be restored. The report says what cannot be measured. */
int probe_measure(probe_report *report, const pupil_live_system *system, const probe_options *options, pupil_why *why);

void probe_text(const probe_report *report, FILE *out);
/* To be freed; NULL: out of memory. */
char *probe_json(const probe_report *report);

/* Names, of numbers and of the table's laws. */
const char *probe_stamp(uint32_t stamp);
void probe_law_text(const pupil_camera_gain *law, char *text, size_t text_bytes);

/* The command on a system of cameras; NULL: the machine's. The program's exit status. */
int probe_on(const pupil_live_system *system, int argc, char **argv);

#endif
