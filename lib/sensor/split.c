/* A total as an exposure time and a gain that the camera has. */
#include "sensor_private.h"

#include "base/numeric.h"

/* The multiple of step at or below x; a millionth of a step is forgiven, so that a multiple stays itself. */
static double multiple(double x, double step)
{
    const double steps = x / step + SENSOR_STEP_SHARE;
    if (!(steps < SENSOR_STEPS_MOST)) /* steps that a double of x cannot tell apart */
        return x;
    const double whole = (double)(int64_t)steps;
    return step * (whole > steps ? whole - 1.0 : whole);
}

double pupil_sensor_longest_exposure(const pupil_sensor_config *c)
{
    return c->frame_rate_priority && c->frame_s < c->exposure_max_s ? c->frame_s : c->exposure_max_s;
}

/* The exposure at or below one that the camera has; its table, or lines. */
static double in_lines(const pupil_sensor_config *c, double exposure_s)
{
    double found = c->exposure_min_s;
    if (!c->exposure_count)
        return c->exposure_step_s > 0.0 ? multiple(exposure_s, c->exposure_step_s) : exposure_s;
    for (uint32_t i = 0; i < c->exposure_count; i++)
        if (c->exposure_table[i] <= exposure_s * (1.0 + SENSOR_ROUND) && c->exposure_table[i] > found)
            found = c->exposure_table[i];
    return found;
}

/* In lines, but never none. */
static double line_at_least(const pupil_sensor_config *c, double exposure_s)
{
    const double e = in_lines(c, exposure_s);
    return e > c->exposure_min_s ? e : c->exposure_min_s;
}

/* In lines, and in half periods of the mains. */
static double exposure_of(const pupil_sensor_config *c, uint32_t hz, double exposure_s)
{
    const double half_s = hz ? 0.5 / hz : 0.0;
    double e = in_lines(c, exposure_s);
    if (half_s > 0.0 && e >= half_s - c->exposure_step_s) {
        /* a multiple that was rounded down to lines stays itself */
        const double up = in_lines(c, multiple(e + c->exposure_step_s, half_s));
        e = up <= exposure_s * (1.0 + SENSOR_ROUND) ? up : in_lines(c, multiple(e, half_s));
        e = e > 0.0 ? e : in_lines(c, exposure_s);
    }
    return e < c->exposure_min_s ? c->exposure_min_s : e;
}

double pupil_sensor_exposure_of(const pupil_sensor_config *c, double exposure_s)
{
    /* where the frequency is to be found, that of most of the world until it is */
    return exposure_of(c, c->mains_hz == PUPIL_SENSOR_MAINS_AUTO ? SENSOR_USUAL_MAINS_HZ : c->mains_hz, exposure_s);
}

double pupil_sensor_held_exposure_of(const pupil_sensor_config *c, double exposure_s)
{
    return exposure_of(c, c->mains_hz == PUPIL_SENSOR_MAINS_AUTO ? 0 : c->mains_hz, exposure_s);
}

double pupil_sensor_gain_of(const pupil_sensor_config *c, double gain)
{
    double g = clamp(gain, c->gain_min, c->gain_max), found = 0.0;
    switch (c->gain_law) {
    case PUPIL_GAIN_LINEAR:
        g = multiple(g, c->gain_step);
        break;
    case PUPIL_GAIN_DB:
        g = pupil_exp2(multiple(pupil_log2(g), SENSOR_LOG2_DB * c->gain_step));
        break;
    case PUPIL_GAIN_RECIPROCAL:
        g = g < 1.0 ? 0.0 : c->gain_step / (c->gain_step - multiple(c->gain_step * (1.0 - 1.0 / g), 1.0));
        break;
    case PUPIL_GAIN_TABLE:
        for (uint32_t i = 0; i < c->gain_count; i++)
            found = c->gain_table[i] <= g * (1.0 + SENSOR_ROUND) ? c->gain_table[i] : found;
        g = found;
        break;
    }
    return g < c->gain_min ? c->gain_min : g;
}

/* By the profile; steps only at the ends of its stages, so that these can be reached. */
static double exposure_at(const pupil_sensor_config *c, double total)
{
    double e = c->exposure_min_s, g = c->gain_min;
    const double most_s = pupil_sensor_longest_exposure(c);
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

/* The next gain above one that the camera has. */
static double next_gain(const pupil_sensor_config *c, double gain)
{
    double next = gain;
    switch (c->gain_law) {
    case PUPIL_GAIN_LINEAR:
        next = gain + c->gain_step;
        break;
    case PUPIL_GAIN_DB:
        next = gain * pupil_exp2(SENSOR_LOG2_DB * c->gain_step);
        break;
    case PUPIL_GAIN_RECIPROCAL:
        next = c->gain_step / (c->gain_step / gain - 1.0);
        break;
    case PUPIL_GAIN_TABLE:
        for (uint32_t i = c->gain_count; i > 0; i--)
            next = c->gain_table[i - 1] > gain * (1.0 + SENSOR_ROUND) ? c->gain_table[i - 1] : next;
        break;
    }
    return next > gain && next <= c->gain_max ? pupil_sensor_gain_of(c, next * (1.0 + SENSOR_ROUND)) : gain;
}

/* The gain is at its most. Of mains that nobody has seen nothing is kept: all exposure there is. Else, where gains do
 * not reach from one multiple of a half period to the next, the nearer one is taken. */
static void fit_dark_end(const pupil_sensor_config *c, double total, int is_fixed, double *exposure_s, double *gain)
{
    const double most_s = pupil_sensor_longest_exposure(c), left = pupil_log2(total / (*exposure_s * *gain));
    if (c->mains_hz == PUPIL_SENSOR_MAINS_AUTO) {
        *exposure_s = line_at_least(c, total / *gain < most_s ? total / *gain : most_s);
        return;
    }
    if (left <= SENSOR_COARSE_EV || !c->mains_hz || is_fixed)
        return;
    const double next_s = pupil_sensor_exposure_of(c, *exposure_s + 0.5 / c->mains_hz + c->exposure_step_s);
    const double least = pupil_sensor_gain_of(c, total / next_s);
    if (next_s > *exposure_s && next_s <= most_s && size_of(pupil_log2(total / (next_s * least))) < left) {
        *exposure_s = next_s;
        *gain = least;
    }
}

/* What rounding down both leaves is the digital factor's. Where gains are far apart that would be much of a stop: then
 * the next gain is taken, with a shorter exposure if there is one. */
static void fit_coarse(const pupil_sensor_config *c, double total, int is_fixed, double *exposure_s, double *gain)
{
    const double left = pupil_log2(total / (*exposure_s * *gain)), next = next_gain(c, *gain);
    if (left <= SENSOR_COARSE_EV || next <= *gain)
        return;
    const double shorter = is_fixed ? *exposure_s : pupil_sensor_exposure_of(c, total / next);
    const double e = shorter * next >= total * pupil_exp2(-SENSOR_COARSE_EV) ? shorter : *exposure_s;
    if (size_of(pupil_log2(total / (e * next))) >= left)
        return;
    *exposure_s = e;
    *gain = next;
}

/* Where only the exposure is left, and its steps are as far apart: the next one, if it is nearer. */
static void fit_lines(const pupil_sensor_config *c, double total, double gain, double *exposure_s)
{
    const double left = pupil_log2(total / (*exposure_s * gain));
    const double longer = pupil_sensor_exposure_of(c, (*exposure_s + c->exposure_step_s) * (1.0 + SENSOR_ROUND));
    if (left > SENSOR_COARSE_EV && longer <= pupil_sensor_longest_exposure(c) &&
        size_of(pupil_log2(total / (longer * gain))) < left)
        *exposure_s = longer;
}

/* is_pinned: which controls the search has pinned. */
static void split(const pupil_sensor_object *o, const uint32_t is_pinned[SENSOR_CONTROLS], double total_log2,
                  double *exposure_s, double *gain)
{
    const pupil_sensor_config *c = &o->config;
    const sensor_search *s = &o->search;
    const double total = pupil_exp2(clamp(total_log2, -SENSOR_TOTAL_END_EV, SENSOR_TOTAL_END_EV));
    const double most_s = pupil_sensor_longest_exposure(c);
    const int is_held_s = c->exposure_mode != PUPIL_SENSOR_AUTO, is_held = c->gain_mode != PUPIL_SENSOR_AUTO;
    const int is_fixed_s = is_held_s || is_pinned[0], is_fixed = is_held || is_pinned[1];
    const int is_auto = c->mains_hz == PUPIL_SENSOR_MAINS_AUTO;
    /* the logarithms of what is pinned are rounded */
    const double pinned_s = clamp(in_lines(c, pupil_exp2(s->pinned[0])), c->exposure_min_s, c->exposure_max_s);
    const double fixed_s = is_held_s ? o->held_exposure : pinned_s;
    const double fixed = is_held ? o->held_gain : pupil_sensor_gain_of(c, pupil_exp2(s->pinned[1]));
    double e = is_fixed ? total / fixed : exposure_at(c, total);
    const double within = clamp(e, c->exposure_min_s, most_s);
    /* a search that has only the exposure left does not get on in half periods of mains that nobody has seen */
    const int is_fine = is_auto && is_pinned[1] && !is_held;
    e = is_fixed_s ? fixed_s : is_fine ? line_at_least(c, within) : pupil_sensor_exposure_of(c, within);
    *exposure_s = e;
    *gain = is_fixed ? fixed : pupil_sensor_gain_of(c, total / e);
    if (total > e * *gain && !is_fixed_s && *gain >= pupil_sensor_gain_of(c, c->gain_max))
        fit_dark_end(c, total, is_fixed, exposure_s, gain);
    else if (total > e * *gain && !is_fixed)
        fit_coarse(c, total, is_fixed_s, exposure_s, gain);
    if (!is_fixed_s)
        fit_lines(c, total, *gain, exposure_s);
}

void pupil_sensor_split(const pupil_sensor_object *o, double total_log2, double *exposure_s, double *gain)
{
    split(o, o->search.is_pinned, total_log2, exposure_s, gain);
}

/* The setting at an end of the path, with nothing pinned. */
static void end_of(const pupil_sensor_object *o, double total_log2, double *exposure_s, double *gain)
{
    static const uint32_t none[SENSOR_CONTROLS] = {0, 0};
    split(o, none, total_log2, exposure_s, gain);
}

void pupil_sensor_ends(const pupil_sensor_object *o, double darkest[SENSOR_CONTROLS], double brightest[SENSOR_CONTROLS])
{
    double e, g;
    end_of(o, -SENSOR_TOTAL_END_EV, &e, &g);
    darkest[0] = pupil_log2(e);
    darkest[1] = pupil_log2(g);
    end_of(o, SENSOR_TOTAL_END_EV, &e, &g);
    brightest[0] = pupil_log2(e);
    brightest[1] = pupil_log2(g);
}

uint32_t pupil_sensor_limits(const pupil_sensor_object *o)
{
    const pupil_sensor_config *c = &o->config;
    double most_s, gain;
    uint32_t limits = 0;
    end_of(o, SENSOR_TOTAL_END_EV, &most_s, &gain);
    if (c->exposure_mode == PUPIL_SENSOR_AUTO) {
        limits |=
            o->setting.exposure_s <= c->exposure_min_s * (1.0 + SENSOR_ROUND) ? 1u << PUPIL_SENSOR_AT_EXPOSURE_MIN : 0;
        const int end = pupil_sensor_longest_exposure(c) < c->exposure_max_s ? PUPIL_SENSOR_AT_FRAME_PERIOD
                                                                             : PUPIL_SENSOR_AT_EXPOSURE_MAX;
        limits |= o->setting.exposure_s * (1.0 + SENSOR_ROUND) >= most_s ? 1u << end : 0;
    }
    if (c->gain_mode == PUPIL_SENSOR_AUTO) {
        limits |= o->setting.gain <= c->gain_min * (1.0 + SENSOR_ROUND) ? 1u << PUPIL_SENSOR_AT_GAIN_MIN : 0;
        limits |= o->setting.gain * (1.0 + SENSOR_ROUND) >= pupil_sensor_gain_of(c, c->gain_max)
                      ? 1u << PUPIL_SENSOR_AT_GAIN_MAX
                      : 0;
    }
    return limits;
}

/* The control that would have had to go on: the profile ends with the gain where it is dark, and begins with the
 * exposure. */
uint32_t pupil_sensor_limit(const pupil_sensor_object *o, int is_dark)
{
    const pupil_sensor_config *c = &o->config;
    if (!is_dark)
        return c->exposure_mode == PUPIL_SENSOR_AUTO ? PUPIL_SENSOR_AT_EXPOSURE_MIN : PUPIL_SENSOR_AT_GAIN_MIN;
    if (c->gain_mode == PUPIL_SENSOR_AUTO)
        return PUPIL_SENSOR_AT_GAIN_MAX;
    return pupil_sensor_longest_exposure(c) < c->exposure_max_s ? PUPIL_SENSOR_AT_FRAME_PERIOD
                                                                : PUPIL_SENSOR_AT_EXPOSURE_MAX;
}
