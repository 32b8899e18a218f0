/* Invariants of pupil_sensor after every call, for any calls, frames and cameras; and that a change of mode does not
 * move the shown level.
 *
 *     test_sensor_properties [SEED [EPISODES]]
 *
 * Each episode has a seed of its own, which a failure prints; with EPISODES 1 it is run alone. */
#include "sensor_plant.h"

#define BUMP_EV 0.005

enum { CALLS = 160, REST = 70, AFTER = 14, HANDS = 8, REASONS = PUPIL_SENSOR_HUNTING + 1 };

static plant p;
static pupil_sensor sensor, twin;
static pupil_sensor_setting s;
static pupil_sensor_config c;
static uint64_t episode_seed;
static unsigned long bumps, compared; /* frames around a retune */
static unsigned long not_there;       /* frames that name a limit although the setting is not at it */
static unsigned long pair[PUPIL_SENSOR_LOCKED + 1][REASONS], at[REASONS], beyond[REASONS], settings, bound,
    free_of_limits;
static double worst_bump;
static int written_again; /* by the last call */

/* At most a few lines of it. */
#define HOLDS(condition, ...)                                                                                          \
    do {                                                                                                               \
        const unsigned long failures = check_state.failures;                                                           \
        CHECK_MSG(condition, __VA_ARGS__);                                                                             \
        if (check_state.failures > failures && check_state.failures <= 20)                                             \
            printf("    this episode alone: %s %llu 1\n", check_state.program, (unsigned long long)episode_seed);      \
    } while (0)

static int one_in(int n)
{
    return check_random() % (uint64_t)n == 0;
}

static double between(double low, double high)
{
    return low * pow(high / low, check_uniform());
}

/* --- cameras --- */

static pupil_sensor_config random_config(void)
{
    const int law = (int)(check_random() % (LAWS + 1));
    pupil_sensor_config r = plant_config(law % LAWS);
    if (law == LAWS)
        r.gain_law = PUPIL_GAIN_ANY;
    r.delay_frames = 1 + (uint32_t)(check_random() % 6);
    r.exposure_step_s = one_in(3) ? 0 : one_in(3) ? between(1e-6, 1e-3) : PLANT_LINE_S;
    r.exposure_min_s = one_in(2) ? PLANT_LINE_S : between(1e-5, 1e-2);
    r.exposure_max_s = one_in(2) ? r.frame_s : between(r.exposure_min_s, 0.2);
    r.gain_min = one_in(2) ? 1 : between(0.4, 3);
    r.gain_max = r.gain_min * between(1, 40);
    r.frame_rate_priority = !one_in(3);
    r.mains_hz = one_in(2) ? 0 : one_in(2) ? 50 : 60;
    r.exposure_mode = one_in(3) ? (uint32_t)(check_random() % 3) : PUPIL_SENSOR_AUTO;
    r.gain_mode = one_in(3) ? (uint32_t)(check_random() % 3) : PUPIL_SENSOR_AUTO;
    r.manual_exposure_s = between(1e-6, 0.3);
    r.manual_gain = between(0.3, 100);
    r.lock = one_in(8);
    r.ev_compensation = one_in(3) ? 4 * check_uniform() - 2 : 0;
    r.flash_frames = (uint32_t)(check_random() % 4);
    r.linear = !one_in(4);
    r.highlight_ev = one_in(2) ? 1 : 0;
    r.tau_s = one_in(4) ? 0 : between(0.05, 5);
    r.stages = (uint32_t)(check_random() % 3);
    for (uint32_t i = 0; i < r.stages; i++)
        r.stage[i] = (pupil_sensor_stage){i ? r.stage[i - 1].exposure_s * between(1, 4) : between(1e-4, 0.02),
                                          i ? r.stage[i - 1].gain * between(1, 4) : between(0.5, 3)};
    r.key_points = one_in(3) ? (uint32_t)(check_random() % (PUPIL_KEY_POINTS + 1)) : 0;
    r.key_at[0] = (pupil_key_point){12 * check_uniform() - 6, between(0.02, 0.2)};
    for (uint32_t i = 1; i < r.key_points; i++) {
        const pupil_key_point *before = &r.key_at[i - 1];
        const double more_ev = between(0.01, 3);
        r.key_at[i].scene_ev = before->scene_ev + more_ev;
        r.key_at[i].key = fmin(1, before->key * exp2(0.5 * more_ev * check_uniform()));
    }
    return r;
}

static int is_multiple(double x, double step)
{
    return fabs(x / step - floor(x / step + 0.5)) < 1e-5;
}

/* By sensor.h: multiples of the step; from half a mains period on multiples of that (rounded down to steps); or the
 * minimum. */
static int camera_has_exposure(double exposure_s)
{
    const double half_s = c.mains_hz ? 0.5 / c.mains_hz : 0,
                 periods = half_s > 0 ? ceil(exposure_s / half_s - 1e-9) : 0;
    if (exposure_s == c.exposure_min_s)
        return 1;
    if (!(exposure_s > c.exposure_min_s && exposure_s <= c.exposure_max_s * (1 + 1e-9)))
        return 0;
    if (c.exposure_step_s > 0 && !is_multiple(exposure_s, c.exposure_step_s))
        return 0;
    return periods < 2 || c.exposure_step_s >= half_s ||
           exposure_s > periods * half_s * (1 - 1e-9) - c.exposure_step_s * (1 + 1e-5);
}

static int camera_has_gain(double gain)
{
    if (gain == c.gain_min)
        return 1;
    if (!(gain > c.gain_min && gain <= c.gain_max * (1 + 1e-9)))
        return 0;
    switch (c.gain_law) {
    case PUPIL_GAIN_LINEAR:
        return is_multiple(gain, c.gain_step);
    case PUPIL_GAIN_DB:
        return is_multiple(20 * log10(gain), c.gain_step);
    case PUPIL_GAIN_RECIPROCAL:
        return gain >= 1 && is_multiple(c.gain_step / gain, 1);
    case PUPIL_GAIN_TABLE:
        for (uint32_t i = 0; i < c.gain_count; i++)
            if (c.gain_table[i] == gain)
                return 1;
        return 0;
    default:
        return 1;
    }
}

/* --- after every call --- */

static int is_locked(void)
{
    return c.lock || (c.exposure_mode != PUPIL_SENSOR_AUTO && c.gain_mode != PUPIL_SENSOR_AUTO);
}

/* Which states and reasons sensor.h combines. A frame that does not count keeps the last state; a clock that went back
 * is reported where there is no other reason. */
static int may_go_together(uint32_t state, uint32_t reason)
{
    if (reason == PUPIL_SENSOR_INVALID_FRAME || reason == PUPIL_SENSOR_REPEATED_FRAME)
        return 1;
    switch (state) {
    case PUPIL_SENSOR_EMPTY:
        return reason == PUPIL_SENSOR_NO_REASON || reason == PUPIL_SENSOR_FLASH;
    case PUPIL_SENSOR_SEARCHING:
    case PUPIL_SENSOR_CLIPPED:
        return reason == PUPIL_SENSOR_NO_REASON || reason == PUPIL_SENSOR_WAITING || reason == PUPIL_SENSOR_FLASH ||
               reason == PUPIL_SENSOR_NONLINEAR || reason == PUPIL_SENSOR_HUNTING ||
               reason == PUPIL_SENSOR_HIGHLIGHTS || reason == PUPIL_SENSOR_CLOCK_BACK;
    case PUPIL_SENSOR_CONVERGED:
        return reason == PUPIL_SENSOR_NO_REASON || reason == PUPIL_SENSOR_NONLINEAR ||
               reason == PUPIL_SENSOR_HIGHLIGHTS || reason == PUPIL_SENSOR_FLASH || reason == PUPIL_SENSOR_CLOCK_BACK;
    case PUPIL_SENSOR_LIMITED:
        return (reason >= PUPIL_SENSOR_AT_EXPOSURE_MIN && reason <= PUPIL_SENSOR_AT_GAIN_MAX) ||
               reason == PUPIL_SENSOR_IGNORED || reason == PUPIL_SENSOR_HUNTING || reason == PUPIL_SENSOR_FLASH;
    case PUPIL_SENSOR_FLICKER:
        return reason == PUPIL_SENSOR_BELOW_MAINS || reason == PUPIL_SENSOR_FLASH;
    default:
        return state == PUPIL_SENSOR_LOCKED && (reason == PUPIL_SENSOR_LOCK || reason == PUPIL_SENSOR_ALL_MANUAL);
    }
}

/* Every limit that an auto control is at, computed independently. */
static uint32_t limits_of(void)
{
    const int by_frame = c.frame_rate_priority && c.frame_s < c.exposure_max_s;
    const double longest = by_frame ? c.frame_s : c.exposure_max_s;
    uint32_t limits = 0;
    if (c.exposure_mode == PUPIL_SENSOR_AUTO) {
        limits |= s.exposure_s <= c.exposure_min_s * (1 + 1e-9) ? 1u << PUPIL_SENSOR_AT_EXPOSURE_MIN : 0;
        double most = c.exposure_step_s > 0 ? c.exposure_step_s * floor(longest / c.exposure_step_s + 1e-6) : longest;
        const double half_s = c.mains_hz ? 0.5 / c.mains_hz : 0, lines = c.exposure_step_s;
        if (half_s > 0 && most >= half_s - lines) {
            double periods = floor((longest + 1e-6 * half_s) / half_s), e = periods * half_s;
            e = lines > 0 ? lines * floor(e / lines + 1e-6) : e;
            most = e > 0 ? e : most;
        }
        most = most > c.exposure_min_s ? most : c.exposure_min_s;
        limits |= s.exposure_s >= most * (1 - 1e-9)
                      ? 1u << (by_frame ? PUPIL_SENSOR_AT_FRAME_PERIOD : PUPIL_SENSOR_AT_EXPOSURE_MAX)
                      : 0;
    }
    if (c.gain_mode == PUPIL_SENSOR_AUTO) {
        int higher = 0; /* a gain that the camera has, above this one */
        const double g = s.gain * (1 + 1e-9), most = c.gain_max * (1 + 1e-9);
        switch (c.gain_law) {
        case PUPIL_GAIN_LINEAR:
            higher = c.gain_step * (floor(g / c.gain_step + 1e-6) + 1) <= most;
            break;
        case PUPIL_GAIN_DB:
            higher = pow(10, c.gain_step / 20 * (floor(20 * log10(g) / c.gain_step + 1e-6) + 1)) <= most;
            break;
        case PUPIL_GAIN_RECIPROCAL:
            higher =
                g < 1 ? most >= 1 : c.gain_step / (ceil(c.gain_step / g - 1e-6) - 1) <= most && c.gain_step / g > 1;
            break;
        case PUPIL_GAIN_TABLE:
            for (uint32_t i = 0; i < c.gain_count; i++)
                higher |= c.gain_table[i] > g && c.gain_table[i] <= most;
            break;
        default:
            higher = g * (1 + 1e-9) < c.gain_max;
            break;
        }
        limits |= s.gain <= c.gain_min * (1 + 1e-9) ? 1u << PUPIL_SENSOR_AT_GAIN_MIN : 0;
        limits |= higher ? 0 : 1u << PUPIL_SENSOR_AT_GAIN_MAX;
    }
    return limits;
}

/* `frame`: the call was a frame with light. */
static void check_setting(const pupil_sensor_setting *before, int frame)
{
    HOLDS(pupil_sensor_get(&sensor, &s) == PUPIL_OK && memcmp(&sensor, &twin, sizeof sensor) == 0, "a twin differs");
    HOLDS(s.state <= PUPIL_SENSOR_LOCKED && s.reason < REASONS && may_go_together(s.state, s.reason),
          "state %u with reason %u", s.state, s.reason);
    if (s.state > PUPIL_SENSOR_LOCKED || s.reason >= REASONS)
        return;
    const double numbers[] = {s.exposure_s, s.gain, s.digital, s.total_s, s.frame_digital, s.slope};
    for (int i = 0; i < 6; i++)
        HOLDS(isfinite(numbers[i]) && numbers[i] > 0, "number %d is %g", i, numbers[i]);
    HOLDS(isfinite(s.scene_ev) && isfinite(s.error_ev) && isfinite(s.dt_s) && s.dt_s >= 0, "scene %g, error %g, dt %g",
          s.scene_ev, s.error_ev, s.dt_s);
    HOLDS(fabs(s.exposure_s * s.gain * s.digital / s.total_s - 1) < 1e-12, "%g s x %g x %g is not %g", s.exposure_s,
          s.gain, s.digital, s.total_s);
    HOLDS(fabs(log2(s.frame_digital)) <= c.digital_ev + 1e-6, "frame_digital %g", s.frame_digital);
    HOLDS(camera_has_exposure(s.exposure_s), "the camera has no exposure of %.9g s (%g to %g, step %g, mains %u)",
          s.exposure_s, c.exposure_min_s, c.exposure_max_s, c.exposure_step_s, c.mains_hz);
    HOLDS(camera_has_gain(s.gain), "the camera has no gain of %.9g (%g to %g, law %u)", s.gain, c.gain_min, c.gain_max,
          c.gain_law);
    /* a setting is repeated for a camera that does not respond, but never after two frames in a row; a call without a
     * frame keeps a change that was not written yet */
    const int is_other = s.exposure_s != before->exposure_s || s.gain != before->gain;
    HOLDS(s.changed ? is_other || !written_again || !frame : !is_other, "changed is %u", s.changed);
    written_again = s.changed && !is_other;
    HOLDS(s.limits == limits_of(), "limits %#x, the setting (%.9g s, gain %.9g, law %u) stands at %#x", s.limits,
          s.exposure_s, s.gain, c.gain_law, limits_of());
    settings += s.changed;
    for (int i = 0; i < REASONS; i++)
        at[i] += s.limits >> i & 1;
    if (!frame)
        return;
    pair[s.state][s.reason]++;
    HOLDS((s.state == PUPIL_SENSOR_LOCKED) == is_locked(), "state %u, reason %u, lock %u, modes %u %u", s.state,
          s.reason, c.lock, c.exposure_mode, c.gain_mode);
    HOLDS((s.state != PUPIL_SENSOR_EMPTY || s.reason == PUPIL_SENSOR_FLASH) && s.frames == before->frames + 1,
          "state %u after %llu frames", s.state, (unsigned long long)s.frames);
    if (s.reason >= PUPIL_SENSOR_AT_EXPOSURE_MIN && s.reason <= PUPIL_SENSOR_AT_GAIN_MAX) {
        beyond[s.reason]++;
        /* the light is beyond the limit; the setting is at it, or within far_ev and moving slowly */
        not_there += !(s.limits >> s.reason & 1) && fabs(s.error_ev) <= 0.004;
    }
}

/* --- any calls --- */

static void begin(double light_ev)
{
    memset(&sensor, 0xa5, sizeof sensor);
    memset(&twin, 0x3c, sizeof twin);
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_init(&twin, &c) == PUPIL_OK);
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    plant_open(&p, &sensor, light_ev, 1 + (uint32_t)(check_random() % 5));
    p.pixels = 2 * PLANT_WIDTH;
    p.delay[1] = one_in(2) ? p.delay[0] : 1 + (uint32_t)(check_random() % 5);
}

static void retune(const pupil_sensor_config *next)
{
    const pupil_sensor_setting before = s;
    c = *next;
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK && pupil_sensor_retune(&twin, &c) == PUPIL_OK);
    check_setting(&before, 0);
}

/* A frame of the camera, with a clock that may stop or go back, or a repeated frame, or invalid statistics. The
 * sequence says which frame is new. */
static void frame(int odd)
{
    static pupil_stats stats;
    static int64_t clock_off;
    static pupil_frame_info last;
    const pupil_sensor_setting before = s;
    pupil_frame_info info = plant_next(&p, &stats);
    int lit = 1;
    clock_off -= odd == 1 ? (int64_t)(check_random() >> 34) : 0;
    info.timestamp_ns += clock_off;
    if (odd == 2)
        info.timestamp_ns = last.timestamp_ns;
    if (odd == 2 && one_in(2))
        info.sequence = last.sequence;
    if (odd == 3)
        pupil_stats_clear(&stats), lit = 0;
    if (odd == 4)
        info.exposure_s = one_in(2) ? NAN : -1, info.gain = one_in(2) ? INFINITY : 0;
    if (odd == 5) { /* metered elsewhere, well or badly */
        const double bad[] = {NAN, INFINITY, -INFINITY, 1e9, 4, -9}, ev = bad[check_random() % 6];
        const double share = one_in(3) ? bad[check_random() % 6] : check_uniform();
        lit = fabs(ev) <= 256 && share >= 0 && share <= 1;
        CHECK(pupil_sensor_scene(&sensor, ev, share, &info) == PUPIL_OK);
        CHECK(pupil_sensor_scene(&twin, ev, share, &info) == PUPIL_OK);
    } else if (odd != 6) { /* 6: lost on its way */
        CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK);
        CHECK(pupil_sensor_frame(&twin, &stats, &info) == PUPIL_OK);
    }
    if (odd != 6) {
        const int is_again = before.frames && info.timestamp_ns && info.timestamp_ns == last.timestamp_ns &&
                             info.sequence && info.sequence == last.sequence;
        lit &= !is_again;
        last = info;
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        HOLDS((s.reason == PUPIL_SENSOR_REPEATED_FRAME) == is_again, "reason %u", s.reason);
        check_setting(&before, lit);
        HOLDS(lit || (!s.changed && s.total_s == before.total_s && s.state == before.state),
              "a frame that is none moved it: state %u, reason %u", s.state, s.reason);
    }
    plant_ask(&p, &s);
}

static void any_calls(void)
{
    c = random_config();
    begin(20 * check_uniform() - 8);
    p.lies = (int)(check_random() % 4);
    p.noise_ev = one_in(2) ? 0.02 : 0;
    p.slope = one_in(3) ? 0.5 + 1.5 * check_uniform() : 1;
    p.ignored[0] = one_in(8), p.ignored[1] = one_in(8);
    for (int i = 0; i < CALLS; i++) {
        const pupil_sensor_setting before = s;
        static pupil_sensor kept;
        pupil_sensor_config next;
        double total;
        if (one_in(12)) /* a step, sometimes into black or white; or a flash */
            p.light_ev = one_in(4) ? (one_in(2) ? -30 : 40) : 20 * check_uniform() - 8;
        switch (check_random() % 24) {
        case 0:
            next = random_config();
            retune(&next);
            /* moved only into the new limits; a dead control's setting does not show its limits */
            HOLDS(fabs(s.total_s / before.total_s - 1) < 1e-9 || is_locked() || fabs(s.digital - 1) < 1e-9 ||
                      before.reason == PUPIL_SENSOR_IGNORED,
                  "total from %g to %g s, digital %g, reason %u", before.total_s, s.total_s, s.digital, before.reason);
            break;
        case 1:
            total = between(1e-7, 100);
            CHECK(pupil_sensor_start(&sensor, total, 1) == PUPIL_OK && pupil_sensor_start(&twin, total, 1) == PUPIL_OK);
            check_setting(&before, 0);
            break;
        case 2: /* refused: nothing moves */
            kept = sensor;
            next = c;
            next.gain_max = NAN;
            CHECK(pupil_sensor_retune(&sensor, &next) == PUPIL_ERR_CONFIG);
            CHECK(pupil_sensor_start(&sensor, NAN, 1) == PUPIL_ERR_VALUE);
            HOLDS(memcmp(&kept, &sensor, sizeof sensor) == 0, "a refused call moved it");
            break;
        case 3: /* moved in memory, the object still works */
            kept = sensor;
            memset(&sensor, 0, sizeof sensor);
            sensor = kept;
            break;
        default:
            frame((int)(check_random() % 32));
        }
    }
}

/* --- a change of mode --- */

/* Changes one thing in the config; returns which. A manual control becomes auto again, or stays manual. */
static const char *change_hands(const pupil_sensor_config *usual)
{
    static const char *const what[] = {"manual gain", "gain held", "manual exposure", "exposure held", "lock",
                                       "profile",     "gain law",  "mains",           "usual",         "both held"};
    const int change = (int)(check_random() % 10);
    pupil_sensor_config next = *usual;
    if (one_in(2))
        next.lock = change == 4 || c.lock;
    next.lock |= change == 4;
    next.gain_mode = change == 0 ? PUPIL_SENSOR_MANUAL : change == 1 || change == 9 ? PUPIL_SENSOR_HELD : 0;
    next.manual_gain = between(0.8, 24);
    next.exposure_mode = change == 2 ? PUPIL_SENSOR_MANUAL : change == 3 || change == 9 ? PUPIL_SENSOR_HELD : 0;
    next.manual_exposure_s = between(5e-5, 0.04);
    next.stages = change == 5 ? 2 : 0;
    next.stage[0] = (pupil_sensor_stage){between(1e-3, 0.01), between(1, 3)};
    next.stage[1] = (pupil_sensor_stage){between(0.01, 0.03), between(3, 8)};
    if (change == 6) {
        const pupil_sensor_config other = plant_config((int)(check_random() % LAWS));
        next.gain_law = other.gain_law, next.gain_step = other.gain_step;
    }
    next.mains_hz = change == 7 ? (one_in(2) ? 50 : 60) : 0;
    retune(&next);
    /* written before the next frame, as sensor.h wants it after each call */
    p.asked[(p.frame + PLANT_RING - 1) % PLANT_RING][0] = s.exposure_s;
    p.asked[(p.frame + PLANT_RING - 1) % PLANT_RING][1] = s.gain;
    return what[change];
}

/* With true metadata and still light, no shown frame differs from the one before by more than BUMP_EV, except where the
 * new modes cannot reach the total: then it is at a limit, and digital is 1. */
static void hands(void)
{
    const int law = (int)(check_random() % LAWS);
    pupil_sensor_config usual = plant_config(law);
    usual.digital_ev = 8; /* one control may be far ahead of the other */
    usual.delay_frames = 5;
    usual.highlight_ev = 0;
    c = usual;
    begin(log2(0.18) - log2(between(1e-3, 0.3)));
    p.pixels = PLANT_PIXELS; /* a slope is learned from the steps: few pixels show it badly */
    const int lamp =
        one_in(2) ? (int)(PLANT_PIXELS * 0.3 * check_uniform()) : 0; /* no log-normal scene, which clip hides */
    for (int i = 0; i < lamp; i++)
        p.scene[i] = 2.0;
    double last = 0, shown = 0;
    for (int i = 0; i < REST; i++)
        plant_turn(&p, &sensor, &s, &last);
    twin = sensor;
    for (int n = 0; n < HANDS; n++) {
        change_hands(&usual);
        const int at_limit = fabs(s.digital - 1) < 1e-9 && s.limits;
        bound += at_limit != 0, free_of_limits += !at_limit;
        for (int i = 0; i < AFTER; i++) {
            plant_turn(&p, &sensor, &s, &shown);
            if (at_limit || (i > 0 && s.limits && fabs(s.digital - 1) < 1e-9)) {
                last = shown;
                continue;
            }
            worst_bump = fmax(worst_bump, fabs(shown - last));
            bumps += fabs(shown - last) > BUMP_EV;
            compared++;
            last = shown;
        }
        twin = sensor;
        if (at_limit) { /* settles again, so that the next change begins at rest */
            retune(&usual);
            for (int i = 0; i < REST; i++)
                plant_turn(&p, &sensor, &s, &last);
        }
        twin = sensor;
    }
}

/* --- limits --- */

/* Light far beyond the camera's range: the state is LIMITED, by a limit of that side of an auto control. */
static void limits(void)
{
    c = random_config();
    c.lock = 0;
    c.linear = 1;
    c.key_points = 0; /* the light is beyond the range for the key 0.18 */
    if (is_locked())
        c.exposure_mode = PUPIL_SENSOR_AUTO;
    const int dark = one_in(2);
    const double longest = fmax(c.exposure_max_s, c.frame_s) * c.gain_max * 4,
                 shortest = c.exposure_min_s * c.gain_min / 4;
    begin(log2(0.18) + c.ev_compensation - log2(dark ? longest : shortest) + (dark ? -1 : 1) * (c.highlight_ev + 1));
    for (int i = 0; i < 80; i++)
        frame(0);
    HOLDS(s.state == PUPIL_SENSOR_LIMITED, "%s: state %u, reason %u, limits %#x, %g s, gain %g",
          dark ? "dark" : "bright", s.state, s.reason, s.limits, s.exposure_s, s.gain);
    const int of_exposure = s.reason == PUPIL_SENSOR_AT_EXPOSURE_MIN || s.reason == PUPIL_SENSOR_AT_EXPOSURE_MAX ||
                            s.reason == PUPIL_SENSOR_AT_FRAME_PERIOD;
    const int upper = s.reason == PUPIL_SENSOR_AT_EXPOSURE_MAX || s.reason == PUPIL_SENSOR_AT_FRAME_PERIOD ||
                      s.reason == PUPIL_SENSOR_AT_GAIN_MAX;
    HOLDS(upper == dark, "%s: reason %u", dark ? "dark" : "bright", s.reason);
    HOLDS((of_exposure ? c.exposure_mode : c.gain_mode) == PUPIL_SENSOR_AUTO, "reason %u, modes %u %u", s.reason,
          c.exposure_mode, c.gain_mode);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    const long episodes = argc > 2 ? atol(argv[2]) : check_some(300);
    const uint64_t first = check_state.seed;
    for (long i = 0; i < episodes; i++) {
        check_state.random = first + (uint64_t)i; /* a stream of its own: neighbours of SplitMix64 share nothing */
        check_state.random = episode_seed = i ? check_random() : first;
        any_calls();
        hands();
        limits();
    }
    printf("seed %llu, %ld episodes: %lu settings; states by reasons 0 to %d:\n", (unsigned long long)first, episodes,
           settings, REASONS - 1);
    for (int state = 0; state <= PUPIL_SENSOR_LOCKED; state++) {
        printf("  %d", state);
        for (int reason = 0; reason < REASONS; reason++)
            printf(" %6lu", pair[state][reason]);
        printf("\n");
    }
    for (int reason = PUPIL_SENSOR_AT_EXPOSURE_MIN; reason <= PUPIL_SENSOR_AT_GAIN_MAX; reason++) {
        printf("limit %d: %lu settings stood at it, %lu frames wanted more\n", reason, at[reason], beyond[reason]);
        CHECK_MSG(episodes < 100 || (at[reason] && beyond[reason]), "limit %d was never met", reason);
    }
    printf("changes of hands: %lu, and %lu into a limit; %.5f EV from frame to frame at most\n", free_of_limits, bound,
           worst_bump);
    CHECK(episodes < 100 || free_of_limits > 1000);
    /* a retune to another control before the delays are known; may only fall */
    CHECK_MSG(bumps * 1000 <= compared, "%lu of %lu frames after a retune jump by %g EV at most", bumps, compared,
              worst_bump);
    unsigned long named = 0;
    for (int i = 0; i < REASONS; i++)
        named += beyond[i];
    /* after some retunes the last step to a limit is not made; may only fall */
    CHECK_MSG(not_there * 20 <= named, "%lu of %lu limits are named where the setting is not", not_there, named);
    return check_end();
}
