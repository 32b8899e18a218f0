/* apps/probe/stream.h: the stream that a probe measures: frames, their levels, and settings that are waited for. */
#ifndef PUPIL_APPS_PROBE_STREAM_H
#define PUPIL_APPS_PROBE_STREAM_H

#include "probe.h"
#include "pupil/error.h"
#include "pupil/pupil.h"

#define PROBE_TRIM     0.1 /* left out of a level at either end, so that clipped and black pixels do not move it */
#define PROBE_MOST_BAD 0.08
#define PROBE_STILL_EV                                                                                                 \
    0.1 /* how far a picture may move by itself for its laws to be measured: the rounding of 8-bit codes and           \
         * exposures in lines */
#define PROBE_LATENCIES 256

/* A frame's light, or several frames': logs of shares of full scale, linear. */
typedef struct probe_level {
    double mean_ev;        /* without the trimmed pixels */
    double high_ev;        /* of the brightest channel of most pixels */
    double low;            /* a tenth of the pixels is below: a share, no log; only if wants_low is set */
    double clipped, black; /* shares of the pixels */
    double spread_ev;      /* of several frames: from the darkest to the brightest */
} probe_level;

enum { PROBE_OVER_TIME = 1, PROBE_STOPPED = 2 }; /* why a stream ended; -1: it failed */

typedef struct probe_stream {
    probe_report *report;
    const probe_options *options;
    pupil_source *source;
    pupil_camera *camera;
    pupil_t pupil;
    pupil_coding coding; /* the format's, with black as it was measured, and the camera's own colours */
    double black;        /* a share of full scale, of linear samples; 0 before it is known */
    int wants_low;
    double period_s;  /* nominal */
    double longest_s; /* exposure that does not lower the frame rate */
    unsigned settle;  /* frames after which a setting is surely in force */
    int64_t end_ns;
    int state; /* 0: continues; PROBE_OVER_TIME, ... */
    pupil_why *why;

    probe_level level; /* of the last frame */
    uint64_t sequence;
    int64_t stamp_ns;
    int any, after_wait; /* a frame has come; something was waited for since */
    double sum_s, square_s;
    uint64_t intervals, frames;
    double latency_s[PROBE_LATENCIES];
    unsigned latencies;
} probe_stream;

/* The next frame, metered. 0; or the state. */
int probe_frame(probe_stream *s);
/* The mean of `count` frames. */
int probe_frames(probe_stream *s, unsigned count, probe_level *level);
/* Asks for a setting (0: unchanged) and waits until the driver has taken it. under_way: the frame that was exposed
 * then. 0; or the state. */
int probe_set(probe_stream *s, double exposure_s, double gain, uint64_t *under_way);
/* The same, until it is in force. */
int probe_settle(probe_stream *s, double exposure_s, double gain);
/* The setting that the driver reports. */
pupil_camera_setting probe_taken(const probe_stream *s);
/* The picture is neither clipped nor black. */
int probe_is_good(const probe_level *level);
/* Writes what the frames reported to the report. */
void probe_stream_tell(probe_stream *s);

/* How far the picture moves by itself, at a constant setting. */
int probe_restless(probe_stream *s, double exposure_s, double gain, double *moved_ev);
/* Says that something is unknown because it needs a picture at rest. */
void probe_moves(probe_known *is, double moved_ev);

/* The parts. Each writes to the report, also what it cannot measure. */
void probe_find_level(probe_stream *s, probe_known *found, double *exposure_s, double *gain);
/* moved_ev: how far the picture moved by itself, before. */
void probe_delays(probe_stream *s, double exposure_s, double gain, double moved_ev);
void probe_laws(probe_stream *s, double exposure_s, double gain, double moved_ev);
void probe_black_level(probe_stream *s);

__attribute__((format(printf, 2, 3))) void probe_unknown(probe_known *is, const char *format, ...);
/* 1: nothing more is measured, and `is` says why. */
int probe_gave_up(const probe_stream *s, probe_known *is);

#endif
