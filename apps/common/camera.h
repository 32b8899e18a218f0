/* apps/common/camera.h: the camera of a command: which one, and its controls put back in any case. */
#ifndef PUPIL_APPS_COMMON_CAMERA_H
#define PUPIL_APPS_COMMON_CAMERA_H

#include "live/live.h"

/* The camera that is asked for, or (NULL) the first that is there. 0, or -1 and a sentence. */
int camera_choose(const pupil_live_system *system, const char *asked, char *device, size_t device_bytes,
                  pupil_why *why);

/* Where the program dies of a fault of its own, the controls of this live source are put back first. NULL: no longer.
 */
void camera_guard(const pupil_source *source);

/* After the source was closed: waits for a write of a control that hangs. -1: it still does, and the camera keeps what
 * it was set to. */
int camera_await_last_write(void);

#endif
