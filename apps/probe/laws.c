/* Whether the picture's level follows exposure and gain, and where black is. */
#include <math.h>

#include "stream.h"

#define OBEYED     0.25 /* of a control's change: if the level changes less, the picture has not followed */
#define LEAST_STOP 0.9  /* of a control's change over all points */
#define MOST_OFF   PROBE_STILL_EV

#define NOT_FOLLOWED "the picture does not follow the exposure"

/* --- points --- */

static int64_t code_of(const probe_report *r, double gain)
{
    const unsigned place = r->offers.gain_place;
    const pupil_live_control *found = place ? &r->offers.control[place - 1] : NULL;
    const pupil_camera_range range = {found ? (int64_t)found->least : 0, found ? (int64_t)found->most : 0,
                                      found ? (int64_t)found->step : 1, 0};
    return found ? pupil_camera_code_of_gain(&r->limits.gain, gain, &range) : 0;
}

/* Adds a point. 1: the picture can no longer be measured; else the state. */
static int take_point(probe_stream *s, probe_law *law, double exposure_s, double gain)
{
    probe_level level;
    if (law->points == PROBE_POINTS)
        return 1;
    if (probe_settle(s, exposure_s, gain) || probe_frames(s, 2, &level))
        return s->state;
    if (!probe_is_good(&level))
        return 1;
    const pupil_camera_setting now = probe_taken(s);
    law->drift_ev = fmax(law->drift_ev, level.spread_ev);
    law->point[law->points++] = (probe_point){.exposure_s = now.exposure_s,
                                              .gain = now.gain,
                                              .code = code_of(s->report, now.gain),
                                              .level_ev = level.mean_ev};
    return 0;
}

/* Repeats a point: changing light is not the camera's fault. */
static void take_drift(probe_stream *s, probe_law *law, unsigned i)
{
    probe_level level;
    if (i < law->points && probe_settle(s, law->point[i].exposure_s, law->point[i].gain) == 0 &&
        probe_frames(s, 2, &level) == 0)
        law->drift_ev = fmax(law->drift_ev, fabs(level.mean_ev - law->point[i].level_ev));
}

static unsigned furthest_off(const probe_law *law)
{
    unsigned furthest = 0;
    for (unsigned i = 1; i < law->points; i++)
        furthest = fabs(law->point[i].off_ev) > fabs(law->point[furthest].off_ev) ? i : furthest;
    return furthest;
}

/* The slope of the level over the control, by least squares, without the effect of the other control. */
static void fit(probe_stream *s, probe_law *law, int of_gain)
{
    const probe_point *first = &law->point[0];
    double x_sum = 0, y_sum = 0, xx = 0, xy = 0, least = 0, most = 0, moved = 0;
    const double n = law->points;
    for (unsigned i = 0; i < law->points; i++) {
        probe_point *p = &law->point[i];
        const double exposure_ev = log2(p->exposure_s / first->exposure_s), gain_ev = log2(p->gain / first->gain);
        const double x = of_gain ? gain_ev : exposure_ev;
        const double y = p->level_ev - first->level_ev - (of_gain ? exposure_ev : gain_ev);
        p->off_ev = y - x;
        law->off_ev = fmax(law->off_ev, fabs(p->off_ev));
        least = fmin(least, x);
        most = fmax(most, x);
        moved = fabs(y) > fabs(moved) ? y : moved;
        x_sum += x;
        y_sum += y;
        xx += x * x;
        xy += x * y;
    }
    if (law->points < 2 || most - least < LEAST_STOP) {
        if (!probe_gave_up(s, &law->is))
            probe_unknown(&law->is, "the picture leaves less than a stop to measure it in");
        return;
    }
    law->is.known = 1;
    law->slope = (n * xy - x_sum * y_sum) / (n * xx - x_sum * x_sum);
    law->as_told = law->off_ev <= MOST_OFF + law->drift_ev;
    law->obeyed = law->slope > OBEYED;
}

/* A law that is off is measured again, because the scene may have moved for a moment. */
static void judge(probe_stream *s, probe_law *law, int of_gain)
{
    fit(s, law, of_gain);
    if (law->is.known && !law->as_told && law->drift_ev <= MOST_OFF) {
        take_drift(s, law, furthest_off(law));
        if (probe_gave_up(s, &law->is))
            return;
    }
    if (law->is.known && law->drift_ev > MOST_OFF)
        probe_moves(&law->is, law->drift_ev);
}

/* --- laws --- */

static void exposure_law(probe_stream *s, double exposure_s, double gain)
{
    static const double factors[] = {1.0, 2.0, 0.5, 0.25, 0.125}, few[] = {1.0, 0.5, 0.25};
    const unsigned count = s->options->quick ? 3 : 5;
    probe_law *law = &s->report->exposure;
    for (unsigned i = 0; i < count; i++) {
        const double wanted_s = exposure_s * (s->options->quick ? few[i] : factors[i]);
        if (wanted_s < s->report->limits.exposure_min_s * 0.999 || wanted_s > s->longest_s * 1.001)
            continue;
        if (take_point(s, law, wanted_s, gain) && s->state)
            break;
        if (i == count / 2)
            take_drift(s, law, 0);
    }
    take_drift(s, law, 0);
    judge(s, law, 0);
}

/* At a constant level: exposure is reduced as gain is raised. */
static void gain_law(probe_stream *s, double total_s)
{
    const pupil_camera_limits *l = &s->report->limits;
    const unsigned count = s->options->quick ? 3 : 6;
    probe_law *law = &s->report->gain;
    const double least = fmax(l->gain_min, total_s / s->longest_s);
    const double most = fmin(l->gain_max, total_s / l->exposure_min_s);
    if (!l->has_gain) {
        probe_unknown(&law->is, "this camera has no control of gain");
        return;
    }
    if (s->report->exposure.is.known && !s->report->exposure.obeyed) {
        probe_unknown(&law->is, "its exposure does not obey, so gain cannot be measured with it");
        return;
    }
    for (unsigned i = 0; i < count && most > least; i++) {
        const double gain = least * pow(most / least, (double)i / (count - 1));
        if (take_point(s, law, total_s / gain, gain) && s->state)
            break;
        if (i == count / 2)
            take_drift(s, law, 0);
    }
    take_drift(s, law, 0);
    judge(s, law, 1);
}

void probe_laws(probe_stream *s, double exposure_s, double gain, double moved_ev)
{
    if (moved_ev > PROBE_STILL_EV) {
        probe_moves(&s->report->exposure.is, moved_ev);
        probe_moves(&s->report->gain.is, moved_ev);
        return;
    }
    if (s->options->say)
        s->options->say("exposure");
    exposure_law(s, exposure_s, gain);
    if (s->options->say)
        s->options->say("gain");
    gain_law(s, exposure_s * gain);
    if (s->report->exposure.is.known && !s->report->exposure.obeyed)
        probe_unknown(&s->report->black.is, NOT_FOLLOWED);
}

/* --- black --- */
/* Black is the level of the darkest tenth of the picture at the shortest exposure, minus the light in it, which is
 * found from the rise at four times the exposure. */

#define MOST_LIGHT 0.02 /* of full scale: with more light the difference says nothing of black */
#define MOST_BLACK 0.1  /* of full scale: no sensor has more (6 % is usual), but a picture that does not change may */

static void measure_black(probe_stream *s)
{
    const pupil_camera_limits *l = &s->report->limits;
    probe_black *b = &s->report->black;
    const double short_s = l->exposure_min_s, long_s = fmin(4.0 * short_s, s->longest_s);
    probe_level at_short, at_long;
    if (probe_settle(s, short_s, l->gain_min) || probe_frames(s, 3, &at_short)) {
        probe_gave_up(s, &b->is);
        return;
    }
    b->exposure_s = probe_taken(s).exposure_s;
    if (probe_settle(s, long_s, l->gain_min) || probe_frames(s, 3, &at_long)) {
        probe_gave_up(s, &b->is);
        return;
    }
    const double longer_s = probe_taken(s).exposure_s;
    const double light = (at_long.low - at_short.low) * b->exposure_s / (longer_s - b->exposure_s);
    if (!(longer_s > b->exposure_s * 1.5)) {
        probe_unknown(&b->is, "the camera has hardly a choice of exposure times");
        return;
    }
    if (light <= MOST_LIGHT && at_short.low - light > MOST_BLACK && at_long.clipped < PROBE_MOST_BAD) {
        probe_unknown(&b->is, NOT_FOLLOWED);
        return;
    }
    b->is.known = 1;
    b->at_most = at_long.clipped > 0.9 || light > MOST_LIGHT;
    b->share = b->at_most ? at_short.low : fmax(0.0, at_short.low - light);
}

void probe_black_level(probe_stream *s)
{
    const probe_black *b = &s->report->black;
    s->wants_low = 1;
    measure_black(s);
    s->wants_low = 0;
    if (b->is.known && !b->at_most)
        s->black = b->share;
}
