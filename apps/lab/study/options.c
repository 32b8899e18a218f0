#include "options.h"

#include <string.h>

#include "options/commands.h"
#include "refuse.h"

#define LOOK_SIDE 150 /* of the pictures of `study look`, which are means over pixels */

static int parse_video(const option_value *v)
{
    study_options *o = v->options;
    unsigned which_case = 0;
    unsigned formula = 0;
    int used = 0;
    const int all = strcmp(v->text, "all") == 0;
    if (!all && (sscanf(v->text, "%1u,%1u%n", &which_case, &formula, &used) != 2 || v->text[used] ||
                 which_case - 1 > 3 || formula - 1 > 3))
        return option_refuse(v, NULL);
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
    return OPTIONS_RUN;
}

#define AT(field) offsetof(study_options, field)

static const option_row rows[] = {
    {"out", 'o', OPTION_PATH, "DIR", AT(out), .right = "a folder",
     .help = "study.csv, study.md, study.html and a plot of each case into DIR",
     .more = "Each is complete or absent. Needs gnuplot."},
    {"video", 0, OPTION_TEXT, "C,F", 0, .parse = parse_video, .right = "a case and a formula, 1,1 to 4,4, or all",
     .help = "also a video of case C and formula F, weights side by side; or all",
     .more = "DIR/case1-formula1.mp4 and so on, 1000x800, the twenty weights in the tables' order. Repeatable."},
    OPTION_ROW_OVERWRITE(study_options, overwrite),
    {"check", 0, OPTION_FLAG, NULL, AT(check),
     .help = "exit 1 unless all of A1..A11 hold, or the counts of --regression"},
    {"float32", 0, OPTION_FLAG, NULL, AT(float32), .help = "the recursions in binary32, as in the original study",
     .more = "A3 and A5 are then violated."},
    {"regression", 0, OPTION_PATH, "CSV", AT(regression),
     .help = "the table of the original study, from numbers alone; no scene",
     .more = "Compares a table (formula,case,weight,threshold,frame) with what binary32 gives from its two "
             "log-averages. With --check, exit 1 below 1257 exact cells of 1277, 1275 within one frame, 1277 within "
             "two."},
    {"size", 0, OPTION_SIZE, "WxH", AT(width), .high = 4096, .help = "of the pictures (600x600; of look 150x150)",
     .more = "The first threshold is the number of their pixels."},
    {"eye", 0, OPTION_NUMBER, "CD_M2", AT(eye_cd_m2), .low = 1e-6, .high = 1e9,
     .right = "cd/m2 of a luminance of 1, from 1e-6 to 1e9", .help = "of look: the luminance of 1, for the eye (1)"},
    OPTION_ROW_THREADS(study_options, threads, "0"),
    OPTION_ROW_QUIET(study_options, quiet),
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command study_command = {
    .name = "study",
    .summary = "reproduces the study of adaptation: tables, videos, checks",
    .usage = "[SCENE] [options]\nlook [SCENE] [--size WxH] [--eye CD_M2]\n--regression CSV [--check]",
    .about = "After how many frames does the picture no longer change? Four changes of light,\n"
             "four formulas, twenty weights. Tables and plots go to --out; without it only\n"
             "the acceptance tests are printed.\n"
             "  SCENE  a recipe of the scene renderer by name or path (room), or spheres: no rendering\n"
             "  look   instead, how the picture looks meanwhile: the formulas, the default law, the eye",
    .exits = "0 done, 1 failed or not met, 2 usage, 130 interrupted",
    .manual =
        "Repeats the study of temporal tone mapping that pupil grew from. A lamp of 512 next to a lamp of 1 is "
        "switched on, switched off, flashes on, flashes off. There are four formulas and twenty weights: after "
        "how many frames does the picture no longer change? docs/study.md describes the results. The darkest and "
        "the brightest frame of SCENE "
        "are the two states of light; spheres needs no rendering. The acceptance tests A1 to A11, with the "
        "number of violations of each, go to standard output.\n\n"
        "study look prints, for the four formulas at a weight of 0.05, the default law and the eye's: how far the "
        "level is off over ten minutes, and of the first ten seconds the colour of objects (the distance from "
        "the picture that has arrived, in a and b of Oklab, 100 times) and the contrast between frames (the "
        "spread of lightness, as a share of that picture's).",
    .groups = groups,
};

/* Removes the word `look` from the operands. */
static int take_look(study_options *o, option_words *words, pupil_why *why)
{
    o->look = words->count && strcmp(words->word[0], "look") == 0;
    if (!o->look)
        return options_given(&study_command, words, "eye")
                   ? pupil_refuse(why, "--eye: works only with pupil study look")
                   : 0;
    words->word++;
    words->count--;
    if (!o->width)
        o->width = o->height = LOOK_SIDE;
    if (o->regression || o->out || o->videos || o->float32 || o->check)
        return pupil_refuse(why, "look: takes a scene, --size, --eye, --threads and --quiet");
    return 0;
}

int study_options_parse(study_options *o, int argc, char **argv, pupil_why *why)
{
    option_words words;
    *o = (study_options){.eye_cd_m2 = 1.0};
    const int parsed = options_parse(&study_command, o, argc, argv, &words, why);
    if (parsed)
        return parsed;
    if (o->regression && (words.count || o->out || o->videos || o->float32 || o->width))
        return pupil_refuse(why, "--regression: takes a table and --check, and nothing else of the study");
    if (take_look(o, &words, why))
        return OPTIONS_USAGE;
    if (words.count > 1)
        return pupil_refuse(why, "%s: one scene at a time", words.word[1]);
    if (o->videos && !o->out)
        return pupil_refuse(why, "--video: needs --out, the folder that it is put in");
    o->scene = words.count ? words.word[0] : "room";
    return OPTIONS_RUN;
}
