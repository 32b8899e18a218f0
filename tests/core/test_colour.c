/* What mapping keeps: grey, the order of brightness, and frames that are already well exposed.
 */
#include "check.h"
#include "frames.h"
#include "reference.h"

#include <math.h>
#include <string.h>

static void map(const pupil_config *config, const pupil_curve *curve, const frame *in, frame *out)
{
    const pupil_image to = frame_writable(out);
    pupil_t pupil;
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, curve, &in->image, &to) == PUPIL_OK);
}

/* Grey in gives equal codes out, and brighter input is never darker. */
static void check_grey(void)
{
    static const pupil_curve curve[] = {{.scale = 1, .inverse_white_squared = 1},
                                        {.scale = 0.3f, .gamut = 4},
                                        {.scale = 7, .inverse_white_squared = 0.01f, .gamut = 3.9f},
                                        {.scale = 100, .inverse_white_squared = 0.0001f, .gamut = 1},
                                        {.scale = 2, .inverse_white_squared = 4}};
    for (uint32_t pixel = PUPIL_PIXEL_RGBA32F; pixel <= PUPIL_PIXEL_RGB8; pixel++)
        for (unsigned i = 0; i < 5; i++)
            for (uint32_t primaries = 0; primaries < 4; primaries++) {
                frame in = frame_make(4096, 1, pixel, 0, 0), out = frame_make(4096, 1, PUPIL_PIXEL_RGB8, 0, 0);
                const unsigned char *code = frame_writable(&out).data;
                pupil_config config;
                unsigned wrong = 0;
                pupil_config_default(&config);
                config.primaries = primaries % 2;
                config.output_primaries = primaries < 2 ? PUPIL_OUTPUT_AS_INPUT : 3 - primaries % 2 - 1;
                config.transfer = i % PUPIL_TRANSFER_COUNT;
                for (uint32_t x = 0; x < 4096; x++) {
                    const double light = exp2(x / 4096.0 * 30 - 20);
                    frame_set(&in, x, 0, light, light, light, 1);
                }
                map(&config, &curve[i], &in, &out);
                for (uint32_t x = 0; x < 4096; x++) {
                    wrong += code[3 * x] != code[3 * x + 1] || code[3 * x] != code[3 * x + 2];
                    wrong += x && code[3 * x] < code[3 * x - 3];
                }
                CHECK_MSG(wrong == 0, "format %u, curve %u, primaries %u: %u of 4096", pixel, i, primaries, wrong);
                frame_free(&in);
                frame_free(&out);
            }
}

/* Rec. ITU-R BT.2087-0, Annex 2, table of the matrix from BT.709 to BT.2020, in light of 8 bits; and back, where
 * BT.2020 colours outside BT.709 have a component at 0. */
static void check_primaries(void)
{
    static const double to_bt2020[3][3] = {
        {0.6274, 0.0691, 0.0164}, {0.3293, 0.9195, 0.0880}, {0.0433, 0.0114, 0.8956}};
    const pupil_curve as_it_is = {.scale = 1, .inverse_white_squared = 1}; /* (1 + u) / (1 + u) */
    pupil_config config;
    pupil_config_default(&config);
    config.transfer = PUPIL_TRANSFER_LINEAR;
    frame in = frame_make(3, 1, PUPIL_PIXEL_RGB32F, 0, 0), out = frame_make(3, 1, PUPIL_PIXEL_RGB8, 0, 0);
    const unsigned char *code = frame_writable(&out).data;
    for (uint32_t x = 0; x < 3; x++)
        frame_set(&in, x, 0, x == 0, x == 1, x == 2, 1);
    config.output_primaries = PUPIL_OUTPUT_BT2020;
    map(&config, &as_it_is, &in, &out);
    for (int x = 0; x < 3; x++)
        for (int c = 0; c < 3; c++)
            CHECK_MSG(fabs(code[3 * x + c] - 255 * to_bt2020[x][c]) <= 0.52, "%d %d: %d", x, c, code[3 * x + c]);
    config.primaries = PUPIL_PRIMARIES_BT2020;
    config.output_primaries = PUPIL_OUTPUT_BT709;
    map(&config, &as_it_is, &in, &out);
    for (int x = 0; x < 3; x++)
        for (int c = 0; c < 3; c++)
            CHECK(c == x ? code[3 * x + c] > 200 : code[3 * x + c] < code[4 * x]);
    frame_free(&in);
    frame_free(&out);
}

/* The same light in BT.709 and in BT.2020 has one level. */
static void check_same_light(void)
{
    static const double to_bt2020[9] = {0.627403895935,  0.329283038378,  0.0433130656875,
                                        0.0690972893582, 0.919540395075,  0.0113623155665,
                                        0.0163914388751, 0.0880133078772, 0.895595253248}; /* RP 177 */
    double level[2];
    for (uint32_t primaries = 0; primaries < 2; primaries++) {
        frame in = frame_make(64, 1, PUPIL_PIXEL_RGB32F, 0, 0);
        pupil_config config;
        pupil_stats stats;
        pupil_t pupil;
        for (uint32_t x = 0; x < 64; x++) {
            const double at[3] = {x % 4 / 3.0 + 1e-3, x / 4 % 4 / 3.0 + 1e-3, x / 16 / 3.0 + 1e-3}, *m = to_bt2020;
            double to[3];
            for (int c = 0; c < 3; c++)
                to[c] = primaries ? m[3 * c] * at[0] + m[3 * c + 1] * at[1] + m[3 * c + 2] * at[2] : at[c];
            frame_set(&in, x, 0, to[0], to[1], to[2], 1);
        }
        pupil_config_default(&config);
        config.primaries = primaries;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &in.image, 0, 1, &stats) == PUPIL_OK);
        level[primaries] = ((double)stats.log2_sum + (double)stats.log2_frac * 0x1p-40) / (double)stats.weight;
        frame_free(&in);
    }
    CHECK_MSG(fabs(level[1] - level[0]) <= 1e-7, "%.9f and %.9f", level[0], level[1]);
}

/* The brightest channel in the statistics is the picture's, regardless of how they were made; the rest of the
 * statistics does not depend on output_primaries. */
static void check_peak(uint32_t pixel, uint32_t primaries, uint32_t output_primaries)
{
    const pupil_coding pq = {.light = PUPIL_LIGHT_PQ, .matrix = PUPIL_MATRIX_BT2020, .range = PUPIL_RANGE_FULL};
    const pupil_curve curve = {.scale = 0.5f};
    frame in = frame_make(300, 40, pixel, 0, 0), out = frame_make(300, 40, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image to = frame_writable(&out);
    pupil_stats as_input, metered, fused;
    pupil_config config;
    pupil_t pupil;
    long double most = 0;
    in.image.coding = &pq;
    for (uint32_t y = 0; y < 40; y++)
        for (uint32_t x = 0; x < 300; x++)
            frame_set(&in, x, y, check_uniform(), 0.1 * check_uniform(), check_uniform(), 1);
    pupil_config_default(&config);
    config.primaries = primaries;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&as_input);
    CHECK(pupil_meter_rows(&pupil, &in.image, 0, 40, &as_input) == PUPIL_OK);
    config.output_primaries = output_primaries;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&metered);
    pupil_stats_clear(&fused);
    CHECK(pupil_meter_rows(&pupil, &in.image, 0, 40, &metered) == PUPIL_OK);
    CHECK(pupil_fused_rows(&pupil, &curve, &in.image, 0, 40, &to, &fused) == PUPIL_OK);
    CHECK(memcmp(&metered, &fused, sizeof fused) == 0);
    for (uint32_t y = 0; y < 40; y++)
        for (uint32_t x = 0; x < 300; x++) {
            long double light[4];
            ref_light(&in.image, x, y, 0, light);
            CHECK(ref_to_picture(&config, light));
            for (int c = 0; c < 3; c++)
                most = light[c] > most ? light[c] : most;
        }
    CHECK_MSG(fabsl(metered.peak / most - 1) < 4e-6L, "format %u: %g, not %Lg", pixel, metered.peak, most);
    CHECK(fabs((double)(as_input.peak / metered.peak) - 1) > 0.01);
    metered.peak = as_input.peak;
    memcpy(metered.peak_bin, as_input.peak_bin, sizeof metered.peak_bin);
    CHECK(memcmp(&metered, &as_input, sizeof metered) == 0);
    frame_free(&in);
    frame_free(&out);
}

/* A frame that is already well exposed, with white point 1: any channel changes by at most one code. Also with the
 * default, a following white point, regardless of the clipped share. */
static void check_identity(uint32_t pixel, uint32_t white_mode, uint32_t order, double clipped)
{
    pupil_config config;
    pupil_t pupil;
    ref_meter meter;
    uint32_t changed = 0, most = 0;
    frame in = frame_make(256, 192, pixel, 0, 0);
    frame out = frame_make(256, 192, pixel == PUPIL_PIXEL_RGBA8 ? PUPIL_PIXEL_RGBA8 : PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image to = frame_writable(&out);
    if (pixel == PUPIL_PIXEL_RGB16 || pixel == PUPIL_PIXEL_RGBA16)
        frame_lognormal(&in, 0.2, 1.5, check_uniform);
    else
        frame_bits(&in, check_uniform);
    for (uint32_t i = 0; i < (uint32_t)(clipped * 256 * 192); i++)
        frame_set(&in, i % 256, i / 256, 1, 1, 1, 1);
    pupil_config_default(&config);
    ref_meter_frame(&config, &in.image, &meter);
    config.key = (double)exp2l(meter.mean_of_floats); /* well exposed: its log-average is the key */
    config.white_mode = white_mode;
    config.order = order;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_process(&pupil, &in.image, NULL, &to) == PUPIL_OK);
    const size_t in_bytes = pupil_pixel_bytes(pixel), out_bytes = pupil_pixel_bytes(to.pixel);
    for (uint32_t i = 0; i < 256 * 192; i++) {
        long double rgba[4];
        const unsigned char *a = (const unsigned char *)in.image.data + i * in_bytes,
                            *b = (const unsigned char *)to.data + i * out_bytes;
        ref_light(&in.image, i % 256, i / 256, 0, rgba);
        for (size_t c = 0; c < out_bytes; c++) {
            const int was = in_bytes == out_bytes ? a[c] : (int)floorl(ref_encode(PUPIL_TRANSFER_SRGB, rgba[c]) + 0.5L);
            const uint32_t change = (uint32_t)abs(was - b[c]);
            changed += change != 0;
            most = change > most ? change : most;
        }
    }
    if (!order)
        printf("format %u, well exposed, white %s, %g %% clipped: at most %u codes of change, %.4f %% of samples\n",
               pixel, white_mode == PUPIL_WHITE_FIXED ? "1" : "following", 100 * clipped, most,
               100.0 * changed / (256 * 192.0 * (double)out_bytes));
    CHECK(most <= 1);
    frame_free(&in);
    frame_free(&out);
}

/* Gamut handling of bright colours needs cones that see all primaries. If a matrix has none, for example only a
 * luminance row, those of BT.709 are used, so all such matrices give the same picture. A sound matrix gives its own. */
static void check_cones(void)
{
    static const struct {
        float x[3], z[3];
    } other_rows[] = {{{0, 0, 0}, {0, 0, 0}},
                      {{-1, -1, -1}, {0, 0, 0}},                    /* negative */
                      {{1e5f, 1e5f, 1e5f}, {0, 0, 0}},              /* far too much */
                      {{1, 0, -0.6f}, {0.1f, 0.2f, 0.3f}},          /* not for each primary */
                      {{0.25f, 0.5f, 0.25f}, {0.25f, 0.5f, 0.25f}}, /* singular */
                      {{0.4f, 0.36f, 0.18f}, {0.02f, 0.12f, 0.95f}}};
    enum { SOUND = 5 };
    const pupil_curve curve = {.scale = 4, .inverse_white_squared = 0.06f, .gamut = 3.5f};
    frame in = frame_make(300, 1, PUPIL_PIXEL_RGB32F, 0, 0), first = frame_make(300, 1, PUPIL_PIXEL_RGBA32F, 0, 0);
    for (uint32_t x = 0; x < 300; x++)
        frame_set(&in, x, 0, 8 * check_uniform(), 8 * check_uniform(), 8 * check_uniform(), 1);
    for (int i = 0; i <= SOUND; i++) {
        frame out = frame_make(300, 1, PUPIL_PIXEL_RGBA32F, 0, 0);
        pupil_config config;
        pupil_config_default(&config);
        config.primaries = PUPIL_PRIMARIES_MATRIX;
        memcpy(config.rgb_to_xyz, other_rows[i].x, sizeof other_rows[i].x);
        memcpy(config.rgb_to_xyz + 3, (const float[3]){0.25f, 0.5f, 0.25f}, 3 * sizeof(float));
        memcpy(config.rgb_to_xyz + 6, other_rows[i].z, sizeof other_rows[i].z);
        map(&config, &curve, &in, i ? &out : &first);
        CHECK_MSG(!i || frame_equal(&first, &out) == (i < SOUND), "matrix %d", i);
        frame_free(&out);
    }
    frame_free(&in);
    frame_free(&first);
}

/* A mosaic's brightest channel is that of its unconverted quads, regardless of the picture's primaries; without bins,
 * the picture is the same. */
static void check_primaries_and_bins(void)
{
    frame mosaic = frame_make(32, 32, PUPIL_PIXEL_BAYER12, 0, 0), in = frame_make(33, 9, PUPIL_PIXEL_RGB32F, 0, 0);
    frame out[2] = {frame_make(33, 9, PUPIL_PIXEL_RGB8, 0, 0), frame_make(33, 9, PUPIL_PIXEL_RGB8, 0, 0)};
    const pupil_curve curve = {.scale = 1, .gamut = 3};
    pupil_stats stats[2], none;
    frame_lognormal(&mosaic, 0.2, 2, check_uniform);
    frame_lognormal(&in, 0.2, 2, check_uniform);
    for (int i = 0; i < 2; i++) {
        const pupil_image to = frame_writable(&out[i]);
        pupil_config config;
        pupil_t pupil;
        pupil_config_default(&config);
        config.primaries = PUPIL_PRIMARIES_BT2020;
        config.output_primaries = i ? PUPIL_OUTPUT_BT709 : PUPIL_OUTPUT_AS_INPUT;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        pupil_stats_clear(&stats[i]);
        CHECK(pupil_meter_rows(&pupil, &mosaic.image, 0, 32, &stats[i]) == PUPIL_OK && stats[i].has_histogram);
        config.output_primaries = PUPIL_OUTPUT_BT709;
        config.white_mode = i ? PUPIL_WHITE_NONE : PUPIL_WHITE_FOLLOW;
        CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
        pupil_stats_clear(&none);
        CHECK(pupil_fused_rows(&pupil, &curve, &in.image, 0, 9, &to, &none) == PUPIL_OK);
        CHECK(none.has_histogram == !i && (none.peak > 0.0f) == !i);
    }
    CHECK(memcmp(&stats[0], &stats[1], sizeof stats[0]) == 0 && frame_equal(&out[0], &out[1]));
    frame_free(&mosaic);
    frame_free(&in);
    frame_free(&out[0]);
    frame_free(&out[1]);
}

int main(int argc, char **argv)
{
    static const uint32_t pixel[] = {PUPIL_PIXEL_RGB8, PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_RGB16, PUPIL_PIXEL_RGBA16};
    check_begin(argc, argv);
    check_grey();
    check_primaries();
    check_same_light();
    static const uint32_t wide[] = {PUPIL_PIXEL_RGB32F, PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_I444_16};
    for (unsigned i = 0; i < 3; i++) {
        check_peak(wide[i], PUPIL_PRIMARIES_BT2020, PUPIL_OUTPUT_BT709);
        check_peak(wide[i], PUPIL_PRIMARIES_BT709, PUPIL_OUTPUT_BT2020);
    }
    for (unsigned i = 0; i < 4; i++)
        for (uint32_t order = 0; order < PUPIL_ORDER_COUNT; order++) {
            check_identity(pixel[i], PUPIL_WHITE_FIXED, order, 0.05);
            check_identity(pixel[i], PUPIL_WHITE_FOLLOW, order, 0);
            check_identity(pixel[i], PUPIL_WHITE_FOLLOW, order, 0.05);
        }
    check_cones();
    check_primaries_and_bins();
    return check_end();
}
