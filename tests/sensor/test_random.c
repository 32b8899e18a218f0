/* Random cameras, each with its own delays, gain law, wrong metadata and tone curve: none of them makes the loop swing.
 *
 *     test_sensor_random [SEED [COUNT]]
 *
 * Prints the first cameras that do, and how many of each kind there were. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;

enum { SEARCH = 500, WATCHED = 300 };

/* One in n. */
static int one_in(int n)
{
    return check_random() % (uint64_t)n == 0;
}

static double between(double low, double high)
{
    return low + (high - low) * check_uniform();
}

/* Describes the camera in a line. */
static void describe(uint64_t seed, const pupil_sensor_config *c)
{
    printf(
        "    seed %llu: believed %u, true %u and %u, info %d, slope %.2f%s, linear %u, ignored %d %d, off by one %d, "
        "moving %.2f, wrap %.1f, jitter %.2f, drops %.2f, noise %.3f, mains %u, light %.2f\n",
        (unsigned long long)seed, c->delay_frames, p.delay[0], p.delay[1], p.lies, p.slope, p.shoulder ? " bent" : "",
        c->linear, p.ignored[0], p.ignored[1], p.off_by_one, p.moving, p.wrap, p.jitter, p.drops, p.noise_ev,
        c->mains_hz, p.light_ev);
}

static pupil_sensor_config random_camera(void)
{
    pupil_sensor_config c = plant_config((int)(check_random() % LAWS));
    c.delay_frames = 1 + (uint32_t)(check_random() % 4);
    c.linear = (uint32_t)(check_random() % 2);
    const int kind = (int)(check_random() % 16);
    c.mains_hz = one_in(4) ? 50 : 0;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, between(-1, 9), 1 + (uint32_t)(check_random() % 6));
    p.pixels = 2 * PLANT_WIDTH;
    p.delay[1] = one_in(2) ? p.delay[0] : 1 + (uint32_t)(check_random() % 6);
    p.lies = (int)(check_random() % 4);
    p.slope = one_in(2) ? 1.0 : between(0.5, 2.0);
    p.shoulder = one_in(4);
    p.noise_ev = one_in(2) ? 0.0 : 0.02;
    p.drops = one_in(8) ? 0.2 : 0.0;
    p.jitter = one_in(8) ? 0.2 : 0.0;
    switch (kind) {
    case 0:
        p.ignored[0] = 1;
        break;
    case 1:
        p.ignored[1] = 1;
        break;
    case 2:
        p.off_by_one = 1;
        break;
    case 3:
        p.moving = between(0.4, 1.5);
        break;
    case 4:
        p.wrap = between(4, 16);
        break;
    default:
        break;
    }
    return c;
}

/* Large steps in the watched time, with a still scene, and the total's range. */
static int watch(double *wandered, pupil_sensor_setting *s)
{
    double low = 1e9, high = -1e9, last = 0;
    int steps = 0;
    for (int i = 0; i < SEARCH + WATCHED; i++) {
        plant_turn(&p, &sensor, s, NULL);
        const double total = log2(s->total_s);
        if (i > SEARCH) {
            steps += fabs(total - last) > 0.08;
            low = fmin(low, total);
            high = fmax(high, total);
        }
        last = total;
    }
    *wandered = high - low;
    return steps;
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    const long count = argc > 2 ? atol(argv[2]) : 1000;
    const uint64_t first = check_state.seed;
    long swinging = 0;
    double worst = 0;
    for (long i = 0; i < count; i++) {
        pupil_sensor_setting s;
        double wandered;
        check_state.random = first + (uint64_t)i * UINT64_C(0x9e3779b97f4a7c15); /* each one can be run alone */
        const uint64_t seed = check_state.random;
        const pupil_sensor_config c = random_camera();
        const int steps = watch(&wandered, &s);
        if (steps > 2 || (steps > 0 && wandered > 0.5)) {
            if (swinging++ < 10) {
                printf("%d steps, %.3f EV, state %u, reason %u\n", steps, wandered, s.state, s.reason);
                describe(seed, &c);
            }
        } else {
            worst = fmax(worst, wandered);
        }
    }
    printf("random cameras: %ld of %ld swing; of the others the total wanders by %.3f EV at most\n", swinging, count,
           worst);
    /* cameras of the first seed with a dead gain, or with delays far beyond the configured ones; may only fall */
    CHECK(swinging * 1000 <= 2 * count);
    return check_end();
}
