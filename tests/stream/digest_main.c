/* The cases of the digest program. The line of a case: "name 0123456789abcdef". */
#include "digest.h"

#ifdef PUPIL_BOARD
#include "../freestanding/board.h"
#define print board_print
#else
#include <stdio.h>
#define print(text) (void)fputs(text, stdout)
#endif

/* --- lines without a C library --- */

static char line[128];
static size_t used;

static void put(const char *text)
{
    while (*text && used < sizeof line - 2)
        line[used++] = *text++;
}

static void put_number(uint32_t number)
{
    char digits[11];
    size_t i = sizeof digits - 1;
    digits[i] = 0;
    do
        digits[--i] = (char)('0' + number % 10);
    while (number /= 10);
    put(digits + i);
}

static void put_digest(uint64_t digest)
{
    put(" ");
    for (int i = 0; i < 16; i++, digest <<= 4) {
        const char digit[2] = {"0123456789abcdef"[digest >> 60], 0};
        put(digit);
    }
    line[used++] = '\n';
    line[used] = 0;
    used = 0;
    print(line);
}

static void run(const digest_case *c)
{
    put_digest(digest_run(c));
}

/* Six frames of 64 x 48 with timestamps, defaults everywhere. */
static digest_case usual(void)
{
    digest_case c = {0};
    pupil_config_default(&c.config);
    c.in = PUPIL_PIXEL_RGB32F;
    c.out = PUPIL_PIXEL_RGBA8;
    c.width = 64;
    c.height = 48;
    c.frames = 6;
    c.flags = DIGEST_STAMPED;
    return c;
}

/* --- the battery --- */

static const char *const pixel_names[PUPIL_PIXEL_COUNT] = {
    "none",    "rgba32f", "rgb32f",   "rgba16f",  "rgba16", "rgb16",  "rgba8",   "rgb8",    "bgrx8",
    "yuyv",    "nv12",    "grey8",    "grey10",   "grey12", "grey16", "bayer8",  "bayer10", "bayer12",
    "bayer14", "bayer16", "bayer10p", "bayer12p", "i420",   "nv21",   "nv16",    "uyvy",    "bgr8",
    "rgbx8",   "grey10p", "grey12p",  "bgr32f",   "rgb16f", "p010",   "i420-10", "rgb10a2", "i444-16"};
static const uint32_t out_pixels[3] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_BGRX8, PUPIL_PIXEL_RGB8};

/* Every input format to every output format at every size, upright and upside down. Widths around 16, the number of
 * lanes in metering; fewer, equal and more rows than the grid and the bands have. */
static void shapes(void)
{
    static const uint32_t sizes[][2] = {{1, 1}, {3, 5}, {16, 16}, {17, 2}, {641, 7}, {64, 48}, {2, 100}};
    for (uint32_t in = PUPIL_PIXEL_RGBA32F; in <= PUPIL_PIXEL_RGB8; in++)
        for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
            for (uint32_t o = 0; o < 3; o++) {
                digest_case c = usual();
                c.in = in;
                c.out = out_pixels[o];
                c.width = sizes[s][0];
                c.height = sizes[s][1];
                c.frames = 2;
                c.flags |= o == 1 ? DIGEST_UPSIDE_DOWN : o == 2 ? DIGEST_PLAIN : 0;
                put(pixel_names[in]);
                put("-");
                put(pixel_names[c.out]);
                put("-");
                put_number(c.width);
                put("x");
                put_number(c.height);
                run(&c);
            }
}

/* Camera formats, with codings that use every feature, to RGBA, NV12 and, for mosaics, to half the size. */
static void cameras(uint32_t first, uint32_t last, uint32_t lights)
{
    static const uint32_t sizes[][2] = {{4, 2}, {20, 34}, {64, 48}, {516, 6}};
    static const uint32_t outs[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_NV12, PUPIL_PIXEL_RGB8};
    for (uint32_t in = first; in <= last; in++)
        for (uint32_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
            for (uint32_t o = 0; o < 3; o++) {
                digest_case c = usual();
                const int mosaic = pupil_pixel_is_mosaic(in);
                const uint32_t n = in + s + o;
                c.in = in;
                c.out = outs[o];
                c.width = sizes[s][0] + (mosaic ? 0 : s % 2);
                c.height = sizes[s][1] + (mosaic ? 0 : o % 2);
                c.frames = 2;
                c.flags |= (s == 1   ? DIGEST_ROWS
                            : s == 2 ? DIGEST_SEAM
                                     : 0) |
                           (s == 3 && !o ? DIGEST_UPSIDE_DOWN : 0) | (mosaic && o == 2 ? DIGEST_HALVED : 0);
                c.coding.matrix = n % PUPIL_MATRIX_COUNT;
                c.coding.range = n % PUPIL_RANGE_COUNT;
                c.coding.light = mosaic ? 0 : n % lights;
                c.coding.bayer = n % PUPIL_BAYER_COUNT;
                c.coding.shift = in == PUPIL_PIXEL_GREY12 || in == PUPIL_PIXEL_BAYER10 ? n % 5 : 0;
                c.coding.black = (float)(n % 3 * 4);
                c.coding.white = n % 2 ? 250.5f : 0.0f;
                if (n % 4) {
                    c.coding.balance[0] = 1.75f;
                    c.coding.balance[1] = 1.0f;
                    c.coding.balance[2] = 1.4f;
                    for (int i = 0; i < 9 && n % 4 == 3; i++)
                        c.coding.rgb_from_camera[i] = i % 4 ? -0.25f : 1.5f;
                }
                c.config.grey_world = n % 2;
                c.config.meter_rows = s == 2 ? 1u << o : 0;
                put(pixel_names[in]);
                put("-");
                put(pixel_names[c.out]);
                put(c.flags & DIGEST_HALVED ? "-halved-" : "-");
                put_number(c.width);
                put("x");
                put_number(c.height);
                run(&c);
            }
}

/* Companded grey and mosaics, otherwise as cameras(). */
static void companded(uint32_t in, uint32_t flags)
{
    digest_case c = usual();
    c.in = in;
    c.flags |= flags;
    c.config.grey_world = 1;
    c.coding = (pupil_coding){.black = 16, .knees = 3, .bayer = in % PUPIL_BAYER_COUNT};
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t light[3] = {8, 64, 400};
        c.coding.knee_code[k] = (float)((k + 1) << (pupil_pixel_bits(in) - 2));
        c.coding.knee_light[k] = (float)light[k] / 1024.0f;
    }
    c.coding.balance[0] = 1.5f;
    c.coding.balance[1] = c.coding.balance[2] = 1.0f;
    put("companded-");
    put(pixel_names[in]);
    run(&c);
}

/* To I420, and to linear light: at sizes that are odd, and with alpha. */
static void outputs(void)
{
    static const uint32_t outs[] = {PUPIL_PIXEL_I420, PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGB32F, PUPIL_PIXEL_RGBA16F,
                                    PUPIL_PIXEL_RGB16F};
    static const uint32_t ins[] = {PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_BAYER10, PUPIL_PIXEL_RGB10A2};
    for (uint32_t o = 0; o < 5; o++)
        for (uint32_t i = 0; i < 4; i++) {
            digest_case c = usual();
            c.in = ins[i];
            c.out = outs[o];
            c.width = i == 2 ? 64 : 37;
            c.height = i == 2 ? 48 : 21;
            c.frames = 2;
            c.flags |= i == 1 ? DIGEST_UPSIDE_DOWN : i == 2 ? DIGEST_HALVED : 0;
            put("out-");
            put(pixel_names[c.in]);
            put("-");
            put(pixel_names[c.out]);
            run(&c);
        }
}

/* By luma: pairs of rows, single rows, and single last columns; more and fewer quads than a kernel's block. */
static void by_luma(void)
{
    static const uint32_t ins[] = {PUPIL_PIXEL_NV12, PUPIL_PIXEL_I420, PUPIL_PIXEL_NV21,
                                   PUPIL_PIXEL_NV16, PUPIL_PIXEL_YUYV, PUPIL_PIXEL_UYVY};
    static const uint32_t outs[] = {PUPIL_PIXEL_NV12, PUPIL_PIXEL_I420, PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_BGRX8};
    static const uint32_t sizes[][2] = {{1, 1}, {66, 49}, {517, 5}};
    for (uint32_t i = 0; i < 6; i++)
        for (uint32_t o = 0; o < 4; o++)
            for (uint32_t s = 0; s < 3; s++) {
                digest_case c = usual();
                const uint32_t n = i + o + s;
                c.config.accuracy = PUPIL_ACCURACY_LUMA;
                c.in = ins[i];
                c.out = outs[o];
                c.width = sizes[s][0];
                c.height = sizes[s][1];
                c.frames = 3;
                c.flags |= (s == 2            ? DIGEST_UPSIDE_DOWN
                            : s == 1 && n % 2 ? DIGEST_ROWS
                                              : 0) |
                           (n % 3 ? DIGEST_PALE : 0);
                c.coding.matrix = n % PUPIL_MATRIX_COUNT;
                c.coding.range = n / 2 % PUPIL_RANGE_COUNT;
                put("luma-");
                put(pixel_names[c.in]);
                put("-");
                put(pixel_names[c.out]);
                put("-");
                put_number(c.width);
                put("x");
                put_number(c.height);
                run(&c);
            }
}

static void some_rows(digest_case *c)
{
    c->config.meter_rows = 4;
    c->flags |= DIGEST_ROWS;
}

/* Every law with both orders, with and without exposure metadata, whole and in parts. */
static void laws(void)
{
    for (uint32_t law = 0; law < PUPIL_LAW_COUNT; law++)
        for (uint32_t order = 0; order < PUPIL_ORDER_COUNT; order++)
            for (uint32_t way = 0; way < 4; way++) {
                digest_case c = usual();
                c.config.law = law;
                c.config.order = order;
                c.frames = 8;
                c.flags |= way == 1 ? DIGEST_EXPOSED : way == 2 ? DIGEST_ROWS : way == 3 ? DIGEST_SEAM : 0;
                put("law");
                put_number(law);
                put(order ? "-fused" : "-exact");
                put(way == 0 ? "-whole" : way == 1 ? "-exposed" : way == 2 ? "-rows" : "-seam");
                run(&c);
            }
}

/* Every transfer with every white mode, on floats and on 8-bit codes. */
static void curves(void)
{
    for (uint32_t transfer = 0; transfer < PUPIL_TRANSFER_COUNT; transfer++)
        for (uint32_t white = 0; white < PUPIL_WHITE_COUNT; white++)
            for (uint32_t codes = 0; codes < 2; codes++) {
                digest_case c = usual();
                c.config.transfer = transfer;
                c.config.white_mode = white;
                c.config.white = 3.0;
                c.in = codes ? PUPIL_PIXEL_RGBA8 : PUPIL_PIXEL_RGBA16F;
                put("transfer");
                put_number(transfer);
                put("-white");
                put_number(white);
                put(codes ? "-codes" : "-half");
                run(&c);
            }
}

/* Every curve from the histogram, with every other setting changed. */
static void knots(void)
{
    static const char *const ways[6] = {"-whole", "-exposed", "-rows", "-seam", "-at-once", "-soon"};
    for (uint32_t curve = PUPIL_CURVE_NORMALISE; curve < PUPIL_CURVE_COUNT; curve++)
        for (uint32_t way = 0; way < 6; way++) {
            digest_case c = usual();
            c.config.curve = curve;
            c.config.transfer = way % PUPIL_TRANSFER_COUNT;
            c.config.law = way == 1 ? PUPIL_LAW_ARITHMETIC_SCALE : PUPIL_LAW_SECONDS;
            c.config.order = way == 2 ? PUPIL_ORDER_FUSED : PUPIL_ORDER_EXACT;
            c.in = way == 3 ? PUPIL_PIXEL_RGBA8 : PUPIL_PIXEL_RGBA16F;
            c.frames = way > 3 ? 24 : 8;
            c.flags |= way % 4 == 1 ? DIGEST_EXPOSED : way == 2 ? DIGEST_ROWS : way == 3 ? DIGEST_SEAM : 0;
            if (way > 3) /* the curve soon reaches its target, and its knots move by stops */
                c.config.tau_light_s = c.config.tau_dark_s = way == 4 ? 0.0 : 0.03;
            if (way == 4) {
                c.config.curve_share = 0.1;
                c.config.curve_ceiling = 2.0;
                c.config.curve_range_ev = 4.0;
            }
            put("curve");
            put_number(curve);
            put(ways[way]);
            run(&c);
        }
}

static void trimmed(digest_case *c)
{
    c->config.trim_low = 0.05;
    c->config.trim_high = 0.95;
}

static void centre(digest_case *c)
{
    pupil_metering_centre(&c->config);
}

static void spot(digest_case *c)
{
    pupil_metering_spot(&c->config);
}

static void roi(digest_case *c)
{
    pupil_metering_roi(&c->config, 0.1, 0.3, 0.45, 0.6);
    c->config.histogram = 1;
}

static void mask(digest_case *c)
{
    for (uint32_t y = 0; y < PUPIL_GRID_SIDE; y++)
        for (uint32_t x = 0; x < PUPIL_GRID_SIDE; x++)
            c->config.weight[y][x] = (uint8_t)((x + y) % 3 ? 17 * x : 0);
    trimmed(c);
    c->in = PUPIL_PIXEL_RGBA32F;
}

static void bt2020(digest_case *c)
{
    c->config.primaries = PUPIL_PRIMARIES_BT2020;
}

static void matrix(digest_case *c)
{
    /* Display P3 to XYZ, rounded to eight binary places; any other matrix would be as good. */
    static const float p3[9] = {124.0f, 68.0f, 51.0f, 59.0f, 177.0f, 20.0f, 0.0f, 12.0f, 267.0f};
    c->config.primaries = PUPIL_PRIMARIES_MATRIX;
    for (int i = 0; i < 9; i++)
        c->config.rgb_to_xyz[i] = p3[i] / 256.0f;
}

static void to_bt709(digest_case *c)
{
    c->config.primaries = PUPIL_PRIMARIES_BT2020;
    c->config.output_primaries = PUPIL_OUTPUT_BT709;
}

static void fused_to_bt2020(digest_case *c)
{
    matrix(c);
    c->config.output_primaries = PUPIL_OUTPUT_BT2020;
    c->config.order = PUPIL_ORDER_FUSED;
}

static void limits(digest_case *c)
{
    c->config.ev_min = -1.5;
    c->config.ev_max = 0.75;
    c->config.ev_compensation = -0.7;
    c->config.key = 0.25;
}

static void floor_and_clip(digest_case *c)
{
    c->config.floor = 0x1p-3f;
    c->config.clip = 4.0f;
}

static void calibrated(digest_case *c)
{
    c->config.calibration = 12.5;
    c->config.law = PUPIL_LAW_GEOMETRIC_LUMINANCE;
    c->config.frame_weight = 1e-7;
    c->flags |= DIGEST_EXPOSED;
}

static void slow(digest_case *c)
{
    c->config.tau_light_s = 1e6;
    c->config.tau_dark_s = 1e5;
}

static void at_once(digest_case *c)
{
    c->config.tau_light_s = 0.0;
    c->config.tau_dark_s = 0.0;
    c->config.white_quantile = 0.9;
}

static void unstamped(digest_case *c)
{
    c->flags &= ~(unsigned)DIGEST_STAMPED;
    c->config.nominal_frame_s = 0.25;
}

static void locked(digest_case *c)
{
    c->config.lock = 1;
}

/* Light of 1e-3 to 1 cd/m2: rods in a picture that has its own primaries. */
static void night(digest_case *c)
{
    c->config.law = PUPIL_LAW_EYE;
    c->config.eye_unit_cd_m2 = 0.03125;
    c->frames = 12;
}

static void fused_night(digest_case *c)
{
    night(c);
    matrix(c);
    c->config.output_primaries = PUPIL_OUTPUT_BT709;
    c->config.order = PUPIL_ORDER_FUSED;
    c->in = PUPIL_PIXEL_RGBA16F;
}

static void weight_one(digest_case *c)
{
    c->config.law = PUPIL_LAW_ARITHMETIC_SCALE;
    c->config.frame_weight = 1.0;
}

static void refused(digest_case *c)
{
    c->config.key = -1.0;
}

int main(void)
{
    static const struct {
        const char *name;
        void (*set)(digest_case *);
    } settings[] = {
        {"trimmed", trimmed},
        {"centre", centre},
        {"spot", spot},
        {"roi", roi},
        {"mask", mask},
        {"bt2020", bt2020},
        {"matrix", matrix},
        {"limits", limits},
        {"floor-and-clip", floor_and_clip},
        {"slow", slow},
        {"at-once", at_once},
        {"calibrated", calibrated},
        {"locked", locked},
        {"refused", refused},
        {"unstamped", unstamped},
        {"weight-one", weight_one},
        {"some-rows", some_rows},
        {"to-bt709", to_bt709},
        {"fused-to-bt2020", fused_to_bt2020},
        {"night", night},
        {"fused-night", fused_night},
    };
    shapes();
    laws();
    curves();
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        digest_case c = usual();
        settings[i].set(&c);
        put(settings[i].name);
        run(&c);
    }
    cameras(PUPIL_PIXEL_YUYV, PUPIL_PIXEL_BAYER12P, PUPIL_LIGHT_BT709 + 1);
    put("row-gains");
    put_digest(digest_lamps());
    cameras(PUPIL_PIXEL_I420, PUPIL_PIXEL_RGBX8, PUPIL_LIGHT_BT709 + 1);
    cameras(PUPIL_PIXEL_BGRX8, PUPIL_PIXEL_BGRX8, PUPIL_LIGHT_BT709 + 1);
    digest_case bgr = usual();
    bgr.out = PUPIL_PIXEL_BGR8;
    put("rgb32f-bgr8");
    run(&bgr);
    cameras(PUPIL_PIXEL_GREY10P, PUPIL_PIXEL_RGB16F, PUPIL_LIGHT_BT709 + 1);
    cameras(PUPIL_PIXEL_P010, PUPIL_PIXEL_COUNT - 1, PUPIL_LIGHT_COUNT);
    companded(PUPIL_PIXEL_GREY10, 0);
    companded(PUPIL_PIXEL_GREY12P, DIGEST_ROWS);
    companded(PUPIL_PIXEL_BAYER12, DIGEST_SEAM);
    companded(PUPIL_PIXEL_BAYER10P, DIGEST_HALVED);
    outputs();
    knots();
    put("veil");
    put_digest(digest_veil());
    put("bloom");
    put_digest(digest_bloom());
    by_luma();
    put("mains");
    put_digest(digest_mains());
    put("flicker");
    put_digest(digest_flicker());
    return 0;
}
