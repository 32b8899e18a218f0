/* The adapted level as a curve for mappers. */
#include "object.h"

#include "base/numeric.h"
#include "base/versioned.h"
#include "core/read.h"

/* A smaller share of the rods changes no 8-bit code by a tenth, and is left out: by day mapping is as fast as with
 * other laws. */
#define LEAST_RODS 0x1p-10

/* W from its log2; has_white 0: there is none. The scale's bound of 2^60 keeps every product of the tone kernel inside
 * a float: scale * 2^30 of luminance * 2^16 for the smallest white. */
static void set_curve(pupil_curve *curve, double scale_log2, int has_white, double white_log2)
{
    const double knee = (double)PUPIL_GAMUT_KNEE;
    *curve = (pupil_curve){.size_bytes = sizeof *curve, .gamut = (float)(1.0 / (1.0 - knee))};
    curve->scale = (float)pupil_exp2(clamp(scale_log2, -60.0, 60.0));
    if (has_white) {
        double white = pupil_exp2(white_log2);
        curve->inverse_white_squared = (float)pupil_exp2(-2.0 * white_log2);
        curve->gamut = white > 1.0 ? (float)(1.0 / (1.0 - knee) - 1.0 / (white - knee)) : 0.0f;
    }
}

int pupil_curve_before_light_sized(const pupil_t *pupil, pupil_curve *curve, size_t curve_bytes)
{
    const int error = curve ? pupil_object_check(pupil) : PUPIL_ERR_NULL;
    if (error)
        return error;
    const pupil_config *c = &pupil_object_of_const(pupil)->config;
    const double white_log2 = c->white_mode == PUPIL_WHITE_FIXED ? pupil_log2(c->white) : 0.0;
    pupil_curve found;
    set_curve(&found, 0.0, c->white_mode != PUPIL_WHITE_NONE, white_log2);
    found.dither = c->dither;
    return pupil_versioned_write(curve, curve_bytes, &found, sizeof found);
}

int pupil_get_curve_sized(const pupil_t *pupil, const pupil_frame_info *info, pupil_curve *curve, size_t curve_bytes)
{
    pupil_frame_info own;
    pupil_curve found;
    int error = curve ? pupil_object_check(pupil) : PUPIL_ERR_NULL;
    if (!error)
        error = pupil_info_read(&own, info);
    if (error)
        return error;
    info = info ? &own : 0;
    const pupil_object *object = pupil_object_of_const(pupil);
    const pupil_adaptation *a = &object->adaptation;
    const pupil_config *c = &object->config;
    if (!a->seen)
        return PUPIL_ERR_NO_EXPOSURE;

    const double flicker_ev =
        c->flicker ? pupil_flicker_at(&a->flicker, info ? info->timestamp_ns : a->last_timestamp_ns) : 0.0;
    const double scale_log2 = pupil_scale_log2(c, a->result.adapted_ev);
    const double frame_log2 = scale_log2 - pupil_exposure_log2(c, a, info) - flicker_ev;
    if (c->white_mode == PUPIL_WHITE_FIXED)
        set_curve(&found, frame_log2, 1, pupil_log2(c->white));
    else if (c->white_mode == PUPIL_WHITE_FOLLOW && a->white_seen)
        /* never below 1: a frame of little contrast is not stretched */
        set_curve(&found, frame_log2, 1, clamp(scale_log2 + a->result.white_ev, 0.0, 30.0));
    else
        set_curve(&found, frame_log2, 0, 0.0);
    found.dither = c->dither;
    found.rods = c->law == PUPIL_LAW_EYE && a->result.rods >= LEAST_RODS ? (float)a->result.rods : 0.0f;
    if (c->curve != PUPIL_CURVE_REINHARD && a->knots.seen)
        pupil_knots_get(c, &a->knots, pupil_exposure_log2(c, a, info) + flicker_ev, &found);
    return pupil_versioned_write(curve, curve_bytes, &found, sizeof found);
}
