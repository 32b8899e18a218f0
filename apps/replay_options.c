#include "replay_options.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct cursor { /* what a parser of one option needs */
    replay_options *o;
    const char *name, *text;
    char *why;
    size_t why_bytes;
} cursor;

static int refuse(const cursor *c, const char *right)
{
    snprintf(c->why, c->why_bytes, "--%s %s: must be %s", c->name, c->text, right);
    return REPLAY_USAGE;
}

/* A number within a range; `right` says in words what would do. */
static int number(const cursor *c, double low, double high, const char *right, double *value)
{
    char *end;
    errno = 0;
    double v = strtod(c->text, &end);
    if (end == c->text || *end || !(v >= low && v <= high))
        return refuse(c, right);
    *value = v;
    return REPLAY_RUN;
}

static int whole(const cursor *c, uint64_t low, uint64_t high, const char *right, uint64_t *value)
{
    char *end;
    errno = 0;
    unsigned long long v = strtoull(c->text, &end, 10);
    if (end == c->text || *end || errno || strchr(c->text, '-') || v < low || v > high)
        return refuse(c, right);
    *value = v;
    return REPLAY_RUN;
}

/* One of a list of words; its place is the value. */
static int word(const cursor *c, const char *const *words, uint32_t *value)
{
    char right[256] = "";
    for (uint32_t i = 0; words[i]; i++) {
        if (strcmp(c->text, words[i]) == 0) {
            *value = i;
            return REPLAY_RUN;
        }
        snprintf(right + strlen(right), sizeof right - strlen(right), "%s%s", i ? ", " : "", words[i]);
    }
    return refuse(c, right);
}

/* `count` numbers with commas (or, for a trim, a dash) between. */
static int numbers(const cursor *c, int count, const char *right, double *value)
{
    const char *p = c->text;
    for (int i = 0; i < count; i++) {
        char *end;
        value[i] = strtod(p, &end);
        if (end == p || !isfinite(value[i]) || (i + 1 < count ? *end != ',' : *end != 0))
            return refuse(c, right);
        p = end + 1;
    }
    return REPLAY_RUN;
}

static int parse_size(const cursor *c)
{
    unsigned width, height;
    char rest;
    if (sscanf(c->text, "%ux%u%c", &width, &height, &rest) != 2 || strchr(c->text, '-') || !width || !height ||
        width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return refuse(c, "WIDTHxHEIGHT, for example 640x360, each from 1 to 16384");
    c->o->source.width = width;
    c->o->source.height = height;
    return REPLAY_RUN;
}

static int parse_metering(const cursor *c)
{
    static const char *const words[] = {"uniform", "centre", "spot", NULL};
    uint32_t which = 0;
    if (strcmp(c->text, "center") != 0 && word(c, words, &which))
        return REPLAY_USAGE;
    if (strcmp(c->text, "center") == 0)
        which = 1;
    if (which == 0)
        pupil_metering_uniform(&c->o->config);
    else if (which == 1)
        pupil_metering_centre(&c->o->config);
    else
        pupil_metering_spot(&c->o->config);
    snprintf(c->o->metering, sizeof c->o->metering, "%s", words[which]);
    return REPLAY_RUN;
}

static int parse_roi(const cursor *c)
{
    const char *right = "X,Y,WIDTH,HEIGHT in fractions of the frame, for example 0.25,0.25,0.5,0.5";
    double v[4];
    if (numbers(c, 4, right, v))
        return REPLAY_USAGE;
    if (pupil_metering_roi(&c->o->config, v[0], v[1], v[2], v[3]))
        return refuse(c, right);
    snprintf(c->o->metering, sizeof c->o->metering, "roi %s", c->text);
    return REPLAY_RUN;
}

static int parse_trim(const cursor *c)
{
    const char *right = "LOW,HIGH in per cent, for example 5,95, with 0 <= LOW < HIGH <= 100";
    double v[2];
    if (numbers(c, 2, right, v))
        return REPLAY_USAGE;
    if (!(v[0] >= 0.0 && v[0] < v[1] && v[1] <= 100.0))
        return refuse(c, right);
    c->o->config.trim_low = (float)(v[0] / 100.0);
    c->o->config.trim_high = (float)(v[1] / 100.0);
    return REPLAY_RUN;
}

static int parse_meter_rows(const cursor *c)
{
    uint64_t n;
    if (whole(c, 1, 8, "1, 2, 4 or 8", &n))
        return REPLAY_USAGE;
    if (n & (n - 1))
        return refuse(c, "1, 2, 4 or 8");
    c->o->config.meter_rows = (uint32_t)n;
    return REPLAY_RUN;
}

static int parse_white(const cursor *c)
{
    pupil_config *config = &c->o->config;
    snprintf(c->o->white, sizeof c->o->white, "%s", c->text);
    config->white_mode = strcmp(c->text, "follow") == 0 ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_NONE;
    if (config->white_mode == PUPIL_WHITE_FOLLOW || strcmp(c->text, "none") == 0)
        return REPLAY_RUN;
    config->white_mode = PUPIL_WHITE_FIXED;
    return number(c, 0x1p-8, 0x1p30, "follow, none, or a number from 0.0039 to 1e9", &config->white);
}

static int parse_formula(const cursor *c)
{
    uint64_t v;
    if (whole(c, 1, 4, "1, 2, 3 or 4", &v))
        return REPLAY_USAGE;
    c->o->config.law = (uint32_t)(PUPIL_LAW_ARITHMETIC_SCALE + v - 1);
    return REPLAY_RUN;
}

static int parse_weight(const cursor *c)
{
    const char *right = "above 0, up to 1";
    if (number(c, 0.0, 1.0, right, &c->o->config.frame_weight))
        return REPLAY_USAGE;
    return c->o->config.frame_weight > 0.0 ? REPLAY_RUN : refuse(c, right);
}

static int parse_threads(const cursor *c)
{
    uint64_t v;
    if (whole(c, 0, 256, "from 0 (one a processor) to 256", &v))
        return REPLAY_USAGE;
    c->o->threads = (unsigned)v;
    c->o->source.threads = (unsigned)v;
    return REPLAY_RUN;
}

static int parse_fps(const cursor *c)
{
    return number(c, 0.001, 1e5, "frames a second, from 0.001 to 100000", &c->o->source.fps);
}

static int parse_transfer(const cursor *c)
{
    static const char *const words[] = {"srgb", "gamma22", "linear", NULL};
    return word(c, words, &c->o->config.transfer);
}

static int parse_gles_version(const cursor *c)
{
    static const char *const words[] = {"3.0", "3.1", NULL};
    uint32_t which = 0;
    if (word(c, words, &which))
        return REPLAY_USAGE;
    c->o->gles_version = which ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30;
    return REPLAY_RUN;
}

static int parse_out(const cursor *c)
{
    if (c->o->out_count == REPLAY_MOST_OUTPUTS)
        return refuse(c, "one of at most 16 outputs");
    if (!*c->text)
        return refuse(c, "a path");
    c->o->out[c->o->out_count++] = c->text;
    return REPLAY_RUN;
}

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

static int path(const cursor *c, const char **where)
{
    if (!*c->text)
        return refuse(c, "a path");
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

static int take(int option, const cursor *c)
{
    replay_options *o = c->o;
    switch (option) {
    case 'o':
        return parse_out(c);
    case STATS:
        return path(c, &o->stats);
    case PLOT:
        return path(c, &o->plot);
    case REPORT:
        return path(c, &o->report);
    case FPS:
        return parse_fps(c);
    case SIZE:
        return parse_size(c);
    case 'n':
        return whole(c, 1, UINT64_C(1) << 40, "a whole number of frames, 1 or more", &o->most);
    case HOLD:
        return whole(c, 1, 1000000, "a whole number from 1 to 1000000", &o->hold);
    case SEED:
        return whole(c, 1, UINT64_MAX, "a whole number, 1 or more", &o->source.seed);
    case TAU_LIGHT:
        return number(c, 0.0, 1e6, "seconds, from 0 to 1e6", &o->config.tau_light_s);
    case TAU_DARK:
        return number(c, 0.0, 1e6, "seconds, from 0 to 1e6", &o->config.tau_dark_s);
    case FORMULA:
        return parse_formula(c);
    case WEIGHT:
        return parse_weight(c);
    case KEY:
        return number(c, 0x1p-10, 1.0, "from 0.001 to 1", &o->config.key);
    case EV:
        return number(c, -16.0, 16.0, "stops, from -16 to 16", &o->config.ev_compensation);
    case METERING:
        return parse_metering(c);
    case ROI:
        return parse_roi(c);
    case TRIM:
        return parse_trim(c);
    case METER_ROWS:
        return parse_meter_rows(c);
    case WHITE:
        return parse_white(c);
    case TRANSFER:
        return parse_transfer(c);
    case GLES_VERSION:
        return parse_gles_version(c);
    default:
        return parse_threads(c);
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
        cursor c = {o, name_of(option), optarg, why, why_bytes};
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
