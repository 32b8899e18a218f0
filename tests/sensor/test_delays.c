/* The delays of the two controls, found from the frames where info reports what was asked for: whatever delay is
 * configured, the loop does not hunt, and only the true delay is ever named. Prints a table. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;

static void begin(int law, uint32_t believed, uint32_t exposure, uint32_t gain, int lies)
{
    pupil_sensor_config c = plant_config(law);
    c.delay_frames = believed;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(18), exposure); /* right from the first frame on */
    p.delay[1] = gain;
    p.lies = lies;
    p.noise_ev = 0.02;
}

/* The scene of a carried camera: it wanders by some hundredths of a stop a frame, and once a second it changes by up to
 * two stops. */
static void wander(int frame)
{
    p.light_ev += 0.03 * plant_normal();
    if (frame % 30 == 10)
        p.light_ev += p.light_ev > 2.0 ? -0.5 - 1.5 * check_uniform() : 0.5 + 1.5 * check_uniform();
    p.light_ev = fmax(-3.0, fmin(8.0, p.light_ev));
}

/* The range of the shown level at rest. */
static double hunting(int frames)
{
    pupil_sensor_setting s;
    double low = 100, high = -100;
    for (int i = 0; i < frames; i++) {
        double shown;
        plant_turn(&p, &sensor, &s, &shown);
        low = fmin(low, shown);
        high = fmax(high, shown);
    }
    return high - low;
}

static void check_pairs(void)
{
    printf(
        "true and believed delay: frames of a changing scene until exposure and gain are identified, hunting then\n");
    int unknown = 0;
    for (uint32_t real = 1; real <= 4; real++)
        for (uint32_t believed = 1; believed <= 4; believed++) {
            pupil_sensor_setting s;
            int latest = 0, wrong = 0;
            double worst = 0, before = 0;
            for (int round = 0; round < 20; round++) {
                int found = -1;
                begin(round % LAWS, believed, real, real, 1);
                for (int i = 0; i < 120; i++) {
                    wander(i);
                    plant_turn(&p, &sensor, &s, NULL);
                    wrong += (s.exposure_delay && s.exposure_delay != real) || (s.gain_delay && s.gain_delay != real);
                    if (s.exposure_delay != real)
                        found = -1;
                    else if (found < 0)
                        found = i + 1;
                }
                found -= 10; /* when the scene first changes */
                unknown += s.exposure_delay != real;
                CHECK(!s.gain_delay || s.gain_delay == real);
                latest = found > latest ? found : latest;
                p.noise_ev = 0;
                hunting(200); /* lets the slow filter finish; a cycle of hunting takes about twice the delay */
                worst = fmax(worst, hunting(100));
                /* and from a start, before anything is known: the loop must come to rest */
                begin(round % LAWS, believed, real, real, 1);
                p.light_ev -= 3;
                p.noise_ev = 0;
                hunting(100);
                before = fmax(before, hunting(100));
            }
            printf("  true %u believed %u: %2d frames, %d wrong, %.4f EV; from a start in still light %.4f EV\n", real,
                   believed, latest, wrong, worst, before);
            CHECK_MSG(wrong == 0, "true %u, believed %u: wrong in %d frames", real, believed, wrong);
            CHECK_MSG(worst <= 0.02 && before <= 0.02, "true %u, believed %u: %g, %g EV", real, believed, worst,
                      before);
        }
    printf("not known after four changes of the scene: %d of 320\n", unknown);
    CHECK(unknown <= 3); /* where the changes need steps that hardly exceed the scene's wandering */
}

/* With true info the delays are found, whatever is believed, even if they are longer than that. */
static void check_truthful(void)
{
    int latest = 0, late = 0, unknown = 0;
    for (uint32_t run = 0; run < 500; run++) {
        const uint32_t exposure = 1 + run % 5, gain = 1 + run / 5 % 5, believed = 1 + run / 25 % 4;
        pupil_sensor_setting s;
        int found = -1;
        begin((int)run % LAWS, believed, exposure, gain, PLANT_TRUTH);
        for (int i = 0; i < 150; i++) {
            wander(i);
            plant_turn(&p, &sensor, &s, NULL);
            found = s.exposure_delay != exposure ? -1 : found < 0 ? i + 1 - 10 : found;
            CHECK_MSG(!s.exposure_delay || s.exposure_delay == exposure, "frame %d: %u, not %u; believed %u", i,
                      s.exposure_delay, exposure, believed);
            CHECK_MSG(!s.gain_delay || s.gain_delay == gain, "frame %d: gain's %u, not %u; believed %u", i,
                      s.gain_delay, gain, believed);
        }
        unknown += s.exposure_delay != exposure;
        latest = found > latest ? found : latest;
        late += found > 30;
    }
    CHECK(late <= 25 && unknown <= 3); /* of 500 */
    printf("true info, delays 1 to 5, believed 1 to 4: known after at most %d frames, %d of 500 after 30\n", latest,
           late);
}

/* Delays become longer than believed, with true metadata: the loop waits for each step, and finds the delays again. */
static void check_longer(void)
{
    static const double step_ev[] = {3.0, -4.0, 4.0, -3.0};
    pupil_sensor_setting s;
    begin(LAW_FINE, 4, 3, 3, PLANT_TRUTH);
    p.noise_ev = 0.0;
    for (int i = 0; i < 240; i++) {
        p.light_ev = log2(18) + (i / 40 % 2 ? 3.0 : 0.0);
        plant_turn(&p, &sensor, &s, NULL);
    }
    p.delay[0] = p.delay[1] = 6;
    for (int k = 0; k < 4; k++) {
        double worst = 0.0;
        p.light_ev += step_ev[k];
        for (int i = 0; i < 120; i++) {
            double shown;
            plant_turn(&p, &sensor, &s, &shown);
            worst = i < 60 ? 0.0 : fmax(worst, fabs(shown));
        }
        CHECK_MSG(worst < 0.1, "step %d after the delay became longer: shown %g EV off", k, worst);
    }
    CHECK_MSG(s.exposure_delay == 6 && (!s.gain_delay || s.gain_delay == 6), "delays of 6: %u, %u", s.exposure_delay,
              s.gain_delay);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_pairs();
    check_truthful();
    check_longer();
    return check_end();
}
