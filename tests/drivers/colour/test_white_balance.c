/* The colour of raw frames: on the fake's mosaics in coloured light a grey scene ends grey, and follows changes of
 * light slowly; saturated is white; when off, nothing changes; and a sensor's black level and matrix are used. */
#include <linux/videodev2.h>
#include <math.h>

#include "check.h"
#include "colour/white_balance.h"
#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"
#include "pupil/pupil.h"

#define FPS 30

typedef struct scene {
    fake_v4l2 *fake;
    pupil_source *source;
    pupil_white_balance colour;
    pupil_t pupil;
    pupil_frame frame;
    unsigned char out[32 * 24 * 3]; /* of 64 x 48, half the size: a pixel for a quad */
    pupil_why why;
} scene;

static scene open_scene(const fake_v4l2_config *config, const pupil_colour_options *options, const char *sensor)
{
    scene s = {.fake = fake_v4l2_new(config)};
    const pupil_live_options live = {.capture = {.system = fake_v4l2_system(s.fake)}, .hands_off = 1};
    pupil_camera_sensor known;
    pupil_config adapting;
    CHECK_MSG(pupil_live_open("0", NULL, &live, &s.source, &s.why) == 0, "%s", s.why.text);
    if (sensor)
        CHECK(pupil_camera_find_sensor(NULL, sensor, &known, &s.why) == 1);
    const pupil_v4l2_format *format = &pupil_live_capture(s.source)->format;
    CHECK_MSG(pupil_white_balance_begin(&s.colour, options, &format->coding, format->pixel, sensor ? &known : NULL,
                                        &s.why) == 0,
              "%s", s.why.text);
    pupil_config_default(&adapting);
    CHECK(pupil_init(&s.pupil, &adapting) == PUPIL_OK);
    return s;
}

static void next(scene *s)
{
    CHECK_MSG(pupil_source_next(s->source, &s->frame, &s->why) == PUPIL_SOURCE_FRAME, "%s", s->why.text);
    s->frame.image.coding = &s->colour.coding;
    const pupil_image out = {
        .data = s->out, .stride_bytes = 32 * 3, .width = 32, .height = 24, .pixel = PUPIL_PIXEL_RGB8};
    CHECK(pupil_process(&s->pupil, &s->frame.image, &s->frame.info, &out) == PUPIL_OK);
    pupil_white_balance_frame(&s->colour, &s->frame.image, &s->frame.info);
    pupil_source_done(s->source, &s->frame);
}

static void close_scene(scene *s)
{
    pupil_source_close(s->source);
    fake_v4l2_free(s->fake);
}

static fake_v4l2_config mosaic(uint32_t fourcc)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.fps = FPS;
    config.only_format = fourcc;
    config.flat = 512;
    return config;
}

/* A grey surface in this light, after the factors: its largest channel over its smallest, less 1. */
static double tint(const scene *s, const double light[3])
{
    double low = HUGE_VAL, high = 0;
    for (int i = 0; i < 3; i++) {
        const double v = light[i] * (double)s->colour.coding.balance[i];
        low = fmin(low, v);
        high = fmax(high, v);
    }
    return high / low - 1;
}

/* In every order and depth: grey within 1 % from the second frame on; another light: no jump, and grey again. */
static void test_grey(void)
{
    static const uint32_t formats[] = {V4L2_PIX_FMT_SRGGB8,   V4L2_PIX_FMT_SGRBG10,  V4L2_PIX_FMT_SGBRG12,
                                       V4L2_PIX_FMT_SBGGR16,  V4L2_PIX_FMT_SRGGB10P, V4L2_PIX_FMT_SBGGR10P,
                                       V4L2_PIX_FMT_SGRBG10P, V4L2_PIX_FMT_SRGGB12};
    const pupil_colour_options automatic = {0};
    for (size_t n = 0; n < sizeof formats / sizeof formats[0]; n++) {
        fake_v4l2_config config = mosaic(formats[n]);
        const double first[3] = {0.5 + check_uniform(), 1.5, 0.5 + check_uniform()};
        const double second[3] = {1.5, 1.0, 0.5 + check_uniform()};
        memcpy(config.colour, first, sizeof first);
        scene s = open_scene(&config, &automatic, NULL);
        CHECK(s.colour.follows == 1);
        for (int i = 0; i < 3; i++)
            next(&s);
        CHECK_MSG(tint(&s, first) < 0.01, "format %zu: %g", n, tint(&s, first));
        for (int i = 0; i < 32 * 24; i++)
            CHECK(abs(s.out[3 * i] - s.out[3 * i + 1]) <= 1 && abs(s.out[3 * i + 2] - s.out[3 * i + 1]) <= 1);
        memcpy(config.colour, second, sizeof second);
        fake_v4l2_reconfigure(s.fake, &config);
        double before = tint(&s, second), at_first = before;
        for (int i = 0; i < 12 * FPS; i++) {
            const pupil_coding last = s.colour.coding;
            next(&s);
            for (int k = 0; k < 3; k++) /* in one frame a factor moves by at most 1 / (1 + tau * fps) of the way */
                CHECK(fabs(s.colour.coding.balance[k] - last.balance[k]) <
                      (PUPIL_WHITE_BALANCE_MOST - 1) / (1 + PUPIL_WHITE_BALANCE_TAU_S * FPS) + 1e-6);
            CHECK_MSG(tint(&s, second) <= before + 0.002, "from %g to %g", before, tint(&s, second));
            before = tint(&s, second);
        }
        CHECK_MSG(at_first > 0.1 && tint(&s, second) < 0.01, "format %zu: %g, then %g", n, at_first, tint(&s, second));
        for (int i = 0; i < 32 * 24; i++)
            CHECK(abs(s.out[3 * i] - s.out[3 * i + 1]) <= 1 && abs(s.out[3 * i + 2] - s.out[3 * i + 1]) <= 1);
        close_scene(&s);
    }
}

/* The same course at any frame rate, up to the effect of the step's length; and the same bits twice. */
static void test_rate(void)
{
    const pupil_colour_options automatic = {0};
    float after[3][3];
    for (int n = 0; n < 3; n++) {
        fake_v4l2_config config = mosaic(V4L2_PIX_FMT_SRGGB16);
        const double light[3] = {1, 0.5, 0.8};
        config.fps = n == 1 ? 240 : FPS;
        scene s = open_scene(&config, &automatic, NULL);
        next(&s);
        memcpy(config.colour, light, sizeof light);
        fake_v4l2_reconfigure(s.fake, &config);
        while (s.frame.info.timestamp_ns < 1500000000)
            next(&s);
        memcpy(after[n], s.colour.coding.balance, sizeof after[n]);
        close_scene(&s);
    }
    CHECK(memcmp(after[0], after[2], sizeof after[0]) == 0);
    CHECK_MSG(fabs(after[0][1] - after[1][1]) < 0.02, "%g at 30 a second, %g at 240", (double)after[0][1],
              (double)after[1][1]);
    CHECK_MSG(fabs(after[1][1] - (2 - exp(-1))) < 0.02, "%g", (double)after[1][1]); /* 1 to 2, after one tau */
}

/* Overexposed by ten stops: white, with any factors and matrix; and the factors stay. */
static void test_full(void)
{
    const pupil_colour_options automatic = {0};
    fake_v4l2_config config = mosaic(V4L2_PIX_FMT_SRGGB10);
    const double light[3] = {0.5, 1, 0.4};
    memcpy(config.colour, light, sizeof light);
    scene s = open_scene(&config, &automatic, "ov5647"); /* it has a matrix, but no known black level */
    CHECK(s.colour.coding.rgb_from_camera[0] > 1);
    for (int i = 0; i < 3; i++)
        next(&s);
    const pupil_coding last = s.colour.coding;
    CHECK(tint(&s, light) < 0.01 && last.balance[0] > 1.9f);
    fake_v4l2_light(s.fake, 1024);
    pupil_config bright;
    pupil_config_default(&bright);
    bright.lock = 1; /* as before the light changed */
    CHECK(pupil_retune(&s.pupil, &bright) == PUPIL_OK);
    for (int i = 0; i < 10; i++)
        next(&s);
    for (int i = 0; i < 32 * 24; i++)
        CHECK_MSG(s.out[3 * i] == s.out[3 * i + 1] && s.out[3 * i + 2] == s.out[3 * i + 1] && s.out[3 * i] > 200,
                  "%d %d %d", s.out[3 * i], s.out[3 * i + 1], s.out[3 * i + 2]);
    CHECK(memcmp(&last, &s.colour.coding, sizeof last) == 0);
    close_scene(&s);
}

/* No frame is looked at, and no bit of the coding changes. */
static void test_off(void)
{
    const pupil_colour_options off = {
        .balance = PUPIL_COLOUR_OFF, .matrix = PUPIL_COLOUR_OFF, .black = PUPIL_COLOUR_OFF};
    const pupil_colour_options automatic = {0};
    fake_v4l2_config config = mosaic(V4L2_PIX_FMT_SGRBG10);
    scene s = open_scene(&config, &off, "imx219");
    const pupil_coding came = pupil_live_capture(s.source)->format.coding;
    CHECK(!s.colour.follows && memcmp(&came, &s.colour.coding, sizeof came) == 0);
    for (int i = 0; i < 3; i++)
        next(&s);
    CHECK(memcmp(&came, &s.colour.coding, sizeof came) == 0 && !s.colour.looked);
    close_scene(&s);
    config.only_format = V4L2_PIX_FMT_YUYV; /* no mosaic: nothing to follow */
    s = open_scene(&config, &automatic, "imx219");
    const pupil_coding yuv = pupil_live_capture(s.source)->format.coding;
    CHECK(!s.colour.follows && memcmp(&yuv, &s.colour.coding, sizeof yuv) == 0);
    close_scene(&s);
}

static void test_known(void)
{
    const pupil_colour_options automatic = {0}, given = {.balance = PUPIL_COLOUR_GIVEN,
                                                         .matrix = PUPIL_COLOUR_GIVEN,
                                                         .black = PUPIL_COLOUR_GIVEN,
                                                         .given_balance = {2, 1, 1.5f},
                                                         .given_matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                                         .given_black = 60};
    const pupil_colour_options plain = {.balance = PUPIL_COLOUR_OFF};
    static const struct {
        uint32_t pixel;
        float black;
    } blacks[] = {{PUPIL_PIXEL_BAYER8, 16},   {PUPIL_PIXEL_BAYER10, 64}, {PUPIL_PIXEL_BAYER10P, 64},
                  {PUPIL_PIXEL_BAYER12, 256}, {PUPIL_PIXEL_GREY12, 256}, {PUPIL_PIXEL_BAYER14, 1024},
                  {PUPIL_PIXEL_BAYER16, 4096}};
    pupil_camera_sensor imx219;
    pupil_white_balance c;
    pupil_why why;
    CHECK(pupil_camera_find_sensor(NULL, "imx219 10-0010", &imx219, &why) == 1);
    for (size_t i = 0; i < sizeof blacks / sizeof blacks[0]; i++) { /* 64 at 10 bits, by its data sheet */
        CHECK(pupil_white_balance_begin(&c, &automatic, NULL, blacks[i].pixel, &imx219, &why) == 0);
        CHECK_MSG(c.coding.black == blacks[i].black, "%g", (double)c.coding.black);
    }
    CHECK(memcmp(c.coding.rgb_from_camera, imx219.matrix, sizeof imx219.matrix) == 0);
    const pupil_coding told = {.black = 50};
    CHECK(pupil_white_balance_begin(&c, &automatic, &told, PUPIL_PIXEL_BAYER10, &imx219, &why) == 0);
    CHECK(c.coding.black == 50); /* the driver knows better */
    CHECK(pupil_white_balance_begin(&c, &plain, NULL, PUPIL_PIXEL_BAYER10, &imx219, &why) == 0);
    CHECK(c.coding.rgb_from_camera[0] == 0 && c.coding.black == 64 && !c.follows);
    CHECK(pupil_white_balance_begin(&c, &given, NULL, PUPIL_PIXEL_BAYER10, &imx219, &why) == 0);
    CHECK(c.coding.balance[0] == 2 && c.coding.rgb_from_camera[8] == 1 && c.coding.black == 60 && !c.follows);
    pupil_colour_options wrong = given;
    wrong.given_black = 1023;
    CHECK(pupil_white_balance_begin(&c, &wrong, NULL, PUPIL_PIXEL_BAYER10, NULL, &why) == -1);
    CHECK_MSG(strstr(why.text, "black must be") && strstr(why.text, "--black-level"), "%s", why.text);
    wrong = given;
    wrong.given_balance[1] = 0;
    CHECK(pupil_white_balance_begin(&c, &wrong, NULL, PUPIL_PIXEL_BAYER10, NULL, &why) == -1);
    CHECK_MSG(strstr(why.text, "balance must be"), "%s", why.text);
}

/* Every matrix of the table keeps grey grey: the balance, which comes before the matrix, relies on that. */
static void test_table(void)
{
    static const char *const names[] = {"imx219", "imx477", "ov5647"};
    pupil_why why;
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
        pupil_camera_sensor s;
        CHECK(pupil_camera_find_sensor(NULL, names[n], &s, &why) == 1 && s.has_matrix);
        for (int i = 0; i < 3; i++)
            CHECK(fabs(s.matrix[3 * i] + s.matrix[3 * i + 1] + s.matrix[3 * i + 2] - 1) < 1e-4);
    }
}

/* A large frame, of which each time one row in eight is looked at: ramps and noise whose average is not quite grey. */
static void test_rows(void)
{
    const uint32_t width = 320, height = 512;
    uint16_t *samples = calloc((size_t)width * height, sizeof *samples);
    const pupil_image_const image = {
        .data = samples, .stride_bytes = 2 * width, .width = width, .height = height, .pixel = PUPIL_PIXEL_BAYER16};
    const pupil_colour_options automatic = {0};
    const uint32_t light[3] = {10000, 20000, 16000}; /* of red, green and blue */
    pupil_white_balance c;
    pupil_frame_info info = {0};
    pupil_why why;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            samples[(size_t)y * width + x] =
                (uint16_t)(light[y % 2 + x % 2] * (1 + y / 2 % 2) + check_random() % 1000); /* RGGB */
    CHECK(pupil_white_balance_begin(&c, &automatic, NULL, image.pixel, NULL, &why) == 0);
    for (int i = 0; i < 300; i++) {
        info.timestamp_ns = 1000000 + i * INT64_C(33333333);
        pupil_white_balance_frame(&c, &image, &info);
    }
    const double most = 1.5 * 20000 + 499.5; /* of green in the mean, with the noise */
    for (int k = 0; k < 3; k++)
        CHECK_MSG(fabs((double)c.coding.balance[k] / (most / (1.5 * light[k] + 499.5)) - 1) < 0.005, "channel %d: %g",
                  k, (double)c.coding.balance[k]);
    free(samples);
}

/* Time that goes backwards, or from one end of its range to the other: no step, or a full one. Light of a single colour
 * is not made completely grey. */
static void test_times(void)
{
    uint16_t samples[64];
    const pupil_image_const image = {
        .data = samples, .stride_bytes = 16, .width = 8, .height = 8, .pixel = PUPIL_PIXEL_BAYER16};
    const pupil_colour_options automatic = {0};
    pupil_white_balance c;
    pupil_why why;
    for (int i = 0; i < 64; i++) /* RGGB: twenty times as much green as red */
        samples[i] = (uint16_t)(i / 8 % 2 == 0 && i % 2 == 0 ? 1000 : 20000);
    CHECK(pupil_white_balance_begin(&c, &automatic, NULL, image.pixel, NULL, &why) == 0);
    pupil_white_balance_frame(&c, &image, &(pupil_frame_info){.timestamp_ns = 5000000000});
    CHECK(c.coding.balance[0] == (float)PUPIL_WHITE_BALANCE_MOST);
    for (int i = 0; i < 64; i++)
        samples[i] = 10000;
    const float before = c.coding.balance[0];
    pupil_white_balance_frame(&c, &image, &(pupil_frame_info){.timestamp_ns = 1000000000});
    CHECK(c.coding.balance[0] == before);
    pupil_white_balance_frame(&c, &image, &(pupil_frame_info){.timestamp_ns = INT64_MIN});
    CHECK(c.coding.balance[0] == before);
    pupil_white_balance_frame(&c, &image, &(pupil_frame_info){.timestamp_ns = INT64_MAX});
    CHECK(fabs((double)c.coding.balance[0] - 1.0) < 1e-6);
    const pupil_image_const other = {.data = samples,
                                     .stride_bytes = 2,
                                     .width = 8,
                                     .height = 8,
                                     .pixel = PUPIL_PIXEL_BAYER16}; /* rows too short: not looked at */
    pupil_white_balance_frame(&c, &other, &(pupil_frame_info){.timestamp_ns = INT64_MAX});
    CHECK(fabs((double)c.coding.balance[0] - 1.0) < 1e-6);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_grey();
    test_rate();
    test_full();
    test_off();
    test_known();
    test_table();
    test_rows();
    test_times();
    return check_end();
}
