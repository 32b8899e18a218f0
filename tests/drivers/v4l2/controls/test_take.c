/* Taking over a camera, setting its controls in the right order, giving it back: also if any driver call fails. */
#include <errno.h>
#include <math.h>
#include <unistd.h>

#include "check.h"
#include "fake_controls.h"

static fake_controls fake, before;
static pupil_why why;

static pupil_camera *open_uvc(void)
{
    pupil_camera_options options = fake_uvc_options(&fake);
    options.mains_hz = 50;
    before = fake;
    return pupil_camera_open(&options, &why);
}

static pupil_camera *open_sensor(void)
{
    const pupil_camera_options options = fake_sensor_options(&fake);
    before = fake;
    return pupil_camera_open(&options, &why);
}

static int as_before(void)
{
    int same = 1;
    for (int i = 0; i < fake.count; i++)
        same &= fake.control[i].value == before.control[i].value;
    return same;
}

static void wait_for(pupil_camera *camera, uint64_t number)
{
    pupil_camera_status status;
    do {
        usleep(200);
        pupil_camera_get_status(camera, &status);
    } while (status.written < number);
}

static void check_uvc(void)
{
    fake_uvc(&fake);
    pupil_camera *camera = open_uvc();
    pupil_camera_limits l;
    pupil_camera_status status;
    pupil_sensor_config config;
    const char *fault = "";
    CHECK_MSG(camera, "%s", why.text);
    if (!camera)
        return;
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_AUTO) == V4L2_EXPOSURE_MANUAL);
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_AUTO_PRIORITY) == 0 &&
          fake_value(&fake, V4L2_CID_AUTO_WHITE_BALANCE) == 0);
    CHECK(fake_value(&fake, V4L2_CID_BACKLIGHT_COMPENSATION) == 0);
    CHECK(fake_value(&fake, V4L2_CID_POWER_LINE_FREQUENCY) == V4L2_CID_POWER_LINE_FREQUENCY_50HZ);
    pupil_camera_get_limits(camera, &l);
    CHECK(fabs(l.exposure_min_s - 3e-4) < 1e-12 && fabs(l.exposure_max_s - 0.2047) < 1e-12 &&
          l.exposure_step_s == 1e-4);
    CHECK(l.readout_s == 0); /* a webcam's is not known */
    CHECK(l.has_gain && !l.gain_known && l.gain_min == 1 / 16.0 && l.gain_max == 255 / 16.0 && l.exposure_delay == 3);
    pupil_sensor_config_default(&config);
    pupil_camera_configure(camera, &config);
    CHECK_MSG(pupil_sensor_config_check(&config, &fault) == PUPIL_OK, "%s", fault);
    CHECK(config.gain_law == PUPIL_GAIN_LINEAR && config.gain_step == 1 / 16.0 && config.delay_frames == 4);
    const uint64_t number = pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = 0.02004, .gain = 2.03});
    wait_for(camera, number);
    pupil_camera_get_status(camera, &status);
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_ABSOLUTE) == 200 && fake_value(&fake, V4L2_CID_GAIN) == 32);
    CHECK(status.exposure_s.asked == 0.02004 && fabs(status.exposure_s.taken - 0.02) < 1e-12);
    CHECK(status.gain.asked == 2.03 && status.gain.taken == 2 && !status.failed);
    CHECK(fake.log[fake.logged - 1].call == fake.log[fake.logged - 2].call); /* both in one call */
    CHECK(pupil_camera_close(camera, &why) == 0 && as_before());
    CHECK(pupil_camera_close(NULL, &why) == 0);

    /* missing controls are not touched, and the menu is obeyed */
    fake_uvc(&fake);
    fake.control[0].menu = 1 << V4L2_EXPOSURE_SHUTTER_PRIORITY | 1 << V4L2_EXPOSURE_APERTURE_PRIORITY;
    fake.needs_manual = 0;
    fake.no_query_ext = 1;
    fake.count = 2;
    camera = open_uvc();
    CHECK_MSG(camera && fake_value(&fake, V4L2_CID_EXPOSURE_AUTO) == V4L2_EXPOSURE_SHUTTER_PRIORITY, "%s", why.text);
    pupil_camera_get_limits(camera, &l);
    CHECK(!l.has_gain && l.gain_min == 1 && l.gain_max == 1);
    fake.control[0].value = 3; /* STREAMON has set it again */
    wait_for(camera, pupil_camera_reapply(camera));
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_AUTO) == V4L2_EXPOSURE_SHUTTER_PRIORITY);
    pupil_camera_restore(camera); /* from a signal's handler */
    CHECK(as_before());
    CHECK(pupil_camera_close(camera, &why) == 0 && as_before());
    fake.control[0].menu = 1 << V4L2_EXPOSURE_APERTURE_PRIORITY;
    CHECK(!open_uvc() && strstr(why.text, "EXPOSURE_AUTO") && as_before());
    fake.count = 1;
    CHECK(!open_uvc() && strstr(why.text, "EXPOSURE_ABSOLUTE") && as_before());
}

static void check_sensor(void)
{
    const double line_s = 3448 / 182.4e6;
    pupil_camera_limits l;
    pupil_camera_status status;
    pupil_sensor_config config;
    const char *fault = "";
    fake_sensor(&fake);
    pupil_camera *camera = open_sensor();
    CHECK_MSG(camera, "%s", why.text);
    if (!camera)
        return;
    pupil_camera_get_limits(camera, &l);
    CHECK(fabs(l.exposure_step_s / line_s - 1) < 1e-12 && fabs(l.exposure_max_s / (1759 * line_s) - 1) < 1e-12);
    CHECK(fabs(l.readout_s / (1080 * line_s) - 1) < 1e-12);
    CHECK(l.gain_known && l.gain_min == 1 && fabs(l.gain_max - 256 / 24.0) < 1e-12);
    CHECK(l.exposure_delay == 2 && l.gain_delay == 1 && fabs(l.frame_s - 1 / 30.0) < 1e-5);
    pupil_sensor_config_default(&config);
    pupil_camera_configure(camera, &config);
    CHECK_MSG(pupil_sensor_config_check(&config, &fault) == PUPIL_OK, "%s", fault);
    CHECK(config.gain_law == PUPIL_GAIN_RECIPROCAL && config.gain_step == 256 && config.delay_frames == 3);
    /* a longer frame first, then its limits, then exposure and gain together: 0.1 s is 5291 lines */
    int at = fake.logged;
    uint64_t number = pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = 0.099, .gain = 4, .frame_s = 0.1});
    wait_for(camera, number);
    CHECK(fake.logged == at + 3 && fake.log[at].id == V4L2_CID_VBLANK && fake.log[at].call < fake.log[at + 1].call);
    CHECK(fake.log[at + 1].id == V4L2_CID_EXPOSURE && fake.log[at + 2].id == V4L2_CID_ANALOGUE_GAIN);
    CHECK(fake.log[at + 1].call == fake.log[at + 2].call && fake.log[at + 2].value == 192);
    pupil_camera_get_status(camera, &status);
    CHECK(fabs(status.exposure_s.taken - 0.099) <= line_s && status.exposure_s.taken <= 0.099 &&
          status.gain.taken == 4);
    pupil_camera_get_limits(camera, &l);
    CHECK(fabs(l.frame_s - 0.1) < line_s && l.exposure_max_s > 0.099);
    /* exposures in whole lines come back unchanged */
    for (int lines = 4; lines < 1759; lines += 97) {
        wait_for(camera, pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = lines * line_s}));
        CHECK(fake_value(&fake, V4L2_CID_EXPOSURE) == lines);
    }
    fake.one_by_one = 1; /* a driver that refuses batches */
    wait_for(camera, pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = 100 * line_s, .gain = 2}));
    pupil_camera_get_status(camera, &status);
    CHECK(!status.failed && status.gain.taken == 2 && fake_value(&fake, V4L2_CID_EXPOSURE) == 100);
    /* values that are not finite and positive change nothing */
    number = pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = NAN, .gain = -1, .frame_s = INFINITY});
    wait_for(camera, number);
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE) == 100 && fake_value(&fake, V4L2_CID_ANALOGUE_GAIN) == 128);
    CHECK(pupil_camera_close(camera, &why) == 0 && as_before());

    fake_sensor(&fake); /* no line's time */
    fake.control[0].id = V4L2_CID_HUE;
    CHECK(!open_sensor() && strstr(why.text, "PIXEL_RATE") && as_before());
}

/* The n-th call fails: alone with EIO for every n of a session; for every ninth n also with all later calls, and with
 * other errors. The result is a sentence or a count of failed writes, never a crash, and everything is restored if the
 * driver accepts it.
 */
static void check_failures(void)
{
    static const int numbers[] = {EIO, EINVAL, EBUSY, ENODEV};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int kind = 0; kind < 8; kind++) {
            const long every = kind ? check_every(9) : 1; /* a failing close takes 30 ms */
            long calls = 0;
            /* n 0: no failure, to count the calls */
            for (long n = 0; n == 0 || n <= calls; n += n ? every : 1 + kind % every) {
                if (sensor)
                    fake_sensor(&fake);
                else
                    fake_uvc(&fake);
                fake.fail_at = n;
                fake.fail_for = kind & 1 ? 1000000 : 0;
                fake.fail_errno = numbers[kind / 2];
                why.text[0] = 0;
                pupil_camera *camera = sensor ? open_sensor() : open_uvc();
                if (camera) {
                    pupil_camera_status status;
                    wait_for(camera, pupil_camera_ask(camera, &(pupil_camera_setting){0.01, 2, sensor ? 0.05 : 0}));
                    pupil_camera_get_status(camera, &status);
                    /* EINVAL means that there is no EXPOSURE_AUTO; then the exposure cannot be written */
                    CHECK(status.failed == 0 || status.error == numbers[kind / 2] ||
                          (numbers[kind / 2] == EINVAL && status.error == EACCES));
                    const int result = pupil_camera_close(camera, &why);
                    CHECK(result == 0 || (result == -1 && strstr(why.text, "could not be put back")));
                    CHECK_MSG(result == -1 || as_before(), "call %ld of %ld, errno %d", n, calls, fake.fail_errno);
                    CHECK(n > 0 || result == 0);
                } else {
                    CHECK_MSG(strlen(why.text) > 20, "call %ld: \"%s\"", n, why.text);
                    CHECK_MSG((kind & 1) || as_before(), "call %ld of open, errno %d", n, fake.fail_errno);
                }
                calls = n == 0 ? fake.calls : calls;
            }
            CHECK(calls > 15);
        }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_uvc();
    check_sensor();
    check_failures();
    return check_end();
}
