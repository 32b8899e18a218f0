/* A camera with exposures in large steps, which it reports: the loop uses the reported steps, within limits that may
 * change, with more steps than are kept, and after the camera's steps have changed. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;
static pupil_sensor_config c;
static pupil_sensor_setting s;

/* The exposure that the camera makes of the one asked for. */
static double rounded(double exposure_s, double step_s)
{
    return fmax(floor(exposure_s / step_s + 0.5), 1.0) * step_s;
}

/* Frames of a camera with steps of `step_s`. What is asked for is within the limits. */
static void turns(int count, double step_s)
{
    for (int i = 0; i < count; i++) {
        pupil_sensor_setting now; /* gcc 12.2 -O2 treats s as a constant where only its address is passed on */
        plant_turn(&p, &sensor, &now, NULL);
        s = now;
        double *asked = &p.asked[(p.frame - 1) % PLANT_RING][0];
        CHECK_MSG(*asked >= c.exposure_min_s * 0.999 && *asked <= c.exposure_max_s * 1.001, "%g s of %g to %g", *asked,
                  c.exposure_min_s, c.exposure_max_s);
        *asked = rounded(*asked, step_s);
    }
}

static void check_settled(const char *what)
{
    const double off = p.light_ev + log2(plant_in_force(&p, 0) * plant_in_force(&p, 1)) - log2(0.18);
    CHECK_MSG(s.state == PUPIL_SENSOR_CONVERGED && fabs(off) < 0.3, "%s: %s, %g EV off", what,
              pupil_sensor_state_name(s.state), off);
}

static void begin(double step_s)
{
    c = plant_config(LAW_FINE);
    c.exposure_step_s = 0.0;
    c.exposure_min_s = 1e-4;
    c.exposure_max_s = 0.033;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(0.18) - log2(0.01), 2);
    turns(120, step_s);
}

/* From dark to bright, over more steps than are kept: 30 ms to 3 ms. */
static void test_many_steps(void)
{
    begin(0.001);
    for (int step = 0; step < 40; step++) {
        p.light_ev += step < 10 ? -0.15 : 0.11;
        turns(25, 0.001);
        if (step % 10 == 9)
            check_settled("many steps");
    }
}

/* Limits that exclude what was reported. */
static void test_limits(void)
{
    static const double limits[][2] = {{0.0123, 0.033}, {1e-4, 0.0077}, {0.0042, 0.0058}, {1e-4, 0.033}};
    begin(0.005);
    for (int i = 0; i < 6; i++) {
        p.light_ev += i % 2 ? 0.7 : -0.5;
        turns(40, 0.005);
    }
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        c.exposure_min_s = limits[i][0];
        c.exposure_max_s = limits[i][1];
        CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
        turns(1, 0.005); /* it may ask for the same as before */
        turns(60, 0.005);
    }
    check_settled("limits that are open again");
}

/* Another mode of the camera, with other steps. */
static void test_other_steps(void)
{
    static const double steps_s[] = {0.004, 0.0031, 0.0007, 0.005};
    begin(0.004);
    for (size_t i = 0; i < sizeof steps_s / sizeof *steps_s; i++) {
        for (int k = 0; k < 6; k++) {
            p.light_ev += k % 2 ? 0.6 : -0.6;
            turns(40, steps_s[i]);
        }
        check_settled("other steps");
    }
}

/* Downward in half stops, slightly different each time: 40 lights over all exposures, of which more are reported than
 * are kept. Some are reported as one although the one asked for is shorter than all that were rounded to it. */
static void test_steps_that_wander(double step_ev, double up)
{
    c = plant_config(LAW_FINE);
    c.exposure_step_s = 0.0;
    c.exposure_min_s = 1e-5;
    c.exposure_max_s = 1.0;
    c.frame_rate_priority = 0;
    c.gain_max = 4.0 * c.gain_min;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(0.18) - log2(0.01), 2);
    for (int i = 0; i < 40 * 16 + 60; i++) {
        pupil_sensor_setting now;
        if (i % 16 == 0)
            p.light_ev = log2(0.18) - (i < 40 * 16 ? log2(1e-5) + 16.0 * check_uniform() : log2(0.02));
        plant_turn(&p, &sensor, &now, NULL);
        s = now;
        double *asked = &p.asked[(p.frame - 1) % PLANT_RING][0];
        *asked = exp2(step_ev * floor(log2(*asked) / step_ev + up)) * (0.9975 + 0.005 * check_uniform());
    }
    check_settled("steps that wander");
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_many_steps();
    test_limits();
    test_other_steps();
    for (int camera = 0; camera < 8; camera++)
        test_steps_that_wander(camera % 2 ? 1.0 : 0.5, camera % 2 ? 0.5 : 1e-9); /* to the nearest; down */
    return check_end();
}
