/* pupil probe: what a camera is, and what it really does. */
#include "probe.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands.h"
#include "common/interrupt.h"
#include "common/report_error.h"
#include "list/list.h"
#include "refuse.h"
#include "run/choose.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_STOPPED = 130 };

#define SECONDS       14.0 /* of the stream; the first frame has its own time */
#define QUICK_SECONDS 8.0

static const char help[] = "usage: pupil probe [-d CAMERA] [options]\n"
                           "What a camera offers, and, measured in its picture, what it does: how its memory\n"
                           "is read, after how many frames exposure and gain act and whether the picture\n"
                           "follows them as it should, black, frame interval, latency. For some seconds its\n"
                           "controls are taken; then each is put back to what it was. Point it at something\n"
                           "of medium light that stands still.\n"
                           "  -d, --device CAMERA  a path, a number or a name; the first that is there\n"
                           "      --json           the same as JSON\n"
                           "      --quick          fewer steps: half the time\n"
                           "  -q, --quiet          no line that says what is being measured\n"
                           "  -h, --help\n"
                           "exit: 0 done, with what could not be measured said so; 1 failed, 2 usage,\n"
                           "130 stopped (the controls are put back)\n";

typedef struct probe_run {
    const char *device;
    int json, quiet, line_open;
    probe_options options;
} probe_run;

static probe_run run;
static pupil_source *live; /* fatal signals must find its camera */

static void restore(void)
{
    if (live)
        pupil_live_restore(live);
}

static void note_source(pupil_source *source)
{
    live = source;
}

static void clear_line(void)
{
    if (run.line_open)
        fputs("\r\033[K", stderr);
    run.line_open = 0;
}

static void say_now(const char *what)
{
    if (run.quiet || !isatty(STDERR_FILENO))
        return;
    fprintf(stderr, "\r\033[Kmeasuring: %s", what);
    run.line_open = 1;
}

static void complain(pupil_why *why)
{
    clear_line();
    report_error("pupil probe", why, "");
}

/* 0: go on; else the exit status and one more. */
static int parse(int argc, char **argv)
{
    static const struct option options[] = {{"device", required_argument, NULL, 'd'}, {"json", no_argument, NULL, 'j'},
                                            {"quick", no_argument, NULL, 'Q'},        {"quiet", no_argument, NULL, 'q'},
                                            {"help", no_argument, NULL, 'h'},         {0}};
    int option;
    opterr = 0;
    optind = 0; /* all over again: tests come here more than once */
    run = (probe_run){0};
    while ((option = getopt_long(argc, argv, ":d:qh", options, NULL)) != -1) {
        if (option == 'h') {
            fputs(help, stdout);
            return 1 + EXIT_DONE;
        }
        if (option == '?' || option == ':') {
            fprintf(stderr, "pupil probe: %s: %s; 'pupil probe --help' lists them\n", argv[optind - 1],
                    option == ':' ? "its value is missing" : "no such option");
            return 1 + EXIT_USAGE;
        }
        run.device = option == 'd' ? optarg : run.device;
        run.json |= option == 'j';
        run.options.quick |= option == 'Q';
        run.quiet |= option == 'q';
    }
    if (optind < argc) {
        fprintf(stderr, "pupil probe: %s: it takes no argument; the camera is named by -d\n", argv[optind]);
        return 1 + EXIT_USAGE;
    }
    if (run.json && list_json_refusal()) {
        fprintf(stderr, "pupil probe: --json: %s\n", list_json_refusal());
        return 1 + EXIT_FAILED;
    }
    return 0;
}

static int print(const probe_report *report, pupil_why *why)
{
    char *json = run.json ? probe_json(report) : NULL;
    clear_line();
    if (run.json && !json) {
        pupil_refuse(why, "not enough memory");
        return -1;
    }
    if (run.json)
        printf("%s\n", json);
    else
        probe_text(report, stdout);
    free(json);
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    pupil_refuse(why, "standard output cannot be written");
    return -1;
}

static int probe(probe_report *report, const pupil_v4l2_system *system)
{
    char device[256];
    pupil_why why;
    int result = -1;
    if (run_choose_camera(system, run.device, device, sizeof device, &why) == 0 &&
        probe_offers(report, system, device, &why) == 0) {
        interrupt_fatal(restore);
        result = probe_measure(report, system, &run.options, &why);
        interrupt_fatal(NULL);
    }
    if (result == 1) {
        clear_line();
        fputs("pupil probe: stopped; the camera's controls are as they were\n", stderr);
        return EXIT_STOPPED;
    }
    if (result == 0)
        result = print(report, &why);
    if (result)
        complain(&why);
    return result ? EXIT_FAILED : EXIT_DONE;
}

int probe_on(const pupil_v4l2_system *system, int argc, char **argv)
{
    const int parsed = parse(argc, argv);
    if (parsed)
        return parsed - 1;
    run.options.seconds = run.options.quick ? QUICK_SECONDS : SECONDS;
    run.options.say = say_now;
    run.options.source = note_source;
    run.options.stop = interrupt_came;
    interrupt_watch();
    probe_report *report = calloc(1, sizeof *report);
    if (!report) {
        fputs("pupil probe: not enough memory\n", stderr);
        return EXIT_FAILED;
    }
    const int status = probe(report, system);
    probe_free(report);
    free(report);
    return status;
}

int probe_main(int argc, char **argv)
{
    return probe_on(NULL, argc, argv);
}
