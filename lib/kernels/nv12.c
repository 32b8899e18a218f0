/* Display codes to Y' Cb Cr 4:2:0. */
#include "kernels.h"

static inline uint8_t byte_of(int32_t x)
{
    return (uint8_t)(x < 0 ? 0 : x > 255 ? 255 : x);
}

static void store_luma(const pupil_chroma_coder *c, const uint8_t *restrict rgba, uint32_t n, uint8_t *restrict luma)
{
    for (uint32_t i = 0; i < n; i++) {
        const uint8_t *p = rgba + 4 * (size_t)i;
        luma[i] = byte_of((c->y[0] * p[0] + c->y[1] * p[1] + c->y[2] * p[2] + c->y_zero) >> 16);
    }
}

/* Of four pixels: (128 and a half) * 4 in 2^-16, and a quarter of the sum. */
static inline uint8_t chroma_of(const int32_t factor[3], const int32_t sum[3])
{
    return byte_of((factor[0] * sum[0] + factor[1] * sum[1] + factor[2] * sum[2] + (257 << 17)) >> 18);
}

static void store_chroma(const pupil_chroma_coder *c, const uint8_t *restrict upper, const uint8_t *restrict lower,
                         uint32_t n, uint8_t *restrict chroma)
{
    for (uint32_t i = 0; i < n; i += 2) {
        const size_t left = 4 * (size_t)i,
                     right = i + 1 < n ? left + 4 : left; /* an odd width's last pixel counts twice */
        int32_t sum[3];
        for (int k = 0; k < 3; k++)
            sum[k] = upper[left + k] + upper[right + k] + lower[left + k] + lower[right + k];
        chroma[i] = chroma_of(c->cb, sum);
        chroma[i + 1] = chroma_of(c->cr, sum);
    }
}

/* Block by block: both rows as RGBA codes, in the L1 cache, and from these the planes. */
void pupil_map_nv12(const pupil_row_job *job, const pupil_chroma_coder *coder, const pupil_row *upper,
                    const pupil_row *lower, uint32_t n, uint8_t *y_upper, uint8_t *y_lower, uint8_t *chroma)
{
    uint8_t codes[2][PUPIL_BLOCK * 4];
    for (uint32_t x = 0; x < n; x += PUPIL_BLOCK) {
        const uint32_t m = n - x < PUPIL_BLOCK ? n - x : PUPIL_BLOCK;
        pupil_work_run(job, upper, x, m, codes[0], 0, 0, 0);
        store_luma(coder, codes[0], m, y_upper + x);
        if (lower) {
            pupil_work_run(job, lower, x, m, codes[1], 0, 0, 0);
            store_luma(coder, codes[1], m, y_lower + x);
        }
        store_chroma(coder, codes[0], codes[lower ? 1 : 0], m, chroma + x);
    }
}
