#include "split_options.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "options/commands.h"
#include "refuse.h"

#define AT(field) offsetof(split_options, field)

/* "A..B", "A.." and "..B". */
static int parse_range(const option_value *v)
{
    split_options *o = v->options;
    const char *dots = strstr(v->text, "..");
    char *end = NULL;
    o->first = 0;
    o->end = UINT64_MAX;
    if (!dots || strspn(v->text, "0123456789.") != strlen(v->text) || strlen(v->text) > 30)
        return option_refuse(v, NULL);
    if (dots != v->text) {
        o->first = strtoull(v->text, &end, 10);
        if (end != dots)
            return option_refuse(v, NULL);
    }
    if (dots[2]) {
        o->end = strtoull(dots + 2, &end, 10);
        if (*end)
            return option_refuse(v, NULL);
    }
    return o->first < o->end ? OPTIONS_RUN : option_refuse(v, NULL);
}

static const char range_right[] = "A..B, frames from A on and before B, with A below B; A.. and ..B leave one end open";

static const option_row range_row[] = {
    {"range", 0, OPTION_TEXT, "A..B", 0, .right = range_right, .parse = parse_range,
     .help = "frames A to B - 1, from 0 (all)",
     .more = "A.. is up to the end, ..B from 0. The ranges of all parts must cover the input without a gap."},
};

static const option_row part_out_row[] = {
    {"out", 'o', OPTION_PATH, "PART", AT(out), .help = "the statistics of these frames"},
};

static const option_row curves_out_rows[] = {
    {"out", 'o', OPTION_PATH, "CURVES", AT(out), .help = "a curve for each frame"},
    {"stats", 0, OPTION_PATH, "FILE", AT(frames.stats), .help = "figures of each frame: .jsonl .json .csv (- is JSONL)",
     .more = "As pupil replay has it, without the figures of the picture, which is not made here."},
};

static const option_row curves_row[] = {
    {"curves", 0, OPTION_PATH, "CURVES", AT(curves), .help = "the file that pupil adapt made for this input"},
};

static const option_row threads_row[] = {
    {"threads", 0, OPTION_COUNT32, "N", AT(frames.threads), .initial = "0", .high = 256,
     .help = "worker threads, 0: one a processor", .more = "1 where several run side by side."},
};

static const option_row other_rows[] = {
    {"overwrite", 'y', OPTION_FLAG, NULL, AT(frames.overwrite), .help = "replace outputs that are there"},
    OPTION_ROW_QUIET(split_options, frames.quiet),
};

static const option_row input_rows[] = {
    {"fps", 0, OPTION_NUMBER, "N", AT(frames.source.fps), .low = 0.001, .high = 1e5, .unit = "frames a second",
     .help = "of stills, raw, pan and synth (30)", .more = "The same for pupil meter and pupil map."},
    {"size", 0, OPTION_SIZE, "WxH", AT(frames.source.width), .high = PUPIL_MAX_SIDE_PX, .help = "of pan and synth"},
    {"max-pixels", 0, OPTION_COUNT, "N", AT(frames.source.max_pixels), .low = 1, .high = 0x1p26,
     .unit = "a number of pixels", .help = "largest frame", .more = "As of pupil replay."},
};

static const option_group meter_groups[] = {
    {"the part", OPTION_ROWS(part_out_row)},
    {NULL, OPTION_ROWS(range_row)},
    {NULL, OPTION_ROWS(other_rows)},
    {"frames", OPTION_ROWS(input_rows)},
    {"exposure", OPTION_ROWS(frame_exposure_rows), .base = AT(frames), .brief = "replay"},
    {"mapping", OPTION_ROWS(frame_mapping_rows), .base = AT(frames), .brief = "replay"},
    {0},
};

static const option_group adapt_groups[] = {
    {"outputs (complete or absent)", OPTION_ROWS(curves_out_rows)},
    {NULL, OPTION_ROWS(other_rows)},
    {"exposure", OPTION_ROWS(frame_exposure_rows), .base = AT(frames), .brief = "replay"},
    {"mapping", OPTION_ROWS(frame_mapping_rows), .base = AT(frames), .brief = "replay"},
    {0},
};

static const option_group map_groups[] = {
    {"outputs (complete or absent)", frame_output_rows, 1, .base = AT(frames)}, /* only -o: adapt has the levels */
    {NULL, OPTION_ROWS(other_rows)},
    {"frames", OPTION_ROWS(curves_row)},
    {NULL, OPTION_ROWS(range_row)},
    {NULL, OPTION_ROWS(input_rows)},
    {NULL, OPTION_ROWS(threads_row)},
    {0},
};

#define SPLIT_MANUAL                                                                                                   \
    "pupil meter, pupil adapt and pupil map are pupil replay in three steps, for several processes or machines: any "  \
    "number of pupil meter, each with its --range; one pupil adapt, in which time passes; any number of pupil map. "   \
    "The pictures and levels are those of one pupil replay, bit for bit, however the input was split. "                \
    "docs/machines.md has examples for GNU parallel, Slurm and Snakemake."

const option_command meter_command = {
    .name = "meter",
    .summary = "the statistics of some frames, for pupil adapt",
    .usage = "INPUT... --range A..B -o PART [options]",
    .about = "Meters frames A to B - 1 of an input. pupil adapt joins the parts.\n"
             "  INPUT  as of pupil replay, but no camera and not standard input",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual = SPLIT_MANUAL "\n\nA range beyond the end of the input makes a part without frames.",
    .groups = meter_groups,
};

const option_command adapt_command = {
    .name = "adapt",
    .summary = "a curve for each frame, from the parts of pupil meter",
    .usage = "PART... -o CURVES [options]",
    .about = "Joins the parts of an input, in any order, and adapts from its first frame to its last.\n"
             "Settings are those that pupil meter was given; options replace them.",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual = SPLIT_MANUAL
    "\n\nA part that is missing, there twice, or of another input is named. Metering cannot be "
    "changed here: --metering, --roi, --floor, --accuracy, --histogram-step and --output-primaries are pupil meter's.",
    .groups = adapt_groups,
};

const option_command map_command = {
    .name = "map",
    .summary = "some frames of an input, by the curves of pupil adapt",
    .usage = "INPUT... --curves CURVES --range A..B -o OUT [options]",
    .about = "Maps frames A to B - 1 of an input by the curves that pupil adapt has made of it.\n"
             "  INPUT  the same as for pupil meter",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual = SPLIT_MANUAL,
    .groups = map_groups,
};

/* Parses the options of the commands that read the input. */
static int parse_input(split_options *o, const option_command *command, int argc, char **argv, option_words *words,
                       pupil_why *why)
{
    struct stat is;
    *o = (split_options){.end = UINT64_MAX};
    frame_options_begin(&o->frames);
    const int parsed = options_parse(command, o, argc, argv, words, why);
    if (parsed)
        return parsed;
    o->frames.inputs = (const char *const *)words->word;
    o->frames.input_count = (size_t)words->count;
    if (!words->count)
        return pupil_refuse(why, "no input: name what pupil replay takes");
    for (int i = 0; i < words->count; i++)
        if (strcmp(words->word[i], "-") == 0)
            return pupil_refuse(why, "-: standard input cannot be read in parts; name a file");
        else if (stat(words->word[i], &is) == 0 && S_ISFIFO(is.st_mode))
            return pupil_refuse(why, "%s: a pipe cannot be read in parts; name a file", words->word[i]);
    return OPTIONS_RUN;
}

int meter_options_parse(split_options *o, int argc, char **argv, pupil_why *why)
{
    option_words words;
    const int parsed = parse_input(o, &meter_command, argc, argv, &words, why);
    if (parsed)
        return parsed;
    if (!o->out)
        return pupil_refuse(why, "no output: -o PART names the file for the statistics");
    if (o->frames.config.meter_rows > 1)
        return pupil_refuse(why, "--meter-rows: chooses rows by the frames before, which a part does not have");
    if (o->frames.gles)
        return pupil_refuse(why, "--gles: parts are metered by the CPU, whose bits are the same everywhere");
    return frame_options_check(&o->frames, options_given(&meter_command, &words, "weight"),
                               options_given(&meter_command, &words, "key"), why);
}

int adapt_options_parse(split_options *o, int argc, char **argv, const pupil_config *config, pupil_why *why)
{
    option_words words;
    *o = (split_options){0};
    frame_options_begin(&o->frames);
    if (config)
        o->frames.config = *config;
    const int parsed = options_parse(&adapt_command, o, argc, argv, &words, why);
    if (parsed)
        return parsed;
    o->words = (const char *const *)words.word;
    o->word_count = (size_t)words.count;
    if (!words.count)
        return pupil_refuse(why, "no parts: name the files that pupil meter has made");
    if (!o->out && !o->frames.stats)
        return pupil_refuse(why, "no output: -o CURVES, or --stats FILE for the levels alone");
    if (o->frames.gles)
        return pupil_refuse(why, "--gles: there are no pixels here");
    const int weight = options_given(&adapt_command, &words, "weight");
    const pupil_config wanted = o->frames.config;
    if (config && frame_options_check(&o->frames, weight, options_given(&adapt_command, &words, "key"), why))
        return OPTIONS_USAGE;
    o->frames.config.dither = wanted.dither;
    return OPTIONS_RUN;
}

int map_options_parse(split_options *o, int argc, char **argv, pupil_why *why)
{
    option_words words;
    const int parsed = parse_input(o, &map_command, argc, argv, &words, why);
    if (parsed)
        return parsed;
    if (!o->curves)
        return pupil_refuse(why, "no curves: --curves CURVES names the file that pupil adapt has made");
    if (!o->frames.out_count)
        return pupil_refuse(why, "no output: -o PART.mkv names a video");
    return OPTIONS_RUN;
}

int split_options_check_paths(const split_options *o, pupil_why *why)
{
    frame_options paths = o->frames;
    int failed = o->curves ? frame_options_check_paths(&paths, why) : OPTIONS_RUN;
    if (o->out && strcmp(o->out, "-") == 0)
        return pupil_refuse(why, "-o -: a part and curves are files, not standard output; name one");
    paths.overwrite = 1; /* existing files are checked when they are written */
    if (o->out)
        paths.out[paths.out_count++] = o->out;
    if (o->words) {
        paths.inputs = o->words;
        paths.input_count = o->word_count;
    } else if (o->curves) {
        paths.inputs = &o->curves;
        paths.input_count = 1;
    }
    return failed ? failed : frame_options_check_paths(&paths, why);
}
