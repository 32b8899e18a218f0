/* A frame's light by blocks, and rows between two octaves. */
#include "bloom_private.h"

void pupil_bloom_light(bloom_frame *f, int32_t y, int32_t x, bloom_line line)
{
    const pupil_image_const *in = f->rows.image;
    const int32_t width = (int32_t)in->width;
    __builtin_memset(line, 0, sizeof(bloom_line));
    if (y < 0 || y >= (int32_t)in->height)
        return;
    const pupil_row row = pupil_veil_row_of(&f->rows, (uint32_t)y);
    const int32_t end = x + BLOOM_LINE < width ? x + BLOOM_LINE : width;
    for (int32_t at = x > 0 ? x : 0, n; at < end; at += n) {
        n = end - at < PUPIL_BLOCK ? end - at : PUPIL_BLOCK;
        (void)PUPIL_PIECE(f->kernels, load[in->pixel])(&f->rows.coder, &row, (uint32_t)at, (uint32_t)n, &f->planes);
        float *const to[3] = {line[0] + (at - x), line[1] + (at - x), line[2] + (at - x)};
        PUPIL_PIECE(f->kernels, bloom_bright)(&f->planes, (uint32_t)n, f->threshold, to);
    }
}

/* A row of the finer octave is 5/16, 10/16 and 1/16 of three, or those from the other side. */
void pupil_bloom_between(const bloom_object *o, const pupil_kernels *kernels, uint32_t octave, int channel, int32_t y,
                         uint32_t from, uint32_t n, float *to)
{
    static const float even[3] = {0x5p-5f, 0xap-5f, 0x1p-5f}, odd[3] = {0x1p-5f, 0xap-5f, 0x5p-5f};
    const int32_t middle = (y + 2 * BLOOM_STEP) / 2 - BLOOM_STEP; /* y / 2, downwards */
    const float *row[3];
    for (int i = 0; i < 3; i++)
        row[i] = o->memory + pupil_bloom_row(o, octave, o->octave[octave].blurred, channel, middle - 1 + i) + from;
    PUPIL_PIECE(kernels, bloom_pairs)(row, row, y & 1 ? odd : even, 3, n, to, 0);
}
