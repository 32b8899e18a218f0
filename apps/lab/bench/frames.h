/* apps/lab/bench/frames.h: frames for the kernels' benchmark: an easy one, as a camera delivers it, and a hard one,
 * with values that no camera should deliver. The same bytes in every run. */
#ifndef PUPIL_APPS_LAB_BENCH_FRAMES_H
#define PUPIL_APPS_LAB_BENCH_FRAMES_H

#include <stddef.h>

#include "pupil/pupil.h"

/* An aligned frame of a format, all its planes in one piece of memory, to be given to free() by its data; data NULL: no
 * memory. The format can have the size. */
pupil_image_const bench_frame(uint32_t pixel, uint32_t width, uint32_t height, int hard);

/* The easy frame under lamps of modulation 0.3, with two and a half periods from the first row to the last; turn: their
 * phase on the first row, 0..1. */
pupil_image_const bench_lamp_frame(uint32_t pixel, uint32_t width, uint32_t height, double turn);

/* Bytes of all planes of a frame without gaps. */
size_t bench_frame_bytes(uint32_t pixel, uint32_t width, uint32_t height);

/* Memory for such a frame, aligned and zero, to write to; data NULL: no memory. */
pupil_image bench_room(uint32_t pixel, uint32_t width, uint32_t height);

/* Input formats, ended by a NULL name. */
typedef struct bench_format {
    const char *name;
    uint32_t pixel;
} bench_format;
extern const bench_format bench_formats[];

/* Their names, for the table of options. */
#define BENCH_FORMAT_WORDS                                                                                             \
    "rgba32f|rgb32f|rgba16f|rgba16|rgb16|rgba8|rgb8|yuyv|nv12|grey8|grey10|grey12|grey16|bayer8|bayer10|bayer12|"      \
    "bayer14|bayer16|bayer10p|bayer12p|i420|nv21|nv16|uyvy|bgr8|bgrx8|rgbx8|grey10p|"                                  \
    "grey12p|bgr32f|rgb16f|p010|i420-10|rgb10a2|i444-16"

const char *bench_format_name(uint32_t pixel);
/* PUPIL_PIXEL_NONE: there is none of that name. */
uint32_t bench_format_named(const char *name);

#endif
