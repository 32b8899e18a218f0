/* Exchanges much of one control for the other, in parts. */
#include "sensor_private.h"

#include "base/numeric.h"

/* Rounds a setting to one that the camera has. */
static void round_setting(const pupil_sensor_object *o, double setting[SENSOR_CONTROLS], double *e, double *g)
{
    const pupil_sensor_config *c = &o->config;
    const double longest_s = pupil_sensor_longest_exposure(c);
    *e = pupil_sensor_exposure_of(c, clamp(pupil_exp2(setting[0]), c->exposure_min_s, longest_s));
    *e = pupil_sensor_told_ask(o, *e);
    *g = pupil_sensor_gain_of(c, pupil_exp2(setting[1]));
    setting[0] = pupil_log2(pupil_sensor_told(o, *e));
    setting[1] = pupil_log2(*g);
}

/* Until the delays are known, one control moves alone: the gain, or else the exposure. Returns whether that is
 * enough. */
static int move_one(const pupil_sensor_object *o, double total, double part[SENSOR_CONTROLS], double *e, double *g)
{
    const double *from = o->estimate.requested;
    for (int c = SENSOR_GAIN; c >= SENSOR_EXPOSURE; c--) {
        const int other = SENSOR_CONTROLS - 1 - c;
        part[other] = from[other];
        part[c] = total - from[other];
        round_setting(o, part, e, g);
        if (size_of(total - part[0] - part[1]) <= SENSOR_COARSE_EV)
            return 1;
    }
    return 0;
}

/* Exchanges in parts: if the delays differ, a frame has one change and not yet the other, and the digital factor can
 * make up for only so much. Returns whether `setting` was replaced by a part. */
int pupil_sensor_is_part_of_exchange(const pupil_sensor_object *o, double total, double setting[SENSOR_CONTROLS],
                                     double *e, double *g)
{
    const pupil_sensor_config *c = &o->config;
    const double *from = o->estimate.requested;
    const int is_timed = o->estimate.is_borne_out || (o->estimate.delay[0] && o->estimate.delay[1]);
    const double most_ev = is_timed ? SENSOR_EXCHANGE_EV : SENSOR_BLIND_EXCHANGE_EV;
    const double move[SENSOR_CONTROLS] = {setting[0] - from[0], setting[1] - from[1]};
    const int minor = size_of(move[0]) < size_of(move[1]) ? 0 : 1, major = SENSOR_CONTROLS - 1 - minor;
    /* a gain that is held does not move */
    if (move[0] * move[1] >= 0.0 || size_of(move[minor]) <= most_ev || c->exposure_mode != PUPIL_SENSOR_AUTO)
        return 0;
    double part[SENSOR_CONTROLS];
    part[minor] = from[minor] + (move[minor] > 0.0 ? most_ev : -most_ev);
    part[major] = setting[major] + setting[minor] - part[minor];
    round_setting(o, part, e, g);
    const int moves_both = size_of(part[0] - from[0]) >= 0.5 * most_ev && size_of(part[1] - from[1]) >= 0.5 * most_ev;
    if (!moves_both || size_of(total - part[0] - part[1]) > SENSOR_COARSE_EV) { /* there is no such setting */
        if (is_timed || !move_one(o, total, part, e, g))
            return 0;
    }
    setting[0] = part[0];
    setting[1] = part[1];
    return 1;
}
