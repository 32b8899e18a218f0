/* What the camera does otherwise than its numbers say, learned from clear steps. */
#include "sensor_private.h"

#include "base/numeric.h"

#define STRAIGHT     0.06 /* no slope at all: what is seen of one is that uncertain */
#define STRANGE_MOST 4
#define ALIKE        0.1 /* gains that agree; the least jump */
#define SHAKY        1.1 /* slopes that are further apart are not one */
#define LEAST_GAIN   0.5 /* of what it should; less is rather the scene's */

static double middle_of(const double x[3])
{
    const double least = x[0] < x[1] ? x[0] : x[1], most = x[0] < x[1] ? x[1] : x[0];
    return x[2] < least ? least : x[2] > most ? most : x[2];
}

/* A step of gain alone. What it does less than it should is believed where the last three say the same. */
static void learn_gain(pupil_sensor_answer *a, double does)
{
    a->gains[0] = a->gains[1], a->gains[1] = a->gains[2], a->gains[2] = does;
    const double middle = middle_of(a->gains);
    a->gain_does = middle > LEAST_GAIN && middle < 1.0 - STRAIGHT ? middle : 1.0;
    for (int i = 0; i < 3; i++)
        if (a->gains[i] < middle * (1.0 - ALIKE) || a->gains[i] > middle * (1.0 + ALIKE))
            a->gain_does = 1.0;
}

/* A step past a gain from which on the camera does so much more, or less; line: what a missing line would be of it.
 * Returns whether that was seen before. */
static int learn_jump(pupil_sensor_answer *a, const pupil_sensor_step *step, double line)
{
    const int up = step->then[1] < step->now[1];
    const double low = up ? step->then[1] : step->now[1], high = up ? step->now[1] : step->then[1];
    const double jump = up ? step->left : -step->left;
    const int starts = low <= a->place[0] && high > a->place[0], ends = high >= a->place[1] && low < a->place[1];
    const int again = a->jumps && high > a->place[0] && low < a->place[1] && is_near(jump, a->jump);
    if (a->slope * a->gain_does != 1.0 || is_near(high, low) || line != 0.0 || !step->is_real)
        return again;
    if (jump < ALIKE && jump > -ALIKE) { /* not between these two */
        a->jumps = starts && ends ? 0 : a->jumps;
        a->place[0] = starts ? high : a->place[0];
        a->place[1] = ends ? low : a->place[1];
        return 0;
    }
    a->place[0] = again && a->place[0] > low ? a->place[0] : low;
    a->place[1] = again && a->place[1] < high ? a->place[1] : high;
    a->jump = jump, a->jumps = again ? 2 : 1, a->steepest = a->slope;
    return again;
}

/* A step with exposure in it. Returns whether a line is missing. */
static int learn_line(pupil_sensor_answer *a, const pupil_sensor_step *step, double line)
{
    if (a->slope * a->gain_does != 1.0 || line == 0.0 || !step->is_real)
        return 0;
    const double share = step->left / line;
    a->short_steps = share < 0.5 ? 0 : a->short_steps + (share < 1.5 && a->short_steps < 2);
    return share > 0.5 && share < 1.5;
}

/* The steepest slope that was not seen once only, or just now; where that is not the slope itself. */
static double steepest_of(const double seen[PUPIL_SENSOR_SLOPES], double slope)
{
    double first = 0.0, second = 0.0;
    for (int i = 0; i < PUPIL_SENSOR_SLOPES; i++) {
        second = seen[i] > first ? first : seen[i] > second ? seen[i] : second;
        first = seen[i] > first ? seen[i] : first;
    }
    second = second > seen[0] ? second : seen[0];
    return second > SHAKY * slope ? second : slope;
}

/* Of a picture that is said to be linear, what gain does less or more than it should is not the picture's: if that is
 * wrong, a step of exposure is too short. */
void pupil_sensor_learn(pupil_sensor_object *o, const pupil_sensor_step *step)
{
    pupil_sensor_answer *a = &o->answer;
    const double slope = step->answer / step->all, does = a->gain_does * slope / a->slope;
    if (!(slope > 0.3 && slope < 3.3)) {
        a->strange += a->strange < STRANGE_MOST;
        return;
    }
    a->strange -= a->strange > 0;
    a->slopes += a->slopes < 3;
    if (o->config.linear) {
        const double less = pupil_sensor_shorter(o, step->now[0]) - pupil_sensor_shorter(o, step->then[0]);
        const double line = less < a->noise && less > -a->noise ? 0.0 : less; /* that would be seen */
        const int is_alone = is_near(step->now[0], step->then[0]);
        if (learn_jump(a, step, line))
            return;
        if (step->is_real && is_alone)
            learn_gain(a, does);
        if (is_alone ? does < 1.0 - STRAIGHT && does * a->slope < 1.0 - STRAIGHT : learn_line(a, step, line))
            return;
    }
    for (int i = PUPIL_SENSOR_SLOPES - 1; i > 0; i--) /* the first of a camera of which nothing is known stands alone */
        a->seen[i] = !o->config.linear && a->slopes == 1 ? slope : a->seen[i - 1];
    a->seen[0] = slope;
    double middle = middle_of(a->seen);
    if (middle > 1.0 - STRAIGHT && middle < 1.0 + STRAIGHT)
        middle = 1.0;
    if (middle > a->slope * (1.0 + STRAIGHT) || middle < a->slope * (1.0 - STRAIGHT)) /* what steps turned back for */
        o->stride = a->gain_does = 1.0, a->jumps = 0;
    a->slope = middle;
    a->steepest = steepest_of(a->seen, middle);
}
