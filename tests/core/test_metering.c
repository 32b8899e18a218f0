/* The log-average against long double: relative error at most 1e-7 from the pixels on natural-like frames of a
 * megapixel and 2.5e-7 on any frame; 1e-9 and 5e-8 against the same binary32 luminances.
 */
#include "check.h"
#include "frames.h"
#include "reference.h"

#include <math.h>

enum { NATURAL, ANY };

static double worst[2][2]; /* [kind][from pixels, from floats] */
static const double allowed[2][2] = {{1e-7, 1e-9}, {2.5e-7, 5e-8}};

static void meter(const char *name, int kind, const pupil_config *config, const pupil_image_const *image)
{
    pupil_t pupil;
    pupil_stats stats;
    ref_meter reference;
    double mean = NAN;
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, image, 0, image->height, &stats) == PUPIL_OK);
    ref_meter_frame(config, image, &reference);
    CHECK_MSG(stats.weight == reference.weight && stats.pixels == reference.pixels, "%s: weight", name);
    if (!reference.weight)
        return;
    CHECK(pupil_stats_mean(&stats, 0, 1, &mean) == PUPIL_OK);
    const double off[2] = {ref_relative(mean - reference.mean_of_pixels),
                           ref_relative(mean - reference.mean_of_floats)};
    for (int i = 0; i < 2; i++) {
        worst[kind][i] = fmax(worst[kind][i], off[i]);
        CHECK_MSG(off[i] <= allowed[kind][i], "%s, %ux%u, format %u, stride %td, %s: %g, mean %.12g", name,
                  image->width, image->height, image->pixel, image->stride_bytes, i ? "floats" : "pixels", off[i],
                  mean);
    }
}

static void check_natural(void)
{
    pupil_config config;
    pupil_config_default(&config);
    config.floor = 0x1p-20f;
    for (uint32_t pixel = PUPIL_PIXEL_RGBA32F; pixel <= PUPIL_PIXEL_RGB8; pixel++) {
        const int is_large = pixel == PUPIL_PIXEL_RGBA32F;
        frame f = frame_make(1280, (uint32_t)check_some(820 / (is_large ? 1 : check_every(5))), pixel, 0, pixel & 1);
        frame_lognormal(&f, 0.1, 1 + pixel % 3, check_uniform);
        meter("log-normal", NATURAL, &config, &f.image);
        if (pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_RGB16) {
            frame_gradient(&f, 1e-3, 1);
            meter("gradient", NATURAL, &config, &f.image);
        }
        frame_free(&f);
    }
}

/* One value everywhere, so that rounding does not average out. */
static void check_constants(void)
{
    static const double value[] = {0x1p-30,   0x1p-24, 1e-5,          0x1p-14, 0x1.000002p-14, 1e-3, 0.01, 0.1, 0.18,
                                   0.3333333, 0.5,     0x1.fffffep-1, 1,       0x1.000002p0,   1.7,  2,    3,   100,
                                   65504,     1e6,     0x1p30,        1e10};
    pupil_config config;
    pupil_config_default(&config);
    for (unsigned i = 0; i < sizeof value / sizeof *value; i++)
        for (int low_floor = 0; low_floor < 2; low_floor++) {
            frame f = frame_make(641, 99 / (uint32_t)check_every(3), PUPIL_PIXEL_RGB32F, 0, 0);
            config.floor = low_floor ? 0x1p-30f : 0x1p-14f;
            frame_fill(&f, value[i], value[i], value[i]);
            meter("constant grey", ANY, &config, &f.image);
            frame_fill(&f, value[i], value[i] * 0.7, value[i] * 0.4);
            meter("constant colour", ANY, &config, &f.image);
            frame_free(&f);
        }
    for (unsigned i = 0; i < 300; i++) {
        const double light = exp2(60 * check_uniform() - 30);
        frame f = frame_make(1 + (uint32_t)(check_random() % 200), 17, PUPIL_PIXEL_RGBA32F, 0, 0);
        frame_fill(&f, light * check_uniform(), light * check_uniform(), light * check_uniform());
        meter("constant, random", ANY, &config, &f.image);
        frame_free(&f);
    }
}

static void check_hard(const pupil_config *config, uint32_t width, uint32_t height, uint32_t pixel)
{
    static const double edge[] = {0, 0x1p-149, 0x1p-30, 0x1p-14, 1, 65504, 0x1p30, 1e38, INFINITY, -INFINITY, -1, NAN};
    const size_t padding = 4 * (check_random() % 9);
    frame f = frame_make(width, height, pixel, padding, (int)(check_random() & 1));
    for (unsigned i = 0; i < sizeof edge / sizeof *edge; i++) {
        frame_fill(&f, edge[i], edge[i], edge[i]);
        meter("edge constant", ANY, config, &f.image);
        frame_checker(&f, edge[i], 0.18);
        meter("checkerboard", ANY, config, &f.image);
        frame_one(&f, 0.01, edge[i], check_uniform);
        meter("one pixel", ANY, config, &f.image);
    }
    frame_checker(&f, 0x1p-30, 0x1p30);
    meter("extreme checkerboard", ANY, config, &f.image);
    frame_odd(&f, check_uniform);
    meter("odd", ANY, config, &f.image);
    frame_lognormal(&f, 0.2, 3, check_uniform);
    meter("log-normal", ANY, config, &f.image);
    CHECK(!padding || frame_guards_intact(&f));
    frame_free(&f);
}

static void check_shapes(void)
{
    static const uint32_t size[][2] = {{1, 1},   {2, 1},  {1, 2},   {3, 5},   {15, 3},
                                       {16, 16}, {17, 4}, {31, 64}, {64, 65}, {97, 31}};
    pupil_config config;
    pupil_config_default(&config);
    for (unsigned i = 0; i < sizeof size / sizeof *size; i++)
        for (uint32_t pixel = PUPIL_PIXEL_RGBA32F; pixel <= PUPIL_PIXEL_RGB8; pixel++) {
            if ((i + pixel) % (unsigned)check_every(3))
                continue;
            config.floor = check_random() & 1 ? 0x1p-30f : 0x1p-14f;
            check_hard(&config, size[i][0], size[i][1], pixel);
        }
    check_hard(&config, 641, 79, PUPIL_PIXEL_RGB32F);
}

static void check_extents(void)
{
    static const uint32_t size[][2] = {{641, 479}, {16384, 1}, {1, 16384}, {16384, 5}, {3, 16384}};
    pupil_config config;
    pupil_config_default(&config);
    for (unsigned i = 0; i < sizeof size / sizeof *size; i++)
        for (int odd = 0; odd < 3; odd++) {
            frame f = frame_make(size[i][0], size[i][1], odd ? PUPIL_PIXEL_RGBA32F : PUPIL_PIXEL_RGBA16F, 0, odd == 1);
            if (odd == 2)
                frame_odd(&f, check_uniform);
            else
                frame_lognormal(&f, 0.18, 2, check_uniform);
            meter("extent", ANY, &config, &f.image);
            frame_free(&f);
        }
}

static void check_weights(void)
{
    static const uint32_t size[][2] = {{1, 1}, {3, 5}, {5, 40}, {16, 16}, {33, 7}, {641, 47}};
    pupil_config config;
    for (unsigned i = 0; i < sizeof size / sizeof *size; i++)
        for (int pattern = 0; pattern < 6; pattern++) {
            frame f = frame_make(size[i][0], size[i][1], PUPIL_PIXEL_RGB16, 0, 0);
            pupil_config_default(&config);
            if (pattern == 1)
                CHECK(pupil_metering_centre(&config) == PUPIL_OK);
            if (pattern == 2)
                CHECK(pupil_metering_spot(&config) == PUPIL_OK);
            if (pattern == 3)
                CHECK(pupil_metering_roi(&config, 0.1, 0.7, 0.33, 0.21) == PUPIL_OK);
            for (unsigned cell = 0; pattern >= 4 && cell < 256; cell++)
                config.weight[cell / 16][cell % 16] = (uint8_t)(pattern == 4         ? check_random()
                                                                : check_random() % 3 ? 0
                                                                                     : 255);
            frame_lognormal(&f, 0.1, 2, check_uniform);
            meter("weighted", ANY, &config, &f.image);
            frame_free(&f);
        }
}

static void check_primaries(void)
{
    /* linear sRGB to XYZ, times 100, so that the scaling to a sum of 1 matters */
    static const float matrix[9] = {41.24f, 35.76f, 18.05f, 21.26f, 71.52f, 7.22f, 1.93f, 11.92f, 95.05f};
    pupil_config config;
    frame f = frame_make(640, 360, PUPIL_PIXEL_RGB32F, 0, 0);
    frame_lognormal(&f, 0.18, 2, check_uniform);
    pupil_config_default(&config);
    config.primaries = PUPIL_PRIMARIES_BT2020;
    meter("BT.2020", ANY, &config, &f.image);
    config.primaries = PUPIL_PRIMARIES_MATRIX;
    memcpy(config.rgb_to_xyz, matrix, sizeof matrix);
    meter("matrix", ANY, &config, &f.image);
    frame_free(&f);
}

/* All light and the floor times 2^k moves the mean by k, to the last bit of its fixed point. */
static void check_scaling(void)
{
    pupil_config config;
    double mean[2] = {0};
    pupil_config_default(&config);
    for (int k = -8; k <= 8; k += 4) {
        frame f = frame_make(200, 50, PUPIL_PIXEL_RGB32F, 0, 0);
        const uint64_t random = check_state.random;
        for (int i = 0; i < 2; i++) {
            pupil_t pupil;
            pupil_stats stats;
            check_state.random = random;
            config.floor = (float)ldexp(1, -14 + (i ? k : 0));
            frame_lognormal(&f, ldexp(0.18, i ? k : 0), 2, check_uniform);
            pupil_stats_clear(&stats);
            CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
            CHECK(pupil_meter_rows(&pupil, &f.image, 0, 50, &stats) == PUPIL_OK);
            CHECK(pupil_stats_mean(&stats, 0, 1, &mean[i]) == PUPIL_OK);
        }
        CHECK_MSG(fabs(mean[1] - mean[0] - k) <= 0x1p-40, "k %d: off by %g", k, mean[1] - mean[0] - k);
        frame_free(&f);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_natural();
    check_constants();
    check_shapes();
    check_extents();
    check_weights();
    check_primaries();
    check_scaling();
    printf("log-average, worst relative error: natural megapixel frames %.2g from the pixels (<= 1e-7), %.2g from the "
           "same "
           "floats (<= 1e-9)\n",
           worst[NATURAL][0], worst[NATURAL][1]);
    printf("log-average, worst relative error: any frame %.2g from the pixels (<= 2.5e-7), %.2g from the same floats "
           "(<= 5e-8)\n",
           worst[ANY][0], worst[ANY][1]);
    return check_end();
}
