/* apps/frame/any_scale.h: float light of any unit. Metering has a floor and a largest luminance, which suit light
 * around 1. Light far from 1 is multiplied by a power of two, which the frame's gain states. A frame that is only
 * sensor noise is scaled to below the floor, so noise stays dark.
 */
#ifndef PUPIL_APPS_FRAME_ANY_SCALE_H
#define PUPIL_APPS_FRAME_ANY_SCALE_H

#include <stddef.h>

#include "refuse.h"
#include "source.h"

typedef struct any_scale {
    int stops;              /* the last frame was multiplied by 2 to this power; 0: it was left alone */
    int known, noise_known; /* a frame with light has set unit_stops; a frame of noise, noise_stops */
    int unit_stops, noise_stops;
    unsigned long long noise_frames;
    float *memory;
    size_t bytes;
} any_scale;

/* Whether the frame has a unit: floats, unless they are decoded codes. */
int any_scale_concerns(const pupil_frame *frame);

/* A frame that has to be multiplied is copied to memory of its own; any other is left alone. -1 and a sentence. */
int any_scale_take(any_scale *a, pupil_frame *frame, pupil_why *why);

/* "; the light ...", for the user, if it is multiplied or noise. */
void any_scale_describe(const any_scale *a, char *text, size_t text_bytes);

/* The next frame sets the scale, and nothing is known of noise. */
void any_scale_forget(any_scale *a);

void any_scale_close(any_scale *a);

#endif
