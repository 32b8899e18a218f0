/* Cameras with controls in steps of up to a stop, down, up or to the nearest, with no metadata of this or wrong ones:
 * searches that switch to the other control, and searches with one control held. */
#include "sensor_plant.h"

enum { NONE_IS_HELD, GAIN_IS_HELD, EXPOSURE_IS_HELD };
enum { FRAMES = 300, LIGHT_FRAMES = 100 };
enum { EXACT_FRAMES = 60, SETTLING_FRAMES = 120, WATCHED_FRAMES = 60 };
static const double held[2] = {0.003, 2.0};

static plant p;
static pupil_sensor sensor;

/* Steps of a control, in stops; 0: any. */
typedef struct steps {
    double ev, first_ev, up;
} steps;

static steps any_steps(void)
{
    const steps s = {check_uniform() < 0.2 ? 0.0 : 0.2 + 1.2 * check_uniform(), check_uniform(),
                     0.5 * (double)(check_random() % 3)};
    return s;
}

static double in_steps(const steps *s, double value)
{
    return s->ev > 0.0 ? exp2(floor((log2(value) - s->first_ev) / s->ev + s->up + 1e-9) * s->ev + s->first_ev) : value;
}

static void any_camera(int which_is_held)
{
    pupil_sensor_config c = plant_config((int)(check_random() % LAWS));
    c.mains_hz = which_is_held == GAIN_IS_HELD || check_random() % 2 ? PUPIL_SENSOR_MAINS_AUTO : 0;
    c.linear = (uint32_t)(check_random() % 2);
    c.exposure_min_s = 1e-4;
    c.gain_mode = which_is_held == GAIN_IS_HELD ? PUPIL_SENSOR_MANUAL : PUPIL_SENSOR_AUTO;
    c.manual_gain = held[1];
    c.exposure_mode = which_is_held == EXPOSURE_IS_HELD ? PUPIL_SENSOR_MANUAL : PUPIL_SENSOR_AUTO;
    c.manual_exposure_s = held[0];
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, 1.0 + 6.0 * check_uniform(), 1 + (uint32_t)(check_random() % 4));
    p.moving = check_random() % 5 == 0 ? 0.4 + check_uniform() : 0.0;
}

/* A held control stays as it is, and the other one is written in few frames of each light. */
static void check_camera(uint64_t seed, int which_is_held)
{
    check_state.random = seed;
    any_camera(which_is_held);
    const steps s[2] = {any_steps(), any_steps()};
    int changes = 0;
    for (int i = 0; i < FRAMES; i++) {
        pupil_sensor_setting now;
        if (i % LIGHT_FRAMES == 0) {
            p.light_ev += i ? 6.0 * check_uniform() - 3.0 : 0.0;
            p.lies = (int)(check_random() % 4);
            CHECK_MSG(changes < 30, "camera %llu: %d settings in a light", (unsigned long long)seed, changes);
            changes = 0;
        }
        plant_turn(&p, &sensor, &now, NULL);
        double *asked = p.asked[(p.frame - 1) % PLANT_RING];
        changes += now.changed != 0;
        CHECK_MSG((which_is_held != GAIN_IS_HELD || fabs(log2(asked[1] / held[1])) < 0.35) &&
                      (which_is_held != EXPOSURE_IS_HELD || fabs(log2(asked[0] / held[0])) < 0.01),
                  "camera %llu: %g s, gain %g", (unsigned long long)seed, asked[0], asked[1]);
        for (int c = 0; c < 2; c++)
            asked[c] = in_steps(&s[c], asked[c]);
    }
}

/* Gains in whole steps, and a longest exposure that is a line short of half a period of the mains: from bright to dark,
 * no longer exposure is ever asked for. */
static void check_just_below_mains(void)
{
    pupil_sensor_config c = plant_config(LAW_SIXTEENTH);
    c.mains_hz = 50;
    c.exposure_step_s = c.exposure_min_s = 1e-4;
    c.exposure_max_s = 0.0099;
    c.gain_step = 1.0;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, 6.0, 2);
    for (int i = 0; i < 400; i++) {
        pupil_sensor_setting now;
        p.light_ev -= 0.02;
        plant_turn(&p, &sensor, &now, NULL);
        CHECK_MSG(now.exposure_s <= c.exposure_max_s * (1.0 + 1e-9), "frame %d: %g s", i, now.exposure_s);
    }
}

/* A webcam with exposures of 100 us x 2^n, a gain that does nothing, and no metadata: in light between two of its
 * exposures the nearer one is kept. Small steps may still be asked for. */
static int rests_without_gain(double between_ev)
{
    pupil_sensor_config c = plant_config(LAW_SIXTEENTH);
    pupil_sensor_setting now;
    int changes = 0;
    double off = 0.0;
    c.highlight_ev = 0.0; /* the key alone, so that the right exposure is known */
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(0.18 / 0.0064) - 3.0, 2);
    p.lies = PLANT_NOTHING;
    p.ignored[1] = 1;
    for (int i = 0; i < EXACT_FRAMES + SETTLING_FRAMES + WATCHED_FRAMES; i++) {
        p.light_ev += i == EXACT_FRAMES ? 3.0 + between_ev : 0.0;
        off = plant_turn(&p, &sensor, &now, NULL);
        changes += i >= EXACT_FRAMES + SETTLING_FRAMES && now.changed;
        double *asked = p.asked[(p.frame - 1) % PLANT_RING];
        asked[0] = 1e-4 * exp2(floor(log2(asked[0] / 1e-4) + 1e-9));
    }
    printf("%.3f EV from an exposure: %d settings in the last %d frames, %+.3f EV off\n", between_ev, changes,
           WATCHED_FRAMES, off);
    return changes <= 3 && fabs(off) <= 0.55;
}

/* Of some hundred cameras those that take rare paths of the search: the moving control has changed as often as allowed,
 * with steps and without; a gain is held during the search for the mains; the metadata of a held exposure are no longer
 * believed. */
int main(int argc, char **argv)
{
    static const uint64_t changing[] = {12, 37, 57, 81, 176}, gain[] = {4, 5}, exposure[] = {10, 62, 68};
    check_begin(argc, argv);
    for (size_t i = 0; i < sizeof changing / sizeof *changing; i++)
        check_camera(changing[i], NONE_IS_HELD);
    for (size_t i = 0; i < sizeof gain / sizeof *gain; i++)
        check_camera(gain[i], GAIN_IS_HELD);
    for (size_t i = 0; i < sizeof exposure / sizeof *exposure; i++)
        check_camera(exposure[i], EXPOSURE_IS_HELD);
    check_just_below_mains();
    int resting = 0;
    for (int i = 0; i < 24; i++)
        resting += rests_without_gain(i / 24.0);
    CHECK_MSG(resting >= 22, "at rest in %d of 24 lights", resting);
    return check_end();
}
