/* Measures after how many frames a written control acts: steps the control, and watches the picture. */
#include <math.h>

#include "stream.h"

#define STEP_FACTOR  4.0
#define LEAST_FACTOR 1.5
#define MOVED        0.3 /* of the step: above noise; reached even if a tone curve leaves less than half of it */
#define LATEST       16  /* frames: the longest delay that pupil/sensor.h takes */
#define MOST_STEPS   6
#define MOST_MOVED   0.3  /* stops: half of what counts as moved, of a step by STEP_FACTOR */
#define MOST_APART   0.25 /* largest difference of the picture's shares of a step when it is repeated */

/* Two settings, different in one control, to step between. */
typedef struct stepping {
    pupil_camera_setting low, high;
    const char *control;
} stepping;

enum { NO_MOVE = -1, NO_PICTURE = -2, NO_STEP = -3, MOVES = -4 };

/* The number of frames from the one in progress to the first that moved, and the picture's share of the step; or one of
 * the above. The caller then checks the state. */
static int one_step(probe_stream *s, const stepping *steps, int up, double *share)
{
    const pupil_camera_setting *to = up ? &steps->high : &steps->low;
    const pupil_camera_setting before = probe_taken(s);
    probe_level base;
    uint64_t under_way = 0, first = 0;
    double off_ev = 0.0;
    if (probe_frames(s, 2, &base) || probe_set(s, to->exposure_s, to->gain, &under_way))
        return NO_STEP;
    if (!probe_is_good(&base))
        return NO_PICTURE;
    if (base.spread_ev > MOST_MOVED)
        return MOVES;
    const pupil_camera_setting now = probe_taken(s);
    const double step_ev = log2(now.exposure_s * now.gain / (before.exposure_s * before.gain));
    if (fabs(step_ev) < log2(LEAST_FACTOR) / 2)
        return NO_STEP;
    for (int i = 0, in_a_row = 0; i < 64 && s->sequence < under_way + LATEST && in_a_row < 2; i++) {
        if (probe_frame(s))
            return NO_STEP;
        off_ev = fmax(off_ev, fabs(s->level.mean_ev - base.mean_ev));
        *share = (s->level.mean_ev - base.mean_ev) / step_ev;
        in_a_row = *share > MOVED ? in_a_row + 1 : 0; /* a single frame may be a flash */
        first = in_a_row == 1 ? s->sequence : first;
        if (in_a_row == 2)
            return first >= under_way ? (int)(first - under_way) : 0;
    }
    return !probe_is_good(&s->level) ? NO_PICTURE : off_ev > MOST_MOVED ? MOVES : NO_MOVE;
}

/* The most frequent delay of the steps; of equally frequent ones the longer. */
static unsigned usual(const unsigned *delay, unsigned count)
{
    unsigned best = 0, best_times = 0;
    for (unsigned i = 0; i < count; i++) {
        unsigned times = 0;
        for (unsigned k = 0; k < count; k++)
            times += delay[k] == delay[i];
        if (times > best_times || (times == best_times && delay[i] > best)) {
            best = delay[i];
            best_times = times;
        }
    }
    return best;
}

/* Steps up and down until enough steps were seen: the delay of each, and the range of their shares. Returns the result
 * of the last step. */
static int take_steps(probe_stream *s, const stepping *steps, probe_delay *d, unsigned *delay, double *apart)
{
    const unsigned wanted = s->options->quick ? 2 : 4;
    double share = 0.0, least = 0.0, most = 0.0;
    int last = NO_STEP;
    if (probe_settle(s, steps->high.exposure_s, steps->high.gain))
        return NO_STEP;
    for (unsigned i = 0; i < MOST_STEPS && d->steps < wanted && !s->state; i++) {
        last = one_step(s, steps, i % 2, &share);
        if (last >= 0) {
            least = d->steps ? fmin(least, share) : share;
            most = d->steps ? fmax(most, share) : share;
            *apart = most - least;
            delay[d->steps++] = (unsigned)last;
        } else if (last == NO_MOVE && !d->steps) {
            break; /* asking more often is of no use */
        }
        const pupil_camera_setting now = probe_taken(s);
        probe_settle(s, now.exposure_s, now.gain);
    }
    return last;
}

/* Says why too few steps were seen. */
static void say_unknown(const probe_stream *s, const stepping *steps, int last, probe_known *is)
{
    if (probe_gave_up(s, is))
        return;
    if (last == NO_MOVE)
        probe_unknown(is, "the picture does not follow within %d frames, though the driver says that it has the value",
                      LATEST);
    else if (last == NO_STEP)
        probe_unknown(is, "the driver does not take a step of %s", steps->control);
    else
        probe_unknown(is, "the picture clips or is black at a step of %s", steps->control);
}

static void measure(probe_stream *s, const stepping *steps, probe_delay *d)
{
    unsigned delay[MOST_STEPS];
    double apart = 0.0;
    const int last = take_steps(s, steps, d, delay, &apart);
    if (apart > MOST_APART || (last == MOVES && d->steps < 2)) { /* the scene's share, then */
        const double step_ev =
            log2(steps->high.exposure_s * steps->high.gain / (steps->low.exposure_s * steps->low.gain));
        probe_moves(&d->is, fmax(apart * step_ev, MOST_MOVED));
        return;
    }
    if (d->steps < 2) {
        say_unknown(s, steps, last, &d->is);
        return;
    }
    d->is.known = 1;
    d->frames = usual(delay, d->steps);
    d->least = d->most = delay[0];
    for (unsigned i = 1; i < d->steps; i++) {
        d->least = delay[i] < d->least ? delay[i] : d->least;
        d->most = delay[i] > d->most ? delay[i] : d->most;
    }
}

void probe_delays(probe_stream *s, double exposure_s, double gain, double moved_ev)
{
    probe_report *r = s->report;
    if (moved_ev > MOST_MOVED) {
        probe_moves(&r->exposure_delay.is, moved_ev);
        probe_moves(&r->gain_delay.is, moved_ev);
        return;
    }
    const pupil_camera_limits *l = &r->limits;
    stepping e = {{fmax(exposure_s / STEP_FACTOR, l->exposure_min_s), gain, 0}, {exposure_s, gain, 0}, "exposure"};
    if (exposure_s < e.low.exposure_s * LEAST_FACTOR) /* at its shortest: step the other way */
        e.high.exposure_s = fmin(2.0 * exposure_s, s->longest_s);
    if (e.high.exposure_s >= e.low.exposure_s * LEAST_FACTOR)
        measure(s, &e, &r->exposure_delay);
    else
        probe_unknown(&r->exposure_delay.is, "the camera has hardly a choice of exposure times");

    if (!l->has_gain) {
        probe_unknown(&r->gain_delay.is, "this camera has no control of gain");
        return;
    }
    const double factor = fmin(STEP_FACTOR, l->gain_max / l->gain_min);
    const double held_s = fmin(fmax(exposure_s * gain / (l->gain_min * factor), l->exposure_min_s), s->longest_s);
    const stepping g = {{held_s, l->gain_min, 0}, {held_s, l->gain_min * factor, 0}, "gain"};
    if (factor >= LEAST_FACTOR)
        measure(s, &g, &r->gain_delay);
    else
        probe_unknown(&r->gain_delay.is, "the camera has hardly a choice of gains");
}
