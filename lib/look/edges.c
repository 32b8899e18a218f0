/* Edges of a mapped picture, by Sobel's operator on its codes. */
#include "pupil/look.h"

#include "base/pixel.h"
#include "core/image.h"
#include "core/read.h"

#define BLOCK 256 /* samples whose magnitudes are kept at a time */

/* The three rows around the one at hand. */
typedef struct around {
    const uint8_t *above, *here, *below;
} around;

/* Whether sample i of the row is on an edge, with those before and after it in its channel. */
static inline uint8_t is_edge(const around *r, size_t before, size_t i, size_t after, int32_t least)
{
    const int32_t x = (r->above[after] - r->above[before]) + 2 * (r->here[after] - r->here[before]) +
                      (r->below[after] - r->below[before]);
    const int32_t y =
        (r->below[before] - r->above[before]) + 2 * (r->below[i] - r->above[i]) + (r->below[after] - r->above[after]);
    return x * x + y * y >= least;
}

/* Samples i to end of a row of n; step: bytes of a pixel. Without a branch, so that it becomes vectors. */
static void find(const around *r, size_t i, size_t end, size_t n, size_t step, int32_t least, uint8_t *found)
{
    const size_t inner = i < step ? step : i, last = end > n - step ? n - step : end;
    size_t k = i;
    for (; k < end && k < step; k++)
        found[k - i] = is_edge(r, k, k, k + step < n ? k + step : k, least);
    for (k = inner; k < last; k++)
        found[k - i] = is_edge(r, k - step, k, k + step, least);
    for (k = last > inner ? last : inner; k < end; k++)
        found[k - i] = is_edge(r, k - step, k, k, least);
}

/* Not inlined, so that its block and the caller's images are not in one stack frame. */
static __attribute__((noinline)) uint64_t mark_row(const around *r, uint32_t width, size_t step, int32_t least,
                                                   const uint8_t colour[3], uint8_t *out)
{
    const size_t n = width * step, part = BLOCK / step * step;
    uint8_t found[BLOCK];
    uint64_t count = 0;
    for (size_t i = 0; i < n; i += part) {
        const size_t end = n - i < part ? n : i + part;
        find(r, i, end, n, step, least, found);
        for (size_t k = i; k < end; k += step) {
            const uint8_t *f = found + (k - i);
            const unsigned edge = f[0] | f[1] | f[2];
            for (size_t c = 0; c < 3; c++)
                out[k + c] = edge ? colour[c] : r->here[k + c];
            if (step == 4)
                out[k + 3] = r->here[k + 3];
            count += edge;
        }
    }
    return count;
}

static int is_codes(uint32_t pixel)
{
    return pixel == PUPIL_PIXEL_RGB8 || pixel == PUPIL_PIXEL_BGR8 || pixel == PUPIL_PIXEL_RGBA8 ||
           pixel == PUPIL_PIXEL_RGBX8 || pixel == PUPIL_PIXEL_BGRX8;
}

/* `out` as one of this version, if it can be written for these rows. */
static int read_out(const pupil_image_const *in, pupil_image *ours, const pupil_image *out)
{
    int error = pupil_image_out_read(ours, out);
    if (error)
        return error;
    if (!ours->data)
        return PUPIL_ERR_NULL;
    if (ours->pixel != in->pixel)
        return PUPIL_ERR_PIXEL_OUT;
    if (ours->width != in->width || ours->height != in->height)
        return PUPIL_ERR_SIZE;
    ours->coding = 0; /* the same format as the input, which has been checked; its coding is not read */
    const pupil_image_const as_const = pupil_image_as_const(*ours);
    return pupil_image_check(&as_const, 0);
}

int pupil_mark_edges(const pupil_image_const *rows, uint32_t threshold, const uint8_t colour[3], const pupil_image *out,
                     uint64_t *edges)
{
    pupil_input from;
    pupil_image to;
    if (!rows || !colour)
        return PUPIL_ERR_NULL;
    int error = pupil_input_read(&from, rows);
    if (!error && !is_codes(from.image.pixel))
        error = PUPIL_ERR_PIXEL;
    if (!error)
        error = read_out(&from.image, &to, out);
    if (!error && (threshold < 1 || threshold > PUPIL_EDGE_MOST))
        error = PUPIL_ERR_VALUE;
    if (error)
        return error;
    const pupil_image_const *in = &from.image;
    const int blue_first = in->pixel == PUPIL_PIXEL_BGR8 || in->pixel == PUPIL_PIXEL_BGRX8;
    const uint8_t ordered[3] = {colour[blue_first ? 2 : 0], colour[1], colour[blue_first ? 0 : 2]};
    uint64_t count = 0;
    for (uint32_t y = 0; y < in->height; y++) {
        const uint8_t *here = (const uint8_t *)in->data + (ptrdiff_t)y * in->stride_bytes;
        const around r = {.above = y || in->rows_above ? here - in->stride_bytes : here,
                          .here = here,
                          .below = y + 1 < in->height || in->rows_below ? here + in->stride_bytes : here};
        count += mark_row(&r, in->width, pupil_pixel_bytes(in->pixel), (int32_t)(threshold * threshold), ordered,
                          (uint8_t *)to.data + (ptrdiff_t)y * to.stride_bytes);
    }
    if (edges)
        *edges = count;
    return PUPIL_OK;
}
