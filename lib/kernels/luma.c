/* Frames of 8-bit Y'CbCr by their luma (config.h: pupil_accuracy): metered by a sample of their pixels, and mapped in
 * 4:2:0 by tables that are made once a call. */
#include "kernels.h"

/* --- metering --- */

/* Pixels of a row that have been picked by pairs, which share Cb and Cr. */
typedef struct picked {
    uint8_t luma[PUPIL_BLOCK * 2], chroma[PUPIL_BLOCK], cr[PUPIL_BLOCK / 2];
} picked;

static void pick_pair(uint32_t pixel, const pupil_row *row, uint32_t pair, uint32_t to, picked *p)
{
    const uint32_t second = 2 * pair + 1 < row->width ? 2 * pair + 1 : 2 * pair; /* of a last column alone: itself */
    if (pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY) {
        for (uint32_t i = 0; i < 4; i++)
            p->luma[4 * to + i] = row->data[4 * (size_t)pair + i];
        return;
    }
    p->luma[2 * to] = row->data[2 * (size_t)pair];
    p->luma[2 * to + 1] = row->data[second];
    if (row->cr) {
        p->chroma[to] = row->chroma[pair];
        p->cr[to] = row->cr[pair];
    } else {
        p->chroma[2 * to] = row->chroma[2 * (size_t)pair];
        p->chroma[2 * to + 1] = row->chroma[2 * (size_t)pair + 1];
    }
}

void pupil_meter_sampled(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, uint32_t weight,
                         uint32_t band, pupil_stats *stats)
{
    pupil_row_job every = *job;
    const uint32_t step = job->sample, end = (x + n + 1) / 2;
    uint32_t count = 0;
    picked p;
    every.sample = 0;
    const pupil_row compact = {
        .data = p.luma, .chroma = p.chroma, .cr = p.cr, .width = PUPIL_BLOCK, .y = row->y, .bins_rows = 1};
    for (uint32_t pair = x / 2; pair < end; pair += step) {
        const uint32_t left = end - pair < step ? end - pair : step;
        pick_pair(job->in_pixel, row, pair + (row->bins_first < left ? row->bins_first : left - 1), count++, &p);
        if (2 * count == PUPIL_BLOCK || pair + step >= end) {
            pupil_work_run(&every, &compact, 0, 2 * count, 0, weight, band, stats);
            count = 0;
        }
    }
}

/* --- mapping --- */

/* All codes as a row of grey pixels, by the exact pieces: grey has the same bits. */
void pupil_luma_tables_make(const pupil_row_job *job, const pupil_chroma_coder *coder, pupil_luma_tables *t)
{
    const pupil_coder *c = job->coder;
    uint8_t grey[PUPIL_BLOCK], none[PUPIL_BLOCK], codes[PUPIL_BLOCK * 4];
    _Static_assert(PUPIL_BLOCK == 256, "a block has all codes of 8 bits");
    for (uint32_t i = 0; i < PUPIL_BLOCK; i++) {
        grey[i] = (uint8_t)i;
        none[i] = 128;
    }
    float change = 0.0f;
    pupil_row_job every = *job;
    every.in_pixel = PUPIL_PIXEL_NV12;
    const pupil_row row = {.data = grey, .chroma = none, .width = PUPIL_BLOCK};
    pupil_work_run(&every, &row, 0, PUPIL_BLOCK, codes, 0, 0, 0);
    PUPIL_PIECE(job->kernels, luma_of_codes)(coder, codes, PUPIL_BLOCK, t->luma);
    t->zero = c->y_zero;
    t->one = c->y_unit;
    t->top = 255.0f / c->y_unit;
    for (uint32_t i = 64; i < PUPIL_BLOCK; i++) {
        const float by = (float)(int32_t)t->luma[i] - (float)(int32_t)i,
                    share = (by < 0.0f ? -by : by) / (float)(int32_t)i;
        change = share > change && (float)(int32_t)i - c->y_zero <= t->top ? share : change;
    }
    t->knee = job->curve->gamut > 0.0f ? PUPIL_GAMUT_KNEE : 1.0f;
    t->far = change < 0.02f ? 8.0f : 0.5f; /* where nothing is scaled, luma need not be luminance */
    t->red_v = c->red_v;
    t->blue_u = c->blue_u;
    t->green_u = c->green_u;
    t->green_v = c->green_v;
}

/* Quads that are mapped exactly, side by side as if they were two rows, and where they belong. */
enum { MOST_EXACT = 64 };
typedef struct exact_quads {
    uint32_t count;
    uint16_t place[MOST_EXACT];
    uint8_t upper[2 * MOST_EXACT], lower[2 * MOST_EXACT], chroma[2 * MOST_EXACT];
} exact_quads;

static __attribute__((noinline)) void map_exactly(const pupil_row_job *job, const pupil_chroma_coder *coder,
                                                  exact_quads *q, const pupil_luma_target *out)
{
    uint8_t upper[2 * MOST_EXACT], lower[2 * MOST_EXACT], chroma[2 * MOST_EXACT];
    const pupil_row from = {.data = q->upper, .chroma = q->chroma, .width = 2 * q->count};
    const pupil_row below = {.data = q->lower, .chroma = q->chroma, .width = 2 * q->count};
    const pupil_yuv_rows to = {.upper = upper, .lower = lower, .chroma = chroma};
    pupil_row_job every = *job;
    every.in_pixel = PUPIL_PIXEL_NV12;
    pupil_map_yuv(&every, coder, &from, &below, 0, 2 * q->count, &to);
    for (uint32_t i = 0; i < q->count; i++) {
        const size_t at = q->place[i];
        out->upper[2 * at] = upper[2 * i];
        out->upper[2 * at + 1] = upper[2 * i + 1];
        out->lower[2 * at] = lower[2 * i];
        out->lower[2 * at + 1] = lower[2 * i + 1];
        out->cb[out->step * at] = chroma[2 * i];
        out->cr[out->step * at] = chroma[2 * i + 1];
    }
    q->count = 0;
}

static void list_exact(const pupil_luma_quads *in, const uint8_t *exact, uint32_t first, uint32_t n, exact_quads *q)
{
    for (uint32_t i = 0; i < n; i++) {
        const size_t at = first + i, k = q->count;
        q->place[k] = (uint16_t)at;
        q->upper[2 * k] = in->upper[2 * at];
        q->upper[2 * k + 1] = in->upper[2 * at + 1];
        q->lower[2 * k] = in->lower[2 * at];
        q->lower[2 * k + 1] = in->lower[2 * at + 1];
        q->chroma[2 * k] = in->cb[in->step * at];
        q->chroma[2 * k + 1] = in->cr[in->step * at];
        q->count += exact[i];
    }
}

static pupil_luma_quads quads_from(const pupil_luma_quads *in, size_t at)
{
    return (pupil_luma_quads){in->upper + 2 * at, in->lower + 2 * at, in->cb + in->step * at, in->cr + in->step * at,
                              in->step};
}

static pupil_luma_target target_from(const pupil_luma_target *out, size_t at)
{
    return (pupil_luma_target){out->upper + 2 * at, out->lower + 2 * at, out->cb + out->step * at,
                               out->cr + out->step * at, out->step};
}

void pupil_map_luma(const pupil_row_job *job, const pupil_chroma_coder *coder, const pupil_luma_tables *tables,
                    const pupil_row *upper, const pupil_row *lower, uint32_t n, const pupil_yuv_rows *to)
{
    const int swapped = job->in_pixel == PUPIL_PIXEL_NV21;
    const pupil_luma_quads in = {.upper = upper->data,
                                 .lower = lower->data,
                                 .cb = swapped ? upper->chroma + 1 : upper->chroma,
                                 .cr = upper->cr ? upper->cr
                                       : swapped ? upper->chroma
                                                 : upper->chroma + 1,
                                 .step = upper->cr ? 1 : 2};
    const pupil_luma_target out = {.upper = to->upper,
                                   .lower = to->lower,
                                   .cb = to->chroma,
                                   .cr = to->cr ? to->cr : to->chroma + 1,
                                   .step = to->cr ? 1 : 2};
    const uint32_t quads = to->lower ? n / 2 : 0;
    uint8_t exact[PUPIL_LUMA_QUADS];
    exact_quads listed;
    listed.count = 0;
    for (uint32_t x = 0; x < quads; x += PUPIL_LUMA_QUADS) {
        const uint32_t m = quads - x < PUPIL_LUMA_QUADS ? quads - x : PUPIL_LUMA_QUADS;
        const pupil_luma_quads from = quads_from(&in, x);
        const pupil_luma_target target = target_from(&out, x);
        if (!PUPIL_PIECE(job->kernels, by_luma)(tables, &from, m, &target, exact))
            continue;
        if (listed.count > MOST_EXACT - PUPIL_LUMA_QUADS)
            map_exactly(job, coder, &listed, &out);
        list_exact(&in, exact, x, m, &listed);
    }
    if (listed.count)
        map_exactly(job, coder, &listed, &out);
    if (2 * quads < n) /* a last column or row alone */
        pupil_map_yuv(job, coder, upper, lower, 2 * quads, n, to);
}
