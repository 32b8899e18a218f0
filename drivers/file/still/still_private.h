/* drivers/file/still/still_private.h: what the still readers share. */
#ifndef PUPIL_DRIVERS_FILE_STILL_STILL_PRIVATE_H
#define PUPIL_DRIVERS_FILE_STILL_STILL_PRIVATE_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "still.h"

/* Writes a sentence and returns -1. What is not printable ASCII becomes '?': names inside a file must not reach a
 * terminal unfiltered. */
int pupil_still_fail(pupil_why *why, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* 0 where a picture of this size may be read, else -1 and the sentence. */
int pupil_still_size_ok(uint64_t width, uint64_t height, pupil_why *why);

/* CIE xy of red, green, blue and white: the order of all four formats. */
typedef struct pupil_chromaticities {
    double xy[8];
} pupil_chromaticities;

typedef struct pupil_still_colour {
    double luminance[3]; /* Y of red, green and blue; sum 1 */
    float to_709[9];     /* row by row */
    int convert;         /* 0: the pixels are Rec.709/D65 as they are */
} pupil_still_colour;

/* The colour of pixels with these chromaticities; NULL, or chromaticities that are not sane, count as Rec.709/D65. */
void pupil_still_colour_from(const pupil_chromaticities *given, pupil_still_colour *colour);

/* The colour of CIE XYZ pixels whose white is D65 at Y = 1. */
void pupil_still_colour_from_xyz(pupil_still_colour *colour);

/* The colour of primaries that are the columns of a matrix to XYZ under D50, as in profiles. 0: they do not add up to
 * white. */
int pupil_still_colour_from_icc(const double to_xyz[9], pupil_still_colour *colour);

/* From the primaries of one colour to those of another. */
void pupil_still_colour_between(const pupil_still_colour *from, const pupil_still_colour *to,
                                pupil_still_colour *between);

/* Converts RGB float pixels in place, where needed. */
void pupil_still_colour_apply(const pupil_still_colour *colour, float *rgb, uint64_t pixels);

#endif
