/* Frames of 8-bit Y'CbCr by their luma (config.h: pupil_accuracy): metered by a sample of their pixels, and mapped by
 * tables that are made once a call. */
#include "kernels.h"

/* --- metering --- */

/* Pixels of a row that were picked in pairs, which share Cb and Cr. */
typedef struct picked {
    uint8_t luma[PUPIL_BLOCK * 2], chroma[PUPIL_BLOCK], cr[PUPIL_BLOCK / 2];
} picked;

/* What `count` pairs have in a plane, or packed: so many bytes of every `step`-th one. `bytes` is a constant in each
 * call. */
static inline __attribute__((always_inline)) void pick(const uint8_t *restrict from, size_t bytes, size_t step,
                                                       uint32_t count, uint8_t *restrict to)
{
    step *= bytes;
    for (; count >= 4; count -= 4, from += 4 * step, to += 4 * bytes)
        for (size_t k = 0; k < 4; k++)
            __builtin_memcpy(to + k * bytes, from + k * step, bytes);
    for (; count; count--, from += step, to += bytes)
        __builtin_memcpy(to, from, bytes);
}

static void pick_pairs(const pupil_row_job *job, const pupil_row *row, uint32_t pair, uint32_t count, picked *p)
{
    const size_t step = job->sample;
    if (job->in_pixel == PUPIL_PIXEL_YUYV || job->in_pixel == PUPIL_PIXEL_UYVY) {
        pick(row->data + 4 * (size_t)pair, 4, step, count, p->luma);
        return;
    }
    const uint32_t last = pair + (count - 1) * job->sample;
    const int is_alone = 2 * last + 1 >= row->width; /* a last column alone is taken twice */
    pick(row->data + 2 * (size_t)pair, 2, step, count - (uint32_t)is_alone, p->luma);
    if (is_alone)
        p->luma[2 * count - 2] = p->luma[2 * count - 1] = row->data[2 * (size_t)last];
    if (row->cr) {
        pick(row->chroma + pair, 1, step, count, p->chroma);
        pick(row->cr + pair, 1, step, count, p->cr);
    } else {
        pick(row->chroma + 2 * (size_t)pair, 2, step, count, p->chroma);
    }
}

void pupil_meter_sampled(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, uint32_t weight,
                         uint32_t band, pupil_stats *stats)
{
    pupil_row_job every = *job;
    const uint32_t step = job->sample, end = (x + n + 1) / 2;
    picked p;
    every.sample = 0;
    const pupil_row compact = {
        .data = p.luma, .chroma = p.chroma, .cr = p.cr, .width = PUPIL_BLOCK, .y = row->y, .bins_rows = 1};
    for (uint32_t pair = x / 2; pair < end;) {
        const uint32_t left = end - pair, groups = left / step; /* groups that are whole */
        const uint32_t count = groups < PUPIL_BLOCK / 2 ? groups : PUPIL_BLOCK / 2;
        if (count) {
            pick_pairs(job, row, pair + row->bins_first, count, &p);
            pair += count * step;
        } else {
            pick_pairs(job, row, pair + (row->bins_first < left ? row->bins_first : left - 1), 1, &p);
            pair = end;
        }
        pupil_work_run(&every, &compact, 0, 2 * (count ? count : 1), 0, weight, band, stats);
    }
}

/* --- mapping: the tables --- */

/* Maps all codes, as a row of grey pixels, to RGBA codes by the exact pieces: so grey has the same bits. */
static void map_greys(const pupil_row_job *job, uint8_t codes[PUPIL_BLOCK * 4])
{
    uint8_t grey[PUPIL_BLOCK], none[PUPIL_BLOCK];
    _Static_assert(PUPIL_BLOCK == 256, "a block has all codes of 8 bits");
    for (uint32_t i = 0; i < PUPIL_BLOCK; i++) {
        grey[i] = (uint8_t)i;
        none[i] = 128;
    }
    pupil_row_job every = *job;
    every.in_pixel = PUPIL_PIXEL_NV12;
    every.out_pixel = PUPIL_PIXEL_RGBA8;
    const pupil_row row = {.data = grey, .chroma = none, .width = PUPIL_BLOCK};
    pupil_work_run(&every, &row, 0, PUPIL_BLOCK, codes, 0, 0, 0);
}

/* A scale of codes: the code of black, and the R'G'B' codes in one code. */
typedef struct code_scale {
    float zero, one;
} code_scale;

static float code_on(const code_scale *scale, float code)
{
    const float value = (code - scale->zero) * scale->one;
    return value < 0.0f ? 0.0f : value < 255.0f ? value : 255.0f;
}

static int16_t word_of(float value)
{
    return (int16_t)(value < 0.0f ? value - 0.5f : value + 0.5f);
}

/* Of the mean of codes 2 i and 2 i + 1. */
static void make_ratios(const code_scale *in, const code_scale *out, pupil_luma_tables *t)
{
    for (uint32_t i = 0; i < 128; i++) {
        const float to = code_on(out, t->luma[2 * i]) + code_on(out, t->luma[2 * i + 1]);
        float from = 2.0f * code_on(in, 2.0f * (float)(int32_t)i + 0.5f);
        from = from > in->one ? from : in->one;
        const float ratio = 2048.0f * to / from;
        const uint32_t word = ratio < 32767.0f ? (uint32_t)(ratio + 0.5f) : 32767;
        t->ratio_low[i] = (uint8_t)word;
        t->ratio_high[i] = (uint8_t)(word >> 8);
    }
}

/* The largest change of a code that is not dark, as a share of it. */
static float largest_change(const code_scale *in, const code_scale *out, const uint8_t luma[256])
{
    float change = 0.0f;
    for (uint32_t i = 64; i < 256; i++) {
        const float from = code_on(in, (float)(int32_t)i), by = code_on(out, luma[i]) - from;
        const float share = (by < 0.0f ? -by : by) / from;
        change = share > change ? share : change;
    }
    return change;
}

/* A colour is mapped exactly if its largest component is near the gamut's surface, where its ratio is not kept, or if
 * it is so far from grey that luma is not its luminance. In R'G'B' codes, with a margin for noise. */
#define NEAR_ROOM 3.0f
#define FAR_ROOM  (PUPIL_LUMA_NOISE / 4)

/* coder: of Y' and its Cb and Cr; NULL: to R'G'B'. */
void pupil_luma_tables_make(const pupil_row_job *job, const pupil_chroma_coder *coder, pupil_luma_tables *t)
{
    const pupil_coder *c = job->coder;
    const code_scale in = {c->y_zero, c->y_unit}, rgb = {0.0f, 1.0f}, out = coder ? in : rgb;
    uint8_t codes[PUPIL_BLOCK * 4];
    map_greys(job, codes);
    if (coder)
        PUPIL_PIECE(job->kernels, luma_of_codes)(coder, codes, PUPIL_BLOCK, t->luma);
    for (uint32_t i = 0; i < PUPIL_BLOCK && !coder; i++)
        t->luma[i] = codes[4 * i + 1];
    make_ratios(&in, &out, t);
    for (uint32_t i = 0; i < 256; i++)
        t->luma_steps[i] = i < 16 ? 0 : t->luma[i] ^ t->luma[i - 16];
    t->red_v = word_of(c->red_v * 8192.0f);
    t->blue_u = word_of(c->blue_u * 8192.0f);
    t->green_u = word_of(c->green_u * 8192.0f);
    t->green_v = word_of(c->green_v * 8192.0f);
    const float knee = job->curve->gamut > 0.0f ? PUPIL_GAMUT_KNEE : 1.0f;
    const float far =
        largest_change(&in, &out, t->luma) < 0.02f ? 8.0f : 0.4f; /* unscaled, luma need not be luminance */
    t->surface = word_of(4.0f * (knee * (255.0f + out.zero * out.one) + NEAR_ROOM));
    t->surface_slope = word_of(1024.0f * knee * out.one);
    t->far = word_of(4.0f * (FAR_ROOM - far * out.zero * out.one));
    t->far_slope = word_of(1024.0f * far * out.one);
}

/* --- mapping: quads that are mapped exactly --- */

/* Quads side by side as if they were two rows, and their places in the frame. */
enum { MOST_EXACT = 64 };
typedef struct exact_quads {
    uint32_t count;
    uint16_t place[MOST_EXACT];
    uint8_t upper[2 * MOST_EXACT], lower[2 * MOST_EXACT], chroma[2 * MOST_EXACT];
} exact_quads;

static void copy_bytes(const uint8_t *restrict from, uint32_t n, uint8_t *restrict to)
{
    for (uint32_t i = 0; i < n; i++)
        to[i] = from[i];
}

static void quads_to_yuv(const pupil_row_job *every, const pupil_chroma_coder *coder, const exact_quads *q,
                         const pupil_yuv_rows *out)
{
    uint8_t upper[2 * MOST_EXACT], lower[2 * MOST_EXACT], chroma[2 * MOST_EXACT];
    const pupil_row from = {.data = q->upper, .chroma = q->chroma, .width = 2 * q->count};
    const pupil_row below = {.data = q->lower, .chroma = q->chroma, .width = 2 * q->count};
    const pupil_yuv_rows to = {.upper = upper, .lower = lower, .chroma = chroma};
    pupil_map_yuv(every, coder, &from, &below, 0, 2 * q->count, &to);
    for (uint32_t i = 0; i < q->count; i++) {
        const size_t at = q->place[i];
        copy_bytes(upper + 2 * (size_t)i, 2, out->upper + 2 * at);
        copy_bytes(lower + 2 * (size_t)i, 2, out->lower + 2 * at);
        out->chroma[out->cr ? at : 2 * at] = chroma[2 * i];
        *(out->cr ? out->cr + at : out->chroma + 2 * at + 1) = chroma[2 * i + 1];
    }
}

static void quads_to_rgb(const pupil_row_job *every, const exact_quads *q, const pupil_yuv_rows *out)
{
    uint8_t codes[8 * MOST_EXACT];
    for (int row = 0; row < (out->lower ? 2 : 1); row++) {
        const pupil_row from = {.data = row ? q->lower : q->upper, .chroma = q->chroma, .width = 2 * q->count};
        uint8_t *to = row ? out->lower : out->upper;
        pupil_work_run(every, &from, 0, 2 * q->count, codes, 0, 0, 0);
        for (uint32_t i = 0; i < q->count; i++)
            copy_bytes(codes + 8 * (size_t)i, 8, to + 8 * (size_t)q->place[i]);
    }
}

static __attribute__((noinline)) void map_exactly(const pupil_row_job *job, const pupil_chroma_coder *coder,
                                                  exact_quads *q, const pupil_yuv_rows *out)
{
    pupil_row_job every = *job;
    every.in_pixel = PUPIL_PIXEL_NV12;
    if (out->chroma)
        quads_to_yuv(&every, coder, q, out);
    else
        quads_to_rgb(&every, q, out);
    q->count = 0;
}

/* --- mapping: a pair of rows, or a row, by blocks --- */

typedef struct luma_work {
    const pupil_row_job *job;
    const pupil_chroma_coder *coder; /* NULL: to R'G'B' */
    const pupil_luma_tables *tables;
    const pupil_row *upper, *lower; /* lower NULL: one row */
    const pupil_yuv_rows *to;       /* of R'G'B' without chroma */
    exact_quads listed;
} luma_work;

/* Copies of a block's codes, for formats whose layout is not the kernels'. */
typedef struct luma_block {
    uint8_t upper[2 * PUPIL_LUMA_QUADS], lower[2 * PUPIL_LUMA_QUADS], chroma[2 * PUPIL_LUMA_QUADS];
    uint8_t new_chroma[2 * PUPIL_LUMA_QUADS];
} luma_block;

static void part_packed(const uint8_t *restrict from, uint32_t luma_at, uint32_t n, uint8_t *restrict luma,
                        uint8_t *restrict chroma)
{
    for (uint32_t i = 0; i < n; i++) {
        luma[i] = from[2 * i + luma_at];
        chroma[i] = from[2 * i + 1 - luma_at];
    }
}

static void average_to(uint8_t *restrict chroma, const uint8_t *restrict other, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        chroma[i] = (uint8_t)((chroma[i] + other[i] + 1) >> 1);
}

/* Interleaved Cb and Cr of quads x to x + n. */
static void gather_chroma(uint32_t pixel, const pupil_row *row, size_t x, uint32_t n, uint8_t *restrict chroma)
{
    const int swapped = pixel == PUPIL_PIXEL_NV21;
    const uint8_t *restrict cb = row->cr ? row->chroma + x : row->chroma + 2 * x + (swapped ? 1 : 0);
    const uint8_t *restrict cr = row->cr ? row->cr + x : row->chroma + 2 * x + (swapped ? 0 : 1);
    const size_t step = row->cr ? 1 : 2;
    for (uint32_t i = 0; i < n; i++) {
        chroma[2 * i] = cb[step * i];
        chroma[2 * i + 1] = cr[step * i];
    }
}

static int is_packed(uint32_t pixel)
{
    return pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY;
}

static int has_chroma_in_each_row(uint32_t pixel)
{
    return is_packed(pixel) || pixel == PUPIL_PIXEL_NV16;
}

/* Quads x to x + n of the rows; if both rows have chroma, it is the mean. */
static pupil_luma_quads block_of(const luma_work *w, size_t x, uint32_t n, luma_block *b)
{
    const uint32_t pixel = w->job->in_pixel;
    pupil_luma_quads in = {.upper = w->upper->data + 2 * x, .chroma = b->chroma};
    if (w->lower)
        in.lower = w->lower->data + 2 * x;
    if (is_packed(pixel)) {
        part_packed(w->upper->data + 4 * x, pixel == PUPIL_PIXEL_UYVY, 2 * n, b->upper, b->chroma);
        in.upper = b->upper;
        if (w->lower) {
            part_packed(w->lower->data + 4 * x, pixel == PUPIL_PIXEL_UYVY, 2 * n, b->lower, b->new_chroma);
            in.lower = b->lower;
        }
    } else if (pixel == PUPIL_PIXEL_NV12 || (pixel == PUPIL_PIXEL_NV16 && !w->lower)) {
        in.chroma = w->upper->chroma + 2 * x;
    } else {
        gather_chroma(pixel, w->upper, x, n, b->chroma);
        if (pixel == PUPIL_PIXEL_NV16)
            copy_bytes(w->lower->chroma + 2 * x, 2 * n, b->new_chroma);
    }
    if (w->lower && has_chroma_in_each_row(pixel))
        average_to(b->chroma, b->new_chroma, 2 * n);
    return in;
}

static void list_quad(luma_work *w, const pupil_luma_quads *in, uint32_t x, uint32_t i)
{
    exact_quads *q = &w->listed;
    const uint32_t k = q->count++;
    q->place[k] = (uint16_t)(x + i);
    copy_bytes(in->upper + 2 * (size_t)i, 2, q->upper + 2 * (size_t)k);
    copy_bytes((in->lower ? in->lower : in->upper) + 2 * (size_t)i, 2, q->lower + 2 * (size_t)k);
    copy_bytes(in->chroma + 2 * (size_t)i, 2, q->chroma + 2 * (size_t)k);
    if (q->count == MOST_EXACT)
        map_exactly(w->job, w->coder, q, w->to);
}

/* Quads i to n of a block at x. Four of `exact` are tested at once: few are set. */
static void list_exact(luma_work *w, const pupil_luma_quads *in, const uint16_t *exact, uint32_t x, uint32_t i,
                       uint32_t n)
{
    for (; i < n; i += 4) {
        uint64_t four;
        __builtin_memcpy(&four, exact + i, sizeof four);
        for (uint32_t k = 0; four && k < 4; k++)
            if (exact[i + k])
                list_quad(w, in, x, i + k);
    }
}

/* Quads x to x + n, PUPIL_LUMA_QUADS at most. */
static void map_block(luma_work *w, uint32_t x, uint32_t n)
{
    const pupil_yuv_rows *to = w->to;
    const size_t at = (to->chroma ? 2 : 8) * (size_t)x;
    uint16_t exact[PUPIL_LUMA_QUADS];
    luma_block b;
    const pupil_luma_quads in = block_of(w, x, n, &b);
    const pupil_luma_target out = {.upper = to->upper + at,
                                   .lower = to->lower ? to->lower + at : 0,
                                   .chroma = to->cr       ? b.new_chroma
                                             : to->chroma ? to->chroma + 2 * (size_t)x
                                                          : 0,
                                   .blue_first = w->job->out_pixel == PUPIL_PIXEL_BGRX8};
    const pupil_kernels *k = w->job->kernels;
    uint32_t parts = to->chroma ? PUPIL_PIECE(k, yuv_by_luma)(w->tables, &in, n, &out, exact)
                                : PUPIL_PIECE(k, rgb_by_luma)(w->tables, &in, n, &out, exact);
    for (uint32_t i = n; i % 4; i++) /* list_exact takes four at once */
        exact[i] = 0;
    for (uint32_t i = 0; i < n && to->cr; i++) {
        to->chroma[x + i] = b.new_chroma[2 * i];
        to->cr[x + i] = b.new_chroma[2 * i + 1];
    }
    for (uint32_t i = 0; parts; i += PUPIL_LUMA_PART, parts >>= 1)
        if (parts & 1)
            list_exact(w, &in, exact, x, i, n - i < PUPIL_LUMA_PART ? n : i + PUPIL_LUMA_PART);
}

static void map_quads(const pupil_row_job *job, const pupil_chroma_coder *coder, const pupil_luma_tables *tables,
                      const pupil_row *upper, const pupil_row *lower, uint32_t quads, const pupil_yuv_rows *to)
{
    luma_work w; /* all of it is set below, except the empty list */
    w.job = job;
    w.coder = coder;
    w.tables = tables;
    w.upper = upper;
    w.lower = lower;
    w.to = to;
    w.listed.count = 0;
    for (uint32_t x = 0; x < quads; x += PUPIL_LUMA_QUADS)
        map_block(&w, x, quads - x < PUPIL_LUMA_QUADS ? quads - x : PUPIL_LUMA_QUADS);
    if (w.listed.count)
        map_exactly(job, coder, &w.listed, to);
}

void pupil_map_luma(const pupil_row_job *job, const pupil_chroma_coder *coder, const pupil_luma_tables *tables,
                    const pupil_row *upper, const pupil_row *lower, uint32_t n, const pupil_yuv_rows *to)
{
    const uint32_t quads = to->lower ? n / 2 : 0;
    map_quads(job, coder, tables, upper, lower, quads, to);
    if (2 * quads < n) /* a last column or row alone */
        pupil_map_yuv(job, coder, upper, lower, 2 * quads, n, to);
}

static void map_rgb_rows(const pupil_row_job *job, const pupil_luma_tables *tables, const pupil_row *upper,
                         const pupil_row *lower, uint32_t n, const pupil_yuv_rows *to)
{
    map_quads(job, 0, tables, upper, lower, n / 2, to);
    if (n % 2)
        pupil_work_run(job, upper, n - 1, 1, to->upper + 4 * (size_t)(n - 1), 0, 0, 0);
    if (n % 2 && lower)
        pupil_work_run(job, lower, n - 1, 1, to->lower + 4 * (size_t)(n - 1), 0, 0, 0);
}

void pupil_map_luma_rgb(const pupil_row_job *job, const pupil_luma_tables *tables, const pupil_row *upper,
                        const pupil_row *lower, uint32_t n, uint8_t *upper_to, uint8_t *lower_to)
{
    const int apart = lower && has_chroma_in_each_row(job->in_pixel);
    const pupil_yuv_rows to = {.upper = upper_to, .lower = apart ? 0 : lower_to}, below = {.upper = lower_to};
    map_rgb_rows(job, tables, upper, apart ? 0 : lower, n, &to);
    if (apart)
        map_rgb_rows(job, tables, lower, 0, n, &below);
}
