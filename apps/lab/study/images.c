/* The scene of the study in its two states of light, and their log-averages. */
#include "study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "file/sink/sink_common.h"
#include "refuse.h"

/* --- spheres by formula --- */

typedef struct vec {
    double x, y, z;
} vec;

static double dot(vec a, vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Light of a lamp at `lamp`, of intensity 1, on a surface at p facing n: Lambert's cosine over the square of the way.
 */
static double lit(vec lamp, vec p, vec n)
{
    vec to = {lamp.x - p.x, lamp.y - p.y, lamp.z - p.z};
    double square = dot(to, to), cosine = dot(to, n) / sqrt(square);
    return cosine > 0.0 ? cosine / square : 0.0;
}

/* The surface at (x, y) in -1..1: a wall at z = 0, balls in front of it. */
static void surface(double x, double y, vec *p, vec *n, double albedo[3])
{
    static const struct {
        vec centre;
        double radius, albedo[3];
    } ball[] = {{{0.0, 0.0, 0.3}, 0.42, {0.62, 0.58, 0.50}},
                {{-0.62, 0.45, 0.2}, 0.22, {0.75, 0.22, 0.15}},
                {{0.60, 0.52, 0.2}, 0.25, {0.15, 0.30, 0.72}},
                {{0.55, -0.55, 0.1}, 0.18, {0.25, 0.65, 0.28}}};
    double shade = 0.55 + 0.25 * x + 0.1 * y; /* a smooth gradient on the wall */
    *p = (vec){x, y, 0.0};
    *n = (vec){0.0, 0.0, 1.0};
    albedo[0] = shade;
    albedo[1] = 0.95 * shade;
    albedo[2] = 0.85 * shade;
    for (size_t i = 0; i < sizeof ball / sizeof ball[0]; i++) {
        double dx = x - ball[i].centre.x, dy = y - ball[i].centre.y, r = ball[i].radius;
        double rest = r * r - dx * dx - dy * dy;
        if (rest <= 0.0)
            continue;
        *n = (vec){dx / r, dy / r, sqrt(rest) / r};
        *p = (vec){x, y, ball[i].centre.z + sqrt(rest)};
        memcpy(albedo, ball[i].albedo, sizeof ball[i].albedo);
    }
}

int study_images_reserve(study_images *images, uint32_t width, uint32_t height, pupil_why *why)
{
    size_t samples = (size_t)width * height * 3;
    *images = (study_images){.width = width, .height = height};
    for (int s = 0; s < 2; s++)
        images->state[s] = malloc(samples * sizeof(float));
    if (images->state[0] && images->state[1])
        return 0;
    study_images_free(images);
    return pupil_refuse(why, "not enough memory for two pictures of %lux%lu", (unsigned long)width,
                        (unsigned long)height);
}

int study_images_spheres(study_images *images, uint32_t width, uint32_t height, pupil_why *why)
{
    static const vec left = {-1.6, 0.8, 1.5}, right = {1.5, 0.7, 1.4};
    if (study_images_reserve(images, width, height, why))
        return -1;
    for (uint32_t row = 0; row < height; row++)
        for (uint32_t column = 0; column < width; column++) {
            size_t at = ((size_t)row * width + column) * 3;
            double x = (2.0 * column + 1.0) / width - 1.0, y = 1.0 - (2.0 * row + 1.0) / height, albedo[3];
            vec p, n;
            surface(x, y, &p, &n, albedo);
            double dim = 1.0 * lit(left, p, n) + 0.02, bright = dim + 512.0 * lit(right, p, n);
            for (unsigned k = 0; k < 3; k++) {
                images->state[0][at + k] = (float)(albedo[k] * dim);
                images->state[1][at + k] = (float)(albedo[k] * bright);
            }
        }
    for (int s = 0; s < 2; s++)
        study_images_round(images->state[s], (size_t)width * height * 3);
    return 0;
}

void study_images_free(study_images *images)
{
    free(images->state[0]);
    free(images->state[1]);
    *images = (study_images){0};
}

/* --- half precision --- */

void study_images_round(float *samples, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        float v = fabsf(samples[i]) < 65504.0f ? samples[i] : copysignf(65504.0f, samples[i]);
        int exponent;
        frexpf(v, &exponent);
        /* 11 bits from the leading one; subnormals of binary16 are multiples of 2^-24 */
        int step = exponent - 11 > -24 ? exponent - 11 : -24;
        samples[i] = isnan(samples[i]) ? 0.0f : ldexpf(rintf(ldexpf(v, -step)), step);
    }
}

/* --- metering --- */

void study_images_scale(study_images *images, int shift)
{
    const size_t samples = (size_t)images->width * images->height * 3;
    for (int s = 0; s < 2; s++)
        for (size_t i = 0; i < samples; i++)
            images->state[s][i] = ldexpf(images->state[s][i], shift);
}

int study_lights_meter(study_lights *lights, const study_images *images, int shift)
{
    pupil_t pupil;
    pupil_config_default(&lights->config);
    lights->config.white_mode = PUPIL_WHITE_NONE; /* Reinhard's global operator, and the original study's gamma */
    lights->config.transfer = PUPIL_TRANSFER_GAMMA22;
    lights->config.floor = ldexpf(lights->config.floor, shift);
    int error = pupil_init(&pupil, &lights->config);
    for (int s = 0; s < 2; s++) {
        pupil_image_const image = {.data = images->state[s],
                                   .stride_bytes = (ptrdiff_t)(images->width * 3 * sizeof(float)),
                                   .width = images->width,
                                   .height = images->height,
                                   .pixel = PUPIL_PIXEL_RGB32F};
        pupil_exposure exposure = {0}; /* the level as the library stores it, on its grid of 2^-40 stops */
        pupil_stats_clear(&lights->stats[s]);
        error = error ? error : pupil_meter_rows(&pupil, &image, 0, images->height, &lights->stats[s]);
        error = error ? error : pupil_reset(&pupil);
        error = error ? error : pupil_adapt(&pupil, &lights->stats[s], NULL);
        error = error ? error : pupil_get_exposure(&pupil, &exposure);
        lights->ev[s] = exposure.adapted_ev;
    }
    return error;
}
