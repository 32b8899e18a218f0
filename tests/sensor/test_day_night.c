/* Day and night: each changes once through dusk and dawn, however the light fluctuates; and an infrared-cut filter that
 * they switch does not switch them back. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;
static pupil_sensor_setting s;
static uint32_t was;

#define NIGHT_EV 3.0
#define DAY_EV   4.5
#define WAIT_S   2.0

static void begin(double light_ev, double frame_s)
{
    pupil_sensor_config c = plant_config(LAW_FINE);
    c.frame_s = frame_s;
    c.night_ev = NIGHT_EV;
    c.day_ev = DAY_EV;
    c.day_night_s = WAIT_S;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, light_ev, 2);
    p.frame_s = frame_s;
    was = PUPIL_SENSOR_DAY_NIGHT_UNKNOWN;
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK && s.day_night == was);
}

/* Whether it changed in this frame. */
static int turn(void)
{
    plant_turn(&p, &sensor, &s, NULL);
    const int changed = s.day_night != was;
    was = s.day_night;
    return changed;
}

static double at_s(void)
{
    return (double)p.frame * p.frame_s;
}

static int stay(double seconds)
{
    int changes = 0;
    for (const double until_s = at_s() + seconds; at_s() < until_s;)
        changes += turn();
    return changes;
}

/* A dusk and a dawn of 6 stops with a cloud of half a stop every three seconds and noise: one change each. `filter`: a
 * filter is switched at once as reported, and lets this much more light through. */
static void day_and_night(double filter_ev, double frame_s)
{
    begin(6.0, frame_s);
    const double middle_s = at_s();
    CHECK(stay(WAIT_S + 1.0) == 1 && was == PUPIL_SENSOR_DAY && at_s() - middle_s >= WAIT_S);
    p.noise_ev = 0.05;
    double passed_ev = 0.0;
    for (int half = 0; half < 2; half++) {
        int changes = 0;
        for (int second = 0; second < 60; second++) {
            const double way = (second + 1) / 60.0, cloud = second % 3 == 0 ? 0.5 : 0.0;
            p.light_ev = (half ? 6.0 * way : 6.0 - 6.0 * way) - cloud + passed_ev;
            for (const double until_s = at_s() + 1.0; at_s() < until_s;) {
                if (!turn())
                    continue;
                changes++;
                const double ev = was == PUPIL_SENSOR_NIGHT ? filter_ev : -filter_ev;
                if (ev == 0.0)
                    continue;
                CHECK(pupil_sensor_announce(&sensor, ev, 3, PUPIL_SENSOR_CHANGE_FILTER) == PUPIL_OK);
                p.light_ev += ev;
                passed_ev += ev;
            }
        }
        CHECK_MSG(changes == 1 && was == (half ? PUPIL_SENSOR_DAY : PUPIL_SENSOR_NIGHT),
                  "filter %g EV, %g s: %d changes, %s", filter_ev, frame_s, changes, pupil_sensor_day_night_name(was));
    }
}

/* Seconds counted before it was turned off do not count when it is on again. */
static void check_off(void)
{
    pupil_sensor_config c = plant_config(LAW_FINE);
    c.night_ev = NIGHT_EV;
    c.day_ev = DAY_EV;
    begin(6.0, 1.0 / 30.0);
    CHECK(stay(WAIT_S - 0.3) == 0);
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
    stay(0.1);
    c.day_night_s = WAIT_S;
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
    CHECK(stay(WAIT_S - 0.3) == 0 && was == PUPIL_SENSOR_DAY_NIGHT_UNKNOWN);
    CHECK(stay(0.6) == 1 && was == PUPIL_SENSOR_DAY);
}

/* Between the two thresholds nothing changes; short changes do not count; a lock does not matter. */
static void check_hysteresis(void)
{
    begin(6.0, 1.0 / 30.0);
    stay(4.0);
    p.light_ev = 0.5 * (NIGHT_EV + DAY_EV) - 0.5;
    CHECK(stay(20.0) == 0 && was == PUPIL_SENSOR_DAY);
    for (int i = 0; i < 5; i++) {
        p.light_ev = NIGHT_EV - 2.0;
        CHECK(stay(WAIT_S - 0.3) == 0);
        p.light_ev = NIGHT_EV + 0.5;
        CHECK(stay(0.5) == 0);
    }
    p.light_ev = NIGHT_EV - 0.5;
    CHECK(stay(WAIT_S + 0.5) == 1 && was == PUPIL_SENSOR_NIGHT);
    p.light_ev = DAY_EV - 0.3;
    CHECK(stay(10.0) == 0);
    pupil_sensor_config c = plant_config(LAW_FINE);
    c.night_ev = NIGHT_EV;
    c.day_ev = DAY_EV;
    c.day_night_s = WAIT_S;
    c.lock = 1;
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
    p.light_ev = DAY_EV + 0.5;
    CHECK(stay(WAIT_S + 0.5) == 1 && was == PUPIL_SENSOR_DAY);
    c.day_night_s = 0.0;
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
    stay(0.1);
    CHECK(was == PUPIL_SENSOR_DAY_NIGHT_UNKNOWN);
    begin(NIGHT_EV + 0.1, 1.0 / 30.0); /* at first the middle decides */
    CHECK(stay(WAIT_S + 0.5) == 1 && was == PUPIL_SENSOR_NIGHT);
}

static void check_config(void)
{
    const char *why = "";
    pupil_sensor_config c = plant_config(LAW_FINE);
    c.night_ev = 1.0;
    CHECK(pupil_sensor_config_check(&c, &why) == PUPIL_ERR_CONFIG && strstr(why, "night_ev"));
    c.day_ev = 257.0;
    CHECK(pupil_sensor_config_check(&c, &why) == PUPIL_ERR_CONFIG && strstr(why, "day_ev"));
    c.day_ev = 1.0;
    CHECK(pupil_sensor_config_check(&c, &why) == PUPIL_OK);
    c.day_night_s = -1.0;
    CHECK(pupil_sensor_config_check(&c, &why) == PUPIL_ERR_CONFIG && strstr(why, "day_night_s"));
    CHECK(strcmp(pupil_sensor_day_night_name(PUPIL_SENSOR_NIGHT), "night") == 0);
    CHECK(strcmp(pupil_sensor_day_night_name(9), "unknown") == 0);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    day_and_night(0.0, 1.0 / 30.0);
    day_and_night(3.0, 1.0 / 30.0);
    day_and_night(3.0, 1.0 / 5.0);
    check_hysteresis();
    check_off();
    check_config();
    return check_end();
}
