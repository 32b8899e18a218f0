/* How much of the lamps' bands row correction gains leave, and what they add in other light, measured in the light
 * itself. The table is that of docs/mains.md.
 */
#include "lamp_rig.h"

enum { SECONDS = 4 };

/* The most that gains add from the first ones on, and what is left at the end. */
typedef struct outcome {
    double before, after;     /* the last quarter of the time; light outside the rectangle */
    double day_after;         /* inside */
    double worse;             /* the most that gains added to any part of any frame */
    double step;              /* the largest difference of adjacent rows' gains, log2 */
    pupil_row_gain_result at; /* the end */
} outcome;

/* The wave moves so slowly that it takes seconds to be known. */
static int is_slow(const rig *r)
{
    return fabs(remainder(r->light_hz, r->fps)) < 1;
}

static outcome run(const rig *r)
{
    static rig_camera c;
    outcome o = {0};
    rig_open(&c, r);
    const int frames = (int)((is_slow(r) ? 2 * SECONDS : SECONDS) * r->fps);
    for (int i = 0; i < frames; i++) {
        const rig_seen seen = rig_next(&c);
        o.worse = fmax(o.worse, fmax(seen.after - seen.before, seen.day_after - seen.day_before));
        for (int y = 1; y < RIG_H; y++)
            o.step = fmax(o.step, fabs(log2((double)c.gain[y] / (double)c.gain[y - 1])));
        if (i < frames * 3 / 4)
            continue;
        o.before = fmax(o.before, seen.before);
        o.after = fmax(o.after, seen.after);
        o.day_after = fmax(o.day_after, seen.day_after);
    }
    CHECK(pupil_row_gain_get(&c.lamps, &o.at) == PUPIL_OK);
    CHECK_MSG(o.worse <= 0.01, "gains added a band of %.3f EV", o.worse);
    return o;
}

static outcome show(const char *name, const rig *r)
{
    const outcome o = run(r);
    printf("%-44s bands %.3f EV, with gains %.3f", name, o.before, o.after);
    if (r->day_inside > 0)
        printf(", in other light %.3f", o.day_after);
    printf("; strength %.2f, reason %u\n", o.at.strength, o.at.reason);
    return o;
}

/* Lamps alone: what is left is at most `limit`. */
static void lamps(const char *name, const rig *r, double limit)
{
    const outcome o = show(name, r);
    CHECK_MSG(o.after <= limit, "%s: %.3f EV are left", name, o.after);
    CHECK(o.at.strength > 0.9);
}

/* No gains, for this reason. */
static void nothing(const char *name, const rig *r, uint32_t reason)
{
    const outcome o = show(name, r);
    CHECK_MSG(o.at.strength == 0 && o.at.reason == reason, "%s: strength %g, reason %u", name, o.at.strength,
              o.at.reason);
    CHECK(o.after == o.before);
}

static void check_lamps(void)
{
    char name[80];
    for (int i = 0; i < 5; i++) {
        static const double exposure_s[] = {3e-4, 1e-3, 2e-3, 4e-3, 8e-3};
        rig r = rig_default();
        r.exposure_s = exposure_s[i];
        snprintf(name, sizeof name, "100 Hz, exposure %g ms", 1e3 * r.exposure_s);
        lamps(name, &r, 0.05);
    }
    for (int i = 0; i < 12; i++) { /* 120 Hz at 48: every row sees two phases; 29.97: the wave rolls in 8 s */
        static const double fps[] = {12, 15, 24, 29.97, 48, 60, 90, 120, 25, 29.97, 48, 90};
        rig r = rig_default();
        r.fps = fps[i];
        if (i >= 8)
            r.mains_hz = 60, r.light_hz = 120;
        snprintf(name, sizeof name, "%g Hz, %g frames a second", r.light_hz, r.fps);
        lamps(name, &r, 0.05);
    }
    for (int i = 0; i < 3; i++) {
        static const double share[] = {0.3, 0.5, 1};
        rig r = rig_default();
        r.readout_share = share[i];
        snprintf(name, sizeof name, "100 Hz, readout %g %% of a frame", 100 * r.readout_share);
        lamps(name, &r, 0.05);
    }
    for (int i = 0; i < 3; i++) {
        static const double modulation[] = {0.05, 0.1, 0.5};
        rig r = rig_default();
        r.modulation = modulation[i];
        snprintf(name, sizeof name, "100 Hz, modulation %g", r.modulation);
        lamps(name, &r, 0.05);
    }
}

/* The third harmonic of 100 Hz is constant at 30 frames a second, and cannot be known: in lamps that are not sines it
 * stays. */
static void check_waves(void)
{
    char name[80];
    for (int wave = RIG_RECTIFIED; wave < RIG_WAVES; wave++)
        for (int i = 0; i < 3; i++) {
            static const double fps[] = {24, 30, 25}, limit[2][3] = {{0.05, 0.11, 0.05}, {0.05, 0.18, 0.05}};
            rig r = rig_default();
            r.wave = (rig_wave)wave;
            r.fps = fps[i];
            if (i == 2)
                r.mains_hz = 60, r.light_hz = 120;
            snprintf(name, sizeof name, "%s, %g Hz, %g frames a second", rig_wave_name[wave], r.light_hz, r.fps);
            lamps(name, &r, limit[wave - RIG_RECTIFIED][i]);
        }
}

static void check_cameras(void)
{
    char name[80];
    for (int i = 0; i < 3; i++) {
        static const double pan_px[] = {0.3, 1, 1.5};
        rig r = rig_default();
        r.pan_px = pan_px[i];
        snprintf(name, sizeof name, "100 Hz, pan of %.2f widths a second", r.pan_px * r.fps / RIG_W);
        lamps(name, &r, 0.05);
    }
    for (int i = 0; i < 2; i++) {
        rig r = rig_default();
        r.light_hz = i ? 100.4 : 99.6;
        snprintf(name, sizeof name, "mains of %g Hz", r.light_hz / 2);
        lamps(name, &r, 0.05);
        r = rig_default();
        r.readout_told = i ? 1.1 : 0.9;
        snprintf(name, sizeof name, "readout told as %g of what it is", r.readout_told);
        lamps(name, &r, 0.05);
        r = rig_default();
        r.jitter_s = i ? 3e-4 : 1e-4;
        snprintf(name, sizeof name, "timestamps off by %g ms RMS", 1e3 * r.jitter_s);
        lamps(name, &r, 0.05);
    }
    rig r = rig_default();
    r.exposure_unknown = 1;
    lamps("exposure not told", &r, 0.05);
    r.jitter_s = 1e-3; /* a third of a period: nothing can be found, but nothing is made worse */
    (void)show("timestamps off by 1 ms RMS", &r);
    r = rig_default();
    r.pan_px = 5;
    (void)show("100 Hz, pan of 1.17 widths a second", &r);
    r.pan_px = 1, r.modulation = 0.1; /* the scene moves as much as the wave */
    (void)show("modulation 0.1, pan of 0.23 widths a second", &r);
}

static void check_nothing(void)
{
    char name[80];
    for (int i = 0; i < 7; i++) {
        static const double fps[] = {10, 25, 50, 15, 24, 30, 60};
        rig r = rig_default();
        r.fps = fps[i];
        if (i >= 3)
            r.mains_hz = 60, r.light_hz = 120;
        snprintf(name, sizeof name, "%g Hz, %g frames a second: stands still", r.light_hz, r.fps);
        nothing(name, &r, PUPIL_ROW_GAIN_STATIONARY);
    }
    rig r = rig_default();
    r.exposure_s = 1e-2;
    nothing("100 Hz, exposure 10 ms", &r, PUPIL_ROW_GAIN_LONG);
    r = rig_default();
    r.modulation = 0;
    nothing("no lamps", &r, PUPIL_ROW_GAIN_NO_FLICKER);
    r.pan_px = 1;
    nothing("no lamps, pan", &r, PUPIL_ROW_GAIN_NO_FLICKER);
}

/* Daylight, or a monitor's steady light, on a part of the picture. */
static void daylit(double width, double height, double share)
{
    char name[80];
    rig r = rig_default();
    r.day_inside = share;
    r.x0 = width < 1 ? 0.05 + 0.3 * check_uniform() * (1 - width) : 0;
    r.y0 = height < 1 ? 0.05 + 0.3 * check_uniform() * (1 - height) : 0;
    r.x1 = r.x0 + width, r.y1 = r.y0 + height;
    snprintf(name, sizeof name, "%g %% daylight on %g x %g of the picture", 100 * share, width, height);
    nothing(name, &r, PUPIL_ROW_GAIN_MIXED);
}

static void check_mixed(void)
{
    static const double width[] = {0.02, 0.05, 0.1, 0.33, 0.5, 0.9};
    char name[80];
    for (int i = 0; i < 6; i++)
        daylit(width[i], 1, 1);
    for (int i = 0; i < 6; i += 2)
        daylit(1, width[i], 1);
    daylit(0.08, 0.08, 1);
    daylit(0.2, 0.2, 1);
    daylit(0.4, 1, 0.5);
    for (int i = 0; i < 3; i++) { /* everywhere: only a weaker wave */
        static const double day[] = {0.3, 0.6, 0.9};
        rig r = rig_default();
        r.day = day[i];
        snprintf(name, sizeof name, "%g %% daylight everywhere", 100 * r.day);
        lamps(name, &r, 0.05);
    }
}

static void check_steps(void)
{
    rig r = rig_default();
    r.modulation = 0.5;
    const outcome o = run(&r);
    /* The wave's steepest slope: 2 pi x amplitude x turns per row; rows of a frame of 1080 are finer by their
     * number. */
    printf("from one row's gain to the next at most %.4f EV, %.4f in a frame of 1080 rows\n", o.step,
           o.step * RIG_H / 1080);
    CHECK(o.step < 0.25);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    rig_make_wall();
    check_lamps();
    check_waves();
    check_cameras();
    check_nothing();
    check_mixed();
    check_steps();
    return check_end();
}
