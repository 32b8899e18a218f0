/* Finds a wrong black level: the same value is added to all pixels. Then a step of the setting moves the values v of
 * two ranks to b + (v - b) r, with the same b and the r that was asked for. With a tone curve, or a control that does
 * nothing, each rank has another b. */
#include "sensor_private.h"

#include "base/numeric.h"

/* The value b, of the step of `ev` stops that has moved a value from one log2 to another. */
static double fixed_value(double from, double to, double ev)
{
    const double ratio = pupil_exp2(ev);
    return (pupil_exp2(to) - pupil_exp2(from) * ratio) / (1.0 - ratio);
}

static int is_known(const sensor_evidence *v)
{
    return v->is_number && v->clipped_share < SENSOR_MEAN_MARGIN && v->black_share < SENSOR_MEAN_MARGIN &&
           v->rank[0] > -SENSOR_FAR_AWAY;
}

/* What is added to all pixels is in the darkest of them, too. Without this the steep part and the flat part of a
 * companded picture look like it. */
void pupil_sensor_black_frame(pupil_sensor_object *o, const sensor_evidence *v)
{
    sensor_black *b = &o->black;
    const double dark = pupil_exp2(v->rank[0]);
    if (!(v->rank[0] > -SENSOR_FAR_AWAY))
        return;
    b->darkest = b->darkest > 0.0 ? smaller(b->darkest, dark) : dark;
    if (b->darkest < SENSOR_BLACK_NOISE * b->value)
        b->value = 0.0;
}

void pupil_sensor_black_before(pupil_sensor_object *o, const sensor_evidence *v)
{
    for (int i = 0; i < SENSOR_RANKS; i++)
        o->black.before[i] = is_known(v) ? v->rank[i] : -SENSOR_FAR_AWAY;
}

/* The black level by each rank; whether they agree on one, which is large and is in the darkest pixels, too. */
static int is_one_level(const sensor_black *b, const sensor_evidence *v, double ev, double value[SENSOR_RANKS])
{
    double least = SENSOR_FAR_AWAY, most = -SENSOR_FAR_AWAY;
    for (int i = 0; i < SENSOR_RANKS; i++) {
        value[i] = fixed_value(b->before[i], v->rank[i], ev);
        least = smaller(value[i], least);
        most = larger(value[i], most);
    }
    return most - least < SENSOR_BLACK_ALIKE * most && least > SENSOR_BLACK_SHARE * pupil_exp2(v->rank[1]) &&
           b->darkest >= SENSOR_BLACK_NOISE * value[0];
}

void pupil_sensor_find_black(pupil_sensor_object *o, const sensor_evidence *v, double ev)
{
    sensor_black *b = &o->black;
    const int is_clear = o->config.linear && is_known(v) && b->before[0] > -SENSOR_FAR_AWAY &&
                         size_of(ev) >= SENSOR_BLACK_STEP_EV && v->rank[1] > v->rank[0] + SENSOR_BLACK_SPREAD_EV;
    double value[SENSOR_RANKS];
    if (!is_clear)
        return;
    const int is_one = is_one_level(b, v, ev, value);
    const int is_again = is_one && size_of(value[0] - b->candidate) < SENSOR_BLACK_ALIKE * value[0];
    if (is_one || size_of(ev) >= 2.0 * SENSOR_BLACK_STEP_EV) /* small steps are the least reliable */
        b->candidate = is_one ? value[0] : 0.0;
    if (is_again && b->value == 0.0) { /* what was learned of the controls came from the black level */
        o->estimate.response[0] = o->estimate.response[1] = 1.0;
        o->estimate.learned = 0;
    }
    if (is_again)
        b->value = value[0];
    else if (!is_one && size_of(value[1]) < 0.5 * b->value)
        b->value = 0.0;
}

double pupil_sensor_above_black(const pupil_sensor_object *o, double level)
{
    const double b = o->black.value, value = pupil_exp2(level), least = SENSOR_BLACK_FLOOR * b;
    return b > 0.0 ? pupil_log2(value - b > least ? value - b : least) : level;
}
