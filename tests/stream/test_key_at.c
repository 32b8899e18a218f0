/* A key that depends on the light: night that looks like night. */
#include "check.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

static const pupil_key_point street[] = {{-4, 0.06}, {-1, 0.09}, {3, 0.18}};

static void start(pupil_t *pupil, uint32_t points, double ev_compensation)
{
    pupil_config config;
    pupil_config_default(&config);
    config.highlight_ev = 0;
    config.ev_compensation = ev_compensation;
    config.key_points = points;
    for (uint32_t i = 0; i < points; i++)
        config.key_at[i] = street[i];
    CHECK(pupil_init(pupil, &config) == PUPIL_OK);
}

static pupil_exposure first(uint32_t points, double ev, double ev_compensation, const pupil_frame_info *info)
{
    pupil_t pupil;
    pupil_stats stats;
    pupil_exposure e = {0};
    start(&pupil, points, ev_compensation);
    ref_stats_at(ev, 1, &stats);
    CHECK(pupil_adapt(&pupil, &stats, info) == PUPIL_OK);
    CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK);
    return e;
}

/* The value that the log-average is mapped to. */
static double key_of(const pupil_exposure *e)
{
    return e->scale * exp2(e->adapted_ev);
}

static double expected(double ev)
{
    if (ev <= -4)
        return 0.06;
    if (ev >= 3)
        return 0.18;
    return ev < -1 ? 0.06 * pow(1.5, (ev + 4) / 3) : 0.09 * pow(2, (ev + 1) / 4);
}

static void check_points(void)
{
    double worst = 0;
    for (double ev = -12; ev <= 12; ev += 0.125) {
        const pupil_exposure e = first(3, ev, 0, NULL), brighter = first(3, ev, 1.5, NULL);
        worst = fmax(worst, fabs(log2(key_of(&e) / expected(e.adapted_ev))));
        CHECK(fabs(log2(key_of(&brighter) / key_of(&e)) - 1.5) < 1e-12);
        const pupil_exposure one = first(1, ev, 0, NULL);
        CHECK(fabs(key_of(&one) - 0.06) < 1e-12); /* one point: the same in any light */
    }
    CHECK_MSG(worst < 1e-12, "off by %g stops", worst);
}

/* The light is the scene's, not the frame's: depending on exposure and gain the same frame is night or day. */
static void check_scene(void)
{
    const pupil_frame_info night = {.exposure_s = 0.25, .gain = 64}, day = {.exposure_s = 0.001, .gain = 1};
    const pupil_exposure dark = first(3, 0, 0, &night), bright = first(3, 0, 0, &day);
    CHECK_MSG(fabs(key_of(&dark) - 0.06) < 1e-12 && fabs(key_of(&bright) - 0.18) < 1e-12, "%g and %g", key_of(&dark),
              key_of(&bright));
}

/* As the light falls the picture's grey falls with it, without jumps. */
static void check_dusk(void)
{
    pupil_t pupil;
    pupil_exposure e = {0};
    start(&pupil, 3, 0);
    double before = 0;
    for (int n = 0; n < 600; n++) {
        const pupil_frame_info info = {.timestamp_ns = (n + 1) * INT64_C(33333333)};
        pupil_stats stats;
        ref_stats_at(6.0 - n * 0.02, 1, &stats);
        CHECK(pupil_adapt(&pupil, &stats, &info) == PUPIL_OK && pupil_get_exposure(&pupil, &e) == PUPIL_OK);
        const double key_log2 = log2(key_of(&e));
        CHECK_MSG(!n || (key_log2 <= before + 1e-12 && before - key_log2 <= 0.5 * 0.02 + 1e-9), "frame %d: %g after %g",
                  n, key_log2, before);
        before = key_log2;
    }
    CHECK(fabs(before - log2(0.06)) < 1e-9);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_points();
    check_scene();
    check_dusk();
    return check_end();
}
