#include "options.h"

#include <string.h>
#include <sys/stat.h>

#include "options/commands.h"
#include "refuse.h"

#define AT(field) offsetof(record_options, field)

static const option_row exposure_rows[] = {
    {"auto", 0, OPTION_FLAG, NULL, AT(automatic), .help = "control what is not set manually",
     .more = "Without --auto, --shutter and --gain no control of the camera is touched, and the lines have 0 for what "
             "is unknown. What was changed gets its old value at the end."},
};

static const option_row other_rows[] = {
    {"overwrite", 'y', OPTION_FLAG, NULL, AT(run.shown.overwrite), .help = "replace a recording that is there",
     .more = "A folder with anything else in it is refused."},
    OPTION_ROW_QUIET(record_options, run.shown.quiet),
};

static const option_group groups[] = {
    {"camera", OPTION_ROWS(run_device_rows), .base = AT(run)},
    {NULL, OPTION_ROWS(run_request_rows), .base = AT(run)},
    {"exposure (without these no control of the camera is touched)", OPTION_ROWS(run_manual_rows), .base = AT(run)},
    {NULL, OPTION_ROWS(exposure_rows)},
    {"recording", OPTION_ROWS(run_end_rows), .base = AT(run)},
    {NULL, OPTION_ROWS(other_rows)},
    {0},
};

const option_command record_command = {
    .name = "record",
    .summary = "a camera's raw frames, lossless, as they come",
    .usage = "[-d CAMERA] [options] DIR\nINPUT... [options] DIR",
    .about = "Records a camera's raw frames into a folder that pupil replay, ffmpeg and mpv open:\n"
             "lossless, with each frame's number, time, exposure and gain. Ctrl-C ends it.\n"
             "  INPUT  what pupil replay takes, instead of a camera",
    .exits = "0 done (by Ctrl-C too), 1 failed, 2 usage, 3 done but frames were lost",
    .manual =
        "Records a camera's raw frames, lossless, into DIR: frames.mkv (raw video in Matroska, or the camera's own "
        "JPEGs), a line for each frame in frames.jsonl, and recording.json. After a crash every frame with a "
        "line is whole. Ctrl-C and SIGTERM end it properly. An INPUT instead of a camera is recorded as pupil "
        "replay would read it. docs/recording.md has the format, and what else opens it.\n\n"
        "--timeout counts the frames' own time. --shutter and --gain act a few frames later; each line has the "
        "values its frame was taken with.\n\n"
        "The status line shows frames and megabytes a second, and frames that were lost because the disk was too "
        "slow. With some lost the exit status is 3.",
    .groups = groups,
};

int record_options_parse(record_options *o, int argc, char **argv, pupil_why *why)
{
    option_words words;
    struct stat is;
    *o = (record_options){0};
    frame_options_begin(&o->run.shown);
    const int parsed = options_parse(&record_command, o, argc, argv, &words, why);
    if (parsed)
        return parsed;
    if (!words.count)
        return pupil_refuse(why, "no folder to record into; 'pupil record --help' has more");
    if (!strcmp(words.word[words.count - 1], "-"))
        return pupil_refuse(why, "-: a recording is a folder, which a pipe cannot carry; name a folder");
    if (words.count == 1 && stat(words.word[0], &is) == 0 && S_ISREG(is.st_mode))
        return pupil_refuse(why, "%s: is a file; to record it, name a folder behind it", words.word[0]);
    if (o->run.device && words.count > 1)
        return pupil_refuse(why, "%s: -d names a camera already, and one folder is recorded into", words.word[0]);
    if (words.count > 1 && (o->run.live.capture.fourcc || o->automatic || o->run.exposure_s > 0.0 || o->run.gain > 0.0))
        return pupil_refuse(why,
                            "--format, --shutter, --gain, --auto: are a camera's; %s is taken as it is (-d names "
                            "a camera)",
                            words.word[0]);
    o->run.mode = o->automatic ? RUN_SENSOR : RUN_DIGITAL;
    o->run.shown.inputs = (const char *const *)words.word;
    o->run.shown.input_count = (size_t)words.count - 1;
    o->folder = words.word[words.count - 1];
    frame_options paths = o->run.shown;
    paths.record = o->folder;
    return frame_options_check_paths(&paths, why);
}
