/* Maps two rows at a time to the planes of NV12 or I420: each block becomes RGBA codes in the L1 cache, and these
 * become Y', Cb and Cr. */
#include "kernels.h"

static void part_planes(const uint8_t *restrict both, uint32_t pairs, uint8_t *restrict cb, uint8_t *restrict cr)
{
    for (uint32_t i = 0; i < pairs; i++) {
        cb[i] = both[2 * i];
        cr[i] = both[2 * i + 1];
    }
}

void pupil_yuv_of_codes(const pupil_kernels *kernels, const pupil_chroma_coder *coder, const uint8_t *upper,
                        const uint8_t *lower, uint32_t n, const pupil_yuv_rows *to)
{
    uint8_t both[PUPIL_BLOCK];
    PUPIL_PIECE(kernels, luma_of_codes)(coder, upper, n, to->upper);
    if (lower)
        PUPIL_PIECE(kernels, luma_of_codes)(coder, lower, n, to->lower);
    PUPIL_PIECE(kernels, chroma_of_codes)(coder, upper, lower ? lower : upper, n, to->cr ? both : to->chroma);
    if (to->cr)
        part_planes(both, (n + 1) / 2, to->chroma, to->cr);
}

void pupil_map_yuv(const pupil_row_job *job, const pupil_chroma_coder *coder, const pupil_row *upper,
                   const pupil_row *lower, uint32_t x, uint32_t end, const pupil_yuv_rows *to)
{
    pupil_luma_kernel *luma_of_codes = PUPIL_PIECE(job->kernels, luma_of_codes);
    pupil_chroma_kernel *chroma_of_codes = PUPIL_PIECE(job->kernels, chroma_of_codes);
    uint8_t codes[2][PUPIL_BLOCK * 4], both[PUPIL_BLOCK];
    for (; x < end; x += PUPIL_BLOCK) {
        const uint32_t m = end - x < PUPIL_BLOCK ? end - x : PUPIL_BLOCK;
        pupil_work_run(job, upper, x, m, codes[0], 0, 0, 0);
        luma_of_codes(coder, codes[0], m, to->upper + x);
        if (to->lower) {
            pupil_work_run(job, lower, x, m, codes[1], 0, 0, 0);
            luma_of_codes(coder, codes[1], m, to->lower + x);
        }
        chroma_of_codes(coder, codes[0], codes[to->lower ? 1 : 0], m, to->cr ? both : to->chroma + x);
        if (to->cr)
            part_planes(both, (m + 1) / 2, to->chroma + x / 2, to->cr + x / 2);
    }
}
