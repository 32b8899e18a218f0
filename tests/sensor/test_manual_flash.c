/* A flash while the exposure is locked or set by the user, and calls on memory that is no sensor. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;
static pupil_sensor_setting s;

/* The setting stays, and so do state and reason, in the flash and after it. */
static void test_flash(void)
{
    static const struct {
        uint32_t lock, manual, reason;
    } cases[] = {{1, 0, PUPIL_SENSOR_LOCK}, {0, 1, PUPIL_SENSOR_ALL_MANUAL}, {1, 1, PUPIL_SENSOR_LOCK}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pupil_sensor_config c = plant_config(LAW_FINE);
        CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
        plant_open(&p, &sensor, log2(0.18) - log2(0.005), 2);
        for (int k = 0; k < 60; k++)
            plant_turn(&p, &sensor, &s, NULL);
        CHECK(s.state == PUPIL_SENSOR_CONVERGED);
        c.lock = cases[i].lock;
        c.exposure_mode = c.gain_mode = cases[i].manual ? PUPIL_SENSOR_MANUAL : PUPIL_SENSOR_AUTO;
        c.manual_exposure_s = s.exposure_s;
        c.manual_gain = s.gain;
        CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
        const double total_s = s.total_s;
        for (int k = 0; k < 30; k++) {
            p.light_ev += k == 10 ? 4.0 : k == 11 ? -4.0 : 0.0;
            plant_turn(&p, &sensor, &s, NULL);
            CHECK_MSG(s.state == PUPIL_SENSOR_LOCKED && s.reason == cases[i].reason, "case %zu, frame %d: %s, %s", i, k,
                      pupil_sensor_state_name(s.state), pupil_sensor_reason_name(s.reason));
            CHECK_MSG(fabs(log2(s.exposure_s * s.gain / total_s)) < 0.02, "case %zu, frame %d: %g s, gain %g", i, k,
                      s.exposure_s, s.gain);
        }
    }
}

static void test_no_sensor(void)
{
    static pupil_sensor none;
    CHECK(pupil_sensor_announce(&none, 1.0, 5, PUPIL_SENSOR_CHANGE_LIGHT) == PUPIL_ERR_OBJECT);
    CHECK(pupil_sensor_announce(NULL, 1.0, 5, PUPIL_SENSOR_CHANGE_LIGHT) == PUPIL_ERR_NULL);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_flash();
    test_no_sensor();
    return check_end();
}
