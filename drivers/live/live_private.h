/* drivers/live/live_private.h: what the files of this folder share. */
#ifndef PUPIL_DRIVERS_LIVE_LIVE_PRIVATE_H
#define PUPIL_DRIVERS_LIVE_LIVE_PRIVATE_H

#include "pupil/error.h"
#include "source.h"
#include "v4l2/controls/camera_controls.h"
#include "v4l2/system.h"

/* Whose controls. */
typedef struct live_which {
    const pupil_v4l2_system *system;
    char path[256];         /* of the video node */
    uint32_t width, height; /* of its frames: the sensor's, where its subdevice does not tell */
    uint32_t mains_hz, delay;
} live_which;

/* A camera's controls on files of their own, which pupil_camera_close closes, too. NULL: there are none, and why. */
pupil_camera *live_controls_open(const live_which *which, pupil_why *why);

/* Changing from the controls of a camera that is gone to those of the one that came back, which may both take seconds:
 * a thread does it, while frames come. */
typedef struct live_again live_again;

/* Takes `old`, which may be NULL. NULL: no memory, and `old` is closed. */
live_again *live_again_start(pupil_camera *old, const live_which *which);
/* 1: done and freed, with the new controls or (NULL) why there are none; 0: not yet. */
int live_again_ready(live_again **again, pupil_camera **camera, pupil_why *why);
/* Waits for two seconds at most and closes what it has opened; or it does so by itself, later. NULL is allowed. */
void live_again_end(live_again *again);

#endif
