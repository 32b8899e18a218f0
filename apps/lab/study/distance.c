/* How far a picture is from its target.
 *
 * The mapping is the one that pupil.h defines, here in double. The library's own, in binary32, differs only in samples
 * on the border of two codes. There rounding changes the distance by a sample or two, up and down, from one binary32
 * scale to the next. "The first frame with D <= 0" would show that instead of the state. The number of differing
 * samples is shown with the tables.
 */
#include "study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/gamut.h"

/* Rec. ITU-R BT.709-6, item 3.2 */
static double luminance(const float *v)
{
    return 0.2126 * (double)v[0] + 0.7152 * (double)v[1] + 0.0722 * (double)v[2];
}

/* Display light of a pixel at scale x: Reinhard's L / (1 + L), and beyond the gamut's knee as pupil_curve defines it
 * without a white point. */
static void display(const float *v, double x, double gamut, double light[3])
{
    double l = luminance(v);
    l = l > 0.0 ? l : 0.0;
    const double s = x / (1.0 + x * l);
    for (unsigned k = 0; k < 3; k++)
        light[k] = v[k] > 0.0f ? (double)v[k] * s : 0.0;
    gamut_fit(0, gamut, l * s, light);
}

static uint8_t code_from(const double *bound, double light, unsigned code)
{
    while (light >= bound[code + 1])
        code++;
    while (light < bound[code])
        code--;
    return (uint8_t)code;
}

int study_target_open(study_target *target, const study_images *images, const study_lights *lights, int light)
{
    *target = (study_target){.pixels = (size_t)images->width * images->height,
                             .rgb = images->state[light],
                             .scale = lights->config.key * exp2(-lights->ev[light]),
                             .gamut = 1.0 / (1.0 - (double)PUPIL_GAMUT_KNEE)};
    target->code = malloc(target->pixels * 3);
    if (!target->code)
        return -1;
    target->bound[0] = -INFINITY;
    target->bound[256] = INFINITY;
    for (unsigned c = 1; c < 256; c++)
        target->bound[c] = pow(((double)c - 0.5) / 255.0, 2.2); /* gamma 2.2, as in the original study */
    for (size_t i = 0; i < target->pixels; i++) {
        double shown[3];
        display(target->rgb + 3 * i, target->scale, target->gamut, shown);
        for (unsigned k = 0; k < 3; k++)
            target->code[3 * i + k] = code_from(target->bound, shown[k], k ? target->code[3 * i + k - 1] : 128);
    }
    return 0;
}

void study_target_close(study_target *target)
{
    free(target->code);
    *target = (study_target){0};
}

uint64_t study_distance(study_target *target, double u, uint64_t limit)
{
    const double x = target->scale * exp(u);
    const uint8_t *code = target->code;
    uint64_t sum = 0;
    target->renders++;
    for (size_t i = 0; i < target->pixels && sum <= limit; i++, code += 3) {
        double shown[3];
        display(target->rgb + 3 * i, x, target->gamut, shown);
        for (unsigned k = 0; k < 3; k++)
            sum += (uint64_t)abs((int)code_from(target->bound, shown[k], code[k]) - (int)code[k]);
    }
    return sum;
}

int study_distance_library(const study_target *target, const study_images *images, const study_lights *lights,
                           int light, uint64_t *differ, unsigned *largest)
{
    const size_t row = (size_t)images->width * 3;
    uint8_t *mapped = malloc(target->pixels * 3);
    pupil_t pupil;
    pupil_curve curve;
    pupil_image_const in = {.data = images->state[light],
                            .stride_bytes = (ptrdiff_t)(row * sizeof(float)),
                            .width = images->width,
                            .height = images->height,
                            .pixel = PUPIL_PIXEL_RGB32F};
    pupil_image out = {.data = mapped,
                       .stride_bytes = (ptrdiff_t)row,
                       .width = images->width,
                       .height = images->height,
                       .pixel = PUPIL_PIXEL_RGB8};
    int error = mapped ? pupil_init(&pupil, &lights->config) : PUPIL_ERR_NULL;
    if (!error)
        error = pupil_adapt(&pupil, &lights->stats[light], NULL);
    if (!error)
        error = pupil_get_curve(&pupil, NULL, &curve);
    if (!error)
        error = pupil_map_rows(&pupil, &curve, &in, &out);
    *differ = 0;
    for (size_t i = 0; !error && i < target->pixels * 3; i++) {
        unsigned off = (unsigned)abs((int)mapped[i] - (int)target->code[i]);
        *differ += off != 0;
        *largest = off > *largest ? off : *largest;
    }
    free(mapped);
    return error;
}
