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

void pupil_work_run(const pupil_row_job *job, const uint8_t *source, uint8_t *target, uint32_t n, uint32_t weight,
                    uint32_t band, pupil_stats *stats)
{
    const pupil_kernels *k = job->kernels;
    const size_t in_bytes = pupil_pixel_bytes(job->in_pixel), out_bytes = pupil_pixel_bytes(job->out_pixel);
    float r[PUPIL_BLOCK], g[PUPIL_BLOCK], b[PUPIL_BLOCK], luminance[PUPIL_BLOCK];
    pupil_run run;

    run_clear(&run);
    for (uint32_t x = 0; x < n; x += PUPIL_BLOCK) {
        uint32_t m = n - x < PUPIL_BLOCK ? n - x : PUPIL_BLOCK;
        const uint8_t *in = source + x * in_bytes;

        k->load[job->in_pixel](in, m, r, g, b);
        k->luminance(job->luma, r, g, b, m, luminance);
        if (stats && weight) {
            k->meter(luminance, r, g, b, m, job->floor, job->clip, &run);
            if (job->histogram)
                k->histogram(luminance, r, g, b, m, job->floor, weight, stats);
        }
        if (target) {
            uint8_t *out = target + x * out_bytes;
            k->tone(r, g, b, luminance, m, job->curve);
            k->store[job->out_pixel](r, g, b, m, job->encoder, out);
            if (job->out_pixel == PUPIL_PIXEL_RGBA8 && k->alpha[job->in_pixel])
                k->alpha[job->in_pixel](in, m, out);
        }
    }
    if (stats && weight)
        stats_add_run(stats, &run, n, weight, band);
}
