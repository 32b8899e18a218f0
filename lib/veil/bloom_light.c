/* A frame's light by blocks, and rows between two octaves. */
#include "bloom_private.h"

#include "base/numeric.h"

/* The part of n pixels from x on that the frame has. */
typedef struct bloom_piece {
    uint32_t first, pixels, before; /* its first pixel, how many, and how many of the n are left of the frame */
} bloom_piece;

static bloom_piece piece_of(uint32_t width, int32_t x, uint32_t n)
{
    const int32_t end = x + (int32_t)n < (int32_t)width ? x + (int32_t)n : (int32_t)width, first = x > 0 ? x : 0;
    return first < end ? (bloom_piece){(uint32_t)first, (uint32_t)(end - first), (uint32_t)(first - x)}
                       : (bloom_piece){0};
}

int pupil_bloom_light(bloom_frame *f, int32_t y, int32_t x, uint32_t n, bloom_line line)
{
    const pupil_image_const *in = f->rows.image;
    const bloom_piece p = y < 0 || y >= (int32_t)in->height ? (bloom_piece){0} : piece_of(in->width, x, n);
    for (int channel = 0; channel < 3 && p.pixels < n; channel++) {
        const uint32_t after = p.before + p.pixels;
        __builtin_memset(line[channel], 0, p.before * sizeof(float));
        __builtin_memset(line[channel] + after, 0, (BLOOM_LINE - after) * sizeof(float));
    }
    if (!p.pixels)
        return 0;
    const pupil_row row = pupil_veil_row_of(&f->rows, (uint32_t)y);
    float *const to[3] = {line[0] + p.before, line[1] + p.before, line[2] + p.before};
    if (f->threshold > 0.0f || in->pixel != PUPIL_PIXEL_RGBA32F || !f->kernels->bloom_light_rgba32f) {
        (void)PUPIL_PIECE(f->kernels, load[in->pixel])(&f->rows.coder, &row, p.first, p.pixels, &f->planes);
        PUPIL_PIECE(f->kernels, bloom_bright)(&f->planes, p.pixels, f->threshold, to);
        return 0;
    }
    const ptrdiff_t next_row = y + f->ahead < (int32_t)in->height ? f->ahead * in->stride_bytes : 0;
    return f->kernels->bloom_light_rgba32f(row.data + 16 * (size_t)p.first, next_row, p.pixels, to);
}

void pupil_bloom_find_four(const bloom_object *o, uint32_t octave, int32_t y, int32_t x, bloom_four *four)
{
    const bloom_octave *at = &o->octave[octave];
    const int32_t middle = (y + 2 * BLOOM_STEP) / 2 - BLOOM_STEP; /* y / 2, rounded down */
    const int32_t first = middle - (y & 1 ? 1 : 2);
    four->y = y;
    for (int32_t i = 0; i < 4; i++) {
        const size_t row = pupil_bloom_row(o, octave, at->blurred, 0, first + i);
        four->row[i] = o->memory + row + (BLOOM_LEFT - PUPIL_BLOOM_SIDE + x);
        four->next[i] = row == o->nothing ? 0 : (size_t)at->rows * at->stride;
    }
}

/* A row of the finer octave is 5/256, 84/256, 137/256 and 30/256 of four rows, or these in reverse. */
void pupil_bloom_take(const pupil_kernels *kernels, bloom_four *four, uint32_t n, pupil_bloom_room room, float *to,
                      int add)
{
    static const float even[4] = {0x5p-8f, 0x54p-8f, 0x89p-8f, 0x1ep-8f};
    static const float odd[4] = {0x1ep-8f, 0x89p-8f, 0x54p-8f, 0x5p-8f};
    PUPIL_PIECE(kernels, bloom_widen)(four->row, four->y & 1 ? odd : even, n, room, to, add);
    for (int i = 0; i < 4; i++)
        four->row[i] += four->next[i];
}
