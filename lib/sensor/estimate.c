/* What was in force in a frame, and what the controls did to the picture.
 *
 * For each control there are these guesses: what was asked for 1, 2, ... 16 frames before is in force; or what the
 * metadata report. Between two frames each pair of guesses says by how much the picture's level should have moved; the
 * remainder is the scene's movement. A scene may move at any time, but hardly just when a wrong guess expects a step.
 * So the guess with the larger remainder loses. Two frames in which all guesses agree cost nothing.
 *
 * The effect of the controls is the sum of what they were seen to do, from frame to frame: so a camera that responds
 * otherwise than it should is followed, and the shown picture does not jump with it. */
#include "sensor_private.h"

#include "base/numeric.h"

/* The cost of a pair of guesses before anything was seen. */
static float prior_cost(const pupil_sensor_object *o, uint32_t e, uint32_t g)
{
    return e > o->config.delay_frames || g > o->config.delay_frames ? (float)SENSOR_COST_PRIOR : 0.0f;
}

void pupil_sensor_forget(pupil_sensor_object *o)
{
    sensor_estimate *a = &o->estimate;
    for (uint32_t e = 0; e < SENSOR_GUESSES; e++)
        for (uint32_t g = 0; g < SENSOR_GUESSES; g++)
            a->cost[e][g] = prior_cost(o, e, g);
    a->noise_ev = 2.0 * SENSOR_QUANTILE_NOISE_EV;
    a->response[0] = a->response[1] = 1.0;
    a->unit[0] = a->unit[1] = 0.0;
    a->still[0] = a->still[1] = 0;
    a->delay[0] = a->delay[1] = 0;
    a->is_borne_out = a->has_reported = a->learned = a->seen = 0;
}

/* What was learned does not explain what is seen: responses are reset, and delays become half as certain. */
void pupil_sensor_doubt(pupil_sensor_object *o)
{
    sensor_estimate *a = &o->estimate;
    for (uint32_t e = 0; e < SENSOR_GUESSES; e++)
        for (uint32_t g = 0; g < SENSOR_GUESSES; g++)
            a->cost[e][g] = (float)(0.5 * ((double)a->cost[e][g] + (double)prior_cost(o, e, g)));
    a->response[0] = a->response[1] = 1.0;
    a->learned = a->seen = 0;
}

/* log2 of what was in force so many frames before this one, by a guess. */
static double in_force(const sensor_estimate *a, int control, uint32_t guess, uint32_t before)
{
    if (!guess)
        return !before            ? a->reported[control]
               : before == a->gap ? a->reported_before[control]
                                  : a->past[(a->frame + SENSOR_RING - before) % SENSOR_RING].reported[control];
    return a->asked[(a->frame + 2 * SENSOR_RING - guess - before) % SENSOR_RING][control];
}

double pupil_sensor_effect(const sensor_estimate *a, const double from[SENSOR_CONTROLS],
                           const double to[SENSOR_CONTROLS])
{
    return a->response[0] * (to[0] - from[0]) + a->response[1] * (to[1] - from[1]);
}

/* By how much the picture's level has moved since the frame before: from least to most. Returns the possible error:
 * quantiles come from bins. */
static double moved(const sensor_estimate *a, const sensor_evidence *v, double *least, double *most)
{
    *least = -SENSOR_FAR_AWAY;
    *most = SENSOR_FAR_AWAY;
    for (int i = 0; i < SENSOR_ORDERS; i++) {
        const double low = v->low[i] - a->high_before[i], high = v->high[i] - a->low_before[i];
        if (v->low[i] == v->high[i] && a->low_before[i] == a->high_before[i]) { /* numbers */
            *least = *most = low;
            return i > 0 ? 2.0 * SENSOR_KNOWN_EV : 0.0;
        }
        *least = larger(low, *least);
        *most = smaller(high, *most);
    }
    if (*least > *most)
        *least = *most = 0.5 * (*least + *most);
    return 2.0 * SENSOR_KNOWN_EV;
}

static int has_metadata(const pupil_frame_info *info)
{
    return info && info->exposure_s >= SENSOR_POSITIVE && info->exposure_s <= 1.0 / SENSOR_POSITIVE &&
           info->gain >= SENSOR_POSITIVE && info->gain <= 1.0 / SENSOR_POSITIVE;
}

static int is_possible(const pupil_sensor_config *config, int control, double setting)
{
    const double least = control == SENSOR_GAIN ? config->gain_min : config->exposure_min_s;
    const double most = control == SENSOR_GAIN ? config->gain_max : pupil_sensor_longest_exposure(config);
    return setting > pupil_log2(least) - SENSOR_SAME_EV && setting < pupil_log2(most) + SENSOR_SAME_EV;
}

/* Which request the metadata of one control mean. When they move, it is the nearest request that is the same within
 * SENSOR_SAME_EV; without one, the metadata are believed. The offset of a camera that rounds or has another unit is
 * measured while no request is in flight. Frames that waited in the driver of a slow program are later than any delay:
 * SENSOR_STILL_FRAMES of them are skipped. */
static void read_control(pupil_sensor_object *o, int c)
{
    sensor_estimate *a = &o->estimate;
    const double moved_by = a->said[c] - a->said_before[c];
    double nearest = SENSOR_SAME_EV, like = a->reported[c] + moved_by;
    int is_still = 1;
    for (uint32_t h = 1; h <= SENSOR_DELAYS; h++) {
        const double asked = in_force(a, c, h, 0), off = size_of(a->said[c] - a->unit[c] - asked);
        is_still &= asked == a->requested[c];
        like = off < nearest ? asked : like;
        nearest = smaller(off, nearest);
    }
    a->reported_before[c] = a->reported[c];
    if (!is_possible(&o->config, c, like)) { /* the unit came from a control that did not do what was asked */
        a->unit[c] = 0.0;
        like = a->said[c];
    }
    if (moved_by != 0.0)
        a->reported[c] = like;
    a->still[c] = is_still ? a->still[c] + (a->still[c] < SENSOR_STILL_FRAMES) : 0;
    if (a->still[c] < SENSOR_STILL_FRAMES)
        return;
    a->unit[c] = a->said[c] - a->requested[c];
    a->reported_before[c] += a->requested[c] - a->reported[c];
    a->reported[c] = a->requested[c];
}

/* Metadata are stuck if they do not change although, longer ago than any delay, a control was asked for more than the
 * coarsest step of any camera: they are not this frame's. Frames that a slow program loses do not count, because those
 * that arrive have waited in the driver. */
static int are_stuck(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const uint32_t late = o->config.delay_frames + SENSOR_LATE_FRAMES;
    uint32_t arrived = 1;
    for (uint32_t h = 0; h + 1 < SENSOR_RING && h < a->said_frames; h++) {
        for (int c = 0; h >= late && arrived > SENSOR_LATE_FRAMES && c < SENSOR_CONTROLS; c++)
            if (size_of(in_force(a, c, h, 0) - in_force(a, c, h + 1, 0)) > SENSOR_COARSE_STEP_EV)
                return 1;
        arrived += h > 0 && a->past[(a->frame + SENSOR_RING - h) % SENSOR_RING].gap;
    }
    return 0;
}

/* The first metadata: guess 0 begins with its prior cost. Until now it was not about metadata. */
static void begin_metadata(pupil_sensor_object *o)
{
    sensor_estimate *a = &o->estimate;
    for (uint32_t i = 0; i < SENSOR_GUESSES; i++) {
        a->cost[0][i] = prior_cost(o, 0, i);
        a->cost[i][0] = prior_cost(o, i, 0);
    }
}

static void read_metadata(pupil_sensor_object *o, const pupil_frame_info *info)
{
    sensor_estimate *a = &o->estimate;
    double now[SENSOR_CONTROLS] = {0.0, 0.0};
    a->reports = has_metadata(info);
    if (a->reports) {
        now[0] = pupil_log2(info->exposure_s);
        now[1] = pupil_log2(info->gain);
        a->said_frames = now[0] == a->said[0] && now[1] == a->said[1] ? a->said_frames + a->gap : 0;
        a->reports = !are_stuck(o);
        if (!a->has_reported)
            begin_metadata(o);
        a->has_reported = 1;
    }
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        a->said_before[c] = a->said[c];
        if (a->reports && !a->reports_before) /* the frame before had none */
            a->reported[c] = a->in_force[c];
        if (a->reports) {
            a->said[c] = now[c];
            read_control(o, c);
        } else {
            a->reported_before[c] = a->reported[c];
            a->reported[c] = a->in_force[c];
        }
    }
}

/* Stops that the scene must have moved by itself, if the controls moved the picture by `effect`. The response is known
 * within limits even before anything was seen. */
static double left_over(const pupil_sensor_object *o, double effect, double least, double most)
{
    const int is_known = o->estimate.learned || o->config.linear;
    const double few = effect * (is_known ? SENSOR_KNOWN_LEAST : SENSOR_STEEP_LEAST),
                 many = effect * (is_known ? SENSOR_KNOWN_MOST : SENSOR_STEEP_MOST);
    const double low = smaller(few, many), high = larger(few, many);
    return high < least ? least - high : low > most ? low - most : 0.0;
}

/* Costs are relative to the best guess, and clamped. Those of delays are clamped relative to the best pair of delays,
 * so that a changed delay is found although metadata explain everything. */
static void limit_costs(sensor_estimate *a, double best)
{
    double delays = SENSOR_FAR_AWAY;
    for (uint32_t e = 1; e < SENSOR_GUESSES; e++)
        for (uint32_t g = 1; g < SENSOR_GUESSES; g++)
            delays = (double)a->cost[e][g] < delays ? (double)a->cost[e][g] : delays;
    const double least = clamp(delays - best, 0.0, SENSOR_COST_MOST);
    for (uint32_t e = 0; e < SENSOR_GUESSES; e++)
        for (uint32_t g = 0; g < SENSOR_GUESSES; g++) {
            const int is_delay = e && g;
            const double more = clamp((double)a->cost[e][g] - (is_delay ? delays : best), 0.0, SENSOR_COST_MOST);
            a->cost[e][g] = (float)(more + (is_delay ? least : 0.0));
        }
}

/* Compares this frame with the one before: the cost of each guess, beyond that of the one with the least remainder. */
static void weigh(pupil_sensor_object *o, double step[SENSOR_CONTROLS][SENSOR_GUESSES], double least, double most)
{
    sensor_estimate *a = &o->estimate;
    const double noise_ev = larger(a->noise_ev, SENSOR_QUANTILE_NOISE_EV);
    const double scale = 1.0 / (SENSOR_COST_DEGREE * noise_ev * noise_ev);
    double best = SENSOR_FAR_AWAY, least_left = SENSOR_FAR_AWAY;
    for (uint32_t e = 0; e < SENSOR_GUESSES; e++)
        for (uint32_t g = 0; g < SENSOR_GUESSES; g++) {
            const double left = left_over(o, step[0][e] + step[1][g], least, most);
            least_left = smaller(left, least_left);
        }
    const double least_paid = pupil_log2(1.0 + least_left * least_left * scale);
    for (uint32_t e = 0; e < SENSOR_GUESSES; e++) {
        double last = SENSOR_FAR_AWAY, paid = 0.0;
        for (uint32_t g = 0; g < SENSOR_GUESSES; g++) {
            const double left = left_over(o, step[0][e] + step[1][g], least, most);
            if (left != last)
                paid = 2.0 * (pupil_log2(1.0 + left * left * scale) - least_paid);
            last = left;
            a->cost[e][g] = (float)((double)a->cost[e][g] + clamp(paid, 0.0, SENSOR_COST_FRAME));
            best = (double)a->cost[e][g] < best ? (double)a->cost[e][g] : best;
        }
    }
    limit_costs(a, best);
}

/* The guesses in the order in which they are preferred: the metadata, then the longest delay first. */
static uint32_t guess_at(uint32_t i)
{
    return i ? SENSOR_GUESSES - i : 0;
}

/* The best pair of guesses, and those that are not ruled out. Metadata that the picture has confirmed are believed. */
static void survey(sensor_estimate *a)
{
    double best = SENSOR_FAR_AWAY;
    a->is_borne_out &= (double)a->cost[0][0] < SENSOR_COST_ALIVE;
    const uint32_t end = a->is_borne_out && a->reports ? 1 : SENSOR_GUESSES;
    a->alive[0] = a->alive[1] = 0;
    for (uint32_t i = a->reports ? 0 : 1; i < end; i++)
        for (uint32_t j = a->reports ? 0 : 1; j < end; j++) {
            const uint32_t e = guess_at(i), g = guess_at(j);
            const double cost = (double)a->cost[e][g];
            if (cost < SENSOR_COST_ALIVE) {
                a->alive[0] |= 1u << e;
                a->alive[1] |= 1u << g;
            }
            if (cost < best) {
                best = cost;
                a->best[0] = e;
                a->best[1] = g;
            }
        }
    for (int c = 0; c < SENSOR_CONTROLS; c++)
        a->in_force[c] = in_force(a, c, a->best[c], 0);
}

/* By how much the scene moved by itself, and its noise: of second differences, so that light that moves evenly is not
 * noise. */
static void follow_scene(sensor_estimate *a, double moved, int is_clear)
{
    const double cut = SENSOR_NOISE_FRAME * a->noise_ev;
    const double size = SENSOR_SIGMA_OF_SIZE * size_of(moved - a->scene_moved[0]) / SENSOR_SECOND_DIFFERENCE;
    for (int i = SENSOR_RAMP_FRAMES - 1; i > 0; i--)
        a->scene_moved[i] = a->scene_moved[i - 1];
    a->scene_moved[0] = moved;
    if (!is_clear)
        return;
    a->noise_ev += SENSOR_NOISE_WEIGHT * (smaller(size, cut) - a->noise_ev);
    a->noise_ev = larger(a->noise_ev, SENSOR_MEAN_NOISE_EV);
}

/* What a change of the setting may do, at least and at most: each control from nothing to twice what it should, and a
 * stop more where its steps are coarse, or may be; in a search two, because a control may jump at the end of a range in
 * which it does nothing; or what the metadata say. */
static void bounds_of(const sensor_estimate *a, const double then[SENSOR_CONTROLS], const double now[SENSOR_CONTROLS],
                      double said, double *low, double *high)
{
    *low = *high = 0.0;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        const double asked = now[c] - then[c], most = 2.0 * asked;
        const double small = a->is_searching ? SENSOR_DIFFER_EV : SENSOR_LARGE_EV;
        const double coarse = size_of(asked) > small ? (a->is_searching ? 2.0 : 1.0) * SENSOR_COARSE_STEP_EV : 0.0;
        *low += asked < 0.0 ? most - coarse : 0.0;
        *high += asked > 0.0 ? most + coarse : 0.0;
    }
    if (*high > *low && a->reports) {
        *low = smaller(said, *low);
        *high = larger(said, *high);
    }
}

/* What the controls did between the frame that is so many frames before this one and its predecessor, by the best
 * guess. What a change leaves unexplained is the camera's, within the bounds of what a camera may do. Beyond them the
 * scene has moved as well. */
static double done_in(const sensor_estimate *a, const sensor_past *frame, uint32_t before, double *unexplained,
                      int *changes)
{
    double then[SENSOR_CONTROLS], now[SENSOR_CONTROLS], low, high;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        then[c] = in_force(a, c, a->best[c], before + frame->gap);
        now[c] = in_force(a, c, a->best[c], before);
    }
    bounds_of(a, then, now, frame->said, &low, &high);
    const double expected = pupil_sensor_effect(a, then, now);
    const double known = clamp(expected, frame->least, frame->most), left = size_of(known - expected);
    const double noise = SENSOR_UNEXPLAINED_NOISE * a->noise_ev, goes_on = 2.0 * size_of(a->scene_moved[0]);
    const double most_usual = larger(noise, goes_on);
    const double seen = larger(frame->wrong_ev, SENSOR_UNEXPLAINED_EV);
    const double slack = larger(most_usual, seen);
    *changes = high - low > 2.0 * SENSOR_DIFFER_EV;
    const int is_camera = known > low - slack && known < high + slack;
    const double done = *changes && left > slack && is_camera ? known : expected;
    *unexplained = *changes ? done - expected : 0.0;
    return done;
}

/* Another guess is best now: corrects what the controls did in the last frames. */
static double redo(sensor_estimate *a)
{
    double redone = 0.0, unexplained;
    int changes;
    for (uint32_t before = 1; before < SENSOR_DELAYS; before++) {
        sensor_past *frame = &a->past[(a->frame + SENSOR_RING - before) % SENSOR_RING];
        int differs = 0;
        for (int c = 0; frame->gap && c < SENSOR_CONTROLS; c++)
            for (uint32_t i = before; i <= before + frame->gap; i += frame->gap)
                differs |= in_force(a, c, a->best[c], i) != in_force(a, c, a->best_before[c], i);
        if (!differs)
            continue;
        const double done = done_in(a, frame, before, &unexplained, &changes);
        redone += done - frame->done;
        frame->done = done;
    }
    return redone;
}

/* What the controls did from the frame before to this one. */
static void follow_effect(pupil_sensor_object *o, double least, double most, double wrong_ev)
{
    sensor_estimate *a = &o->estimate;
    sensor_past *now = &a->past[a->frame % SENSOR_RING];
    /* without metadata another guess is made, which says nothing of the frames before */
    const int is_other =
        a->reports == a->reports_before && (a->best[0] != a->best_before[0] || a->best[1] != a->best_before[1]);
    const double redone = is_other ? redo(a) : 0.0;
    int changes;
    *now = (sensor_past){.least = least, .most = most, .wrong_ev = wrong_ev, .gap = a->gap};
    now->said = a->said[0] - a->said_before[0] + a->said[1] - a->said_before[1];
    now->done = done_in(a, now, 0, &a->unexplained, &changes);
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        now->reported[c] = a->reported[c];
        a->best_before[c] = a->best[c];
    }
    a->reports_before = a->reports;
    a->stepped = 0.0;
    for (int c = 0; c < SENSOR_CONTROLS; c++)
        a->stepped += in_force(a, c, a->best[c], 0) - in_force(a, c, a->best[c], a->gap);
    a->answered = least == most ? least : 0.0;
    a->effect += redone + now->done;
    follow_scene(a, least == most ? least - now->done : 0.0, least == most && !changes);
}

/* This frame and the one before it. */
static void compare(pupil_sensor_object *o, const sensor_evidence *v)
{
    sensor_estimate *a = &o->estimate;
    double step[SENSOR_CONTROLS][SENSOR_GUESSES], least, most;
    int differs = 0;
    for (int c = 0; c < SENSOR_CONTROLS; c++)
        for (uint32_t h = 0; h < SENSOR_GUESSES; h++) {
            step[c][h] = a->response[c] * (in_force(a, c, h, 0) - in_force(a, c, h, a->gap));
            differs |= size_of(step[c][h] - step[c][0]) > SENSOR_DIFFER_EV;
        }
    const double wrong_ev = moved(a, v, &least, &most);
    if (differs) {
        weigh(o, step, least, most);
        const double reported = step[0][0] + step[1][0];
        const double clear = least > 0.0 ? least : most < 0.0 ? -most : 0.0;
        if (a->reports && clear > SENSOR_STEP_EV && left_over(o, reported, least, most) < SENSOR_QUANTILE_NOISE_EV)
            a->is_borne_out = 1;
    }
    survey(a);
    follow_effect(o, least, most, wrong_ev);
}

static double least_cost(const sensor_estimate *a, int control, uint32_t guess)
{
    double least = SENSOR_FAR_AWAY;
    for (uint32_t other = 1; other < SENSOR_GUESSES; other++) {
        const double cost = (double)(control ? a->cost[other][guess] : a->cost[guess][other]);
        least = smaller(cost, least);
    }
    return least;
}

/* The delay of a control, once the frames fit no other one, regardless of what was believed at first; until it is
 * contradicted. Else 0. */
static __attribute__((noinline)) uint32_t delay_of(const pupil_sensor_object *o, int control)
{
    const sensor_estimate *a = &o->estimate;
    double best = SENSOR_FAR_AWAY, second = SENSOR_FAR_AWAY;
    uint32_t delay = 0;
    for (uint32_t h = 1; h < SENSOR_GUESSES; h++)
        if (least_cost(a, control, h) < best) {
            best = least_cost(a, control, h);
            delay = h;
        }
    for (uint32_t h = 1; h < SENSOR_GUESSES; h++) {
        const double cost = least_cost(a, control, h) - (h > o->config.delay_frames ? SENSOR_COST_PRIOR : 0.0);
        second = h != delay ? smaller(cost, second) : second;
    }
    if (second - best >= SENSOR_COST_PRIOR)
        return delay;
    return a->delay[control] && least_cost(a, control, a->delay[control]) - best < SENSOR_COST_ALIVE ? a->delay[control]
                                                                                                     : 0;
}

/* Counts frames, lost ones too: what was asked for after the frame before holds for all that were lost. A program that
 * loses frames before each one it gets is slower than the camera, and its queue is full. Then the delay is constant in
 * delivered frames, so lost ones are not counted. */
static void count_frames(sensor_estimate *a, const pupil_frame_info *info)
{
    const uint64_t sequence = info ? info->sequence : 0, ahead = sequence - a->sequence;
    const int is_ahead = sequence > a->sequence;
    a->losses = is_ahead && ahead > 1 ? a->losses + (a->losses < SENSOR_SLOW_FRAMES) : 0;
    const int is_slow = a->losses == SENSOR_SLOW_FRAMES;
    a->gap = is_ahead && !is_slow && ahead < SENSOR_RING - SENSOR_DELAYS ? (uint32_t)ahead : 1;
    a->sequence = sequence;
    for (uint32_t i = 0; i < a->gap; i++) {
        a->past[(a->frame + i + 1) % SENSOR_RING].gap = 0;
        for (int c = 0; c < SENSOR_CONTROLS; c++)
            a->asked[(a->frame + i) % SENSOR_RING][c] = a->requested[c];
    }
    a->frame = (a->frame + a->gap) % SENSOR_RING;
}

/* Takes the setting of the first frame to have been in force for some time. */
static void begin_frames(sensor_estimate *a, const pupil_frame_info *info)
{
    double first[SENSOR_CONTROLS] = {a->requested[0], a->requested[1]};
    if (has_metadata(info)) {
        first[0] = pupil_log2(info->exposure_s);
        first[1] = pupil_log2(info->gain);
    }
    for (uint32_t i = 0; i < SENSOR_RING; i++)
        for (int c = 0; c < SENSOR_CONTROLS; c++)
            a->asked[i][c] = a->past[i].reported[c] = a->reported[c] = a->in_force[c] = a->said[c] = first[c];
    a->effect += pupil_sensor_effect(a, a->requested, first);
    a->sequence = info ? info->sequence : 0;
    a->gap = 1;
    a->has_frame = 1;
}

void pupil_sensor_estimate_frame(pupil_sensor_object *o, const sensor_evidence *v, const pupil_frame_info *info)
{
    sensor_estimate *a = &o->estimate;
    if (a->has_frame)
        count_frames(a, info);
    else
        begin_frames(a, info);
    read_metadata(o, info);
    if (a->has_level && !v->is_dead && !o->announced.frames) {
        compare(o, v);
    } else { /* the light may have moved with the controls: they count as expected */
        survey(a);
        follow_effect(o, -SENSOR_FAR_AWAY, SENSOR_FAR_AWAY, 0.0);
    }
    a->has_level = !v->is_dead;
    for (int c = 0; c < SENSOR_CONTROLS; c++)
        a->delay[c] = delay_of(o, c);
    for (int i = 0; i < SENSOR_ORDERS; i++) {
        a->low_before[i] = v->low[i];
        a->high_before[i] = v->high[i];
    }
}

/* The request of the control has not changed for longer than any delay. */
static int is_idle(const sensor_estimate *a, int control)
{
    for (uint32_t h = 1; h <= SENSOR_DELAYS; h++)
        if (size_of(a->asked[(a->frame + SENSOR_RING - h) % SENSOR_RING][control] - a->requested[control]) >
            SENSOR_SAME_EV)
            return 0;
    return 1;
}

int pupil_sensor_is_waited_for(const sensor_estimate *a, int control)
{
    return !a->delay[SENSOR_CONTROLS - 1 - control] || !is_idle(a, control);
}

uint32_t pupil_sensor_longest_delay(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const uint32_t alive =
        (pupil_sensor_is_waited_for(a, 0) ? a->alive[0] : 0) | (pupil_sensor_is_waited_for(a, 1) ? a->alive[1] : 0);
    for (uint32_t h = SENSOR_GUESSES - 1; h > 0; h--)
        if (alive >> h & 1)
            return h;
    return o->config.delay_frames;
}

/* The change from a setting to the requested one had the effect `seen` in place of `expected`. The control that moved
 * further gets the larger part of the correction (normalised least mean squares). */
void pupil_sensor_learn(pupil_sensor_object *o, const double from[SENSOR_CONTROLS], double expected, double seen)
{
    sensor_estimate *a = &o->estimate;
    const double e = a->requested[0] - from[0], g = a->requested[1] - from[1], off = seen - expected;
    a->response[0] = clamp(a->response[0] + off * e / (e * e + g * g), SENSOR_RESPONSE_LEAST, SENSOR_RESPONSE_MOST);
    a->response[1] = clamp(a->response[1] + off * g / (e * e + g * g), SENSOR_RESPONSE_LEAST, SENSOR_RESPONSE_MOST);
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        if (size_of(a->response[c] - 1.0) < SENSOR_STRAIGHT)
            a->response[c] = 1.0;
        a->seen |= size_of(a->requested[c] - from[c]) >= SENSOR_STEP_EV ? 1u << c : 0;
    }
    for (int c = 0; c < SENSOR_CONTROLS; c++) { /* a tone curve is the same for both */
        const double other = a->response[SENSOR_CONTROLS - 1 - c];
        if (!(a->seen >> c & 1) && other >= SENSOR_STEEP_LEAST && other <= SENSOR_STEEP_MOST)
            a->response[c] = other;
    }
    a->learned = 1;
}

double pupil_sensor_unrest(const sensor_estimate *a)
{
    double most = 0.0;
    for (int i = 0; i < SENSOR_RAMP_FRAMES; i++)
        most = larger(size_of(a->scene_moved[i]), most);
    return most;
}

void pupil_sensor_overshot(sensor_estimate *a)
{
    for (int c = 0; c < SENSOR_CONTROLS; c++)
        a->response[c] = larger(a->response[c], 1.0);
}
