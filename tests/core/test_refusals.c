/* Every error code, by the misuse that it is for. After each refusal the object, the statistics and the output are
 * unchanged, byte for byte.
 */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

#include <math.h>
#include <stddef.h>

static pupil_t pupil, pupil_before;
static pupil_stats stats, stats_before;
static float in_memory[12 * 4 + 8];
static unsigned char out_memory[12 * 4 + 64], out_before[sizeof out_memory];
static pupil_image_const in;
static pupil_image out;
static const pupil_curve curve = {.scale = 1};

/* 4 x 3 pixels of RGB32F into RGB8, a stream that is two frames old. */
static void fresh(void)
{
    pupil_config config;
    pupil_frame_info info = {.timestamp_ns = 1};
    for (unsigned i = 0; i < sizeof in_memory / sizeof *in_memory; i++)
        in_memory[i] = 0.1f + (float)i / 64;
    memset(out_memory, 0x77, sizeof out_memory);
    in = (pupil_image_const){
        .data = in_memory, .stride_bytes = 4 * 12, .width = 4, .height = 3, .pixel = PUPIL_PIXEL_RGB32F};
    out =
        (pupil_image){.data = out_memory + 16, .stride_bytes = 13, .width = 4, .height = 3, .pixel = PUPIL_PIXEL_RGB8};
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_process(&pupil, &in, &info, &out) == PUPIL_OK);
    info.timestamp_ns = 2;
    CHECK(pupil_process(&pupil, &in, &info, &out) == PUPIL_OK);
    pupil_stats_clear(&stats);
    const pupil_image_const top = pupil_image_rows(in, 0, 1);
    CHECK(pupil_meter_rows(&pupil, &top, 0, 3, &stats) == PUPIL_OK);
}

static void remember(void)
{
    pupil_before = pupil;
    stats_before = stats;
    memcpy(out_before, out_memory, sizeof out_memory);
}

/* Objects have padding between their fields, which is never set. */
#define ANY_BYTES
#if defined __has_feature
#if __has_feature(memory_sanitizer)
#undef ANY_BYTES
#define ANY_BYTES __attribute__((no_sanitize("memory")))
#endif
#endif
ANY_BYTES static int same(const void *a, const void *b, size_t bytes)
{
    const unsigned char *p = a, *q = b;
    while (bytes && *p++ == *q++)
        bytes--;
    return !bytes;
}

static void expect(int got, int wanted, const char *what)
{
    CHECK_MSG(got == wanted, "%s: %d, wanted %d", what, got, wanted);
    CHECK_MSG(same(&pupil, &pupil_before, sizeof pupil), "%s: the object was touched", what);
    CHECK_MSG(same(&stats, &stats_before, sizeof stats), "%s: the statistics were touched", what);
    CHECK_MSG(same(out_memory, out_before, sizeof out_memory), "%s: the output was touched", what);
}

/* All calls that take images, with the same wrong images. */
static void expect_images(const pupil_image_const *i, const pupil_image *o, int wanted, const char *what)
{
    remember();
    expect(pupil_process(&pupil, i, NULL, o), wanted, what);
    if (o == &out)
        expect(pupil_meter(&pupil, i, NULL), wanted, what);
    expect(pupil_map_rows(&pupil, &curve, i, o), wanted, what);
    pupil_image_const row = i ? *i : in;
    row.height = row.height != 0;
    pupil_image to = o ? *o : out;
    to.height = o ? to.height != 0 : 1;
    if (wanted == PUPIL_ERR_STRIDE) /* a single row cannot overlap itself */
        return;
    if (i && o && i->height == o->height)
        expect(pupil_fused_rows(&pupil, &curve, &row, 1, 3, &to, &stats), wanted, what);
    CHECK(pupil_frame_begin(&pupil, 4, 3, NULL) == PUPIL_OK);
    remember();
    if (i && o && i->width == 4 && o->height == i->height)
        expect(pupil_frame_rows(&pupil, &row, 1, &to), wanted, what);
    CHECK(pupil_frame_cancel(&pupil) == PUPIL_OK);
}

static void check_images(void)
{
    static const uint32_t not_in[] = {PUPIL_PIXEL_NONE, PUPIL_PIXEL_COUNT + 1, PUPIL_PIXEL_COUNT, 77, 0xffffffff};
    static const uint32_t not_out[] = {PUPIL_PIXEL_NONE, PUPIL_PIXEL_RGBX8, PUPIL_PIXEL_RGB16, PUPIL_PIXEL_COUNT,
                                       0xffffffff};
    static const uint32_t side[] = {0, PUPIL_MAX_SIDE_PX + 1, 0x10000, 0xffffffff};
    fresh();
    pupil_image_const i = in;
    pupil_image o = out;
    expect_images(NULL, &out, PUPIL_ERR_NULL, "no input");
    i.data = NULL;
    expect_images(&i, &out, PUPIL_ERR_NULL, "input without data");
    remember();
    expect(pupil_process(&pupil, &in, NULL, NULL), PUPIL_ERR_NULL, "no output");
    expect(pupil_map_rows(&pupil, &curve, &in, NULL), PUPIL_ERR_NULL, "no output");
    o.data = NULL;
    expect_images(&in, &o, PUPIL_ERR_NULL, "output without data");
    for (unsigned k = 0; k < 5; k++) {
        i = in;
        i.pixel = not_in[k];
        expect_images(&i, &out, PUPIL_ERR_PIXEL, "input format");
        o = out;
        o.pixel = not_out[k];
        expect_images(&in, &o, PUPIL_ERR_PIXEL_OUT, "output format");
    }
    for (unsigned k = 0; k < 4; k++) {
        i = in;
        o = out;
        i.width = o.width = side[k];
        i.stride_bytes = o.stride_bytes = 1 << 20;
        expect_images(&i, &o, PUPIL_ERR_SIZE, "width");
        i.width = o.width = 4;
        i.height = o.height = side[k];
        remember();
        expect(pupil_process(&pupil, &i, NULL, &o), PUPIL_ERR_SIZE, "height");
    }
    o = out;
    o.width = 3;
    expect_images(&in, &o, PUPIL_ERR_SIZE, "widths differ");
    o = out;
    o.height = 2;
    remember();
    expect(pupil_process(&pupil, &in, NULL, &o), PUPIL_ERR_SIZE, "heights differ");
    expect(pupil_map_rows(&pupil, &curve, &in, &o), PUPIL_ERR_SIZE, "heights differ");
    const pupil_image_const two_rows = pupil_image_rows(in, 0, 2);
    o.width = 2;
    o.height = 1;
    expect(pupil_map_rows(&pupil, &curve, &two_rows, &o), PUPIL_ERR_SIZE, "half the size, of no mosaic");
    static const ptrdiff_t short_stride[] = {0, 44, -44, 4, -4};
    for (unsigned k = 0; k < 5; k++) {
        i = in;
        i.stride_bytes = short_stride[k];
        expect_images(&i, &out, PUPIL_ERR_STRIDE, "input stride");
        o = out;
        o.stride_bytes = short_stride[k] / 4;
        expect_images(&in, &o, PUPIL_ERR_STRIDE, "output stride");
    }
    i = in;
    i.stride_bytes = 50;
    expect_images(&i, &out, PUPIL_ERR_ALIGNMENT, "stride of 50 bytes");
    for (int k = 1; k < 4; k++) {
        i = in;
        i.data = (const char *)in_memory + k;
        expect_images(&i, &out, PUPIL_ERR_ALIGNMENT, "data");
    }
    i = (pupil_image_const){
        .data = (const char *)in_memory + 1, .stride_bytes = 32, .width = 4, .height = 3, .pixel = PUPIL_PIXEL_RGBA16F};
    expect_images(&i, &out, PUPIL_ERR_ALIGNMENT, "half data");
    i = (pupil_image_const){
        .data = (const char *)in_memory + 1, .stride_bytes = 13, .width = 4, .height = 3, .pixel = PUPIL_PIXEL_RGB8};
    CHECK(pupil_process(&pupil, &i, NULL, &out) == PUPIL_OK); /* bytes need no alignment */
}

static void check_rows(void)
{
    const pupil_image_const one = {
        .data = in_memory, .stride_bytes = 48, .width = 4, .height = 1, .pixel = PUPIL_PIXEL_RGB32F};
    pupil_image to = {.data = out_memory + 16, .stride_bytes = 13, .width = 4, .height = 1, .pixel = PUPIL_PIXEL_RGB8};
    static const uint32_t outside[] = {3, 4, 0x7fffffff, 0xffffffff};
    fresh();
    remember();
    for (unsigned k = 0; k < 4; k++)
        expect(pupil_meter_rows(&pupil, &one, outside[k], 3, &stats), PUPIL_ERR_ROWS, "first row outside");
    expect(pupil_meter_rows(&pupil, &in, 1, 3, &stats), PUPIL_ERR_ROWS, "last row outside");
    expect(pupil_meter_rows(&pupil, &one, 0, 0, &stats), PUPIL_ERR_SIZE, "a frame of no rows");
    expect(pupil_meter_rows(&pupil, &one, 0, PUPIL_MAX_SIDE_PX + 1, &stats), PUPIL_ERR_SIZE,
           "a frame of too many rows");
    expect(pupil_meter_rows(&pupil, &one, 1, 4, &stats), PUPIL_ERR_STATS, "another frame height");
    expect(pupil_meter_rows(&pupil, &in, 0, 3, &stats), PUPIL_ERR_ROWS, "more rows than the frame has");
    expect(pupil_meter_rows(&pupil, &one, 1, 3, NULL), PUPIL_ERR_NULL, "no statistics");
    expect(pupil_fused_rows(&pupil, &curve, &one, 5, 3, &to, &stats), PUPIL_ERR_ROWS, "first row outside");
    expect(pupil_fused_rows(&pupil, &curve, &one, 1, 3, &to, NULL), PUPIL_ERR_NULL, "no statistics");
    expect(pupil_fused_rows(&pupil, NULL, &one, 1, 3, &to, &stats), PUPIL_ERR_NULL, "no curve");
    expect(pupil_map_rows(&pupil, NULL, &one, &to), PUPIL_ERR_NULL, "no curve");
    static const pupil_curve bad[] = {{.scale = NAN},
                                      {.scale = -1},
                                      {.scale = INFINITY},
                                      {.scale = 1, .inverse_white_squared = NAN},
                                      {.scale = 1, .inverse_white_squared = -1},
                                      {.scale = 1, .inverse_white_squared = INFINITY},
                                      {.scale = 1, .gamut = NAN},
                                      {.scale = 1, .gamut = -1},
                                      {.scale = 1, .gamut = INFINITY},
                                      {.scale = 1, .dither = 2},
                                      {.scale = 1, .first_row = PUPIL_MAX_SIDE_PX},
                                      {.scale = 1, .knots = 1},
                                      {.scale = 1, .knots = 128, .levels = 1},
                                      {.scale = 1, .knots = 128, .levels = 257},
                                      {.scale = 1, .knots = 128, .knot_scale = NAN},
                                      {.scale = 1, .knots = 128, .knot_scale = -1},
                                      {.scale = 1, .knots = 128, .knot_scale = 0x1p61f},
                                      {.scale = 1, .knots = 128, .knot = {[127] = 1.1f}},
                                      {.scale = 1, .knots = 128, .knot = {[0] = NAN}},
                                      {.scale = 1, .knots = 128, .knot = {[64] = -0.1f}}};
    for (unsigned k = 0; k < sizeof bad / sizeof *bad; k++) {
        expect(pupil_map_rows(&pupil, &bad[k], &one, &to), PUPIL_ERR_VALUE, "curve");
        expect(pupil_fused_rows(&pupil, &bad[k], &one, 1, 3, &to, &stats), PUPIL_ERR_VALUE, "curve");
    }
    stats.black = 13; /* of 12 pixels */
    remember();
    expect(pupil_meter_rows(&pupil, &one, 1, 3, &stats), PUPIL_ERR_STATS, "statistics that cannot be");
    stats.black = 0;
    pupil_config config;
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    remember();
    expect(pupil_meter_rows(&pupil, &one, 1, 3, &stats), PUPIL_ERR_STATS,
           "statistics with a histogram, metering without");
}

static void check_order(void)
{
    pupil_config config;
    pupil_exposure e;
    const pupil_image_const
        one = {.data = in_memory, .stride_bytes = 48, .width = 4, .height = 1, .pixel = PUPIL_PIXEL_RGB32F},
        narrow = {.data = in_memory, .stride_bytes = 48, .width = 3, .height = 1, .pixel = PUPIL_PIXEL_RGB32F};
    const pupil_image to = {
        .data = out_memory + 16, .stride_bytes = 13, .width = 4, .height = 1, .pixel = PUPIL_PIXEL_RGB8};
    pupil_config_default(&config);
    fresh();
    remember();
    expect(pupil_frame_rows(&pupil, &one, 0, NULL), PUPIL_ERR_ORDER, "rows without begin");
    expect(pupil_frame_end(&pupil), PUPIL_ERR_ORDER, "end without begin");
    expect(pupil_frame_begin(&pupil, 0, 3, NULL), PUPIL_ERR_SIZE, "begin without width");
    expect(pupil_frame_begin(&pupil, 4, 0, NULL), PUPIL_ERR_SIZE, "begin without height");
    expect(pupil_frame_begin(&pupil, PUPIL_MAX_SIDE_PX + 1, 3, NULL), PUPIL_ERR_SIZE, "begin too wide");
    expect(pupil_frame_begin(&pupil, 4, PUPIL_MAX_SIDE_PX + 1, NULL), PUPIL_ERR_SIZE, "begin too high");
    const pupil_frame_info reserved = {.reserved = 1};
    expect(pupil_frame_begin(&pupil, 4, 3, &reserved), PUPIL_ERR_SIZE_BYTES, "begin with a field of a later version");
    expect(pupil_meter(&pupil, &in, &reserved), PUPIL_ERR_SIZE_BYTES, "meter with a field of a later version");
    expect(pupil_frame_cancel(&pupil), PUPIL_ERR_ORDER, "cancel without begin");
    CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK && e.frames == 2);
    CHECK(pupil_frame_begin(&pupil, 4, 3, NULL) == PUPIL_OK);
    CHECK(pupil_frame_rows(&pupil, &one, 2, &to) == PUPIL_OK);
    remember();
    expect(pupil_frame_begin(&pupil, 4, 3, NULL), PUPIL_ERR_ORDER, "a second begin");
    expect(pupil_retune(&pupil, &config), PUPIL_ERR_ORDER, "retune within a frame");
    expect(pupil_process(&pupil, &in, NULL, &out), PUPIL_ERR_ORDER, "process within a frame");
    expect(pupil_meter(&pupil, &in, NULL), PUPIL_ERR_ORDER, "meter within a frame");
    expect(pupil_frame_rows(&pupil, &narrow, 0, NULL), PUPIL_ERR_SIZE, "rows of another width");
    expect(pupil_frame_rows(&pupil, &one, 3, NULL), PUPIL_ERR_ROWS, "a row outside");
    expect(pupil_frame_rows(&pupil, &in, 0, NULL), PUPIL_ERR_ROWS, "more rows than the frame has");
    CHECK(pupil_frame_end(&pupil) == PUPIL_ERR_ROWS); /* and drops it */
    CHECK(pupil_frame_end(&pupil) == PUPIL_ERR_ORDER);
    CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK && e.frames == 2);
    CHECK(pupil_frame_begin(&pupil, 4, 1, NULL) == PUPIL_OK && pupil_frame_cancel(&pupil) == PUPIL_OK);
    CHECK(pupil_frame_begin(&pupil, 4, 1, NULL) == PUPIL_OK && pupil_reset(&pupil) == PUPIL_OK);
    CHECK(pupil_frame_end(&pupil) == PUPIL_ERR_ORDER); /* reset forgot it */
    CHECK(pupil_frame_begin(&pupil, 4, 1, NULL) == PUPIL_OK);
    remember();
    expect(pupil_frame_rows(&pupil, &one, 0, &to), PUPIL_ERR_NO_EXPOSURE, "mapped before any light");
    CHECK(pupil_frame_rows(&pupil, &one, 0, NULL) == PUPIL_OK && pupil_frame_end(&pupil) == PUPIL_OK);
    CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK && e.frames == 1);
}

static void expect_stats(size_t offset, size_t bytes, uint64_t value, const char *what)
{
    pupil_stats s = stats;
    memcpy((unsigned char *)&s + offset, &value, bytes);
    remember();
    expect(pupil_adapt(&pupil, &s, NULL), PUPIL_ERR_STATS, what);
    const pupil_stats wrong = s;
    expect(pupil_stats_add(&stats, &s), PUPIL_ERR_STATS, what);
    expect(pupil_stats_add(&s, &stats), PUPIL_ERR_STATS, what);
    CHECK_MSG(memcmp(&s, &wrong, sizeof s) == 0, "%s: touched", what);
}

#define STATS_FIELD(field, value)                                                                                      \
    expect_stats(offsetof(pupil_stats, field), sizeof(stats.field), (uint64_t)(value), #field " " #value)

static void check_stats(void)
{
    double value = 5;
    fresh();
    STATS_FIELD(log2_frac, UINT64_C(1) << 40);
    STATS_FIELD(log2_frac, -1);
    STATS_FIELD(log2_sum, INT64_MAX);
    STATS_FIELD(log2_sum, INT64_MIN);
    STATS_FIELD(log2_sum, 4 * 33);
    STATS_FIELD(weight, -1);
    STATS_FIELD(weight, 3);
    STATS_FIELD(pixels, -1);
    STATS_FIELD(black, 5);
    STATS_FIELD(clipped, 5);
    STATS_FIELD(bad, -1);
    STATS_FIELD(rows, 4);
    STATS_FIELD(rows, 0);
    STATS_FIELD(frame_height, 0);
    STATS_FIELD(frame_height, PUPIL_MAX_SIDE_PX + 1);
    STATS_FIELD(has_histogram, 2);
    STATS_FIELD(has_histogram, 0);
    STATS_FIELD(peak, 0);          /* 0 where there are bins */
    STATS_FIELD(peak, 0x7fc00000); /* NaN */
    STATS_FIELD(peak, 0xbf800000); /* -1 */
    STATS_FIELD(peak_bin[3], 1);
    STATS_FIELD(bin[3], 1);
    STATS_FIELD(bin[511], -1);
    STATS_FIELD(band_log2_sum[0], INT64_MAX);
    STATS_FIELD(band_log2_sum[63], 1);
    STATS_FIELD(band_log2_sum[0], INT64_MIN);
    STATS_FIELD(band_pixels[5], 1000);
    STATS_FIELD(peak, 0x7f800000);       /* infinite */
    STATS_FIELD(code_light, 0x40000000); /* 2 */
    STATS_FIELD(code_light, 0x7fc00000); /* NaN */
    STATS_FIELD(channel_quads, 5);
    STATS_FIELD(channel_sum[0], 1); /* of no quad */
    STATS_FIELD(channel_sum[2], -1);
    const pupil_stats good = stats;
    static const double share[][2] = {{NAN, 1}, {0, NAN}, {-0.1, 1}, {0, 1.1}, {0.6, 0.4}, {1, 0}};
    for (unsigned i = 0; i < 6; i++)
        CHECK(pupil_stats_mean(&stats, share[i][0], share[i][1], &value) == PUPIL_ERR_VALUE && value == 5);
    CHECK(pupil_stats_quantile(&stats, NAN, &value) == PUPIL_ERR_VALUE &&
          pupil_stats_quantile(&stats, 1.1, &value) == PUPIL_ERR_VALUE);
    CHECK(pupil_stats_quantile(&stats, -0.1, &value) == PUPIL_ERR_VALUE && value == 5);
    CHECK(pupil_stats_mean(NULL, 0, 1, &value) == PUPIL_ERR_NULL &&
          pupil_stats_mean(&stats, 0, 1, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_stats_quantile(NULL, 0, &value) == PUPIL_ERR_NULL &&
          pupil_stats_quantile(&stats, 0, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_stats_peak_quantile(&stats, 2, &value) == PUPIL_ERR_VALUE && value == 5);
    CHECK(pupil_stats_peak_quantile(NULL, 0, &value) == PUPIL_ERR_NULL);
    CHECK(pupil_stats_peak_quantile(&stats, 0, NULL) == PUPIL_ERR_NULL);
    stats.black = 99;
    CHECK(pupil_stats_quantile(&stats, 0.5, &value) == PUPIL_ERR_STATS && value == 5);
    pupil_stats_clear(&stats);
    CHECK(pupil_stats_mean(&stats, 0, 1, &value) == PUPIL_ERR_NO_LIGHT && value == 5);
    stats.has_histogram = 1;
    CHECK(pupil_stats_quantile(&stats, 0.5, &value) == PUPIL_ERR_NO_LIGHT && value == 5);
    pupil_stats_clear(&stats);
    stats.log2_frac = 1; /* of no weight */
    CHECK(pupil_stats_mean(&stats, 0, 1, &value) == PUPIL_ERR_STATS && value == 5);
    pupil_stats_clear(&stats); /* so many quads that a sum of a channel cannot be checked */
    stats.rows = stats.frame_height = 1;
    stats.weight = stats.pixels = stats.channel_quads = (UINT64_C(1) << 44) - 1;
    CHECK(pupil_stats_mean(&stats, 0, 1, &value) == PUPIL_OK && value == 0);
    stats.weight = stats.pixels = ++stats.channel_quads;
    CHECK(pupil_stats_mean(&stats, 0, 1, &value) == PUPIL_ERR_STATS);
    stats = good;
    memset(stats.bin, 0, sizeof stats.bin);
    memset(stats.peak_bin, 0, sizeof stats.peak_bin);
    stats.peak = 0;
    stats.has_histogram = 0; /* sound, but the white point wants to follow */
    remember();
    expect(pupil_adapt(&pupil, &stats, NULL), PUPIL_ERR_NO_HISTOGRAM, "adapt without a histogram");
    pupil_config config;
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    config.trim_low = 0.1f;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    remember();
    expect(pupil_adapt(&pupil, &stats, NULL), PUPIL_ERR_NO_HISTOGRAM, "a trimmed mean without a histogram");
    config.trim_low = 0.0f;
    config.curve = PUPIL_CURVE_EQUALISE;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    remember();
    expect(pupil_adapt(&pupil, &stats, NULL), PUPIL_ERR_NO_HISTOGRAM, "a curve of the histogram without one");
    config.curve = PUPIL_CURVE_REINHARD;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_OK); /* nothing needs it */
    pupil_stats_clear(NULL);
}

/* Zeros, noise, and the wrong pointer: every call that takes an object. */
static void check_objects(void)
{
    pupil_config config;
    pupil_exposure e;
    pupil_curve c;
    uint32_t level = 77;
    pupil_config_default(&config);
    fresh();
    for (int kind = 0; kind < 4; kind++) {
        const int wanted = kind < 3 ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
        pupil_t *p = kind < 3 ? &pupil : NULL;
        for (size_t i = 0; i < sizeof pupil; i++)
            ((unsigned char *)&pupil)[i] = (unsigned char)(kind == 0 ? 0 : kind == 1 ? 0xff : check_random());
        remember();
        expect(pupil_retune(p, &config), wanted, "retune");
        expect(pupil_reset(p), wanted, "reset");
        expect(pupil_process(p, &in, NULL, &out), wanted, "process");
        expect(pupil_meter(p, &in, NULL), wanted, "meter");
        expect(pupil_frame_begin(p, 4, 3, NULL), wanted, "frame_begin");
        expect(pupil_frame_rows(p, &in, 0, NULL), wanted, "frame_rows");
        expect(pupil_frame_end(p), wanted, "frame_end");
        expect(pupil_frame_cancel(p), wanted, "frame_cancel");
        expect(pupil_meter_rows(p, &in, 0, 3, &stats), wanted, "meter_rows");
        expect(pupil_adapt(p, &stats, NULL), wanted, "adapt");
        expect(pupil_map_rows(p, &curve, &in, &out), wanted, "map_rows");
        expect(pupil_fused_rows(p, &curve, &in, 0, 3, &out, &stats), wanted, "fused_rows");
        expect(pupil_get_exposure(p, &e), wanted, "get_exposure");
        expect(pupil_get_curve(p, NULL, &c), wanted, "get_curve");
        expect(pupil_curve_before_light(p, &c), wanted, "curve_before_light");
        expect(pupil_get_stats(p, &stats), wanted, "get_stats");
        expect(pupil_get_level(p, &level), wanted, "get_level");
        CHECK(level == 77);
    }
    CHECK(pupil_init(NULL, &config) == PUPIL_ERR_NULL && pupil_init(&pupil, NULL) == PUPIL_ERR_NULL);
    fresh();
    remember();
    expect(pupil_retune(&pupil, NULL), PUPIL_ERR_NULL, "retune to nothing");
    expect(pupil_adapt(&pupil, NULL, NULL), PUPIL_ERR_NULL, "adapt to nothing");
    expect(pupil_get_exposure(&pupil, NULL), PUPIL_ERR_NULL, "exposure into nothing");
    expect(pupil_get_curve(&pupil, NULL, NULL), PUPIL_ERR_NULL, "curve into nothing");
    expect(pupil_curve_before_light(&pupil, NULL), PUPIL_ERR_NULL, "curve before light into nothing");
    expect(pupil_get_stats(&pupil, NULL), PUPIL_ERR_NULL, "statistics into nothing");
    expect(pupil_get_level(&pupil, NULL), PUPIL_ERR_NULL, "level into nothing");
    CHECK(pupil_get_level(&pupil, &level) == PUPIL_OK && level < PUPIL_LEVEL_COUNT);
}

/* Planes, pairs of rows and codings. */
static void check_cameras(void)
{
    static uint16_t mosaic[8 * 8];
    pupil_coding coding = {0};
    pupil_image_const i = {.data = mosaic, .stride_bytes = 16, .width = 8, .height = 8, .pixel = PUPIL_PIXEL_BAYER10};
    pupil_image o = {
        .data = out_memory + 16, .stride_bytes = 8 * 3, .width = 8, .height = 8, .pixel = PUPIL_PIXEL_RGB8};
    fresh();
    pupil_stats_clear(&stats);
    remember();
    for (uint32_t side = 7; side <= 9; side += 2) {
        pupil_image_const odd = i;
        odd.width = side == 7 ? 7 : 8;
        odd.height = side == 9 ? 7 : 8;
        expect(pupil_meter_rows(&pupil, &odd, 0, 8, &stats), PUPIL_ERR_SIZE, "a mosaic of an odd size");
    }
    pupil_image_const packed = i;
    packed.pixel = PUPIL_PIXEL_BAYER10P;
    packed.width = 6;
    expect(pupil_meter_rows(&pupil, &packed, 0, 8, &stats), PUPIL_ERR_SIZE, "packed, and no multiple of 4");
    o.width = 4;
    expect(pupil_map_rows(&pupil, &curve, &i, &o), PUPIL_ERR_SIZE, "half as wide, but not half as high");
    pupil_image_const rows = pupil_image_rows(i, 1, 2);
    expect(pupil_meter_rows(&pupil, &rows, 1, 8, &stats), PUPIL_ERR_ROWS, "a mosaic from an odd row on");
    expect(pupil_meter_rows(&pupil, &i, 0, 9, &stats), PUPIL_ERR_SIZE, "a mosaic of nine rows");
    i.pixel = PUPIL_PIXEL_NV12;
    expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_NULL, "NV12 without chroma");
    i.chroma = mosaic;
    i.chroma_stride_bytes = 7;
    expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_STRIDE, "chroma rows that overlap");
    i.chroma_stride_bytes = -8;
    rows = pupil_image_rows(i, 0, 3);
    expect(pupil_meter_rows(&pupil, &rows, 0, 8, &stats), PUPIL_ERR_ROWS, "NV12 cut within a pair");
    i.pixel = PUPIL_PIXEL_NV16;
    i.chroma_stride_bytes = 4;
    const pupil_image_const two_rows = pupil_image_rows(i, 2, 2);
    expect(pupil_meter_rows(&pupil, &two_rows, 2, 8, &stats), PUPIL_ERR_STRIDE, "NV16's two chroma rows overlap");
    i.pixel = PUPIL_PIXEL_I420;
    expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_NULL, "I420 without Cr");
    i.cr = mosaic;
    expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_STRIDE, "rows of Cr that overlap");
    i.cr_stride_bytes = 4;
    rows = pupil_image_rows(i, 0, 3);
    expect(pupil_meter_rows(&pupil, &rows, 0, 8, &stats), PUPIL_ERR_ROWS, "I420 cut within a pair");
    i.pixel = PUPIL_PIXEL_P010;
    i.chroma_stride_bytes = 17;
    expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_ALIGNMENT, "P010's chroma rows at odd addresses");
    i.chroma_stride_bytes = 14;
    expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_STRIDE, "P010's chroma rows overlap");
    i.chroma_stride_bytes = 16;
    i.chroma = (const char *)mosaic + 1;
    expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_ALIGNMENT, "P010's chroma at an odd address");
    i.chroma = mosaic;
    i.pixel = PUPIL_PIXEL_I444_16;
    i.chroma_stride_bytes = i.cr_stride_bytes = 14;
    expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_STRIDE, "I444_16's rows of Cb overlap");
    i.pixel = PUPIL_PIXEL_NV12;
    i.chroma_stride_bytes = -8;
    o = (pupil_image){.data = out_memory, .stride_bytes = 4, .width = 4, .height = 1, .pixel = PUPIL_PIXEL_NV12};
    const pupil_image_const one = pupil_image_rows(in, 1, 1);
    expect(pupil_map_rows(&pupil, &curve, &one, &o), PUPIL_ERR_NULL, "to NV12 without chroma");
    o.chroma = out_memory + 64;
    o.chroma_stride_bytes = 4;
    expect(pupil_fused_rows(&pupil, &curve, &one, 1, 3, &o, &stats), PUPIL_ERR_ROWS, "to NV12 from an odd row on");

    const pupil_image_const lower = {
        .data = mosaic, .stride_bytes = 16, .width = 8, .height = 2, .pixel = PUPIL_PIXEL_BAYER10};
    expect(pupil_fused_rows(&pupil, &curve, &lower, 2, 8, &o, &stats), PUPIL_ERR_ROWS, "half a pair of NV12's rows");

    static const struct {
        const char *what;
        pupil_coding coding;
    } wrong[] = {{"matrix", {.matrix = PUPIL_MATRIX_COUNT}},
                 {"range", {.range = PUPIL_RANGE_COUNT}},
                 {"light", {.light = PUPIL_LIGHT_COUNT}},
                 {"bayer", {.bayer = PUPIL_BAYER_COUNT}},
                 {"shift", {.shift = 7}},
                 {"black", {.black = -1}},
                 {"black", {.black = __builtin_nanf("")}},
                 {"white", {.black = 64, .white = 64}},
                 {"white", {.white = 65536}},
                 {"white", {.white = __builtin_nanf("")}},
                 {"balance", {.balance = {1, 1, 0}}},
                 {"balance", {.balance = {1, 2000, 1}}},
                 {"rgb_from_camera", {.rgb_from_camera = {[4] = 17}}},
                 {"knees", {.knees = PUPIL_KNEES + 1}},
                 {"knee_code", {.knees = 1, .knee_light = {0.5f}}},
                 {"knee_code", {.black = 64, .knees = 1, .knee_code = {64.5f}, .knee_light = {0.5f}}},
                 {"knee_code", {.knees = 2, .knee_code = {90, 90}, .knee_light = {0.1f, 0.5f}}},
                 {"knee_code", {.knees = 2, .knee_code = {90, 80}, .knee_light = {0.1f, 0.5f}}},
                 {"knee_code", {.knees = 1, .knee_code = {__builtin_nanf("")}, .knee_light = {0.5f}}},
                 {"knee_code", {.white = 400, .knees = 1, .knee_code = {399.5f}, .knee_light = {0.5f}}},
                 {"knee_code", {.knees = 1, .knee_code = {65534.5f}, .knee_light = {0.5f}}},
                 {"size_bytes", {.size_bytes = 3}},
                 {"knee_light", {.knees = 1, .knee_code = {90}}},
                 {"knee_light", {.knees = 1, .knee_code = {90}, .knee_light = {1}}},
                 {"knee_light", {.knees = 2, .knee_code = {80, 90}, .knee_light = {0.5f, 0.5f}}},
                 {"knee_light", {.knees = 2, .knee_code = {80, 90}, .knee_light = {0.5f, 0.4f}}},
                 {"knee_light", {.knees = 1, .knee_code = {90}, .knee_light = {__builtin_nanf("")}}}};
    for (unsigned k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        const char *why = "";
        CHECK(pupil_coding_check(&wrong[k].coding, i.pixel, &why) == PUPIL_ERR_CODING);
        CHECK_MSG(strncmp(why, wrong[k].what, strlen(wrong[k].what)) == 0, "%s: %s", wrong[k].what, why);
        i.coding = &wrong[k].coding;
        expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_CODING, why);
    }
    static const pupil_coding short_one = {.size_bytes = 3};
    pupil_image coded = {
        .data = out_memory + 16, .stride_bytes = 13, .width = 4, .height = 1, .pixel = PUPIL_PIXEL_RGB8};
    coded.coding = &short_one;
    expect(pupil_map_rows(&pupil, &curve, &one, &coded), PUPIL_ERR_CODING, "the output's coding, of no version");
    CHECK(pupil_coding_check(&coding, i.pixel, NULL) == PUPIL_OK &&
          pupil_coding_check(NULL, i.pixel, NULL) == PUPIL_ERR_NULL);
    /* valid for some formats, not for this one */
    i.coding = &coding;
    i.pixel = PUPIL_PIXEL_BAYER14;
    static const struct {
        const char *what;
        uint32_t not, but; /* formats */
        pupil_coding coding;
    } unfit[] = {{"shift", PUPIL_PIXEL_BAYER14, PUPIL_PIXEL_BAYER12, {.shift = 3}},
                 {"shift", PUPIL_PIXEL_BAYER10P, PUPIL_PIXEL_BAYER10, {.shift = 1}},
                 {"shift", PUPIL_PIXEL_GREY16, PUPIL_PIXEL_GREY12, {.shift = 4}},
                 {"black", PUPIL_PIXEL_BAYER14, PUPIL_PIXEL_BAYER16, {.black = 16383}},
                 {"black", PUPIL_PIXEL_GREY8, PUPIL_PIXEL_GREY10, {.black = 254.5f}},
                 {"light", PUPIL_PIXEL_BAYER14, PUPIL_PIXEL_GREY12, {.light = PUPIL_LIGHT_SRGB}},
                 {"light",
                  PUPIL_PIXEL_GREY12,
                  PUPIL_PIXEL_YUYV,
                  {.light = PUPIL_LIGHT_SRGB, .knees = 1, .knee_code = {90}, .knee_light = {0.5f}}},
                 {"knee_code",
                  PUPIL_PIXEL_GREY10,
                  PUPIL_PIXEL_BAYER12,
                  {.knees = 1, .knee_code = {1022.5f}, .knee_light = {0.5f}}}};
    for (unsigned k = 0; k < sizeof unfit / sizeof *unfit; k++) {
        const char *why = "";
        CHECK(pupil_coding_check(&unfit[k].coding, unfit[k].but, &why) == PUPIL_OK && !*why);
        CHECK(pupil_coding_check(&unfit[k].coding, unfit[k].not, &why) == PUPIL_ERR_CODING);
        CHECK_MSG(strncmp(why, unfit[k].what, strlen(unfit[k].what)) == 0, "%s: %s", unfit[k].what, why);
        i.coding = &unfit[k].coding;
        i.pixel = unfit[k].not ;
        expect(pupil_meter_rows(&pupil, &i, 0, 8, &stats), PUPIL_ERR_CODING, why);
    }
}

static void check_sentences(void)
{
    for (int a = 0; a >= PUPIL_ERR_CODING; a--)
        for (int b = PUPIL_ERR_CODING; b < a; b++)
            CHECK(strcmp(pupil_error_string(a), pupil_error_string(b)) != 0);
    for (int a = PUPIL_ERR_CODING - 5; a < 6; a++)
        CHECK(pupil_error_string(a) != NULL && strlen(pupil_error_string(a)) > 1);
    CHECK(pupil_error_string(INT32_MIN) != NULL && pupil_error_string(INT32_MAX) != NULL);
    static const char *const fields[] = {"stride_bytes", "chroma_stride_bytes", "cr_stride_bytes"};
    for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) /* the stride of any plane may be refused */
        CHECK(strstr(pupil_error_string(PUPIL_ERR_STRIDE), fields[k]));
    CHECK(strstr(pupil_error_string(PUPIL_ERR_ALIGNMENT), "chroma") &&
          strstr(pupil_error_string(PUPIL_ERR_SIZE), "multiple of 4"));
    for (uint32_t pixel = 0; pixel < 300; pixel++) {
        static const size_t bytes[] = {0, 16, 12, 8, 8, 6, 4, 3, 4, 2, 1, 1, 2,  2, 2, 1, 2, 2,
                                       2, 2,  0,  0, 1, 1, 1, 2, 3, 4, 0, 0, 12, 6, 2, 2, 4, 2};
        static const uint32_t bits[] = {
            [PUPIL_PIXEL_GREY8] = 8,    10, 12, 16, 8, 10, 12, 14, 16, 10, 12, [PUPIL_PIXEL_GREY10P] = 10, 12,
            [PUPIL_PIXEL_COUNT - 1] = 0};
        CHECK(pupil_pixel_bytes(pixel) == (pixel < PUPIL_PIXEL_COUNT ? bytes[pixel] : 0));
        CHECK(pupil_pixel_bits(pixel) == (pixel < PUPIL_PIXEL_COUNT ? bits[pixel] : 0));
        CHECK(pupil_pixel_is_mosaic(pixel) == (pixel >= PUPIL_PIXEL_BAYER8 && pixel <= PUPIL_PIXEL_BAYER12P));
    }
    CHECK(pupil_pixel_bytes(0xffffffff) == 0 && pupil_row_bytes(0xffffffff, 4) == 0);
    CHECK(pupil_row_bytes(PUPIL_PIXEL_BAYER10P, 8) == 10 && pupil_row_bytes(PUPIL_PIXEL_BAYER12P, 8) == 12 &&
          pupil_row_bytes(PUPIL_PIXEL_GREY10P, 5) == 10 && pupil_row_bytes(PUPIL_PIXEL_GREY12P, 3) == 6 &&
          pupil_row_bytes(PUPIL_PIXEL_YUYV, 3) == 8 && pupil_row_bytes(PUPIL_PIXEL_RGB16, 5) == 30);
    CHECK(pupil_pixel_planes(PUPIL_PIXEL_RGB8) == 1 && pupil_pixel_planes(PUPIL_PIXEL_NV12) == 2 &&
          pupil_pixel_planes(PUPIL_PIXEL_I420) == 3 && pupil_pixel_planes(0) == 0 && pupil_pixel_planes(300) == 0);
    CHECK(pupil_chroma_row_bytes(PUPIL_PIXEL_NV12, 5) == 6 && pupil_chroma_row_bytes(PUPIL_PIXEL_I420, 5) == 3 &&
          pupil_chroma_row_bytes(PUPIL_PIXEL_I444_16, 5) == 10 && pupil_chroma_rows(PUPIL_PIXEL_I444_16, 5) == 5 &&
          pupil_chroma_row_bytes(PUPIL_PIXEL_RGB8, 5) == 0);
    CHECK(pupil_chroma_rows(PUPIL_PIXEL_NV21, 5) == 3 && pupil_chroma_rows(PUPIL_PIXEL_NV16, 5) == 5 &&
          pupil_chroma_rows(PUPIL_PIXEL_YUYV, 5) == 0);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_images();
    check_rows();
    check_order();
    check_stats();
    check_objects();
    check_cameras();
    check_sentences();
    return check_end();
}
