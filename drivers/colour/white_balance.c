#include "white_balance.h"

#include <string.h>

#include "refuse.h"

#define LARGE     256          /* rows from which on one in eight is enough */
#define NOMINAL_S (1.0 / 30.0) /* between frames without timestamps, as pupil_config.nominal_frame_s */

static void choose_black(pupil_coding *c, const pupil_colour_options *o, uint32_t bits,
                         const pupil_camera_sensor *sensor)
{
    if (o->black == PUPIL_COLOUR_GIVEN)
        c->black = o->given_black;
    else if (o->black == PUPIL_COLOUR_AUTO && sensor && sensor->black > 0.0 && !(c->black > 0.0f))
        c->black = (float)(sensor->black / (double)(UINT32_C(1) << (16 - bits))); /* 4096 is 64 of 10 bits */
}

static void choose_knees(pupil_coding *c, const pupil_colour_options *o)
{
    if (!o->knees)
        return;
    c->knees = o->knees;
    memcpy(c->knee_code, o->knee_code, sizeof c->knee_code);
    memcpy(c->knee_light, o->knee_light, sizeof c->knee_light);
}

static void choose_colours(pupil_coding *c, const pupil_colour_options *o, const pupil_camera_sensor *sensor)
{
    if (o->balance == PUPIL_COLOUR_GIVEN)
        memcpy(c->balance, o->given_balance, sizeof c->balance);
    if (o->matrix == PUPIL_COLOUR_GIVEN)
        memcpy(c->rgb_from_camera, o->given_matrix, sizeof c->rgb_from_camera);
    else if (o->matrix == PUPIL_COLOUR_AUTO && o->balance != PUPIL_COLOUR_OFF && sensor && sensor->has_matrix)
        memcpy(c->rgb_from_camera, sensor->matrix, sizeof c->rgb_from_camera);
}

static void begin_meter(pupil_t *meter, uint32_t meter_rows)
{
    pupil_config config;
    pupil_config_default(&config);
    config.grey_world = 1;
    config.white_mode = PUPIL_WHITE_NONE; /* no histogram */
    config.meter_rows = meter_rows;
    pupil_init(meter, &config);
}

int pupil_white_balance_begin(pupil_white_balance *colour, const pupil_colour_options *options,
                              const pupil_coding *coding, uint32_t pixel, const pupil_camera_sensor *sensor,
                              pupil_why *why)
{
    const uint32_t bits = pupil_pixel_bits(pixel);
    const int mosaic = pupil_pixel_is_mosaic(pixel);
    const char *fault = "";
    memset(colour, 0, sizeof *colour);
    if (!mosaic && (options->balance == PUPIL_COLOUR_GIVEN || options->matrix == PUPIL_COLOUR_GIVEN))
        return pupil_refuse(
            why, "a white balance or a matrix was given, and is of raw formats (Bayer); this camera's frames "
                 "have their colours already (--white-balance and --matrix auto or off)");
    if (!bits && options->black == PUPIL_COLOUR_GIVEN)
        return pupil_refuse(
            why, "a black level was given, and is of raw formats and grey; this camera's frames have colours "
                 "already (--black-level auto or off)");
    if (coding)
        colour->coding = *coding;
    if (!bits && options->knees)
        return pupil_refuse(why, "knees were given, and are of raw formats and grey; this camera's frames have colours "
                                 "already (leave --knees out)");
    if (bits) {
        choose_black(&colour->coding, options, bits, sensor);
        choose_knees(&colour->coding, options);
    }
    if (mosaic)
        choose_colours(&colour->coding, options, sensor);
    colour->follows = mosaic && options->balance == PUPIL_COLOUR_AUTO;
    colour->first = colour->coding;
    if (pupil_coding_check(&colour->coding, pixel, &fault))
        return pupil_refuse(why, "--black-level, --knees, --white-balance or --matrix does not suit these frames: %s",
                            fault);
    return 0;
}

/* The factors that this frame asks for. 0: it asks for none. */
static int look(pupil_white_balance *colour, const pupil_image_const *image, const pupil_frame_info *info,
                float grey[3])
{
    pupil_stats stats;
    if (!colour->looked)
        begin_meter(&colour->meter, image->height >= LARGE ? 8 : 1);
    colour->looked = 1;
    pupil_stats_clear(&stats);
    if (pupil_meter_rows(&colour->meter, image, 0, image->height, &stats) != PUPIL_OK)
        return 0;
    pupil_adapt(&colour->meter, &stats, info); /* counts frames, by which the rows are chosen */
    return pupil_stats_grey_world(&stats, grey) == PUPIL_OK;
}

void pupil_white_balance_frame(pupil_white_balance *colour, const pupil_image_const *image,
                               const pupil_frame_info *info)
{
    float grey[3];
    if (!colour->follows || !look(colour, image, info, grey))
        return;
    const double past_s = info->timestamp_ns || colour->last_ns
                              ? ((double)info->timestamp_ns - (double)colour->last_ns) * 1e-9
                              : NOMINAL_S;
    const double dt_s = past_s > 0.0 ? past_s : 0.0;
    /* The implicit step of a first-order filter: no overshoot after a gap of any length. */
    const double share = colour->began ? dt_s / (dt_s + PUPIL_WHITE_BALANCE_TAU_S) : 1.0;
    for (int i = 0; i < 3; i++) {
        const double aim = grey[i] < PUPIL_WHITE_BALANCE_MOST ? (double)grey[i] : PUPIL_WHITE_BALANCE_MOST;
        colour->balance[i] += share * (aim - colour->balance[i]);
        colour->coding.balance[i] = (float)colour->balance[i];
    }
    colour->began = 1;
    colour->last_ns = info->timestamp_ns;
}
