/* Exposure, gain and frame time of libcamera cameras with unusual limits: the ranges that are offered, the next
 * request, and what is in force. */
#include "odd.h"

#include <errno.h>

static pupil_libcamera_can can;

static int offers(void *camera, pupil_live_offers *o, pupil_libcamera_can *to)
{
    if (to)
        *to = can;
    return it.real->offers(camera, o, NULL);
}

/* The fake with what it can changed in `can` before it is opened. */
static void begin(int sensor)
{
    fake_libcamera_config c;
    fake_libcamera_config_default(&c);
    c.sensor = sensor;
    odd_begin(&c);
    it.real->offers(it.fake, NULL, &can);
    it.layer.offers = offers;
}

static pupil_libcamera_ask last_ask(void)
{
    const fake_libcamera_log *log;
    const size_t logged = fake_libcamera_logged(it.fake, &log);
    return logged ? log[logged - 1].ask : (pupil_libcamera_ask){0};
}

static void test_limits(void)
{
    pupil_source *source;
    pupil_camera_limits l;
    begin(1);
    CHECK(odd_open(&source, NULL) == 0);
    pupil_camera_get_limits(pupil_live_camera(source), &l);
    CHECK(l.has_gain && l.gain_min == 1.0 && l.gain_max == 16.0 && l.exposure_min_s == 1e-4 && l.exposure_max_s == 1.0);
    CHECK(l.frame_min_s == 1.0 / 120 && l.frame_max_s == 2.0 && l.exposure_step_s == 1e-6);
    odd_end(source);

    begin(1);
    can.gain.least = 0.0;
    can.exposure_s.least = 0.0;
    can.controls &= ~(uint32_t)PUPIL_LIBCAMERA_CAN_FRAME;
    CHECK(odd_open(&source, NULL) == 0);
    pupil_camera_get_limits(pupil_live_camera(source), &l);
    CHECK(l.has_gain && l.gain_min == 1.0 && l.exposure_min_s == 1e-6 && l.frame_max_s == 0.0);
    odd_end(source);

    for (int unlisted = 0; unlisted < 2; unlisted++) { /* a control without a range is none */
        begin(1);
        can.gain.most = unlisted ? can.gain.most : 0.0;
        can.controls &= unlisted ? ~(uint32_t)PUPIL_LIBCAMERA_CAN_GAIN : ~0u;
        CHECK(odd_open(&source, NULL) == 0);
        pupil_camera_get_limits(pupil_live_camera(source), &l);
        CHECK(!l.has_gain && l.gain_min == 1.0 && l.gain_max == 1.0);
        odd_end(source);
    }

    begin(1);
    can.exposure_s.most = 0.0;
    CHECK(odd_open(&source, NULL) == 0 && !pupil_live_camera(source));
    CHECK(strstr(pupil_live_no_controls(source), "no control of this camera's exposure time"));
    odd_end(source);
}

/* Settings are clamped to the limits; NaN, or values not above 0, leave the setting unchanged. */
static void test_ask(void)
{
    static const struct {
        pupil_camera_setting asked;
        double exposure_s, gain, frame_least_s, frame_most_s;
    } cases[] = {{{.exposure_s = 0.005, .gain = 2.0}, 0.005, 2.0, 1.0 / 30, 1.0 / 30},
                 {{.exposure_s = 1e-9, .gain = 0.5}, 1e-4, 1.0, 1.0 / 30, 1.0 / 30},
                 {{.exposure_s = 50.0, .gain = 99.0}, 1.0, 16.0, 1.0 / 30, 1.0},
                 {{.exposure_s = (double)INFINITY, .gain = (double)NAN}, 0.0, 0.0, 1.0 / 30, 1.0 / 30},
                 {{.exposure_s = -1.0, .gain = 4.0}, 0.0, 4.0, 1.0 / 30, 1.0 / 30},
                 {{.exposure_s = 0.01, .frame_s = 0.1}, 0.01, 0.0, 0.1, 0.1},
                 {{.exposure_s = 0.5, .frame_s = 0.1}, 0.5, 0.0, 0.1, 0.5},
                 {{.exposure_s = 0.005, .frame_s = 0.001}, 0.005, 0.0, 1.0 / 120, 1.0 / 120},
                 {{.exposure_s = 0.01, .frame_s = 9.0}, 0.01, 0.0, 2.0, 2.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pupil_source *source;
        pupil_frame frame;
        begin(1);
        CHECK(odd_open(&source, NULL) == 0);
        pupil_camera_ask(pupil_live_camera(source), &cases[i].asked);
        CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
        const pupil_libcamera_ask a = last_ask();
        CHECK_MSG(a.exposure_s == cases[i].exposure_s && a.gain == cases[i].gain &&
                      fabs(a.frame_least_s - cases[i].frame_least_s) < 1e-12 &&
                      fabs(a.frame_most_s - cases[i].frame_most_s) < 1e-12,
                  "case %zu: %g s, gain %g, frames of %g to %g s", i, a.exposure_s, a.gain, a.frame_least_s,
                  a.frame_most_s);
        odd_end(source);
    }
}

/* A camera whose longest frame time is not known gets the one that is asked for. */
static void test_open_frame_time(void)
{
    pupil_source *source;
    pupil_frame frame;
    begin(1);
    can.frame_s.most = 0.0;
    CHECK(odd_open(&source, NULL) == 0);
    pupil_camera_ask(pupil_live_camera(source), &(pupil_camera_setting){.exposure_s = 0.01, .frame_s = 9.0});
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME && last_ask().frame_least_s == 9.0);
    odd_end(source);
}

/* --- what is in force --- */

static double told_exposure_s, told_gain;

static int wait_for(void *camera, pupil_libcamera_done *done, int timeout_ms)
{
    const int got = it.real->wait(camera, done, timeout_ms);
    if (got == 1) {
        done->exposure_s = told_exposure_s;
        done->gain = told_gain;
    }
    return got;
}

/* Metadata with an exposure time alone: the gain is the last one that was taken. Nothing is known of any frame but the
 * last. */
static void test_told(void)
{
    pupil_source *source;
    pupil_frame frame;
    pupil_frame_info info = {0};
    begin(1);
    it.layer.wait = wait_for;
    told_exposure_s = 0.02;
    told_gain = 0.0;
    CHECK(odd_open(&source, NULL) == 0);
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME && frame.info.exposure_s == 0.02 && frame.info.gain == 0.0);
    pupil_camera_ask(pupil_live_camera(source), &(pupil_camera_setting){.exposure_s = 0.02, .gain = 3.0});
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
    CHECK_MSG(frame.info.exposure_s == 0.02 && frame.info.gain == 3.0, "gain %g", frame.info.gain);
    pupil_camera_in_force(pupil_live_camera(source), frame.info.sequence + 1, &info);
    CHECK_MSG(info.exposure_s == 0.0 && info.gain == 0.0, "%g s, gain %g", info.exposure_s, info.gain);
    told_gain = 5.0;
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME && frame.info.gain == 5.0);
    odd_end(source);
}

/* The setting is asked for once more. */
static void test_reapply(void)
{
    pupil_source *source;
    pupil_frame frame;
    begin(1);
    CHECK(odd_open(&source, NULL) == 0);
    pupil_camera_ask(pupil_live_camera(source), &(pupil_camera_setting){.exposure_s = 0.004, .gain = 2.0});
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME && last_ask().exposure_s == 0.004);
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME && last_ask().exposure_s == 0.0);
    pupil_camera_reapply(pupil_live_camera(source));
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
    CHECK(last_ask().exposure_s == 0.004 && last_ask().gain == 2.0);
    odd_end(source);
}

/* If only the gain is refused, that is a refusal, too. */
static void test_refused_gain(void)
{
    fake_libcamera_config c;
    pupil_source *source;
    pupil_frame frame;
    pupil_camera_status status;
    fake_libcamera_config_default(&c);
    c.sensor = 1;
    c.refuse_at = 1;
    c.refuse = 1;
    odd_begin(&c);
    CHECK(odd_open(&source, NULL) == 0);
    pupil_camera_ask(pupil_live_camera(source), &(pupil_camera_setting){.gain = 2.0});
    for (int i = 0; i < 8; i++)
        CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
    pupil_camera_get_status(pupil_live_camera(source), &status);
    CHECK_MSG(status.failed == 1 && status.error == ECANCELED, "%llu failed, error %d",
              (unsigned long long)status.failed, status.error);
    odd_end(source);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_limits();
    test_ask();
    test_open_frame_time();
    test_told();
    test_reapply();
    test_refused_gain();
    return check_end();
}
