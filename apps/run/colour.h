/* apps/run/colour.h: the colour of a live run's raw frames, from the camera that is open now. */
#ifndef PUPIL_APPS_RUN_COLOUR_H
#define PUPIL_APPS_RUN_COLOUR_H

#include "colour/white_balance.h"
#include "pupil/error.h"
#include "source.h"

typedef struct run_colour {
    pupil_white_balance colour;
    int began;
    uint64_t reopened; /* at the begin */
    int own_picture;   /* the picture is to be the camera's own, so codes of Rec. 709's curve are read with the
                        * display's curve: as players show them, not some codes lighter or darker */
} run_colour;

/* Gives a frame of a live source its coding; begins again with the first frame of a reopened camera, which may be
 * another one. -1 and a sentence: the frame's format cannot have what was asked for. */
int run_colour_take(run_colour *c, const pupil_colour_options *options, const pupil_source *source, pupil_frame *frame,
                    pupil_why *why);

#endif
