/* How bright the picture should become: from far off in one step; nearby by a slow filter, which is faster where light
 * moves to one side. */
#include "sensor_private.h"

#include "base/key.h"
#include "base/numeric.h"

/* Stops of the picture for one stop of light: the mean of both controls, since a tone curve affects both alike. */
static double slope_of(const pupil_sensor_object *o)
{
    return 0.5 * (o->estimate.response[0] + o->estimate.response[1]);
}

/* The key's level. */
static double grey_of(const pupil_sensor_config *c)
{
    return pupil_log2(c->key) + pupil_log2(c->clip);
}

/* The scene's light in a frame with this mean, by the picture's slope. */
static double light_of(const pupil_sensor_object *o, double mean)
{
    const double grey = grey_of(&o->config);
    return (mean - grey) / slope_of(o) + grey - o->estimate.in_force[0] - o->estimate.in_force[1];
}

/* What a frame's mean should be: the key, or key_at for this scene light. */
static double aim_at(const pupil_sensor_object *o, double light)
{
    const pupil_sensor_config *c = &o->config;
    const double grey = grey_of(c);
    const double key = pupil_key_log2(c->key, c->key_at, c->key_points, light) + pupil_log2(c->clip);
    return grey + slope_of(o) * (key - grey) + c->ev_compensation;
}

double pupil_sensor_plan_for(const pupil_sensor_object *o, double ev)
{
    return aim_at(o, o->plan.light + ev) - aim_at(o, o->plan.light) - slope_of(o) * ev;
}

/* By how much the highlights hold the level back. */
static double held_back(const pupil_sensor_config *c, const sensor_evidence *v, double above_effect, double highlight)
{
    const double room = v->white - v->highlight;
    double most = room - SENSOR_HIGHLIGHT_AIM_EV;               /* the picture may become brighter by this */
    if (v->clipped_share > c->highlight_share || room <= 0.0) { /* how far highlights are above white is estimated */
        most = v->white - highlight - SENSOR_HIGHLIGHT_AIM_EV;
    }
    return clamp(above_effect - most, 0.0, c->highlight_ev);
}

/* The last large step was some time ago. */
static int is_at_rest(const sensor_plan *p)
{
    return p->near_frames >= SENSOR_HIGHLIGHT_FRAMES;
}

/* By how much the highlights are off. They are known from bins: at rest, an error below a part of a bin is ignored. */
static double highlight_off(const sensor_plan *p, double held_ev)
{
    const double off = held_ev - p->held_back_ev;
    const double least_ev = held_ev > 0.0 && is_at_rest(p) ? SENSOR_HIGHLIGHT_REST_EV : 0.0;
    return off - clamp(off, -least_ev, least_ev);
}

/* Stops a frame by which the highlights may move the level. Whether they are still clipped is seen only after the
 * delay: until then the level may move by no more than the room that is aimed at. */
static double highlight_move_ev(const pupil_sensor_object *o)
{
    if (is_at_rest(&o->plan))
        return SENSOR_HIGHLIGHT_SLOW_EV;
    const double fast_ev = SENSOR_HIGHLIGHT_AIM_EV / pupil_sensor_longest_delay(o);
    return smaller(fast_ev, SENSOR_GLIDE_EV);
}

/* The size of a step from a frame that is only too bright or too dark, in stops: half of the last such step if that
 * went too far, twice as much if it did not go far enough. So a camera with few stops between black and white settles.
 * It starts at twice SENSOR_BLIND_EV, and blind_step limits it: one change of direction, as when the light changes,
 * still gets the full step. */
static double blind_ev(const sensor_plan *p, double side)
{
    const double last = size_of(p->blind_ev), most = 2.0 * SENSOR_BLIND_EV;
    const double next = side * p->blind_ev < 0.0 ? 0.5 * last : 2.0 * last;
    return last > 0.0 ? smaller(next, most) : most;
}

static double blind_step(const sensor_plan *p, double side)
{
    const double ev = blind_ev(p, side);
    return smaller(ev, SENSOR_BLIND_EV);
}

/* The effect that this frame asks for.
 *
 * A clipped frame's mean is too low, so its goal is between the frame's own effect and the right one: such steps
 * approach the aim from one side. Only where the frame is far too bright may a guess go further, or too far; the steps
 * after that come from the dark side, without guesses. So guesses cannot make the loop swing. */
static void find_goal(pupil_sensor_object *o, const sensor_evidence *v)
{
    const pupil_sensor_config *c = &o->config;
    sensor_plan *p = &o->plan;
    const double effect = o->estimate.effect;
    double mean, highlight, lost, goal;
    p->light = light_of(o, v->mean);
    p->aim = aim_at(o, p->light);
    const double plain = p->aim - v->mean;
    goal = plain;
    p->is_guess = 0;
    pupil_sensor_guess(c, v, p->aim, &mean, &highlight, &lost);
    o->setting.scene_ev = v->mean - o->estimate.in_force[0] - o->estimate.in_force[1];
    if (goal < -c->far_ev) {
        p->is_guess = mean > v->mean;
        p->light = light_of(o, mean);
        p->aim = aim_at(o, p->light);
        goal = v->clipped_share >= SENSOR_BLIND_CLIPPED ? clamp(-blind_step(p, -1.0), -SENSOR_BLIND_EV, plain)
                                                        : p->aim + lost - mean;
        o->setting.scene_ev += mean - v->mean;
    } else if (v->is_number) {
        p->blind_ev = 0.0;
    }
    if (v->black_share > 0.5 && goal > blind_step(p, 1.0)) {
        goal = blind_step(p, 1.0);
        p->is_guess = 1;
    }
    /* if the picture is far off, little is known of its highlights */
    const double near_ev = SENSOR_FAR_TIMES * c->far_ev;
    const double off = highlight_off(p, v->has_highlight ? held_back(c, v, goal, highlight) : 0.0);
    p->moved = 0.0;
    const int is_waiting = pupil_sensor_is_pending(o) || o->announced.frames;
    const double far = effect + goal - p->held_back_ev - p->wanted;
    const double low = smaller(far, 0.0), by_them = clamp(off, low, far - low); /* highlights may be the only error */
    if (size_of(far - by_them) < near_ev && !is_waiting) {
        const double fast_ev = highlight_move_ev(o);
        const double move = clamp(SENSOR_HIGHLIGHT_WEIGHT * off, -fast_ev, fast_ev);
        p->held_back_ev += move;
        p->moved = c->lock ? 0.0 : -move;
        p->wanted += p->moved;
    }
    p->goal = effect + goal - p->held_back_ev;
}

/* Whether too few frames have said the same for a large step: light may come and go within a frame or two. Not while
 * the first setting is looked for. The step is the least that all of them ask for. */
static int is_flash(pupil_sensor_object *o, double off)
{
    sensor_plan *p = &o->plan;
    const int is_same_side = p->far_frames && (p->far_ev > 0.0) == (off > 0.0);
    if (!is_same_side || size_of(off) < size_of(p->far_ev))
        p->far_ev = off;
    p->far_frames = is_same_side ? p->far_frames + (p->far_frames < SENSOR_DELAYS) : 1;
    return !p->is_looking && p->far_frames <= o->config.flash_frames;
}

/* The delays are known, or that of the only control that moves: so it is known what each frame was taken with. */
static int is_timed(const sensor_estimate *a)
{
    return a->is_borne_out ||
           ((a->delay[0] || !pupil_sensor_is_waited_for(a, 0)) && (a->delay[1] || !pupil_sensor_is_waited_for(a, 1)));
}

/* The largest weight of the filter. */
static double most_weight(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const uint32_t delay = pupil_sensor_longest_delay(o), gap = a->gap < delay ? a->gap : delay;
    return is_timed(a) ? SENSOR_TRACK_WEIGHT : SENSOR_DELAY_WEIGHT * gap / delay;
}

/* Stops a frame by which the light moves, if it clearly moved to one side in each of the last frames; else 0. */
static double ramp_of(const sensor_estimate *a)
{
    double least = a->scene_moved[0];
    for (int i = 1; i < SENSOR_RAMP_FRAMES; i++) {
        if (least * a->scene_moved[i] <= 0.0)
            return 0.0;
        least = size_of(a->scene_moved[i]) < size_of(least) ? a->scene_moved[i] : least;
    }
    return size_of(least) > SENSOR_RAMP_NOISE * a->noise_ev ? least : 0.0;
}

/* The usual weight of the filter: less at rest, where noise would be visible. */
static double usual_weight(const pupil_sensor_object *o)
{
    const double tau_s = o->config.tau_s, share = SENSOR_CALM_EV / o->estimate.noise_ev;
    const double usual = tau_s > 0.0 ? pupil_one_minus_exp(o->setting.dt_s / tau_s) : 1.0;
    return is_at_rest(&o->plan) ? clamp(share * share, SENSOR_CALM_SHARE * usual, usual) : usual;
}

/* `wanted` moves towards a goal that is near. */
static void filter(pupil_sensor_object *o, double off)
{
    sensor_plan *p = &o->plan;
    const pupil_sensor_config *c = &o->config;
    const double usual = usual_weight(o), most = most_weight(o);
    double move = off * smaller(usual, most);
    double most_ev = larger(SENSOR_GLIDE_EV, size_of(move)); /* nearby only tau_s counts */
    if (size_of(off) < SENSOR_LAST_EV && p->beyond != 0.0) { /* not seen: the setting goes to the limit */
        move = off;
    } else if (p->far_frames > c->flash_frames) {
        move = off * most;
        most_ev = SENSOR_GLIDE_EV;
    } else if (is_timed(&o->estimate) && p->beyond == 0.0) {
        move -= ramp_of(&o->estimate); /* brighter light, less effect */
    }
    p->wanted += clamp(move, -most_ev - p->moved, most_ev - p->moved); /* the move by highlights included */
}

/* Whether the announced change has come. A frame that is mostly clipped or black only shows the side. The wait ends
 * when the change, with its setting, is seen in more frames than a flash lasts. */
static void await_change(pupil_sensor_object *o, const sensor_evidence *v, double goal)
{
    sensor_plan *p = &o->plan;
    sensor_announced *a = &o->announced;
    int has_come = size_of(goal - a->with) <= size_of(goal - a->without);
    if (v->clipped_share > 0.5)
        has_come = a->with <= a->without;
    else if (v->black_share > 0.5)
        has_come = a->with >= a->without;
    const uint32_t gap = pupil_sensor_is_on_its_way(o) ? 0 : o->estimate.gap;
    p->wanted = has_come ? a->with : a->without;
    p->slow = PUPIL_SENSOR_ANNOUNCED;
    p->far_frames = 0;
    a->seen = has_come ? a->seen + gap : 0;
    a->frames = a->seen > o->config.flash_frames || a->frames <= gap ? 0 : a->frames - gap;
    o->setting.filter_ev = o->day_night.filter_ev + (has_come ? a->filter_ev : 0.0);
    if (!a->frames)
        o->day_night.filter_ev = o->setting.filter_ev;
}

void pupil_sensor_plan_frame(pupil_sensor_object *o, const sensor_evidence *v)
{
    const pupil_sensor_config *c = &o->config;
    sensor_plan *p = &o->plan;
    double least, most;
    p->near_frames += p->near_frames < SENSOR_HIGHLIGHT_FRAMES ? o->estimate.gap : 0;
    find_goal(o, v);
    pupil_sensor_reach(o, &least, &most);
    const double goal = clamp(p->goal, least, most), off = goal - p->wanted;
    p->beyond = p->goal - goal;
    o->setting.error_ev = off;
    o->setting.wanted_ev = p->aim;
    p->slow = PUPIL_SENSOR_NO_REASON;
    if (c->lock)
        return;
    if (o->announced.frames) {
        await_change(o, v, goal);
        o->setting.error_ev = goal - p->wanted;
        return;
    }
    const int is_off = size_of(off) > (p->is_looking ? SENSOR_LOOK_EV : c->far_ev);
    const int is_new = is_off ? is_flash(o, off) : 0;
    p->far_frames = is_off ? p->far_frames : 0;
    const int is_far = p->is_looking ? is_off : size_of(off) > SENSOR_FAR_TIMES * c->far_ev;
    const int is_waiting = pupil_sensor_is_pending(o) && (is_far || !o->search.is_searching);
    if ((is_far && is_new) || is_waiting) {
        p->slow = is_far && is_new ? PUPIL_SENSOR_FLASH : PUPIL_SENSOR_WAITING;
        return;
    }
    if (is_far) {
        p->wanted += p->far_ev;
        p->blind_ev = v->is_number ? 0.0 : p->far_ev < 0.0 ? -blind_ev(p, -1.0) : blind_ev(p, 1.0);
        p->near_frames = 0;
        p->is_looking = p->is_guess || !v->is_number;
        p->far_frames = 0;
        return;
    }
    p->is_looking = 0;
    filter(o, off);
}
