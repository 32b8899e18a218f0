/* apps/replay/compare.h: --compare: the same frames by two settings, side by side in one picture, each with its label.
 */
#ifndef PUPIL_APPS_REPLAY_COMPARE_H
#define PUPIL_APPS_REPLAY_COMPARE_H

#include "frame/pipeline.h"
#include "options/frame_options.h"

typedef struct compare {
    frame_pipeline right; /* the left one is the run's own */
    pupil_image picture;  /* RGB8: both, and the caller's to read until the next frame */
    size_t bytes;
} compare;

/* Settings as replay_options_side has them, and the frames' primaries. 0; -1: not enough memory. Closing takes what a
 * failed opening left. */
int compare_open(compare *c, const frame_options *right, uint32_t primaries);

/* After `left` has mapped the frame: maps the right one, and makes the picture of both. -1 and a sentence. */
int compare_frame(compare *c, const frame_pipeline *left, const pupil_frame *frame, const char *const label[2],
                  pupil_why *why);

void compare_close(compare *c);

#endif
