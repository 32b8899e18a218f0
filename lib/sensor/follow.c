/* Which setting gives the picture that is wanted. A camera that answers as its numbers say has it at once. Of one that
 * answers otherwise it is found by a search on the path of settings, from the points that were seen: on a camera on
 * which more never makes the picture darker the wanted effect is between a point below and one above it. */
#include "sensor_private.h"

#include "base/numeric.h"

/* Whether only the metadata are left to say what is in force. */
static int is_by_metadata(const sensor_estimate *a)
{
    return a->reports && ((a->alive[0] == 1 && a->alive[1] == 1) || a->is_borne_out);
}

/* The shortest delay that the frames so far leave possible. */
static uint32_t shortest_delay(const sensor_estimate *a)
{
    uint32_t shortest = 0;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        uint32_t delay = 0;
        while (delay < SENSOR_DELAYS && !(a->alive[c] >> delay & 1))
            delay++;
        shortest = delay > shortest ? delay : shortest;
    }
    return shortest;
}

/* Where many frames are lost, the program is slow, and settings come late by more than the camera's delay: the one that
 * was found holds as long as nothing speaks against it. */
static int is_refuted(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    uint32_t lost = 0;
    if (o->setting.frames < SENSOR_RING || (a->alive[0] >> a->delay[0] & a->alive[1] >> a->delay[1] & 1))
        return 0;
    for (uint32_t i = 0; i < SENSOR_RING; i++)
        lost += !a->past[i].gap;
    return lost >= SENSOR_MANY_LOST;
}

/* Frames after which a setting is taken to be in force, with any delay. */
static uint32_t wait_frames(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const uint32_t longest = pupil_sensor_longest_delay(o), late = o->config.delay_frames + SENSOR_LATE_FRAMES;
    const uint32_t most = late > 2 * SENSOR_LATE_FRAMES ? late : 2 * SENSOR_LATE_FRAMES;
    const uint32_t known = a->delay[0] > a->delay[1] ? a->delay[0] : a->delay[1];
    if (a->is_borne_out && known && !is_refuted(o))
        return known > o->config.delay_frames ? known : o->config.delay_frames;
    const uint32_t usual = longest < most && !is_by_metadata(a) ? longest : most, shortest = shortest_delay(a);
    return usual > shortest ? usual : shortest;
}

int pupil_sensor_is_on_its_way(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    int is_there = 1, is_late = 0;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        const int is_in = size_of(a->in_force[c] - a->requested[c]) < SENSOR_DIFFER_EV;
        is_there &= is_in;
        is_late |= !is_in && a->reports && !a->best[c];
    }
    /* Metadata that nothing contradicts say that it is not: the delay may be longer than was believed. And where frames
     * are lost because the program is slow, those that come have waited in the driver: they are counted. */
    const uint32_t usual = wait_frames(o), least = SENSOR_LATE_FRAMES + 1;
    const int is_waiting = o->search.since < usual || (is_late && o->search.looks < (usual > least ? usual : least));
    return is_waiting && !(is_there && is_by_metadata(a));
}

/* The setting that was asked for last is in force beyond doubt. */
static int is_in_force(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const int is_known = is_by_metadata(a) || (a->delay[0] && a->delay[1]);
    return !pupil_sensor_is_on_its_way(o) &&
           (is_known || o->search.since >= o->config.delay_frames + SENSOR_LATE_FRAMES);
}

int pupil_sensor_is_pending(const pupil_sensor_object *o)
{
    return o->search.is_large && pupil_sensor_is_on_its_way(o);
}

double pupil_sensor_effect_asked(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    return a->effect + (pupil_sensor_is_on_its_way(o) ? pupil_sensor_effect(a, a->in_force, a->requested) : 0.0);
}

/* The effect of a total beyond that of the requested setting; and its setting. What the setting lacks of the total is
 * the digital factor's. */
static double effect_of(const pupil_sensor_object *o, double total, double setting[SENSOR_CONTROLS])
{
    double e, g;
    pupil_sensor_split(o, total, &e, &g);
    setting[0] = pupil_log2(pupil_sensor_told(o, e));
    setting[1] = pupil_log2(g);
    return pupil_sensor_effect(&o->estimate, o->estimate.requested, setting);
}

static double left_of(double total, const double setting[SENSOR_CONTROLS])
{
    return total - setting[0] - setting[1];
}

void pupil_sensor_reach(const pupil_sensor_object *o, double *least, double *most)
{
    double darkest[SENSOR_CONTROLS], brightest[SENSOR_CONTROLS];
    const double asked = pupil_sensor_effect_asked(o);
    if (o->config.exposure_mode == PUPIL_SENSOR_HELD && o->config.gain_mode == PUPIL_SENSOR_HELD) {
        *least = *most = o->plan.wanted; /* and what was rounded is held, too */
        return;
    }
    pupil_sensor_ends(o, darkest, brightest);
    *least = asked + pupil_sensor_effect(&o->estimate, o->estimate.requested, darkest);
    *most = asked + pupil_sensor_effect(&o->estimate, o->estimate.requested, brightest);
}

/* The ends of the path of settings. */
static void path_ends(const pupil_sensor_object *o, double *least, double *most)
{
    double setting[SENSOR_CONTROLS];
    (void)effect_of(o, -SENSOR_TOTAL_END_EV, setting);
    *least = setting[0] + setting[1];
    (void)effect_of(o, SENSOR_TOTAL_END_EV, setting);
    *most = setting[0] + setting[1];
}

/* The total whose effect is so much beyond that of the requested setting, by what the controls are known to do. */
static double total_for(const pupil_sensor_object *o, double need)
{
    const sensor_estimate *a = &o->estimate;
    double setting[SENSOR_CONTROLS], low, high;
    path_ends(o, &low, &high);
    if (a->response[0] == 1.0 && a->response[1] == 1.0)
        return clamp(a->requested[0] + a->requested[1] + need, low, high);
    for (int i = 0; i < SENSOR_BISECT; i++) {
        const double middle = 0.5 * (low + high);
        const double effect = effect_of(o, middle, setting);
        if (effect + left_of(middle, setting) < need)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/* --- what was seen --- */

static void forget_points(sensor_search *s)
{
    __builtin_memset(s->point, 0, sizeof s->point);
}

/* The requested setting and what it does. Points that contradict it are of another time: more never makes darker. */
static void remember(pupil_sensor_object *o)
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

/* The nearest points below and above what is wanted. */
static void surround(const pupil_sensor_object *o, const sensor_point **low, const sensor_point **high)
{
    const double wanted = o->plan.wanted;
    *low = *high = 0;
    for (const sensor_point *p = o->search.point; p < o->search.point + SENSOR_POINTS; p++) {
        if (!p->is_used)
            continue;
        if (p->effect < wanted && (!*low || p->effect > (*low)->effect))
            *low = p;
        if (p->effect >= wanted && (!*high || p->effect < (*high)->effect))
            *high = p;
    }
}

/* Where the error is large and does not shrink, what was learned of the camera is wrong: it is forgotten. */
static void doubt(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const double error = o->plan.wanted - o->estimate.effect, size = size_of(error);
    const double other_light = size_of(o->plan.wanted - s->wrong_wanted);
    if (other_light > SENSOR_UNPIN_EV || (size < SENSOR_WRONG_EV && !s->is_searching))
        s->wrong_times = 0;
    if (other_light > SENSOR_WRONG_EV) {
        s->wrong_wanted = o->plan.wanted;
        s->wrong_ev = SENSOR_FAR_AWAY;
    }
    if (size < SENSOR_WRONG_EV || size < SENSOR_SHRINK * s->wrong_ev) {
        s->wrong_frames = 0;
        s->wrong_ev = size;
        return;
    }
    /* what is a little off and was asked for again once waits for steps that are on their way: calm at rest */
    const int is_calm = s->wrong_times || size < SENSOR_UNPIN_EV;
    s->wrong_frames += pupil_sensor_is_pending(o) && is_calm ? 0 : o->estimate.gap;
    const uint32_t most = wait_frames(o) + (s->is_resting ? SENSOR_REST_FRAMES : SENSOR_WRONG_FRAMES);
    if (s->wrong_frames < most << s->wrong_times)
        return;
    s->wrong_times += s->wrong_times < SENSOR_WRONG_TIMES;
    s->wrong_frames = 0;
    s->is_resting = s->is_searching = s->is_pinned[0] = s->is_pinned[1] = s->swaps = s->unanswered = 0;
    s->is_blunt = 0;
    s->jump_ev = 0.0;
    o->white.highest = -SENSOR_FAR_AWAY;
    o->black.wrong = 0;
    o->black.darkest = 0.0;
    forget_points(s);
    pupil_sensor_doubt(o);
}

/* --- where to go --- */

/* Whether a control may do `need` stops of the picture from a setting on. */
static int has_room(const pupil_sensor_object *o, int control, const double setting[SENSOR_CONTROLS], double need)
{
    const pupil_sensor_config *c = &o->config;
    const double to = setting[control] + need;
    const double least = control == SENSOR_GAIN ? c->gain_min : c->exposure_min_s;
    const double most = control == SENSOR_GAIN ? c->gain_max : pupil_sensor_longest_exposure(c);
    const uint32_t mode = control == SENSOR_GAIN ? c->gain_mode : c->exposure_mode;
    return mode == PUPIL_SENSOR_AUTO && to <= pupil_log2(most) && to >= pupil_log2(least);
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
    forget_points(s);
}

/* The camera did not answer as it should. Gains are finer than exposures that lamps allow, and come sooner. */
static void begin_search(pupil_sensor_object *o, double need)
{
    sensor_search *s = &o->search;
    const double *requested = o->estimate.requested;
    s->is_searching = 1;
    s->swaps = s->narrowed = 0;
    if (has_room(o, SENSOR_GAIN, requested, need))
        move_only(o, SENSOR_GAIN, requested);
    else if (has_room(o, SENSOR_EXPOSURE, requested, need))
        move_only(o, SENSOR_EXPOSURE, requested);
    remember(o);
}

/* The control that moves has no setting between two others: it stays at one of them, and the other control does the
 * rest. Whether there is such another control. */
static int swap(pupil_sensor_object *o, const sensor_point *low, const sensor_point *high)
{
    sensor_search *s = &o->search;
    const double wanted = o->plan.wanted;
    const int is_one = s->is_pinned[0] != s->is_pinned[1];
    const int coarse = size_of(high->setting[0] - low->setting[0]) > size_of(high->setting[1] - low->setting[1])
                           ? SENSOR_EXPOSURE
                           : SENSOR_GAIN;
    const int other = SENSOR_CONTROLS - 1 - (is_one ? (int)s->mover : coarse);
    const sensor_point *from = has_room(o, other, low->setting, wanted - low->effect)     ? low
                               : has_room(o, other, high->setting, wanted - high->effect) ? high
                                                                                          : 0;
    if (!from || s->swaps >= SENSOR_SWAPS)
        return 0;
    const double total = from->setting[0] + from->setting[1] + wanted - from->effect;
    move_only(o, other, from->setting);
    s->swaps++;
    s->narrowed = 0;
    s->total = total;
    return 1;
}

/* Between the points that were seen. Where nothing is left between them the search ends at the nearer one. */
static double narrow(pupil_sensor_object *o, double total)
{
    sensor_search *s = &o->search;
    const sensor_point *low, *high;
    double setting[SENSOR_CONTROLS];
    surround(o, &low, &high);
    if (!low || !high)
        return total;
    const double gap = high->total - low->total, wanted = o->plan.wanted;
    const double share = (wanted - low->effect) / (high->effect - low->effect);
    const double middle = low->total + gap * clamp(share, SENSOR_NARROW, 1.0 - SENSOR_NARROW);
    (void)effect_of(o, middle, setting);
    const int is_low = setting[0] == low->setting[0] && setting[1] == low->setting[1];
    const int is_high = setting[0] == high->setting[0] && setting[1] == high->setting[1];
    if (gap > SENSOR_GAP_EV && !is_low && !is_high && s->search_frames < SENSOR_SEARCH_FRAMES &&
        (s->narrowed < SENSOR_NARROWED || s->swaps >= SENSOR_SWAPS)) {
        s->narrowed++;
        return middle;
    }
    const sensor_point *near = wanted - low->effect < high->effect - wanted ? low : high;
    const double nearest = near->total;
    if (size_of(wanted - near->effect) > SENSOR_OFF_EV && s->search_frames < SENSOR_SEARCH_FRAMES) {
        if (swap(o, low, high))
            return s->total;
        if (gap > SENSOR_GAP_EV && !is_low && !is_high)
            return middle;
    }
    s->is_resting = 1;
    s->rest_wanted = wanted;
    s->rest_ev = size_of(wanted - near->effect);
    return nearest;
}

/* What the picture of a step by `ev` shows of the camera's white, and of its black level; whether that is known now. */
static int finds_black(pupil_sensor_object *o, const sensor_evidence *v, double ev)
{
    const int had_black = o->black.value > 0.0;
    if (size_of(ev) >= SENSOR_STEP_EV)
        pupil_sensor_find_white(o, v);
    pupil_sensor_find_black(o, v, ev);
    return !had_black && o->black.value > 0.0;
}

/* Once a large step is in force: what it did. A weak answer is believed the second time, for the scene may have moved
 * against it; but for the first of a camera of which nothing is known. */
static void judge_answer(pupil_sensor_object *o, const sensor_evidence *v)
{
    sensor_search *s = &o->search;
    sensor_estimate *a = &o->estimate;
    const double expected = pupil_sensor_effect(a, s->from, a->requested), seen = a->effect - s->effect_from;
    const double plain = a->requested[0] - s->from[0] + a->requested[1] - s->from[1], share = seen / expected;
    const int had_black = o->black.value > 0.0;
    s->is_large = 0;
    if (finds_black(o, v, plain))
        return; /* the step was asked for by another level */
    if ((o->plan.goal - a->effect) * expected < 0.0 && size_of(o->plan.goal - a->effect) > 0.5 * size_of(expected)) {
        pupil_sensor_overshot(a); /* the controls do more than was believed */
        s->unanswered = s->weak = 0;
    }
    s->deaf = v->is_number ? s->deaf : 0; /* it may have answered where nothing can be seen */
    if (!v->is_number || !(size_of(expected) > SENSOR_DIFFER_EV))
        return;
    const int is_wrong = size_of(seen - expected) > SENSOR_MISMATCH_EV;
    s->unanswered = size_of(seen) < SENSOR_ANSWER_SHARE * size_of(plain)
                        ? s->unanswered + (s->unanswered < SENSOR_UNANSWERED_MOST)
                        : 0;
    s->deaf = s->unanswered ? s->deaf + (s->deaf < 2) : 0;
    if (had_black)
        pupil_sensor_test_black(o, is_wrong);
    if (is_wrong && !s->is_searching && size_of(o->plan.wanted - a->effect) > SENSOR_OFF_EV)
        begin_search(o, o->plan.wanted - a->effect);
    const double large = share < SENSOR_WEAK ? expected : plain; /* what is thought to do much goes in small steps */
    if (size_of(large) < SENSOR_STEP_EV)
        return;
    s->weak = share < SENSOR_WEAK ? s->weak + (s->weak < 2) : 0;
    const int is_still = pupil_sensor_unrest(a) < SENSOR_STRAIGHT * size_of(expected);
    if (is_still && (s->weak != 1 || !(a->learned || o->config.linear)))
        pupil_sensor_learn(o, s->from, expected, seen);
}

/* A step is in force: whether the metadata say better than the request what it did. */
static void weigh_told(pupil_sensor_object *o, const sensor_evidence *v)
{
    const sensor_estimate *a = &o->estimate;
    sensor_search *s = &o->search;
    const uint32_t was = o->told.is_trusted;
    double asked = 0.0, told = 0.0;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        asked += a->requested[c] - s->from[c];
        told += a->said[c] - o->told.said_before[c];
    }
    if (v->is_number)
        pupil_sensor_weigh_told(o, asked, told, a->effect - s->effect_from);
    if (!was && o->told.is_trusted) { /* what was looked for is known now */
        s->is_searching = s->is_resting = s->is_pinned[0] = s->is_pinned[1] = s->swaps = 0;
        forget_points(s);
    }
}

static int is_requested(const pupil_sensor_object *o, double total)
{
    double setting[SENSOR_CONTROLS];
    (void)effect_of(o, total, setting);
    return setting[0] == o->estimate.requested[0] && setting[1] == o->estimate.requested[1];
}

/* The control that moves has no better setting than the requested one: the other one does the rest, or the search
 * ends. */
static double leave(pupil_sensor_object *o, double need)
{
    sensor_search *s = &o->search;
    const double *requested = o->estimate.requested;
    const int is_one = s->is_pinned[0] != s->is_pinned[1], other = SENSOR_CONTROLS - 1 - (int)s->mover;
    if (is_one && s->swaps < SENSOR_SWAPS && has_room(o, other, requested, need)) {
        move_only(o, other, requested);
        s->swaps++;
        s->narrowed = 0;
        return requested[0] + requested[1] + need;
    }
    s->is_resting = 1;
    s->rest_wanted = o->plan.wanted;
    s->rest_ev = size_of(need);
    return s->set;
}

/* To what the camera has. */
static void round_setting(const pupil_sensor_object *o, double setting[SENSOR_CONTROLS], double *e, double *g)
{
    const pupil_sensor_config *c = &o->config;
    const double longest_s = pupil_sensor_longest_exposure(c);
    *e = pupil_sensor_exposure_of(c, clamp(pupil_exp2(setting[0]), c->exposure_min_s, longest_s));
    *e = pupil_sensor_told_ask(o, *e, longest_s);
    *g = pupil_sensor_gain_of(c, pupil_exp2(setting[1]));
    setting[0] = pupil_log2(pupil_sensor_told(o, *e));
    setting[1] = pupil_log2(*g);
}

/* Until it is known which frames have what, one control moves alone: the gain, or else the exposure. Whether that is
 * enough. */
static int move_one(const pupil_sensor_object *o, double total, double part[SENSOR_CONTROLS], double *e, double *g)
{
    const double *from = o->estimate.requested;
    for (int c = SENSOR_GAIN; c >= SENSOR_EXPOSURE; c--) {
        const int other = SENSOR_CONTROLS - 1 - c;
        part[other] = from[other];
        part[c] = total - from[other];
        round_setting(o, part, e, g);
        if (size_of(total - part[0] - part[1]) <= SENSOR_COARSE_EV)
            return 1;
    }
    return 0;
}

/* Much of one control in exchange for the other goes in parts: between two delays a frame has the one and not yet the
 * other, and the digital factor can make up for so much only. Whether this is a part, which replaces the setting. */
static int is_part_of_exchange(const pupil_sensor_object *o, double total, double setting[SENSOR_CONTROLS], double *e,
                               double *g)
{
    const pupil_sensor_config *c = &o->config;
    const double *from = o->estimate.requested;
    const int is_timed = o->estimate.is_borne_out || (o->estimate.delay[0] && o->estimate.delay[1]);
    const double most_ev = is_timed ? SENSOR_EXCHANGE_EV : SENSOR_BLIND_EXCHANGE_EV;
    const double move[SENSOR_CONTROLS] = {setting[0] - from[0], setting[1] - from[1]};
    const int smaller = size_of(move[0]) < size_of(move[1]) ? 0 : 1, larger = SENSOR_CONTROLS - 1 - smaller;
    if (move[0] * move[1] >= 0.0 || size_of(move[smaller]) <= most_ev || c->exposure_mode != PUPIL_SENSOR_AUTO ||
        c->gain_mode != PUPIL_SENSOR_AUTO)
        return 0;
    double part[SENSOR_CONTROLS];
    part[smaller] = from[smaller] + (move[smaller] > 0.0 ? most_ev : -most_ev);
    part[larger] = setting[larger] + setting[smaller] - part[smaller];
    round_setting(o, part, e, g);
    if (is_timed && size_of(total - part[0] - part[1]) > SENSOR_COARSE_EV) { /* the gain makes up for few lines */
        part[1] = setting[0] + setting[1] - part[0];
        round_setting(o, part, e, g);
    }
    if (size_of(part[smaller] - from[smaller]) < 0.5 * most_ev ||
        size_of(total - part[0] - part[1]) > SENSOR_COARSE_EV) { /* there is no such setting */
        if (is_timed || !move_one(o, total, part, e, g))
            return 0;
    }
    setting[0] = part[0];
    setting[1] = part[1];
    return 1;
}

static void ask(pupil_sensor_object *o, double total, int may_be_a_part)
{
    sensor_search *s = &o->search;
    sensor_estimate *a = &o->estimate;
    double setting[SENSOR_CONTROLS], e, g;
    const double asked = pupil_sensor_effect_asked(o);
    (void)effect_of(o, total, setting);
    pupil_sensor_split(o, total, &e, &g);
    double part[SENSOR_CONTROLS] = {setting[0], setting[1]}, part_e, part_g;
    s->is_exchanging = may_be_a_part && is_part_of_exchange(o, total, part, &part_e, &part_g);
    if (s->is_exchanging) {
        e = part_e;
        g = part_g;
        setting[0] = part[0];
        setting[1] = part[1];
    }
    s->set = total;
    if (e == o->setting.exposure_s && g == o->setting.gain)
        return;
    if (!a->has_frame) /* it is taken to be in force in the first one */
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

/* A small step of the setting and a large one of the picture: a light, or a camera that jumps there, as gains do where
 * one amplifier hands over to another. What jumps up with a step up and down with one down is the camera, unless light
 * that flickers moves as far without a step. */
static void find_jump(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const double moved = a->answered - a->stepped;
    if (size_of(s->set - s->jump_total) > SENSOR_WRONG_EV)
        s->jump_ev = 0.0;
    const double size = size_of(moved);
    if (a->stepped * moved <= 0.0 || size_of(a->stepped) > 0.5 * size || size < SENSOR_MISMATCH_EV ||
        size < SENSOR_NOISE_CUT * a->noise_ev || size > 2.0 * SENSOR_COARSE_STEP_EV)
        return;
    if (size_of(moved + s->jumped_ev) < SENSOR_ALIKE * size) {
        s->jump_ev = size;
        s->jump_total = s->set;
    }
    s->jumped_ev = moved;
}

/* Another frame: what was seen gets older, and another light makes some of it worthless. */
static void count_frame(pupil_sensor_object *o)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    s->since = s->since + a->gap < SENSOR_RING ? s->since + a->gap : SENSOR_RING;
    s->looks += s->looks < SENSOR_RING;
    if (o->setting.frames == 1 && (a->in_force[0] != a->requested[0] || a->in_force[1] != a->requested[1]))
        s->since = s->looks = 0; /* the camera began with another setting than it was asked for */
    for (sensor_point *p = s->point; p < s->point + SENSOR_POINTS; p++) {
        p->age += a->gap;
        p->is_used &= p->age < SENSOR_POINT_FRAMES;
    }
    if (size_of(o->plan.wanted - s->blunt_wanted) > SENSOR_WRONG_EV) {
        s->is_blunt = s->swaps = 0;
        s->blunt_wanted = o->plan.wanted;
    }
}

/* Whether a search goes on, and with which control: `need` is what the setting that was asked for lacks. */
static void go_on_searching(pupil_sensor_object *o, double need)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const double other_light = size_of(o->plan.wanted - s->rest_wanted);
    s->is_resting &= other_light <= SENSOR_OFF_EV && size_of(need) <= s->rest_ev + SENSOR_WRONG_EV;
    s->pinned_frames += s->pinned_frames < SENSOR_PINNED_FRAMES;
    if (s->pinned_frames >= SENSOR_PINNED_FRAMES && other_light > SENSOR_UNPIN_EV)
        s->is_pinned[0] = s->is_pinned[1] = 0;
    s->is_searching &= size_of(need) > SENSOR_OFF_EV || s->is_resting;
    s->search_frames = s->is_searching && !s->is_resting ? s->search_frames + a->gap : 0;
    if (s->is_pinned[0] == s->is_pinned[1])
        return;
    const int other = SENSOR_CONTROLS - 1 - (int)s->mover;
    if (s->unanswered > 1 && s->swaps < SENSOR_SWAPS && has_room(o, other, a->requested, need)) {
        move_only(o, other, a->requested); /* the control that moves does nothing */
        s->swaps++;
        s->unanswered = 0;
    } else if (!s->is_resting && size_of(need) > SENSOR_OFF_EV && !has_room(o, (int)s->mover, a->requested, need)) {
        s->is_pinned[0] = s->is_pinned[1] = 0; /* the control that moves is at its end */
        forget_points(s);
    }
}

/* Whether the setting is to change: never further than the frame itself says, and never where it says the opposite. */
static int is_due(pupil_sensor_object *o, double need, double left)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const double error = o->plan.goal - a->effect, large_ev = SENSOR_LARGE_EV, hold_ev = o->config.hold_ev;
    const int is_opposite = need * error < 0.0 && size_of(error) > o->config.far_ev;
    const int is_backward = is_opposite || (size_of(need) > large_ev && size_of(error) < 0.5 * size_of(need));
    /* of a camera that does not do small steps they are left to the digital factor */
    if (a->unexplained != 0.0) {
        s->is_blunt = 1;
        s->blunt_wanted = o->plan.wanted;
    }
    const int is_as_chosen = size_of(need - left) <= hold_ev && size_of(left) < SENSOR_COARSE_EV;
    const int is_held = size_of(need) <= hold_ev || is_as_chosen;
    const int is_near_jump = size_of(need) <= 0.5 * s->jump_ev + hold_ev;
    const int is_small = (s->is_blunt ? size_of(need) <= large_ev : is_held) || is_near_jump;
    return !s->is_resting && !is_backward && (!is_small || o->plan.beyond != 0.0 || s->is_exchanging);
}

static void choose(pupil_sensor_object *o, const sensor_evidence *v, double need, double left)
{
    sensor_search *s = &o->search;
    const sensor_estimate *a = &o->estimate;
    const int is_unknown = !o->config.linear && !a->learned && size_of(need) > SENSOR_STEP_EV;
    const double most = size_of(need) * (double)(2u << (s->unanswered - (s->unanswered > 1))),
                 requested = a->requested[0] + a->requested[1];
    double total = total_for(o, is_unknown ? 0.5 * need : need);
    total = clamp(total, requested - most - size_of(left), requested + most + size_of(left));
    total = s->is_searching ? narrow(o, total) : total;
    if (s->is_searching && !s->is_resting && is_requested(o, total))
        total = leave(o, need);
    s->total = total;
    ask(o, total, 1);
    if (s->is_large && !s->since) { /* how it looked before the step */
        o->white.top = v->spike > 0.0 ? v->top : SENSOR_FAR_AWAY;
        pupil_sensor_black_before(o, v);
    }
}

void pupil_sensor_follow(pupil_sensor_object *o, const sensor_evidence *v)
{
    sensor_search *s = &o->search;
    count_frame(o);
    find_jump(o);
    if (s->is_large && !pupil_sensor_is_on_its_way(o))
        weigh_told(o, v);
    if (!pupil_sensor_is_on_its_way(o) && !v->is_dead)
        pupil_sensor_learn_told(o);
    if (s->is_large && !pupil_sensor_is_on_its_way(o))
        judge_answer(o, v);
    else if (s->is_large)
        pupil_sensor_watch_white(o, v);
    if (is_in_force(o))
        remember(o);
    const int is_still = o->config.lock || o->announced.frames;
    if (!is_still)
        doubt(o);
    if (!is_still && !pupil_sensor_is_pending(o)) {
        const double left = left_of(s->set, o->estimate.requested);
        const double need = o->plan.wanted - pupil_sensor_effect_asked(o);
        go_on_searching(o, need);
        s->total = s->set + (s->is_searching ? 0.0 : need - left);
        /* the plan waits for steps; a search or an exchange of more than two goes on from what is wanted now: in the
         * next frame */
        const int is_old = o->plan.waited_frames > 2 * wait_frames(o);
        if (!is_old && is_due(o, need, left))
            choose(o, v, need, left);
    }
    o->estimate.is_searching = s->is_searching;
    report_total(o);
}

void pupil_sensor_move_to(pupil_sensor_object *o, double effect)
{
    sensor_search *s = &o->search;
    s->total = total_for(o, effect - pupil_sensor_effect_asked(o));
    ask(o, s->total, 0);
    s->is_large = 0;
    report_total(o);
}

/* The total, brought into what the camera can under the current configuration. Where both controls are held, what was
 * rounded is held, too. */
void pupil_sensor_begin(pupil_sensor_object *o, double total)
{
    sensor_search *s = &o->search;
    const pupil_sensor_config *c = &o->config;
    double least, most;
    s->is_pinned[0] = s->is_pinned[1] = s->is_searching = s->is_resting = 0;
    forget_points(s);
    path_ends(o, &least, &most);
    const int is_held = c->exposure_mode == PUPIL_SENSOR_HELD && c->gain_mode == PUPIL_SENSOR_HELD;
    if (!(is_held && o->setting.frames && size_of(total - most) < 1.0))
        total = clamp(total, least, most);
    s->total = total;
    ask(o, total, 0);
    o->plan.wanted = pupil_sensor_effect_asked(o) + left_of(total, o->estimate.requested);
    report_total(o);
}
