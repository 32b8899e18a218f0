/* The whole loop on a driver's controls: a fake imx219 whose frames are exposed with what was written to it some frames
 * ago, the camera's library, and pupil/sensor.h. in_force reports what each frame was taken with; the loop settles, in
 * daylight and in the dark, and asks for a longer frame if that is allowed. */
#include <math.h>
#include <unistd.h>

#include "check.h"
#include "fake_controls.h"

#define LINE_S (3448 / 182.4e6)

static fake_controls fake;
static pupil_why why;

static pupil_camera *open_camera(void)
{
    const pupil_camera_options options = fake_sensor_options(&fake);
    fake_sensor(&fake);
    return pupil_camera_open(&options, &why);
}

/* Exposure and gain in the registers. */
static void registers(double at[2])
{
    at[0] = (double)fake_value(&fake, V4L2_CID_EXPOSURE) * LINE_S;
    at[1] = 256.0 / (256.0 - (double)fake_value(&fake, V4L2_CID_ANALOGUE_GAIN));
}

static void settle(double light_ev, uint32_t state, double exposure_s, double gain)
{
    pupil_camera *camera = open_camera();
    pupil_sensor_config config;
    pupil_sensor_setting s = {0};
    pupil_sensor sensor;
    double written[64][2]; /* in the registers while frame i is exposed, acting by the delays of 2 and 1 */
    int settled = 0;
    CHECK_MSG(camera, "%s", why.text);
    if (!camera)
        return;
    pupil_sensor_config_default(&config);
    pupil_camera_configure(camera, &config);
    CHECK(pupil_sensor_init(&sensor, &config) == PUPIL_OK);
    for (int i = 0; i < 2; i++)
        registers(written[i]);
    for (uint64_t frame = 0; frame < 60; frame++) {
        pupil_frame_info info = {.timestamp_ns = 1000000 + (int64_t)frame * 33333333, .sequence = frame};
        const double e = written[frame < 2 ? 0 : frame - 2][0], g = written[frame < 1 ? 0 : frame - 1][1];
        pupil_camera_frame(camera, frame, 0); /* it was dequeued: the next one is exposed now */
        pupil_camera_in_force(camera, frame, &info);
        CHECK_MSG(fabs(info.exposure_s / e - 1) < 1e-9 && fabs(info.gain / g - 1) < 1e-9,
                  "frame %d: %g s x %g, said to be %g x %g", (int)frame, e, g, info.exposure_s, info.gain);
        const double off = light_ev + log2(e * g) - log2(0.18);
        CHECK(pupil_sensor_scene(&sensor, light_ev, 0, &info) == PUPIL_OK);
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        if (fabs(off + log2(s.frame_digital)) > 0.1)
            settled = (int)frame + 1;
        if (s.changed || frame == 0) {
            pupil_camera_status status;
            const uint64_t number = pupil_camera_ask(camera, &(pupil_camera_setting){s.exposure_s, s.gain, 0});
            do {
                usleep(100);
                pupil_camera_get_status(camera, &status);
            } while (status.written < number);
            CHECK_MSG(fabs(status.exposure_s.taken / s.exposure_s - 1) < 1e-9 &&
                          fabs(status.gain.taken / s.gain - 1) < 1e-9,
                      "%g s x %g taken of %g x %g", status.exposure_s.taken, status.gain.taken, s.exposure_s, s.gain);
        }
        registers(written[frame + 1]);
    }
    CHECK_MSG(s.state == state, "state %u, reason %u", s.state, s.reason);
    CHECK_MSG(settled <= 4 || state == PUPIL_SENSOR_LIMITED, "%d frames", settled);
    CHECK_MSG(fabs(s.exposure_s / exposure_s - 1) < 0.01 && fabs(s.gain / gain - 1) < 0.05, "%g s x %g", s.exposure_s,
              s.gain);
    CHECK(pupil_camera_close(camera, &why) == 0 && fake_value(&fake, V4L2_CID_EXPOSURE) == 1600);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    settle(log2(0.18 * 100), PUPIL_SENSOR_CONVERGED, 0.01, 1);
    settle(log2(0.18 * 2000), PUPIL_SENSOR_CONVERGED, 26 * LINE_S, 1);        /* 26.4 lines */
    settle(log2(0.18 * 7.5), PUPIL_SENSOR_CONVERGED, 0.03, 1 / (7.5 * 0.03)); /* as for 50 Hz, while nothing is known */
    settle(log2(0.18 * 1e-3), PUPIL_SENSOR_LIMITED, 1759 * LINE_S, 256 / 24.0);
    return check_end();
}
