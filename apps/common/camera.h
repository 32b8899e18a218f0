/* apps/common/camera.h: chooses the camera of a command, and restores its controls however the command ends. */
#ifndef PUPIL_APPS_COMMON_CAMERA_H
#define PUPIL_APPS_COMMON_CAMERA_H

#include "live/live.h"

/* The camera that is asked for, or (NULL) the first one found. 0, or -1 and a sentence. */
int camera_choose(const pupil_live_system *system, const char *asked, char *device, size_t device_bytes,
                  pupil_why *why);

/* If the program crashes, the controls of this live source are restored first. NULL: no longer. */
void camera_guard(const pupil_source *source);

/* After the source was closed: waits for a control write that hangs. -1: it still hangs, and the camera keeps its
 * settings. */
int camera_await_last_write(void);

#endif
