#include "options.h"

#include <stdio.h>
#include <string.h>

#include "options/shared_options.h"
#include "refuse.h"

enum { REPORT = OPTION_OWN, HOLD, RESET_EACH, SEED, KEEP_GOING, LOOP };

static const struct option long_options[] = {
    {"report", required_argument, NULL, REPORT},
    {"hold", required_argument, NULL, HOLD},
    {"reset-each", no_argument, NULL, RESET_EACH},
    {"seed", required_argument, NULL, SEED},
    {"keep-going", no_argument, NULL, KEEP_GOING},
    {"loop", no_argument, NULL, LOOP},
    SHARED_OPTIONS,
};

static int take_flag(int option, frame_options *o)
{
    switch (option) {
    case RESET_EACH:
        o->reset_each = 1;
        return 1;
    case KEEP_GOING:
        o->keep_going = 1;
        return 1;
    case LOOP:
        o->loop = 1;
        return 1;
    default:
        return shared_option_flag(option, o);
    }
}

static int take(int option, const value_text *c)
{
    frame_options *o = c->o;
    switch (option) {
    case REPORT:
        return option_path(c, &o->report);
    case HOLD:
        return value_whole(c, 1, 1000000, "a whole number from 1 to 1000000", &o->hold);
    case SEED:
        return value_whole(c, 1, UINT64_MAX, "a whole number, 1 or more", &o->source.seed);
    default:
        return shared_option_take(option, c);
    }
}

/* What --loop asks of the other options. */
static int check_loop(const frame_options *o, pupil_why *why)
{
    if (o->loop && !o->view)
        return pupil_refuse(why, "--loop: is of --view; to write frames several times there is --hold"), -1;
    for (size_t i = 0; o->loop && i < o->input_count; i++)
        if (strcmp(o->inputs[i], "-") == 0)
            return pupil_refuse(why, "--loop: standard input comes once; name a file"), -1;
    return 0;
}

int replay_options_parse(frame_options *o, int argc, char **argv, pupil_why *why)
{
    int option, weight_given = 0;
    *o = (frame_options){.hold = 1, .metering = "uniform", .white = "follow"};
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
            return OPTIONS_HELP;
        if (option == '?' || option == ':') {
            const char *said = argv[optind - 1];
            pupil_refuse(why, "%s: no such option, or its value is missing; 'pupil replay --help' lists them", said);
            return OPTIONS_USAGE;
        }
        if (take_flag(option, o))
            continue;
        value_text c = {o, option_name(long_options, option), optarg, why};
        weight_given |= option == OPTION_WEIGHT;
        if (take(option, &c))
            return OPTIONS_USAGE;
    }
    o->inputs = (const char *const *)argv + 1;
    if (!o->input_count) {
        pupil_refuse(why,
                     "no input: name an HDR file, a folder, a video or synth:walk; 'pupil replay --help' tells more");
        return OPTIONS_USAGE;
    }
    if (check_loop(o, why) || shared_options_check(o, weight_given, why))
        return OPTIONS_USAGE;
    return OPTIONS_RUN;
}
