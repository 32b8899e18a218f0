/* A total as an exposure time and a gain that the camera has. */
#include "sensor_private.h"

#include "base/numeric.h"

/* A total that came from its logarithm is off by a few 2^-52 of these. */
#define UP (1.0 + 1e-9)

/* The multiple of step at or below x; a millionth of a step is forgiven, so that a multiple stays itself. */
static double multiple(double x, double step)
{
    const double steps = x / step + 1e-6;
    if (!(steps < 1e15)) /* steps that a double of x cannot tell apart */
        return x;
    const double whole = (double)(int64_t)steps;
    return step * (whole > steps ? whole - 1.0 : whole);
}

static double longest(const pupil_sensor_config *c)
{
    return c->frame_rate_priority && c->frame_s < c->exposure_max_s ? c->frame_s : c->exposure_max_s;
}

static double in_lines(const pupil_sensor_config *c, double exposure_s)
{
    return c->exposure_step_s > 0.0 ? multiple(exposure_s, c->exposure_step_s) : exposure_s;
}

double pupil_sensor_exposure_of(const pupil_sensor_config *c, double exposure_s)
{
    const double half_s = c->mains_hz > PUPIL_SENSOR_MAINS_AUTO ? 0.5 / c->mains_hz : 0.0;
    double e = in_lines(c, exposure_s);
    if (half_s > 0.0 && e >= half_s - c->exposure_step_s) {
        /* a multiple that was rounded down to lines stays itself */
        const double up = in_lines(c, multiple(e + c->exposure_step_s, half_s));
        e = up <= exposure_s * (1.0 + 1e-9) ? up : in_lines(c, multiple(e, half_s));
        e = e > 0.0 ? e : in_lines(c, exposure_s);
    }
    return e < c->exposure_min_s ? c->exposure_min_s : e;
}

double pupil_sensor_gain_of(const pupil_sensor_config *c, double gain)
{
    const double db = 0.16609640474436813; /* log2(10) / 20 */
    double g = clamp(gain, c->gain_min, c->gain_max), found = 0.0;
    switch (c->gain_law) {
    case PUPIL_GAIN_LINEAR:
        g = multiple(g, c->gain_step);
        break;
    case PUPIL_GAIN_DB:
        g = pupil_exp2(multiple(pupil_log2(g), db * c->gain_step));
        break;
    case PUPIL_GAIN_RECIPROCAL:
        g = g < 1.0 ? 0.0 : c->gain_step / (c->gain_step - multiple(c->gain_step * (1.0 - 1.0 / g), 1.0));
        break;
    case PUPIL_GAIN_TABLE:
        for (uint32_t i = 0; i < c->gain_count; i++)
            found = c->gain_table[i] <= g * (1.0 + 1e-9) ? c->gain_table[i] : found;
        g = found;
        break;
    }
    return g < c->gain_min ? c->gain_min : g;
}

/* By the profile; steps only at the ends of its stages, so that these can be reached. */
static double exposure_at(const pupil_sensor_config *c, double total)
{
    double e = c->exposure_min_s, g = c->gain_min;
    const double most_s = longest(c);
    for (uint32_t i = 0; i <= c->stages + 1; i++) {
        const pupil_sensor_stage end = {i == c->stages ? c->frame_s : c->exposure_max_s, c->gain_max};
        const pupil_sensor_stage *stage = i < c->stages ? &c->stage[i] : &end;
        const double next_s = pupil_sensor_exposure_of(c, clamp(stage->exposure_s, e, most_s > e ? most_s : e));
        if (total <= next_s * g)
            return clamp(total / g, e, next_s);
        e = next_s;
        g = pupil_sensor_gain_of(c, clamp(stage->gain, g, c->gain_max));
        if (total <= e * g)
            return e;
    }
    return e;
}

void pupil_sensor_split(const pupil_sensor_object *o, double total_log2, double *exposure_s, double *gain)
{
    const pupil_sensor_config *c = &o->config;
    const double total = pupil_exp2(clamp(total_log2, -500.0, 500.0)), most_s = longest(c);
    const int held_s = c->exposure_mode != PUPIL_SENSOR_AUTO, held = c->gain_mode != PUPIL_SENSOR_AUTO;
    const double taken_s = pupil_exp2(o->answer.taken[0]), taken = pupil_exp2(o->answer.taken[1]);
    const double e0 = held_s ? o->held_exposure : pupil_sensor_exposure_of(c, taken_s < most_s ? taken_s : most_s);
    const double g0 = held ? o->held_gain : pupil_sensor_gain_of(c, taken);
    double e = held ? total / g0 : exposure_at(c, total), g = 0.0;
    /* a control that does nothing is as good as held where it is; it is asked for more only where the other one ends */
    if (o->answer.dead[1])
        e = total / taken, g = e >= c->exposure_min_s && e <= most_s ? g0 : 0.0;
    if (o->answer.dead[0] && !held) {
        g = g > 0.0 ? g : pupil_sensor_gain_of(c, total / taken_s);
        e = total >= taken_s * c->gain_min && total <= taken_s * c->gain_max ? e0 : total / g;
    }
    e = held_s ? e0 : pupil_sensor_exposure_of(c, clamp(e, c->exposure_min_s, most_s));
    *exposure_s = e;
    *gain = held ? g0 : g > 0.0 ? g : pupil_sensor_gain_of(c, total / e);
}

/* A control that does nothing stays where it is; and a stop beyond: should it do something after all, that shows it. */
double pupil_sensor_reachable(const pupil_sensor_object *o, double wanted)
{
    const pupil_sensor_config *c = &o->config;
    const pupil_sensor_answer *a = &o->answer;
    double least = o->least_log2, most = o->most_log2;
    if (a->dead[0] && !a->dead[1] && c->gain_mode == PUPIL_SENSOR_AUTO)
        least = a->taken[0] + pupil_log2(0.5 * c->gain_min), most = a->taken[0] + pupil_log2(2.0 * c->gain_max);
    if (a->dead[1] && !a->dead[0] && c->exposure_mode == PUPIL_SENSOR_AUTO)
        least = a->taken[1] + pupil_log2(0.5 * c->exposure_min_s), most = a->taken[1] + pupil_log2(2.0 * longest(c));
    return clamp(wanted, least, most);
}

double pupil_sensor_shorter(const pupil_sensor_object *o, double exposure_log2)
{
    const double e = pupil_exp2(exposure_log2), line_s = o->config.exposure_step_s, less = e - line_s;
    return pupil_log2((less > line_s ? less : line_s) / e);
}

/* log2 of what the controls do beyond exposure x gain, by what has been seen. A line that is missing is believed before
 * it is certain: that only makes steps shorter. */
static double beyond(const pupil_sensor_object *o, double exposure, double gain)
{
    const pupil_sensor_answer *a = &o->answer;
    return (a->gain_does - 1.0) * gain + (a->short_steps > 1 ? pupil_sensor_shorter(o, exposure) : 0.0);
}

/* As far as it passes the place for certain; where that makes the step too long, as far as it may. */
double pupil_sensor_jump(const pupil_sensor_answer *a, double from, double to, double off)
{
    const double low = from < to ? from : to, high = from < to ? to : from, more = from < to ? a->jump : -a->jump;
    const int passes = more * off > 0.0 ? high > a->place[0] + 1e-9 && low < a->place[1] - 1e-9
                                        : high > a->place[1] - 1e-9 && low < a->place[0] + 1e-9;
    return a->jumps > 1 && a->gain_does == 1.0 && passes && low < high ? more : 0.0;
}

double pupil_sensor_way(const pupil_sensor_object *o, double off)
{
    const double now = beyond(o, o->answer.taken[0], o->answer.taken[1]);
    double way = off, e, g;
    for (int i = 0; i < 5; i++) { /* half of what is left, at worst, is left by each */
        pupil_sensor_split(o, o->total_log2 + way, &e, &g);
        const double more = beyond(o, pupil_log2(e), pupil_log2(g)) +
                            pupil_sensor_jump(&o->answer, o->answer.taken[1], pupil_log2(g), off);
        way = off * clamp(1.0 + (now - more) / off, 0.5, 2.0);
    }
    return way;
}

uint32_t pupil_sensor_limits(const pupil_sensor_object *o)
{
    const pupil_sensor_config *c = &o->config;
    double most_s, most;
    uint32_t limits = 0;
    pupil_sensor_split(o, 500.0, &most_s, &most);
    if (c->exposure_mode == PUPIL_SENSOR_AUTO) {
        limits |= o->setting.exposure_s <= c->exposure_min_s * UP ? 1u << PUPIL_SENSOR_AT_EXPOSURE_MIN : 0;
        const int end = longest(c) < c->exposure_max_s ? PUPIL_SENSOR_AT_FRAME_PERIOD : PUPIL_SENSOR_AT_EXPOSURE_MAX;
        limits |= o->setting.exposure_s * UP >= most_s ? 1u << end : 0;
    }
    if (c->gain_mode == PUPIL_SENSOR_AUTO) {
        limits |= o->setting.gain <= c->gain_min * UP ? 1u << PUPIL_SENSOR_AT_GAIN_MIN : 0;
        limits |= o->setting.gain * UP >= most ? 1u << PUPIL_SENSOR_AT_GAIN_MAX : 0;
    }
    return limits;
}

/* The control that would have had to go on: the profile ends with the gain where it is dark, and begins with the
 * exposure. */
uint32_t pupil_sensor_limit(const pupil_sensor_object *o, int dark)
{
    const pupil_sensor_config *c = &o->config;
    if (!dark)
        return c->exposure_mode == PUPIL_SENSOR_AUTO ? PUPIL_SENSOR_AT_EXPOSURE_MIN : PUPIL_SENSOR_AT_GAIN_MIN;
    if (c->gain_mode == PUPIL_SENSOR_AUTO)
        return PUPIL_SENSOR_AT_GAIN_MAX;
    return longest(c) < c->exposure_max_s ? PUPIL_SENSOR_AT_FRAME_PERIOD : PUPIL_SENSOR_AT_EXPOSURE_MAX;
}

/* The setting for the wanted total, unless that is near enough to when it was last chosen. */
void pupil_sensor_choose(pupil_sensor_object *o, int anew)
{
    pupil_sensor_setting *s = &o->setting;
    const double moved = o->total_log2 - o->set_log2, exposure_s = s->exposure_s, gain = s->gain;
    anew |= o->total_log2 >= o->most_log2 || o->total_log2 <= o->least_log2;
    if (anew || moved > o->config.hold_ev || moved < -o->config.hold_ev) {
        pupil_sensor_split(o, o->total_log2, &s->exposure_s, &s->gain);
        o->set_log2 = o->total_log2;
        o->answer.standing[0] = pupil_log2(s->exposure_s);
        o->answer.standing[1] = pupil_log2(s->gain);
    }
    s->changed = s->exposure_s != exposure_s || s->gain != gain;
    s->total_s = pupil_exp2(o->total_log2);
    s->digital = s->total_s / (s->exposure_s * s->gain);
    s->limits = pupil_sensor_limits(o);
}
