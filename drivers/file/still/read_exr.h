/* drivers/file/still/read_exr.h: the interface of the OpenEXR reader's two halves: what to read (read_exr.c), and the
 * pixels (read_exr_pixels.c). */
#ifndef PUPIL_DRIVERS_FILE_STILL_READ_EXR_H
#define PUPIL_DRIVERS_FILE_STILL_READ_EXR_H

#include <openexr.h>

#include "pupil/error.h"
#include "still_private.h"

typedef enum exr_kind {
    EXR_KIND_RGB,         /* three channels: R, G, B */
    EXR_KIND_XYZ,         /* three: X, Y, Z, of CIE 1931 */
    EXR_KIND_LUMINANCE,   /* one: Y */
    EXR_KIND_LUMA_CHROMA, /* three: RY, Y, BY; chroma perhaps of half the size */
    EXR_KIND_COUNT
} exr_kind;

typedef struct exr_plan {
    exr_context_t file;
    int part;
    int is_tiled;
    exr_compression_t compression;
    exr_attr_box2i_t data, display;
    const exr_attr_chlist_t *channels;
    exr_kind kind;
    int channel[3];     /* places in `channels`, in the order of the output; -1: not used */
    int step_x, step_y; /* of the chroma channels, in pixels: 1 or 2 */
    pupil_still_colour colour;
    pupil_why *why; /* gets the library's first complaint, too */
    char library_says[200];
} exr_plan;

/* Decodes all chunks into the still. */
int pupil_exr_read_pixels(exr_plan *plan, pupil_still *still);

/* Writes a sentence of what went wrong and the library's message. Returns -1. */
int pupil_exr_fail(exr_plan *plan, const char *what);

#endif
