/* Strobes and lightning: light of one or two frames moves nothing; a step of the light that stays is answered two
 * frames later than without rejection. Prints a table. */
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

/* Events of this many frames, every `every` frames: how far the total moves from its value at rest. */
static double moved_by(uint32_t delay, int frames, double ev, int every, int lies)
{
    pupil_sensor_setting s;
    double worst = 0;
    begin(delay, 2, lies);
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    const double before = log2(s.total_s), light_ev = p.light_ev;
    for (int i = 0; i < 12 * every; i++) {
        p.light_ev = light_ev + (i % every < frames ? ev : 0);
        plant_turn(&p, &sensor, &s, NULL);
        worst = fmax(worst, fabs(log2(s.total_s) - before));
        /* converged is what is not far off */
        const int is_lit = i % every < frames;
        CHECK_MSG(s.state == (is_lit ? PUPIL_SENSOR_SEARCHING : PUPIL_SENSOR_CONVERGED), "state %u, reason %u", s.state,
                  s.reason);
        CHECK((s.reason == PUPIL_SENSOR_FLASH) == is_lit);
    }
    return worst;
}

/* Alone and in trains: every 3rd to 10th frame, and every 30th. */
static void check_strobes(void)
{
    printf("flashes: how far the total moves, EV\n  frames  -3 EV   -1 EV   +1 EV   +3 EV   +6 EV\n");
    for (int frames = 1; frames <= 2; frames++) {
        static const double evs[] = {-3, -1, 1, 3, 6};
        printf("  %d     ", frames);
        for (int i = 0; i < 5; i++) {
            double worst = 0;
            for (uint32_t delay = 1; delay <= 4; delay++)
                for (int every = 3; every <= 11; every++)
                    for (int lies = 0; lies < 2; lies++) {
                        const double moved = moved_by(delay, frames, evs[i], every > 10 ? 30 : every, lies);
                        CHECK_MSG(moved <= 0.02, "%d frames of %+g EV, one of %d, D %u, lies %d: %g EV", frames, evs[i],
                                  every, delay, lies, moved);
                        worst = fmax(worst, moved);
                    }
            printf("  %.4f", worst);
        }
        printf("\n");
    }
}

/* When a flash is, relative to a step at frame 0: its frames, and its stops above the light at that time. */
typedef struct beside {
    const char *what;
    int from, to;
    double ev;
} beside;

static const beside flashes[] = {{"no flash", 0, 0, 0},
                                 {"two frames before", -2, 0, 4},
                                 {"a frame before, one between", -2, -1, 4},
                                 {"dark before", -2, 0, -4},
                                 {"with its first frame", 0, 1, 3},
                                 {"with its first two", 0, 2, 3},
                                 {"dark, with its first", 0, 1, -3},
                                 {"before and with it", -1, 1, 3}};
enum { FLASHES = sizeof flashes / sizeof flashes[0] };

/* Frames until the sensor is within 0.1 EV, and rounding, of a step that stays. */
static int settled(uint32_t delay, uint32_t flash_frames, double ev, const beside *flash)
{
    pupil_sensor_setting s;
    int frames = 0;
    begin(delay, flash_frames, 0);
    const double light_ev = p.light_ev;
    for (int i = -2; i < 40; i++) {
        const double lit = light_ev + (i >= 0 ? ev : 0); /* with the flash, where there is one */
        p.light_ev = lit + (i >= flash->from && i < flash->to ? flash->ev : 0);
        const double off = plant_turn(&p, &sensor, &s, NULL) - (p.light_ev - lit);
        if (i >= 0 && (off > 0.1 || off < -0.16))
            frames = i + 1;
    }
    return frames;
}

/* Whether, with the flash, a frame shows only a part of the step: this part is done first, and then the rest. */
static int is_in_two(const beside *flash, double ev)
{
    const double seen = flash->to > 0 ? ev + flash->ev : flash->ev;
    return flash->from < flash->to && flash->to >= 0 && seen * ev > 0 && fabs(seen) < fabs(ev);
}

/* Two frames later than without rejection, plus the frames in which a flash hides the step. Where a flash looks like a
 * part of the step, that part is done first; the second step needs as many agreeing frames. */
static void check_steps(void)
{
    static const double evs[] = {-6, -3, -1, 1, 3};
    printf("a step that stays, D 1 to 4: frames beyond D, -6 to +3 EV\n");
    for (int f = 0; f < FLASHES; f++) {
        printf("  %-28s", flashes[f].what);
        for (int i = 0; i < 5; i++) {
            int most = 0;
            for (uint32_t delay = 1; delay <= 4; delay++) {
                const int without = settled(delay, 0, evs[i], &flashes[0]),
                          with = settled(delay, 2, evs[i], &flashes[f]);
                const int hidden = flashes[f].to > 0 ? flashes[f].to : 0, d = (int)delay;
                const int limit = is_in_two(&flashes[f], evs[i]) ? 2 + (d > 3 ? d : 3) + d : without + 2 + hidden;
                CHECK_MSG(without <= d + 1 && with <= limit, "%s, D %d, %+g EV: %d and %d frames", flashes[f].what, d,
                          evs[i], without, with);
                most = with - d > most ? with - d : most;
            }
            printf("%4d", most);
        }
        printf("\n");
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_strobes();
    check_steps();
    return check_end();
}
