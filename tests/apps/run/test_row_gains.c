/* `pupil run --row-gains` on the fake camera under lamps: bands of a short exposure are removed, both in the light and
 * in the picture; daylight gets none; unknown values are reported; any number of threads gives the same picture.
 */
#include "run_rig.h"

enum { WIDTH = 64, HEIGHT = 480, WATCHED = 60 };
static const double fps = 30, readout_s = 0.025;

static void arguments(const char *const words[])
{
    for (rig_argument_count = 1; words[rig_argument_count - 1]; rig_argument_count++)
        rig_arguments[rig_argument_count] = (char *)(uintptr_t)words[rig_argument_count - 1];
}
#define ARGUMENTS(...) arguments((const char *const[]){__VA_ARGS__, NULL})

/* Lines of 64 pixels and 196 of blanking; their rate makes 480 of them 25 ms. */
static fake_v4l2_config camera(uint32_t fourcc, double modulation)
{
    fake_v4l2_config c;
    fake_v4l2_config_default(&c);
    c.fps = fps;
    c.only_format = fourcc;
    c.width = WIDTH, c.height = HEIGHT;
    c.flat = 600;
    c.lamp_hz = 100, c.modulation = modulation, c.readout_s = readout_s;
    c.pixel_rate = (int64_t)(HEIGHT / readout_s * (WIDTH + 196)), c.hblank = 196;
    return c;
}

/* The difference of the brightest and the darkest row of light, EV; gains NULL: uncorrected. */
static double bands(const live_run *r, const float *gain, double exposure_s)
{
    const fake_v4l2_picture p = {.height = HEIGHT,
                                 .lamp_hz = 100,
                                 .modulation = 0.3,
                                 .readout_s = readout_s,
                                 .exposure_s = exposure_s,
                                 .end_s = (double)(r->frame.info.sequence + 1) / fps};
    double low = 1e9, high = -1e9;
    for (uint32_t y = 0; y < HEIGHT; y++) {
        const double ev = log2(fake_v4l2_lamp(&p, y) * (gain ? (double)gain[y] : 1.0));
        low = fmin(low, ev);
        high = fmax(high, ev);
    }
    return high - low;
}

/* The same in codes of the picture, green of each row. */
static double shown_bands(const live_run *r)
{
    double low = 1e9, high = -1e9;
    for (uint32_t y = 0; y < HEIGHT; y++) {
        double sum = 0.0;
        for (uint32_t x = 0; x < WIDTH; x++)
            sum += shown(r, x, y)[1];
        low = fmin(low, sum / WIDTH);
        high = fmax(high, sum / WIDTH);
    }
    return high - low;
}

static const float *gains_of(const live_run *r, uint64_t with_before)
{
    return r->lamps.with > with_before ? r->lamps.gain : NULL;
}

typedef struct watched {
    double ev, codes, camera_ev; /* of the worst frame */
} watched;

static watched watch(live_run *r, int frames, double exposure_s)
{
    watched w = {0};
    for (int i = 0; i < frames; i++) {
        const uint64_t before = r->lamps.with;
        step(r);
        w.ev = fmax(w.ev, bands(r, gains_of(r, before), exposure_s));
        w.codes = fmax(w.codes, shown_bands(r));
        w.camera_ev = fmax(w.camera_ev, bands(r, NULL, exposure_s));
    }
    return w;
}

static void skip(live_run *r, int frames)
{
    for (int i = 0; i < frames; i++)
        step(r);
}

static int tells(const live_run *r, const char *words)
{
    char text[400];
    run_row_gains_tell(&r->lamps, text, sizeof text);
    return strstr(text, words) != NULL;
}

/* Before and after, in the camera's own picture and in the adapted one. */
static void test_bands(uint32_t fourcc, uint32_t mode)
{
    const fake_v4l2_config c = camera(fourcc, 0.3);
    const char *name = (const char *)&fourcc;
    live_run r;
    ARGUMENTS("--shutter", "1ms", "--mains", "50");
    begin_with(&r, mode, &c, 10, 16, 4.0);
    skip(&r, 60);
    const watched without = watch(&r, WATCHED, 1e-3);
    CHECK(r.lamps.frames == 0 && !*r.remark.text);
    end(&r);
    ARGUMENTS("--shutter", "1ms", "--mains", "50", "--row-gains");
    begin_with(&r, mode, &c, 10, 16, 4.0);
    CHECK_MSG(!*r.remark.text, "%s", r.remark.text);
    skip(&r, 60);
    const watched with = watch(&r, WATCHED, 1e-3);
    printf("%.4s, mode %u: %.3f EV and %.1f codes without, %.4f EV and %.1f codes with\n", name, mode, without.ev,
           without.codes, with.ev, with.codes);
    CHECK_MSG(without.ev > 0.8 && without.codes > 20, "%.4s: %g EV, %g codes without", name, without.ev, without.codes);
    CHECK_MSG(with.ev <= 0.05 && with.codes <= 2, "%.4s: %g EV, %g codes with", name, with.ev, with.codes);
    CHECK(tells(&r, "of 120 frames") && !tells(&r, "("));
    end(&r);
}

/* The mains are found from the bands, and the readout is given. */
static void test_found(void)
{
    fake_v4l2_config c = camera(V4L2_PIX_FMT_Y12, 0.3);
    live_run r;
    c.pixel_rate = 0;
    ARGUMENTS("--shutter", "1ms", "--row-gains", "--readout", "26");
    begin_with(&r, RUN_BOTH, &c, 10, 16, 4.0);
    CHECK_MSG(!*r.remark.text, "%s", r.remark.text);
    skip(&r, 90);
    const watched w = watch(&r, WATCHED, 1e-3);
    printf("mains found, readout told 4 %% wrong: %.4f EV\n", w.ev);
    CHECK_MSG(w.ev <= 0.05, "%g EV", w.ev);
    end(&r);
}

/* Steps of the exposure: its middle moves against the driver's stamp. */
static void test_steps(void)
{
    static const double exposure_s[] = {3e-3, 1e-3, 5e-3, 2e-3};
    const fake_v4l2_config c = camera(V4L2_PIX_FMT_Y12, 0.3);
    double worst = 0.0;
    live_run r;
    ARGUMENTS("--shutter", "1ms", "--mains", "50", "--row-gains");
    rig_delay = c.control_delay;
    begin_with(&r, RUN_BOTH, &c, 10, 16, 2.0);
    rig_delay = 0;
    skip(&r, 90);
    for (int i = 0; i < 4; i++) {
        r.sensor.loop.config.manual_exposure_s = exposure_s[i];
        CHECK(pupil_camera_loop_retune(&r.sensor.loop, &r.sensor.loop.config) == PUPIL_OK);
        for (int k = 0; k < 20; k++) {
            const uint64_t before = r.lamps.with;
            step(&r);
            worst = fmax(worst, bands(&r, gains_of(&r, before), r.record.exposure_s));
        }
        CHECK_MSG(fabs(r.record.exposure_s - exposure_s[i]) < 1e-6, "%g s", r.record.exposure_s);
    }
    printf("exposure in steps: %.4f EV at most\n", worst);
    CHECK_MSG(worst <= 0.05, "%g EV", worst);
    end(&r);
}

/* With nothing to remove, and with something unknown. */
static void test_none(void)
{
    fake_v4l2_config c = camera(V4L2_PIX_FMT_Y12, 0.0);
    live_run r;
    ARGUMENTS("--shutter", "1ms", "--mains", "50", "--row-gains");
    begin_with(&r, RUN_BOTH, &c, 10, 16, 4.0);
    skip(&r, 90);
    CHECK(r.lamps.frames == 90 && r.lamps.with == 0 && shown_bands(&r) == 0.0);
    CHECK(tells(&r, "in 0 of 90 frames (no flicker was found)"));
    end(&r);

    c = camera(V4L2_PIX_FMT_Y12, 0.3);
    ARGUMENTS("--shutter", "10ms", "--mains", "50", "--row-gains"); /* a whole period */
    begin_with(&r, RUN_BOTH, &c, 10, 16, 0.4);
    skip(&r, 90);
    CHECK(r.lamps.with == 0 && tells(&r, "(the exposure is a flicker period"));
    end(&r);

    c.pixel_rate = 0;
    ARGUMENTS("--shutter", "1ms", "--mains", "50", "--row-gains");
    begin_with(&r, RUN_BOTH, &c, 10, 16, 4.0);
    CHECK_MSG(strstr(r.remark.text, "PIXEL_RATE") && strstr(r.remark.text, "--readout"), "%s", r.remark.text);
    skip(&r, 30);
    CHECK(r.lamps.with == 0 && tells(&r, "(the camera's readout is not known"));
    end(&r);

    ARGUMENTS("--row-gains", "--readout", "25");
    begin_with(&r, RUN_DIGITAL, &c, 10, 16, 4.0);
    CHECK_MSG(strstr(r.remark.text, "--mains"), "%s", r.remark.text);
    skip(&r, 30);
    CHECK(r.lamps.with == 0 && tells(&r, "--mains"));
    end(&r);

    ARGUMENTS("--row-gains", "--readout", "25", "--mains", "50"); /* the exposure is unknown, and short */
    begin_with(&r, RUN_DIGITAL, &c, 10, 16, 4.0);
    CHECK(!*r.remark.text);
    skip(&r, 60);
    const watched w = watch(&r, WATCHED, 1e-3);
    CHECK_MSG(w.ev <= 0.05, "%g EV", w.ev);
    end(&r);
}

/* Rows that share a gain stay in one thread. */
static void test_threads(uint32_t fourcc)
{
    const fake_v4l2_config c = camera(fourcc, 0.3);
    live_run r;
    ARGUMENTS("--shutter", "1ms", "--mains", "50", "--row-gains");
    begin_with(&r, RUN_BOTH, &c, 10, 16, 4.0);
    skip(&r, 60);
    CHECK(r.lamps.with > 0);
    for (unsigned threads = 2; threads <= 7; threads++) {
        frame_pipeline other;
        CHECK(frame_pipeline_open(&other, &r.options.shown.config, threads) == 0);
        other.pupil = r.pipeline.pupil;
        cpu_engine_row_gains(other.cpu, r.lamps.gain);
        CHECK(frame_pipeline_map_again(&other, &r.pipeline.curve, &r.frame) == 0);
        const pupil_image display = other.display;
        CHECK_MSG(memcmp(display.data, r.pipeline.display.data, (size_t)display.stride_bytes * display.height) == 0,
                  "%.4s: %u threads show another picture", (const char *)&fourcc, threads);
        frame_pipeline_close(&other);
    }
    end(&r);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_bands(V4L2_PIX_FMT_Y12, RUN_SENSOR);
    test_bands(V4L2_PIX_FMT_Y12, RUN_BOTH);
    test_bands(V4L2_PIX_FMT_SRGGB10P, RUN_BOTH);
    test_bands(V4L2_PIX_FMT_YUYV, RUN_BOTH);
    test_bands(V4L2_PIX_FMT_NV12, RUN_BOTH);
    test_found();
    test_steps();
    test_none();
    test_threads(V4L2_PIX_FMT_Y12);
    test_threads(V4L2_PIX_FMT_NV12);
    test_threads(V4L2_PIX_FMT_SRGGB10P);
    return check_end();
}
