/* Light out of the camera's reach: the loop asks for the extreme setting, and names the limit from then on.
 */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;

static void begin(int law, double slope)
{
    pupil_sensor_config c = plant_config(law);
    c.linear = slope == 1.0;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, 6.0, 3);
    p.slope = slope;
}

/* With a slope, the last step has more or less effect than its number: it is still made, and not left to the digital
 * factor. */
static void check_last_step(int law, double slope)
{
    pupil_sensor_setting s, dark;
    begin(law, slope);
    const pupil_sensor_config c = plant_config(law);
    for (int i = 0; i < 120; i++)
        plant_turn(&p, &sensor, &s, NULL);
    for (int i = 0; i < 200; i++) { /* by small steps, so that no large one overshoots to the end */
        p.light_ev -= 0.05;
        plant_turn(&p, &sensor, &s, NULL);
    }
    for (int i = 0; i < 100; i++)
        plant_turn(&p, &sensor, &s, NULL);
    CHECK(pupil_sensor_start(&sensor, 1e4, 1.0) == PUPIL_OK && pupil_sensor_get(&sensor, &dark) == PUPIL_OK);
    CHECK_MSG(s.gain == dark.gain && s.state == PUPIL_SENSOR_LIMITED, "slope %g: gain %g of %g to %g, %s", slope,
              s.gain, c.gain_max, dark.gain, pupil_sensor_state_name(s.state));
}

/* In light far beyond reach, the limit is named while the step to the end is still in flight. */
static void check_named(double light_ev, uint32_t limit)
{
    pupil_sensor_setting s;
    begin(LAW_FINE, 1.0);
    for (int i = 0; i < 60; i++)
        plant_turn(&p, &sensor, &s, NULL);
    p.light_ev = light_ev;
    int frames = 0;
    for (; frames < 20 && !(s.limits >> limit & 1); frames++)
        plant_turn(&p, &sensor, &s, NULL);
    CHECK(s.changed);
    plant_turn(&p, &sensor, &s, NULL);
    CHECK_MSG(s.state == PUPIL_SENSOR_LIMITED && s.reason == limit, "%g EV, frame %d: %s, %s", light_ev, frames,
              pupil_sensor_state_name(s.state), pupil_sensor_reason_name(s.reason));
}

/* Highlights lower the aim and so bring it within reach: they are followed where the key is not in reach, too. */
static void check_highlights(double light_ev)
{
    pupil_sensor_setting s;
    begin(LAW_FINE, 1.0);
    p.light_ev = light_ev;
    for (int i = 0; i < PLANT_PIXELS * 6 / 10; i++)
        p.scene[i] = -9.0;
    for (int i = 0; i < 150; i++)
        plant_turn(&p, &sensor, &s, NULL);
    CHECK_MSG(s.state == PUPIL_SENSOR_CONVERGED && s.reason == PUPIL_SENSOR_HIGHLIGHTS, "light %g EV: %s, %s", light_ev,
              pupil_sensor_state_name(s.state), pupil_sensor_reason_name(s.reason));
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (double slope = 0.625; slope < 1.5; slope += 0.125)
        for (int law = 0; law < LAWS; law++)
            check_last_step(law, slope);
    check_named(-4.0, PUPIL_SENSOR_AT_GAIN_MAX);
    for (double light_ev = 3.8; light_ev < 6.0; light_ev += 0.2)
        check_highlights(light_ev);
    return check_end();
}
