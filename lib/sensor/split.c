/* A total as an exposure time and a gain that the camera has. */
#include "sensor_private.h"

#include "base/numeric.h"

/* The multiple of step at or below x; a millionth of a step is forgiven, so that a multiple stays itself. */
static double multiple(double x, double step)
{
    const double steps = x / step + SENSOR_STEP_SHARE;
    if (!(steps < SENSOR_STEPS_MOST)) /* steps too fine for a double of x */
        return x;
    const double whole = (double)(int64_t)steps;
    return step * (whole > steps ? whole - 1.0 : whole);
}

/* The longest exposure that the camera has up to this one: from its table, or in lines. */
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

/* In lines, but at least exposure_min_s. */
static double line_at_least(const pupil_sensor_config *c, double exposure_s)
{
    const double e = in_lines(c, exposure_s);
    return larger(e, c->exposure_min_s);
}

/* The longest table entry up to this exposure that is a multiple of half a mains period; 0: none. */
static double multiple_in_table(const pupil_sensor_config *c, double half_s, double exposure_s)
{
    double found = 0.0;
    for (uint32_t i = 0; i < c->exposure_count && c->exposure_table[i] <= exposure_s * (1.0 + SENSOR_ROUND); i++) {
        const double entry_s = c->exposure_table[i], off_s = entry_s - multiple(entry_s + 0.5 * half_s, half_s);
        found = entry_s >= 0.5 * half_s && size_of(off_s) < SENSOR_NEAR_MULTIPLE * half_s ? entry_s : found;
    }
    return found;
}

/* In lines, and in half mains periods. If a table has no such exposure, any entry is taken: a shorter one would have
 * bands, too. */
static double exposure_of(const pupil_sensor_config *c, uint32_t hz, double exposure_s)
{
    const double half_s = hz ? 0.5 / hz : 0.0;
    double e = in_lines(c, exposure_s);
    if (half_s > 0.0 && c->exposure_count) {
        const double in_table = multiple_in_table(c, half_s, exposure_s);
        e = in_table > 0.0 ? in_table : e;
    } else if (half_s > 0.0 && e >= half_s - c->exposure_step_s) {
        /* a multiple that was rounded down to lines stays itself */
        const double up = in_lines(c, multiple(e + c->exposure_step_s, half_s));
        e = up <= exposure_s * (1.0 + SENSOR_ROUND) ? up : in_lines(c, multiple(e, half_s));
        e = e > 0.0 ? e : in_lines(c, exposure_s);
    }
    return larger(e, c->exposure_min_s);
}

double pupil_sensor_exposure_of(const pupil_sensor_config *c, double exposure_s)
{
    /* until the frequency is found, that of most of the world */
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
    return larger(g, c->gain_min);
}

/* The exposure by the profile: rounded only at the ends of stages, so that these can be reached. */
static double exposure_at(const pupil_sensor_config *c, double total)
{
    double e = c->exposure_min_s, g = c->gain_min;
    const double most_s = pupil_sensor_longest_exposure(c);
    for (uint32_t i = 0; i <= c->stages + 1; i++) {
        const pupil_sensor_stage end = {i == c->stages ? c->frame_s : c->exposure_max_s, c->gain_max};
        const pupil_sensor_stage *stage = i < c->stages ? &c->stage[i] : &end;
        const double next_s = pupil_sensor_exposure_of(c, clamp(stage->exposure_s, e, larger(most_s, e)));
        if (total <= next_s * g)
            return clamp(total / g, e, next_s);
        e = next_s;
        g = pupil_sensor_gain_of(c, clamp(stage->gain, g, c->gain_max));
        if (total <= e * g)
            return e;
    }
    return e;
}

/* The next larger gain that the camera has, or the same. */
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

/* The next longer exposure that the camera has, or the same. */
static double next_exposure(const pupil_sensor_config *c, uint32_t hz, double exposure_s)
{
    const double above_s = exposure_s * (1.0 + SENSOR_ROUND), half_s = hz ? 0.5 / hz : 0.0;
    double next_s = exposure_of(c, hz, above_s + c->exposure_step_s);
    if (hz && next_s <= above_s)
        next_s = exposure_of(c, hz, above_s + half_s + c->exposure_step_s);
    for (uint32_t i = c->exposure_count; i > 0; i--) {
        const double entry_s = exposure_of(c, hz, c->exposure_table[i - 1]);
        next_s = entry_s > above_s ? entry_s : next_s;
    }
    return next_s > above_s && next_s <= pupil_sensor_longest_exposure(c) ? next_s : exposure_s;
}

/* A setting, and the stops by which it misses the total. */
typedef struct sensor_fit {
    double exposure_s, gain, off_ev;
} sensor_fit;

static void take_nearer(const pupil_sensor_object *o, sensor_fit *fit, double total, double exposure_s, double gain)
{
    const double off_ev = size_of(pupil_log2(total / (pupil_sensor_told(o, exposure_s) * gain)));
    if (off_ev < fit->off_ev)
        *fit = (sensor_fit){exposure_s, gain, off_ev};
}

/* On a camera that rounds exposures: tries the known ones near the profile's exposure, and one between two of them. */
static void fit_told(const pupil_sensor_object *o, double total, int is_fixed, sensor_fit *fit)
{
    const pupil_sensor_config *c = &o->config;
    const double most_s = pupil_sensor_longest_exposure(c), fixed = fit->gain, wanted_s = fit->exposure_s;
    for (uint32_t i = 0; i < o->told.count; i++) {
        const double e = o->told.range[i].low_s, probe_s = pupil_sensor_told_probe(o, e);
        const double off_ev = size_of(pupil_log2(o->told.range[i].told_s / wanted_s));
        if (off_ev > SENSOR_COARSE_STEP_EV + SENSOR_SAME_EV)
            continue;
        const double g = is_fixed ? fixed : pupil_sensor_gain_of(c, total / o->told.range[i].told_s);
        take_nearer(o, fit, total, e, g);
        take_nearer(o, fit, total, e, is_fixed ? fixed : next_gain(c, g));
        if (probe_s <= most_s)
            take_nearer(o, fit, total, line_at_least(c, probe_s), fixed);
    }
}

/* If the nearest known one is too short, and the next longer one is not known: asks for one that is as far beyond the
 * total, or in the middle of the unknown range. If the camera has one in between, it is nearer. */
static void probe_told(const pupil_sensor_object *o, uint32_t hz, double total, sensor_fit *fit)
{
    const pupil_sensor_config *c = &o->config;
    const double told_s = pupil_sensor_told(o, fit->exposure_s), beyond_s = total / fit->gain;
    const double mirrored_s = beyond_s * beyond_s / told_s, between_s = pupil_sensor_told_probe(o, fit->exposure_s);
    const double probe_s = mirrored_s > between_s ? exposure_of(c, hz, mirrored_s) : line_at_least(c, between_s);
    if (beyond_s > told_s && probe_s > beyond_s && fit->off_ev > SENSOR_COARSE_EV &&
        probe_s <= pupil_sensor_longest_exposure(c) && pupil_sensor_told(o, probe_s) == probe_s)
        fit->exposure_s = probe_s;
}

/* What rounding down loses is left to the digital factor. With coarse steps that could be much of a stop: then the
 * setting nearest to the total is taken. Bands of lamps are worse than half a stop of digital gain. */
static void fit_coarse(const pupil_sensor_object *o, uint32_t hz, double total, int is_fixed_s, int is_fixed,
                       sensor_fit *fit)
{
    const pupil_sensor_config *c = &o->config;
    const double e = fit->exposure_s, g = fit->gain, next = is_fixed ? g : next_gain(c, g);
    const double banded_s = hz ? 0.5 / hz - c->exposure_step_s : 0.0;
    if (fit->off_ev <= SENSOR_COARSE_EV)
        return;
    const double shorter = is_fixed_s || next <= g ? e : exposure_of(c, hz, total / next);
    const int has_bands = e >= banded_s && shorter < banded_s;
    if (!has_bands)
        take_nearer(o, fit, total, shorter, next);
    if (is_fixed_s || fit->off_ev <= SENSOR_COARSE_EV)
        return;
    const double longer = next_exposure(c, hz, e);
    take_nearer(o, fit, total, longer, is_fixed ? g : pupil_sensor_gain_of(c, total / pupil_sensor_told(o, longer)));
    take_nearer(o, fit, total, has_bands ? exposure_of(c, hz, clamp(0.5 / hz, 0.0, e)) : next_exposure(c, hz, shorter),
                next);
    const int is_end = size_of(pupil_log2(total)) >= SENSOR_TOTAL_END_EV - 1.0;
    if (o->told.count && !is_end)
        fit_told(o, total, is_fixed, fit);
    if (o->told.count && !is_end)
        probe_told(o, hz, total, fit);
    if (fit->off_ev > 0.5)
        take_nearer(o, fit, total, shorter, next);
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
    /* pinned values come from rounded logarithms */
    const double pinned_s = clamp(in_lines(c, pupil_exp2(s->pinned[0])), c->exposure_min_s, c->exposure_max_s);
    const double fixed_s = is_held_s ? o->held_exposure : pinned_s;
    const double fixed = is_held ? o->held_gain : pupil_sensor_gain_of(c, pupil_exp2(s->pinned[1]));
    double e = is_fixed ? total / fixed : exposure_at(c, total);
    const double within = clamp(e, c->exposure_min_s, most_s);
    /* a search that moves only the exposure needs steps finer than half periods of mains that nobody has seen */
    const int is_fine = is_auto && is_pinned[1] && !is_held;
    e = is_fixed_s ? fixed_s : is_fine ? line_at_least(c, within) : pupil_sensor_exposure_of(c, within);
    sensor_fit fit = {e, is_fixed ? fixed : pupil_sensor_gain_of(c, total / pupil_sensor_told(o, e)), 0.0};
    uint32_t hz = is_auto ? SENSOR_USUAL_MAINS_HZ : c->mains_hz;
    /* at the dark end any exposure is taken, unless multiples were asked for or there is a longer one */
    const int may_be_any =
        is_auto || (o->setting.mains == PUPIL_SENSOR_MAINS_FOUND && next_exposure(c, c->mains_hz, e) <= e);
    if (may_be_any && !is_fixed_s && fit.gain >= pupil_sensor_gain_of(c, c->gain_max) && total > e * fit.gain) {
        fit.exposure_s = line_at_least(c, total / fit.gain < most_s ? total / fit.gain : most_s);
        hz = 0;
    }
    fit.off_ev = size_of(pupil_log2(total / (pupil_sensor_told(o, fit.exposure_s) * fit.gain)));
    fit_coarse(o, is_fine ? 0 : hz, total, is_fixed_s, is_fixed, &fit);
    *exposure_s = fit.exposure_s;
    *gain = fit.gain;
}

void pupil_sensor_split(const pupil_sensor_object *o, double total_log2, double *exposure_s, double *gain)
{
    split(o, o->search.is_pinned, total_log2, exposure_s, gain);
    *exposure_s = pupil_sensor_told_ask(o, *exposure_s);
}

void pupil_sensor_split_freely(const pupil_sensor_object *o, double total_log2, double *exposure_s, double *gain)
{
    static const uint32_t none[SENSOR_CONTROLS] = {0, 0};
    split(o, none, total_log2, exposure_s, gain);
}

void pupil_sensor_ends(const pupil_sensor_object *o, double darkest[SENSOR_CONTROLS], double brightest[SENSOR_CONTROLS])
{
    double e, g;
    pupil_sensor_split_freely(o, -SENSOR_TOTAL_END_EV, &e, &g);
    darkest[0] = pupil_log2(pupil_sensor_told(o, e));
    darkest[1] = pupil_log2(g);
    pupil_sensor_split_freely(o, SENSOR_TOTAL_END_EV, &e, &g);
    brightest[0] = pupil_log2(pupil_sensor_told(o, e));
    brightest[1] = pupil_log2(g);
}

uint32_t pupil_sensor_limits(const pupil_sensor_object *o)
{
    const pupil_sensor_config *c = &o->config;
    double most_s, gain;
    uint32_t limits = 0;
    pupil_sensor_split_freely(o, SENSOR_TOTAL_END_EV, &most_s, &gain);
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

/* The control whose limit is to be named: in the dark the profile ends with the gain, and in bright light it begins
 * with the exposure. */
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
