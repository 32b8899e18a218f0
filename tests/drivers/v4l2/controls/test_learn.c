/* Delays measured from frames replace the assumed ones, for later writes and for those in flight. Not if they were
 * configured, and not if frames cannot have shown them. */
#include <math.h>
#include <unistd.h>

#include "check.h"
#include "fake_controls.h"

static fake_controls fake;
static pupil_why why;

static pupil_camera *open_camera(int sensor, uint32_t delay)
{
    pupil_camera_options options = sensor ? fake_sensor_options(&fake) : fake_uvc_options(&fake);
    options.delay = delay;
    if (sensor)
        fake_sensor(&fake);
    else
        fake_uvc(&fake);
    pupil_camera *camera = pupil_camera_open(&options, &why);
    CHECK_MSG(camera, "%s", why.text);
    if (!camera)
        exit(check_end());
    return camera;
}

static void close_camera(pupil_camera *camera)
{
    CHECK(pupil_camera_close(camera, &why) == 0);
}

static double gain_of(pupil_camera *camera, uint64_t sequence)
{
    pupil_frame_info info;
    pupil_camera_frame(camera, sequence, 0);
    pupil_camera_in_force(camera, sequence, &info);
    return info.gain;
}

static double exposure_of(pupil_camera *camera, uint64_t sequence)
{
    pupil_frame_info info;
    pupil_camera_in_force(camera, sequence, &info);
    return info.exposure_s;
}

/* Asks after a frame; so many frames have begun since then. */
static void ask(pupil_camera *camera, uint64_t sequence, double exposure_s, double gain, uint64_t late)
{
    pupil_camera_status status;
    pupil_camera_frame(camera, sequence + late, 0);
    pupil_camera_ask(camera, &(pupil_camera_setting){exposure_s, gain, 0});
    do {
        usleep(100);
        pupil_camera_get_status(camera, &status);
    } while (status.written != status.asks);
}

static void check_limits(pupil_camera *camera, uint32_t exposure_delay, uint32_t gain_delay)
{
    pupil_camera_limits l;
    pupil_camera_get_limits(camera, &l);
    CHECK_MSG(l.exposure_delay == exposure_delay && l.gain_delay == gain_delay, "%u and %u, expected %u and %u",
              l.exposure_delay, l.gain_delay, exposure_delay, gain_delay);
}

/* Asked for after frame 10, while 11 is being exposed; `shown`: frames from 10 to the first that has the setting. */
static void check_shown(uint32_t shown)
{
    pupil_camera *camera = open_camera(0, 0);
    pupil_camera_status status;
    const uint32_t delay = shown - 1;
    check_limits(camera, 3, 3);
    CHECK(gain_of(camera, 10) == 2.5);
    ask(camera, 10, 0.01, 4.0, 0);
    for (uint64_t n = 11; n <= 17; n++) {
        const uint64_t truth = 10 + shown;
        gain_of(camera, n);
        if (n >= truth)
            pupil_camera_learn(camera, shown, 0);
        /* if longer than assumed, that is only known once the assumed frame came without it */
        if (n >= truth || n < 14)
            CHECK_MSG(gain_of(camera, n) == (n < truth ? 2.5 : 4.0), "shown %u, frame %d", shown, (int)n);
    }
    check_limits(camera, delay, delay); /* gain is assumed to be alike, as nothing else is known */
    pupil_camera_get_status(camera, &status);
    CHECK(status.exposure_s.from_frame == 10 + shown && status.gain.from_frame == 10 + shown);
    CHECK(exposure_of(camera, 9 + shown) == 0.025 && exposure_of(camera, 10 + shown) == 0.01);
    gain_of(camera, 30);
    ask(camera, 30, 0.02, 8.0, 0);
    for (uint64_t n = 31; n <= 36; n++)
        CHECK(gain_of(camera, n) == (n < 30 + shown ? 4.0 : 8.0));
    pupil_camera_learn(camera, shown, shown + 1); /* now the gain's delay is known */
    check_limits(camera, delay, delay + 1);
    close_camera(camera);
}

/* Frames are counted from the measured one; several may have begun since. */
static void check_late(void)
{
    pupil_camera *camera = open_camera(0, 0);
    gain_of(camera, 10);
    ask(camera, 10, 0.01, 4.0, 2); /* 13 is being exposed */
    for (uint64_t n = 11; n <= 16; n++)
        gain_of(camera, n);
    pupil_camera_learn(camera, 4, 0); /* 14 was the first */
    check_limits(camera, 1, 1);
    ask(camera, 16, 0.02, 8.0, 0); /* otherwise late: which of the two was seen? */
    for (uint64_t n = 17; n <= 24; n++)
        gain_of(camera, n);
    pupil_camera_learn(camera, 3, 3);
    check_limits(camera, 1, 1);
    ask(camera, 24, 0.01, 4.0, 0);
    for (uint64_t n = 25; n <= 30; n++)
        gain_of(camera, n);
    pupil_camera_learn(camera, 3, 3);
    check_limits(camera, 2, 2);
    close_camera(camera);
}

/* The frame that would distinguish the two delays was lost. */
static void check_lost(void)
{
    pupil_camera *camera = open_camera(0, 0);
    gain_of(camera, 10);
    ask(camera, 10, 0.01, 4.0, 0);
    gain_of(camera, 11);
    gain_of(camera, 12);
    gain_of(camera, 14); /* 13 or 14 was the first */
    pupil_camera_learn(camera, 3, 3);
    check_limits(camera, 3, 3);
    close_camera(camera);
}

static void check_left_alone(void)
{
    pupil_camera *camera = open_camera(0, 2); /* --control-delay */
    gain_of(camera, 10);
    ask(camera, 10, 0.01, 4.0, 0);
    for (uint64_t n = 11; n <= 16; n++)
        gain_of(camera, n);
    pupil_camera_learn(camera, 5, 5);
    check_limits(camera, 2, 2);
    close_camera(camera);

    camera = open_camera(1, 0); /* by the table: exposure 2, gain 1 */
    check_limits(camera, 2, 1);
    pupil_camera_learn(camera, 4, 4); /* nothing was written yet */
    check_limits(camera, 2, 1);
    gain_of(camera, 10);
    ask(camera, 10, 0.01, 4.0, 0);
    for (uint64_t n = 11; n <= 16; n++)
        gain_of(camera, n);
    pupil_camera_learn(camera, 0, 0); /* not known */
    check_limits(camera, 2, 1);
    pupil_camera_learn(camera, 4, 0); /* they were not alike */
    check_limits(camera, 3, 1);
    close_camera(camera);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t shown = 1; shown <= 6; shown++)
        check_shown(shown);
    check_late();
    check_lost();
    check_left_alone();
    return check_end();
}
