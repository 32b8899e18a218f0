/* A camera whose gain does nothing, and a steep picture: a search leaves the gain far above the profile's. More gain is
 * more noise, so where highlights hold the level, the profile is tried again, once in each light. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;

enum { FOUND = 250, TRIED = 900 };

static pupil_sensor_setting turns(int count)
{
    pupil_sensor_setting s;
    for (int i = 0; i < count; i++)
        plant_turn(&p, &sensor, &s, NULL);
    return s;
}

/* Begins with random numbers with which the search ends far above the profile. */
static void begin(uint64_t random, int law, double slope)
{
    pupil_sensor_config c = plant_config(law);
    check_state.random = random;
    c.delay_frames = 1 + (uint32_t)(random % 3);
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, 7.0 + 3.0 * check_uniform(), 2);
    p.pixels = 2 * PLANT_WIDTH;
    p.ignored[1] = 1;
    p.noise_ev = 0.02;
    p.slope = slope;
    p.lies = PLANT_NOTHING;
}

static void test_gain_goes_back(void)
{
    begin(16, LAW_FINE, 1.74);
    pupil_sensor_setting s = turns(FOUND);
    CHECK_MSG(s.gain > 4.0 && s.exposure_s < 0.01, "after the search: %g s x %g", s.exposure_s, s.gain);
    s = turns(TRIED);
    CHECK_MSG(s.gain < 2.0 && s.exposure_s < 0.01, "after a long rest: %g s x %g", s.exposure_s, s.gain);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_gain_goes_back();
    return check_end();
}
