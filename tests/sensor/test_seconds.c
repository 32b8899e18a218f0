/* The sensor's slow filter: dL/dt = (target - L) / tau_s in seconds, at any frame rate and with any lost frames, as
 * long as a frame's weight is below 0.39 / delay_frames, or 0.35 where only a delay of 1 is possible. Above that each
 * frame, including those lost before it, goes that share of the way, and no faster. Prints a table. */
#include <math.h>

#include "check.h"
#include "pupil/sensor.h"

#define STEP_EV 0.45 /* below hold_ev, so that the setting is constant */

enum { RATES = 5, TAUS = 3, DELAYS = 2 };

static const double rate[RATES] = {1, 10, 30, 120, 240};
static const double tau[TAUS] = {0.2, 0.8, 10};
static const uint32_t delay[DELAYS] = {1, 4};

typedef struct walk {
    double off_share; /* largest error in time, as a share of the time since the step, from 5 to 95 % of the way */
    int bounded, frames;
    double late[3]; /* time at which 10, 50, 90 % are reached over the ODE's time, interpolated between frames */
} walk;

/* Seconds after which the ODE has left 1 - share of the step, by Heun's method in steps of tau / 20000. */
static long double seconds_until(double share, double tau_s)
{
    static double known_share = -1, known_tau;
    static long double left, t;
    const long double h = (long double)tau_s / 20000;
    if (share < known_share || known_tau != tau_s)
        left = 1, t = 0;
    known_share = share, known_tau = tau_s;
    while (left > 1 - (long double)share) {
        const long double k1 = -left / tau_s, k2 = -(left + h * k1) / tau_s;
        left += h * (k1 + k2) / 2;
        t += h;
    }
    return t;
}

/* The largest weight of a frame. */
static double most_weight(uint32_t frames_delay, int gap)
{
    return fmin(0.39, 0.39 * gap / frames_delay);
}

/* A scene becomes lighter or darker by less than half a stop, well within far_ev (2), and the camera's setting does not
 * move. */
static walk follow(double fps, double tau_s, uint32_t frames_delay, double drops, int darker)
{
    static const double shares[3] = {0.1, 0.5, 0.9};
    pupil_sensor_config c;
    pupil_sensor_setting s;
    pupil_sensor sensor;
    walk w = {0, 0, 0, {0, 0, 0}};
    pupil_sensor_config_default(&c);
    c.far_ev = 2;
    c.hold_ev = 0.5;
    c.tau_s = tau_s;
    c.delay_frames = frames_delay;
    c.frame_s = 1 / fps;
    c.exposure_min_s = 1e-6, c.exposure_max_s = 1 / fps;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_start(&sensor, 1e-4, 1) == PUPIL_OK);
    const double at_rest = log2(0.18) - log2(1e-4);
    double expected = 0, reached = 0, then = 0;
    int64_t last_ns = 0;
    int last = 0;
    for (int i = 0; reached < 0.96; i++) {
        const int64_t now_ns = 1000000000 + (int64_t)((double)i / fps * 1e9);
        if (i > 2 && check_uniform() < drops)
            continue;
        const pupil_frame_info info = {.timestamp_ns = now_ns, .sequence = (uint64_t)i + 1};
        const double scene_ev = at_rest + (i < 2 ? 0 : darker ? -STEP_EV : STEP_EV);
        CHECK(pupil_sensor_scene(&sensor, scene_ev, 0, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        const double dt_s = (now_ns - last_ns) * 1e-9, before = reached;
        const double bound = most_weight(frames_delay, i - last);
        last_ns = now_ns, last = i;
        reached = log2(s.total_s / 1e-4) / STEP_EV * (darker ? 1 : -1);
        if (i < 2) {
            CHECK(fabs(reached) < 1e-9);
            continue;
        }
        const double wanted = 1 - exp(-dt_s / tau_s), weight = wanted < bound ? wanted : bound;
        expected += weight * (1 - expected);
        CHECK_MSG(fabs(reached - expected) < 1e-6, "%g fps, tau %g s, delay %u: %g of the way, %g is right", fps, tau_s,
                  frames_delay, reached, expected);
        w.frames++;
        w.bounded += wanted > bound;
        const double now = (double)(now_ns - 1000000000) * 1e-9 - 1 / fps; /* since the last frame before the step */
        if (reached > 0.05 && reached < 0.95)
            w.off_share = fmax(w.off_share, fabs(now / (double)seconds_until(reached, tau_s) - 1));
        for (int k = 0; k < 3; k++) /* between two frames it moves as the ODE does */
            if (before < shares[k] && reached >= shares[k]) {
                const double part = log((1 - before) / (1 - shares[k])) / log((1 - before) / (1 - reached));
                w.late[k] = (then + part * (now - then)) / (double)seconds_until(shares[k], tau_s);
            }
        then = now;
    }
    return w;
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    printf("time over that of the ODE at 50 %% of the way; *: the bound of the weight acts\n%-8s%-8s", "tau_s",
           "delay");
    for (int r = 0; r < RATES; r++)
        printf("%8.0f fps", rate[r]);
    printf("\n");
    for (int t = 0; t < TAUS; t++)
        for (int d = 0; d < DELAYS; d++)
            for (int drops = 0; drops < 2; drops++) {
                printf("%-8g%-4u%-6s", tau[t], delay[d], drops ? "20 %" : "");
                for (int r = 0; r < RATES; r++) {
                    const walk up = follow(rate[r], tau[t], delay[d], drops ? 0.2 : 0, 0);
                    const walk down = follow(rate[r], tau[t], delay[d], drops ? 0.2 : 0, 1);
                    const int free_of_bound = !up.bounded && !down.bounded;
                    printf("%11.3f%s", up.late[1], up.bounded ? "*" : " ");
                    const walk *w[2] = {&up, &down};
                    for (int k = 0; k < 2 && free_of_bound; k++) {
                        CHECK_MSG(w[k]->off_share <= 0.01, "%g fps, tau %g s, delay %u: off by %.4f of the time",
                                  rate[r], tau[t], delay[d], w[k]->off_share);
                        for (int n = 0; n < 3; n++)
                            CHECK_MSG(fabs(w[k]->late[n] - 1) <= 0.01, "%g fps, tau %g s, delay %u: %.4f of the time",
                                      rate[r], tau[t], delay[d], w[k]->late[n]);
                    }
                    /* the bound acts where tau_s x rate is below 1 / -ln(1 - bound), 9.75 at a delay of 4, and nowhere
                     * else */
                    const double least = -1 / log(1 - most_weight(delay[d], 1));
                    if (!drops)
                        CHECK_MSG((up.bounded == up.frames) == (tau[t] * rate[r] < least) &&
                                      (up.bounded == 0) == free_of_bound,
                                  "%g fps, tau %g s, delay %u: %d of %d frames bounded", rate[r], tau[t], delay[d],
                                  up.bounded, up.frames);
                    CHECK_MSG(free_of_bound || (up.late[1] > 0.99 && down.late[1] > 0.99),
                              "%g fps, tau %g s, delay %u: faster than the ODE", rate[r], tau[t], delay[d]);
                }
                printf("\n");
            }
    return check_end();
}
