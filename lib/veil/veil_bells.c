/* Known lights as bells: their terms are summed, and spread by one table. */
#include "veil_private.h"

#include "base/fault.h"
#include "base/numeric.h"

/* Whether, on one axis, neither a bell nor its next period wraps around into the picture. */
static int fits(double at, double radius, double size, double period)
{
    return within(at, size - period + radius, period - radius);
}

static int check_spots(const veil_object *o, uint32_t bell, double radius, const pupil_veil_spot *spot, size_t count)
{
    const pupil_veil_config *c = &o->config;
    const double width = c->width, height = c->height;
    for (size_t i = 0; i < count; i++) {
        if (spot[i].reserved || !fits(spot[i].x_px, radius, width, c->period * width))
            return PUPIL_ERR_VALUE;
        if (bell != PUPIL_VEIL_BAND && !fits(spot[i].y_px, radius, height, c->period * height))
            return PUPIL_ERR_VALUE;
        for (int channel = 0; channel < 3; channel++)
            if (!within((double)spot[i].rgb[channel], 0.0, (double)PUPIL_CEILING))
                return PUPIL_ERR_VALUE;
    }
    return PUPIL_OK;
}

static void add_spot(veil_object *o, const pupil_veil_spot *spot)
{
    const pupil_veil_config *c = &o->config;
    float x[VEIL_TERMS], y[VEIL_TERMS];
    pupil_veil_terms_at(spot->x_px / (c->period * c->width), o->terms, x);
    pupil_veil_terms_at(spot->y_px / (c->period * c->height), o->terms, y);
    for (int channel = 0; channel < 3; channel++)
        for (uint32_t l = 0; l < o->terms; l++) {
            const float light = spot->rgb[channel] * y[l];
            float *restrict row = o->work[channel][l];
            for (uint32_t k = 0; k < o->terms; k++)
                row[k] += light * x[k];
        }
}

int pupil_veil_add_bells(pupil_veil *veil, uint32_t bell, double radius_px, const pupil_veil_spot *spot, size_t count)
{
    int error = spot || !count ? pupil_veil_check(veil) : PUPIL_ERR_NULL;
    if (error)
        return error;
    veil_object *o = pupil_veil_object_of(veil);
    if (bell >= PUPIL_VEIL_BELL_COUNT || !within(radius_px, 1e-3, 4.0 * PUPIL_MAX_SIDE_PX))
        return PUPIL_ERR_VALUE;
    error = check_spots(o, bell, radius_px, spot, count);
    if (error)
        return error;
    pupil_veil_fill_bell(o, bell, radius_px);
    __builtin_memset(o->work, 0, sizeof o->work);
    for (size_t i = 0; i < count; i++)
        add_spot(o, &spot[i]);
    for (int channel = 0; channel < 3; channel++)
        pupil_veil_spread(o, (const float(*)[VEIL_WAVES])o->bell_table,
                          (const float(*)[VEIL_TERM_ROOM])o->work[channel], channel);
    return PUPIL_OK;
}
