/* Dark frames of codes: noise stays dark, a picture that is 4 stops too dark does not, and the way back to light
 * follows the law. */
#include "check.h"
#include "pupil/pupil.h"

#include <math.h>

#define SECOND INT64_C(1000000000)
#define SIDE   128
#define LEAST  (0.18 / 16.0) /* of the default, in frame units */

typedef struct camera {
    const char *name;
    uint32_t pixel;
    double black, white; /* codes */
    double noise;        /* standard deviation in the dark, codes */
    double finer_ev;     /* by how much the first code is below 2^-12 */
} camera;

/* 8 bits as from webcams, after their own sRGB curve; sensors at a low and at a high gain. */
static const camera cameras[] = {{"RGB8", PUPIL_PIXEL_RGB8, 0, 255, 1, 0},
                                 {"YUYV", PUPIL_PIXEL_YUYV, 16, 235, 1, 0},
                                 {"GREY8", PUPIL_PIXEL_GREY8, 0, 255, 0.5, 0},
                                 {"GREY10", PUPIL_PIXEL_GREY10, 64, 1023, 1, 0},
                                 {"BAYER10", PUPIL_PIXEL_BAYER10, 64, 1023, 1, 0},
                                 {"BAYER12", PUPIL_PIXEL_BAYER12, 256, 4095, 2, 0},
                                 {"BAYER12, gain 8", PUPIL_PIXEL_BAYER12, 256, 4095, 8, 0},
                                 {"BAYER14", PUPIL_PIXEL_BAYER14, 512, 16383, 3, 1.954},
                                 {"GREY16", PUPIL_PIXEL_GREY16, 0, 65535, 10, 4}};

static pupil_t pupil;
static unsigned char shown[SIDE * SIDE * 3];

static void start(double amplification_ev)
{
    pupil_config config;
    pupil_config_default(&config);
    config.flicker = 0;
    config.highlight_ev = 0;
    config.amplification_ev = amplification_ev;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
}

/* Sum of 12, with mean 0. */
static double gaussian(void)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += check_uniform();
    return sum;
}

static void put(const camera *c, void *frame, int i, double code)
{
    const double most = pow(2.0, ceil(log2(c->white))) - 1.0, rounded = fmin(fmax(floor(code + 0.5), 0.0), most);
    unsigned char *bytes = frame;
    uint16_t *words = frame;
    if (c->pixel == PUPIL_PIXEL_RGB8) {
        bytes[3 * i] = bytes[3 * i + 1] = bytes[3 * i + 2] = (unsigned char)rounded;
    } else if (c->pixel == PUPIL_PIXEL_YUYV) {
        bytes[2 * i] = (unsigned char)rounded;
        bytes[2 * i + 1] = 128;
    } else if (c->pixel == PUPIL_PIXEL_GREY8) {
        bytes[i] = (unsigned char)rounded;
    } else {
        words[i] = (uint16_t)rounded;
    }
}

/* A frame of 10,000 pixels around `code`, two of them hot at full; returns its exposure. */
static pupil_exposure look(const camera *c, double code, double noise, int hot, const pupil_frame_info *info)
{
    static uint16_t frame[SIDE * SIDE * 3 / 2];
    const pupil_coding coding = {.black = c->white > 255.0 ? (float)c->black : 0.0f, .white = 0.0f};
    const size_t bytes = pupil_row_bytes(c->pixel, SIDE);
    pupil_exposure e = {0};
    for (int i = 0; i < SIDE * SIDE; i++)
        put(c, frame, i, hot && i % 5000 == 17 ? 65535.0 : code + noise * gaussian());
    const pupil_image_const in = {.data = frame,
                                  .stride_bytes = (ptrdiff_t)bytes,
                                  .width = SIDE,
                                  .height = SIDE,
                                  .pixel = c->pixel,
                                  .coding = &coding};
    const pupil_image out = {
        .data = shown, .stride_bytes = SIDE * 3, .width = SIDE, .height = SIDE, .pixel = PUPIL_PIXEL_RGB8};
    CHECK(pupil_process(&pupil, &in, info, &out) == PUPIL_OK);
    CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK);
    return e;
}

/* The display code that a share of the green samples is at or below. */
static int quantile(double share)
{
    size_t count[256] = {0}, below = 0;
    int code = 0;
    for (size_t i = 1; i < sizeof shown; i += 3)
        count[shown[i]]++;
    while ((double)(below += count[code]) < share * SIDE * SIDE)
        code++;
    return code;
}

static void check_lens_cap(void)
{
    for (size_t i = 0; i < sizeof cameras / sizeof cameras[0]; i++) {
        const camera *c = &cameras[i];
        printf("lens cap, %-16s", c->name);
        for (double most = 32.0; most > 2.0; most = most > 6.0 ? 6.0 : most - 1.0) {
            start(most);
            const pupil_exposure e = look(c, c->black, c->noise, 1, NULL);
            const int middle = quantile(0.5), high = quantile(0.99);
            printf("  %2.0f EV: scale %6.1f, codes %3d %3d", most, e.scale, middle, high);
            if (most == 32.0)
                CHECK_MSG(high >= 200, "%s: without a limit 99 %% are below code %d", c->name, high);
            if (most != 4.0)
                continue;
            CHECK(e.state == PUPIL_STATE_LIMITED && e.reason == PUPIL_REASON_AMPLIFICATION);
            CHECK_MSG(fabs(log2(e.scale) - 4.0 - c->finer_ev) < 0.01, "%s: scale %g", c->name, e.scale);
            CHECK_MSG(middle == 0 && high <= 90, "%s: codes %d and %d", c->name, middle, high);
        }
        printf("\n");
    }
}

/* The code of light, of the linear ones and of sRGB. */
static double code_of(const camera *c, double light)
{
    const int curved = c->pixel == PUPIL_PIXEL_RGB8 || c->pixel == PUPIL_PIXEL_YUYV;
    const double value = !curved ? light : light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
    return c->black + value * (c->white - c->black);
}

/* The limit applies to the frame's codes: in scene light it depends on exposure and gain. */
static void check_exposed(void)
{
    for (int stops = -6; stops <= 6; stops += 3) {
        const pupil_frame_info info = {.timestamp_ns = SECOND, .exposure_s = exp2(stops - 1), .gain = 2.0};
        start(4.0);
        const pupil_exposure e = look(&cameras[0], 0.0, 0.0, 0, &info);
        CHECK(e.state == PUPIL_STATE_LIMITED && e.reason == PUPIL_REASON_AMPLIFICATION);
        CHECK_MSG(fabs(e.adapted_ev - (log2(LEAST) - stops)) < 1e-6, "2^%d s x gain: %g", stops, e.adapted_ev);
    }
}

/* 4 stops too dark, with noise that dithers it: as bright as a right frame. Each further stop of the scene makes the
 * picture a stop darker. */
static void check_too_dark(void)
{
    for (size_t i = 0; i < sizeof cameras / sizeof cameras[0]; i++) {
        const camera *c = &cameras[i];
        start(4.0);
        look(c, code_of(c, LEAST), 0.3, 0, NULL);
        const int right = quantile(0.5);
        start(4.0);
        const pupil_exposure e = look(c, code_of(c, 0.25 * LEAST * exp2(-c->finer_ev)), 0.3, 0, NULL);
        const int darker = quantile(0.5);
        printf("4 stops too dark, %-16s shown at code %3d; %.1f stops, at %3d\n", c->name, right, 6.0 + c->finer_ev,
               darker);
        CHECK_MSG(right >= 112 && right <= 122, "%s: at %d", c->name, right);  /* 0.18 is code 118 */
        CHECK_MSG(darker >= 50 && darker <= 72, "%s: at %d", c->name, darker); /* 0.045: 59 */
        CHECK(e.state == PUPIL_STATE_LIMITED && e.reason == PUPIL_REASON_AMPLIFICATION);
    }
}

/* Statistics have the light of the first code; those of floats have none, and no limit. */
static void check_codes(void)
{
    static const struct {
        uint32_t pixel, light;
        float black;
        double first;
    } rows[] = {{PUPIL_PIXEL_RGB32F, 0, 0, 0},
                {PUPIL_PIXEL_RGBA16F, 0, 0, 0},
                {PUPIL_PIXEL_RGBA16, 0, 0, 1.0 / 65535},
                {PUPIL_PIXEL_BGR8, 0, 0, 1.0 / 255 / 12.92},
                {PUPIL_PIXEL_NV12, 0, 0, 1.0 / 219 / 12.92},
                {PUPIL_PIXEL_NV12, PUPIL_LIGHT_LINEAR, 0, 1.0 / 219},
                {PUPIL_PIXEL_YUYV, PUPIL_LIGHT_BT709, 0, 1.0 / 219 / 4.5},
                {PUPIL_PIXEL_RGB10A2, 0, 0, 1.0 / 1023 / 12.92},
                {PUPIL_PIXEL_RGB10A2, PUPIL_LIGHT_HLG, 0, 1.0 / 1023 / 1023 / 3},
                {PUPIL_PIXEL_GREY8, 0, 16, 1.0 / 239},
                {PUPIL_PIXEL_GREY12, PUPIL_LIGHT_SRGB, 0, 1.0 / 4095 / 12.92},
                {PUPIL_PIXEL_BAYER10, 0, 64, 1.0 / 959},
                {PUPIL_PIXEL_BAYER14, 0, 512, 1.0 / 15871}};
    static uint16_t pixels[4096];
    start(4.0);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const pupil_coding coding = {.light = rows[i].light, .black = rows[i].black};
        const pupil_image_const in = {.data = pixels,
                                      .stride_bytes = (ptrdiff_t)pupil_row_bytes(rows[i].pixel, 4),
                                      .width = 4,
                                      .height = 4,
                                      .pixel = rows[i].pixel,
                                      .chroma = pixels + 1024,
                                      .chroma_stride_bytes = 4,
                                      .coding = &coding};
        pupil_stats stats, sum;
        pupil_stats_clear(&stats);
        pupil_stats_clear(&sum);
        CHECK(pupil_meter_rows(&pupil, &in, 0, 4, &stats) == PUPIL_OK);
        CHECK_MSG(fabs((double)stats.code_light - rows[i].first) <= 2e-4 * rows[i].first, "format %u: %g, not %g",
                  rows[i].pixel, (double)stats.code_light, rows[i].first);
        CHECK(pupil_stats_add(&sum, &stats) == PUPIL_OK && sum.code_light == stats.code_light);
        stats.code_light = -1.0f;
        CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_ERR_STATS);
        stats.code_light = NAN;
        CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_ERR_STATS);
    }
    static float dark[16 * 3];
    for (int i = 0; i < 48; i++)
        dark[i] = 0x1p-13f;
    const pupil_image_const in = {
        .data = dark, .stride_bytes = 48, .width = 4, .height = 4, .pixel = PUPIL_PIXEL_RGB32F};
    pupil_exposure e;
    pupil_reset(&pupil);
    CHECK(pupil_meter(&pupil, &in, NULL) == PUPIL_OK && pupil_get_exposure(&pupil, &e) == PUPIL_OK);
    CHECK(e.adapted_ev == -13.0 && e.state == PUPIL_STATE_SETTLED && e.reason == PUPIL_REASON_NONE);
}

/* Cap on, cap off: each step is the law's share of the distance to the target, which in the dark is at the limit. */
static void check_way_back(void)
{
    static const int rates[] = {24, 30, 60, 240};
    const camera *c = &cameras[0];
    const double limit = log2(LEAST);
    double half[4] = {0};
    for (int r = 0; r < 4; r++) {
        const int fps = rates[r];
        double before = 0.0, most = 0.0;
        start(4.0);
        for (int n = 0; n <= 4 * fps; n++) {
            const int dark = n > fps && n <= 3 * fps;
            const pupil_frame_info info = {.timestamp_ns = SECOND + n * SECOND / fps};
            const pupil_exposure e = look(c, dark ? 0.0 : 118.0, 0.0, 0, &info);
            const double target = fmax(e.metered_ev, limit), tau = target > before ? 0.3 : 0.9;
            if (n)
                CHECK_MSG(fabs(e.adapted_ev - before - (1.0 - exp(-e.dt_s / tau)) * (target - before)) < 1e-9,
                          "%d fps, frame %d: %g", fps, n, e.adapted_ev);
            CHECK(e.adapted_ev >= limit);
            CHECK(e.reason == (dark ? PUPIL_REASON_AMPLIFICATION : PUPIL_REASON_NONE));
            most = n ? fmax(most, fabs(e.adapted_ev - before)) : 0.0;
            before = e.adapted_ev;
            if (n == 3 * fps + fps / 2)
                half[r] = e.adapted_ev;
        }
        printf("cap on for 2 s, off: at %3d fps the largest step is %.3f stops; half a second later at %+.3f EV\n", fps,
               most, half[r]);
        CHECK(fabs(half[r] - half[0]) < 1e-6);
    }
}

/* The limit applies to codes: a longer exposure moves it to darker scenes. */
static void check_exposures(void)
{
    const camera *c = &cameras[0];
    for (int gain = 1; gain <= 16; gain *= 4) {
        const pupil_frame_info info = {.timestamp_ns = SECOND, .exposure_s = 0.01, .gain = gain};
        start(4.0);
        const pupil_exposure e = look(c, 1.0, 0.0, 0, &info);
        CHECK(fabs(e.adapted_ev - log2(LEAST / (0.01 * gain))) < 1e-9 && e.reason == PUPIL_REASON_AMPLIFICATION);
    }
    start(32.0);
    const pupil_exposure e = look(c, 1.0, 0.0, 0, NULL);
    CHECK(e.reason == PUPIL_REASON_NONE && e.scale > 500.0 && e.state == PUPIL_STATE_SETTLED);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_lens_cap();
    check_exposed();
    check_too_dark();
    check_codes();
    check_way_back();
    check_exposures();
    return check_end();
}
