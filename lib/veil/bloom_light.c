/* A frame's light by blocks, and rows between two octaves. */
#include "bloom_private.h"

#include "base/numeric.h"

static int is_lit(bloom_line line, uint32_t n)
{
    uint32_t any = 0;
    for (int channel = 0; channel < 3; channel++)
        for (uint32_t i = 0; i < n; i++)
            any |= pupil_bits_of_float(line[channel][i]);
    return any != 0;
}

int pupil_bloom_light(bloom_frame *f, int32_t y, int32_t x, uint32_t n, bloom_line line)
{
    const pupil_image_const *in = f->rows.image;
    const int32_t width = (int32_t)in->width, end = x + (int32_t)n < width ? x + (int32_t)n : width;
    const int32_t first = x > 0 ? x : 0;
    const int outside = y < 0 || y >= (int32_t)in->height || first >= end;
    if (outside || first > x || end - x < (int32_t)n)
        __builtin_memset(line, 0, sizeof(bloom_line));
    if (outside)
        return 0;
    const pupil_row row = pupil_veil_row_of(&f->rows, (uint32_t)y);
    const uint32_t pixels = (uint32_t)(end - first);
    float *const to[3] = {line[0] + (first - x), line[1] + (first - x), line[2] + (first - x)};
    (void)PUPIL_PIECE(f->kernels, load[in->pixel])(&f->rows.coder, &row, (uint32_t)first, pixels, &f->planes);
    PUPIL_PIECE(f->kernels, bloom_bright)(&f->planes, pixels, f->threshold, to);
    return !(f->threshold > 0.0f) || is_lit(line, n);
}

/* A row of the finer octave is 5/16, 10/16 and 1/16 of three, or those from the other side. */
void pupil_bloom_between(const bloom_object *o, const pupil_kernels *kernels, uint32_t octave, int channel, int32_t y,
                         uint32_t from, uint32_t n, float *to)
{
    static const float even[3] = {0x5p-4f, 0xap-4f, 0x1p-4f}, odd[3] = {0x1p-4f, 0xap-4f, 0x5p-4f};
    const int32_t middle = (y + 2 * BLOOM_STEP) / 2 - BLOOM_STEP; /* y / 2, downwards */
    const float *row[3];
    for (int i = 0; i < 3; i++)
        row[i] = o->memory + pupil_bloom_row(o, octave, o->octave[octave].blurred, channel, middle - 1 + i) + from;
    PUPIL_PIECE(kernels, bloom_up)(row, y & 1 ? odd : even, n, to);
}
