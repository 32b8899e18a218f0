/* What a step did, once it is in force, and whether what was learned from steps is wrong. */
#include "sensor_private.h"

static void agree(pupil_sensor_object *o)
{
    for (int c = 0; c < SENSOR_CONTROLS; c++)
        o->search.agreed[c] = o->estimate.requested[c];
    o->search.agreed_effect = o->estimate.effect;
}

/* If a large error does not shrink, what was learned of the camera is wrong, and is doubted. */
void pupil_sensor_watch_error(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const double error = o->plan.wanted - o->estimate.effect, size = size_of(error);
    const double other_light = size_of(o->plan.wanted - s->wrong_wanted);
    const double half_ev = s->is_resting ? 0.5 * s->step_ev + SENSOR_SAME_EV : 0.0;
    const double right_ev = larger(half_ev, SENSOR_WRONG_EV) + pupil_sensor_doubt_ev(o);
    if (other_light > SENSOR_UNPIN_EV || (size < right_ev && !s->is_searching))
        s->wrong_times = 0;
    if (other_light > SENSOR_WRONG_EV) {
        s->wrong_wanted = o->plan.wanted;
        s->wrong_ev = SENSOR_FAR_AWAY;
    }
    if (size < right_ev || size < SENSOR_SHRINK * s->wrong_ev) {
        s->wrong_frames = 0;
        s->wrong_ev = size;
        return;
    }
    /* after a first doubt, or if the error is small, steps in flight are waited for: calm at rest */
    const int is_calm = s->wrong_times || size < SENSOR_UNPIN_EV;
    s->wrong_frames += pupil_sensor_is_pending(o) && is_calm ? 0 : o->estimate.gap;
    const uint32_t most = pupil_sensor_wait_frames(o) + (s->is_resting ? SENSOR_REST_FRAMES : SENSOR_WRONG_FRAMES);
    if (s->wrong_frames < most << s->wrong_times)
        return;
    s->wrong_times += s->wrong_times < SENSOR_WRONG_TIMES;
    s->wrong_frames = 0;
    s->is_resting = s->is_searching = s->is_pinned[0] = s->is_pinned[1] = s->swaps = s->unanswered = 0;
    s->is_blunt = 0;
    o->white.highest = -SENSOR_FAR_AWAY;
    o->black.darkest = 0.0;
    pupil_sensor_forget_ends(s);
    pupil_sensor_doubt(o);
    agree(o);
}

/* Looks for white and the black level after a step of `ev`. Returns whether the black level was just found. */
static int finds_black(pupil_sensor_object *o, const sensor_evidence *v, double ev)
{
    const int had_black = o->black.value > 0.0;
    if (size_of(ev) >= SENSOR_STEP_EV)
        pupil_sensor_find_white(o, v);
    pupil_sensor_find_black(o, v, ev);
    return !had_black && o->black.value > 0.0;
}

/* Once a large step is in force: what it did. A weak response may come from a scene that moved, so it has to be seen
 * twice; once is enough while nothing is known of the camera. */
static void judge_answer(pupil_sensor_object *o, const sensor_evidence *v)
{
    sensor_search *s = &o->search;
    sensor_estimate *a = &o->estimate;
    const double expected = pupil_sensor_effect(a, s->from, a->requested), seen = a->effect - s->effect_from;
    const double plain = a->requested[0] - s->from[0] + a->requested[1] - s->from[1], share = seen / expected;
    s->is_large = 0;
    if (finds_black(o, v, plain))
        return; /* the step was asked for with another black level */
    if ((o->plan.goal - a->effect) * expected < 0.0 && size_of(o->plan.goal - a->effect) > 0.5 * size_of(expected)) {
        pupil_sensor_overshot(a); /* the controls do more than was believed */
        s->unanswered = s->weak = 0;
    }
    if (!v->is_number || !(size_of(expected) > SENSOR_DIFFER_EV))
        return;
    const int is_wrong = size_of(seen - expected) > SENSOR_MISMATCH_EV;
    s->unanswered = size_of(seen) < SENSOR_ANSWER_SHARE * size_of(plain)
                        ? s->unanswered + (s->unanswered < SENSOR_UNANSWERED_MOST)
                        : 0;
    s->deaf = s->unanswered ? s->deaf + (s->deaf < 2) : 0;
    if (is_wrong && !s->is_searching)
        pupil_sensor_begin_search(o, o->plan.wanted - a->effect);
    const double large = share < SENSOR_WEAK ? expected : plain; /* a large response makes small steps */
    if (size_of(large) < SENSOR_STEP_EV)
        return;
    s->weak = share < SENSOR_WEAK ? s->weak + (s->weak < 2) : 0;
    const int is_still = pupil_sensor_unrest(a) < SENSOR_STRAIGHT * size_of(expected);
    if (is_still && (s->weak != 1 || !(a->learned || o->config.linear)))
        pupil_sensor_learn(o, s->from, expected, seen);
}

/* Compares a step by request, by metadata and as seen. Once the metadata are trusted, the exposures need no search. */
static void weigh(pupil_sensor_object *o, double asked, double said, double seen)
{
    sensor_search *s = &o->search;
    const uint32_t was = o->told.is_trusted;
    pupil_sensor_weigh_told(o, asked, said, seen);
    if (!was && o->told.is_trusted) {
        s->is_searching = s->is_resting = s->is_pinned[0] = s->is_pinned[1] = s->swaps = 0;
        pupil_sensor_forget_ends(s);
    }
}

/* A large step is in force: whether the metadata predicted its effect better than the request. */
static void weigh_step(pupil_sensor_object *o, const sensor_evidence *v)
{
    const sensor_estimate *a = &o->estimate;
    double asked = 0.0, said = 0.0;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        asked += a->requested[c] - o->search.from[c];
        said += a->said[c] - o->told.said_before[c];
    }
    if (v->is_number)
        weigh(o, asked, said, a->effect - o->search.effect_from);
}

/* After small steps, if the metadata say that the exposure moved by more than was asked for within any delay, but by no
 * more than a camera may round: whether the picture moved so, too. If nothing was asked for, the camera's own automatic
 * did it. */
static void weigh_frame(pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const double said = a->said[0] - a->said_before[0];
    double least = a->requested[0], most = least;
    for (uint32_t i = 1; i <= SENSOR_DELAYS + 1; i++) {
        const double asked = a->asked[(a->frame + SENSOR_RING - i) % SENSOR_RING][0];
        least = smaller(asked, least);
        most = larger(asked, most);
    }
    if (most > least && size_of(said) > most - least && size_of(said) < SENSOR_COARSE_STEP_EV + SENSOR_SAME_EV)
        weigh(o, said < 0.0 ? least - most : most - least, said, a->answered);
}

/* Steps that are too small to be evaluated one by one: since the last setting that agreed, their sum has to do what it
 * should. */
static void watch_small(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const double lacks = pupil_sensor_effect(a, s->agreed, a->requested) - (a->effect - s->agreed_effect);
    const double need = o->plan.wanted - a->effect;
    if (size_of(lacks) < SENSOR_UNEXPLAINED_EV || s->is_searching) {
        agree(o);
    } else if (size_of(lacks) > SENSOR_MISMATCH_EV && lacks * need > 0.0) {
        pupil_sensor_begin_search(o, need);
        agree(o);
    }
}

void pupil_sensor_answer_frame(pupil_sensor_object *o, const sensor_evidence *v)
{
    const int is_large = o->search.is_large, is_on_its_way = pupil_sensor_is_on_its_way(o);
    if (is_large && !is_on_its_way)
        weigh_step(o, v);
    else if (!o->told.is_trusted)
        weigh_frame(o);
    if (!is_on_its_way)
        pupil_sensor_learn_told(o);
    if (is_large && !is_on_its_way) {
        judge_answer(o, v);
        agree(o);
    } else if (!is_large && !is_on_its_way && v->is_number) {
        watch_small(o);
    }
}
