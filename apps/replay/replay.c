/* pupil replay: recorded frames through meter -> adapt -> map, and everything that a user wants to see of it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "common/interrupt.h"
#include "common/open_input.h"
#include "common/progress.h"
#include "common/report_error.h"
#include "frame/replay_work.h"
#include "options.h"
#include "output/frame_log_fill.h"
#include "output/outputs.h"
#include "output/plot.h"
#include "output/stats_file.h"
#include "refuse.h"
#include "report/replay_report.h"
#include "view/view.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_SKIPPED = 3, EXIT_INTERRUPTED = 130 };

typedef struct replay {
    frame_options options;
    pupil_source *source;
    replay_work work;
    pupil_t pupil;
    pupil_stats stats;
    pupil_curve curve;

    view *view;      /* NULL: no window (yet) */
    int quit;        /* the window was closed */
    int64_t last_ns; /* the last frame's moment */
    int64_t loop_ns; /* how much later than its file says this pass of --loop is */

    outputs outputs;
    pupil_stats_file *stats_file;
    replay_report *report;
    frame_log log; /* where a plot or a report wants it */

    progress progress;
    uint64_t shown, skipped;
    size_t finished;   /* outputs that are in their places */
    char gpu[640];     /* who did the frames */
    char summary[512]; /* the figures that a report found */
    pupil_why why;
} replay;

static void say(replay *r, const char *end)
{
    report_error("pupil replay", &r->why, end);
}

static int no_memory(replay *r)
{
    pupil_refuse(&r->why, "not enough memory");
    return -1;
}

/* --- a frame --- */

static int open_outputs(replay *r, const pupil_image_const *first)
{
    const frame_options *o = &r->options;
    pupil_sink_options options = {
        .width = first->width, .height = first->height, .fps = r->source->fps, .overwrite = o->overwrite};
    for (size_t i = 0; i < o->out_count; i++)
        if (outputs_open(&r->outputs, o->out[i], &options, &r->why))
            return -1;
    if (o->stats && pupil_stats_file_open(&r->stats_file, o->stats, &r->why))
        return -1;
    if ((o->plot || o->report) && frame_log_open(&r->log, 0))
        return no_memory(r);
    if (o->report)
        return replay_report_open(&r->report, o, &options, r->source->frames * o->hold, &r->why);
    return 0;
}

static int write_frame(replay *r, const pupil_frame *frame, const pupil_image_const *display, frame_log_entry *record)
{
    double began_s = progress_now_s();
    if (outputs_write(&r->outputs, display, &frame->info, &r->why))
        return -1;
    record->write_us = (progress_now_s() - began_s) * 1e6;
    if (r->stats_file && pupil_stats_file_write(r->stats_file, record, &r->why))
        return -1;
    if (frame_log_add(&r->log, record))
        return no_memory(r);
    return r->report ? replay_report_frame(r->report, frame, &r->curve, display, &r->stats, record, &r->why) : 0;
}

/* The window comes with the first frame, and where it is there the GPU is its own. */
static int open_view(replay *r, const pupil_frame *first)
{
    const frame_options *o = &r->options;
    const view_of of = {.options = &r->options, .pupil = &r->pupil, .work = &r->work, .fps = r->source->fps};
    if (!o->view || r->shown)
        return 0;
    return view_open(&r->view, &of, &first->image, &r->why);
}

/* For the user, without an end of the run. */
static void warn(replay *r)
{
    if (!*r->work.warning.text)
        return;
    progress_clear(&r->progress);
    r->why = r->work.warning;
    say(r, "; the CPU continues");
    *r->work.warning.text = 0;
}

/* Frames are written in all their pixels; what is only viewed is measured in a smaller picture. */
static int is_written(const frame_options *o)
{
    return o->out_count || o->stats || o->plot || o->report;
}

static int show(replay *r, const pupil_frame *frame, double read_us)
{
    pupil_image out;
    if (open_view(r, frame))
        return -1;
    warn(r);
    double began_s = progress_now_s();
    int error = replay_work_frame(&r->work, &r->pupil, frame, !r->view || is_written(&r->options), &r->stats, &r->curve,
                                  &out, &r->why);
    double process_us = (progress_now_s() - began_s) * 1e6;
    if (error)
        return -1;
    warn(r);
    if (!r->shown && open_outputs(r, &frame->image))
        return -1;
    pupil_image_const display = pupil_image_as_const(out);
    frame_log_entry record = frame_log_fill(&r->pupil, &r->options.config, &r->stats, &r->curve, frame, &display);
    record.frame = r->shown;
    record.read_us = read_us;
    record.process_us = process_us;
    if (write_frame(r, frame, &display, &record))
        return -1;
    progress_step(&r->progress, &record);
    r->shown++;
    r->quit = r->view && view_frame(r->view, frame, &r->curve, &display, &record) == VIEW_QUIT;
    warn(r);
    return 0;
}

static int goes_on(const replay *r)
{
    return !interrupt_came() && !r->quit && (!r->options.most || r->shown < r->options.most);
}

/* A frame as often as --hold says, each with its own moment. */
static int take(replay *r, pupil_frame *frame, double read_us)
{
    const frame_options *o = &r->options;
    if (o->reset_each)
        pupil_reset(&r->pupil);
    frame->info.timestamp_ns += r->loop_ns;
    for (uint64_t i = 0; i < o->hold && goes_on(r); i++) {
        if (o->hold > 1)
            frame->info.timestamp_ns = (int64_t)((double)r->shown * 1e9 / r->source->fps);
        r->last_ns = frame->info.timestamp_ns;
        if (show(r, frame, i ? 0.0 : read_us))
            return -1;
    }
    return 0;
}

/* The input is at its end: from its beginning again, its first frame a period after the last one. 1: it is not to be;
 * -1: it cannot. */
static int again(replay *r, uint64_t shown_before)
{
    if (!r->options.loop || r->shown == shown_before)
        return 1;
    r->loop_ns = r->last_ns + (int64_t)(1e9 / r->source->fps);
    pupil_source_close(r->source);
    r->source = NULL;
    return open_input(r->options.inputs, r->options.input_count, &r->options.source, &r->source, &r->why);
}

static int run(replay *r)
{
    const frame_options *o = &r->options;
    uint64_t shown_before = 0;
    while (goes_on(r)) {
        pupil_frame frame;
        double began_s = progress_now_s();
        int got = pupil_source_next(r->source, &frame, &r->why);
        double read_us = (progress_now_s() - began_s) * 1e6;
        if (interrupt_came())
            return 0;
        if (got == PUPIL_SOURCE_END) {
            int stop = again(r, shown_before);
            if (stop)
                return stop < 0 ? -1 : 0;
            shown_before = r->shown;
            continue;
        }
        if (got == PUPIL_SOURCE_DAMAGED && o->keep_going) {
            progress_clear(&r->progress);
            say(r, "; skipped");
            r->skipped++;
            continue;
        }
        if (got != PUPIL_SOURCE_FRAME)
            return -1;
        int error = take(r, &frame, read_us);
        pupil_source_done(r->source, &frame);
        if (error)
            return -1;
    }
    return 0;
}

/* --- begin and end --- */

static int begin(replay *r)
{
    const char *fault = "";
    if (pupil_config_check(&r->options.config, &fault)) {
        pupil_refuse(&r->why, "settings: %s", fault);
        return -1;
    }
    if (r->options.plot && pupil_plot_check(r->options.plot, &r->why))
        return -1;
    r->options.source.stop = interrupt_came;
    if (open_input(r->options.inputs, r->options.input_count, &r->options.source, &r->source, &r->why))
        return -1;
    pupil_init(&r->pupil, &r->options.config);
    if (replay_work_open(&r->work, &r->options))
        return no_memory(r);
    if (r->options.gles && !r->options.view)
        replay_work_gles(&r->work, NULL);
    uint64_t total = r->source->frames * r->options.hold;
    if (r->options.most && (!total || total > r->options.most))
        total = r->options.most;
    progress_begin(&r->progress, r->options.quiet, r->options.loop ? 0 : total);
    return 0;
}

/* What is most likely to fail goes first: then nothing is in its place yet. Ctrl-C leaves out what is to come. */
static int finish(replay *r)
{
    const frame_options *o = &r->options;
    if (!r->shown) {
        pupil_refuse(&r->why, "%s: no frame could be read", o->inputs[0]);
        return -1;
    }
    if (o->plot) {
        if (pupil_plot_write(o->plot, r->log.entry, r->log.count, o->inputs[0], &r->why))
            return -1;
        r->finished++;
    }
    replay_report *report = r->report;
    if (report && !interrupt_came()) {
        r->report = NULL;
        if (replay_report_finish(report, r->log.entry, r->log.count, r->summary, sizeof r->summary, &r->why))
            return -1;
        r->finished++;
    }
    pupil_stats_file *stats_file = r->stats_file;
    if (stats_file && !interrupt_came()) {
        r->stats_file = NULL;
        if (pupil_stats_file_finish(stats_file, &r->why))
            return -1;
        r->finished++;
    }
    if (interrupt_came())
        return -1;
    size_t count = r->outputs.count;
    int failed = outputs_finish(&r->outputs, &r->why);
    r->finished += count - r->outputs.count;
    return failed;
}

static void end(replay *r)
{
    outputs_discard(&r->outputs);
    if (r->stats_file)
        pupil_stats_file_discard(r->stats_file);
    if (r->report)
        replay_report_discard(r->report);
    replay_work_tell(&r->work, r->gpu, sizeof r->gpu);
    replay_work_close(&r->work); /* before its window, whose context it may use */
    view_close(r->view);
    pupil_source_close(r->source);
    frame_log_close(&r->log);
}

static void tell(const replay *r)
{
    const frame_options *o = &r->options;
    double took_s = progress_now_s() - r->progress.began_s;
    fprintf(stderr, "replayed %llu frames in %.1f s", (unsigned long long)r->shown, took_s);
    if (r->skipped)
        fprintf(stderr, ", skipped %llu", (unsigned long long)r->skipped);
    for (size_t i = 0; i < o->out_count; i++)
        fprintf(stderr, "; %s", o->out[i]);
    if (o->stats)
        fprintf(stderr, "; %s", o->stats);
    if (o->plot)
        fprintf(stderr, "; %s", o->plot);
    if (o->report)
        fprintf(stderr, "; %s/index.html", o->report);
    fprintf(stderr, "%s\n%s", r->gpu, r->summary);
}

int replay_main(int argc, char **argv)
{
    static replay r; /* one run a process; pupil_t and pupil_stats are large for a stack */
    char command[4096];
    replay_report_command(command, sizeof command, argc, argv); /* before parsing moves argv about */
    int parsed = replay_options_parse(&r.options, argc, argv, &r.why);
    r.options.command = command;
    if (parsed == OPTIONS_HELP)
        return EXIT_DONE;
    if (parsed == OPTIONS_USAGE || frame_options_check_paths(&r.options, &r.why)) {
        say(&r, "");
        return EXIT_USAGE;
    }
    interrupt_watch();
    int failed = begin(&r) || run(&r);
    progress_clear(&r.progress);
    if (!failed && r.view && !r.quit && !is_written(&r.options) && !r.options.most)
        view_stay(r.view); /* until a key is pressed */
    if (!failed)
        failed = interrupt_came() || finish(&r);
    int interrupted = failed && interrupt_came();
    end(&r);
    if (interrupted)
        fprintf(stderr, "pupil replay: interrupted; %s\n",
                r.finished ? "some outputs were complete already, the others are not there" : "nothing was written");
    else if (failed)
        say(&r, "");
    else if (!r.options.quiet)
        tell(&r);
    return interrupted ? EXIT_INTERRUPTED : failed ? EXIT_FAILED : r.skipped ? EXIT_SKIPPED : EXIT_DONE;
}
