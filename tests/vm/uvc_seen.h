/* tests/vm/uvc_seen.h: the camera of uvc_camera.h as seen by a test in the guest: its node, and the values in its
 * pictures. */
#ifndef PUPIL_TESTS_VM_UVC_SEEN_H
#define PUPIL_TESTS_VM_UVC_SEEN_H

#include <sys/types.h>

#include "pupil/pupil.h"
#include "vm/uvc_camera.h"

/* Waits until uvcvideo has a node for it: its path. 0, or -1: there is none after 20 seconds. */
int uvc_await(char path[32]);
/* Ends the camera's process, and waits until its node is gone. */
void uvc_unplug(pid_t process);

/* The settings that a picture of 320x240 says it was taken with. */
uvc_truth uvc_read_truth(const pupil_image_const *image);
/* log2 of such a picture's mean, as long as nothing is clipped. */
double uvc_level(const uvc_truth *truth);
/* Meters the picture below the row that has the truth. is_linear: its luma is linear, which YUYV cannot express. */
int uvc_meter(const pupil_t *pupil, const pupil_image_const *image, int is_linear, pupil_stats *stats);

#endif
