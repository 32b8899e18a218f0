/* The eye's law: its four filters against their closed forms at any frame rate and with lost frames; dark adaptation
 * against the differential equations in small steps; that it ends, and its behaviour at the ends of its range. The
 * reference has the formulas of docs/numerics.md in long double and shares nothing with the library.
 */
#include "check.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

#define UNIT_CD_M2 100.0L

static void start(pupil_t *pupil)
{
    pupil_config config;
    pupil_config_default(&config);
    config.law = PUPIL_LAW_EYE;
    config.flicker = 0;
    CHECK(pupil_init(pupil, &config) == PUPIL_OK);
}

static pupil_exposure adapt(pupil_t *pupil, const pupil_stats *stats, int64_t timestamp_ns)
{
    pupil_exposure exposure = {0};
    const pupil_frame_info info = {.timestamp_ns = timestamp_ns};
    CHECK(pupil_adapt(pupil, stats, &info) == PUPIL_OK);
    CHECK(pupil_get_exposure(pupil, &exposure) == PUPIL_OK);
    return exposure;
}

/* Statistics of a light in cd/m2; returns the nearest light that statistics can represent. */
static long double light_at(double cd_m2, pupil_stats *stats)
{
    return exp2l((long double)ref_stats_at(log2(cd_m2 / (double)UNIT_CD_M2), 1, stats)) * UNIT_CD_M2;
}

/* --- the filters --- */

enum { CONE, ROD, CONE_PIGMENT, ROD_PIGMENT, FILTERS };

static const long double neural_s[2] = {0.08L, 0.15L}, restored_s[2] = {110.0L, 400.0L}, half_cd_m2[2] = {2e6L, 0.04L};

static long double at_rest(int filter, long double light)
{
    return filter < 2 ? light : half_cd_m2[filter - 2] / (half_cd_m2[filter - 2] + light);
}

static long double tau_of(int filter, long double light)
{
    return filter < 2 ? neural_s[filter]
                      : restored_s[filter - 2] * half_cd_m2[filter - 2] / (half_cd_m2[filter - 2] + light);
}

static void filters_of(const pupil_exposure *e, double value[FILTERS])
{
    value[CONE] = e->cone_cd_m2;
    value[ROD] = e->rod_cd_m2;
    value[CONE_PIGMENT] = e->cone_pigment;
    value[ROD_PIGMENT] = e->rod_pigment;
}

/* From light to light: the remaining distance at the end of each is the closed form's start for the next. */
static void filters_at(int fps, int lost_percent)
{
    static const double lights[] = {30.0, 2000.0, 0.02, 5.0, 1e-4, 3e5};
    static const double lasting_s[] = {2.0, 20.0, 120.0, 3.0, 300.0, 2.0};
    double worst[FILTERS] = {0.0}, value[FILTERS];
    long double from[FILTERS];
    pupil_stats stats;
    pupil_t pupil;
    int64_t frame = 0;
    unsigned lost = 0;
    start(&pupil);
    long double light = light_at(lights[0], &stats);
    (void)adapt(&pupil, &stats, INT64_C(1000000000));
    for (int f = 0; f < FILTERS; f++)
        from[f] = at_rest(f, light);
    int64_t began_ns = INT64_C(1000000000);
    for (unsigned i = 1; i < sizeof lights / sizeof lights[0]; i++) {
        int64_t now_ns = began_ns;
        light = light_at(lights[i], &stats);
        for (int64_t left = (int64_t)(lasting_s[i] * fps); left > 0; left--) {
            frame++;
            if (left > 1 && (int)(check_random() % 100) < lost_percent) {
                lost++;
                continue;
            }
            now_ns = INT64_C(1000000000) + frame * 1000000000 / fps;
            const pupil_exposure e = adapt(&pupil, &stats, now_ns);
            filters_of(&e, value);
            for (int f = 0; f < FILTERS; f++) {
                const long double end = at_rest(f, light), t = (long double)(now_ns - began_ns) * 1e-9L;
                const long double exact = end + (from[f] - end) * expl(-t / tau_of(f, light));
                worst[f] = fmax(worst[f], (double)fabsl((long double)value[f] / exact - 1));
            }
        }
        for (int f = 0; f < FILTERS; f++) {
            const long double end = at_rest(f, light), t = (long double)(now_ns - began_ns) * 1e-9L;
            from[f] = end + (from[f] - end) * expl(-t / tau_of(f, light));
        }
        began_ns = now_ns;
    }
    printf("%3d fps, %u of %lld frames lost: cones, rods %.1e, %.1e of their closed forms, their pigments %.1e, %.1e\n",
           fps, lost, (long long)frame, worst[CONE], worst[ROD], worst[CONE_PIGMENT], worst[ROD_PIGMENT]);
    for (int f = 0; f < FILTERS; f++)
        CHECK_MSG(worst[f] <= 1e-10, "%d fps, filter %d: %g", fps, f, worst[f]);
}

/* --- dark adaptation --- */

static long double cone_half(long double light)
{
    const long double k4 = powl(1 / (5 * light + 1), 4);
    return 12.9223L * light / (k4 * light + 0.171L * (1 - k4) * (1 - k4) * cbrtl(light));
}

static long double rod_half(long double light)
{
    const long double j2 = powl(1 / (5e5L * light + 1), 2);
    return 2.5874L * light / (19000 * j2 * light + 0.2615L * powl(1 - j2, 4) * powl(light, 1 / 6.0L));
}

/* log2 of the half-saturation light of a single response with the same slope in faint light as both together. */
static long double faintest(const long double s[FILTERS])
{
    return log2l(s[CONE_PIGMENT] * powl(cone_half(s[CONE]), -0.73L) + s[ROD_PIGMENT] * powl(rod_half(s[ROD]), -0.73L)) /
           -0.73L;
}

static long double faintest_at_rest(long double light_log2)
{
    long double s[FILTERS];
    for (int f = 0; f < FILTERS; f++)
        s[f] = at_rest(f, exp2l(light_log2));
    return faintest(s);
}

static long double level_of(const long double s[FILTERS])
{
    long double low = log2l(1e-6L), high = log2l(1e8L), sought = faintest(s);
    for (int i = 0; i < 80; i++) {
        const long double middle = (low + high) / 2;
        if (faintest_at_rest(middle) < sought)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void only_rises(void)
{
    long double last = faintest_at_rest(log2l(1e-6L)), least = 1;
    for (int i = 1; i <= 46500; i++) {
        const long double now = faintest_at_rest(log2l(1e-6L) + i * 0.001L);
        least = fminl(least, (now - last) / 0.001L);
        last = now;
    }
    printf("sensitivity at rest falls with light by at least %.2Lf stops a stop\n", least);
    CHECK(least > 0.05L);
}

static void change_of(const long double s[FILTERS], long double light, long double change[FILTERS])
{
    for (int f = 0; f < 2; f++) {
        change[f] = (light - s[f]) / neural_s[f];
        change[f + 2] = (1 - s[f + 2]) / restored_s[f] - s[f + 2] * light / (restored_s[f] * half_cd_m2[f]);
    }
}

/* One step of the fourth-order Runge-Kutta method. */
static void step_of(long double s[FILTERS], long double light, long double dt)
{
    long double k[4][FILTERS], at[FILTERS];
    change_of(s, light, k[0]);
    for (int i = 1; i < 4; i++) {
        for (int f = 0; f < FILTERS; f++)
            at[f] = s[f] + k[i - 1][f] * dt * (i < 3 ? 0.5L : 1);
        change_of(at, light, k[i]);
    }
    for (int f = 0; f < FILTERS; f++)
        s[f] += (k[0][f] + 2 * k[1][f] + 2 * k[2][f] + k[3][f]) * dt / 6;
}

/* Half an hour in the dark after a bright room, at 30 frames a second; the equations in steps of 1 / 480 s. */
static void dark_adaptation(void)
{
    enum { FPS = 30, SUB = 16, SECONDS = 1800 };
    static const int told_s[] = {1, 10, 60, 180, 420, 900, 1800};
    long double s[FILTERS], worst = 0;
    pupil_stats bright, dark;
    pupil_t pupil;
    unsigned told = 0;
    start(&pupil);
    const long double before = light_at(5000.0, &bright), after = light_at(1e-3, &dark);
    for (int f = 0; f < FILTERS; f++)
        s[f] = at_rest(f, before);
    (void)adapt(&pupil, &bright, INT64_C(1000000000));
    printf("in the dark of 0.001 cd/m2 after 5000, stops above it:");
    for (int64_t frame = 1; frame <= FPS * SECONDS; frame++) {
        const int64_t now_ns = INT64_C(1000000000) + frame * 1000000000 / FPS;
        const pupil_exposure e = adapt(&pupil, &dark, now_ns);
        for (int i = 0; i < SUB; i++)
            step_of(s, after, 1.0L / (FPS * SUB));
        if (frame % FPS && frame > 2 * FPS)
            continue;
        const long double level = level_of(s) - log2l(UNIT_CD_M2);
        worst = fmaxl(worst, fabsl(exp2l((long double)e.adapted_ev - level) - 1));
        if (told < sizeof told_s / sizeof told_s[0] && frame == (int64_t)told_s[told] * FPS) {
            printf(" %d s %.2f,", told_s[told], e.adapted_ev - e.metered_ev);
            told++;
        }
    }
    printf("\n    the adapted light is within %.1e of the equations in small steps\n", (double)worst);
    CHECK_MSG(worst <= 0.01L, "%Lg", worst);
}

/* --- ends --- */

static void it_ends(void)
{
    static const double lights[] = {1e-4, 1e4, 0.3, 100.0};
    pupil_stats stats;
    pupil_t pupil;
    start(&pupil);
    for (int i = 0; i < 4; i++) {
        pupil_exposure e = {0};
        (void)light_at(lights[i], &stats);
        for (int64_t n = 0; n < 40; n++) /* a frame an hour */
            e = adapt(&pupil, &stats, (1 + n + i * 100) * INT64_C(3600000000000));
        CHECK_MSG(e.adapted_ev == e.metered_ev && e.state == PUPIL_STATE_SETTLED, "%g cd/m2: off by %g", lights[i],
                  e.adapted_ev - e.metered_ev);
    }
    /* also in tiny steps: as many as there are units in the last place left */
    double last = 1e9;
    (void)light_at(90.0, &stats);
    for (int64_t n = 0; n < 3000; n++) {
        const pupil_exposure e = adapt(&pupil, &stats, INT64_C(2000000000000000) + n * 1000000);
        const double left = fabs(e.cone_cd_m2 - exp2(e.metered_ev) * 100.0);
        CHECK(left <= last);
        last = left;
    }
    CHECK_MSG(last < 1e-12, "%g", last);
}

/* No time, time that goes back, no light, frames beyond what an eye can distinguish. */
static void odd_frames(void)
{
    pupil_config config;
    pupil_stats stats[2], none;
    pupil_t pupil;
    start(&pupil);
    (void)light_at(100.0, &stats[0]);
    (void)light_at(0.1, &stats[1]);
    pupil_stats_clear(&none);
    const pupil_exposure first = adapt(&pupil, &stats[0], 1000);
    pupil_exposure e = adapt(&pupil, &stats[1], 1000);
    CHECK(e.adapted_ev == first.adapted_ev && e.state == PUPIL_STATE_ADAPTING);
    e = adapt(&pupil, &stats[1], -1000000000);
    CHECK(e.adapted_ev == first.adapted_ev && e.reason == PUPIL_REASON_CLOCK_BACK);
    e = adapt(&pupil, &none, INT64_C(1000000000));
    CHECK(e.adapted_ev == first.adapted_ev && e.reason == PUPIL_REASON_NO_LIGHT);
    e = adapt(&pupil, &stats[1], INT64_C(9000000000000000000));
    CHECK(e.adapted_ev == e.metered_ev);
    static const double units[] = {1e-6, 100.0, 1e9};
    for (int u = 0; u < 3; u++)
        for (int n = 0; n < 40; n++) {
            pupil_config_default(&config);
            config.law = PUPIL_LAW_EYE;
            config.eye_unit_cd_m2 = units[u];
            if (!n)
                CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
            (void)ref_stats_at(n % 2 ? 29.5 : -13.5, 1, &stats[0]);
            e = adapt(&pupil, &stats[0], (n + 1) * INT64_C(40000000));
            CHECK(isfinite(e.adapted_ev) && isfinite(e.scale) && e.rods >= 0.0 && e.rods <= 1.0);
            CHECK(e.cone_cd_m2 >= 1e-6 && e.cone_cd_m2 <= 1e8 && e.rod_pigment > 0.0 && e.rod_pigment <= 1.0);
        }
}

/* ev_min and ev_max also bound the level while it moves. */
static void limits(void)
{
    pupil_config config;
    pupil_stats stats[2];
    pupil_t pupil;
    pupil_config_default(&config);
    config.law = PUPIL_LAW_EYE;
    config.ev_min = -4.0;
    config.ev_max = 6.0;
    (void)ref_stats_at(-20.0, 1, &stats[0]);
    (void)ref_stats_at(20.0, 1, &stats[1]);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int64_t n = 1; n < 400; n++) {
        const pupil_exposure e = adapt(&pupil, &stats[n / 100 % 2], n * (n % 100 < 50 ? 40000000 : 4000000000000));
        CHECK(e.adapted_ev >= -4.0 && e.adapted_ev <= 6.0);
        if (n % 100 == 99)
            CHECK_MSG(e.adapted_ev == (n / 100 % 2 ? 6.0 : -4.0) && e.state == PUPIL_STATE_LIMITED, "%g, state %u",
                      e.adapted_ev, e.state);
    }
}

/* A change of law keeps the level, and an eye begins at rest. */
static void changes_of_law(void)
{
    pupil_config config;
    pupil_exposure e, kept;
    pupil_stats stats;
    pupil_t pupil;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    (void)light_at(3.0, &stats);
    e = adapt(&pupil, &stats, 1000000);
    CHECK(e.cone_cd_m2 == 0.0 && e.rods == 0.0 && e.rod_pigment == 0.0);
    config.law = PUPIL_LAW_EYE;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK && pupil_get_exposure(&pupil, &kept) == PUPIL_OK);
    CHECK(kept.adapted_ev == e.adapted_ev && fabs(kept.cone_cd_m2 / 3.0 - 1.0) < 1e-6 && kept.rods > 0.01);
    e = adapt(&pupil, &stats, 41000000);
    CHECK_MSG(fabs(e.adapted_ev - kept.adapted_ev) < 1e-9, "%g", e.adapted_ev - kept.adapted_ev);
    for (uint32_t law = 0; law < PUPIL_LAW_EYE; law++) {
        config.law = law;
        CHECK(pupil_retune(&pupil, &config) == PUPIL_OK && pupil_get_exposure(&pupil, &kept) == PUPIL_OK);
        CHECK(kept.rods == 0.0 && kept.cone_cd_m2 == 0.0);
        kept = adapt(&pupil, &stats, 81000000);
        CHECK_MSG(fabs(kept.adapted_ev - e.adapted_ev) < 1e-9, "law %u: %g", law, kept.adapted_ev - e.adapted_ev);
        config.law = PUPIL_LAW_EYE;
        CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    }
}

/* The eye at rest at either end of its range, and a frame without a time step: the level is that end, for any light. */
static void ends_of_the_range(void)
{
    for (int end = 0; end < 2; end++) {
        pupil_config config;
        pupil_stats stats;
        pupil_t pupil;
        pupil_config_default(&config);
        config.law = PUPIL_LAW_EYE;
        config.flicker = 0;
        config.amplification_ev = 32.0;
        config.eye_unit_cd_m2 = end ? 1e4 : 1.0;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        const double light_ev = log2((end ? 1e8 : 1e-6) / config.eye_unit_cd_m2);
        (void)ref_stats_at(light_ev + (end ? 2.0 : -2.0), 1, &stats);
        (void)adapt(&pupil, &stats, 1000);
        (void)ref_stats_at(light_ev + (end ? -9.0 : 9.0), 1, &stats);
        const pupil_exposure e = adapt(&pupil, &stats, 1000);
        CHECK_MSG(fabs(e.adapted_ev - light_ev) < 1e-9, "end %d: %.12g, not %.12g", end, e.adapted_ev, light_ev);
    }
}

/* In the dark the cones' pigment recovers long before the rods'; until both have, the eye is not at rest. */
static void rods_are_last(void)
{
    int rods_alone = 0;
    pupil_stats stats;
    pupil_t pupil;
    start(&pupil);
    (void)light_at(100.0, &stats);
    (void)adapt(&pupil, &stats, 1000000000);
    const long double dark = light_at(1e-4, &stats);
    double last = 1e9;
    for (int64_t n = 1; n <= 40; n++) {
        const pupil_exposure e = adapt(&pupil, &stats, 1000000000 + n * INT64_C(500000000000));
        const double cones_off = fabs(e.cone_pigment - (double)at_rest(CONE_PIGMENT, dark));
        const double rods_off = fabs(e.rod_pigment - (double)at_rest(ROD_PIGMENT, dark));
        if (cones_off < 1e-15 && rods_off > 1e-13) {
            rods_alone++;
            CHECK_MSG(e.adapted_ev > e.metered_ev && e.adapted_ev - e.metered_ev < last, "%d: %g", (int)n,
                      e.adapted_ev - e.metered_ev);
        }
        last = e.adapted_ev - e.metered_ev;
    }
    CHECK_MSG(rods_alone > 3, "%d", rods_alone);
    CHECK(last == 0.0);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    filters_at(1, 20);
    filters_at(30, 20);
    filters_at(240, 20);
    only_rises();
    dark_adaptation();
    it_ends();
    odd_frames();
    limits();
    changes_of_law();
    ends_of_the_range();
    rods_are_last();
    return check_end();
}
