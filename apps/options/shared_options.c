#include "shared_options.h"

#include "refuse.h"
#include <stdio.h>

const char *option_name(const struct option *options, int option)
{
    for (const struct option *o = options; o->name; o++)
        if (o->val == option)
            return o->name;
    return "?";
}

int option_path(const value_text *c, const char **where)
{
    if (!*c->text)
        return value_refuse(c, "a path");
    *where = c->text;
    return OPTIONS_RUN;
}

int shared_option_flag(int option, frame_options *o)
{
    switch (option) {
    case 'y':
        o->overwrite = 1;
        return 1;
    case 'q':
        o->quiet = 1;
        return 1;
    case OPTION_LOCK:
        o->config.lock = 1;
        return 1;
    case OPTION_FUSED:
        o->config.order = PUPIL_ORDER_FUSED;
        return 1;
    case OPTION_GLES:
        o->gles = 1;
        return 1;
    case OPTION_VIEW:
        o->view = 1;
        return 1;
    default:
        return 0;
    }
}

int shared_option_take(int option, const value_text *c)
{
    frame_options *o = c->o;
    switch (option) {
    case 'o':
        return value_of_out(c);
    case OPTION_STATS:
        return option_path(c, &o->stats);
    case OPTION_PLOT:
        return option_path(c, &o->plot);
    case OPTION_FPS:
        return value_of_fps(c);
    case OPTION_SIZE:
        return value_of_size(c);
    case 'n':
        return value_whole(c, 1, UINT64_C(1) << 40, "a whole number of frames, 1 or more", &o->most);
    case OPTION_TAU_LIGHT:
        return value_number(c, 0.0, 1e6, "seconds, from 0 to 1e6", &o->config.tau_light_s);
    case OPTION_TAU_DARK:
        return value_number(c, 0.0, 1e6, "seconds, from 0 to 1e6", &o->config.tau_dark_s);
    case OPTION_FORMULA:
        return value_of_formula(c);
    case OPTION_WEIGHT:
        return value_of_weight(c);
    case OPTION_KEY:
        return value_number(c, 0x1p-10, 1.0, "from 0.001 to 1", &o->config.key);
    case OPTION_EV:
        return value_number(c, -16.0, 16.0, "stops, from -16 to 16", &o->config.ev_compensation);
    case OPTION_METERING:
        return value_of_metering(c);
    case OPTION_ROI:
        return value_of_roi(c);
    case OPTION_TRIM:
        return value_of_trim(c);
    case OPTION_METER_ROWS:
        return value_of_meter_rows(c);
    case OPTION_WHITE:
        return value_of_white(c);
    case OPTION_TRANSFER:
        return value_of_transfer(c);
    case OPTION_GLES_VERSION:
        return value_of_gles_version(c);
    default:
        return value_of_threads(c);
    }
}

int shared_options_check(const frame_options *o, int weight_given, pupil_why *why)
{
    const char *sentence = NULL;
    if (weight_given && o->config.law == PUPIL_LAW_SECONDS)
        sentence = "--weight: is a weight a frame, of --formula 1..4; the default law takes --tau-light and --tau-dark";
    else if (o->gles_version && !o->gles && !o->view)
        sentence = "--gles-version: is of --gles and --view";
    if (!sentence)
        return OPTIONS_RUN;
    pupil_refuse(why, "%s", sentence);
    return OPTIONS_USAGE;
}
