/* Unusual statistics: without counts of pixels, of light below the whole histogram, and of frames that are black when
 * an announced change comes. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;
static pupil_sensor_setting s;
static pupil_stats stats;

static void begin(void)
{
    const pupil_sensor_config c = plant_config(LAW_FINE);
    const double middle = 0.5 * (log2(PLANT_LINE_S) + log2(20.0 / 30.0));
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(0.18) - middle, 2);
}

/* An ISP's statistics give the distribution of light, but not the number of pixels. */
static void test_no_counts(void)
{
    begin();
    for (int i = 0; i < 60; i++) {
        const pupil_frame_info info = plant_next(&p, &stats);
        stats.pixels = stats.clipped = stats.black = stats.bad = 0;
        memset(stats.band_log2_sum, 0, sizeof stats.band_log2_sum);
        memset(stats.band_pixels, 0, sizeof stats.band_pixels);
        CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK);
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        plant_ask(&p, &s);
    }
    const double off = p.light_ev + log2(s.exposure_s * s.gain) - log2(0.18);
    CHECK_MSG(s.state == PUPIL_SENSOR_CONVERGED && fabs(off) < 0.1, "%s, %g EV off", pupil_sensor_state_name(s.state),
              off);
}

/* All light is in the histogram's first bin, which frames metered by the library never reach: the loop asks for the
 * largest exposure, and the state says that it is not enough. */
static void test_lowest_bin(void)
{
    begin();
    for (int i = 0; i < 120; i++) {
        const pupil_frame_info info = plant_next(&p, &stats);
        memset(stats.bin, 0, sizeof stats.bin);
        stats.bin[0] = stats.weight;
        stats.log2_sum = -32 * (int64_t)stats.weight;
        stats.log2_frac = 0;
        CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK);
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        plant_ask(&p, &s);
    }
    CHECK_MSG(s.state == PUPIL_SENSOR_LIMITED && s.gain > 21.0, "%s, %g s, gain %g", pupil_sensor_state_name(s.state),
              s.exposure_s, s.gain);
}

/* The lamp goes out as announced: black frames only show that it is dark, and the sensor keeps the announced
 * setting. */
static void test_announced_dark(void)
{
    begin();
    for (int i = 0; i < 60; i++)
        plant_turn(&p, &sensor, &s, NULL);
    const double before = log2(s.exposure_s * s.gain);
    CHECK(pupil_sensor_announce(&sensor, -6.0, 10, PUPIL_SENSOR_CHANGE_LIGHT) == PUPIL_OK);
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    p.frame--;
    plant_ask(&p, &s);
    p.light_ev -= 20.0;
    for (int i = 0; i < 3; i++) {
        plant_turn(&p, &sensor, &s, NULL);
        CHECK_MSG(s.reason == PUPIL_SENSOR_ANNOUNCED, "frame %d: %s", i, pupil_sensor_reason_name(s.reason));
        const double moved = log2(s.exposure_s * s.gain) - before;
        CHECK_MSG(fabs(moved - 6.0) < 0.2, "frame %d: %g EV", i, moved);
    }
}

/* A chess board of black and white becomes a scene, and a board again: by the dark half all has become brighter, by the
 * bright half darker. The effect of the controls is as certain as before. */
static void test_all_and_nothing(void)
{
    double scene[PLANT_PIXELS];
    begin();
    memcpy(scene, p.scene, sizeof scene);
    for (int i = 0; i < 60; i++) {
        for (int k = 0; k < PLANT_PIXELS; k++)
            p.scene[k] = i % 2 || i > 30 ? scene[k] : k % 2 ? 20.0 : -20.0;
        p.light_slope = 0;
        plant_turn(&p, &sensor, &s, NULL);
    }
    const double off = p.light_ev + log2(s.exposure_s * s.gain) - log2(0.18);
    CHECK_MSG(s.state == PUPIL_SENSOR_CONVERGED && fabs(off) < 0.1, "%s, %g EV off", pupil_sensor_state_name(s.state),
              off);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_no_counts();
    test_lowest_bin();
    test_announced_dark();
    test_all_and_nothing();
    return check_end();
}
