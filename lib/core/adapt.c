/* The only place where time passes. The level lives in log2 (2^-52 stops) for the default law and formulas 3 and 4,
 * and as a double in the quantity that formulas 1 and 2 average. Every step ends on its target, never short of it (the
 * step is rounded away from the old value) and never past it. */
#include "object.h"

#include "base/key.h"
#include "base/numeric.h"
#include "base/versioned.h"
#include "core/read.h"

/* The white point of the eye's law follows as fast as the cones do. */
#define EYE_WHITE_S 0.08

#define SETTLED_EV 0.05 /* from the target: pupil.h, PUPIL_STATE_SETTLED */
/* Between these multiples of highlight_share the highlights begin to hold the level; docs/pictures.md. */
#define HIGHLIGHT_LEAST 0.8
#define HIGHLIGHT_MOST  1.6
/* Light that is white with any white point: the last sRGB code begins at 0.99554 = 223 / 224, which Reinhard's curve
 * reaches at light of 223, 10.275 stops over a key of 0.18. Up to 1 % of the frame may be so bright; half of that is
 * above the white point, too. */
#define WHITE_ROOM_EV 10.275
#define WHITE_LEAST   0.005
#define WHITE_MOST    0.01

/* config.h, amplification_ev: log2 of 0.18, from which the limit is counted down; and of the light below which a first
 * code lowers the limit further: that of 12 bits of linear light, which the first of 8-bit sRGB is near. */
#define MID_GREY_EV  (-2.473931188332412)
#define FULL_CODE_EV (-12.0)
/* A stop below the largest luminance, stats.h: about half of the frame is there. */
#define MOST_MEAN_EV 29.0

/* pupil.h, PUPIL_REASON_CLOCK_UNIT: 10000 frames a second. At 10 frames a second or more, timestamps in us that are
 * read as ns are less than this apart; ms and seconds always are. */
#define LEAST_STEP_S 1e-4

/* A step of w of the way from s to t, at least one unit where w > 0. */
static pupil_level_q52 approach(pupil_level_q52 s, pupil_level_q52 t, double w)
{
    uint64_t distance = t > s ? (uint64_t)t - (uint64_t)s : (uint64_t)s - (uint64_t)t;
    if (w >= 1.0)
        return t;
    double exact = w * (double)distance;
    uint64_t step = (uint64_t)exact;
    step += (double)step < exact;
    step = step < distance ? step : distance;
    return (pupil_level_q52)(t > s ? (uint64_t)s + step : (uint64_t)s - step);
}

/* The same for positive doubles, whose bits sort as their values do. */
static double approach_linear(double s, double t, double w)
{
    if (w >= 1.0 || s == t)
        return t;
    double next = s + w * (t - s);
    if (t > s) {
        if (!(next > s))
            next = pupil_double_of_bits(pupil_bits_of_double(s) + 1);
        return next < t ? next : t;
    }
    if (!(next < s))
        next = pupil_double_of_bits(pupil_bits_of_double(s) - 1);
    return next > t ? next : t;
}

/* From 1 stop on a double is a whole number of units already, so only smaller ones are rounded. */
pupil_level_q52 pupil_level_of(double stops)
{
    double scaled = stops * 0x1p52;
    if (stops < 1.0 && stops > -1.0)
        scaled += scaled < 0.0 ? -0.5 : 0.5;
    return (pupil_level_q52)scaled;
}

static double stops_of(pupil_level_q52 q)
{
    return (double)q * 0x1p-52;
}

static int is_linear_law(uint32_t law)
{
    return law == PUPIL_LAW_ARITHMETIC_SCALE || law == PUPIL_LAW_ARITHMETIC_LUMINANCE;
}

/* What formulas 1 and 2 average, at a level. */
static double linear_of_level(uint32_t law, pupil_level_q52 level)
{
    return pupil_exp2(law == PUPIL_LAW_ARITHMETIC_SCALE ? -stops_of(level) : stops_of(level));
}

static double seen_cd_m2(const pupil_config *c, double ev)
{
    return pupil_exp2(ev + pupil_log2(c->eye_unit_cd_m2));
}

/* cd_m2: the light that it sees; 0: there is no eye. */
static void tell_of_eye(pupil_adaptation *a, double cd_m2)
{
    a->result.cone_cd_m2 = a->eye.cone_cd_m2;
    a->result.rod_cd_m2 = a->eye.rod_cd_m2;
    a->result.cone_pigment = a->eye.cone_pigment;
    a->result.rod_pigment = a->eye.rod_pigment;
    a->result.rods = cd_m2 > 0.0 ? pupil_eye_rods(&a->eye, cd_m2) : 0.0;
}

void pupil_adaptation_change_law(pupil_object *object, uint32_t old_law)
{
    pupil_adaptation *a = &object->adaptation;
    uint32_t law = object->config.law;
    if (!a->seen || law == old_law)
        return;
    if (is_linear_law(old_law) || old_law == PUPIL_LAW_EYE)
        a->level = pupil_level_of(a->result.adapted_ev);
    if (is_linear_law(law))
        a->linear = linear_of_level(law, a->level);
    if (law == PUPIL_LAW_EYE) {
        pupil_eye_begin(&a->eye, seen_cd_m2(&object->config, stops_of(a->level)));
        tell_of_eye(a, a->eye.cone_cd_m2);
    } else if (old_law == PUPIL_LAW_EYE) {
        a->eye = (pupil_eye){0};
        tell_of_eye(a, 0.0);
    }
}

static double time_step(const pupil_config *c, const pupil_adaptation *a, const pupil_frame_info *info)
{
    if (!a->stamped)
        return 0.0;
    if (info->timestamp_ns == 0 && a->last_timestamp_ns == 0)
        return c->nominal_frame_s;
    /* in double before subtracting: the difference of two int64 may not fit; 2^-53 of a century is 30 ns */
    if ((info->timestamp_ns < 0) != (a->last_timestamp_ns < 0))
        return ((double)info->timestamp_ns - (double)a->last_timestamp_ns) * 1e-9;
    return (double)(info->timestamp_ns - a->last_timestamp_ns) * 1e-9;
}

double pupil_adaptation_tick(const pupil_config *c, pupil_adaptation *a, const pupil_frame_info *info)
{
    const double dt_s = time_step(c, a, info);
    a->last_timestamp_ns = info->timestamp_ns;
    a->stamped = 1;
    return dt_s;
}

static uint32_t clock_reason(int is_timed, double dt_s)
{
    if (dt_s < 0.0)
        return PUPIL_REASON_CLOCK_BACK;
    return is_timed && dt_s < LEAST_STEP_S ? PUPIL_REASON_CLOCK_UNIT : PUPIL_REASON_NONE;
}

double pupil_weight_of_step(const pupil_config *c, double dt_s, int more_light)
{
    if (c->law != PUPIL_LAW_SECONDS && c->law != PUPIL_LAW_EYE)
        return c->frame_weight;
    double tau = c->law == PUPIL_LAW_EYE ? EYE_WHITE_S : more_light ? c->tau_light_s : c->tau_dark_s;
    return tau > 0.0 ? pupil_one_minus_exp(dt_s / tau) : 1.0;
}

static int brings_exposure(const pupil_frame_info *info)
{
    return info && info->exposure_s >= 0x1p-64 && info->exposure_s <= 0x1p64 && info->gain >= 0x1p-64 &&
           info->gain <= 0x1p64;
}

static double exposure_and_gain_log2(const pupil_frame_info *info)
{
    return pupil_log2(info->exposure_s) + pupil_log2(info->gain);
}

void pupil_adaptation_learn_exposure(pupil_adaptation *a, const pupil_frame_info *info)
{
    if (brings_exposure(info)) {
        a->exposure_known = 1;
        a->exposure_log2 = exposure_and_gain_log2(info);
    }
}

double pupil_exposure_log2(const pupil_config *c, const pupil_adaptation *a, const pupil_frame_info *info)
{
    if (!brings_exposure(info) && !a->exposure_known)
        return 0.0;
    double taken_with = brings_exposure(info) ? exposure_and_gain_log2(info) : a->exposure_log2;
    return taken_with - pupil_log2(c->calibration);
}

/* For an eye at rest the level is that of the light. Light beyond the eye's range keeps the offset of the range's
 * end. */
static void move_eye(pupil_object *object, double target_ev, double dt_s)
{
    const pupil_config *c = &object->config;
    pupil_adaptation *a = &object->adaptation;
    const double light = clamp(seen_cd_m2(c, target_ev), PUPIL_EYE_LEAST_CD_M2, PUPIL_EYE_MOST_CD_M2);
    if (a->seen)
        pupil_eye_move(&a->eye, light, dt_s);
    else
        pupil_eye_begin(&a->eye, light);
    const double off_ev = pupil_eye_level_log2(&a->eye, light) - pupil_log2(light);
    a->result.adapted_ev = clamp(target_ev + off_ev, c->ev_min, c->ev_max);
    tell_of_eye(a, light);
}

static void move_level(pupil_object *object, pupil_level_q52 target, double dt_s)
{
    const pupil_config *c = &object->config;
    pupil_adaptation *a = &object->adaptation;

    if (c->law == PUPIL_LAW_EYE) {
        move_eye(object, stops_of(target), dt_s);
        return;
    }
    if (!is_linear_law(c->law)) {
        a->level = a->seen ? approach(a->level, target, pupil_weight_of_step(c, dt_s, target > a->level)) : target;
        a->result.adapted_ev = stops_of(a->level);
        return;
    }
    double goal = linear_of_level(c->law, target);
    a->linear = a->seen ? approach_linear(a->linear, goal, c->frame_weight) : goal;
    if (a->linear == goal) /* the target itself, not what is left of it after an exponential and a logarithm */
        a->result.adapted_ev = stops_of(target);
    else
        a->result.adapted_ev = pupil_log2(a->linear) * (c->law == PUPIL_LAW_ARITHMETIC_SCALE ? -1.0 : 1.0);
}

static void move_white(pupil_object *object, pupil_level_q52 target, double dt_s)
{
    pupil_adaptation *a = &object->adaptation;
    double w = pupil_weight_of_step(&object->config, dt_s, target > a->white);
    a->white = a->seen && a->white_seen ? approach(a->white, target, w) : target;
    a->white_seen = 1;
    a->result.white_ev = stops_of(a->white);
}

/* With the weight of the level, which moves after them. */
static void move_knots(pupil_object *object, const pupil_stats *stats, double target_ev, double white_ev,
                       double divisor_log2, double dt_s)
{
    const pupil_config *c = &object->config;
    pupil_adaptation *a = &object->adaptation;
    const double level_ev = a->result.adapted_ev;
    const double w = a->seen && a->knots.seen ? pupil_weight_of_step(c, dt_s, target_ev > level_ev) : 1.0;
    const pupil_knots_frame frame = {.stats = stats,
                                     .divisor_log2 = divisor_log2 + a->result.flicker_ev,
                                     .target_ev = target_ev,
                                     .white_ev = white_ev,
                                     .centre_ev = w < 1.0 ? level_ev : target_ev,
                                     .weight = w};
    pupil_knots_follow(c, &a->knots, &frame);
}

static void judge(pupil_object *object, double target_ev, uint32_t reason)
{
    pupil_exposure *r = &object->adaptation.result;
    const double off_ev = target_ev - r->adapted_ev;
    r->reason = reason;
    if (reason == PUPIL_REASON_LOCK)
        r->state = PUPIL_STATE_LOCKED;
    else if (off_ev > SETTLED_EV || off_ev < -SETTLED_EV)
        r->state = PUPIL_STATE_ADAPTING;
    else if (reason == PUPIL_REASON_EV_MIN || reason == PUPIL_REASON_EV_MAX || reason == PUPIL_REASON_AMPLIFICATION)
        r->state = PUPIL_STATE_LIMITED;
    else
        r->state = PUPIL_STATE_SETTLED;
}

/* pupil_stats_excess between these shares of the light, from its bright end. */
static double brightest_excess(const pupil_stats *stats, double least, double most, double from_log2, double most_ev)
{
    return pupil_stats_excess(stats, pupil_stats_share_of_light(stats, 1.0 - most),
                              pupil_stats_share_of_light(stats, 1.0 - least), from_log2, most_ev);
}

/* By how much the level is to be above the log-average, so that the bright part of the frame is not pale and no large
 * part of it white. Means over shares, not quantiles, so that a lamp which becomes a little larger cannot make the
 * level jump. */
static double held_back_ev(const pupil_config *c, const pupil_stats *stats, double mean_log2)
{
    if (!stats->has_histogram || !(c->highlight_ev > 0.0))
        return 0.0;
    const double pale =
        brightest_excess(stats, HIGHLIGHT_LEAST * c->highlight_share, HIGHLIGHT_MOST * c->highlight_share,
                         mean_log2 + c->highlight_room_ev, c->highlight_ev);
    const double white = brightest_excess(stats, WHITE_LEAST, WHITE_MOST, mean_log2 + WHITE_ROOM_EV, c->highlight_ev);
    return pale > white ? pale : white;
}

double pupil_least_level_log2(const pupil_config *c, float code_light)
{
    if (!(code_light > 0.0f))
        return -1e3; /* below any */
    const double finer_ev = FULL_CODE_EV - pupil_log2((double)code_light);
    return MID_GREY_EV - c->amplification_ev - (finer_ev > 0.0 ? finer_ev : 0.0);
}

/* Everything that can be refused, before anything is touched. */
static int targets_of(const pupil_object *object, const pupil_stats *stats, double *mean_log2, double *white_log2)
{
    const pupil_config *c = &object->config;
    int error = pupil_stats_check(stats);
    if (error || !stats->weight)
        return error;
    if (stats->has_histogram && !pupil_stats_are_counted(stats))
        return PUPIL_ERR_STATS; /* of some rows only, none of which is counted */
    error = pupil_stats_light_mean(stats, pupil_log2((double)c->floor), (double)c->trim_low, (double)c->trim_high,
                                   mean_log2);
    if (!error && c->white_mode == PUPIL_WHITE_FOLLOW)
        error = pupil_stats_peak_quantile(stats, pupil_stats_share_of_light(stats, c->white_quantile), white_log2);
    if (!error && c->curve != PUPIL_CURVE_REINHARD && !stats->has_histogram)
        error = PUPIL_ERR_NO_HISTOGRAM;
    return error;
}

/* The level that this frame asks for, and why it is not the log-average. */
static double target_of(pupil_object *object, const pupil_stats *stats, double mean_log2, double divisor_log2,
                        const pupil_frame_info *info, uint32_t *reason)
{
    const pupil_config *c = &object->config;
    pupil_exposure *r = &object->adaptation.result;
    r->metered_ev = stops_of(pupil_level_of(mean_log2 - divisor_log2));
    r->flicker_ev = 0.0;
    if (c->flicker) {
        pupil_flicker *f = &object->adaptation.flicker;
        pupil_flicker_frame(f, r->metered_ev, info->exposure_s, info->timestamp_ns);
        r->flicker_ev = pupil_flicker_at(f, info->timestamp_ns);
    }
    double target_ev = r->metered_ev - r->flicker_ev + r->held_back_ev;
    const double least_ev = pupil_least_level_log2(c, stats->code_light) - divisor_log2;
    const int too_dark = target_ev < least_ev - SETTLED_EV;
    target_ev = target_ev < least_ev ? least_ev : target_ev;
    if (target_ev < c->ev_min || target_ev > c->ev_max)
        *reason = target_ev < c->ev_min ? PUPIL_REASON_EV_MIN : PUPIL_REASON_EV_MAX;
    else if (too_dark)
        *reason = PUPIL_REASON_AMPLIFICATION;
    else if (*reason == PUPIL_REASON_NONE && (stats->black > stats->pixels / 2 || mean_log2 > MOST_MEAN_EV))
        *reason = PUPIL_REASON_RANGE;
    else if (*reason == PUPIL_REASON_NONE && r->held_back_ev > SETTLED_EV)
        *reason = PUPIL_REASON_HIGHLIGHTS;
    else if (*reason == PUPIL_REASON_NONE && !stats->has_histogram && c->highlight_ev > 0.0)
        *reason = PUPIL_REASON_NO_HISTOGRAM;
    return clamp(target_ev, c->ev_min, c->ev_max);
}

int pupil_adapt(pupil_t *pupil, const pupil_stats *stats, const pupil_frame_info *info)
{
    pupil_frame_info own;
    double mean = 0.0, white = 0.0;
    int error = pupil_object_check(pupil);
    if (error)
        return error;
    if (!stats)
        return PUPIL_ERR_NULL;
    pupil_object *object = pupil_object_of(pupil);
    error = targets_of(object, stats, &mean, &white);
    if (!error)
        error = pupil_info_read(&own, info);
    if (error)
        return error;

    pupil_adaptation *a = &object->adaptation;
    const pupil_config *c = &object->config;
    info = &own;
    const int is_timed = a->stamped && (info->timestamp_ns || a->last_timestamp_ns);
    double dt_s = pupil_adaptation_tick(c, a, info);
    uint32_t reason = clock_reason(is_timed, dt_s);
    dt_s = dt_s > 0.0 ? dt_s : 0.0;
    a->turn++;
    a->result.dt_s = dt_s;
    if (!stats->weight) {
        a->result.reason = PUPIL_REASON_NO_LIGHT;
        return PUPIL_OK;
    }
    pupil_adaptation_learn_exposure(a, info);
    const double divisor_log2 = pupil_exposure_log2(c, a, info);
    a->result.held_back_ev = held_back_ev(c, stats, mean);
    const double target_ev = target_of(object, stats, mean, divisor_log2, info, &reason);
    if (c->lock && a->seen) {
        reason = PUPIL_REASON_LOCK;
    } else {
        const double white_ev = white - divisor_log2 - a->result.flicker_ev;
        if (c->white_mode == PUPIL_WHITE_FOLLOW)
            move_white(object, pupil_level_of(white_ev), dt_s);
        if (c->curve != PUPIL_CURVE_REINHARD)
            move_knots(object, stats, target_ev, white_ev, divisor_log2, dt_s);
        move_level(object, pupil_level_of(target_ev), dt_s);
        a->seen = 1;
    }
    a->result.scale = pupil_exp2(pupil_scale_log2(c, a->result.adapted_ev));
    a->result.frames++;
    judge(object, target_ev, reason);
    return PUPIL_OK;
}

int pupil_get_exposure_sized(const pupil_t *pupil, pupil_exposure *exposure, size_t exposure_bytes)
{
    const int error = exposure ? pupil_object_check(pupil) : PUPIL_ERR_NULL;
    if (error)
        return error;
    const pupil_exposure *result = &pupil_object_of_const(pupil)->adaptation.result;
    return pupil_versioned_write(exposure, exposure_bytes, result, sizeof *result);
}
