/* The path of settings, from the darkest to the brightest: the effect of a total on it, by the learned responses. */
#include "sensor_private.h"

#include "base/numeric.h"

/* The effect of a total, less that of the requested setting; and the setting for it. What that setting lacks of the
 * total is left to the digital factor. */
double pupil_sensor_effect_of(const pupil_sensor_object *o, double total, double setting[SENSOR_CONTROLS])
{
    double e, g;
    pupil_sensor_split(o, total, &e, &g);
    setting[0] = pupil_log2(pupil_sensor_told(o, e));
    setting[1] = pupil_log2(g);
    return pupil_sensor_effect(&o->estimate, o->estimate.requested, setting);
}

double pupil_sensor_left_of(double total, const double setting[SENSOR_CONTROLS])
{
    return total - setting[0] - setting[1];
}

void pupil_sensor_reach(const pupil_sensor_object *o, double *least, double *most)
{
    double darkest[SENSOR_CONTROLS], brightest[SENSOR_CONTROLS];
    const double asked = pupil_sensor_effect_asked(o);
    if (o->config.exposure_mode == PUPIL_SENSOR_HELD && o->config.gain_mode == PUPIL_SENSOR_HELD) {
        *least = *most = o->plan.wanted; /* and what was rounded is held, too */
        return;
    }
    pupil_sensor_ends(o, darkest, brightest);
    *least = asked + pupil_sensor_effect(&o->estimate, o->estimate.requested, darkest);
    *most = asked + pupil_sensor_effect(&o->estimate, o->estimate.requested, brightest);
}

/* The ends of the path of settings. */
void pupil_sensor_path_ends(const pupil_sensor_object *o, double *least, double *most)
{
    double setting[SENSOR_CONTROLS];
    (void)pupil_sensor_effect_of(o, -SENSOR_TOTAL_END_EV, setting);
    *least = setting[0] + setting[1];
    (void)pupil_sensor_effect_of(o, SENSOR_TOTAL_END_EV, setting);
    *most = setting[0] + setting[1];
}

/* The total whose effect is `need` more than that of the requested setting, by the learned responses. */
double pupil_sensor_total_for(const pupil_sensor_object *o, double need)
{
    const sensor_estimate *a = &o->estimate;
    double setting[SENSOR_CONTROLS], low, high;
    pupil_sensor_path_ends(o, &low, &high);
    if (a->response[0] == 1.0 && a->response[1] == 1.0)
        return clamp(a->requested[0] + a->requested[1] + need, low, high);
    /* out of reach: the limit itself, so that no part of the last step is left to the digital factor */
    if (pupil_sensor_effect_of(o, high, setting) <= need + SENSOR_ROUND)
        return high;
    if (pupil_sensor_effect_of(o, low, setting) >= need - SENSOR_ROUND)
        return low;
    for (int i = 0; i < SENSOR_BISECT; i++) {
        const double middle = 0.5 * (low + high);
        const double effect = pupil_sensor_effect_of(o, middle, setting);
        if (effect + pupil_sensor_left_of(middle, setting) < need)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}
