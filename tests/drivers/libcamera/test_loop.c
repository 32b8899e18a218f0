/* libcamera's exposure in a closed loop: the light changes, settings are refused, frames report what they were taken
 * with or do not. */
#include "rig.h"

static fake_libcamera_config sensor_config(void)
{
    fake_libcamera_config c;
    fake_libcamera_config_default(&c);
    c.sensor = 1;
    c.fourcc = V4L2_PIX_FMT_SRGGB10;
    c.black = 4096;
    c.delay = 2;
    return c;
}

/* A webcam refuses an exposure time before, and in the request that turns its automatic exposure off. */
static void test_takes_over_first(void)
{
    fake_libcamera_config c;
    rig r;
    const fake_libcamera_log *log;
    fake_libcamera_config_default(&c);
    CHECK_MSG(rig_open(&r, &c, NULL) == 0, "%s", why.text);
    CHECK(!fake_libcamera_automatic(r.fake));
    rig_run(&r, 20);
    const size_t logged = fake_libcamera_logged(r.fake, &log);
    unsigned asked = 0;
    CHECK(log[0].ask.automatic == -1 && log[0].ask.exposure_s == 0.0);
    for (size_t i = 1; i < logged; i++) {
        CHECK(log[i].ask.automatic == 0 && !log[i].refused);
        asked += log[i].ask.exposure_s > 0.0;
        CHECK(log[i].ask.gain == 0.0); /* for a webcam an invented scale */
    }
    CHECK(asked > 0 && rig_counts(&r)->cancelled == 0);
    const pupil_live *live = pupil_live_get(r.source);
    CHECK_MSG(strstr(live->remark.text, "is a webcam") && strstr(live->remark.text, "v4l2:"), "%s", live->remark.text);
    pupil_camera_limits limits;
    pupil_camera_get_limits(pupil_live_camera(r.source), &limits);
    CHECK(!limits.has_gain && limits.gain_min == 1.0 && limits.gain_max == 1.0);
    CHECK(pupil_live_give_back(r.source, &why) == 0);
    CHECK(fake_libcamera_automatic(r.fake)); /* its node is not there, so libcamera has to */
    CHECK(rig_next(&r, 0) == PUPIL_SOURCE_FRAME);
    rig_close(&r);
}

/* Exposure, gain and frame duration go together, and the frame's own metadata says what it was taken with. */
static void test_sensor(void)
{
    for (uint32_t delay = 0; delay <= 3; delay++) {
        fake_libcamera_config c = sensor_config();
        rig r;
        const fake_libcamera_log *log;
        char what[64];
        c.delay = delay;
        CHECK_MSG(rig_open(&r, &c, &(pupil_live_options){.capture = {.fps = 30.0}}) == 0, "%s", why.text);
        CHECK(*pupil_live_get(r.source)->remark.text == 0 && pupil_live_is_linear(r.source));
        fake_libcamera_light(r.fake, 0.125);
        rig_run(&r, 60);
        snprintf(what, sizeof what, "sensor, delay %u, x8", delay);
        rig_step(&r, 0.125, 1.0, 0, what);
        snprintf(what, sizeof what, "sensor, delay %u, /8", delay);
        rig_step(&r, 1.0, 0.125, 0, what);
        for (int i = 0; i < 30; i++) {
            CHECK(rig_next(&r, 1) == PUPIL_SOURCE_FRAME);
            CHECK(r.info.exposure_s == fake_libcamera_exposure(r.fake, r.info.sequence));
            CHECK(r.info.gain == fake_libcamera_gain(r.fake, r.info.sequence));
        }
        const size_t logged = fake_libcamera_logged(r.fake, &log);
        for (size_t i = 1; i < logged; i++)
            if (log[i].ask.exposure_s > 0.0)
                CHECK(log[i].ask.gain > 0.0 && fabs(log[i].ask.frame_least_s - 1.0 / 30) < 1e-9 &&
                      log[i].ask.frame_most_s >= log[i].ask.exposure_s);
        rig_close(&r);
    }
}

/* Frames without metadata, taken at once and by a program that is slower than the camera, so that frames wait in their
 * requests: the setting in force is determined by the clock, and nothing overshoots. */
static void test_no_metadata(void)
{
    for (int slow = 0; slow < 2; slow++)
        for (uint32_t delay = 1; delay <= 3; delay++) {
            fake_libcamera_config c;
            rig r;
            char what[80];
            fake_libcamera_config_default(&c);
            c.fourcc = V4L2_PIX_FMT_SRGGB10;
            c.delay = delay;
            CHECK_MSG(rig_open(&r, &c, NULL) == 0, "%s", why.text);
            r.wait_s = slow ? 0.05 : 0.0;
            rig_run(&r, 100);
            for (int i = 0; i < 2; i++) { /* the first ones teach the delay */
                fake_libcamera_light(r.fake, 0.25);
                rig_run(&r, 60);
                fake_libcamera_light(r.fake, 0.125);
                rig_run(&r, 60);
            }
            snprintf(what, sizeof what, "webcam, delay %u%s, x8", delay, slow ? ", slow program" : "");
            rig_step(&r, 0.125, 1.0, slow ? c.buffers : 0, what);
            rig_run(&r, 30);
            snprintf(what, sizeof what, "webcam, delay %u%s, /8", delay, slow ? ", slow program" : "");
            rig_step(&r, 1.0, 0.125, slow ? c.buffers : 0, what);
            rig_close(&r);
        }
}

/* Programs from slightly to fifteen times slower than the camera. The first light teaches the delay. A program that
 * wants every frame shows each after the whole queue, and settles later. */
static void test_slow_programs(void)
{
    static const double period_s[] = {0.04, 0.05, 0.08, 0.12, 0.2, 1.0 / 3, 0.5};
    for (unsigned k = 0; k < 3 * sizeof period_s / sizeof *period_s; k++) {
        fake_libcamera_config c;
        rig r;
        const uint32_t delay = 1 + k % 3;
        const double s = period_s[k / 3];
        for (int late = PUPIL_LIVE_LATE_KEPT; late <= PUPIL_LIVE_LATE_LEFT_OUT; late++) {
            fake_libcamera_config_default(&c);
            c.fourcc = V4L2_PIX_FMT_SRGGB10;
            c.delay = delay;
            CHECK_MSG(rig_open(&r, &c, &(pupil_live_options){.capture = {.late = late}}) == 0, "%s", why.text);
            r.wait_s = s;
            fake_libcamera_light(r.fake, 0.125);
            rig_run(&r, 80);
            const double aim = log2(0.01 * 0.05 / 0.18);
            unsigned settled = 0, frames = late == PUPIL_LIVE_LATE_KEPT ? 30 : 16;
            fake_libcamera_light(r.fake, 1.0);
            for (unsigned i = 0; i < 100; i++) {
                rig_run(&r, 1);
                const double off = rig_total(&r, 1.0) - aim, shown = off + log2(r.loop.setting.frame_digital);
                settled = fabs(off) > 0.25 || fabs(shown) > 0.1 ? i + 1 : settled;
            }
            CHECK_MSG(settled <= frames, "late %d, a frame in %g s, delay %u: settled after %u frames", late, s, delay,
                      settled);
            CHECK(late != PUPIL_LIVE_LATE_BY_PACE || s < 0.04 || rig_counts(&r)->late > 0);
            CHECK(late != PUPIL_LIVE_LATE_KEPT || rig_counts(&r)->late == 0);
            printf("late %d, a frame in %.3f s, delay %u: %u frames, %llu late\n", late, s, delay, settled,
                   (unsigned long long)rig_counts(&r)->late);
            rig_close(&r);
        }
    }
}

/* More refusals than there are requests: each loses one, which is queued again, and the setting is asked for again. */
static void test_refused(void)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        fake_libcamera_config c = sensor_config();
        rig r;
        if (!sensor)
            fake_libcamera_config_default(&c);
        c.refuse_at = 2;
        c.refuse = 9;
        CHECK_MSG(rig_open(&r, &c, NULL) == 0, "%s", why.text);
        rig_run(&r, 30);
        fake_libcamera_light(r.fake, 0.2);
        rig_run(&r, 100);
        pupil_camera_status status;
        pupil_camera_get_status(pupil_live_camera(r.source), &status);
        CHECK_MSG(status.failed == 9 && rig_counts(&r)->cancelled == 9, "%llu refused, %llu cancelled",
                  (unsigned long long)status.failed, (unsigned long long)rig_counts(&r)->cancelled);
        CHECK(r.loop.refusals == 9 && !r.loop.refused && rig_counts(&r)->restarted == 0);
        CHECK_MSG(fabs(status.exposure_s.taken / fake_libcamera_exposure(r.fake, r.info.sequence) - 1.0) < 1e-6,
                  "%g is said, %g is", status.exposure_s.taken, fake_libcamera_exposure(r.fake, r.info.sequence));
        CHECK(fabs(rig_total(&r, 0.2) - log2(0.01 * 0.05 / 0.18)) < 0.6); /* it came to the key all the same */
        rig_close(&r);
    }
}

/* A delay that is given is kept. */
static void test_given_delay(void)
{
    fake_libcamera_config c;
    pupil_camera_limits limits;
    rig r;
    fake_libcamera_config_default(&c);
    CHECK(rig_open(&r, &c, &(pupil_live_options){.delay = 5}) == 0);
    pupil_camera_learn(pupil_live_camera(r.source), 2, 2);
    pupil_camera_get_limits(pupil_live_camera(r.source), &limits);
    CHECK(limits.exposure_delay == 5 && limits.gain_delay == 5);
    rig_close(&r);
    c = sensor_config(); /* the requests before it, and its own */
    CHECK(rig_open(&r, &c, NULL) == 0);
    pupil_camera_configure(pupil_live_camera(r.source), &r.config);
    CHECK_MSG(r.config.delay_frames == c.buffers + 3, "%u", r.config.delay_frames);
    rig_close(&r);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_takes_over_first();
    test_sensor();
    test_no_metadata();
    test_slow_programs();
    test_refused();
    test_given_delay();
    return check_end();
}
