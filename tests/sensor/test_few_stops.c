/* Cameras with few stops between black and white, fewer than a step made when only the side is known: a wall of one
 * brightness, in 8-bit codes, with a steep tone curve that was not configured. However the light changes, after the
 * promised frames the shown level is within 0.1 EV of the key. */
#include <math.h>

#include "check.h"
#include "pupil/pupil.h"
#include "pupil/sensor.h"

enum { WIDTH = 16, PROMISED = 60, JUDGED = 20, LATE = 3 };

static pupil_t pupil;
static pupil_sensor sensor;
static double asked_s[LATE], asked_gain[LATE];
static int frame;

/* One frame, of light for which the right exposure is this many stops above 1 ms at gain 1. Returns the shown level's
 * error.
 */
static double turn(double light_ev, double slope)
{
    static uint16_t pixels[WIDTH];
    static pupil_stats stats;
    const double exposure_s = asked_s[frame % LATE], gain = asked_gain[frame % LATE];
    const double value = fmin(0.18 * exp2(slope * (log2(exposure_s * gain / 1e-3) - light_ev)), 1.0);
    const double code = floor(255.0 * value + 0.5);
    for (int x = 0; x < WIDTH; x++)
        pixels[x] = (uint16_t)lround(4095.0 / 255.0 * code);
    const pupil_image_const image = pupil_image_const_of(pixels, WIDTH, 1, PUPIL_PIXEL_GREY12);
    const pupil_frame_info info = {sizeof info,         0,          (frame + 1) * INT64_C(33333333),
                                   (uint64_t)frame + 1, exposure_s, gain};
    pupil_sensor_setting s;
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, &image, 0, 1, &stats) == PUPIL_OK);
    CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    asked_s[frame % LATE] = s.exposure_s;
    asked_gain[frame % LATE] = s.gain;
    frame++;
    return log2(fmax(code, 0.5) / 255.0 * s.frame_digital / 0.18);
}

/* Still light after each of these, in stops. */
static double worst_of(double slope, const double *light_ev, int lights)
{
    pupil_sensor_config c;
    pupil_sensor_setting s;
    double worst = 0.0;
    pupil_sensor_config_default(&c);
    c.exposure_min_s = 1e-6;
    c.delay_frames = LATE;
    c.highlight_ev = 0.0;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    frame = 0;
    for (int i = 0; i < LATE; i++)
        asked_s[i] = s.exposure_s, asked_gain[i] = s.gain;
    for (int i = 0; i < lights; i++)
        for (int k = 0; k < PROMISED + JUDGED; k++) {
            const double off = turn(light_ev[i], slope);
            worst = fmax(worst, k < PROMISED ? 0.0 : fabs(off));
        }
    return worst;
}

int main(int argc, char **argv)
{
    pupil_config metering;
    check_begin(argc, argv);
    pupil_config_default(&metering);
    metering.histogram = 1;
    CHECK(pupil_init(&pupil, &metering) == PUPIL_OK);
    for (double slope = 1.0; slope <= 3.1; slope += 0.25)
        for (double step = -9.0; step <= 9.0; step += CHECK_SANITIZED ? 1.5 : 0.25) {
            /* back, and then as far again: a halved step has to grow */
            const double light[] = {0.0, step, 0.0, step < 0.0 ? 5.0 : -3.0, 1.0};
            const double worst = worst_of(slope, light, sizeof light / sizeof *light);
            CHECK_MSG(worst <= 0.1, "slope %g, steps of %g EV: %g EV off", slope, step, worst);
        }
    return check_end();
}
