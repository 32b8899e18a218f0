/* The default law: first order in log2 luminance, in seconds, at any frame rate, with separate time constants for more
 * and for less light; and the effects of clocks.
 */
#include "check.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

#define SECOND INT64_C(1000000000)

static void start(pupil_t *pupil, double tau_light, double tau_dark)
{
    pupil_config config;
    pupil_config_default(&config);
    config.tau_light_s = tau_light;
    config.tau_dark_s = tau_dark;
    config.white_mode = PUPIL_WHITE_NONE;
    config.highlight_ev = 0;
    CHECK(pupil_init(pupil, &config) == PUPIL_OK);
}

static pupil_exposure adapt(pupil_t *pupil, double ev, int64_t timestamp_ns)
{
    const pupil_frame_info info = {.timestamp_ns = timestamp_ns};
    pupil_exposure exposure = {0};
    pupil_stats stats;
    ref_stats_at(ev, 0, &stats);
    CHECK(pupil_adapt(pupil, &stats, &info) == PUPIL_OK);
    CHECK(pupil_get_exposure(pupil, &exposure) == PUPIL_OK);
    return exposure;
}

/* After a step the distance is exp(-t / tau) of the original, for any mix of time steps. */
static void check_closed_form(void)
{
    double worst = 0;
    for (int i = 0; i < 400; i++) {
        const double tau = exp(log(1e-3) + check_uniform() * log(1e6)), from = 40 * check_uniform() - 20;
        const int up = i & 1;
        int64_t now = SECOND;
        pupil_t pupil;
        start(&pupil, up ? tau : 1e6, up ? 1e6 : tau); /* the wrong one would show at once */
        const double to = from + (up ? 8 : -8), begun = adapt(&pupil, from, now).adapted_ev;
        pupil_stats stats;
        const double target = ref_stats_at(to, 0, &stats);
        for (int n = 0; n < 60; n++) {
            const int64_t dt = (int64_t)(tau * 0.2 * check_uniform() * 1e9) + 1;
            now += dt;
            const pupil_exposure e = adapt(&pupil, to, now);
            const long double t = (now - SECOND) / 1e9L;
            const double off = fabs((double)(e.adapted_ev - (target + (begun - target) * expl(-t / tau))));
            worst = fmax(worst, off);
            CHECK_MSG(off <= 1e-10, "tau %g, t %Lg: off by %g", tau, t, off);
            CHECK(e.dt_s == dt / 1e9 || fabs(e.dt_s - dt / 1e9) <= 1e-15 * e.dt_s);
        }
    }
    printf("default law: at most %.2g stops from its closed form (<= 1e-10)\n", worst);
}

/* The same light at any frame rate, and with dropped frames, gives the same level at the same moment. */
static void check_rates(void)
{
    static const int fps[] = {24, 30, 50, 60, 120, 240, 1};
    double level[10] = {0}, reached[3][7], worst = 0;
    for (unsigned r = 0; r < 7; r++) {
        pupil_t pupil;
        static const double within[3] = {1, 0.05, 0.001};
        start(&pupil, 1.3, 2.9);
        adapt(&pupil, -3, SECOND);
        reached[0][r] = reached[1][r] = reached[2][r] = INFINITY;
        for (int n = 1; n <= 10 * fps[r] * 2; n++) {
            const double ev = n <= 10 * fps[r] ? 5 : -3;
            const double t = (double)n / fps[r];
            const double now = adapt(&pupil, ev, SECOND + n * SECOND / fps[r]).adapted_ev;
            for (int k = 0; k < 3; k++)
                if (t <= 10 && fabs(now - 5) <= within[k] && !isfinite(reached[k][r]))
                    reached[k][r] = t;
            if (n % (2 * fps[r]) == 0 && t <= 20) {
                const int at = n / (2 * fps[r]) - 1;
                if (!r)
                    level[at] = now;
                worst = fmax(worst, fabs(level[at] - now));
            }
        }
        for (int k = 0; k < 3; k++) /* n dt are equal within one dt of either */
            CHECK_MSG(fabs(reached[k][r] - reached[k][0]) <= 1.0 / fps[r] + 1.0 / 24 || !isfinite(reached[k][0]),
                      "%d fps: within %g after %g s, at 24 fps after %g s", fps[r], within[k], reached[k][r],
                      reached[k][0]);
    }
    printf("24, 30, 50, 60, 120, 240 and 1 fps: the level at whole seconds within %.2g stops (<= 1e-9)\n", worst);
    CHECK(worst <= 1e-9);
    pupil_t all, some;
    start(&all, 0.3, 0.9);
    start(&some, 0.3, 0.9);
    adapt(&all, 0, SECOND);
    adapt(&some, 0, SECOND);
    for (int n = 1; n <= 600; n++) {
        const int64_t at = SECOND + n * (SECOND / 60);
        const double a = adapt(&all, n < 300 ? 6 : -6, at).adapted_ev;
        if (check_random() % 4 == 0 || n == 299)
            CHECK_MSG(fabs(adapt(&some, n < 300 ? 6 : -6, at).adapted_ev - a) <= 1e-9, "dropped frames, frame %d", n);
    }
}

/* dL/dt = (target - L) / tau by Heun's method in long double, 1 / 4096 of tau a step or less. */
static long double integrate(long double level, long double target, long double tau, long double seconds)
{
    const int steps = 1 + (int)(4096 * seconds / tau);
    const long double h = seconds / steps / tau;
    for (int i = 0; i < steps; i++) {
        const long double k1 = target - level, k2 = target - (level + h * k1);
        level += h * (k1 + k2) / 2;
    }
    return level;
}

/* A step up and one down, each with its own time constant, at any frame rate and with a fifth of the frames lost: the
 * level is the ODE's at every frame, and covers each part of the distance at the ODE's time, within 1 %. */
static void check_ode(void)
{
    static const int fps[] = {1, 10, 30, 120, 240};
    static const double taus[2][2] = {{0.4, 1.2}, {2.5, 0.7}}; /* light, dark */
    double worst_ev = 0, worst_share = 0;
    for (int turn = 0; turn < 5 * 2 * 2; turn++) {
        const int rate = fps[turn % 5], drops = turn / 5 % 2;
        const double *tau = taus[turn / 10];
        long double level = 0;
        int64_t last = SECOND;
        pupil_t pupil;
        start(&pupil, tau[0], tau[1]);
        level = adapt(&pupil, -3, SECOND).adapted_ev;
        int compared[2] = {0, 0};
        for (int n = 1; n <= 24 * rate; n++) {
            const int dark = n > 12 * rate;
            const int64_t now = SECOND + n * SECOND / rate;
            if (drops && check_uniform() < 0.2)
                continue;
            pupil_stats stats;
            const double target = ref_stats_at(dark ? -2 : 5, 0, &stats), before = (double)level;
            const double got = adapt(&pupil, dark ? -2 : 5, now).adapted_ev;
            level = integrate(level, target, tau[dark], (now - last) / 1e9L);
            worst_ev = fmax(worst_ev, fabs(got - (double)level));
            CHECK_MSG(fabs(got - (double)level) <= 1e-4, "%d fps, drops %d, frame %d: %g, the ODE has %g", rate, drops,
                      n, got, (double)level);
            /* the rest of this frame's distance, as a time */
            const double took = tau[dark] * log((before - target) / (got - target)), dt = (double)(now - last) * 1e-9;
            if (fabs(before - target) > 0.02 && fabs(got - target) > 0.02) {
                worst_share = fmax(worst_share, fabs(took / dt - 1));
                CHECK_MSG(fabs(took / dt - 1) <= 0.01, "%d fps, drops %d, frame %d: %g s for %g s", rate, drops, n,
                          took, dt);
                compared[dark]++;
            }
            last = now;
        }
        CHECK(compared[0] > 0 && compared[1] > 0);
    }
    printf("1 to 240 fps, a fifth of the frames lost or none: within %.2g stops of the ODE, and %.2g of the time\n",
           worst_ev, worst_share);
}

static void check_directions(void)
{
    pupil_t pupil;
    start(&pupil, 0.1, 10);
    adapt(&pupil, 0, SECOND);
    const double lit = adapt(&pupil, 8, SECOND + SECOND / 10).adapted_ev;
    CHECK_MSG(fabs(lit - 8 * (1 - exp(-1))) < 1e-9, "more light: tau_light_s, %.12g", lit);
    const double dark = adapt(&pupil, 0, SECOND + SECOND / 5).adapted_ev;
    CHECK_MSG(fabs(dark - lit * exp(-0.01)) < 1e-9, "less light: tau_dark_s, %.12g", dark);
    start(&pupil, 0, 0);
    adapt(&pupil, 0, SECOND);
    CHECK(adapt(&pupil, 7.25, SECOND + 1).adapted_ev == 7.25 && adapt(&pupil, -7.25, SECOND + 2).adapted_ev == -7.25);
}

static void check_clocks(void)
{
    pupil_t pupil;
    pupil_exposure e;
    start(&pupil, 0.5, 0.5);
    adapt(&pupil, 0, 10 * SECOND);
    e = adapt(&pupil, 4, 10 * SECOND); /* the same moment */
    CHECK(e.adapted_ev == 0 && e.dt_s == 0 && e.metered_ev == 4 && e.reason == PUPIL_REASON_CLOCK_UNIT);
    e = adapt(&pupil, 4, 9 * SECOND); /* back in time */
    CHECK(e.adapted_ev == 0 && e.dt_s == 0 && e.reason == PUPIL_REASON_CLOCK_BACK);
    e = adapt(&pupil, 4, 9 * SECOND + SECOND / 2); /* and continues from there */
    CHECK_MSG(fabs(e.adapted_ev - 4 * (1 - exp(-1))) < 1e-9 && e.reason == PUPIL_REASON_NONE,
              "after the clock went back: %g, dt %g", e.adapted_ev, e.dt_s);
    e = adapt(&pupil, 4, 9 * SECOND + SECOND / 2 + INT64_C(1000000) * SECOND); /* twelve days later */
    CHECK(e.adapted_ev == 4 && fabs(e.dt_s - 1e6) < 1e-6);
    e = adapt(&pupil, -1, INT64_MAX);
    CHECK(e.adapted_ev == -1 && e.dt_s > 9e9);
    e = adapt(&pupil, 5, INT64_MIN); /* the difference does not fit 64 bits */
    CHECK(e.adapted_ev == -1 && e.dt_s == 0 && e.reason == PUPIL_REASON_CLOCK_BACK);
    e = adapt(&pupil, 5, INT64_MAX);
    CHECK_MSG(e.adapted_ev == 5 && e.dt_s > 1.8e10, "the longest step: %g s", e.dt_s);
}

/* 30 frames a second with timestamps in another unit than ns. */
static void check_units(void)
{
    static const struct {
        int64_t per_second;
        uint32_t reason;
    } units[] = {{1, PUPIL_REASON_CLOCK_UNIT},
                 {1000, PUPIL_REASON_CLOCK_UNIT},
                 {1000000, PUPIL_REASON_CLOCK_UNIT},
                 {SECOND, PUPIL_REASON_NONE}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        pupil_t pupil;
        start(&pupil, 0.5, 0.5);
        for (int64_t n = 0; n < 60; n++) {
            const pupil_exposure e = adapt(&pupil, n ? 4 : 0, (1000 * 30 + n) * units[i].per_second / 30);
            CHECK_MSG(e.reason == (n ? units[i].reason : PUPIL_REASON_NONE), "%lld a second, frame %lld: reason %u",
                      (long long)units[i].per_second, (long long)n, e.reason);
        }
    }
    pupil_t pupil;
    start(&pupil, 0.5, 0.5);
    CHECK(adapt(&pupil, 0, 0).reason == PUPIL_REASON_NONE && adapt(&pupil, 0, 0).reason == PUPIL_REASON_NONE);
    CHECK(adapt(&pupil, 0, 100000).reason == PUPIL_REASON_NONE); /* 0.1 ms */
    CHECK(adapt(&pupil, 0, 199999).reason == PUPIL_REASON_CLOCK_UNIT);
}

static void check_unstamped(void)
{
    pupil_t pupil;
    pupil_config config;
    pupil_stats stats;
    pupil_exposure e = {0};
    pupil_config_default(&config);
    config.nominal_frame_s = 0.25;
    config.tau_light_s = 0.5;
    config.white_mode = PUPIL_WHITE_NONE;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    adapt(&pupil, 0, 0);
    for (int n = 1; n <= 8; n++) {
        ref_stats_at(4, 0, &stats);
        CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_OK && pupil_get_exposure(&pupil, &e) == PUPIL_OK);
        CHECK_MSG(e.dt_s == 0.25 && fabs(e.adapted_ev - 4 * (1 - exp(-n * 0.5))) < 1e-9, "unstamped frame %d: %g", n,
                  e.adapted_ev);
    }
    /* a clock that begins at 0: the second frame's stamp counts */
    CHECK(pupil_reset(&pupil) == PUPIL_OK);
    adapt(&pupil, 0, 0);
    e = adapt(&pupil, 4, SECOND / 8);
    CHECK_MSG(e.dt_s == 0.125 && fabs(e.adapted_ev - 4 * (1 - exp(-0.25))) < 1e-9, "from 0 to 1/8 s: dt %g", e.dt_s);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_closed_form();
    check_rates();
    check_ode();
    check_directions();
    check_clocks();
    check_units();
    check_unstamped();
    return check_end();
}
