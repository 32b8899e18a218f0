/* The level on the GPU compared with pupil_adapt for extreme numbers: exposures and calibrations up to their limits,
 * time constants of hours, limits that leave no room, a lock from the start, reset and retune in between, a full
 * ring. */
#include <math.h>

#include "frames.h"
#include "gl_test.h"
#include "pupil/gles.h"

#define SECOND_NS UINT64_C(1000000000)
#define SIDE      2

typedef struct bench {
    pupil_gles gles;
    pupil_t pupil;
    frame frame;
    int64_t now_ns;
} bench;

static bench b;

static pupil_config usual(void)
{
    pupil_config config;
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    config.ev_min = -64.0;
    config.ev_max = 64.0;
    return config;
}

static void begin_with(uint32_t pixel, const pupil_config *config)
{
    pupil_gles_config gles_config;
    pupil_why why = {""};
    pupil_gles_config_default(&gles_config);
    gles_config.pixel = pixel;
    gles_config.width = gles_config.height = SIDE;
    gles_config.adapt = PUPIL_GLES_ADAPT_GPU;
    CHECK(pupil_init(&b.pupil, config) == PUPIL_OK);
    b.now_ns = 1;
    const int error = pupil_gles_init(&b.gles, &gles_config, &b.pupil, pupil_egl_get_proc, &why);
    CHECK_MSG(error == PUPIL_OK, "%s", why.text);
    if (b.frame.memory)
        frame_free(&b.frame);
    b.frame = frame_make(SIDE, SIDE, pixel, 0, 0);
}

static void begin(const pupil_config *config)
{
    begin_with(PUPIL_PIXEL_RGB32F, config);
}

static void meter(double light, double dt_s, double exposure_s, double gain)
{
    const pupil_frame_info info = {
        .timestamp_ns = b.now_ns += (int64_t)(dt_s * 1e9), .exposure_s = exposure_s, .gain = gain};
    frame_fill(&b.frame, light, light, light);
    CHECK(pupil_gles_upload(&b.gles, &b.frame.image) == PUPIL_OK);
    CHECK(pupil_gles_meter(&b.gles, &info) == PUPIL_OK);
}

/* The difference of the two levels, in stops. */
static double collect(void)
{
    pupil_stats stats;
    pupil_frame_info info;
    pupil_exposure exposure;
    pupil_gles_status status;
    CHECK(pupil_gles_collect(&b.gles, 60 * SECOND_NS, &stats, &info) == PUPIL_OK);
    CHECK(pupil_adapt(&b.pupil, &stats, &info) == PUPIL_OK);
    CHECK(pupil_get_exposure(&b.pupil, &exposure) == PUPIL_OK);
    CHECK(pupil_gles_get_status(&b.gles, &status) == PUPIL_OK && status.level_known);
    return fabs((double)status.level_q24 * 0x1p-24 - exposure.adapted_ev);
}

static double step(double light, double dt_s, double exposure_s, double gain)
{
    meter(light, dt_s, exposure_s, gain);
    return collect();
}

static void compare_pictures(gl_test *test, const pupil_frame_info *info, const char *what)
{
    uint8_t gpu[SIDE * SIDE * 4], cpu[SIDE * SIDE * 4];
    const pupil_image out = {
        .data = cpu, .stride_bytes = SIDE * 4, .width = SIDE, .height = SIDE, .pixel = PUPIL_PIXEL_RGBA8};
    const pupil_gles_target target = {
        .framebuffer = gl_test_framebuffer(test, SIDE, SIDE), .width = SIDE, .height = SIDE, .top_first = 1};
    pupil_curve curve;
    CHECK(pupil_get_curve(&b.pupil, info, &curve) == PUPIL_OK);
    CHECK(pupil_map_rows(&b.pupil, &curve, &b.frame.image, &out) == PUPIL_OK);
    CHECK(pupil_gles_map(&b.gles, NULL, &target) == PUPIL_OK);
    gl_test_read(test, gpu);
    for (size_t i = 0; i < sizeof gpu; i++)
        CHECK_MSG(abs(gpu[i] - cpu[i]) <= 1, "%s: %d, and %d by the CPU", what, gpu[i], cpu[i]);
}

static void test_exposures(gl_test *test)
{
    static const double lights[] = {0x1p-30, 0x1p-14, 0.18, 0x1p30};
    char what[96];
    for (int calibration = -64; calibration <= 64; calibration += 64) {
        pupil_config config = usual();
        config.floor = 0x1p-30f;
        config.calibration = ldexp(1.0, calibration);
        config.tau_light_s = config.tau_dark_s = 0.0;
        begin(&config);
        for (int exposure = -64; exposure <= 64; exposure += 32)
            for (int gain = -64; gain <= 64; gain += 32)
                for (int i = 0; i < 4; i++) {
                    snprintf(what, sizeof what, "calibration 2^%d, exposure 2^%d, gain 2^%d, light %g", calibration,
                             exposure, gain, lights[i]);
                    const double off = step(lights[i], 1.0, ldexp(1.0, exposure), ldexp(1.0, gain));
                    CHECK_MSG(off <= 2e-6, "%s: %g stops off", what, off);
                    compare_pictures(test, NULL, what);
                }
        pupil_gles_close(&b.gles);
    }
}

/* Codes that are too dark: the amplification limit, regardless of the exposure; not for light. */
static void test_dark_codes(gl_test *test)
{
    static const uint32_t pixels[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_RGB8, PUPIL_PIXEL_RGB10A2, PUPIL_PIXEL_GREY10};
    static const double lights[] = {0.0, 0.0005, 0.005, 0.02, 0.18};
    char what[96];
    for (int i = 0; i < 4; i++) {
        pupil_config config = usual();
        config.tau_light_s = config.tau_dark_s = 0.0;
        begin_with(pixels[i], &config);
        for (int gain = -4; gain <= 4; gain += 4)
            for (int j = 0; j < 5; j++) {
                pupil_exposure e;
                snprintf(what, sizeof what, "format %u, light %g, gain 2^%d", pixels[i], lights[j], gain);
                const double off = step(lights[j], 1.0, 1.0, ldexp(1.0, gain));
                CHECK_MSG(off <= 2e-6, "%s: %g stops off", what, off);
                CHECK(pupil_get_exposure(&b.pupil, &e) == PUPIL_OK);
                CHECK_MSG((e.reason == PUPIL_REASON_AMPLIFICATION) == (j < (i == 2 ? 2 : 3)), "%s: reason %u", what,
                          e.reason);
                compare_pictures(test, NULL, what);
            }
        pupil_gles_close(&b.gles);
    }
}

/* Of floats and halves, black pixels are left out while there are others; of codes they count. */
static void test_black(void)
{
    static const uint32_t pixels[] = {PUPIL_PIXEL_RGB32F, PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_RGB8};
    static const float floors[] = {0x1p-14f, 0.0001f, 0.3f, 0x1p-30f};
    for (int i = 0; i < 3 * 4 * 2; i++) {
        pupil_config config = usual();
        config.tau_light_s = config.tau_dark_s = 0.0;
        config.floor = floors[i % 4];
        if (i / 4 % 2) { /* pixels are in the rows and columns 4 and 12 */
            memset(config.weight, 0, sizeof config.weight);
            config.weight[4][12] = 255;
            config.weight[12][4] = 3;
        }
        begin_with(pixels[i / 8], &config);
        (void)step(0.5, 1.0, 1.0, 1.0);
        for (uint32_t lit = 0; lit < 16; lit++) {
            const pupil_frame_info info = {.timestamp_ns = b.now_ns += 1000000000, .exposure_s = 1.0, .gain = 1.0};
            for (uint32_t at = 0; at < 4; at++) {
                const double light = lit >> at & 1 ? 0.9 / (1 + at) : at == 1 ? -1.0 : 0.0;
                frame_set(&b.frame, at % 2, at / 2, light, light, light, 1);
            }
            CHECK(pupil_gles_upload(&b.gles, &b.frame.image) == PUPIL_OK);
            CHECK(pupil_gles_meter(&b.gles, &info) == PUPIL_OK);
            const double off = collect();
            CHECK_MSG(off <= 2e-6, "format %u, floor %g, weights %d, pixels %x: %g stops off", pixels[i / 8],
                      (double)config.floor, i / 4 % 2, lit, off);
        }
        pupil_gles_close(&b.gles);
    }
}

static void test_slow(double frame_s, double tau_s, unsigned frames)
{
    pupil_config config = usual();
    double most = 0.0;
    config.tau_light_s = tau_s;
    config.tau_dark_s = tau_s;
    begin(&config);
    step(0x1p-10, frame_s, 0.0, 0.0);
    for (unsigned i = 0; i < frames; i++)
        most = fmax(most, step(0x1p14, frame_s, 0.0, 0.0));
    printf("%g s a frame, tau %g s, %u frames: %.1e stops\n", frame_s, tau_s, frames, most);
    CHECK_MSG(most <= 2e-6, "%g stops", most);
    pupil_gles_close(&b.gles);
}

static void test_no_room(void)
{
    pupil_config config = usual();
    config.ev_min = config.ev_max = 1.25;
    begin(&config);
    CHECK(step(0x1p10, 0.1, 0.0, 0.0) == 0.0);
    CHECK(step(0x1p-10, 0.1, 0.0, 0.0) == 0.0);
    config = usual();
    CHECK(pupil_retune(&b.pupil, &config) == PUPIL_OK && pupil_gles_retune(&b.gles, &b.pupil, NULL) == PUPIL_OK);
    CHECK(step(0x1p10, 0.0, 0.0, 0.0) == 0.0); /* no time, no step */
    pupil_gles_close(&b.gles);
}

static void test_lock(void)
{
    pupil_config config = usual();
    config.lock = 1;
    begin(&config);
    CHECK(step(0x1p10, 0.1, 0.0, 0.0) <= 2e-6); /* the first light is still taken */
    CHECK(step(0x1p-10, 0.1, 0.0, 0.0) <= 2e-6);
    pupil_gles_close(&b.gles);
}

static void test_reset(void)
{
    const pupil_config config = usual();
    begin(&config);
    CHECK(step(0x1p10, 0.1, 0.0, 0.0) <= 2e-6);
    CHECK(pupil_reset(&b.pupil) == PUPIL_OK && pupil_gles_retune(&b.gles, &b.pupil, NULL) == PUPIL_OK);
    const double reset = step(0x1p-10, 0.1, 0.0, 0.0); /* no frame before: at once */
    CHECK_MSG(reset <= 2e-6, "after a reset: %g stops", reset);
    pupil_gles_close(&b.gles);

    begin(&config); /* a dropped frame has no effect */
    meter(0x1p10, 0.1, 0.0, 0.0);
    CHECK(pupil_gles_retune(&b.gles, &b.pupil, NULL) == PUPIL_OK);
    const double dropped = step(0x1p-10, 0.1, 0.0, 0.0);
    CHECK_MSG(dropped <= 2e-6, "after a dropped frame: %g stops", dropped);
    pupil_gles_close(&b.gles);
}

/* A frame that comes when the ring is full is not metered, but mapped with its own exposure. */
static void test_full_ring(gl_test *test)
{
    const pupil_config config = usual();
    begin(&config);
    CHECK(step(0.25, 0.1, 0.01, 1.0) <= 2e-6);
    for (int i = 0; i < 3; i++)
        meter(0.25, 0.1, 0.01, 1.0);
    const pupil_frame_info info = {.timestamp_ns = b.now_ns += 100000000, .exposure_s = 0.04, .gain = 1.0};
    frame_fill(&b.frame, 1.0, 1.0, 1.0);
    CHECK(pupil_gles_upload(&b.gles, &b.frame.image) == PUPIL_OK);
    CHECK(pupil_gles_meter(&b.gles, &info) == PUPIL_GLES_BUSY);
    compare_pictures(test, &info, "a full ring");
    for (int i = 0; i < 3; i++)
        CHECK(collect() <= 2e-6);
    pupil_gles_close(&b.gles);
}

int main(int argc, char **argv)
{
    static gl_test test;
    check_begin(argc, argv);
    const int status = gl_test_open(&test, PUPIL_GLES_BEST);
    if (status)
        return status;
    test_exposures(&test);
    test_dark_codes(&test);
    test_black();
    test_slow(1.0 / 240.0, 60.0, 200);
    test_slow(1.0 / 1000.0, 9.5e5, 1000); /* a step of 4.5 / 2^32: if rounded each time, 11 % off */
    test_no_room();
    test_lock();
    test_reset();
    test_full_ring(&test);
    frame_free(&b.frame);
    gl_test_close(&test);
    return check_end();
}
