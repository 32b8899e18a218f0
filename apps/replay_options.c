#include "replay_options.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "replay_values.h"

enum {
    STATS = 256,
    PLOT,
    REPORT,
    FPS,
    SIZE,
    HOLD,
    RESET_EACH,
    SEED,
    KEEP_GOING,
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
    VIEW,
    LOOP,
    THREADS
};

static const struct option long_options[] = {
    {"out", required_argument, NULL, 'o'},
    {"stats", required_argument, NULL, STATS},
    {"plot", required_argument, NULL, PLOT},
    {"report", required_argument, NULL, REPORT},
    {"overwrite", no_argument, NULL, 'y'},
    {"fps", required_argument, NULL, FPS},
    {"size", required_argument, NULL, SIZE},
    {"frames", required_argument, NULL, 'n'},
    {"hold", required_argument, NULL, HOLD},
    {"reset-each", no_argument, NULL, RESET_EACH},
    {"seed", required_argument, NULL, SEED},
    {"keep-going", no_argument, NULL, KEEP_GOING},
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
    {"view", no_argument, NULL, VIEW},
    {"loop", no_argument, NULL, LOOP},
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

static int take_flag(int option, replay_options *o)
{
    switch (option) {
    case 'y':
        o->overwrite = 1;
        return 1;
    case 'q':
        o->quiet = 1;
        return 1;
    case RESET_EACH:
        o->reset_each = 1;
        return 1;
    case KEEP_GOING:
        o->keep_going = 1;
        return 1;
    case LOCK:
        o->config.lock = 1;
        return 1;
    case FUSED:
        o->config.order = PUPIL_ORDER_FUSED;
        return 1;
    case GLES:
        o->gles = 1;
        return 1;
    case VIEW:
        o->view = 1;
        return 1;
    case LOOP:
        o->loop = 1;
        return 1;
    default:
        return 0;
    }
}

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
    case REPORT:
        return path(c, &o->report);
    case FPS:
        return value_of_fps(c);
    case SIZE:
        return value_of_size(c);
    case 'n':
        return value_whole(c, 1, UINT64_C(1) << 40, "a whole number of frames, 1 or more", &o->most);
    case HOLD:
        return value_whole(c, 1, 1000000, "a whole number from 1 to 1000000", &o->hold);
    case SEED:
        return value_whole(c, 1, UINT64_MAX, "a whole number, 1 or more", &o->source.seed);
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

/* What --view and --gles ask of the other options. */
static int check_view(const replay_options *o, char *why, size_t why_bytes)
{
    if (o->loop && !o->view)
        return snprintf(why, why_bytes, "--loop: is of --view; to write frames several times there is --hold"), -1;
    for (size_t i = 0; o->loop && i < o->input_count; i++)
        if (strcmp(o->inputs[i], "-") == 0)
            return snprintf(why, why_bytes, "--loop: standard input comes once; name a file"), -1;
    if (o->gles_version && !o->gles && !o->view)
        return snprintf(why, why_bytes, "--gles-version: is of --gles and --view"), -1;
    return 0;
}

int replay_options_parse(replay_options *o, int argc, char **argv, char *why, size_t why_bytes)
{
    int option, weight_given = 0;
    *o = (replay_options){.hold = 1, .metering = "uniform", .white = "follow"};
    pupil_config_default(&o->config);
    o->config.histogram = 1; /* every record has quantiles */

    optind = 1;
    opterr = 0;
    while ((option = getopt_long(argc, argv, "+o:n:yqh", long_options, NULL)) != -1 || optind < argc) {
        if (option == -1) { /* an input; gathered at the front of argv, so that options may stand on either side */
            if (optind > 1 && strcmp(argv[optind - 1], "--") == 0) {
                while (optind < argc)
                    argv[1 + o->input_count++] = argv[optind++];
                break;
            }
            argv[1 + o->input_count++] = argv[optind++];
            continue;
        }
        if (option == 'h')
            return REPLAY_HELP;
        if (option == '?' || option == ':') {
            const char *said = argv[optind - 1];
            snprintf(why, why_bytes, "%s: no such option, or its value is missing; 'pupil replay --help' lists them",
                     said);
            return REPLAY_USAGE;
        }
        if (take_flag(option, o))
            continue;
        value_text c = {o, name_of(option), optarg, why, why_bytes};
        weight_given |= option == WEIGHT;
        if (take(option, &c))
            return REPLAY_USAGE;
    }
    o->inputs = (const char *const *)argv + 1;
    if (!o->input_count) {
        snprintf(why, why_bytes,
                 "no input: name an HDR file, a folder, a video or synth:walk; 'pupil replay --help' tells more");
        return REPLAY_USAGE;
    }
    if (check_view(o, why, why_bytes))
        return REPLAY_USAGE;
    if (weight_given && o->config.law == PUPIL_LAW_SECONDS) {
        snprintf(why, why_bytes,
                 "--weight: is a weight a frame, of --formula 1..4; the default law takes --tau-light and --tau-dark");
        return REPLAY_USAGE;
    }
    return REPLAY_RUN;
}
