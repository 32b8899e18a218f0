#include "run_options.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "colour_options.h"

enum {
    MODE = 256,
    WIDTH,
    HEIGHT,
    SIZE,
    FPS,
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
    STATS,
    PLOT,
    RECORD,
    VIEW,
    TAU_LIGHT,
    TAU_DARK,
    FORMULA,
    WEIGHT,
    KEY,
    EV,
    LOCK,
    METERING,
    ROI,
    TRIM,
    METER_ROWS,
    WHITE,
    TRANSFER,
    FUSED,
    GLES,
    GLES_VERSION,
    THREADS
};

static const struct option long_options[] = {
    {"device", required_argument, NULL, 'd'},
    {"mode", required_argument, NULL, MODE},
    {"width", required_argument, NULL, WIDTH},
    {"height", required_argument, NULL, HEIGHT},
    {"size", required_argument, NULL, SIZE},
    {"framerate", required_argument, NULL, FPS},
    {"fps", required_argument, NULL, FPS},
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
    {"out", required_argument, NULL, 'o'},
    {"stats", required_argument, NULL, STATS},
    {"plot", required_argument, NULL, PLOT},
    {"record", required_argument, NULL, RECORD},
    {"view", no_argument, NULL, VIEW},
    {"overwrite", no_argument, NULL, 'y'},
    {"frames", required_argument, NULL, 'n'},
    {"timeout", required_argument, NULL, 't'},
    {"tau-light", required_argument, NULL, TAU_LIGHT},
    {"tau-dark", required_argument, NULL, TAU_DARK},
    {"formula", required_argument, NULL, FORMULA},
    {"weight", required_argument, NULL, WEIGHT},
    {"key", required_argument, NULL, KEY},
    {"ev", required_argument, NULL, EV},
    {"lock", no_argument, NULL, LOCK},
    {"metering", required_argument, NULL, METERING},
    {"roi", required_argument, NULL, ROI},
    {"trim", required_argument, NULL, TRIM},
    {"meter-rows", required_argument, NULL, METER_ROWS},
    {"white", required_argument, NULL, WHITE},
    {"transfer", required_argument, NULL, TRANSFER},
    {"fused", no_argument, NULL, FUSED},
    {"gles", no_argument, NULL, GLES},
    {"gles-version", required_argument, NULL, GLES_VERSION},
    {"threads", required_argument, NULL, THREADS},
    {"quiet", no_argument, NULL, 'q'},
    {"help", no_argument, NULL, 'h'},
    {NULL, 0, NULL, 0},
};

static const char *name_of(int option)
{
    for (const struct option *o = long_options; o->name; o++)
        if (o->val == option)
            return o->name;
    return "?";
}

static int path(const value_text *c, const char **where)
{
    if (!*c->text)
        return value_refuse(c, "a path");
    *where = c->text;
    return REPLAY_RUN;
}

static int take_flag(int option, run_options *r)
{
    replay_options *o = &r->shown;
    switch (option) {
    case 'y':
        return o->overwrite = 1;
    case 'q':
        return o->quiet = 1;
    case NEWEST:
        return r->live.capture.newest = 1;
    case NO_PRIORITY:
        return r->any_frame_rate = 1;
    case VIEW:
        return o->view = 1;
    case GLES:
        return o->gles = 1;
    case LOCK:
        o->config.lock = 1;
        return 1;
    case FUSED:
        o->config.order = PUPIL_ORDER_FUSED;
        return 1;
    default:
        return 0;
    }
}

/* What a camera is asked for. */
static int take_camera(int option, const value_text *c, run_options *r)
{
    static const char moment[] = "10ms, 1/100, 0.01s, or a plain number of microseconds, from 1us to 1000s";
    uint64_t whole = 0;
    switch (option) {
    case 'd':
        return *c->text ? path(c, &r->device) : value_refuse(c, "a path, a number or a camera's name");
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
            return REPLAY_USAGE;
        r->live.capture.buffers = (uint32_t)whole;
        return REPLAY_RUN;
    case DELAY:
        if (value_whole(c, 1, 15, "frames, from 1 to 15", &whole))
            return REPLAY_USAGE;
        r->live.delay = (uint32_t)whole;
        return REPLAY_RUN;
    case REOPEN:
        return run_value_time(c, 1.0, 0.0, 1e6, "seconds, from 0 to 1e6", &r->live.capture.reopen_s);
    case SHUTTER:
        return run_value_time(c, 1e-6, 1e-6, 1000.0, moment, &r->exposure_s);
    case GAIN:
        return value_number(c, 0x1p-10, 65536.0, "a factor, from 0.001 to 65536", &r->gain);
    case MAINS:
        return run_value_mains(c, &r->live.mains_hz);
    case FLICKER_PERIOD:
        return run_value_period(c, &r->live.mains_hz);
    case WHITE_BALANCE:
        return colour_option_balance(&r->colour, c->text, c->why, c->why_bytes) ? REPLAY_USAGE : REPLAY_RUN;
    case COLOUR_MATRIX:
        return colour_option_matrix(&r->colour, c->text, c->why, c->why_bytes) ? REPLAY_USAGE : REPLAY_RUN;
    case BLACK_LEVEL:
        return colour_option_black(&r->colour, c->text, c->why, c->why_bytes) ? REPLAY_USAGE : REPLAY_RUN;
    case RECORD:
        return path(c, &c->o->record);
    case 't':
        return run_value_time(c, 1.0, 1e-3, 1e9, "seconds above 0, or 500ms, 10min", &r->seconds);
    default:
        return -1;
    }
}

/* What a replay has, too. */
static int take(int option, const value_text *c)
{
    replay_options *o = c->o;
    switch (option) {
    case 'o':
        return value_of_out(c);
    case STATS:
        return path(c, &o->stats);
    case PLOT:
        return path(c, &o->plot);
    case FPS:
        return value_of_fps(c);
    case SIZE:
        return value_of_size(c);
    case 'n':
        return value_whole(c, 1, UINT64_C(1) << 40, "a whole number of frames, 1 or more", &o->most);
    case TAU_LIGHT:
        return value_number(c, 0.0, 1e6, "seconds, from 0 to 1e6", &o->config.tau_light_s);
    case TAU_DARK:
        return value_number(c, 0.0, 1e6, "seconds, from 0 to 1e6", &o->config.tau_dark_s);
    case FORMULA:
        return value_of_formula(c);
    case WEIGHT:
        return value_of_weight(c);
    case KEY:
        return value_number(c, 0x1p-10, 1.0, "from 0.001 to 1", &o->config.key);
    case EV:
        return value_number(c, -16.0, 16.0, "stops, from -16 to 16", &o->config.ev_compensation);
    case METERING:
        return value_of_metering(c);
    case ROI:
        return value_of_roi(c);
    case TRIM:
        return value_of_trim(c);
    case METER_ROWS:
        return value_of_meter_rows(c);
    case WHITE:
        return value_of_white(c);
    case TRANSFER:
        return value_of_transfer(c);
    case GLES_VERSION:
        return value_of_gles_version(c);
    default:
        return value_of_threads(c);
    }
}

static int conflict(char *why, size_t why_bytes, const char *sentence)
{
    snprintf(why, why_bytes, "%s", sentence);
    return REPLAY_USAGE;
}

/* What options ask of one another. */
static int check(const run_options *r, int weight_given, char *why, size_t why_bytes)
{
    const replay_options *o = &r->shown;
    if (weight_given && o->config.law == PUPIL_LAW_SECONDS)
        return conflict(why, why_bytes,
                        "--weight: is a weight a frame, of --formula 1..4; the default law takes --tau-light and "
                        "--tau-dark");
    if (o->gles_version && !o->gles && !o->view)
        return conflict(why, why_bytes, "--gles-version: is of --gles and --view");
    if (r->mode == RUN_SENSOR && o->config.order == PUPIL_ORDER_FUSED)
        return conflict(why, why_bytes,
                        "--fused: is of --mode digital and both; the picture of sensor is the camera's");
    if (r->mode == RUN_DIGITAL && (r->live.mains_hz || r->any_frame_rate))
        return conflict(why, why_bytes,
                        "--mains, --flicker-period and --no-frame-rate-priority: are of --mode sensor and both; "
                        "digital leaves the camera as it is");
    return REPLAY_RUN;
}

int run_options_parse(run_options *r, int argc, char **argv, char *why, size_t why_bytes)
{
    int option, weight_given = 0;
    *r = (run_options){.shown = {.hold = 1, .metering = "uniform", .white = "follow"}, .mode = RUN_BEST};
    pupil_config_default(&r->shown.config);
    r->shown.config.histogram = 1; /* every record has quantiles, and the sensor's controller sees highlights */

    optind = 1;
    opterr = 0;
    while ((option = getopt_long(argc, argv, "+d:o:n:t:yqh", long_options, NULL)) != -1) {
        if (option == 'h')
            return REPLAY_HELP;
        if (option == '?' || option == ':') {
            snprintf(why, why_bytes, "%s: no such option, or its value is missing; 'pupil run --help' lists them",
                     argv[optind - 1]);
            return REPLAY_USAGE;
        }
        if (take_flag(option, r))
            continue;
        const value_text c = {&r->shown, name_of(option), optarg, why, why_bytes};
        weight_given |= option == WEIGHT;
        const int camera = take_camera(option, &c, r);
        if (camera > 0 || (camera < 0 && take(option, &c)))
            return REPLAY_USAGE;
    }
    if (optind < argc) {
        snprintf(why, why_bytes, "%s: no option; a camera goes behind -d: -d %s", argv[optind], argv[optind]);
        return REPLAY_USAGE;
    }
    return check(r, weight_given, why, why_bytes);
}
