/* The octaves of a bloom: a frame's light at half the size, and again, and each one's blurs. */
#include "bloom_private.h"

#include "core/image.h"

enum { PART = BLOOM_PART / 2, HALVED = 6 };
_Static_assert(PART % 8 == 0, "kernels write whole vectors");

/* What a worker gathers with. */
typedef struct gathering {
    BLOOM_ALIGNED bloom_line row[HALVED];
    BLOOM_ALIGNED float line[BLOOM_LINE];
    bloom_frame frame;
} gathering;
_Static_assert(sizeof(gathering) + 64 <= sizeof(pupil_bloom_scratch), "PUPIL_BLOOM_SCRATCH_BYTES is too small");

static bloom_object *object_of(pupil_bloom *bloom)
{
    return (bloom_object *)(void *)bloom;
}

/* --- the first octave, from the frame --- */

static void read_row(gathering *g, int32_t y, int32_t x, uint32_t n)
{
    (void)pupil_bloom_light(&g->frame, y, 2 * x - BLOOM_SIDE, 2 * n + 2 * BLOOM_SIDE,
                            g->row[(y + 2 * HALVED) % HALVED]);
}

/* Rows first to end of the octave, `n` pixels from x on, down the rows; x may be before the picture. */
static void gather_part(bloom_object *o, gathering *g, int32_t first, int32_t end, int32_t x, uint32_t n)
{
    for (int32_t y = 2 * first - 2; y < 2 * first + 2; y++)
        read_row(g, y, x, n);
    for (int32_t j = first; j < end; j++) {
        read_row(g, 2 * j + 2, x, n);
        read_row(g, 2 * j + 3, x, n);
        for (int channel = 0; channel < 3; channel++) {
            const float *row[HALVED];
            for (int32_t k = 0; k < HALVED; k++)
                row[k] = g->row[(2 * j - 2 + k + 2 * HALVED) % HALVED][channel];
            float *to = o->memory + pupil_bloom_row(o, 1, o->octave[1].light, channel, j) + BLOOM_LEFT + x;
            PUPIL_PIECE(g->frame.kernels, bloom_down)(row, 2 * n + 2 * BLOOM_SIDE, g->line);
            PUPIL_PIECE(g->frame.kernels, bloom_halve)(g->line + BLOOM_SIDE, n, to);
        }
    }
}

static int check_frame(const bloom_object *o, const pupil_image_const *frame, uint32_t first_row, uint32_t count)
{
    if (pupil_pixel_is_mosaic(frame->pixel))
        return PUPIL_ERR_PIXEL;
    if (frame->width != o->config.width || frame->height != o->config.height)
        return PUPIL_ERR_SIZE;
    if (first_row > frame->height || count > frame->height - first_row || first_row % 2)
        return PUPIL_ERR_ROWS;
    return count % 2 && first_row + count != frame->height ? PUPIL_ERR_ROWS : PUPIL_OK;
}

int pupil_bloom_gather_rows(pupil_bloom *bloom, const pupil_t *pupil, const pupil_image_const *frame,
                            uint32_t first_row, uint32_t count, pupil_bloom_scratch *scratch)
{
    pupil_input in;
    int error = scratch ? pupil_bloom_check(bloom) : PUPIL_ERR_NULL;
    if (!error)
        error = pupil_object_check(pupil);
    if (!error)
        error = pupil_input_read(&in, frame);
    if (!error)
        error = check_frame(object_of(bloom), &in.image, first_row, count);
    bloom_object *o = object_of(bloom);
    if (error || !count || o->octaves < 2)
        return error;
    gathering *g = (gathering *)pupil_bloom_aligned(scratch);
    g->frame.kernels = pupil_level_kernels(pupil_object_of_const(pupil)->level);
    g->frame.threshold = (float)o->config.threshold;
    pupil_veil_rows_begin(&g->frame.rows, &in.image);
    const int last = first_row + count == o->config.height;
    const int32_t first = first_row ? (int32_t)(first_row / 2) : 1 - BLOOM_MARGIN;
    const int32_t end = last ? (int32_t)o->octave[1].height + BLOOM_MARGIN - 1 : (int32_t)((first_row + count) / 2);
    const int32_t beyond = (int32_t)o->octave[1].width + BLOOM_MARGIN;
    for (int32_t x = -BLOOM_MARGIN; x < beyond; x += PART)
        gather_part(o, g, first, end, x, (uint32_t)(beyond - x < PART ? beyond - x : PART));
    return PUPIL_OK;
}

/* --- the others --- */

/* Octave k + 1 from octave k. */
static void halve(bloom_object *o, const pupil_kernels *kernels, uint32_t k)
{
    const bloom_octave *from = &o->octave[k], *to = &o->octave[k + 1];
    float *line = o->memory + o->line;
    for (int channel = 0; channel < 3; channel++)
        for (int32_t j = 1 - BLOOM_MARGIN; j < (int32_t)to->height + BLOOM_MARGIN - 1; j++) {
            const float *six[HALVED];
            for (int32_t i = 0; i < HALVED; i++)
                six[i] = o->memory + pupil_bloom_row(o, k, from->light, channel, 2 * j - 2 + i);
            float *row = o->memory + pupil_bloom_row(o, k + 1, to->light, channel, j) + BLOOM_LEFT - BLOOM_MARGIN;
            PUPIL_PIECE(kernels, bloom_down)(six, from->stride, line);
            PUPIL_PIECE(kernels, bloom_halve)(line + BLOOM_LEFT - 2 * BLOOM_MARGIN, to->width + 2 * BLOOM_MARGIN, row);
        }
}

/* Row y of an octave gets a lobe's light; `more`: in addition to what is there. */
static void blur_row(bloom_object *o, const pupil_kernels *kernels, const bloom_lobe *lobe, int channel, int32_t y,
                     int more)
{
    const bloom_octave *at = &o->octave[lobe->octave];
    const float *one[BLOOM_TAPS], *other[BLOOM_TAPS];
    float *line = o->memory + o->line;
    for (int32_t k = 0; k < (int32_t)lobe->taps; k++) {
        one[k] = o->memory + pupil_bloom_row(o, lobe->octave, at->light, channel, y - k);
        other[k] = o->memory + pupil_bloom_row(o, lobe->octave, at->light, channel, y + k);
    }
    PUPIL_PIECE(kernels, bloom_pairs)(one, other, lobe->column, lobe->taps, at->stride, line, 0);
    for (uint32_t k = 0; k < lobe->taps; k++) {
        one[k] = line + BLOOM_LEFT - BLOOM_MARGIN - k;
        other[k] = line + BLOOM_LEFT - BLOOM_MARGIN + k;
    }
    float *to = o->memory + pupil_bloom_row(o, lobe->octave, at->blurred, channel, y) + BLOOM_LEFT - BLOOM_MARGIN;
    PUPIL_PIECE(kernels, bloom_pairs)(one, other, lobe->row, lobe->taps, at->width + 2 * BLOOM_MARGIN, to, more);
}

static void blur(bloom_object *o, const pupil_kernels *kernels, uint32_t octave)
{
    const bloom_octave *at = &o->octave[octave];
    const uint32_t across = at->width + 2 * BLOOM_MARGIN;
    float *line = o->memory + o->line;
    for (int channel = 0; channel < 3; channel++)
        for (int32_t y = 1 - BLOOM_MARGIN; y < (int32_t)at->height + BLOOM_MARGIN - 1; y++) {
            float *row = o->memory + pupil_bloom_row(o, octave, at->blurred, channel, y);
            int more = 0;
            for (uint32_t i = 0; i < o->lobes; i++)
                if (o->lobe[i].octave == octave) {
                    blur_row(o, kernels, &o->lobe[i], channel, y, more);
                    more = 1;
                }
            if (!more)
                __builtin_memset(row, 0, at->stride * sizeof *row);
            if (octave + 1 == o->octaves)
                continue;
            pupil_bloom_between(o, kernels, octave + 1, channel, y, 0, o->octave[octave + 1].stride, line);
            PUPIL_PIECE(kernels, bloom_widen)
            (line + BLOOM_LEFT - BLOOM_MARGIN / 2, across / 2, row + BLOOM_LEFT - BLOOM_MARGIN);
        }
}

int pupil_bloom_solve(pupil_bloom *bloom, const pupil_t *pupil)
{
    int error = pupil_bloom_check(bloom);
    if (!error)
        error = pupil_object_check(pupil);
    if (error)
        return error;
    bloom_object *o = object_of(bloom);
    const pupil_kernels *kernels = pupil_level_kernels(pupil_object_of_const(pupil)->level);
    for (uint32_t k = 1; k + 1 < o->octaves; k++)
        halve(o, kernels, k);
    for (uint32_t k = o->octaves - 1; k > 0; k--)
        blur(o, kernels, k);
    return PUPIL_OK;
}
