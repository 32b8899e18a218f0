/* Cameras whose exposures are coarser than configured: webcams that know only powers of two round what they are asked
 * for, and report the rounded exposure in the metadata. Once the picture has shown that the metadata are right, what
 * became of each requested exposure is remembered: a whole range of requests becomes the same exposure. */
#include "sensor_private.h"

#include "base/numeric.h"

void pupil_sensor_forget_told(pupil_sensor_object *o)
{
    o->told.is_trusted = o->told.count = o->told.next = 0;
}

static double low_of(const sensor_told_range *r)
{
    return smaller(r->low_s, r->told_s);
}

static double high_of(const sensor_told_range *r)
{
    return larger(r->high_s, r->told_s);
}

/* The range that an exposure is in: a request between two that became the same exposure becomes the same, too. */
static const sensor_told_range *range_of(const sensor_told *t, double exposure_s)
{
    for (uint32_t i = 0; i < t->count; i++) {
        const sensor_told_range *r = &t->range[i];
        if (exposure_s >= low_of(r) * (1.0 - SENSOR_ROUND) && exposure_s <= high_of(r) * (1.0 + SENSOR_ROUND))
            return r;
    }
    return 0;
}

/* The next longer range than one, if it is within the coarsest step. */
static const sensor_told_range *next_above(const sensor_told *t, const sensor_told_range *r)
{
    const sensor_told_range *next = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        const double low_s = low_of(&t->range[i]);
        if (low_s > high_of(r) && low_s < (next ? low_of(next) : pupil_exp2(SENSOR_COARSE_STEP_EV) * high_of(r)))
            next = &t->range[i];
    }
    return next;
}

/* The end of the unknown above a range: the next range, or the coarsest step, or the longest exposure. */
static double end_above(const pupil_sensor_object *o, const sensor_told_range *r, const sensor_told_range *next)
{
    const double most_s = pupil_sensor_longest_exposure(&o->config), coarse = pupil_exp2(SENSOR_COARSE_STEP_EV);
    const double step_s = coarse * (coarse * r->told_s > high_of(r) ? r->told_s : high_of(r));
    return next ? low_of(next) : smaller(step_s, most_s);
}

/* The middle of it, in stops. */
static double middle_above(const pupil_sensor_object *o, const sensor_told_range *r, const sensor_told_range *next)
{
    return high_of(r) * pupil_exp2(0.5 * pupil_log2(end_above(o, r, next) / high_of(r)));
}

/* The range that an exposure is in, or is assumed to be in: an untried one belongs to its nearer neighbour, except in
 * the middle. Above the longest known range it may have one of its own. */
static const sensor_told_range *likely_range_of(const pupil_sensor_object *o, double exposure_s)
{
    const sensor_told *t = &o->told;
    const sensor_told_range *found = range_of(t, exposure_s);
    /* a search of exposures tries what it likes */
    const int is_open = !(o->search.is_searching && o->search.is_pinned[SENSOR_GAIN]);
    for (uint32_t i = 0; is_open && !found && i < t->count; i++) {
        const sensor_told_range *r = &t->range[i], *next = next_above(t, r);
        if (exposure_s < high_of(r) || (next && exposure_s > low_of(next)))
            continue;
        const double middle_s = middle_above(o, r, next), off_s = exposure_s - middle_s;
        if (size_of(off_s) > o->config.exposure_step_s + SENSOR_STEP_SHARE * middle_s)
            found = off_s < 0.0 ? r : next;
    }
    return found;
}

double pupil_sensor_told(const pupil_sensor_object *o, double exposure_s)
{
    const sensor_told_range *r = likely_range_of(o, exposure_s);
    return r ? r->told_s : exposure_s;
}

double pupil_sensor_told_ask(const pupil_sensor_object *o, double exposure_s)
{
    const sensor_told_range *r = likely_range_of(o, exposure_s);
    return r ? clamp(exposure_s, r->low_s, r->high_s) : exposure_s;
}

double pupil_sensor_told_probe(const pupil_sensor_object *o, double exposure_s)
{
    const sensor_told_range *r = likely_range_of(o, exposure_s), *next = r ? next_above(&o->told, r) : 0;
    if (!r)
        return exposure_s;
    const double end_s = end_above(o, r, next), step_ev = pupil_log2((next ? next->told_s : end_s) / r->told_s);
    if (pupil_log2(end_s / high_of(r)) > 0.5 * step_ev + SENSOR_ROUND)
        return middle_above(o, r, next);
    /* steps are even: if half of one was tried, the other half has nothing but its end */
    return next ? exposure_s : end_s + o->config.exposure_step_s;
}

/* Stops by which the picture moved outside what a step may do with any tone curve. */
static double missed(double step, double seen)
{
    const double low = step * (step < 0.0 ? SENSOR_STEEP_MOST : SENSOR_STEEP_LEAST);
    const double high = step * (step < 0.0 ? SENSOR_STEEP_LEAST : SENSOR_STEEP_MOST);
    return seen < low ? low - seen : seen > high ? seen - high : 0.0;
}

/* Compares by the learned slope, or else by any slope that a tone curve may have. */
void pupil_sensor_weigh_told(pupil_sensor_object *o, double asked, double told, double seen)
{
    const double slope = 0.5 * (o->estimate.response[0] + o->estimate.response[1]);
    const double by_request = missed(asked, seen), by_metadata = missed(told, seen);
    const double off_request = size_of(seen - slope * asked), off_metadata = size_of(seen - slope * told);
    if (!o->estimate.reports || size_of(told - asked) < SENSOR_MISMATCH_EV)
        return;
    if (off_metadata > 0.5 * off_request && by_metadata >= by_request)
        pupil_sensor_forget_told(o);
    else if (size_of(told) > SENSOR_STEP_EV &&
             (off_metadata < 0.5 * off_request || by_request > by_metadata + SENSOR_MISMATCH_EV))
        o->told.is_trusted = 1;
}

/* Corrects the last requests to what the camera took. */
static void correct_asked(sensor_estimate *a, double told)
{
    const double asked = a->requested[0];
    for (uint32_t i = 0; i < SENSOR_RING; i++)
        if (a->asked[i][0] == asked)
            a->asked[i][0] = told;
    a->requested[0] = told;
    a->unit[0] = a->said[0] - told;
    a->reported[0] = a->in_force[0] = told;
}

void pupil_sensor_learn_told(pupil_sensor_object *o)
{
    sensor_estimate *a = &o->estimate;
    sensor_told *t = &o->told;
    if (!t->is_trusted || !a->reports)
        return;
    const double asked_s = o->setting.exposure_s, above_ev = a->said[0] - pupil_log2(asked_s);
    if (!t->count)
        t->unit_ev = above_ev > 0.0 || above_ev < -SENSOR_COARSE_STEP_EV - SENSOR_SAME_EV ? above_ev : 0.0;
    if (above_ev > t->unit_ev || above_ev < t->unit_ev - SENSOR_COARSE_STEP_EV - SENSOR_SAME_EV) { /* another unit */
        t->unit_ev = above_ev;
        t->count = 0;
    }
    const double told_s = pupil_exp2(a->said[0] - t->unit_ev);
    sensor_told_range *place = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        sensor_told_range *r = &t->range[i];
        if (size_of(pupil_log2(r->told_s / told_s)) < SENSOR_DIFFER_EV)
            place = r;
        else if (r == range_of(t, asked_s)) /* it has changed */
            *r = t->range[--t->count];
    }
    if (!place) {
        place = &t->range[t->count < SENSOR_TOLD_RANGES ? t->count++ : t->next++ % SENSOR_TOLD_RANGES];
        *place = (sensor_told_range){told_s, asked_s, asked_s};
    }
    place->low_s = clamp(place->low_s, 0.0, asked_s);
    place->high_s = larger(asked_s, place->high_s);
    const double told = pupil_log2(place->told_s);
    if (told != a->requested[0])
        correct_asked(a, told);
}
