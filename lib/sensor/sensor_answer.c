/* How the camera answers: after how many frames, how strongly, and whether at all; found from the frames.
 *
 * For each of the two controls there are these guesses at what was in force in a frame: what its info says; what was
 * asked for 1, 2, ... 16 frames before; what was in force at the start, because the camera does not obey. Between two
 * frames each pair of guesses says by how much the picture's level should have moved; what is left is the scene's. A
 * scene moves as it likes, but not by what was asked of the camera just when some guess expects it; so a guess loses
 * where it leaves more than another one. Two frames in which all guesses agree tell nothing and cost nothing.
 *
 * The price of what is left, r, is the log-likelihood of Student's distribution with three degrees of freedom, so that
 * a cut of the scene does not decide alone. It is counted from the best guess's, and at most to MOST: one contradiction
 * to the guess that was believed lets all the others come back. */
#include "sensor_private.h"

#include "base/numeric.h"
#include "core/object.h"

#define TOLD  0
#define NEVER (PUPIL_SENSOR_DELAYS + 1)

#define ALIVE 6.0  /* bits: 1 in 64 */
#define PRIOR 7.0  /* of delays longer than believed, and of a camera that does not obey: not alive at first */
#define MOST  16.0 /* one surprise of two stops at the least noise: 2 log2(1 + 4 / 0.0027) = 21 is more */

#define NOISE_EV    0.03 /* least: half of what a quantile from bins of 0.09 to 0.17 stops is off by */
#define STEEP_LEAST 0.45 /* a gamma of 2.2, and below */
#define STEEP_MOST  2.2
#define STEP_EV     0.3 /* a control's step from here on shows how strongly the camera answers */
#define UNHEARD_EV  0.4 /* more than any law of gains rounds */
#define ALIKE       0.1 /* light that goes on as it did before a step looks like a part of it; of the step */
#define REAL_EV     4.5 /* this far below white 8 bits have 11 codes, and half a code is 0.06 EV */
#define FAR_AWAY    1e3

static const double order_share[PUPIL_SENSOR_ORDERS] = {0.5, 0.35, 0.65, 0.2, 0.8, 0.1, 0.9, 0.05, 0.95, 0.02};

/* Values of the frame that hold a rank; where a rank is clipped or black, only that they are above or below. */
void pupil_sensor_orders(const pupil_sensor_config *config, const pupil_stats *stats, pupil_sensor_light *light)
{
    /* below nine stops under white the codes of 12 bits are coarser than the noise */
    const double dark = pupil_log2(config->clip) - 9.0;
    double quantile[PUPIL_SENSOR_ORDERS];
    if (stats && stats->has_histogram)
        pupil_stats_quantiles(stats, order_share, PUPIL_SENSOR_ORDERS, quantile);
    for (int i = 0; i < PUPIL_SENSOR_ORDERS; i++) {
        const double value = stats && stats->has_histogram ? quantile[i] : light->mean;
        const double above = stats && stats->has_histogram ? 0.99 - order_share[i] : 0.02;
        const double below = stats && stats->has_histogram ? order_share[i] - 0.01 : 0.02;
        const int is_clipped = light->clipped_share > above;
        const int is_black = light->black_share > below || (stats && value < dark);
        light->low[i] = is_black ? -FAR_AWAY : value;
        light->high[i] = is_clipped ? FAR_AWAY : is_black && value < dark ? dark : value;
    }
}

void pupil_sensor_answer_reset(pupil_sensor_object *o)
{
    pupil_sensor_answer *a = &o->answer;
    for (uint32_t e = 0; e < PUPIL_SENSOR_GUESSES; e++)
        for (uint32_t g = 0; g < PUPIL_SENSOR_GUESSES; g++)
            a->price[e][g] = e > o->config.delay_frames || g > o->config.delay_frames ? (float)PRIOR : 0.0f;
    a->noise = 2.0 * NOISE_EV;
    a->brighter = FAR_AWAY;
    a->slope = a->steepest = a->gain_does = 1.0;
    for (int i = 0; i < PUPIL_SENSOR_SLOPES; i++)
        a->seen[i] = 1.0;
    a->gains[0] = a->gains[1] = a->gains[2] = a->unit[0] = a->unit[1] = 0.0;
    a->slopes = a->jumps = a->short_steps = a->strange = a->delay[0] = a->delay[1] = a->is_told = 0;
}

/* log2 of what guess h of control c says was in force so many frames before this one. */
static double in_force(const pupil_sensor_answer *a, int c, uint32_t h, uint32_t before)
{
    if (h == TOLD)
        return before ? a->told_before[c] : a->told[c];
    return h == NEVER ? a->anchor[c] : a->asked[(a->frame - h - before) % PUPIL_SENSOR_RING][c];
}

/* By how much the picture's level has moved: from least to most. */
static void moved(const pupil_sensor_answer *a, const pupil_sensor_light *light, double *least, double *most)
{
    *least = -FAR_AWAY, *most = FAR_AWAY;
    for (int i = 0; i < PUPIL_SENSOR_ORDERS; i++) {
        const double low = light->low[i] - a->high_of[i], high = light->high[i] - a->low_of[i];
        if (light->low[i] == light->high[i] && a->low_of[i] == a->high_of[i]) { /* numbers */
            *least = *most = low;
            return;
        }
        *least = low > *least ? low : *least;
        *most = high < *most ? high : *most;
    }
    if (*least > *most)
        *least = *most = 0.5 * (*least + *most);
}

/* Stops that the scene must have moved by itself, if the controls moved by step. How strongly the picture answers is
 * known a little, even where nothing has been seen yet. */
static double left_over(const pupil_sensor_object *o, double step, double least, double most)
{
    const pupil_sensor_answer *a = &o->answer;
    const int known = a->slopes > 1 || o->config.linear;
    const double few = step * (known ? 0.8 * a->slope : STEEP_LEAST),
                 many = step * (known ? 1.25 * a->slope : STEEP_MOST);
    const double low = few < many ? few : many, high = few < many ? many : few;
    return high < least ? least - high : low > most ? low - most : 0.0;
}

/* One comparison of this frame with the one before. */
static void weigh(pupil_sensor_object *o, double step[2][PUPIL_SENSOR_GUESSES], double least, double most)
{
    pupil_sensor_answer *a = &o->answer;
    const double scale = 1.0 / (3.0 * a->noise * a->noise);
    double best = FAR_AWAY, told = 0.0, least_paid = FAR_AWAY;
    for (uint32_t e = 0; e < PUPIL_SENSOR_GUESSES; e++) {
        double last = FAR_AWAY, paid = 0.0;
        for (uint32_t g = 0; g < PUPIL_SENSOR_GUESSES; g++) {
            const double all = step[0][e] + step[1][g], left = left_over(o, all, least, most);
            paid = left == last ? paid : 2.0 * pupil_log2(1.0 + left * left * scale);
            last = left;
            told = e == TOLD && g == TOLD ? paid : told;
            least_paid = paid < least_paid ? paid : least_paid;
            a->price[e][g] = (float)((double)a->price[e][g] + paid);
            best = (double)a->price[e][g] < best ? (double)a->price[e][g] : best;
        }
    }
    for (uint32_t e = 0; e < PUPIL_SENSOR_GUESSES; e++)
        for (uint32_t g = 0; g < PUPIL_SENSOR_GUESSES; g++) {
            const double more = (double)a->price[e][g] - best;
            a->price[e][g] = (float)(more < MOST ? more : MOST);
        }
    a->is_told &= told - least_paid < ALIVE;
}

/* The pairs of guesses from the one that is taken where nothing speaks for another: what is told, then the longest. */
static uint32_t guess_at(uint32_t i)
{
    return i == TOLD || i == NEVER ? i : NEVER - i;
}

/* What is not ruled out: the range of what was in force, and whether the last setting is. A camera that does not obey
 * counts only where nothing else is left. */
static void survey(pupil_sensor_answer *a, int never)
{
    a->is_told &= (double)a->price[TOLD][TOLD] < ALIVE;
    const uint32_t end = never ? PUPIL_SENSOR_GUESSES : a->is_told ? TOLD + 1 : NEVER;
    const double *asked = a->asked[(a->frame - 1) % PUPIL_SENSOR_RING];
    double best = FAR_AWAY;
    a->low = FAR_AWAY, a->high = -FAR_AWAY;
    a->alive[0] = a->alive[1] = a->in_flight = 0;
    for (uint32_t i = 0; i < end; i++)
        for (uint32_t j = 0; j < end; j++) {
            const uint32_t e = guess_at(i), g = guess_at(j);
            if (!((double)a->price[e][g] < ALIVE))
                continue;
            const double exposure = in_force(a, 0, e, 0), gain = in_force(a, 1, g, 0), sum = exposure + gain;
            const double off = sum - asked[0] - asked[1];
            a->alive[0] |= 1u << e, a->alive[1] |= 1u << g;
            a->low = sum < a->low ? sum : a->low;
            a->high = sum > a->high ? sum : a->high;
            a->in_flight |= e != NEVER && g != NEVER && (off > 0.05 || off < -0.05);
            if ((double)a->price[e][g] < best) {
                best = (double)a->price[e][g];
                a->taken[0] = exposure, a->taken[1] = gain;
                a->best[0] = e, a->best[1] = g;
            }
        }
    if (!a->alive[0] && !never)
        survey(a, 1);
    if (never) /* whatever is done next shows which of the two it is */
        a->low = a->high = a->taken[0] + a->taken[1];
}

/* 0, or that info says of a control what was not asked for in the last frames: 1 where it stands still, 2 where it has
 * moved by itself. Where it has moved as was asked, it has another unit. */
static uint32_t is_unheard(pupil_sensor_answer *a, int c, uint32_t gap)
{
    const double step = a->told[c] - a->told_before[c];
    double unit = 0.0;
    for (uint32_t h = 1; h <= PUPIL_SENSOR_DELAYS; h++) {
        const double asked = in_force(a, c, h, 0);
        if (is_near(a->told[c], asked))
            return 0;
        if (!is_near(step, 0.0) && is_near(step, asked - in_force(a, c, h, gap)))
            unit = a->told[c] - asked;
    }
    a->unit[c] += unit;
    return unit != 0.0 ? 0 : is_near(step, 0.0) && a->unheard[c] < 2 ? 1 : 2;
}

/* A control does nothing and is planned around: 1, by the picture; 2, by info, until that says that it moves. */
static int is_dead(const pupil_sensor_answer *a, int c)
{
    const double off = a->told[c] - a->standing[c];
    const int is_off = a->unheard[c] == 1 && (off > UNHEARD_EV || off < -UNHEARD_EV);
    const int stands = a->alive[c] == 1u << TOLD && is_near(a->told[c], a->told_before[c]) && (a->dead[c] || is_off);
    return a->alive[c] == 1u << NEVER ? 1 : 2 * stands;
}

/* A step that nothing in doubt is about, and what the picture made of it. */
static void learn(pupil_sensor_object *o, double step[2][PUPIL_SENSOR_GUESSES], uint32_t gap, double answer, int real)
{
    const pupil_sensor_answer *a = &o->answer;
    const double exposure = step[0][a->best[0]];
    double low = FAR_AWAY, high = -FAR_AWAY;
    for (uint32_t e = 0; e < PUPIL_SENSOR_GUESSES; e++)
        for (uint32_t g = 0; g < PUPIL_SENSOR_GUESSES; g++)
            if (a->alive[0] >> e & a->alive[1] >> g & 1 && (double)a->price[e][g] < ALIVE) {
                const double all = step[0][e] + step[1][g];
                low = all < low ? all : low;
                high = all > high ? all : high;
                real &= is_near(step[0][e], exposure);
            }
    const double size = low > 0.0 ? low : -high;
    pupil_sensor_step seen = {
        .all = 0.5 * (low + high), .answer = answer, .left = answer, .is_real = real && a->left < ALIKE * size};
    for (int c = 0; c < 2; c++)
        seen.then[c] = in_force(a, c, a->best[c], gap), seen.now[c] = in_force(a, c, a->best[c], 0);
    seen.left -= step[0][a->best[0]] + step[1][a->best[1]] - pupil_sensor_jump(a, seen.then[1], seen.now[1], 0.0);
    if (size > STEP_EV && size > 4.0 * a->noise && high - low < 0.1 * size)
        pupil_sensor_learn(o, &seen);
}

/* This frame and the one before it. */
static void compare(pupil_sensor_object *o, const pupil_sensor_light *light, uint32_t gap)
{
    pupil_sensor_answer *a = &o->answer;
    double step[2][PUPIL_SENSOR_GUESSES], least, most;
    int tells = 0;
    for (int c = 0; c < 2; c++)
        for (uint32_t h = 0; h < PUPIL_SENSOR_GUESSES; h++) {
            const double then = in_force(a, c, h, gap), now = in_force(a, c, h, 0);
            step[c][h] = c ? a->gain_does * (now - then) + pupil_sensor_jump(a, then, now, 0.0) : now - then;
            tells |= step[c][h] - step[c][0] > 0.01 || step[c][h] - step[c][0] < -0.01;
        }
    moved(a, light, &least, &most);
    if (tells) {
        const double told = step[0][TOLD] + step[1][TOLD], clear = least > 0.0 ? least : -most;
        weigh(o, step, least, most);
        /* what info says has moved, and the picture with it: from now on it is believed */
        if (o->answer.info_tells && clear > STEP_EV && left_over(o, told, least, most) < a->noise)
            a->is_told = 1;
        survey(a, 0);
        const double dark = pupil_log2(o->config.clip) - REAL_EV;
        if (least == most)
            learn(o, step, gap, least, gap == 1 && light->low[0] > dark && a->low_of[0] > dark);
    }
    const double own = a->slope * (step[0][a->best[0]] + step[1][a->best[1]]), left = least - own;
    a->brighter += most - own;
    a->left = least < most ? FAR_AWAY : left < 0.0 ? -left : left;
    if (least == most) { /* what the best guess leaves is the scene's; of a normal deviate: 1.25 |x| */
        const double size = 1.25 * a->left, cut = 4.0 * a->noise;
        a->noise += 0.1 * ((size < cut ? size : cut) - a->noise);
        a->noise = a->noise > NOISE_EV ? a->noise : NOISE_EV;
    }
}

static double least_price(const pupil_sensor_answer *a, int control, uint32_t h)
{
    double least = FAR_AWAY;
    for (uint32_t other = 0; other < PUPIL_SENSOR_GUESSES; other++) {
        const double price = (double)(control ? a->price[other][h] : a->price[h][other]);
        least = price < least ? price : least;
    }
    return least;
}

/* The delay of a control, once it has been seen to obey and the frames have told this delay from each other one,
 * whatever info says; until it is contradicted. Else 0. */
static uint32_t delay_of(const pupil_sensor_object *o, int control)
{
    const pupil_sensor_answer *a = &o->answer;
    double best = FAR_AWAY, second = FAR_AWAY;
    uint32_t delay = 0;
    for (uint32_t h = 1; h < NEVER; h++)
        if (least_price(a, control, h) < best)
            best = least_price(a, control, h), delay = h;
    /* it began PRIOR behind what is told: where that stays right, no other is more than MOST - PRIOR behind this one */
    const int behind = a->is_told && delay > o->config.delay_frames;
    for (uint32_t h = 1; h < NEVER; h++) {
        const double price = least_price(a, control, h) - (h > o->config.delay_frames && !behind ? PRIOR : 0.0);
        second = h != delay && price < second ? price : second;
    }
    if (second - best >= (behind ? MOST - PRIOR - 1.0 : ALIVE) && least_price(a, control, NEVER) - best > PRIOR + 1.0)
        return delay;
    return a->delay[control] && least_price(a, control, a->delay[control]) - best < ALIVE ? a->delay[control] : 0;
}

void pupil_sensor_answer_frame(pupil_sensor_object *o, const pupil_sensor_light *light, uint64_t sequence)
{
    pupil_sensor_answer *a = &o->answer;
    const uint64_t ahead = sequence - a->sequence;
    const uint32_t gap = sequence > a->sequence && ahead < PUPIL_SENSOR_RING ? (uint32_t)ahead : 1;
    const int first = !a->frame;
    for (uint32_t i = 0; i < (first ? (uint32_t)PUPIL_SENSOR_RING : gap); i++)
        for (int c = 0; c < 2; c++) /* what the first frame was taken with stood for some time */
            a->asked[(a->frame + i) % PUPIL_SENSOR_RING][c] = first ? a->told[c] : a->standing[c];
    a->frame += first ? PUPIL_SENSOR_RING : gap;
    a->gap = gap, a->sequence = sequence;
    for (int c = 0; c < 2; c++) { /* what is told for want of info is in its own unit */
        const double unit = a->unit[c];
        a->told[c] -= a->told[c] == a->standing[c] ? 0.0 : unit;
        a->unheard[c] = is_unheard(a, c, gap);
        a->told[c] -= a->unit[c] - unit, a->told_before[c] -= a->unit[c] - unit;
        a->anchor[c] = first ? a->told[c] : a->anchor[c];
    }
    if (!first && a->has_level && gap < PUPIL_SENSOR_RING - PUPIL_SENSOR_DELAYS && !light->dead)
        compare(o, light, gap);
    survey(a, 0);
    a->disobeys = 0;
    for (int c = 0; c < 2; c++) {
        a->dead[c] = (uint32_t)is_dead(a, c);
        a->disobeys |= !a->dead[c] && (a->alive[c] >> NEVER & 1 || (a->unheard[c] && a->alive[c] & 1u << TOLD));
        a->told_before[c] = a->told[c];
        a->delay[c] = delay_of(o, c);
        if (!(a->alive[c] >> NEVER & 1))
            a->anchor[c] = a->taken[c];
    }
    a->has_level = !light->dead;
    for (int i = 0; i < PUPIL_SENSOR_ORDERS; i++)
        a->low_of[i] = light->low[i], a->high_of[i] = light->high[i];
}

/* The longest delay that is not ruled out. */
uint32_t pupil_sensor_longest_delay(const pupil_sensor_object *o)
{
    for (uint32_t h = NEVER - 1; h > 0; h--)
        if ((o->answer.alive[0] | o->answer.alive[1]) >> h & 1)
            return h;
    return o->config.delay_frames;
}

/* Frames after which a setting is in force, or never will be: what is told tells it by itself. */
uint32_t pupil_sensor_longest_wait(const pupil_sensor_object *o)
{
    return o->answer.alive[0] & o->answer.alive[1] & 1u << TOLD ? PUPIL_SENSOR_DELAYS : pupil_sensor_longest_delay(o);
}
