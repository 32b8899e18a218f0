/* Takes a run of pixels of one row through the kernels, block by block, and adds it to the statistics. */
#include "kernels.h"

#include "base/numeric.h"

static void run_clear(pupil_run *run)
{
    for (int i = 0; i < PUPIL_LANES; i++) {
        run->product[i] = 1.0f;
        run->exponent[i] = 0;
    }
    run->black = run->clipped = run->bad = 0;
}

/* log2 of everything in the lanes: whole stops, and the rest in 2^-40. The products are multiplied in a fixed tree. */
static int64_t run_log2(const pupil_run *run, uint64_t *frac_q40)
{
    double p[PUPIL_LANES];
    int64_t whole = 0;
    for (int i = 0; i < PUPIL_LANES; i++) {
        p[i] = (double)run->product[i];
        whole += run->exponent[i];
    }
    for (int half = PUPIL_LANES / 2; half; half /= 2)
        for (int i = 0; i < half; i++)
            p[i] *= p[i + half];
    double log2 = pupil_log2(p[0]); /* 0 <= log2 < 16 */
    uint64_t q40 = (uint64_t)(log2 * 0x1p40 + 0.5);
    *frac_q40 = q40 & ((UINT64_C(1) << 40) - 1);
    return whole + (int64_t)(q40 >> 40);
}

static __attribute__((noinline)) void stats_add_run(pupil_stats *stats, const pupil_run *run, uint32_t n,
                                                    uint32_t weight, uint32_t band)
{
    uint64_t frac;
    int64_t whole = run_log2(run, &frac);
    uint64_t low = stats->log2_frac + frac * weight;

    stats->log2_sum += whole * (int64_t)weight + (int64_t)(low >> 40);
    stats->log2_frac = low & ((UINT64_C(1) << 40) - 1);
    stats->pixels += n;
    stats->weight += (uint64_t)n * weight;
    stats->black += run->black;
    if (stats->size_bytes >= sizeof *stats) /* an older caller's statistics end before it */
        stats->black_weight += (uint64_t)run->black * weight;
    stats->clipped += run->clipped;
    stats->bad += run->bad;
    /* unsigned, because the bands of a caller's statistics have not been checked yet */
    stats->band_log2_sum[band] =
        (int64_t)((uint64_t)stats->band_log2_sum[band] + (uint64_t)(whole * (1 << 24) + (int64_t)(frac >> 16)));
    stats->band_pixels[band] += n;
}

/* Samples x - 1 to x + n + 1 of a mosaic's row, mirrored at the frame's sides. */
static void unpack_around(const pupil_row_job *job, const uint8_t *row, uint32_t width, uint32_t x, uint32_t n,
                          uint16_t *samples)
{
    const uint32_t first = x ? x - 1 : 0, end = x + n < width ? x + n + 1 : width;
    uint16_t *to = x ? samples : samples + 1;
    PUPIL_PIECE(job->kernels, unpack[job->in_pixel])(row, job->coder->shift, first, end - first, to);
    if (!x)
        samples[0] = samples[2];
    if (x + n == width)
        samples[n + 1] = samples[n - 1];
}

static __attribute__((noinline)) void load_bilinear(const pupil_row_job *job, const pupil_row *row, uint32_t x,
                                                    uint32_t n, pupil_planes *planes)
{
    uint16_t samples[3][PUPIL_BLOCK + 2];
    const uint16_t *const rows[3] = {samples[0], samples[1], samples[2]};
    unpack_around(job, row->above, row->width, x, n, samples[0]);
    unpack_around(job, row->data, row->width, x, n, samples[1]);
    unpack_around(job, row->below, row->width, x, n, samples[2]);
    PUPIL_PIECE(job->kernels, bilinear)
    (job->coder, rows, (x & 1) == job->coder->red_x, row->odd == job->coder->red_y, n, planes);
}

/* --- companded mosaics: samples become light before they become pixels --- */

/* Room up to the end of the last vector, which is computed as a whole. */
#define LIGHT_OF(SAMPLES) ((SAMPLES) + PUPIL_LANES)

static __attribute__((noinline)) void load_bilinear_light(const pupil_row_job *job, const pupil_row *row, uint32_t x,
                                                          uint32_t n, pupil_planes *planes)
{
    float light[3][LIGHT_OF(PUPIL_BLOCK + 2)];
    uint16_t samples[PUPIL_BLOCK + 2];
    const float *const rows[3] = {light[0], light[1], light[2]};
    const uint8_t *const data[3] = {row->above, row->data, row->below};
    for (int i = 0; i < 3; i++) {
        unpack_around(job, data[i], row->width, x, n, samples);
        PUPIL_PIECE(job->kernels, expand)(job->coder, samples, n + 2, light[i]);
    }
    PUPIL_PIECE(job->kernels, bilinear_light)
    (job->coder, rows, (x & 1) == job->coder->red_x, row->odd == job->coder->red_y, n, planes);
}

/* As add_grey_world, in 1/65535 of the largest light. */
static void add_grey_world_light(const pupil_coder *c, const float *upper, const float *lower, uint32_t n,
                                 pupil_stats *stats)
{
    const float *red_row = c->red_y ? lower : upper, *blue_row = c->red_y ? upper : lower;
    for (uint32_t i = 0; i < 2 * n; i += 2) {
        const float rgb[3] = {red_row[i + c->red_x], 0.5f * (red_row[i + 1 - c->red_x] + blue_row[i + c->red_x]),
                              blue_row[i + 1 - c->red_x]};
        if (rgb[0] >= 1.0f || rgb[1] >= 1.0f || rgb[2] >= 1.0f)
            continue;
        for (int k = 0; k < 3; k++)
            stats->channel_sum[k] += (int32_t)((rgb[k] > -1.0f ? rgb[k] : -1.0f) * 262140.0f);
        stats->channel_quads++;
    }
}

/* In parts, whose light is small enough for the stack. */
static __attribute__((noinline)) void load_binned_light(const pupil_row_job *job, const pupil_row *row, uint32_t x,
                                                        uint32_t n, pupil_planes *planes, pupil_stats *stats)
{
    enum { PART = PUPIL_BLOCK / 2 };
    float upper[LIGHT_OF(2 * PART)], lower[LIGHT_OF(2 * PART)];
    uint16_t samples[2 * PART];
    pupil_unpack_kernel *unpack = PUPIL_PIECE(job->kernels, unpack[job->in_pixel]);
    pupil_expand_kernel *expand = PUPIL_PIECE(job->kernels, expand);
    for (uint32_t done = 0; done < n; done += PART) {
        const uint32_t part = n - done < PART ? n - done : PART;
        unpack(row->data, job->coder->shift, 2 * (x + done), 2 * part, samples);
        expand(job->coder, samples, 2 * part, upper);
        unpack(row->below, job->coder->shift, 2 * (x + done), 2 * part, samples);
        expand(job->coder, samples, 2 * part, lower);
        PUPIL_PIECE(job->kernels, binned_light)(job->coder, upper, lower, done, part, planes);
        if (job->grey_world)
            add_grey_world_light(job->coder, upper, lower, part, stats);
    }
}

/* From the samples, so that the white balance changes neither the sums nor what counts as full. */
static void add_grey_world(const pupil_coder *c, const uint16_t *upper, const uint16_t *lower, uint32_t n,
                           pupil_stats *stats)
{
    const uint16_t *red = (c->red_y ? lower : upper) + c->red_x, *green_r = (c->red_y ? lower : upper) + 1 - c->red_x;
    const uint16_t *blue = (c->red_y ? upper : lower) + 1 - c->red_x, *green_b = (c->red_y ? upper : lower) + c->red_x;
    for (uint32_t i = 0; i < 2 * n; i += 2) {
        const int32_t rgb4[3] = {4 * red[i], 2 * (green_r[i] + green_b[i]), 4 * blue[i]};
        if ((float)rgb4[0] >= c->full4 || (float)rgb4[1] >= c->full4 || (float)rgb4[2] >= c->full4)
            continue; /* a full quad has lost its colour */
        for (int k = 0; k < 3; k++)
            stats->channel_sum[k] += rgb4[k] - c->black4;
        stats->channel_quads++;
    }
}

static __attribute__((noinline)) void load_binned(const pupil_row_job *job, const pupil_row *row, uint32_t x,
                                                  uint32_t n, pupil_planes *planes, pupil_stats *stats)
{
    uint16_t upper[PUPIL_SAMPLES], lower[PUPIL_SAMPLES];
    pupil_unpack_kernel *unpack = PUPIL_PIECE(job->kernels, unpack[job->in_pixel]);
    unpack(row->data, job->coder->shift, 2 * x, 2 * n, upper);
    unpack(row->below, job->coder->shift, 2 * x, 2 * n, lower);
    PUPIL_PIECE(job->kernels, binned)(job->coder, upper, lower, n, planes);
    if (job->grey_world)
        add_grey_world(job->coder, upper, lower, n, stats);
}

/* 1: opaque. The sums of the channels, where the job wants them, go to stats. */
static int load(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes,
                pupil_stats *stats)
{
    if (job->way == PUPIL_WAY_PIXELS)
        return PUPIL_PIECE(job->kernels, load[job->in_pixel])(job->coder, row, x, n, planes);
    const int binned = job->way == PUPIL_WAY_BINNED;
    if (job->coder->lines && binned)
        load_binned_light(job, row, x, n, planes, stats);
    else if (job->coder->lines)
        load_bilinear_light(job, row, x, n, planes);
    else if (binned)
        load_binned(job, row, x, n, planes, stats);
    else
        load_bilinear(job, row, x, n, planes);
    if (job->curve && job->coder->has_matrix)
        PUPIL_PIECE(job->kernels, matrix)(job->coder->matrix, n, planes);
    return 1;
}

/* --- the histogram --- */

/* The white point follows the brightest channel that the curve gets, in the picture's primaries. */
static __attribute__((noinline)) void add_bins_of_picture(const pupil_row_job *job, const pupil_channels *light,
                                                          uint32_t n, uint32_t weight, pupil_stats *stats)
{
    PUPIL_PLANES_ALIGNED pupil_planes planes;
    const pupil_channels picture = {planes.r, planes.g, planes.b};
    for (uint32_t i = 0; i < n; i++) {
        planes.r[i] = light->r[i];
        planes.g[i] = light->g[i];
        planes.b[i] = light->b[i];
    }
    PUPIL_PIECE(job->kernels, to_picture)(job->to_peak, n, &planes);
    PUPIL_PIECE(job->kernels, histogram)(job, light, &picture, n, weight, stats);
}

static void add_bins(const pupil_row_job *job, const pupil_channels *light, uint32_t n, uint32_t weight,
                     pupil_stats *stats)
{
    if (job->to_peak)
        add_bins_of_picture(job, light, n, weight, stats);
    else
        PUPIL_PIECE(job->kernels, histogram)(job, light, light, n, weight, stats);
}

/* The next pixels of a block that are counted: one of each group of job->histogram pixels, or of the fewer ones at the
 * end. A block begins with a whole group. */
enum { MOST_PICKED = 64, MOST_PICKED_IN_ROW = 128 };
typedef struct picks {
    uint32_t count, group; /* how many pixels, and the size of each one's group */
    size_t at;             /* the first one; the next is a group further on */
} picks;

static picks picks_from(const pupil_row_job *job, const pupil_row *row, uint32_t i, uint32_t n, uint32_t most)
{
    const uint32_t left = n - i, groups = left / job->histogram;
    const uint32_t group = groups ? job->histogram : left;
    return (picks){.count = groups > most ? most
                            : groups      ? groups
                                          : 1,
                   .group = group,
                   .at = i + (row->bins_first < group ? row->bins_first : group - 1)};
}

static void pick_floats(const float *restrict from, const picks *p, float *restrict to)
{
    const float *at = from + p->at;
    const size_t step = p->group;
    uint32_t i = 0;
    for (; i + 4 <= p->count; i += 4, at += 4 * step)
        for (size_t k = 0; k < 4; k++)
            to[i + k] = at[k * step];
    for (; i < p->count; i++, at += step)
        to[i] = *at;
}

/* Counts the picks of a block in planes, whose `grey` is free. */
static void count_in_planes(const pupil_row_job *job, const pupil_row *row, uint32_t n, uint32_t weight,
                            pupil_planes *planes, pupil_stats *stats)
{
    const pupil_channels all = {planes->r, planes->g, planes->b};
    float *to = planes->grey;
    const pupil_channels light = {to, to + MOST_PICKED, to + 2 * MOST_PICKED};
    weight *= row->bins_rows;
    if (job->histogram == 1) {
        add_bins(job, &all, n, weight, stats);
        return;
    }
    for (uint32_t i = 0; i < n;) {
        const picks p = picks_from(job, row, i, n, MOST_PICKED);
        pick_floats(planes->r, &p, to);
        pick_floats(planes->g, &p, to + MOST_PICKED);
        pick_floats(planes->b, &p, to + 2 * MOST_PICKED);
        add_bins(job, &light, p.count, weight * p.group, stats);
        i += p.count * p.group;
    }
}

/* `bytes` is a constant in each call. */
static inline __attribute__((always_inline)) void pick_of(const uint8_t *restrict from, size_t bytes, const picks *p,
                                                          uint8_t *restrict to)
{
    const size_t step = bytes * p->group;
    const uint8_t *at = from + bytes * p->at;
    uint32_t i = 0;
    for (; i + 4 <= p->count; i += 4, at += 4 * step)
        for (size_t k = 0; k < 4; k++)
            __builtin_memcpy(to + bytes * (i + k), at + k * step, bytes);
    for (; i < p->count; i++, at += step)
        __builtin_memcpy(to + bytes * i, at, bytes);
}

static void pick_pixels(const uint8_t *from, size_t bytes, const picks *p, uint8_t *to)
{
    if (bytes == 16)
        pick_of(from, 16, p, to);
    else if (bytes == 12)
        pick_of(from, 12, p, to);
    else if (bytes == 8)
        pick_of(from, 8, p, to);
    else
        pick_of(from, bytes, p, to);
}

/* Counts the picks of contiguous pixels that are not in planes: only these are loaded. */
static __attribute__((noinline)) void count_in_row(const pupil_row_job *job, const pupil_row *row, uint32_t x,
                                                   uint32_t n, uint32_t weight, pupil_planes *planes,
                                                   pupil_stats *stats)
{
    const size_t bytes = pupil_pixel_bytes(job->in_pixel);
    const pupil_channels light = {planes->r, planes->g, planes->b};
    float picked[4 * MOST_PICKED_IN_ROW];
    const pupil_row some = {.data = (const uint8_t *)picked, .width = MOST_PICKED_IN_ROW};
    weight *= row->bins_rows;
    for (uint32_t i = 0; i < n;) {
        const picks p = picks_from(job, row, i, n, MOST_PICKED_IN_ROW);
        pick_pixels(row->data + x * bytes, bytes, &p, (uint8_t *)picked);
        (void)PUPIL_PIECE(job->kernels, load[job->in_pixel])(job->coder, &some, 0, p.count, planes);
        add_bins(job, &light, p.count, weight * p.group, stats);
        i += p.count * p.group;
    }
}

static int is_counted(const pupil_row_job *job, const pupil_row *row)
{
    return job->histogram && row->bins_rows;
}

static void meter_block(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes,
                        uint32_t weight, pupil_run *run, pupil_stats *stats)
{
    const pupil_kernels *k = job->kernels;
    (void)load(job, row, x, n, planes, stats);
    if (is_counted(job, row))
        count_in_planes(job, row, n, weight, planes, stats);
    k->meter[PUPIL_PLANES](job, 0, planes, n, run);
}

/* What maps a job's blocks. */
typedef struct mapper {
    pupil_scale_kernel *direct, *planar; /* from the format, where there is such a piece; from planes */
    pupil_store_kernel *store;
    pupil_alpha_kernel *alpha;
    int histogram; /* the row is counted */
    int dither;
    int to_light; /* alpha is a float or a half */
} mapper;

/* Whether a level can map without planes. */
static int is_direct(const pupil_row_job *job)
{
    return job->kernels->scale[job->in_pixel] && !job->to_picture && !job->curve->knot;
}

static inline mapper mapper_of(const pupil_row_job *job, const pupil_row *row, int metered)
{
    const pupil_kernels *k = job->kernels;
    const int histogram = metered && is_counted(job, row);
    const int direct = is_direct(job) && !(histogram && job->histogram == 1);
    return (mapper){
        .direct = direct ? k->scale[job->in_pixel] : 0,
        .planar = job->curve->knot ? k->scale_by_knots : k->scale[PUPIL_PLANES],
        .store = PUPIL_PIECE(k, store[job->out_pixel]),
        .alpha = job->out_pixel == PUPIL_PIXEL_RGBA8 ? PUPIL_PIECE(k, alpha[job->in_pixel]) : 0,
        .to_light = pupil_kernels_scalar.store_alpha[job->out_pixel] && pupil_kernels_scalar.alpha_light[job->in_pixel],
        .histogram = histogram,
        .dither = job->curve->dither && pupil_pixel_bytes(job->out_pixel) <= 4}; /* codes: light takes 6 or more */
}

/* Loads a block to planes, and scales these. 1: opaque. */
static int load_and_scale(const pupil_row_job *job, const mapper *with, const pupil_row *row, uint32_t x, uint32_t n,
                          pupil_planes *planes, uint32_t weight, pupil_run *run, pupil_stats *stats)
{
    const int opaque = load(job, row, x, n, planes, stats);
    if (with->histogram)
        count_in_planes(job, row, n, weight, planes, stats);
    if (job->to_picture) {
        if (run)
            job->kernels->meter[PUPIL_PLANES](job, 0, planes, n, run);
        PUPIL_PIECE(job->kernels, to_picture)(job->to_picture, n, planes);
        with->planar(job->picture, 0, n, planes, 0);
        return opaque;
    }
    with->planar(job, 0, n, planes, run);
    return opaque;
}

static __attribute__((noinline)) void store_alpha(const pupil_row_job *job, const void *source, uint32_t n,
                                                  float *alpha, void *target)
{
    PUPIL_PIECE(job->kernels, alpha_light[job->in_pixel])(source, n, alpha);
    PUPIL_PIECE(job->kernels, store_alpha[job->out_pixel])(alpha, n, target);
}

/* run NULL: not metered. */
static __attribute__((noinline)) void map_blocks(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n,
                                                 uint8_t *target, pupil_planes *planes, uint32_t weight, pupil_run *run,
                                                 pupil_stats *stats)
{
    const size_t in_bytes = pupil_pixel_bytes(job->in_pixel), out_bytes = pupil_pixel_bytes(job->out_pixel);
    const mapper with = mapper_of(job, row, run != 0);
    for (uint32_t end = x + n; x < end; x += n, target += n * out_bytes) {
        n = end - x < PUPIL_BLOCK ? end - x : PUPIL_BLOCK;
        const uint8_t *source = row->data + x * in_bytes;
        const int opaque = with.direct ? with.direct(job, source, n, planes, run)
                                       : load_and_scale(job, &with, row, x, n, planes, weight, run, stats);
        if (with.dither)
            PUPIL_PIECE(job->kernels, dither)(job->encoder->transfer, x, row->y, n, planes);
        with.store(planes, n, job->encoder, target);
        if (opaque)
            continue;
        if (with.alpha)
            with.alpha(source, n, target);
        else if (with.to_light)
            store_alpha(job, source, n, planes->grey, target);
    }
}

/* Pixels are counted after they are mapped: then the mapping kernel fetches them from memory, while it also computes.
 */
static __attribute__((noinline)) void map_and_count(const pupil_row_job *job, const pupil_row *row, uint32_t x,
                                                    uint32_t n, uint8_t *target, pupil_planes *planes, uint32_t weight,
                                                    pupil_run *run, pupil_stats *stats)
{
    const size_t out_bytes = pupil_pixel_bytes(job->out_pixel);
    const uint32_t most = MOST_PICKED_IN_ROW * job->histogram; /* whole blocks */
    for (uint32_t done = 0; done < n; done += most) {
        const uint32_t part = n - done < most ? n - done : most;
        map_blocks(job, row, x + done, part, target + done * out_bytes, planes, weight, run, stats);
        count_in_row(job, row, x + done, part, weight, planes, stats);
    }
}

void pupil_map_planes(const pupil_row_job *job, uint32_t x, uint32_t y, uint32_t n, pupil_planes *planes,
                      const void *source, uint8_t *target)
{
    const mapper with = mapper_of(job, 0, 0);
    if (job->to_picture)
        PUPIL_PIECE(job->kernels, to_picture)(job->to_picture, n, planes);
    with.planar(job->to_picture ? job->picture : job, 0, n, planes, 0);
    if (with.dither)
        PUPIL_PIECE(job->kernels, dither)(job->encoder->transfer, x, y, n, planes);
    with.store(planes, n, job->encoder, target);
    if (source && with.alpha)
        with.alpha(source, n, target);
    else if (source && with.to_light)
        store_alpha(job, source, n, planes->grey, target);
}

/* For a level that goes from samples to lanes in one step, if only some of the pixels are counted, or none. 0: not
 * done. */
static int meter_at_once(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, uint32_t weight,
                         pupil_planes *planes, pupil_run *run, pupil_stats *stats)
{
    const pupil_kernels *k = job->kernels;
    const int counted = is_counted(job, row);
    if ((counted && job->histogram == 1) || job->grey_world || job->coder->lines)
        return 0;
    if (job->way == PUPIL_WAY_BINNED)
        return !counted && k->meter_quads[job->in_pixel] && k->meter_quads[job->in_pixel](job, row, x, n, run);
    if (!k->meter[job->in_pixel])
        return 0;
    k->meter[job->in_pixel](job, row->data + x * pupil_pixel_bytes(job->in_pixel), 0, n, run);
    if (counted)
        count_in_row(job, row, x, n, weight, planes, stats);
    return 1;
}

void pupil_work_run(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, uint8_t *target,
                    uint32_t weight, uint32_t band, pupil_stats *stats)
{
    const int metered = stats && weight;
    PUPIL_PLANES_ALIGNED pupil_planes planes;
    pupil_run run;

    run_clear(&run);
    if (target && metered && is_counted(job, row) && job->histogram > 1 && is_direct(job))
        map_and_count(job, row, x, n, target, &planes, weight, &run, stats);
    else if (target)
        map_blocks(job, row, x, n, target, &planes, weight, metered ? &run : 0, stats);
    else if (!meter_at_once(job, row, x, n, weight, &planes, &run, stats))
        for (uint32_t i = 0; i < n; i += PUPIL_BLOCK)
            meter_block(job, row, x + i, n - i < PUPIL_BLOCK ? n - i : PUPIL_BLOCK, &planes, weight, &run, stats);
    if (metered)
        stats_add_run(stats, &run, n, weight, band);
}
