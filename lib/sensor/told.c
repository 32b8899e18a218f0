/* Exposures that are not what was asked for, as the metadata tell them. A camera may have coarser exposures than its
 * configuration says: webcams that know only powers of two round what they are asked for, and report what they took.
 * Once the picture has shown that the metadata know better, what became of each exposure that was asked for is kept: on
 * such a camera a whole range of them becomes the same one. */
#include "sensor_private.h"

#include "base/numeric.h"

void pupil_sensor_forget_told(pupil_sensor_object *o)
{
    o->told.is_trusted = o->told.count = o->told.next = 0;
}

/* The range that an exposure is in: what is between two that became the same one becomes that, too. */
static const sensor_told_range *range_of(const sensor_told *t, double exposure_s)
{
    for (uint32_t i = 0; i < t->count; i++) {
        const sensor_told_range *r = &t->range[i];
        const double least = r->low_s < r->told_s ? r->low_s : r->told_s;
        const double most = r->high_s > r->told_s ? r->high_s : r->told_s;
        if (exposure_s >= least * (1.0 - SENSOR_ROUND) && exposure_s <= most * (1.0 + SENSOR_ROUND))
            return r;
    }
    return 0;
}

double pupil_sensor_told(const pupil_sensor_object *o, double exposure_s)
{
    const sensor_told_range *r = range_of(&o->told, exposure_s);
    return r ? r->told_s : exposure_s;
}

double pupil_sensor_told_ask(const pupil_sensor_object *o, double exposure_s)
{
    const sensor_told_range *r = range_of(&o->told, exposure_s);
    return r ? clamp(exposure_s, r->low_s, r->high_s) : exposure_s;
}

double pupil_sensor_told_between(const pupil_sensor_object *o, double exposure_s)
{
    const sensor_told *t = &o->told;
    const sensor_told_range *r = range_of(t, exposure_s); /* it has one: it was asked for */
    const double high_s = r->high_s > r->told_s ? r->high_s : r->told_s;
    double next_s = 2.0 * high_s;
    for (uint32_t i = 0; i < t->count; i++)
        if (t->range[i].told_s > high_s && t->range[i].told_s < next_s)
            next_s = t->range[i].told_s;
    const double gap_ev = pupil_log2(next_s / high_s);
    return gap_ev > SENSOR_OFF_EV ? high_s * pupil_exp2(0.5 * gap_ev) : exposure_s;
}

/* By how much the picture moved otherwise than a step of the setting may move it, with any tone curve. */
static double missed(double step, double seen)
{
    const double low = step * (step < 0.0 ? SENSOR_STEEP_MOST : SENSOR_STEEP_LEAST);
    const double high = step * (step < 0.0 ? SENSOR_STEEP_LEAST : SENSOR_STEEP_MOST);
    return seen < low ? low - seen : seen > high ? seen - high : 0.0;
}

/* By the slope that the controls are known to have, or else by any that a tone curve may have. */
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

/* What was asked for was this. */
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
    place->low_s = asked_s < place->low_s ? asked_s : place->low_s;
    place->high_s = asked_s > place->high_s ? asked_s : place->high_s;
    const double told = pupil_log2(place->told_s);
    if (told != a->requested[0])
        correct_asked(a, told);
}
