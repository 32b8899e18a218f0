/* drivers/file/pan/panorama.h: an equirectangular panorama and the pictures a pinhole camera takes in it.
 *
 * The panorama's centre is yaw 0, pitch 0; yaw grows to the right, pitch upward. Its left and right edges meet at yaw
 * 180, its top row is around pitch 90.
 *
 * Filtering, all in linear light: texels are joined bilinearly, around the seam and across the poles. Each pixel is the
 * mean of n x n points spread over its whole area, with n such that two points are at most one texel apart. Toward the
 * poles, where texels crowd, rows are averaged beforehand over half the width that a texel has at the equator, so that
 * n need not grow without end. A constant panorama gives that constant, to the bit.
 *
 * Threads: a made panorama is only read; any number of threads may render from it.
 */
#ifndef PUPIL_DRIVERS_FILE_PAN_PANORAMA_H
#define PUPIL_DRIVERS_FILE_PAN_PANORAMA_H

#include "file/still/still.h"
#include "pupil/error.h"

typedef struct pupil_panorama {
    uint32_t width, height;
    size_t row_floats; /* from one row to the next */
    float *texels;     /* RGB, (width + 2) x (height + 2): one texel of the other side on each edge */
} pupil_panorama;

/* Degrees; fov is the whole horizontal field of view. */
typedef struct pupil_view {
    double yaw, pitch, fov;
} pupil_view;

/* Takes a still of 2:1 (within 1 %), RGB32F. 0, or -1 and a sentence without a file name. NaN and negative texels are
 * kept and affect only the pixels that contain them; infinite ones count as +-1e37, so that interpolating between two
 * does not give NaN. */
int pupil_panorama_make(pupil_panorama *panorama, const pupil_still *still, pupil_why *why);

void pupil_panorama_free(pupil_panorama *panorama);

/* RGB of one direction (not 0, of any length; x right, y up, z toward yaw 0, pitch 0). */
void pupil_panorama_sample(const pupil_panorama *panorama, const float direction[3], float rgb[3]);

/* A picture of width x height, packed RGB floats. */
void pupil_panorama_render(const pupil_panorama *panorama, pupil_view view, float *pixels, uint32_t width,
                           uint32_t height);

/* The directions around which a camera sees most and least light: the mean of log2 luminance within 25 degrees, of
 * directions not further than 60 degrees from the horizon. fov is left alone. */
void pupil_panorama_extremes(const pupil_panorama *panorama, pupil_view *brightest, pupil_view *darkest);

#endif
