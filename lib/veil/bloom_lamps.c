/* Where a frame has lamps, the pixels above a bright pass's threshold: pixels that no lamp reaches are skipped. */
#include "bloom_private.h"

void pupil_bloom_find_lamps(bloom_frame *f, int32_t y, uint32_t *words)
{
    const pupil_image_const *in = f->rows.image;
    const int inside = y >= 0 && y < (int32_t)in->height, by_pixels = in->pixel == PUPIL_PIXEL_RGBA32F;
    const pupil_row row = pupil_veil_row_of(&f->rows, inside ? (uint32_t)y : 0);
    *words++ = 0;
    for (uint32_t x = 0; x < in->width; x += BLOOM_WORD) {
        const uint32_t n = in->width - x < BLOOM_WORD ? in->width - x : BLOOM_WORD;
        *words = 0;
        if (inside && by_pixels)
            *words = PUPIL_PIECE(f->kernels, bloom_lamps_rgba32f)(row.data + 16 * (size_t)x, n, f->threshold);
        else if (inside) {
            (void)PUPIL_PIECE(f->kernels, load[in->pixel])(&f->rows.coder, &row, x, n, &f->planes);
            *words = PUPIL_PIECE(f->kernels, bloom_lamps)(&f->planes, n, f->threshold);
        }
        words++;
    }
    *words = 0;
}
