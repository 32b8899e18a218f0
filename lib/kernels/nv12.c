/* Two rows at a time to the planes of NV12: block by block as RGBA codes, in the L1 cache, and from these Y', Cb and
 * Cr.
 */
#include "kernels.h"

void pupil_map_nv12(const pupil_row_job *job, const pupil_chroma_coder *coder, const pupil_row *upper,
                    const pupil_row *lower, uint32_t n, uint8_t *y_upper, uint8_t *y_lower, uint8_t *chroma)
{
    pupil_luma_kernel *luma_of_codes = PUPIL_PIECE(job->kernels, luma_of_codes);
    pupil_chroma_kernel *chroma_of_codes = PUPIL_PIECE(job->kernels, chroma_of_codes);
    uint8_t codes[2][PUPIL_BLOCK * 4];
    for (uint32_t x = 0; x < n; x += PUPIL_BLOCK) {
        const uint32_t m = n - x < PUPIL_BLOCK ? n - x : PUPIL_BLOCK;
        pupil_work_run(job, upper, x, m, codes[0], 0, 0, 0);
        luma_of_codes(coder, codes[0], m, y_upper + x);
        if (lower) {
            pupil_work_run(job, lower, x, m, codes[1], 0, 0, 0);
            luma_of_codes(coder, codes[1], m, y_lower + x);
        }
        chroma_of_codes(coder, codes[0], codes[lower ? 1 : 0], m, chroma + x);
    }
}
