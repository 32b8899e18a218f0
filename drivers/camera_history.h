/* drivers/camera_history.h: which values a camera of any kind had in force in which frame, if the frames do not report
 * it: what the driver took when, after how many frames that acts, and what frames show about this delay. */
#ifndef PUPIL_DRIVERS_CAMERA_HISTORY_H
#define PUPIL_DRIVERS_CAMERA_HISTORY_H

#include <stdint.h>

#include "pupil/camera_controls.h"

enum { CAMERA_HISTORY = 16, CAMERA_USUAL_DELAY = 3 };

/* The stream of frames. All zero: none has come. */
typedef struct camera_timeline {
    uint64_t under_way; /* sequence of the frame that is exposed now */
    uint32_t any_frame;
    uint64_t measured, measured_mask; /* the last frame that was asked about; bit k: the k-th before it was, too */
} camera_timeline;

/* What the driver took. */
typedef struct camera_entry {
    uint64_t under_way; /* the frame that was exposed then */
    uint32_t in_stream; /* 0: before the first frame, so it was in force with that one */
    double value;
} camera_entry;

typedef struct camera_history {
    camera_entry entry[CAMERA_HISTORY];
    uint32_t count;             /* of all entries that were ever written */
    uint32_t delay;             /* frames from the one in progress to the first that was taken with it */
    uint32_t learned;           /* what frames showed, from which `delay` was made; 0: it is assumed */
    uint64_t late, late_before; /* frames from the measured one to the one in progress, at the last write and at the one
                                 * before; 0: not known */
} camera_history;

/* As pupil_camera_frame says it. */
void pupil_camera_timeline_frame(camera_timeline *time, uint64_t sequence, int started);
/* A frame's settings were asked about. */
void pupil_camera_timeline_measured(camera_timeline *time, uint64_t sequence);

/* The driver has taken `value`, asked for after frame *after (NULL: not known). Also sets `v`. */
void pupil_camera_history_take(camera_history *h, const camera_timeline *time, pupil_camera_value *v, double value,
                               const uint64_t *after);
double pupil_camera_history_at(const camera_history *h, uint64_t sequence);
/* From which frame on the latest entry is in force. */
uint64_t pupil_camera_history_acts_from(const camera_history *h);
/* What frames show of the delays, as in pupil_camera_learn. 1: a delay has changed. */
int pupil_camera_history_learn(camera_history *exposures, camera_history *gains, const camera_timeline *time,
                               uint32_t exposure_delay, uint32_t gain_delay);

#endif
