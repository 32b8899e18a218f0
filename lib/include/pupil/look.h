/* pupil/look.h: marks that are drawn into a mapped picture. Nothing here changes metering.
 *
 * Threads: plain functions of their arguments; rows can be worked in any groups on any threads.
 */
#ifndef PUPIL_LOOK_H
#define PUPIL_LOOK_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The largest possible magnitude: both derivatives are 4 * 255. */
#define PUPIL_EDGE_MOST 1442

/* Draws the edges of a picture in `colour` (focus peaking: sharp parts are marked), and copies the rest. A pixel is on
 * an edge where gx^2 + gy^2 >= threshold^2 in its red, green or blue, gx and gy being Sobel's derivatives in codes and
 * `threshold` 1..PUPIL_EDGE_MOST:
 * - gx: the column to the right of the pixel less that to the left, their three rows weighted by 1, 2, 1;
 * - gy: the row below less the row above, their three columns weighted by 1, 2, 1.
 *
 * A step of n codes across a straight edge has a magnitude of 4n. Beyond the picture's border its outermost pixels
 * repeat. (Sobel, Feldman: A 3x3 isotropic gradient operator for image processing, 1968.)
 *
 * `rows` are codes: RGB8, BGR8, RGBA8, RGBX8 or BGRX8. Groups of rows give the same pixels as the whole: the rows next
 * to them are read where rows_above and rows_below (image.h) are not 0, as pupil_image_rows sets them. `out` has the
 * same format and size, and does not overlap `rows`. The fourth byte is copied. `edges`, unless NULL, becomes the
 * number of pixels on edges: a measure of sharpness. Integers alone: the same bits everywhere.
 *
 * PUPIL_ERR_NULL, _PIXEL (rows), _PIXEL_OUT (out has another format), _SIZE, _STRIDE; PUPIL_ERR_VALUE: threshold. */
PUPIL_API int pupil_mark_edges(const pupil_image_const *rows, uint32_t threshold, const uint8_t colour[3],
                               const pupil_image *out, uint64_t *edges);

#ifdef __cplusplus
}
#endif

#endif
