/* Works one row of 1920 pixels by every kernel of 64-bit ARM, between marks that count_plugin.c counts. Prints a line
 * for each: level, what is done, input, output, kind of picture, pixels; the plugin adds the number of instructions,
 * everything included that a row needs. */
#include "kernels.h"

#include <stdio.h>
#include <unistd.h>

enum { WIDTH = 1920 };

static const char *const names[PUPIL_PIXEL_COUNT] = {
    [PUPIL_PIXEL_RGBA32F] = "rgba32f", [PUPIL_PIXEL_RGB32F] = "rgb32f", [PUPIL_PIXEL_RGBA16F] = "rgba16f",
    [PUPIL_PIXEL_RGBA16] = "rgba16",   [PUPIL_PIXEL_RGB16] = "rgb16",   [PUPIL_PIXEL_RGBA8] = "rgba8",
    [PUPIL_PIXEL_RGB8] = "rgb8",       [PUPIL_PIXEL_BGRX8] = "bgrx8",
};

static _Alignas(16) uint8_t source[WIDTH * 16], target[WIDTH * 4];
static uint32_t state;

static uint32_t random_below(uint32_t n) /* Numerical Recipes' generator */
{
    state = state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)state * n >> 32);
}

/* A channel in 1/256 of the clip level. An ordinary picture has most pixels dark, no strong colours, and nothing at the
 * clip level; a hard one has a channel there in one pixel of ten. */
static uint32_t channel(uint32_t of_pixel, int hard)
{
    static uint32_t base;
    if (of_pixel == 0)
        base = 4 + random_below(250) * random_below(250) / 256;
    return hard && random_below(32) == 0 ? 256 : base * (192 + random_below(64)) / 256;
}

/* The channel v / 256 as a binary16; v is 1 to 256. */
static uint16_t half(uint32_t v)
{
    uint32_t exponent = 15, fraction = v << 2;
    for (; fraction < 1024; fraction *= 2)
        exponent--;
    return (uint16_t)(exponent << 10 | (fraction & 1023));
}

static void fill(uint32_t pixel, int hard)
{
    const uint32_t samples =
        pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_RGB16 || pixel == PUPIL_PIXEL_RGB8 ? 3 : 4;
    void *const to = source;
    state = 1;
    for (uint32_t i = 0; i < WIDTH * samples; i++) {
        const uint32_t v = i % samples == 3 ? 256 : channel(i % samples, hard);
        switch (pixel) {
        case PUPIL_PIXEL_RGBA32F:
        case PUPIL_PIXEL_RGB32F:
            ((float *)to)[i] = (float)v * 0x1p-8f;
            break;
        case PUPIL_PIXEL_RGBA16F:
            ((uint16_t *)to)[i] = half(v);
            break;
        case PUPIL_PIXEL_RGBA16:
        case PUPIL_PIXEL_RGB16:
            ((uint16_t *)to)[i] = (uint16_t)(v * 256 - (v == 256));
            break;
        default:
            source[i] = (uint8_t)(v - (v == 256));
        }
    }
}

static void count(const char *level, const char *what, const pupil_row_job *job, int hard, int meters)
{
    pupil_stats stats;
    pupil_stats_clear(&stats);
    printf("%s %s %s %s %s %d ", level, what, names[job->in_pixel], job->curve ? names[job->out_pixel] : "-",
           hard ? "hard" : "ordinary", WIDTH);
    fflush(stdout);
    (void)getppid();
    pupil_work_run(job, source, job->curve ? target : 0, WIDTH, meters, 0, &stats);
    (void)getppid();
}

static void count_level(const char *name, const pupil_kernels *kernels)
{
    static const uint32_t in[] = {PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGB32F, PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_RGBA16,
                                  PUPIL_PIXEL_RGB16,   PUPIL_PIXEL_RGBA8,  PUPIL_PIXEL_RGB8};
    static const uint32_t out[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_BGRX8, PUPIL_PIXEL_RGB8};
    /* middle grey of an average of 1/8; no pixel of an ordinary picture is beyond white */
    const pupil_curve curve = {.scale = 0.18f * 8, .inverse_white_squared = 0.0f};
    for (int hard = 0; hard < 2; hard++)
        for (unsigned i = 0; i < sizeof in / sizeof *in; i++) {
            pupil_row_job job = {.kernels = kernels,
                                 .encoder = &pupil_encoders[PUPIL_TRANSFER_SRGB],
                                 .luma = {0.2126f, 0.7152f, 0.0722f},
                                 .floor = 0x1p-14f,
                                 .clip = 1.0f,
                                 .in_pixel = in[i],
                                 .out_pixel = PUPIL_PIXEL_RGBA8};
            fill(in[i], hard);
            count(name, "meter", &job, hard, 1);
            job.histogram = 1;
            count(name, "meter+histogram", &job, hard, 1);
            job.histogram = 0;
            job.curve = &curve;
            for (unsigned j = 0; j < sizeof out / sizeof *out; j++) {
                job.out_pixel = out[j];
                count(name, "map", &job, hard, 0);
            }
            job.out_pixel = PUPIL_PIXEL_RGBA8;
            count(name, "fused", &job, hard, 1);
        }
}

int main(void)
{
    count_level("neon", &pupil_kernels_neon);
    count_level("scalar", &pupil_kernels_scalar);
    return 0;
}
