/* The search for a setting on a camera that responds otherwise than its numbers say. Because more never makes the
 * picture darker, the wanted effect is between a point that was seen below it and one above it. One control moves, the
 * other one is pinned. */
#include "sensor_private.h"

#include "base/numeric.h"

void pupil_sensor_forget_points(sensor_search *s)
{
    __builtin_memset(s->point, 0, sizeof s->point);
}

/* Remembers the requested setting and its effect. Points that contradict it are outdated, because more never makes the
 * picture darker. */
void pupil_sensor_remember(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const sensor_point now = {
        .total = s->set, .setting = {a->requested[0], a->requested[1]}, .effect = a->effect, .is_used = 1};
    sensor_point *place = 0;
    for (sensor_point *p = s->point; p < s->point + SENSOR_POINTS; p++) {
        const int is_same = p->setting[0] == now.setting[0] && p->setting[1] == now.setting[1];
        const double more = p->setting[0] + p->setting[1] - now.setting[0] - now.setting[1];
        if (p->is_used && !is_same &&
            (more > 0.0 ? p->effect < now.effect - SENSOR_UNEXPLAINED_EV
                        : p->effect > now.effect + SENSOR_UNEXPLAINED_EV))
            p->is_used = 0;
        if (p->is_used && is_same)
            place = p;
    }
    if (!place) {
        place = &s->point[s->next];
        s->next = (s->next + 1) % SENSOR_POINTS;
    }
    *place = now;
}

static double sum_of(const sensor_point *p)
{
    return p->setting[0] + p->setting[1];
}

/* The brightest setting of those that were too dark, and the darkest of those that were not: compared by setting,
 * because noise decides which of two equal effects is larger. */
static void surround(const pupil_sensor_object *o, const sensor_point **low, const sensor_point **high)
{
    *low = *high = 0;
    for (const sensor_point *p = o->search.point; p < o->search.point + SENSOR_POINTS; p++) {
        if (p->is_used && p->effect < o->plan.wanted && (!*low || sum_of(p) > sum_of(*low)))
            *low = p;
        if (p->is_used && p->effect >= o->plan.wanted && (!*high || sum_of(p) < sum_of(*high)))
            *high = p;
    }
}

/* Stops over which settings, up to this one or from it on, all have its effect. */
static double flat_ev(const pupil_sensor_object *o, const sensor_point *from)
{
    double widest = 0.0;
    for (const sensor_point *p = o->search.point; p < o->search.point + SENSOR_POINTS; p++) {
        const double width = size_of(sum_of(p) - sum_of(from));
        if (p->is_used && size_of(p->effect - from->effect) < SENSOR_UNEXPLAINED_EV && width > widest)
            widest = width;
    }
    return widest;
}

/* Whether a control has `need` stops left from a setting on, up to the largest gain that the camera has. */
static int has_room(const pupil_sensor_object *o, int control, const double setting[SENSOR_CONTROLS], double need)
{
    const pupil_sensor_config *c = &o->config;
    const double to = setting[control] + need;
    const double least = control == SENSOR_GAIN ? c->gain_min : c->exposure_min_s;
    const double most =
        control == SENSOR_GAIN ? pupil_sensor_gain_of(c, c->gain_max) : pupil_sensor_longest_exposure(c);
    const uint32_t mode = control == SENSOR_GAIN ? c->gain_mode : c->exposure_mode;
    return mode == PUPIL_SENSOR_AUTO && to <= pupil_log2(most) && to >= pupil_log2(least);
}

/* ... so many stops of the picture, by its response: a control that does nothing does not replace another. */
static int may_do(const pupil_sensor_object *o, int control, const double setting[SENSOR_CONTROLS], double need)
{
    return has_room(o, control, setting, need / o->estimate.response[control]);
}

/* From here on only one control moves, so that more of it never makes the picture darker. */
static void move_only(pupil_sensor_object *o, int control, const double setting[SENSOR_CONTROLS])
{
    sensor_search *s = &o->search;
    const int other = SENSOR_CONTROLS - 1 - control;
    s->is_pinned[control] = 0;
    s->is_pinned[other] = 1;
    s->pinned[other] = setting[other];
    s->mover = (uint32_t)control;
    s->pinned_frames = 0;
    s->rest_wanted = o->plan.wanted;
    pupil_sensor_forget_points(s);
}

/* The other control does the rest, from a setting on, if it can and the mover has not changed too often. */
static int hand_over(pupil_sensor_object *o, int control, const double setting[SENSOR_CONTROLS], double need)
{
    if (o->search.swaps >= SENSOR_SWAPS || !may_do(o, control, setting, need))
        return 0;
    move_only(o, control, setting);
    o->search.swaps++;
    return 1;
}

double pupil_sensor_doubt_ev(const pupil_sensor_object *o)
{
    return o->plan.held_back_ev > SENSOR_SETTLED_EV ? SENSOR_HIGHLIGHT_DOUBT_EV : 0.0;
}

/* A setting that lacks only this is not worth a search: the digital factor does the rest. Where the aim is out of
 * reach, the setting goes to the limit. */
static int is_near(const pupil_sensor_object *o, double need)
{
    const double doubted_ev = SENSOR_OFF_EV + pupil_sensor_doubt_ev(o);
    const double most_ev = larger(doubted_ev, SENSOR_MISMATCH_EV);
    return size_of(need) <= most_ev && o->plan.beyond == 0.0;
}

/* The search ends at this total, whose setting lacks `need`. */
static double rest_at(pupil_sensor_object *o, double total, double need)
{
    sensor_search *s = &o->search;
    s->is_resting = 1;
    s->rest_wanted = o->plan.wanted;
    s->rest_ev = size_of(need);
    s->step_ev = 0.0;
    return total;
}

/* The camera did not respond as it should. The gain moves first: its steps are finer than those of exposures under
 * lamps, and it is in force sooner. */
void pupil_sensor_begin_search(pupil_sensor_object *o, double need)
{
    sensor_search *s = &o->search;
    const double *requested = o->estimate.requested;
    if (is_near(o, need)) {
        if (size_of(need) > SENSOR_OFF_EV) /* one more such step would do no better */
            (void)rest_at(o, s->set, need);
        return;
    }
    s->is_searching = 1;
    s->swaps = 0;
    const int may_gain = may_do(o, SENSOR_GAIN, requested, need),
              has_both = may_gain || may_do(o, SENSOR_EXPOSURE, requested, need);
    if (has_both ? may_gain : has_room(o, SENSOR_GAIN, requested, need))
        move_only(o, SENSOR_GAIN, requested);
    else if (has_room(o, SENSOR_EXPOSURE, requested, need))
        move_only(o, SENSOR_EXPOSURE, requested);
    pupil_sensor_remember(o);
}

/* The control that moves has no setting between two points: it stays at one of them, and the other control does the
 * rest. Returns whether that one can. */
static int swap(pupil_sensor_object *o, const sensor_point *low, const sensor_point *high)
{
    sensor_search *s = &o->search;
    const double wanted = o->plan.wanted;
    const int is_one = s->is_pinned[0] != s->is_pinned[1];
    const int coarse = size_of(high->setting[0] - low->setting[0]) > size_of(high->setting[1] - low->setting[1])
                           ? SENSOR_EXPOSURE
                           : SENSOR_GAIN;
    const int other = SENSOR_CONTROLS - 1 - (is_one ? (int)s->mover : coarse);
    const double from_low = sum_of(low) + wanted - low->effect, from_high = sum_of(high) + wanted - high->effect;
    if (hand_over(o, other, low->setting, wanted - low->effect))
        s->total = from_low;
    else if (hand_over(o, other, high->setting, wanted - high->effect))
        s->total = from_high;
    else
        return 0;
    return 1;
}

/* There is a jump between two points whose effects differ by more than any tone curve makes of their settings. */
static int is_jump(const sensor_point *low, const sensor_point *high)
{
    return high->effect - low->effect > SENSOR_STEEP_MOST * (sum_of(high) - sum_of(low));
}

/* There is nothing between two points if the total to be tried has the setting of one of them. */
static int is_closed(const pupil_sensor_object *o, const sensor_point *low, const sensor_point *high, double middle)
{
    double setting[SENSOR_CONTROLS];
    (void)pupil_sensor_effect_of(o, middle, setting);
    const int is_low = setting[0] == low->setting[0] && setting[1] == low->setting[1];
    const int is_high = setting[0] == high->setting[0] && setting[1] == high->setting[1];
    return high->total - low->total <= SENSOR_GAP_EV || is_low || is_high;
}

/* Between the points that were seen: by the slope, or in the middle where one of them is the end of settings that all
 * do the same. If nothing is left between them, the search ends at the nearer one. */
static double narrow(pupil_sensor_object *o, const sensor_point *low, const sensor_point *high)
{
    sensor_search *s = &o->search;
    const double gap = high->total - low->total, wanted = o->plan.wanted, step_ev = high->effect - low->effect;
    const double share = (wanted - low->effect) / step_ev;
    const int is_flat = flat_ev(o, low) > SENSOR_GAP_EV || flat_ev(o, high) > SENSOR_GAP_EV;
    const double middle = low->total + gap * (is_flat ? 0.5 : clamp(share, SENSOR_NARROW, 1.0 - SENSOR_NARROW));
    const int is_end = is_closed(o, low, high, middle);
    if ((is_end || is_jump(low, high)) && swap(o, low, high))
        return s->total;
    if (!is_end)
        return middle;
    const sensor_point *near = wanted - low->effect < high->effect - wanted ? low : high;
    (void)rest_at(o, near->total, wanted - near->effect);
    s->step_ev = step_ev <= SENSOR_COARSE_STEP_EV + SENSOR_SAME_EV ? step_ev : 0.0;
    return near->total;
}

/* All points are on one side: further by what is wanted; if settings did nothing, by at least the width of their
 * range. */
static double widen(const pupil_sensor_object *o, const sensor_point *from, double total)
{
    const double flat = flat_ev(o, from), step = total - from->total;
    if (flat < SENSOR_GAP_EV)
        return total;
    const double least = larger(flat, SENSOR_WRONG_EV);
    return size_of(step) > least ? total : from->total + (o->plan.wanted > from->effect ? least : -least);
}

static int is_requested(const pupil_sensor_object *o, double total)
{
    double setting[SENSOR_CONTROLS];
    (void)pupil_sensor_effect_of(o, total, setting);
    return setting[0] == o->estimate.requested[0] && setting[1] == o->estimate.requested[1];
}

/* The control that moves has no better setting than the requested one: the other control does the rest, or the search
 * ends here. */
static double leave(pupil_sensor_object *o, double need)
{
    sensor_search *s = &o->search;
    const double *requested = o->estimate.requested;
    const int is_one = s->is_pinned[0] != s->is_pinned[1], other = SENSOR_CONTROLS - 1 - (int)s->mover;
    if (is_one && hand_over(o, other, requested, need))
        return requested[0] + requested[1] + need;
    return rest_at(o, s->set, need);
}

/* The control that moves is at its end. */
static int is_at_end(const pupil_sensor_object *o, double need)
{
    return is_requested(o, need < 0.0 ? -SENSOR_TOTAL_END_EV : SENSOR_TOTAL_END_EV) ||
           !has_room(o, (int)o->search.mover, o->estimate.requested, need);
}

/* Decides whether a search continues, and with which control. `need` is what the requested setting lacks. */
void pupil_sensor_search_on(pupil_sensor_object *o, double need)
{
    sensor_search *s = &o->search;
    const double other_light = size_of(o->plan.wanted - s->rest_wanted);
    /* highlights may differ at each of two settings: the nearer setting stays */
    const double other_ev = SENSOR_OFF_EV + (size_of(need) <= 0.5 * s->step_ev ? pupil_sensor_doubt_ev(o) : 0.0);
    /* a search that ended within the promise continues when the error exceeds it */
    const double rest_ev = SENSOR_WRONG_EV + (s->rest_ev > SENSOR_WRONG_EV ? s->rest_ev : 0.0);
    s->is_resting &= other_light <= other_ev && size_of(need) <= rest_ev && o->plan.beyond == 0.0;
    s->pinned_frames += s->pinned_frames < SENSOR_PINNED_FRAMES;
    if (s->pinned_frames >= SENSOR_PINNED_FRAMES && other_light > SENSOR_UNPIN_EV)
        s->is_pinned[0] = s->is_pinned[1] = 0;
    s->is_searching &= size_of(need) > SENSOR_OFF_EV || s->is_resting;
    if (s->is_pinned[0] == s->is_pinned[1])
        return;
    const int other = SENSOR_CONTROLS - 1 - (int)s->mover;
    if (s->unanswered > 1 && hand_over(o, other, o->estimate.requested, need)) {
        s->unanswered = 0; /* the control that moves does nothing */
    } else if (!s->is_resting && size_of(need) > SENSOR_OFF_EV && is_at_end(o, need)) {
        s->is_pinned[0] = s->is_pinned[1] = 0;
        pupil_sensor_forget_points(s);
    }
}

double pupil_sensor_search_at(pupil_sensor_object *o, double total, double need)
{
    sensor_search *s = &o->search;
    const sensor_point *low, *high;
    if (!s->is_searching)
        return total;
    if (is_near(o, need))
        return rest_at(o, s->set, need);
    surround(o, &low, &high);
    double at = total;
    if (low && high)
        at = narrow(o, low, high);
    else if (low || high)
        at = widen(o, low ? low : high, total);
    return !s->is_resting && is_requested(o, at) ? leave(o, need) : at;
}
