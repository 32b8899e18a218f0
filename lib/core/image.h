/* lib/core/image.h: a caller's image, copied and checked once, where a call enters the library. */
#ifndef PUPIL_CORE_IMAGE_H
#define PUPIL_CORE_IMAGE_H

#include "pupil/image.h"

/* Whether an image can be read (or, out, written): size, pixel, planes, strides, alignment, coding. */
int pupil_image_check(const pupil_image_const *image, int out);

/* An image of this version, with its coding. */
typedef struct pupil_input {
    pupil_image_const image; /* its coding: NULL, or the one below */
    pupil_coding coding;
} pupil_input;

typedef struct pupil_output {
    pupil_image image;
    pupil_coding coding;
} pupil_output;

/* Copies the caller's image and its coding, and checks both. PUPIL_OK or an error. */
int pupil_input_read(pupil_input *ours, const pupil_image_const *theirs);
int pupil_output_read(pupil_output *ours, const pupil_image *theirs);

#endif
