/* drivers/live/live_private.h: what the files of this folder share. */
#ifndef PUPIL_DRIVERS_LIVE_LIVE_PRIVATE_H
#define PUPIL_DRIVERS_LIVE_LIVE_PRIVATE_H

#include "file/video/jpeg_frame.h"
#include "live.h"

/* The camera whose controls are to be opened. */
typedef struct live_which {
    const pupil_v4l2_system *system;
    char path[256];         /* of the video node */
    uint32_t width, height; /* of its frames: the sensor's size, where its subdevice does not report it */
    uint32_t mains_hz, delay;
} live_which;

/* A camera's controls on files of their own, which pupil_camera_close closes, too. NULL: there are none, and why. */
pupil_camera *live_controls_open(const live_which *which, pupil_why *why);

/* Changing from the controls of a camera that is gone to those of the one that came back. Both can take seconds, so a
 * thread does it while frames come. */
typedef struct live_change live_change;

/* Takes `old`, which may be NULL. NULL: no memory, and `old` is closed. */
live_change *live_change_start(pupil_camera *old, const live_which *which);
/* 1: done and freed, with the new controls or (NULL) why there are none; 0: not yet. */
int live_change_done(live_change **change, pupil_camera **camera, pupil_why *why);
/* Waits for the thread, two seconds at most, and closes what it has opened; else the thread does so later. NULL is
 * allowed. */
void live_change_end(live_change *change);

typedef struct live_source {
    pupil_live live;
    pupil_live_options options;
    char which[256], name[32], bus[32]; /* of the camera that was opened first */

    pupil_v4l2_capture capture;
    pupil_v4l2_frame frame; /* that is out */
    int is_out;
    pupil_jpeg *jpeg;                 /* of compressed frames: their decoder ... */
    uint32_t jpeg_width, jpeg_height; /* ... and the size that it is for */
    int began, reopened;              /* a frame was out; none since the camera was opened again */
    uint64_t sequence;                /* of the last frame */
    uint32_t driver_sequence;         /* the driver's number of it */
    int64_t first_ns;
    double period_ns; /* between the last two frames, by number and stamp; 0: no frame came so far */
    int64_t stamp_ns; /* of the last frame */
    char label[320];

    uint64_t described; /* counts.reopened when live.stream was filled in */
    live_which controls_of;
    live_change *change;        /* NULL: the controls are those of the camera that streams */
    uint64_t controls_reopened; /* counts.reopened when the controls were opened */
    int told;                   /* the camera knows that the stream has started */
} live_source;

/* Opens the camera again, waiting for it until end_ns; `tries` attempts have failed already. PUPIL_SOURCE_FRAME: it
 * runs; PUPIL_SOURCE_END: options.stop; PUPIL_SOURCE_FAILED: it did not come. */
int live_reopen(live_source *s, int64_t end_ns, int tries, pupil_why *why);
/* After a frame: opens the controls of a camera that was opened again. Frames do not wait for them. */
void live_follow_controls(live_source *s);
/* Which node the controls are to be opened on: that of the capture. */
void live_name_controls(live_source *s);

static inline int64_t live_now_ns(const live_source *s)
{
    return s->capture.device.system->now_ns(s->capture.device.system->context);
}

#endif
