/* pupil probe: what a camera is, and what it really does. */
#include "probe.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/camera.h"
#include "common/interrupt.h"
#include "common/progress.h"
#include "common/report_error.h"
#include "list/list.h"
#include "options/commands.h"
#include "refuse.h"

#define SECONDS       14.0 /* of the stream; the first frame does not count */
#define QUICK_SECONDS 8.0

typedef struct probe_run {
    const char *device;
    int json, quiet;
    progress line;
    probe_options options;
} probe_run;

static probe_run run;

static void say_now(const char *what)
{
    if (!progress_due(&run.line, 0.0))
        return;
    progress_add(&run.line, "measuring: %s", what);
    progress_show(&run.line);
}

static void complain(pupil_why *why)
{
    progress_clear(&run.line);
    report_error("pupil probe", why, "");
}

static const option_row rows[] = {
    {"device", 'd', OPTION_PATH, "CAMERA", offsetof(probe_run, device),
     .right = "a path, a number, a camera's name or libcamera:ID",
     .help = "path, number, name, libcamera:ID (the first: 'pupil list')"},
    OPTION_ROW_JSON(probe_run, json, "the same as JSON, with units in its names"),
    {"quick", 0, OPTION_FLAG, NULL, offsetof(probe_run, options.quick), .help = "fewer steps: at most 8 seconds"},
    {"quiet", 'q', OPTION_FLAG, NULL, offsetof(probe_run, quiet), .help = "no line that shows the progress"},
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command probe_command = {
    .name = "probe",
    .summary = "what a camera offers, and what it really does, measured in its picture",
    .usage = "[-d CAMERA] [options]",
    .about = "Shows what a camera offers, and measures in its picture what it does: how its memory\n"
             "is read, after how many frames exposure and gain act, whether the picture follows them,\n"
             "black level, frame interval, latency. For some seconds it uses the camera's controls;\n"
             "then each gets its old value back. Point the camera at a scene of medium light that\n"
             "does not move.",
    .exits = "0 done, also where something could not be measured; 1 failed, 2 usage,\n"
             "130 stopped (the controls have their old values)",
    .manual =
        "Shows what a camera offers, and measures in its picture what it does: how the CPU reads its memory; after how "
        "many frames exposure and gain act; whether the picture follows exposure (linear, or with a tone curve) and "
        "gain (its law), or only the driver reports it; the black level; the frame interval and its jitter; the "
        "latency "
        "from the driver's timestamp. It streams for at most 14 seconds. Then, and after Ctrl-C, each control gets its "
        "old value back. Point the camera at a scene of medium light that does not move. What cannot be measured is "
        "called undetermined, with the reason.\n\n"
        "A delay is counted from the frame that is being exposed while a control is written to the first that shows "
        "it. Levels are logarithms of linear light: the mean of the pixels without the darkest and the brightest "
        "tenth. "
        "The light of mosaics and of grey is counted from the measured black level.",
    .instead = "name the camera by -d",
    .groups = groups,
};

/* -1: continue; else the exit status. */
static int parse(int argc, char **argv)
{
    option_words words;
    run = (probe_run){0};
    const int parsed = options_read(&probe_command, &run, argc, argv, &words);
    if (parsed < 0 && run.json && list_json_refusal()) {
        fprintf(stderr, "pupil probe: --json: %s\n", list_json_refusal());
        return EXIT_FAILED;
    }
    return parsed;
}

static int print(const probe_report *report, pupil_why *why)
{
    char *json = run.json ? probe_json(report) : NULL;
    progress_clear(&run.line);
    if (run.json && !json)
        return pupil_refuse(why, "not enough memory");
    if (run.json)
        printf("%s\n", json);
    else
        probe_text(report, stdout);
    free(json);
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    return pupil_refuse(why, "standard output cannot be written");
}

static int probe(probe_report *report, const pupil_live_system *system)
{
    char device[272];
    pupil_why why;
    int result = -1;
    if (camera_choose(system, run.device, device, sizeof device, &why) == 0 &&
        pupil_live_offers_read(&report->offers, system, device, &why) == 0) {
        result = probe_measure(report, system, &run.options, &why);
    }
    if (result == 1) {
        progress_clear(&run.line);
        fputs("pupil probe: stopped; the camera's controls are as they were\n", stderr);
        return EXIT_INTERRUPTED;
    }
    if (result == 0)
        result = print(report, &why);
    if (result)
        complain(&why);
    return result ? EXIT_FAILED : EXIT_DONE;
}

int probe_on(const pupil_live_system *system, int argc, char **argv)
{
    const int parsed = parse(argc, argv);
    if (parsed >= 0)
        return parsed;
    run.options.seconds = run.options.quick ? QUICK_SECONDS : SECONDS;
    run.options.say = say_now;
    run.options.source = camera_guard;
    run.options.stop = interrupt_came;
    progress_begin(&run.line, run.quiet, 0);
    interrupt_watch();
    probe_report *report = calloc(1, sizeof *report);
    if (!report) {
        fputs("pupil probe: not enough memory\n", stderr);
        return EXIT_FAILED;
    }
    const int status = probe(report, system);
    pupil_live_modes_free(&report->offers.modes);
    free(report);
    return status;
}

int probe_main(int argc, char **argv)
{
    return probe_on(NULL, argc, argv);
}
