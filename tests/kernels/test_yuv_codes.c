/* The outermost codes of 8-bit Y'CbCr, by each matrix, range and curve: the same light at every level, and none beyond
 * the entries of x86's table (kernels.h: PUPIL_BEYOND). */
#include <stdio.h>
#include <string.h>

#include "check.h"
#include "core/object.h"
#include "kernels/kernels.h"

static const uint8_t outer[] = {0, 1, 15, 16, 17, 127, 128, 129, 235, 240, 254, 255};
enum { OUTER = sizeof outer };

static void check_bounds(const pupil_coder *c, const pupil_coding *of)
{
    const float y[2] = {(0.0f - c->y_zero) * c->y_unit, (255.0f - c->y_zero) * c->y_unit};
    const float chroma[3] = {c->red_v, c->blue_u, c->green_u + c->green_v};
    for (int i = 0; i < 3; i++) {
        const float reach = chroma[i] < 0.0f ? -128.0f * chroma[i] : 128.0f * chroma[i];
        CHECK_MSG(y[0] - reach >= -(float)PUPIL_BEYOND && y[1] + reach < 255.0f + (float)PUPIL_BEYOND,
                  "matrix %u, range %u: codes from %g to %g", of->matrix, of->range, (double)(y[0] - reach),
                  (double)(y[1] + reach));
    }
}

/* All pairs of outer Cb and Cr with each outer Y', twice as many pixels as pairs. */
static void check_levels(const pupil_coder *c, const pupil_coding *of)
{
    static pupil_planes expected, got;
    uint8_t luma[PUPIL_BLOCK], chroma[PUPIL_BLOCK];
    const pupil_row row = {.data = luma, .chroma = chroma, .width = PUPIL_BLOCK};
    for (uint32_t first = 0; first < OUTER * OUTER * OUTER; first += PUPIL_BLOCK / 2) {
        for (uint32_t i = 0; i < PUPIL_BLOCK; i += 2) {
            const uint32_t k = (first + i / 2) % (OUTER * OUTER * OUTER);
            luma[i] = luma[i + 1] = outer[k % OUTER];
            chroma[i] = outer[k / OUTER % OUTER];
            chroma[i + 1] = outer[k / OUTER / OUTER];
        }
        pupil_kernels_scalar.load[PUPIL_PIXEL_NV12](c, &row, 0, PUPIL_BLOCK, &expected);
        for (uint32_t level = 1; level < PUPIL_LEVEL_COUNT; level++) {
            if (pupil_level_choose(1u << level) != level)
                continue;
            pupil_level_kernels(level)->load[PUPIL_PIXEL_NV12](c, &row, 0, PUPIL_BLOCK, &got);
            CHECK_MSG(!memcmp(got.r, expected.r, sizeof got.r) && !memcmp(got.g, expected.g, sizeof got.g) &&
                          !memcmp(got.b, expected.b, sizeof got.b),
                      "level %u, matrix %u, range %u, light %u, from combination %u", level, of->matrix, of->range,
                      of->light, first);
        }
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t light = 0; light < PUPIL_LIGHT_COUNT; light++)
        for (uint32_t matrix = 0; matrix < PUPIL_MATRIX_COUNT; matrix++)
            for (uint32_t range = 0; range < PUPIL_RANGE_COUNT; range++) {
                const pupil_coding coding = {.matrix = matrix, .range = range, .light = light};
                pupil_coder coder;
                pupil_coder_make(&coding, PUPIL_PIXEL_NV12, &coder);
                check_levels(&coder, &coding);
                if (PUPIL_BEYOND > 0 && coder.top == 255.0f)
                    check_bounds(&coder, &coding);
            }
    return check_end();
}
