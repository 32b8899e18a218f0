/* Which setting gives the wanted picture, and whether it is asked for now: at once on a camera that responds as its
 * numbers say; otherwise it is searched. */
#include "sensor_private.h"

#include "base/numeric.h"

/* The setting is kept while it lacks no more than this. In light that has been still for long, a picture that is
 * right is left alone: the digital factor does the rest. */
static double hold_of(const pupil_sensor_object *o)
{
    const double hold_ev = o->config.hold_ev;
    const int is_calm = o->search.since >= SENSOR_RING && o->plan.near_frames >= SENSOR_HIGHLIGHT_FRAMES;
    return is_calm ? larger(hold_ev, SENSOR_COARSE_EV) : hold_ev;
}

/* Whether a part of an exchange would move one control only, by less than a setting is changed for. */
static int is_kept(const pupil_sensor_object *o, const double part[SENSOR_CONTROLS])
{
    const double *now = o->estimate.requested;
    return (part[0] == now[0] || part[1] == now[1]) && size_of(part[0] + part[1] - now[0] - now[1]) <= hold_of(o);
}

static void ask(pupil_sensor_object *o, double total, int may_be_a_part)
{
    sensor_search *s = &o->search;
    sensor_estimate *a = &o->estimate;
    double setting[SENSOR_CONTROLS], e, g;
    const double asked = pupil_sensor_effect_asked(o);
    (void)pupil_sensor_effect_of(o, total, setting);
    pupil_sensor_split(o, total, &e, &g);
    double part[SENSOR_CONTROLS] = {setting[0], setting[1]}, part_e, part_g;
    s->is_exchanging = may_be_a_part && pupil_sensor_is_part_of_exchange(o, total, part, &part_e, &part_g);
    if (s->is_exchanging && is_kept(o, part))
        return;
    if (s->is_exchanging) {
        e = part_e;
        g = part_g;
        setting[0] = part[0];
        setting[1] = part[1];
    }
    s->set = total;
    if (e == o->setting.exposure_s && g == o->setting.gain)
        return;
    if (!a->has_frame) /* it counts as in force in the first frame */
        a->effect += pupil_sensor_effect(a, a->requested, setting);
    const double moves = size_of(setting[0] - a->requested[0]) + size_of(setting[1] - a->requested[1]);
    if ((moves > SENSOR_LARGE_EV || s->is_searching) && a->has_frame) {
        s->is_large = 1;
        s->effect_from = asked;
        for (int c = 0; c < SENSOR_CONTROLS; c++) {
            s->from[c] = a->requested[c];
            o->told.said_before[c] = a->said[c];
        }
    }
    s->since = s->looks = a->has_frame ? 0 : SENSOR_RING;
    for (int c = 0; c < SENSOR_CONTROLS; c++)
        a->requested[c] = setting[c];
    o->setting.exposure_s = e;
    o->setting.gain = g;
    o->setting.changed = 1;
}

static void report_total(pupil_sensor_object *o)
{
    pupil_sensor_setting *t = &o->setting;
    t->total_s = pupil_exp2(o->search.total);
    t->digital = t->total_s / (t->exposure_s * t->gain);
    t->limits = pupil_sensor_limits(o);
}

/* Counts a frame. In another light some of what was seen is no longer valid. */
void pupil_sensor_count_frame(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    s->since = s->since + a->gap < SENSOR_NOISY_FRAMES ? s->since + a->gap : SENSOR_NOISY_FRAMES;
    s->looks += s->looks < SENSOR_RING;
    if (o->setting.frames == 1 && (a->in_force[0] != a->requested[0] || a->in_force[1] != a->requested[1]))
        s->since = s->looks = 0; /* the camera began with another setting than it was asked for */
    if (size_of(o->plan.wanted - s->blunt_wanted) > SENSOR_WRONG_EV) {
        s->is_blunt = s->swaps = s->is_restored = 0;
        s->blunt_wanted = o->plan.wanted;
    }
}

/* Whether the setting should change: not by much more than this frame asks for, and not if it asks for the opposite. */
static int is_due(pupil_sensor_object *o, double need, double left)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const double error = o->plan.goal - a->effect, large_ev = SENSOR_LARGE_EV, hold_ev = hold_of(o);
    const int is_opposite = need * error < 0.0 && size_of(error) > o->config.far_ev;
    const int is_backward = is_opposite || (size_of(need) > large_ev && size_of(error) < 0.5 * size_of(need));
    /* if the camera does not do small steps, the digital factor does them */
    if (a->unexplained != 0.0) {
        s->is_blunt = 1;
        s->blunt_wanted = o->plan.wanted;
    }
    const int is_as_chosen = size_of(need - left) <= hold_ev && size_of(left) < SENSOR_COARSE_EV;
    const int is_held = size_of(need) <= hold_ev || is_as_chosen;
    const int is_small = s->is_blunt ? size_of(need) <= large_ev : is_held;
    return !s->is_resting && !is_backward && (!is_small || o->plan.beyond != 0.0 || s->is_exchanging);
}

/* Whether much of one control would be exchanged for the other to gain little: an exchange may miss by as much. */
static int is_much_for_little(const pupil_sensor_object *o, const double setting[SENSOR_CONTROLS], double need)
{
    const double *now = o->estimate.requested;
    const double move[SENSOR_CONTROLS] = {setting[0] - now[0], setting[1] - now[1]};
    const int is_much = size_of(move[0]) > SENSOR_LARGE_EV && size_of(move[1]) > SENSOR_LARGE_EV;
    return is_much && move[0] * move[1] < 0.0 && size_of(need) <= SENSOR_MISMATCH_EV;
}

/* The present setting is near, and another one is not worth an exchange. */
static int is_left_alone(const pupil_sensor_object *o, double total, double need)
{
    double setting[SENSOR_CONTROLS];
    const int is_near = size_of(need) < SENSOR_UNPIN_EV && o->plan.beyond == 0.0;
    (void)pupil_sensor_effect_of(o, total, setting);
    return is_near && !o->search.is_exchanging && !o->search.is_searching && is_much_for_little(o, setting, need);
}

/* Whether a setting far from the profile has held back highlights for long: more gain makes more noise, and noise
 * counts as highlights. In each light the profile is tried again once. */
static int is_noisy(const pupil_sensor_object *o)
{
    const sensor_search *s = &o->search;
    double e, g;
    if (s->is_restored || s->since < SENSOR_NOISY_FRAMES || o->plan.held_back_ev < SENSOR_SETTLED_EV ||
        o->estimate.noise_ev < SENSOR_CALM_EV)
        return 0;
    pupil_sensor_split_freely(o, o->estimate.requested[0] + o->estimate.requested[1], &e, &g);
    return pupil_log2(o->setting.gain / g) > 2.0 * SENSOR_EXCHANGE_EV;
}

static void choose(pupil_sensor_object *o, const sensor_evidence *v, double need, double left)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const int is_unknown = !o->config.linear && !a->learned && size_of(need) > SENSOR_STEP_EV;
    const double most = size_of(need) * (double)(2u << (s->unanswered - (s->unanswered > 1))) + size_of(left),
                 back = smaller(size_of(left), most), requested = a->requested[0] + a->requested[1];
    double total = pupil_sensor_total_for(o, is_unknown ? 0.5 * need : need);
    total = clamp(total, requested - (need < 0.0 ? most : back), requested + (need > 0.0 ? most : back));
    if (is_left_alone(o, total, need))
        return;
    s->total = pupil_sensor_search_at(o, total, need);
    ask(o, s->total, 1);
    if (!s->since) { /* a step was asked for: keep how the picture was before */
        o->white.top = v->spike > 0.0 ? v->top : SENSOR_FAR_AWAY;
        pupil_sensor_black_before(o, v);
    }
}

/* A step larger than any camera rounds should be in force, but the metadata, which are true, did not move: the write
 * was lost, or the control does nothing. It is written again. */
static void write_lost_again(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    int is_lost = 0;
    if (!s->is_large || !a->reports || !a->is_borne_out || pupil_sensor_is_on_its_way(o))
        return;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        const int has_moved = a->said[c] != o->told.said_before[c];
        const int is_far = size_of(a->requested[c] - s->from[c]) > SENSOR_COARSE_STEP_EV + SENSOR_SAME_EV;
        s->lost[c] = has_moved ? 0 : s->lost[c] + (is_far && s->lost[c] <= SENSOR_LOST_TIMES);
        if (has_moved)
            return;
        is_lost |= is_far && s->lost[c] <= SENSOR_LOST_TIMES;
    }
    if (is_lost) {
        s->since = s->looks = 0;
        o->setting.changed = 1;
    }
}

void pupil_sensor_follow(pupil_sensor_object *o, const sensor_evidence *v)
{
    sensor_search *s = &o->search;
    write_lost_again(o);
    pupil_sensor_answer_frame(o, v);
    pupil_sensor_remember(o);
    const int is_still = o->config.lock || o->announced.frames;
    if (!is_still)
        pupil_sensor_watch_error(o);
    if (!is_still && !pupil_sensor_is_pending(o)) {
        const double left = pupil_sensor_left_of(s->set, o->estimate.requested);
        const double need = o->plan.wanted - pupil_sensor_effect_asked(o);
        if (is_noisy(o)) {
            s->is_searching = s->is_resting = s->is_pinned[0] = s->is_pinned[1] = 0;
            s->is_exchanging = s->is_restored = 1;
        }
        pupil_sensor_search_on(o, need);
        s->total = s->set + (s->is_searching ? 0.0 : need - left);
        if (is_due(o, need, left))
            choose(o, v, need, left);
    }
    o->estimate.is_searching = s->is_searching;
    report_total(o);
}

void pupil_sensor_move_to(pupil_sensor_object *o, double effect)
{
    sensor_search *s = &o->search;
    s->total = pupil_sensor_total_for(o, effect - pupil_sensor_effect_asked(o));
    ask(o, s->total, 0);
    s->is_large = 0;
    report_total(o);
}

/* Begins with a total, clamped to the limits of the current configuration. If both controls are held, what was rounded
 * is held, too. */
void pupil_sensor_begin(pupil_sensor_object *o, double total)
{
    sensor_search *s = &o->search;
    const pupil_sensor_config *c = &o->config;
    double least, most;
    s->is_pinned[0] = s->is_pinned[1] = s->is_searching = s->is_resting = 0;
    pupil_sensor_forget_ends(s);
    pupil_sensor_path_ends(o, &least, &most);
    const int is_held = c->exposure_mode == PUPIL_SENSOR_HELD && c->gain_mode == PUPIL_SENSOR_HELD;
    if (!(is_held && o->setting.frames && size_of(total - most) < 1.0))
        total = clamp(total, least, most);
    s->total = total;
    ask(o, total, 0);
    o->plan.wanted = pupil_sensor_effect_asked(o) + pupil_sensor_left_of(total, o->estimate.requested);
    report_total(o);
}
