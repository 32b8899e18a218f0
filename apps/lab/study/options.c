#include "options.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pupil/image.h"
#include "refuse.h"

const char study_help[] = "usage: pupil study [SCENE] [options]\n"
                          "       pupil study --regression CSV [--check]\n"
                          "When has the picture arrived? Four light scenarios, four formulas, twenty weights.\n"
                          "  SCENE  a recipe of the scene renderer by name or path (room), or spheres: quick\n"
                          "  -o, --out DIR         study.csv, study.md, study.html and a plot of each case into DIR\n"
                          "      --video C,F       also a video of case C, formula F: weights side by side; or all\n"
                          "      --check           exit 1 unless all of A1..A11 hold (or its counts)\n"
                          "      --float32         the recursions as the seeds have them, in binary32: A3 and A5 fail\n"
                          "      --regression CSV  the seeds' table again, from numbers alone; no scene\n"
                          "      --size WxH        of the pictures (600x600); the first threshold is their pixels\n"
                          "      --threads N       (0: one a processor)\n"
                          "  -q, --quiet   -h, --help\n"
                          "exit: 0 done, 1 failed or not met, 2 usage, 130 interrupted\n";

enum { VIDEO = 256, CHECK, FLOAT32, REGRESSION, SIZE, THREADS };

static const struct option long_options[] = {
    {"out", required_argument, NULL, 'o'},
    {"video", required_argument, NULL, VIDEO},
    {"check", no_argument, NULL, CHECK},
    {"float32", no_argument, NULL, FLOAT32},
    {"regression", required_argument, NULL, REGRESSION},
    {"size", required_argument, NULL, SIZE},
    {"threads", required_argument, NULL, THREADS},
    {"quiet", no_argument, NULL, 'q'},
    {"help", no_argument, NULL, 'h'},
    {NULL, 0, NULL, 0},
};

static int parse_video(study_options *o, const char *text)
{
    unsigned which_case, formula;
    int used = 0;
    const int all = strcmp(text, "all") == 0;
    if (!all && (sscanf(text, "%1u,%1u%n", &which_case, &formula, &used) != 2 || text[used] || which_case - 1 > 3 ||
                 formula - 1 > 3))
        return STUDY_USAGE;
    for (unsigned i = 0; i < 16; i++) {
        unsigned known = 0;
        if (!all && i != (formula - 1) * 4 + which_case - 1)
            continue;
        for (unsigned k = 0; k < o->videos; k++)
            known |= o->video[k].which_case == i % 4 && o->video[k].formula == i / 4;
        if (known)
            continue;
        o->video[o->videos].which_case = i % 4;
        o->video[o->videos++].formula = i / 4;
    }
    return STUDY_RUN;
}

/* Two sides that the study can hold in memory, or the one number of threads. */
static int parse_size(study_options *o, const char *text)
{
    unsigned long width, height;
    int used = 0;
    if (sscanf(text, "%6lux%6lu%n", &width, &height, &used) != 2 || text[used] || !width || !height || width > 4096 ||
        height > 4096)
        return STUDY_USAGE;
    o->width = (uint32_t)width;
    o->height = (uint32_t)height;
    return STUDY_RUN;
}

static int parse_threads(study_options *o, const char *text)
{
    int used = 0;
    return sscanf(text, "%4u%n", &o->threads, &used) == 1 && !text[used] && o->threads <= 256 ? STUDY_RUN : STUDY_USAGE;
}

static int take(study_options *o, int option, const char *text, const char **right)
{
    switch (option) {
    case 'o':
        o->out = text;
        *right = "--out: must be a folder";
        return *text ? STUDY_RUN : STUDY_USAGE;
    case VIDEO:
        *right = "--video: must be a case and a formula, 1,1 to 4,4, or all";
        return parse_video(o, text);
    case REGRESSION:
        o->regression = text;
        return STUDY_RUN;
    case SIZE:
        *right = "--size: must be WIDTHxHEIGHT, from 1x1 to 4096x4096";
        return parse_size(o, text);
    case THREADS:
        *right = "--threads: must be a whole number from 0 to 256";
        return parse_threads(o, text);
    case CHECK:
        o->check = 1;
        return STUDY_RUN;
    case FLOAT32:
        o->float32 = 1;
        return STUDY_RUN;
    default:
        o->quiet = 1;
        return STUDY_RUN;
    }
}

int study_options_parse(study_options *o, int argc, char **argv, pupil_why *why)
{
    int option;
    *o = (study_options){0};
    optind = 1;
    opterr = 0;
    while ((option = getopt_long(argc, argv, "o:qh", long_options, NULL)) != -1) {
        const char *right = "";
        if (option == 'h')
            return STUDY_HELP;
        if (option == '?' || option == ':') {
            pupil_refuse(why, "%s: no such option, or its value is missing; 'pupil study --help' lists them",
                         argv[optind - 1]);
            return STUDY_USAGE;
        }
        if (take(o, option, optarg, &right)) {
            pupil_refuse(why, "%s, not %s", right, optarg);
            return STUDY_USAGE;
        }
    }
    if (argc - optind > 1 || (o->regression && (argc > optind || o->out || o->videos || o->float32 || o->width))) {
        pupil_refuse(why,
                     o->regression ? "--regression takes a table and --check, and nothing else of the study"
                                   : "%s: one scene at a time",
                     argv[argc - 1]);
        return STUDY_USAGE;
    }
    if (o->videos && !o->out) {
        pupil_refuse(why, "--video: needs --out, the folder that it is put in");
        return STUDY_USAGE;
    }
    o->scene = optind < argc ? argv[optind] : "room";
    return STUDY_RUN;
}
