/* The display frame against long double: never more than one code off, for every format in and out, every transfer and
 * every white point; odd pixels; alpha; padding untouched.
 */
#include "check.h"
#include "frames.h"
#include "reference.h"

#include <math.h>

static uint64_t codes, off_by_one;
static double beyond; /* the largest error against the reference's real-valued code, in codes, less the unavoidable
                       * 0.5 */

static void pixel_codes(const pupil_image *out, uint32_t x, uint32_t y, int code[4])
{
    const size_t bytes = pupil_pixel_bytes(out->pixel);
    const unsigned char *at = (const unsigned char *)out->data + (ptrdiff_t)y * out->stride_bytes + x * bytes;
    const int swapped = out->pixel == PUPIL_PIXEL_BGRX8;
    code[0] = at[swapped ? 2 : 0];
    code[1] = at[1];
    code[2] = at[swapped ? 0 : 2];
    code[3] = bytes == 4 ? at[3] : -1;
}

static void compare(const char *name, const pupil_config *config, const pupil_curve *curve, const frame *in,
                    const frame *out)
{
    const pupil_image to = frame_writable(out);
    pupil_t pupil;
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, curve, &in->image, &to) == PUPIL_OK);
    for (uint32_t y = 0; y < to.height; y++)
        for (uint32_t x = 0; x < to.width; x++) {
            long double rgba[4], wanted[3];
            int code[4];
            ref_light(&in->image, x, y, 0, rgba);
            ref_map(config, curve, rgba, wanted);
            pixel_codes(&to, x, y, code);
            for (int c = 0; c < 3; c++) {
                const int right = (int)floorl(wanted[c] + 0.5L);
                codes++;
                off_by_one += code[c] != right;
                if (code[c] != right)
                    beyond = fmax(beyond, (double)fabsl(code[c] - wanted[c]) - 0.5);
                CHECK_MSG(abs(code[c] - right) <= 1,
                          "%s, format %u to %u, transfer %u, curve %g %g: %Lg %Lg %Lg channel %d is %d, wanted %Lg",
                          name, in->image.pixel, to.pixel, config->transfer, curve->scale, curve->inverse_white_squared,
                          rgba[0], rgba[1], rgba[2], c, code[c], wanted[c]);
            }
            if (to.pixel == PUPIL_PIXEL_BGRX8)
                CHECK(code[3] == 255);
            if (to.pixel == PUPIL_PIXEL_RGBA8)
                /* rounded in binary32: 2^-16 of a code is half an ulp of 255 */
                CHECK_MSG(fabsl(code[3] - ref_alpha(rgba)) <= 0.5L + 0x1p-16L, "%s, format %u: alpha %Lg became %d",
                          name, in->image.pixel, rgba[3], code[3]);
        }
    CHECK(frame_guards_intact(out));
}

static void check_all_formats(void)
{
    static const pupil_curve curve[] = {{.scale = 1, .inverse_white_squared = 1},
                                        {.scale = 0.18f, .gamut = 4},
                                        {.scale = 2.5f, .inverse_white_squared = 0.0625f, .gamut = 3.7f},
                                        {.scale = 40, .inverse_white_squared = 1e-3f, .gamut = 3.97f},
                                        {.scale = 0.004f, .inverse_white_squared = 0.3f, .gamut = 0.01f},
                                        {.scale = 1e-6f, .gamut = 16},
                                        {.scale = 3e5f, .inverse_white_squared = 1e-12f}};
    for (uint32_t from = PUPIL_PIXEL_RGBA32F; from <= PUPIL_PIXEL_RGB8; from++)
        for (uint32_t to = PUPIL_PIXEL_RGBA8; to <= PUPIL_PIXEL_BGRX8; to++)
            for (unsigned i = 0; i < sizeof curve / sizeof *curve; i++) {
                const uint32_t width = 1 + (uint32_t)(check_random() % 90),
                               height = 1 + (uint32_t)(check_random() % 40);
                frame in = frame_make(width, height, from, 4 * (check_random() % 3), (int)(check_random() & 1));
                frame out = frame_make(width, height, to, check_random() % 7, (int)(check_random() & 1));
                pupil_config config;
                pupil_config_default(&config);
                config.transfer = (uint32_t)((i + from + to) % PUPIL_TRANSFER_COUNT);
                if (check_random() % 4 == 0)
                    config.primaries = PUPIL_PRIMARIES_BT2020;
                config.output_primaries = (uint32_t)((i + from) % PUPIL_OUTPUT_COUNT);
                frame_lognormal(&in, 0.18 / curve[i].scale, 2.5, check_uniform);
                compare("log-normal", &config, &curve[i], &in, &out);
                frame_odd(&in, check_uniform);
                compare("odd", &config, &curve[i], &in, &out);
                frame_bits(&in, check_uniform);
                compare("any bits", &config, &curve[i], &in, &out);
                frame_free(&in);
                frame_free(&out);
            }
}

/* A table of random values, at any scale: every format, odd pixels. */
static void check_knots(void)
{
    for (uint32_t from = PUPIL_PIXEL_RGBA32F; from <= PUPIL_PIXEL_RGB8; from++)
        for (int turn = 0; turn < 6; turn++) {
            frame in = frame_make(301, 3, from, 4, turn & 1), out = frame_make(301, 3, PUPIL_PIXEL_RGB8, 1, 0);
            pupil_curve curve = {.size_bytes = sizeof curve, .scale = 1, .gamut = 4, .knots = PUPIL_CURVE_KNOTS};
            pupil_config config;
            curve.knot_scale = (float)exp2(turn * 4.3);
            for (int k = 0; k < PUPIL_CURVE_KNOTS; k++)
                curve.knot[k] = turn % 3 ? (float)pow(k / 127.0, turn) : (float)check_uniform();
            pupil_config_default(&config);
            config.transfer = (uint32_t)turn % PUPIL_TRANSFER_COUNT;
            config.output_primaries = (uint32_t)turn % PUPIL_OUTPUT_COUNT;
            frame_gradient(&in, 1e-6, 1e3);
            compare("knots, gradient", &config, &curve, &in, &out);
            frame_lognormal(&in, 0.2, 3, check_uniform);
            compare("knots, log-normal", &config, &curve, &in, &out);
            frame_odd(&in, check_uniform);
            compare("knots, odd", &config, &curve, &in, &out);
            frame_free(&in);
            frame_free(&out);
        }
}

/* Widths around each power of two, up to the longest buffer of a mapper. */
static void check_widths(void)
{
    const pupil_curve curve = {.scale = 0.8f, .inverse_white_squared = 0.04f, .gamut = 3.8f};
    pupil_config config;
    pupil_config_default(&config);
    for (uint32_t width = 1; width <= 1100; width += width < 70 ? 1 : 79) {
        frame in = frame_make(width, 2, PUPIL_PIXEL_RGB32F, 0, 0), out = frame_make(width, 2, PUPIL_PIXEL_RGB8, 0, 0);
        frame_lognormal(&in, 0.3, 2, check_uniform);
        compare("width", &config, &curve, &in, &out);
        frame_free(&in);
        frame_free(&out);
    }
    frame in = frame_make(PUPIL_MAX_SIDE_PX, 2, PUPIL_PIXEL_RGBA16F, 0, 1),
          out = frame_make(PUPIL_MAX_SIDE_PX, 2, PUPIL_PIXEL_BGRX8, 0, 0);
    frame_lognormal(&in, 0.3, 2, check_uniform);
    compare("widest", &config, &curve, &in, &out);
    frame_free(&in);
    frame_free(&out);
}

/* Curves at the limits of what a config allows: nothing overflows to black. */
static void check_extreme_curves(void)
{
    static const float scale[] = {0, 0x1p-149f, 0x1p-100f, 0x1p-30f, 1, 0x1p30f, 0x1p60f},
                       white[] = {0, 0x1p-60f, 1, 0x1p16f};
    static const double light[] = {0, 0x1p-30, 0x1p-14, 0.18, 1, 1000, 0x1p30, 3e38, INFINITY};
    pupil_config config;
    pupil_config_default(&config);
    for (unsigned i = 0; i < sizeof scale / sizeof *scale; i++)
        for (unsigned j = 0; j < sizeof white / sizeof *white; j++)
            for (unsigned k = 0; k < sizeof light / sizeof *light; k++) {
                const pupil_curve curve = {
                    .scale = scale[i], .inverse_white_squared = white[j], .gamut = k % 3 ? 0 : 16};
                frame in = frame_make(5, 1, PUPIL_PIXEL_RGB32F, 0, 0), out = frame_make(5, 1, PUPIL_PIXEL_RGB8, 0, 0);
                frame_fill(&in, light[k], light[k], light[k]);
                frame_set(&in, 1, 0, light[k], 0, 0, 1);
                frame_set(&in, 3, 0, 0, light[k], light[k] / 2, 1);
                compare("extreme", &config, &curve, &in, &out);
                frame_free(&in);
                frame_free(&out);
            }
}

/* Without the reference: what anyone would expect. */
static void check_examples(void)
{
    static const double input[][3] = {{0, 0, 0},
                                      {-0.0, 0, 0},
                                      {-3, -3, -3},
                                      {NAN, NAN, NAN},
                                      {-INFINITY, -INFINITY, -INFINITY},
                                      {1e-45, 0, 0},
                                      {INFINITY, INFINITY, INFINITY},
                                      {3e38, 3e38, 3e38},
                                      {1e30, 1e30, 1e30},
                                      {0.5, NAN, 0.5}};
    for (uint32_t pixel = PUPIL_PIXEL_RGBA32F; pixel <= PUPIL_PIXEL_RGB32F; pixel++)
        for (int mode = 0; mode < 2; mode++) {
            frame in = frame_make(10, 1, pixel, 0, 0), out = frame_make(10, 1, PUPIL_PIXEL_RGB8, 0, 0);
            const pupil_curve curve = {.scale = 0.7f, .inverse_white_squared = mode ? 0.25f : 0, .gamut = mode ? 3 : 0};
            const pupil_image to = frame_writable(&out);
            const unsigned char *code = to.data;
            pupil_config config;
            pupil_t pupil;
            for (uint32_t i = 0; i < 10; i++)
                frame_set(&in, i, 0, input[i][0], input[i][1], input[i][2], NAN);
            pupil_config_default(&config);
            CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
            CHECK(pupil_map_rows(&pupil, &curve, &in.image, &to) == PUPIL_OK);
            for (int i = 0; i < 27; i++)
                CHECK_MSG(code[i] == (i < 18 ? 0 : 255), "pixel %d channel %d is %d", i / 3, i % 3, code[i]);
            CHECK_MSG(code[28] == 0, "NaN became %d", code[28]);
            frame_free(&in);
            frame_free(&out);
        }
}

static void check_alpha(void)
{
    static const double alpha[] = {0,        1,         0.5,          -1,           2,     NAN,
                                   INFINITY, -INFINITY, 0.0019607842, 0.0019607844, 0.998, 1e-40};
    const pupil_curve curve = {.scale = 1, .inverse_white_squared = 1};
    pupil_config config;
    pupil_config_default(&config);
    for (uint32_t from = PUPIL_PIXEL_RGBA32F; from <= PUPIL_PIXEL_RGB8; from++) {
        frame in = frame_make(256, 256, from, 0, 0), out = frame_make(256, 256, PUPIL_PIXEL_RGBA8, 0, 0);
        for (uint32_t i = 0; i < 65536; i++)
            frame_set(&in, i % 256, i / 256, 0.1, 0.2, 0.3, i < 12 ? alpha[i] : i / 65535.0);
        compare("alpha", &config, &curve, &in, &out);
        frame_free(&in);
        frame_free(&out);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_all_formats();
    check_knots();
    check_widths();
    check_extreme_curves();
    check_examples();
    check_alpha();
    const double share = 100.0 * (double)off_by_one / (double)codes;
    printf("mapping: %llu codes, off by one %.4f %% (<= 0.01 %%), none by more; at most %.2g codes past the "
           "unavoidable 0.5\n",
           (unsigned long long)codes, share, beyond);
    CHECK(share <= 0.01);
    return check_end();
}
