/* apps/frame/frame_veil.h: the veil of each frame (pupil/veil.h), of any size, gathered by several workers.
 *
 * Threads: gather and map by the workers, each with its number; the others by one thread, between these.
 */
#ifndef PUPIL_APPS_FRAME_FRAME_VEIL_H
#define PUPIL_APPS_FRAME_FRAME_VEIL_H

#include "pupil/veil.h"
#include "source.h"

typedef struct frame_veil frame_veil;

/* A configuration that pupil_veil_config_check accepts; its width and height are ignored. Unless `bloom_above` is NULL
 * the narrow lobes are bloom (pupil/bloom.h) of light above it. NULL: not enough memory. */
frame_veil *frame_veil_open(const pupil_veil_config *config, const double *bloom_above, unsigned workers);
void frame_veil_close(frame_veil *v); /* NULL is allowed */

/* A new frame: makes the veil for its size, and forgets the light of the last frame. -1 and a sentence: the frame
 * cannot have a veil. */
int frame_veil_begin(frame_veil *v, const pupil_frame *frame, pupil_why *why);

/* The worker's rows of the frame, metered into stats (NULL: only gathered). PUPIL_OK or an error. */
int frame_veil_gather(frame_veil *v, unsigned worker, const pupil_t *pupil, const pupil_image_const *frame,
                      uint32_t first_row, uint32_t rows, pupil_stats *stats);

/* All workers' light becomes the veil. PUPIL_OK or an error. */
int frame_veil_solve(frame_veil *v, const pupil_t *pupil);
const pupil_veil *frame_veil_of(const frame_veil *v);

/* The worker's rows, from curve->first_row of the frame on, as pupil_bloom_map_rows. */
int frame_veil_map(frame_veil *v, unsigned worker, const pupil_t *pupil, const pupil_curve *curve,
                   const pupil_image_const *frame, const pupil_image *out);

#endif
