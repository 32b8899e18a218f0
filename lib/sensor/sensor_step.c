/* A step of the controller: what a frame asks for, and how much of it is done at once. */
#include "sensor_private.h"

#include "base/numeric.h"

/* A frame with this share of it clipped, or half of it black, says little but that: by how many stops the total then
 * moves, to look again. Six stops are the largest step of a scene that is to settle with one look more. */
#define BLIND_CLIPPED 0.97
#define BLIND_BLACK   0.5
#define BLIND_STEP_EV 6.0
#define KNOWN_EV      0.05 /* a quantile from bins is off by as much */

/* The quantile that is to stay below clip comes from bins of up to 0.32 stops and moves by as much where many pixels
 * change from one to the next. So it is aimed at below the last bin's middle, and what it asks for is far only beyond a
 * bin; the filter makes a hundredth of it, in frames that are few, too. */
#define HIGHLIGHT_AIM_EV  0.20
#define HIGHLIGHT_FAR_EV  0.35
#define HIGHLIGHT_STEP_EV 0.40
#define HIGHLIGHT_SLOW_EV 0.01
#define LEAST_STRIDE      0.125

/* Turns with less than so many frames of rest between, from which on a camera counts as one that cannot be approached;
 * and as approached. */
#define MOST_TURNS      5
#define CALM            20
#define LONG_CALM       1000
#define PATIENCE_S      1.0
#define MOST_PATIENCE_S 64.0
/* More than what is rounded down: a third of a stop, and hold_ev. */
#define UNSEEN_EV 0.4
/* Where a picture does not follow: little enough to be looked at, far enough from the noise to be seen. */
#define SMALL_STEP_EV 0.25
#define PROBE_EV      0.4
/* Of a setting that moves more than itself; more at once is rather the scene's. */
#define JUMP_LEAST     0.01
#define JUMP_MOST      0.8
#define LEAST_NOISE_EV 0.003 /* of the mean of a frame that stands still */
#define NOISES         3.0   /* a picture that is no further off than so many times its noise is near, up to */
#define NOISY_EV       0.15

/* A large step may not be in force yet. */
static int is_pending(const pupil_sensor_object *o)
{
    return o->waited < pupil_sensor_longest_wait(o) && o->answer.in_flight;
}

/* Seconds since the frame before. */
static uint32_t tick(pupil_sensor_object *o, const pupil_frame_info *info)
{
    const int64_t now = info ? info->timestamp_ns : 0, last = o->last_timestamp_ns;
    /* in double: the difference of two int64 may not fit; 2^-53 of a century is 30 ns */
    double dt_s = !o->stamped ? 0.0 : !now && !last ? o->config.frame_s : ((double)now - (double)last) * 1e-9;
    const uint32_t reason = o->stamped && now && now == last ? PUPIL_SENSOR_REPEATED_FRAME
                            : dt_s < 0.0                     ? PUPIL_SENSOR_CLOCK_BACK
                                                             : PUPIL_SENSOR_NO_REASON;
    o->setting.dt_s = dt_s > 0.0 ? dt_s : 0.0;
    o->last_timestamp_ns = now;
    o->stamped = 1;
    if (reason != PUPIL_SENSOR_REPEATED_FRAME && o->waited < PUPIL_SENSOR_DELAYS)
        o->waited++;
    return reason;
}

/* log2 of the highest total by the highlights. */
static double highlight_limit(const pupil_sensor_config *c, const pupil_sensor_light *light, double frame_log2,
                              double guess, double slope)
{
    const double room = pupil_log2(c->clip) - light->highlight;
    if (light->clipped_share > c->highlight_share || room <= 0.0) { /* by how much is not known */
        const double over = HIGHLIGHT_AIM_EV + guess - pupil_log2(c->clip);
        return frame_log2 - (over > HIGHLIGHT_STEP_EV ? over : HIGHLIGHT_STEP_EV) / slope;
    }
    return frame_log2 + (room - HIGHLIGHT_AIM_EV) / slope;
}

/* log2 of what a frame's mean, now `mean`, is to be: the key, or that at the scene's light, bent as the picture is. */
static double wanted_of(const pupil_sensor_object *o, double mean, double frame_log2)
{
    const pupil_sensor_config *c = &o->config;
    const double clip = pupil_log2(c->clip), grey = pupil_log2(c->key) + clip;
    const double ev = (mean - grey) / o->answer.slope + grey - frame_log2;
    double key = c->key_points ? pupil_log2(c->key_at[0].key) + clip : grey;
    for (const pupil_sensor_key_point *p = c->key_at + 1; p < c->key_at + c->key_points; p++)
        key += clamp((ev - p[-1].scene_ev) / (p->scene_ev - p[-1].scene_ev), 0.0, 1.0) * pupil_log2(p->key / p[-1].key);
    return grey + o->answer.slope * (key - grey) + c->ev_compensation;
}

/* log2 of the total that this frame asks for; the reason where it is not the key alone; whether it is a guess.
 *
 * A clipped frame's mean is too low, so its target lies between the frame's own total and the right one: whatever the
 * scene, one such step after another comes nearer from one side (the error that is left is the clipped share of the one
 * before). It is only where this says "far too bright" that a guess may go further, and too far; what comes after it
 * comes from the dark side, without guesses. So guesses cannot make it swing. */
static double target_of(pupil_sensor_object *o, const pupil_sensor_light *light, double frame_log2, uint32_t *reason,
                        int *guessed)
{
    const pupil_sensor_config *c = &o->config;
    double wanted = wanted_of(o, light->mean, frame_log2);
    const double slope = o->answer.slope, plain = frame_log2 + (wanted - light->mean) / slope;
    double target = plain, mean, highlight, lost;
    pupil_sensor_guess(c, light, wanted, &mean, &highlight, &lost);
    o->setting.scene_ev = light->mean - frame_log2;
    if (target < frame_log2 - c->far_ev) {
        /* what is not clipped shows how much brighter it has become since the mean was one */
        const double most = o->known_ev + o->answer.brighter + KNOWN_EV + slope * (frame_log2 - o->known_log2);
        *guessed = mean > light->mean;
        wanted = wanted_of(o, mean, frame_log2);
        target = light->clipped_share >= BLIND_CLIPPED ? frame_log2 - BLIND_STEP_EV
                                                       : frame_log2 + (wanted + lost - mean) / slope;
        target = clamp(frame_log2 + (wanted_of(o, most, frame_log2) - most) / slope, target, plain);
        highlight = highlight < most + o->known_over ? highlight : most + o->known_over;
        o->setting.scene_ev = mean - frame_log2;
    } else {
        o->known_ev = light->mean, o->known_log2 = frame_log2;
        o->known_over = (light->clipped_share > c->highlight_share ? highlight : light->highlight) - light->mean;
        o->answer.brighter = 0.0;
    }
    o->setting.wanted_ev = wanted;
    if (light->has_highlight) {
        const double most = highlight_limit(c, light, frame_log2, highlight, slope);
        if (most < target) {
            target = most > target - c->highlight_ev ? most : target - c->highlight_ev;
            *reason = PUPIL_SENSOR_HIGHLIGHTS;
        }
    }
    if (light->black_share > BLIND_BLACK && target > frame_log2 + BLIND_STEP_EV) {
        target = frame_log2 + BLIND_STEP_EV;
        *guessed = 1;
    }
    return target;
}

/* Frames that have to say the same before a step, where light that comes and goes within a frame or two would not be
 * seen as such: not while the first setting is looked for. What all of them ask for is done: *off becomes the least. */
static int is_flash(pupil_sensor_object *o, double *off)
{
    const int same_side = o->odd_frames && (o->odd_ev > 0.0) == (*off > 0.0);
    if (!same_side || (*off < 0.0 ? *off > o->odd_ev : *off < o->odd_ev))
        o->odd_ev = *off;
    o->odd_frames = same_side ? o->odd_frames + (o->odd_frames < 16) : 1;
    if (!(o->looking && !o->answer.in_flight) && o->odd_frames <= o->config.flash_frames)
        return 1;
    *off = o->odd_ev;
    return 0;
}

/* Whether the light seems to jump in the frame in which what the filter asked for comes into force, by the slope of the
 * frame before. Then it was the camera, which has no step so small, or does more than it is asked to. */
static void watch(pupil_sensor_object *o, double mean_log2, double taken_log2)
{
    const double own = o->setting.slope * (taken_log2 - o->taken_log2), left = mean_log2 - o->mean_log2 - own;
    const double size = 1.25 * (left < 0.0 ? -left : left),
                 most = 4.0 * o->noise_ev; /* of a normal deviate: 1.25 |x| */
    o->jumped += (o->jumped < 0) - (o->jumped > 0);
    if (own < 0.02 && own > -0.02)
        o->noise_ev += 0.1 * (clamp(size, LEAST_NOISE_EV, most) - o->noise_ev);
    else if (o->nudged && !o->odd_frames && size > most + JUMP_LEAST && size < JUMP_MOST)
        o->jumped = (o->nudged > 0 ? 1 : -1) * (int32_t)(o->config.flash_frames + 3);
    o->nudged += (o->nudged < 0) - (o->nudged > 0);
    o->mean_log2 = mean_log2, o->taken_log2 = taken_log2;
}

/* What is off is what the filter itself has done. */
static int is_recoil(const pupil_sensor_object *o, double off)
{
    return o->jumped && (off > 0.0) == (o->jumped < 0);
}

/* Until the light is further off than this, or for a time that grows with every vain search. */
static void stand_still(pupil_sensor_object *o, double band_ev)
{
    o->band_ev = band_ev, o->stood_s = 0.0;
    o->patience_s = clamp(4.0 * o->patience_s, PATIENCE_S, MOST_PATIENCE_S);
}

/* A large step that goes back on the one before, without any rest between them, goes half the way, the next one of that
 * kind half of that: so a camera that answers otherwise than its numbers say (a tone curve, dark areas that come and go
 * with a code) is approached and not swung around. One whose level jumps over the key is left where it was nearer,
 * until the light is further off than that, or for a time that every vain search makes longer. */
static uint32_t step(pupil_sensor_object *o, double off, int guessed)
{
    const pupil_sensor_config *c = &o->config;
    const int32_t direction = off > 0.0 ? 1 : -1;
    const double size = off < 0.0 ? -off : off;
    const int strange = o->answer.strange > 1, seen = o->answer.slopes || o->answer.dead[0] || o->answer.dead[1];
    if (o->direction == -direction || (o->last_direction == -direction && o->turns > 0))
        o->stride *= o->stride > LEAST_STRIDE ? 0.5 : 1.0;
    if (o->last_direction == -direction) {
        o->turns++;
        if (o->turns >= MOST_TURNS) {
            o->total_log2 = size > o->last_size ? o->last_total_log2 : o->total_log2;
            stand_still(o, 1.5 * (size > o->last_size ? size : o->last_size));
            o->waited = 0;
            o->direction = o->last_direction = 0;
            return PUPIL_SENSOR_HUNTING;
        }
    }
    o->same = o->last_direction == direction ? o->same + 1 : 0;
    if (o->same > 3 && o->stride < 1.0) /* it was too careful */
        o->stride *= 2.0;
    o->last_direction = direction, o->last_size = size, o->last_total_log2 = o->total_log2;
    off *= o->stride;
    off *= o->answer.slope / o->answer.steepest;
    o->looking = guessed || o->looking;
    if (!c->linear && !o->answer.slopes) {
        off *= 0.5; /* a slope of 2 is the steepest that is ordinary */
        o->looking = 1;
    }
    /* nothing of it has been seen: a step that has to be seen */
    if (o->same > 2 && !seen && size < PROBE_EV)
        off = PROBE_EV * direction;
    if (strange)
        off = clamp(off, -SMALL_STEP_EV, SMALL_STEP_EV);
    if (is_recoil(o, off)) /* back, and no more of it for a while */
        stand_still(o, 1.5 * size);
    o->total_log2 = pupil_sensor_reachable(o, o->total_log2 + pupil_sensor_way(o, off));
    o->direction = guessed ? 0 : direction;
    o->waited = 0;
    o->nudged = o->jumped = 0, o->calm = o->odd_frames = 0;
    return strange ? PUPIL_SENSOR_NONLINEAR : PUPIL_SENSOR_NO_REASON;
}

/* The wanted total, on its way to the target, which lies between low and high. Returns the reason for going slowly. */
static uint32_t move(pupil_sensor_object *o, double low, double high, double far_ev, int at_end, int guessed)
{
    const pupil_sensor_config *c = &o->config;
    const int pending = is_pending(o);
    double off = low > o->total_log2 ? low - o->total_log2 : high < o->total_log2 ? high - o->total_log2 : 0.0;
    if (off == 0.0 && o->waited >= PUPIL_SENSOR_DELAYS) /* doubt that has lasted so long ends only with what is done */
        off = clamp(o->setting.error_ev, -PROBE_EV, PROBE_EV);
    const double size = off < 0.0 ? -off : off; /* the least that is not in doubt */
    if (o->band_ev > 0.0) {
        o->stood_s += clamp(o->setting.dt_s, 0.0, PATIENCE_S / 30.0); /* of a slow camera, as many frames */
        o->odd_frames = size > o->band_ev && !pending ? o->odd_frames + 1 : 0, o->odd_ev = off;
        if (o->odd_frames <= c->flash_frames && o->stood_s < o->patience_s)
            return PUPIL_SENSOR_HUNTING;
        o->turns = o->stood_s < o->patience_s ? 0 : MOST_TURNS - 2;
        o->band_ev = 0.0;
    }
    if (size > far_ev) {
        if (is_flash(o, &off))
            return PUPIL_SENSOR_FLASH;
        return pending ? PUPIL_SENSOR_WAITING : step(o, off, guessed);
    }
    o->odd_frames = 0;
    if (is_recoil(o, off) && size > JUMP_LEAST)
        stand_still(o, 1.5 * size);
    if (pending || o->band_ev > 0.0)
        return pending ? PUPIL_SENSOR_WAITING : PUPIL_SENSOR_HUNTING;
    const uint32_t delay = pupil_sensor_longest_delay(o), gap = o->answer.gap < delay ? o->answer.gap : delay;
    const double most_weight = 0.39 * gap / delay; /* sensor.h: tau_s */
    double weight = c->tau_s > 0.0 ? pupil_one_minus_exp(o->setting.dt_s / c->tau_s) : 1.0;
    weight = weight < most_weight ? weight : most_weight;
    o->direction = 0;
    o->calm += o->calm < LONG_CALM;
    if (o->calm >= (o->answer.disobeys ? 4 * CALM : CALM))
        o->turns = 0, o->last_direction = 0;
    if (o->calm >= LONG_CALM)
        o->patience_s = 0.0;
    o->looking = 0, o->stride = 1.0;
    /* the last 5 thousandths to a limit are not seen, and then all of it is used */
    off *= at_end && off < 0.005 && off > -0.005 ? 1.0 : weight;
    o->total_log2 += o->coarse ? clamp(off, -HIGHLIGHT_SLOW_EV, HIGHLIGHT_SLOW_EV) : off;
    return PUPIL_SENSOR_NO_REASON;
}

/* After the step. */
static void judge(pupil_sensor_object *o, double beyond, double far_ev, double clipped_share, uint32_t reason,
                  uint32_t slow)
{
    pupil_sensor_setting *s = &o->setting;
    const pupil_sensor_config *c = &o->config;
    const int by_hand = c->exposure_mode != PUPIL_SENSOR_AUTO && c->gain_mode != PUPIL_SENSOR_AUTO;
    const double unseen = o->total_log2 - o->answer.taken[0] - o->answer.taken[1];
    const int far = s->error_ev > far_ev || s->error_ev < -far_ev;
    if (slow == PUPIL_SENSOR_FLASH) { /* the state is what it was */
        s->reason = slow;
        return;
    }
    s->state = PUPIL_SENSOR_CONVERGED;
    if (c->lock || by_hand) {
        s->state = PUPIL_SENSOR_LOCKED;
        reason = c->lock ? PUPIL_SENSOR_LOCK : PUPIL_SENSOR_ALL_MANUAL;
    } else if (o->answer.dead[0] || o->answer.dead[1] ||
               (o->answer.disobeys && (unseen > UNSEEN_EV || unseen < -UNSEEN_EV))) {
        s->state = PUPIL_SENSOR_LIMITED;
        reason = PUPIL_SENSOR_IGNORED;
    } else if (slow == PUPIL_SENSOR_HUNTING && o->band_ev > 0.0) {
        s->state = PUPIL_SENSOR_LIMITED;
        reason = o->answer.disobeys ? PUPIL_SENSOR_IGNORED : PUPIL_SENSOR_HUNTING;
    } else if (far || is_pending(o)) {
        s->state = clipped_share > 0.5 ? PUPIL_SENSOR_CLIPPED : PUPIL_SENSOR_SEARCHING;
        reason = slow ? slow : reason;
    } else if (beyond > 0.05 || beyond < -0.05) { /* pupil.h, too, calls a level settled within 0.05 */
        s->state = PUPIL_SENSOR_LIMITED;
        reason = pupil_sensor_limit(o, beyond > 0.0);
    } else if (c->mains_hz && s->exposure_s < 0.5 / c->mains_hz * 0.99 - c->exposure_step_s) {
        s->state = PUPIL_SENSOR_FLICKER;
        reason = PUPIL_SENSOR_BELOW_MAINS;
    }
    s->reason = reason;
}

void pupil_sensor_advance(pupil_sensor_object *o, pupil_sensor_light *light, const pupil_frame_info *info)
{
    pupil_sensor_setting *s = &o->setting;
    const pupil_sensor_config *c = &o->config;
    const pupil_sensor_answer *a = &o->answer;
    uint32_t reason = tick(o, info), slow = PUPIL_SENSOR_NO_REASON, dead = a->dead[0] | a->dead[1];
    s->changed = 0;
    if (reason != PUPIL_SENSOR_REPEATED_FRAME)
        pupil_sensor_answer_frame(o, light, info ? info->sequence : 0);
    const double frame_log2 = a->taken[0] + a->taken[1];
    if (!light->dead && reason != PUPIL_SENSOR_REPEATED_FRAME)
        pupil_flicker_frame(&o->flicker, light->middle - a->slope * frame_log2, pupil_exp2(a->taken[0]),
                            o->last_timestamp_ns);
    const int was_beat = s->flicker_ev != 0.0;
    s->flicker_ev = pupil_flicker_at(&o->flicker, o->last_timestamp_ns);
    if (s->flicker_ev != 0.0 && !was_beat) /* it was this that nothing settled in */
        o->band_ev = o->patience_s = 0.0;
    light->mean -= s->flicker_ev, light->highlight -= s->flicker_ev;
    if (light->dead || reason == PUPIL_SENSOR_REPEATED_FRAME) {
        s->reason = light->dead ? PUPIL_SENSOR_INVALID_FRAME : reason;
    } else {
        int guessed = 0;
        const double wanted = target_of(o, light, frame_log2, &reason, &guessed);
        const double target = pupil_sensor_reachable(o, wanted),
                     low = pupil_sensor_reachable(o, wanted + a->low - frame_log2);
        const double high = pupil_sensor_reachable(o, wanted + a->high - frame_log2);
        o->coarse = reason == PUPIL_SENSOR_HIGHLIGHTS ? CALM : o->coarse - (o->coarse > 0);
        const int coarse = reason == PUPIL_SENSOR_HIGHLIGHTS || (o->coarse && o->calm >= CALM);
        const double noisy_ev = clamp(NOISES * o->noise_ev, 0.0, NOISY_EV) / a->slope;
        const double far_ev = clamp(coarse ? HIGHLIGHT_FAR_EV : noisy_ev, c->far_ev, 2.0);
        s->error_ev = target - o->total_log2;
        watch(o, light->mean, frame_log2);
        s->frames++;
        if (!c->lock)
            slow = move(o, low, high, far_ev, wanted != target, guessed);
        const double set_log2 = o->set_log2;
        pupil_sensor_choose(o, !c->lock && (a->dead[0] | a->dead[1]) & ~dead & 2); /* the light is as it was told */
        if (s->changed && o->waited)
            o->nudged = (o->set_log2 > set_log2 ? 1 : -1) * (int32_t)(pupil_sensor_longest_wait(o) + 1);
        judge(o, wanted - target, far_ev, light->clipped_share, reason, slow);
    }
    s->slope = a->slope;
    s->exposure_delay = a->delay[0], s->gain_delay = a->delay[1];
    /* what multiplies values makes more of a bent picture than of light */
    const double missing = o->total_log2 - frame_log2 + (a->gain_does - 1.0) * (a->standing[1] - a->taken[1]);
    s->frame_digital = pupil_exp2(clamp(a->slope * missing, -c->digital_ev, c->digital_ev) - s->flicker_ev);
}
