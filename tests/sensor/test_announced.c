/* A change of light that is announced: how soon the sensor is right with and without the announcement, that nothing is
 * learned from frames in which light and controls move at once, and what happens after a wrong announcement. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;
static pupil_sensor_setting s;

typedef struct answer {
    int frames;       /* from the light's first frame to the one from which the sensor stays right */
    double overshoot; /* stops beyond, from the change on */
    double shown;     /* largest error of the shown level once the sensor is right */
    int settings;     /* asked for */
} answer;

/* Announces after the last frame. */
static void announce(double ev, uint32_t within, uint32_t change)
{
    CHECK(pupil_sensor_announce(&sensor, ev, within, change) == PUPIL_OK);
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    p.frame--;
    plant_ask(&p, &s);
}

static void begin(uint32_t delay, int lies, double middle_ev)
{
    const pupil_sensor_config c = plant_config(LAW_FINE);
    const double middle = 0.5 * (log2(PLANT_LINE_S) + log2(20.0 / 30.0));
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(0.18) - middle + middle_ev, delay);
    p.lies = lies;
    for (int i = 0; i < 60; i++)
        plant_turn(&p, &sensor, &s, NULL);
}

static void learn_delay(void)
{
    for (int i = 0; i < 120; i++) {
        p.light_ev += i == 0 ? 1.0 : i == 60 ? -1.0 : 0.0;
        plant_turn(&p, &sensor, &s, NULL);
    }
}

/* `lead`: frames from the call to the light's first one; 0: nothing is announced. */
static answer step(double ev, double announced_ev, int lead, uint32_t within)
{
    answer a = {0, 0.0, 0.0, 0};
    if (lead)
        announce(announced_ev, within, PUPIL_SENSOR_CHANGE_LIGHT);
    a.settings = lead != 0;
    for (int i = 1; i < lead; i++) {
        plant_turn(&p, &sensor, &s, NULL);
        a.settings += s.changed != 0;
    }
    p.light_ev += ev;
    for (int i = 0; i < 90; i++) {
        double shown;
        const double off = plant_turn(&p, &sensor, &s, &shown);
        a.settings += s.changed != 0;
        if (fabs(off) > 0.12) {
            a.frames = i + 1;
            a.shown = 0.0;
        } else {
            a.shown = fmax(a.shown, fabs(shown));
        }
        a.overshoot = fmax(a.overshoot, ev > 0 ? -off : off);
    }
    CHECK_MSG(s.state == PUPIL_SENSOR_CONVERGED, "%+g EV: %s", ev, pupil_sensor_state_name(s.state));
    return a;
}

static void check_settling(void)
{
    static const double steps[] = {-6, -4, -2, 2, 4, 6};
    printf(
        "frames until the sensor is right: nothing announced, announced with the light, announced D frames before\n");
    printf("D ");
    for (int i = 0; i < 6; i++)
        printf("%+12.0f EV", steps[i]);
    printf("   overshoot, EV: not announced, announced\n");
    for (int lies = PLANT_TRUTH; lies <= PLANT_NOTHING; lies++)
        for (uint32_t delay = 1; delay <= 5; delay++) {
            double beyond[2] = {0.0, 0.0};
            printf("%u", delay);
            for (int i = 0; i < 6; i++) {
                answer a[3];
                for (int how = 0; how < 3; how++) {
                    begin(delay, lies, -0.5 * steps[i]);
                    learn_delay();
                    a[how] = step(steps[i], steps[i], how == 0 ? 0 : how == 1 ? 1 : (int)delay, 3);
                    beyond[how > 0] = fmax(beyond[how > 0], a[how].overshoot);
                }
                printf("  %3d %3d %3d ", a[0].frames, a[1].frames, a[2].frames);
                CHECK_MSG(a[1].frames <= (int)delay - 1, "D %u, %+g EV: %d frames", delay, steps[i], a[1].frames);
                CHECK_MSG(a[2].frames == 0, "D %u, %+g EV: %d frames", delay, steps[i], a[2].frames);
                CHECK_MSG(a[1].shown < 0.1 && a[2].shown < 0.1, "D %u, %+g EV: shown %g EV off", delay, steps[i],
                          fmax(a[1].shown, a[2].shown));
                CHECK_MSG(a[0].frames > a[1].frames, "D %u, %+g EV: sooner without", delay, steps[i]);
            }
            printf("   %.3f %.3f\n", beyond[0], beyond[1]);
            CHECK_MSG(beyond[1] < 0.05, "D %u: overshoot %g EV", delay, beyond[1]);
        }
}

/* The setting comes before the light, which comes within the announced frames: a single step, and the digital factor
 * makes up for it. */
static void check_waiting(void)
{
    for (int known = 0; known < 2; known++)
        for (int lead = 1; lead <= 12; lead++)
            for (int sign = -1; sign <= 1; sign += 2) {
                begin(3, PLANT_NOTHING, 0.0);
                if (known)
                    learn_delay();
                const answer a = step(sign * 1.4, sign * 1.4, lead, 12);
                CHECK_MSG(a.settings == 1, "lead %d, known %d: %d settings", lead, known, a.settings);
                CHECK_MSG(a.frames <= (lead < 3 ? 3 - lead : 0), "lead %d: %d frames", lead, a.frames);
                CHECK_MSG(a.overshoot < 0.06, "lead %d: overshoot %g", lead, a.overshoot);
            }
}

/* A change that does not come is taken back, and one that comes otherwise is corrected; neither is attributed to the
 * camera. */
static void check_wrong(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        begin(2, PLANT_NOTHING, 0.0);
        learn_delay();
        const double before = log2(s.total_s);
        answer a = step(0.0, sign * 3.0, 1, 5);
        CHECK_MSG(a.frames >= 5 && a.frames <= 5 + 2 * 2 + 5, "nothing comes: %d frames", a.frames);
        CHECK_MSG(fabs(log2(s.total_s) - before) < 0.06, "nothing comes: %g EV", log2(s.total_s) - before);
        CHECK(s.exposure_delay == 2 && s.slope == 1.0);
        a = step(sign * 4.0, sign * 3.0, 2, 5);
        CHECK_MSG(a.frames <= 5 + 2 * 2 + 5, "a stop more than announced: %d frames", a.frames);
        CHECK_MSG(fabs(log2(s.total_s) - before + sign * 4.0) < 0.06, "a stop more: %g EV", log2(s.total_s) - before);
        CHECK(s.exposure_delay == 2 && s.slope == 1.0);
        a = step(-sign * 3.0, sign * 2.0, 1, 5);
        CHECK_MSG(fabs(log2(s.total_s) - before + sign * 1.0) < 0.06, "the other way: %g EV", log2(s.total_s) - before);
    }
}

/* A flash of some frames, on and off; and two changes at once. */
static void check_pairs(void)
{
    begin(3, PLANT_TRUTH, 0.0);
    learn_delay();
    const double before = log2(s.total_s);
    for (int turn = 0; turn < 2; turn++) {
        const double ev = turn ? -4.0 : 4.0;
        announce(ev, 2, PUPIL_SENSOR_CHANGE_LIGHT);
        for (int i = 0; i < 10; i++) {
            p.light_ev += i == 2 ? ev : 0.0;
            const double off = plant_turn(&p, &sensor, &s, NULL);
            CHECK_MSG(fabs(off) < 0.12, "the flash: frame %d is %g EV off", i, off);
        }
    }
    CHECK(fabs(log2(s.total_s) - before) < 0.06);
    announce(2.0, 8, PUPIL_SENSOR_CHANGE_LIGHT);
    plant_turn(&p, &sensor, &s, NULL);
    CHECK(s.reason == PUPIL_SENSOR_ANNOUNCED && s.state == PUPIL_SENSOR_SEARCHING);
    announce(1.0, 8, PUPIL_SENSOR_CHANGE_LIGHT);
    for (int i = 0; i < 30; i++) {
        p.light_ev += i == 2 ? 3.0 : 0.0;
        plant_turn(&p, &sensor, &s, NULL);
    }
    CHECK(s.state == PUPIL_SENSOR_CONVERGED && fabs(log2(s.total_s) - before + 3.0) < 0.06);
}

/* At the camera's limit the missing stops count, too; a lock is a limit; and refused announcements. */
static void check_limits(void)
{
    pupil_sensor_config c = plant_config(LAW_FINE);
    begin(2, PLANT_TRUTH, -12.0); /* three stops below what the camera reaches, or so */
    CHECK(s.state == PUPIL_SENSOR_LIMITED);
    const double most = log2(s.total_s);
    const double missing = log2(0.18) - p.light_ev - most;
    CHECK_MSG(missing > 1.0 && missing < 6.0, "%g EV", missing);
    const answer a = step(missing + 2.0, missing + 2.0, 2, 5);
    CHECK_MSG(a.frames == 0 && a.settings == 1, "from a limit: %d frames, %d settings", a.frames, a.settings);

    c.lock = 1;
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
    const double held = s.total_s;
    announce(3.0, 5, PUPIL_SENSOR_CHANGE_LIGHT);
    CHECK(!s.changed && s.total_s == held);

    const pupil_sensor same = sensor;
    CHECK(pupil_sensor_announce(NULL, 1.0, 5, 0) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_announce(&sensor, (double)NAN, 5, 0) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_announce(&sensor, 32.5, 5, 0) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_announce(&sensor, 1.0, 0, 0) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_announce(&sensor, 1.0, 1001, 0) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_announce(&sensor, 1.0, 5, PUPIL_SENSOR_CHANGE_COUNT) == PUPIL_ERR_VALUE);
    CHECK(memcmp(&same, &sensor, sizeof same) == 0);
    pupil_sensor fresh;
    CHECK(pupil_sensor_init(&fresh, &c) == PUPIL_OK);
    CHECK(pupil_sensor_announce(&fresh, 1.0, 5, 0) == PUPIL_OK); /* before the first frame: nothing */
    CHECK(strcmp(pupil_sensor_reason_name(PUPIL_SENSOR_ANNOUNCED), "announced") == 0);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_settling();
    check_waiting();
    check_wrong();
    check_pairs();
    check_limits();
    return check_end();
}
