/* A run of pixels of one row through the kernels, block by block, and what it adds to the statistics. */
#include "kernels.h"

#include "../core/numeric.h"

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

static void stats_add_run(pupil_stats *stats, const pupil_run *run, uint32_t n, uint32_t weight, uint32_t band)
{
    uint64_t frac;
    int64_t whole = run_log2(run, &frac);
    uint64_t low = stats->log2_frac + frac * weight;

    stats->log2_sum += whole * (int64_t)weight + (int64_t)(low >> 40);
    stats->log2_frac = low & ((UINT64_C(1) << 40) - 1);
    stats->pixels += n;
    stats->weight += (uint64_t)n * weight;
    stats->black += run->black;
    stats->clipped += run->clipped;
    stats->bad += run->bad;
    /* unsigned, because nobody has checked the bands of a caller's statistics yet */
    stats->band_log2_sum[band] =
        (int64_t)((uint64_t)stats->band_log2_sum[band] + (uint64_t)(whole * (1 << 24) + (int64_t)(frac >> 16)));
    stats->band_pixels[band] += n;
}

/* A piece of a level, or the scalar level's where it has none of its own. */
#define PIECE(KERNELS, MEMBER) ((KERNELS)->MEMBER ? (KERNELS)->MEMBER : pupil_kernels_scalar.MEMBER)

static void meter_block(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes, uint32_t weight,
                        pupil_run *run, pupil_stats *stats)
{
    const pupil_kernels *k = job->kernels;
    if (k->meter[job->in_pixel] && !job->histogram) {
        k->meter[job->in_pixel](job, source, 0, n, run);
        return;
    }
    PIECE(k, load[job->in_pixel])(source, n, planes);
    if (job->histogram)
        PIECE(k, histogram)(job, planes, n, weight, stats);
    k->meter[PUPIL_PLANES](job, 0, planes, n, run);
}

/* run NULL: not metered. */
static void map_block(const pupil_row_job *job, const void *source, void *target, uint32_t n, pupil_planes *planes,
                      uint32_t weight, pupil_run *run, pupil_stats *stats)
{
    const pupil_kernels *k = job->kernels;
    const int bins = run && job->histogram;
    int opaque;
    if (k->scale[job->in_pixel] && !bins) {
        opaque = k->scale[job->in_pixel](job, source, n, planes, run);
    } else {
        opaque = PIECE(k, load[job->in_pixel])(source, n, planes);
        if (bins)
            PIECE(k, histogram)(job, planes, n, weight, stats);
        k->scale[PUPIL_PLANES](job, 0, n, planes, run);
    }
    PIECE(k, store[job->out_pixel])(planes, n, job->encoder, target);
    pupil_alpha_kernel *alpha = PIECE(k, alpha[job->in_pixel]);
    if (job->out_pixel == PUPIL_PIXEL_RGBA8 && alpha && !opaque)
        alpha(source, n, target);
}

void pupil_work_run(const pupil_row_job *job, const uint8_t *source, uint8_t *target, uint32_t n, uint32_t weight,
                    uint32_t band, pupil_stats *stats)
{
    const size_t in_bytes = pupil_pixel_bytes(job->in_pixel), out_bytes = pupil_pixel_bytes(job->out_pixel);
    const int metered = stats && weight;
    pupil_planes planes;
    pupil_run run;

    run_clear(&run);
    if (!target && job->kernels->meter[job->in_pixel] && !job->histogram) {
        job->kernels->meter[job->in_pixel](job, source, 0, n, &run);
        if (metered)
            stats_add_run(stats, &run, n, weight, band);
        return;
    }
    for (uint32_t x = 0; x < n; x += PUPIL_BLOCK) {
        uint32_t m = n - x < PUPIL_BLOCK ? n - x : PUPIL_BLOCK;
        if (target)
            map_block(job, source + x * in_bytes, target + x * out_bytes, m, &planes, weight, metered ? &run : 0,
                      stats);
        else
            meter_block(job, source + x * in_bytes, m, &planes, weight, &run, stats);
    }
    if (metered)
        stats_add_run(stats, &run, n, weight, band);
}
