/* Strobes and lightning: light that is there in one frame or two moves nothing; a step of the light that stays is
 * answered two frames later than without. Prints a table of docs/sensor.md. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;

static void begin(uint32_t delay, uint32_t flash_frames, int lies)
{
    pupil_sensor_setting s;
    pupil_sensor_config c = plant_config(LAW_FINE);
    c.flash_frames = flash_frames;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(18) + 2, delay);
    p.lies = lies;
    for (int i = 0; i < 60; i++)
        plant_turn(&p, &sensor, &s, NULL);
}

/* Events of so many frames, each a while after the one before: how far the total moves from where it stood. */
static double moved_by(uint32_t delay, int frames, double ev, int every, int lies)
{
    pupil_sensor_setting s;
    double worst = 0;
    begin(delay, 2, lies);
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    const double before = log2(s.total_s), light_ev = p.light_ev;
    for (int i = 0; i < 300; i++) {
        p.light_ev = light_ev + (i % every < frames ? ev : 0);
        plant_turn(&p, &sensor, &s, NULL);
        worst = fmax(worst, fabs(log2(s.total_s) - before));
        CHECK_MSG(s.state == PUPIL_SENSOR_CONVERGED, "state %u, reason %u", s.state, s.reason);
        CHECK(i % every >= frames || fabs(ev) < 0.2 || s.reason == PUPIL_SENSOR_FLASH);
    }
    return worst;
}

static void check_strobes(void)
{
    printf("flashes: how far the total moves, EV\n  frames  -3 EV   -1 EV   +1 EV   +3 EV   +6 EV\n");
    for (int frames = 1; frames <= 2; frames++) {
        static const double evs[] = {-3, -1, 1, 3, 6};
        printf("  %d     ", frames);
        for (int i = 0; i < 5; i++) {
            double worst = 0;
            for (uint32_t delay = 1; delay <= 4; delay++)
                for (int every = 5; every <= 30; every += 5)
                    for (int lies = 0; lies < 2; lies++)
                        worst = fmax(worst, moved_by(delay, frames, evs[i], every, lies));
            printf("  %.4f", worst);
            CHECK_MSG(worst <= 0.02, "%d frames of %+g EV: %g EV", frames, evs[i], worst);
        }
        printf("\n");
    }
}

/* Frames until the sensor is within 0.1 EV, and rounding, of a step that stays. */
static int settled(uint32_t delay, uint32_t flash_frames, double ev, int flash_before)
{
    pupil_sensor_setting s;
    int frames = 0;
    begin(delay, flash_frames, 0);
    for (int i = 0; i < 2 * flash_before; i++) { /* a flash, and a frame of rest */
        p.light_ev += i ? -4 : 4;
        plant_turn(&p, &sensor, &s, NULL);
    }
    p.light_ev += ev;
    for (int i = 0; i < 40; i++) {
        const double off = plant_turn(&p, &sensor, &s, NULL);
        if (off > 0.1 || off < -0.16)
            frames = i + 1;
    }
    return frames;
}

static void check_steps(void)
{
    static const double evs[] = {-6, -3, -1, 1, 3};
    for (uint32_t delay = 1; delay <= 4; delay++)
        for (int i = 0; i < 5; i++)
            for (int flash = 0; flash < 2; flash++) {
                const int without = settled(delay, 0, evs[i], 0), with = settled(delay, 2, evs[i], flash);
                CHECK_MSG(without <= (int)delay + 1 && with <= without + 2, "D %u, %+g EV: %d and %d frames", delay,
                          evs[i], without, with);
            }
    printf("steps that stay: D frames without flash_frames, two more with it\n");
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_strobes();
    check_steps();
    return check_end();
}
