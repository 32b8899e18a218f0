/* lib/veil/scatter.h: mapping of rows with the light that is scattered to them: some blocks, down the rows, so that
 * their veil is computed once for all rows between two rows of nodes. */
#ifndef PUPIL_VEIL_SCATTER_H
#define PUPIL_VEIL_SCATTER_H

#include "bloom_private.h"
#include "veil_private.h"

enum { SCATTER_BLOCKS = 2 }; /* side by side: short pieces of rows are slow to read */

/* The caller's scratch. */
typedef struct scatter_block {
    pupil_planes planes;
    pupil_scattered veil[SCATTER_BLOCKS];
    uint8_t codes[2][4 * PUPIL_BLOCK]; /* of a pair of rows, for NV12 and I420 */
    pupil_picture_job job;
    pupil_chroma_coder chroma;
    veil_rows rows;
} scatter_block;

typedef struct scatter_map {
    const veil_object *veil;   /* NULL: none */
    const bloom_object *bloom; /* NULL: none */
    bloom_window *window;      /* of bloom; its frame is set */
    const pupil_image *out;    /* as many rows as `in` */
    uint32_t first_row;        /* of the frame */
    scatter_block *block;
} scatter_map;

void pupil_scatter_map(const scatter_map *map, const pupil_object *pupil, const pupil_tone *curve,
                       const pupil_image_const *in);

#endif
