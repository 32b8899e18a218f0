#include "options.h"

#include <stdio.h>
#include <string.h>

#include "options/colour_options.h"
#include "options/shared_options.h"
#include "refuse.h"

enum {
    MODE = OPTION_OWN,
    WIDTH,
    HEIGHT,
    FORMAT,
    BUFFERS,
    NEWEST,
    REOPEN,
    SHUTTER,
    GAIN,
    MAINS,
    FLICKER_PERIOD,
    NO_PRIORITY,
    WHITE_BALANCE,
    COLOUR_MATRIX,
    BLACK_LEVEL,
    DELAY,
    CURVE,
    KEY_AT,
    RESUME,
    RECORD,
    ROW_GAINS,
    READOUT
};

static const struct option long_options[] = {
    {"device", required_argument, NULL, 'd'},
    {"mode", required_argument, NULL, MODE},
    {"width", required_argument, NULL, WIDTH},
    {"height", required_argument, NULL, HEIGHT},
    {"framerate", required_argument, NULL, OPTION_FPS},
    {"format", required_argument, NULL, FORMAT},
    {"buffers", required_argument, NULL, BUFFERS},
    {"newest", no_argument, NULL, NEWEST},
    {"reopen", required_argument, NULL, REOPEN},
    {"shutter", required_argument, NULL, SHUTTER},
    {"gain", required_argument, NULL, GAIN},
    {"mains", required_argument, NULL, MAINS},
    {"flicker-period", required_argument, NULL, FLICKER_PERIOD},
    {"no-frame-rate-priority", no_argument, NULL, NO_PRIORITY},
    {"white-balance", required_argument, NULL, WHITE_BALANCE},
    {"matrix", required_argument, NULL, COLOUR_MATRIX},
    {"black-level", required_argument, NULL, BLACK_LEVEL},
    {"control-delay", required_argument, NULL, DELAY},
    {"curve", required_argument, NULL, CURVE},
    {"key-at", required_argument, NULL, KEY_AT},
    {"resume", required_argument, NULL, RESUME},
    {"record", required_argument, NULL, RECORD},
    {"row-gains", no_argument, NULL, ROW_GAINS},
    {"readout", required_argument, NULL, READOUT},
    {"timeout", required_argument, NULL, 't'},
    SHARED_OPTIONS,
};

static int take_flag(int option, run_options *r)
{
    switch (option) {
    case NEWEST:
        return r->live.capture.newest = 1;
    case NO_PRIORITY:
        return r->any_frame_rate = 1;
    case ROW_GAINS:
        return r->row_gains = 1;
    default:
        return shared_option_flag(option, &r->shown);
    }
}

/* Options of the capture; -1: it is none of them. */
static int take_capture(int option, const value_text *c, run_options *r)
{
    uint64_t whole = 0;
    switch (option) {
    case 'd':
        return *c->text ? option_path(c, &r->device) : value_refuse(c, "a path, a number or a camera's name");
    case MODE:
        return run_value_mode(c, &r->mode);
    case WIDTH:
        return run_value_side(c, &c->o->source.width);
    case HEIGHT:
        return run_value_side(c, &c->o->source.height);
    case FORMAT:
        return run_value_format(c, &r->live.capture.fourcc);
    case BUFFERS:
        if (value_whole(c, 2, PUPIL_V4L2_MOST_BUFFERS, "from 2 to 32", &whole))
            return OPTIONS_USAGE;
        r->live.capture.buffers = (uint32_t)whole;
        return OPTIONS_RUN;
    case DELAY:
        if (value_whole(c, 1, 15, "frames, from 1 to 15", &whole))
            return OPTIONS_USAGE;
        r->live.delay = (uint32_t)whole;
        return OPTIONS_RUN;
    case RESUME:
        if (strcmp(c->text, "-") == 0)
            return value_refuse(c, "a file");
        return option_path(c, &r->resume);
    case REOPEN:
        return run_value_time(c, 1.0, 0.0, 1e6, "seconds, from 0 to 1e6", &r->live.capture.reopen_s);
    default:
        return -1;
    }
}

/* What a camera is asked for. */
static int take_camera(int option, const value_text *c, run_options *r)
{
    static const char moment[] = "10ms, 1/100, 0.01s, or a plain number of microseconds, from 1us to 1000s";
    switch (option) {
    case CURVE:
        return run_value_curve(c, &r->curve);
    case KEY_AT:
        return run_value_key_at(c, &r->key_at);
    case SHUTTER:
        return run_value_time(c, 1e-6, 1e-6, 1000.0, moment, &r->exposure_s);
    case GAIN:
        return value_number(c, 0x1p-10, 65536.0, "a factor, from 0.001 to 65536", &r->gain);
    case MAINS:
        return run_value_mains(c, &r->live.mains_hz, &r->mains_off);
    case FLICKER_PERIOD:
        return run_value_period(c, &r->live.mains_hz);
    case WHITE_BALANCE:
        return colour_option_balance(&r->colour, c->text, c->why) ? OPTIONS_USAGE : OPTIONS_RUN;
    case COLOUR_MATRIX:
        return colour_option_matrix(&r->colour, c->text, c->why) ? OPTIONS_USAGE : OPTIONS_RUN;
    case BLACK_LEVEL:
        return colour_option_black(&r->colour, c->text, c->why) ? OPTIONS_USAGE : OPTIONS_RUN;
    case READOUT:
        return run_value_time(c, 1e-3, 1e-4, 1.0, "25ms, or a plain number of milliseconds, from 0.1 to 1000",
                              &r->readout_s);
    case RECORD:
        return option_path(c, &c->o->record);
    case 't':
        return run_value_time(c, 1.0, 1e-3, 1e9, "seconds above 0, or 500ms, 10min", &r->seconds);
    default:
        return take_capture(option, c, r);
    }
}

static int conflict(pupil_why *why, const char *sentence)
{
    pupil_refuse(why, "%s", sentence);
    return OPTIONS_USAGE;
}

/* Of --row-gains, and of --mains where it is about them. */
static int check_lamps(const run_options *r, pupil_why *why)
{
    const frame_options *o = &r->shown;
    if (r->mode == RUN_DIGITAL && ((r->live.mains_hz && !r->row_gains) || r->any_frame_rate))
        return conflict(why, "--mains, --flicker-period and --no-frame-rate-priority: are of --mode sensor and both; "
                             "digital leaves the camera as it is");
    if (r->readout_s > 0.0 && !r->row_gains)
        return conflict(why, "--readout: is of --row-gains");
    if (r->row_gains && (o->gles || o->gles_version))
        return conflict(why, "--row-gains: is the CPU's work, and goes without --gles and --gles-version");
    if (r->row_gains && o->config.order == PUPIL_ORDER_FUSED)
        return conflict(why, "--row-gains: looks at a frame before it is mapped, and goes without --fused");
    if (r->row_gains && r->mains_off)
        return conflict(why, "--row-gains: is about lamps on the mains, and goes without --mains off");
    return OPTIONS_RUN;
}

/* What options ask of one another. */
static int check(const run_options *r, int weight_given, int key_given, pupil_why *why)
{
    const frame_options *o = &r->shown;
    if (shared_options_check(o, weight_given, why))
        return OPTIONS_USAGE;
    if (r->mode == RUN_SENSOR && o->config.order == PUPIL_ORDER_FUSED)
        return conflict(why, "--fused: is of --mode digital and both; the picture of sensor is the camera's");
    if (check_lamps(r, why))
        return OPTIONS_USAGE;
    if (r->key_at && r->mode != RUN_SENSOR)
        return conflict(
            why, "--key-at: is of --mode sensor, which shows the camera's own picture; the other modes adapt it");
    if (r->resume && (r->mode == RUN_DIGITAL || (r->exposure_s > 0.0 && r->gain > 0.0)))
        return conflict(why,
                        "--resume: is of what is steered, which nothing is with --mode digital, or with both --shutter "
                        "and --gain");
    if (r->key_at && key_given)
        return conflict(why, "--key and --key-at: one of them; --key is the same in any light");
    const int by_hand = r->exposure_s > 0.0 || r->gain > 0.0;
    if (r->mode == RUN_DIGITAL && (r->curve || (r->live.delay && !by_hand)))
        return conflict(why,
                        "--curve and (without --shutter and --gain) --control-delay: are of --mode sensor and both; "
                        "digital steers nothing");
    return OPTIONS_RUN;
}

int run_options_parse(run_options *r, int argc, char **argv, pupil_why *why)
{
    int option, weight_given = 0, key_given = 0;
    *r = (run_options){.shown = {.hold = 1, .metering = "uniform", .white = "follow"}, .mode = RUN_BEST};
    pupil_config_default(&r->shown.config);
    r->shown.config.histogram = 1; /* every record has quantiles, and the sensor's controller sees highlights */

    optind = 1;
    opterr = 0;
    while ((option = getopt_long(argc, argv, "+d:o:n:t:yqh", long_options, NULL)) != -1) {
        if (option == 'h')
            return OPTIONS_HELP;
        if (option == '?' || option == ':') {
            pupil_refuse(why, "%s: no such option, or its value is missing; 'pupil run --help' lists them",
                         argv[optind - 1]);
            return OPTIONS_USAGE;
        }
        if (take_flag(option, r))
            continue;
        const value_text c = {&r->shown, option_name(long_options, option), optarg, why};
        weight_given |= option == OPTION_WEIGHT;
        key_given |= option == OPTION_KEY;
        const int camera = take_camera(option, &c, r);
        if (camera > 0 || (camera < 0 && shared_option_take(option, &c)))
            return OPTIONS_USAGE;
    }
    if (optind < argc) {
        pupil_refuse(why, "%s: no option; a camera goes behind -d: -d %s", argv[optind], argv[optind]);
        return OPTIONS_USAGE;
    }
    return check(r, weight_given, key_given, why);
}
