/* The search for a setting on a camera that responds otherwise than its numbers say. Because more never makes the
 * picture darker, the wanted effect is between two ends: the brightest setting that was too dark, and the darkest that
 * was not. One control moves, the other one is pinned. What a search has found holds until the light changes. */
#include "sensor_private.h"

#include "base/numeric.h"

void pupil_sensor_forget_ends(sensor_search *s)
{
    s->low.is_seen = s->high.is_seen = s->is_half = 0;
}

static double sum_of(const sensor_seen *p)
{
    return p->setting[0] + p->setting[1];
}

/* The wanted effect may have moved beyond an end, which is then the other one. */
static void turn_ends(sensor_search *s, double wanted)
{
    if (s->low.is_seen && s->low.effect >= wanted) {
        s->high = s->low;
        s->low.is_seen = 0;
    } else if (s->high.is_seen && s->high.effect < wanted) {
        s->low = s->high;
        s->high.is_seen = 0;
    }
}

/* If a setting has another effect now, it came later than expected, and what was seen was the setting before. */
static void check_end(sensor_seen *end, const sensor_estimate *a)
{
    if (end->setting[0] == a->in_force[0] && end->setting[1] == a->in_force[1] &&
        size_of(end->effect - a->effect) > SENSOR_WRONG_EV)
        end->is_seen = 0;
}

/* The requested setting is in force: it is the new end on its side. More never makes the picture darker: an end that
 * contradicts it is void. */
static void remember_requested(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const sensor_seen now = {
        .total = s->set, .setting = {a->requested[0], a->requested[1]}, .effect = a->effect, .is_seen = 1};
    const int is_dark = now.effect < o->plan.wanted;
    turn_ends(s, o->plan.wanted);
    *(is_dark ? &s->low : &s->high) = now;
    if (s->low.is_seen && s->high.is_seen && sum_of(&s->low) >= sum_of(&s->high))
        (is_dark ? &s->high : &s->low)->is_seen = 0;
}

void pupil_sensor_remember(pupil_sensor_object *o)
{
    if (!pupil_sensor_is_on_its_way(o)) {
        remember_requested(o);
        return;
    }
    check_end(&o->search.low, &o->estimate);
    check_end(&o->search.high, &o->estimate);
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
    s->rest_wanted = o->plan.wanted;
    pupil_sensor_forget_ends(s);
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

/* The other control did nothing: back to the two neighbouring settings between which the search was when it took over.
 * The nearer one is the best that the camera has. */
static int return_to_pair(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const sensor_seen *low = &s->pair[0], *high = &s->pair[1];
    if (!low->is_seen || low->effect >= o->plan.wanted || high->effect < o->plan.wanted)
        return 0;
    move_only(o, (int)s->pair_mover, low->setting);
    s->low = *low;
    s->high = *high;
    s->swaps = SENSOR_SWAPS;
    s->pair[0].is_seen = 0;
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
    s->swaps = s->pair[0].is_seen = 0;
    const int may_gain = may_do(o, SENSOR_GAIN, requested, need),
              has_both = may_gain || may_do(o, SENSOR_EXPOSURE, requested, need);
    if (has_both ? may_gain : has_room(o, SENSOR_GAIN, requested, need))
        move_only(o, SENSOR_GAIN, requested);
    else if (has_room(o, SENSOR_EXPOSURE, requested, need))
        move_only(o, SENSOR_EXPOSURE, requested);
    pupil_sensor_remember(o);
}

/* The control that moves has no setting between the ends: it stays at one of them, and the other control does the
 * rest. Returns whether that one can. */
static int swap(pupil_sensor_object *o, const sensor_seen *low, const sensor_seen *high)
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
    s->pair_mover = SENSOR_CONTROLS - 1 - (uint32_t)other;
    s->pair[0] = *low;
    s->pair[1] = *high;
    return 1;
}

/* There is a jump between two ends whose effects differ by more than any tone curve makes of their settings. */
static int is_jump(const sensor_seen *low, const sensor_seen *high)
{
    return high->effect - low->effect > SENSOR_STEEP_MOST * (sum_of(high) - sum_of(low));
}

/* Whether there is a setting between the two at this share of the way; its total. */
static int is_between(const pupil_sensor_object *o, const sensor_seen *low, const sensor_seen *high, double share,
                      double *total)
{
    double setting[SENSOR_CONTROLS];
    const double gap = high->total - low->total;
    *total = low->total + gap * share;
    (void)pupil_sensor_effect_of(o, *total, setting);
    const int is_low = setting[0] == low->setting[0] && setting[1] == low->setting[1];
    const int is_high = setting[0] == high->setting[0] && setting[1] == high->setting[1];
    return gap > SENSOR_GAP_EV && !is_low && !is_high;
}

/* Between the ends: by turns by the slope and in the middle, so that any camera's gap is halved in two steps. If
 * nothing is left between them, the search ends at the nearer one. */
static double narrow(pupil_sensor_object *o, const sensor_seen *low, const sensor_seen *high)
{
    sensor_search *s = &o->search;
    const double wanted = o->plan.wanted, step_ev = high->effect - low->effect;
    const double slope = clamp((wanted - low->effect) / step_ev, SENSOR_NARROW, 1.0 - SENSOR_NARROW);
    double total;
    const double share = s->is_half ? 0.5 : slope;
    const int is_open = is_between(o, low, high, share, &total) || is_between(o, low, high, 0.5, &total);
    s->is_half = !s->is_half;
    if ((!is_open || is_jump(low, high)) && swap(o, low, high))
        return s->total;
    if (is_open)
        return total;
    const sensor_seen *near = wanted - low->effect < high->effect - wanted ? low : high;
    (void)rest_at(o, near->total, wanted - near->effect);
    /* a larger step may be a setting that came late: it has to be seen twice */
    s->step_ev = step_ev <= (s->wrong_times ? 2.0 : 1.0) * SENSOR_COARSE_STEP_EV + SENSOR_SAME_EV ? step_ev : 0.0;
    return near->total;
}

/* One end is not known: further by what is wanted; if the last step did nothing, by at least twice as much. */
static double widen(const pupil_sensor_object *o, double total, double need)
{
    const sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const double step_ev = size_of(a->requested[0] + a->requested[1] - s->from[0] - s->from[1]);
    if (size_of(a->effect - s->effect_from) >= SENSOR_UNEXPLAINED_EV)
        return total;
    const double least = larger(2.0 * step_ev, SENSOR_WRONG_EV);
    return size_of(total - s->set) > least ? total : s->set + (need > 0.0 ? least : -least);
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
    if (return_to_pair(o))
        return narrow(o, &s->low, &s->high);
    if (is_one && hand_over(o, other, requested, need))
        return requested[0] + requested[1] + need;
    return rest_at(o, s->set, need);
}

/* The control that moves is at its end, and has not been further than what is wanted. */
static int is_at_end(const pupil_sensor_object *o, double need)
{
    const int has_ends = o->search.low.is_seen && o->search.high.is_seen;
    return !has_ends && (is_requested(o, need < 0.0 ? -SENSOR_TOTAL_END_EV : SENSOR_TOTAL_END_EV) ||
                         !has_room(o, (int)o->search.mover, o->estimate.requested, need));
}

/* The control that moves did nothing in two steps: the other one does the rest. A gain is left where the profile has
 * it, so that it adds no noise. */
static int replace_mover(pupil_sensor_object *o, double need)
{
    const int other = SENSOR_CONTROLS - 1 - (int)o->search.mover;
    double setting[SENSOR_CONTROLS] = {o->estimate.requested[0], o->estimate.requested[1]}, e, g;
    if (o->search.unanswered < 2)
        return 0;
    if (return_to_pair(o))
        return 1;
    pupil_sensor_split_freely(o, setting[0] + setting[1], &e, &g);
    if (other == SENSOR_EXPOSURE)
        setting[SENSOR_GAIN] = pupil_log2(g);
    return hand_over(o, other, setting, need);
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
    if (other_light > SENSOR_UNPIN_EV)
        s->is_pinned[0] = s->is_pinned[1] = 0;
    s->is_searching &= size_of(need) > SENSOR_OFF_EV || s->is_resting;
    if (s->is_pinned[0] == s->is_pinned[1])
        return;
    if (replace_mover(o, need)) {
        s->unanswered = 0;
    } else if (!s->is_resting && size_of(need) > SENSOR_OFF_EV && is_at_end(o, need) && !return_to_pair(o)) {
        s->is_pinned[0] = s->is_pinned[1] = 0;
        pupil_sensor_forget_ends(s);
    }
}

double pupil_sensor_search_at(pupil_sensor_object *o, double total, double need)
{
    sensor_search *s = &o->search;
    if (!s->is_searching)
        return total;
    if (is_near(o, need))
        return rest_at(o, s->set, need);
    const sensor_seen low = s->low, high = s->high;
    const double at = low.is_seen && high.is_seen ? narrow(o, &low, &high) : widen(o, total, need);
    return !s->is_resting && is_requested(o, at) ? leave(o, need) : at;
}
