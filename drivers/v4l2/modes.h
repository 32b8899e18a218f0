/* drivers/v4l2/modes.h: what a camera offers: formats, their sizes, their rates. */
#ifndef PUPIL_DRIVERS_V4L2_MODES_H
#define PUPIL_DRIVERS_V4L2_MODES_H

#include "device.h"
#include "pupil/error.h"

#define PUPIL_V4L2_MOST_RATES 16

/* One size, or, where the steps are not 0, all sizes from the first to the largest by steps. */
typedef struct pupil_v4l2_size {
    uint32_t width, height, max_width, max_height, step_width, step_height;
    double fps[PUPIL_V4L2_MOST_RATES]; /* rising; unknown: none */
    uint32_t rates;
    int fps_between; /* fps[0] and fps[1] are the ends of a range */
} pupil_v4l2_size;

typedef struct pupil_v4l2_mode {
    uint32_t fourcc;
    int read; /* natively, or as a JPEG */
    int compressed;
    char description[32];
    pupil_v4l2_size *size; /* NULL: the driver does not report them (sensors behind a media graph) */
    uint32_t sizes;
} pupil_v4l2_mode;

typedef struct pupil_v4l2_modes {
    pupil_v4l2_mode *mode;
    uint32_t count;
} pupil_v4l2_modes;

/* 0, or -1 and a sentence. Free what it filled in, after a failure too. */
int pupil_v4l2_modes_read(const pupil_v4l2_device *device, pupil_v4l2_modes *modes, pupil_why *why);
void pupil_v4l2_modes_free(pupil_v4l2_modes *modes);

/* "640x480@30,15 1280x720@30": the sizes of a mode in one line; cut where it does not fit. */
void pupil_v4l2_mode_text(const pupil_v4l2_mode *mode, char *text, size_t text_bytes);

#endif
