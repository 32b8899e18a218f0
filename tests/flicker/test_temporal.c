/* Lamps at 50 and 60 Hz make all light rise and fall from frame to frame: both loops remove that from the level and
 * from each shown frame, and nothing else. Prints figures of docs/mains.md. */
#include <math.h>

#include "check.h"
#include "pupil/pupil.h"
#include "pupil/sensor.h"
#include "reference.h"

#define PI         3.14159265358979323846
#define LINE_S     18.9e-6
#define LIMIT_EV   0.005        /* RMS from frame to frame */
#define NOTHING_EV 0.0005       /* most that may be removed without a lamp */
#define SLOWEST    (1.0 / 16.0) /* turns per frame: slower flicker is left to the level */

enum { DELAY = 3, RING = 8, LONG = 100000 };

typedef struct room {
    double fps, lamp_hz, share; /* the share of light with the lamp's wave */
    double jitter_s, drops;     /* largest error of timestamps; share of lost frames */
    double level_ev;            /* log2 of the light of a frame of 1 s and gain 1 */
    uint64_t frame;
    double asked[RING][2];
    pupil_sensor sensor;
    pupil_sensor_setting setting;
} room;

static void open_room(room *r, double fps, double lamp_hz, double share)
{
    pupil_sensor_config c;
    *r = (room){.fps = fps, .lamp_hz = lamp_hz, .share = share, .level_ev = log2(0.18 / 0.004)};
    pupil_sensor_config_default(&c);
    c.frame_s = 1.0 / fps;
    c.exposure_min_s = c.exposure_step_s = LINE_S;
    c.exposure_max_s = fmin(1.0 / fps, 0.006); /* then gain: long exposures hide lamps */
    c.gain_law = PUPIL_GAIN_RECIPROCAL;
    c.gain_step = 256;
    CHECK(pupil_sensor_init(&r->sensor, &c) == PUPIL_OK);
    CHECK(pupil_sensor_start(&r->sensor, 0.004, 1.0) == PUPIL_OK);
    CHECK(pupil_sensor_get(&r->sensor, &r->setting) == PUPIL_OK);
    for (int i = 0; i < RING; i++)
        r->asked[i][0] = r->setting.exposure_s, r->asked[i][1] = r->setting.gain;
}

/* Takes the next frame; returns log2 of its shown level over the key. NAN: it was lost. */
static double next_frame(room *r)
{
    const double *in_force = r->asked[(r->frame + RING - DELAY) % RING];
    const double end_s = 1.0 + (double)r->frame / r->fps, middle_s = end_s - 0.5 * in_force[0];
    const double turns = r->lamp_hz * in_force[0], seen = turns > 0.0 ? sin(PI * turns) / (PI * turns) : 1.0;
    const double light = r->level_ev + log2(1.0 + r->share * seen * cos(2.0 * PI * r->lamp_hz * middle_s));
    const double late_s = r->jitter_s * (2.0 * check_uniform() - 1.0);
    const pupil_frame_info info = {.timestamp_ns = (int64_t)((middle_s + late_s) * 1e9),
                                   .sequence = r->frame,
                                   .exposure_s = in_force[0],
                                   .gain = in_force[1]};
    const int lost = r->drops > 0.0 && check_uniform() < r->drops;
    double shown = NAN;
    if (!lost) {
        CHECK(pupil_sensor_scene(&r->sensor, light, 0.0, &info) == PUPIL_OK);
        CHECK(pupil_sensor_get(&r->sensor, &r->setting) == PUPIL_OK);
        CHECK(isfinite(r->setting.flicker_ev) && fabs(r->setting.flicker_ev) < 1.5);
        shown = light + log2(in_force[0] * in_force[1] * r->setting.frame_digital / 0.18);
    }
    r->asked[r->frame % RING][0] = r->setting.exposure_s;
    r->asked[r->frame % RING][1] = r->setting.gain;
    r->frame++;
    return shown;
}

/* RMS from frame to frame of the shown level, over so many frames; *beat: the most that was removed. */
static double flicker(room *r, int frames, double *beat)
{
    double sum = 0.0, last = NAN, most = 0.0;
    int n = 0;
    for (int i = 0; i < frames; i++) {
        const double shown = next_frame(r);
        most = fmax(most, fabs(r->setting.flicker_ev));
        if (isnan(shown))
            continue;
        if (!isnan(last))
            sum += (shown - last) * (shown - last), n++;
        last = shown;
    }
    if (beat)
        *beat = most;
    return n ? sqrt(sum / n) : 0.0;
}

static double beyond(double x)
{
    return fabs(x - round(x));
}

static const double rates[] = {10.7, 12.5, 15, 24, 25, 27, 29.97, 30, 33, 48, 50, 60, 66, 72, 90, 120, 144, 200, 240};
enum { RATES = sizeof rates / sizeof rates[0] };

/* Flicker at almost half the frame rate looks the same forwards and backwards: the mains' deviation cannot be learned
 * from it, and the swell that the deviation causes is followed late. */
static int is_half(double lamp_hz, double fps)
{
    return beyond(lamp_hz / fps) > 0.5 - 1.0 / 64.0;
}

static void check_rates(double jitter_s, double drops, const char *what)
{
    static const double lamps[] = {100.0, 100.08, 120.0, 119.93}, shares[] = {0.01, 0.1, 0.3};
    double worst = 0.0, half = 0.0, before = 0.0;
    int left = 0;
    /* In steps of five or seven: this still includes all lamps. */
    for (int i = 0; i < RATES * 4 * 3; i += CHECK_SANITIZED ? 7 : check_every(5)) {
        const double fps = rates[i / 12], lamp_hz = lamps[i / 3 % 4], share = shares[i % 3];
        const int second = (int)ceil(fps), long_enough = 7 * second > 260 ? 7 * second : 260;
        room r;
        double beat;
        open_room(&r, fps, lamp_hz, share);
        r.jitter_s = jitter_s, r.drops = drops;
        const double first = flicker(&r, second, NULL);
        flicker(&r, long_enough, NULL);
        const double rms = flicker(&r, 2 * second, &beat);
        if (beyond(lamp_hz / fps) < SLOWEST * 1.1) { /* a slow swell */
            CHECK_MSG(beat == 0.0, "%g Hz at %g fps: %g", lamp_hz, fps, beat);
            left++;
            continue;
        }
        before = fmax(before, first);
        if (is_half(lamp_hz, fps)) {
            half = fmax(half, rms);
            CHECK_MSG(rms < 0.3 * first || rms <= LIMIT_EV, "%g Hz at %g fps: %g EV, at first %g", lamp_hz, fps, rms,
                      first);
            continue;
        }
        worst = fmax(worst, rms);
        CHECK_MSG(rms <= LIMIT_EV, "%g Hz at %g fps, %g %%: %g EV, at first %g", lamp_hz, fps, 100 * share, rms, first);
        CHECK_MSG(first < 0.02 || beat > 0.3 * first, "%g Hz at %g fps, %g %%: beat %g", lamp_hz, fps, 100 * share,
                  beat);
    }
    printf(
        "beats%s: %.4f EV RMS a frame at first, %.4f after eight seconds; of half the frame rate %.4f; %d too slow\n",
        what, before, worst, half, left);
}

/* Light that steps under a lamp, which also changes the loop's exposures; then the lamp is switched off. */
static void check_steps(void)
{
    static const double steps[] = {1.0, -2.0, 0.5, -0.3, 3.0, -1.5};
    double after = 0.0, rest = 0.0, off = 0.0;
    for (int f = 0; f < RATES; f++) {
        const int second = (int)ceil(rates[f]);
        const double lamp_hz = beyond(100.05 / rates[f]) > SLOWEST ? 100.05 : 119.95;
        room r;
        double beat;
        if (beyond(lamp_hz / rates[f]) < SLOWEST || is_half(lamp_hz, rates[f]))
            continue;
        open_room(&r, rates[f], lamp_hz, 0.1);
        flicker(&r, 8 * second + 100, NULL);
        for (int i = 0; i < 6; i++) {
            r.level_ev += steps[i];
            flicker(&r, 2 * second + 20, NULL); /* the step itself shows, and the new exposure has another wave */
            after = fmax(after, flicker(&r, second, NULL));
            flicker(&r, 5 * second + 100, NULL);
            const double rms = flicker(&r, second, NULL);
            rest = fmax(rest, rms);
            CHECK_MSG(rms <= LIMIT_EV, "%g Hz at %g fps, step %g: %g EV", lamp_hz, rates[f], steps[i], rms);
        }
        r.share = 0.0;
        flicker(&r, 8, NULL);
        const double rms = flicker(&r, second, &beat);
        off = fmax(off, beat);
        CHECK_MSG(beat <= NOTHING_EV && rms <= LIMIT_EV, "off at %g fps: beat %g, %g EV", rates[f], beat, rms);
    }
    printf(
        "steps of light: %.4f EV RMS a frame 2 to 3 seconds after, %.4f after 8; 8 frames after the lamp is off %.4f "
        "EV are taken out\n",
        after, rest, off);
}

/* --- light without lamps --- */

enum { STILL, NOISE, WALK, PANS, STEPS, BLINKS, STROBES, WAVES, KINDS };
static const char *const kind_name[KINDS] = {"still", "noise",    "random walk", "pans",
                                             "steps", "blinking", "strobes",     "slow waves"};

static double normal(void)
{
    const double u = 1.0 - check_uniform();
    return sqrt(-2.0 * log(u)) * cos(2.0 * PI * check_uniform());
}

/* log2 of its light at frame i, given that of the frame before. */
static double ordinary(int kind, double fps, int i, double *state)
{
    const double t = i / fps;
    switch (kind) {
    case NOISE:
        return 0.05 * normal();
    case WALK:
        return *state = 0.999 * *state + 0.03 * normal();
    case PANS: /* there and back, at different speeds */
        if (i % 97 == 0)
            state[1] = 0.05 * (check_uniform() - 0.5);
        *state = 0.995 * *state + state[1];
        return *state;
    case STEPS:
        if (check_uniform() < 0.05)
            *state = 4.0 * (check_uniform() - 0.5);
        return *state;
    case BLINKS: /* 1 % of the light's pixels, 7 stops, once a second */
        return 0.07 * (t - floor(t) < 0.5);
    case STROBES: /* one frame of 5 to 30, and back */
        return i % (5 + i / 1000 % 26) == 0 ? 3.0 : 0.0;
    case WAVES: /* a person walks by: nothing is periodic */
        state[0] += 2.0 * PI * (1.5 + 0.5 * sin(0.9 * t)) / fps;
        return 0.2 * sin(state[0]);
    default:
        return 0.0;
    }
}

/* How much of a frame's light the digital loop removes. */
static double taken_out(pupil_t *pupil, double ev, int64_t timestamp_ns)
{
    pupil_stats stats;
    pupil_exposure e;
    const pupil_frame_info info = {.timestamp_ns = timestamp_ns};
    ref_stats_at(ev, 1, &stats);
    CHECK(pupil_adapt(pupil, &stats, &info) == PUPIL_OK && pupil_get_exposure(pupil, &e) == PUPIL_OK);
    return e.flicker_ev;
}

static void check_ordinary(void)
{
    static const double some[] = {15, 24, 25, 29.97, 30, 49, 60};
    pupil_config config;
    pupil_config_default(&config);
    for (int kind = 0; kind < KINDS; kind++) {
        double most = 0.0;
        for (int f = 0; f < 7; f++) {
            pupil_t pupil;
            room r;
            double state[2] = {0.0, 0.0};
            CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
            for (int i = 0; i < check_some(LONG / 7 / check_every(4)); i++)
                most = fmax(most, fabs(taken_out(&pupil, ordinary(kind, some[f], i, state),
                                                 1000000000 + (int64_t)(i * 1e9 / some[f]))));
            open_room(&r, some[f], 0.0, 0.0);
            for (int i = 0; i < check_some(1500 / check_every(2)); i++) {
                r.level_ev = log2(0.18 / 0.004) + ordinary(kind, some[f], i, state);
                next_frame(&r);
                most = fmax(most, fabs(r.setting.flicker_ev));
            }
        }
        printf("%s: %g EV are taken out at most\n", kind_name[kind], most);
        CHECK_MSG(most <= NOTHING_EV, "%s: %g EV", kind_name[kind], most);
    }
}

/* --- the digital loop --- */

/* For the frame itself, as in pupil_process, and for the next one, as with mapping by older statistics. */
static void check_digital(void)
{
    double now = 0.0, next = 0.0, without = 0.0;
    for (int on = 0; on < 2; on++) {
        pupil_config config;
        pupil_t pupil;
        double last[2] = {NAN, NAN}, sum[2] = {0, 0};
        pupil_config_default(&config);
        config.flicker = (uint32_t)on;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        for (int i = 0; i < 900; i++) {
            const double ev = log2(1.0 + 0.1 * sin(2.0 * PI * 100.03 * i / 30.0));
            const pupil_frame_info info = {.timestamp_ns = 1000000000 + (int64_t)(i * 1e9 / 30.0)};
            pupil_curve curve = {.scale = 1.0f};
            double shown[2];
            CHECK(pupil_get_curve(&pupil, &info, &curve) == (i ? PUPIL_OK : PUPIL_ERR_NO_EXPOSURE));
            shown[1] = ev + log2((double)curve.scale);
            const double beat = taken_out(&pupil, ev, info.timestamp_ns);
            CHECK(on || beat == 0.0);
            CHECK(pupil_get_curve(&pupil, i % 2 ? &info : NULL, &curve) == PUPIL_OK);
            shown[0] = ev + log2((double)curve.scale);
            for (int k = 0; k < 2; k++) {
                sum[k] += i >= 600 ? (shown[k] - last[k]) * (shown[k] - last[k]) / 300.0 : 0.0;
                last[k] = shown[k];
            }
        }
        now = sqrt(sum[0]), next = sqrt(sum[1]);
        without = on ? without : now;
    }
    printf("the digital loop: %.4f EV RMS a frame without, %.4f of the frame itself, %.4f of the next one\n", without,
           now, next);
    CHECK(without > 0.05 && now <= LIMIT_EV && next <= LIMIT_EV);
}

/* One frame with an exposure that is NaN or impossible: nothing goes out of range (the asan preset would see it), and
 * the flicker is found again. */
static void check_wrong_exposures(void)
{
    static const double wrong[] = {INFINITY, 1e300, 0x1p64, 1e10};
    pupil_config config;
    pupil_config_default(&config);
    for (int k = 0; k < 4; k++) {
        pupil_t pupil;
        double most[2] = {0, 0};
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        for (int i = 0; i < 600; i++) {
            pupil_stats stats;
            pupil_exposure e;
            const pupil_frame_info info = {.timestamp_ns = 1000000000 + (int64_t)(i * 1e9 / 30.0),
                                           .exposure_s = i == 300 ? wrong[k] : 0.005};
            ref_stats_at(log2(1.0 + 0.1 * sin(2.0 * PI * 100.03 * i / 30.0)), 1, &stats);
            CHECK(pupil_adapt(&pupil, &stats, &info) == PUPIL_OK && pupil_get_exposure(&pupil, &e) == PUPIL_OK);
            CHECK_MSG(fabs(e.flicker_ev) < 0.2 && fabs(e.adapted_ev) < 0.2, "exposure of %g, frame %d: %g and %g EV",
                      wrong[k], i, e.flicker_ev, e.adapted_ev);
            most[i > 300] = fmax(most[i > 300], fabs(e.flicker_ev));
        }
        CHECK_MSG(most[0] > 0.1 && most[1] > 0.1, "exposure of %g: beats of %g and, after it, %g EV", wrong[k], most[0],
                  most[1]);
    }
}

/* For any input everything stays finite, and the same frames give the same bits. */
static uint64_t abuse(void)
{
    static const double evs[] = {0.0, -300.0, 60.0, NAN, INFINITY};
    pupil_sensor_config c;
    pupil_sensor sensor;
    pupil_sensor_setting s;
    uint64_t digest = 0;
    int64_t now = 1;
    pupil_sensor_config_default(&c);
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    for (int i = 0; i < 4000; i++) {
        const uint64_t kind = check_random() % 40;
        const double ev = kind < 5 ? evs[kind] : 0.3 * sin(2.0 * PI * (double)i / 3.0);
        now = kind == 5   ? now
              : kind == 6 ? now - 50000000
              : kind == 7 ? INT64_MAX - 1
              : kind == 8 ? -now
              : kind == 9 ? 0
                          : (now > INT64_MAX / 2 || now < 0 ? 1 : now) + 33333333;
        const pupil_frame_info info = {.timestamp_ns = now, .exposure_s = kind == 10 ? 1e19 : 0.005, .gain = 1.0};
        CHECK(pupil_sensor_scene(&sensor, ev, 0.0, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        CHECK_MSG(isfinite(s.flicker_ev) && isfinite(s.frame_digital) && s.frame_digital > 0 && isfinite(s.total_s),
                  "frame %d, kind %d: beat %g, digital %g", i, (int)kind, s.flicker_ev, s.frame_digital);
        uint64_t bits;
        memcpy(&bits, &s.frame_digital, sizeof bits);
        digest = digest * UINT64_C(0x100000001b3) + bits;
    }
    return digest;
}

/* A frame of an object under a lamp of 100 Hz, with a wave of 20 %, at 30 frames a second. */
static pupil_exposure lamp_frame(pupil_t *pupil, int64_t timestamp_ns, double exposure_s)
{
    const pupil_frame_info info = {.timestamp_ns = timestamp_ns, .exposure_s = exposure_s, .gain = 1.0};
    pupil_exposure e = {0};
    pupil_stats stats;
    (void)ref_stats_at(log2(1.0 + 0.2 * cos(2.0 * PI * 100.0 * (double)timestamp_ns * 1e-9)), 1, &stats);
    CHECK(pupil_adapt(pupil, &stats, &info) == PUPIL_OK && pupil_get_exposure(pupil, &e) == PUPIL_OK);
    return e;
}

static float scale_at(const pupil_t *pupil, int64_t timestamp_ns)
{
    const pupil_frame_info info = {.timestamp_ns = timestamp_ns};
    pupil_curve curve = {0};
    CHECK(pupil_get_curve(pupil, &info, &curve) == PUPIL_OK);
    return curve.scale;
}

/* For frames far from the last one, and for those without a time, nothing is known. */
static void check_far_away(void)
{
    pupil_config config;
    pupil_exposure e = {0};
    pupil_t pupil;
    int64_t last = 0;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int64_t n = 0; n < 300; n++)
        e = lamp_frame(&pupil, last = 5000000000 + n * 33333333, 0.0);
    CHECK_MSG(fabs(e.flicker_ev) > 0.05, "%g", e.flicker_ev);
    CHECK_MSG(fabs(log2((double)scale_at(&pupil, last)) - (log2(e.scale) - e.flicker_ev)) < 1e-6, "%g",
              (double)scale_at(&pupil, last));
    static const int64_t far_ns[] = {-1000000001, -4000000000, 1000000001, 4000000000};
    for (int i = 0; i < 4; i++)
        CHECK_MSG(scale_at(&pupil, last + far_ns[i]) == (float)e.scale, "%g s", (double)far_ns[i] * 1e-9);
    CHECK(scale_at(&pupil, last - 999999999) != (float)e.scale);
    CHECK(scale_at(&pupil, 0) == (float)e.scale);
}

/* Two exposures that end, by their info, almost at the same time, which gives a meaningless frame rate: nothing is
 * removed from later frames, and after a pause the lamp is found. */
static void check_no_period(void)
{
    pupil_config config;
    pupil_exposure e = {0};
    pupil_t pupil;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    (void)lamp_frame(&pupil, 1, 2.0 * nextafter(1e-9, 0.0));
    e = lamp_frame(&pupil, 2, 1e-30);
    CHECK(e.flicker_ev == 0.0);
    e = lamp_frame(&pupil, 900000000, 1e-30);
    CHECK(e.flicker_ev == 0.0 && isfinite(e.adapted_ev));
    for (int64_t n = 0; n < 30; n++)
        e = lamp_frame(&pupil, 933333333 + n * 33333333, 1e-30);
    CHECK(e.flicker_ev == 0.0 && isfinite(e.adapted_ev));
    for (int64_t n = 0; n < 300; n++)
        e = lamp_frame(&pupil, 4000000000 + n * 33333333, 1e-30);
    CHECK_MSG(fabs(e.flicker_ev) > 0.05 && fabs(e.flicker_ev) < 0.5, "%g", e.flicker_ev);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_rates(0.0, 0.0, "");
    check_rates(0.0, 0.1, ", 10 % lost");
    check_rates(0.0002, 0.05, ", timestamps off by up to 0.2 ms, 5 % lost");
    check_steps();
    check_ordinary();
    check_digital();
    check_wrong_exposures();
    const uint64_t random = check_state.random, once = abuse();
    check_state.random = random;
    CHECK(abuse() == once);
    check_far_away();
    check_no_period();
    return check_end();
}
