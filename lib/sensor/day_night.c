/* Day or night, from the light of the scene without that of announced filters. */
#include "sensor_private.h"

void pupil_sensor_day_night_frame(pupil_sensor_object *o)
{
    const pupil_sensor_config *c = &o->config;
    sensor_day_night *d = &o->day_night;
    uint32_t *now = &o->setting.day_night, side = 0;
    const double light = o->setting.scene_ev - d->filter_ev;
    if (c->day_night_s <= 0.0) {
        *now = PUPIL_SENSOR_DAY_NIGHT_UNKNOWN;
        d->side = 0;
        return;
    }
    if (o->announced.frames) /* it is not known with which filter the frame was taken */
        return;
    if (*now == PUPIL_SENSOR_DAY_NIGHT_UNKNOWN) /* at first the middle decides */
        side = light < 0.5 * (c->night_ev + c->day_ev) ? PUPIL_SENSOR_NIGHT : PUPIL_SENSOR_DAY;
    else if (*now == PUPIL_SENSOR_DAY && light < c->night_ev)
        side = PUPIL_SENSOR_NIGHT;
    else if (*now == PUPIL_SENSOR_NIGHT && light > c->day_ev)
        side = PUPIL_SENSOR_DAY;
    d->beyond_s = side && side == d->side ? d->beyond_s + o->setting.dt_s : 0.0;
    d->side = side;
    if (!side || d->beyond_s < c->day_night_s)
        return;
    *now = side;
    d->side = 0;
}
