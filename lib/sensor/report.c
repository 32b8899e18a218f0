/* State and reason of a frame. */
#include "sensor_private.h"

#include "base/numeric.h"

static const char *const state_names[] = {"empty", "searching", "converged", "limited", "clipped", "flicker", "locked"};
static const char *const reason_names[] = {
    "none",       "waiting",     "exposure_min", "exposure_max", "frame_period",  "gain_min",       "gain_max",
    "highlights", "below_mains", "lock",         "all_manual",   "invalid_frame", "repeated_frame", "clock_back",
    "flash",      "ignored",     "nonlinear",    "hunting",      "announced"};
static const char *const day_night_names[] = {"unknown", "day", "night"};

const char *pupil_sensor_state_name(uint32_t state)
{
    return state < sizeof state_names / sizeof state_names[0] ? state_names[state] : "unknown";
}

const char *pupil_sensor_reason_name(uint32_t reason)
{
    return reason < sizeof reason_names / sizeof reason_names[0] ? reason_names[reason] : "unknown";
}

const char *pupil_sensor_day_night_name(uint32_t day_night)
{
    return day_night_names[day_night < sizeof day_night_names / sizeof day_night_names[0] ? day_night : 0];
}

/* The camera ignores its settings: now, or in the steps toward what would otherwise be reported as a limit. */
static int is_ignored(const pupil_sensor_object *o)
{
    const sensor_search *s = &o->search;
    const int is_nearest = s->is_resting && s->step_ev > 0.0; /* a search has found no better setting */
    return (s->unanswered > 1 && !is_nearest && size_of(o->plan.wanted - o->estimate.effect) > SENSOR_WRONG_EV) ||
           (s->deaf > 1 && size_of(o->plan.beyond) > SENSOR_WRONG_EV);
}

/* What is shown or wanted is off. Of what is shown, that is not known beyond a limit. */
static int is_off(const pupil_sensor_object *o, const sensor_evidence *v)
{
    const sensor_plan *p = &o->plan;
    const double digital = pupil_log2(o->setting.frame_digital) + o->setting.flicker_ev;
    const double shown = v->mean + digital - (p->aim - p->held_back_ev);
    return size_of(o->setting.error_ev) > o->config.far_ev || (p->beyond == 0.0 && size_of(shown) > o->config.far_ev);
}

/* A camera that does not take its setting gets it again, because its own automatic may have come back on. */
static void write_again(pupil_sensor_object *o)
{
    const double dt_s = o->setting.dt_s, most_s = 0.5 * SENSOR_REWRITE_S; /* not in two frames in a row */
    o->rewrite_s += o->setting.changed ? 0.0 : smaller(dt_s, most_s);
    if (o->rewrite_s < SENSOR_REWRITE_S)
        return;
    o->rewrite_s = 0.0;
    o->setting.changed = 1;
}

/* Why the level is not what the key asks for, or is not reliable. */
static uint32_t reason_of(const pupil_sensor_object *o)
{
    const double slope = o->setting.slope;
    const int is_bent = o->config.linear && (slope < SENSOR_KNOWN_LEAST || slope > SENSOR_KNOWN_MOST);
    if (o->setting.reason)
        return o->setting.reason;
    if (o->plan.held_back_ev > SENSOR_SETTLED_EV)
        return PUPIL_SENSOR_HIGHLIGHTS;
    return o->black.value > 0.0 || is_bent ? PUPIL_SENSOR_NONLINEAR : PUPIL_SENSOR_NO_REASON;
}

static int is_below_mains(const pupil_sensor_object *o)
{
    const pupil_sensor_config *c = &o->config;
    return c->mains_hz > PUPIL_SENSOR_MAINS_AUTO &&
           o->setting.exposure_s < 0.5 / c->mains_hz * SENSOR_HALF_PERIOD - c->exposure_step_s;
}

void pupil_sensor_report(pupil_sensor_object *o, const sensor_evidence *v)
{
    pupil_sensor_setting *s = &o->setting;
    const pupil_sensor_config *c = &o->config;
    const int is_manual = c->exposure_mode != PUPIL_SENSOR_AUTO && c->gain_mode != PUPIL_SENSOR_AUTO;
    const int is_within = size_of(o->plan.beyond) <= SENSOR_SETTLED_EV;
    if (s->changed) /* the time since the last write begins again in any state */
        o->rewrite_s = 0.0;
    if (o->plan.slow == PUPIL_SENSOR_FLASH && !is_manual) { /* the state remains; but what is shown is off */
        s->reason = PUPIL_SENSOR_FLASH;
        s->state = s->state == PUPIL_SENSOR_CONVERGED ? PUPIL_SENSOR_SEARCHING : s->state;
        return;
    }
    s->reason = reason_of(o);
    s->state = PUPIL_SENSOR_CONVERGED;
    if (c->lock || is_manual) {
        s->state = PUPIL_SENSOR_LOCKED;
        s->reason = c->lock ? PUPIL_SENSOR_LOCK : PUPIL_SENSOR_ALL_MANUAL;
    } else if (is_ignored(o)) {
        s->state = PUPIL_SENSOR_LIMITED;
        s->reason = PUPIL_SENSOR_IGNORED;
        write_again(o);
    } else if (is_off(o, v) || (is_within && pupil_sensor_is_pending(o)) || o->announced.frames) {
        s->state = v->clipped_share > 0.5 ? PUPIL_SENSOR_CLIPPED : PUPIL_SENSOR_SEARCHING;
        s->reason = o->plan.slow ? o->plan.slow : s->reason;
    } else if (!is_within) { /* also while a step to the limit is on its way */
        s->state = PUPIL_SENSOR_LIMITED;
        s->reason = pupil_sensor_limit(o, o->plan.beyond > 0.0);
        if (size_of(o->plan.beyond) > SENSOR_WRONG_EV) /* at a limit, the camera's own automatic may be the cause */
            write_again(o);
    } else if (is_below_mains(o)) {
        s->state = PUPIL_SENSOR_FLICKER;
        s->reason = PUPIL_SENSOR_BELOW_MAINS;
    }
}
