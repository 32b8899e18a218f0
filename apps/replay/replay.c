/* pupil replay: recorded frames through meter -> adapt -> map, and everything that a user wants to see of them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/command_line.h"
#include "common/interrupt.h"
#include "common/open_input.h"
#include "common/report_error.h"
#include "compare.h"
#include "explain.h"
#include "frame/any_scale.h"
#include "options.h"
#include "options/commands.h"
#include "refuse.h"
#include "session/session.h"

typedef struct replay {
    frame_options options;
    session session;
    any_scale scale;
    replay_side side[2]; /* of --compare */
    compare compare;
    int64_t last_ns; /* the last frame's time */
    int64_t loop_ns; /* how much later than the file's times this pass of --loop is */
    uint64_t skipped;
    uint64_t bad_frames;    /* frames with NaN or infinite pixels */
    double bad_share;       /* share of such pixels in the worst frame */
    uint32_t width, height; /* of the first frame */
} replay;

/* --- a frame --- */

static void show_progress(replay *r, const frame_log_entry *e)
{
    progress *p = &r->session.progress;
    if (!progress_due(p, 0.1))
        return;
    progress_add(p, "frame %llu", (unsigned long long)e->frame + 1);
    if (p->total)
        progress_add(p, " of %llu", (unsigned long long)p->total);
    progress_add(p, "   metered %+.2f EV, adapted %+.2f EV, %s", e->metered_ev, e->adapted_ev, e->state);
    if (*e->reason)
        progress_add(p, " (%s)", e->reason);
    progress_add(p, "   %.0f frames/s", (double)(e->frame + 1) / (p->last_s - p->began_s));
    progress_show(p);
}

static int show(replay *r, const pupil_frame *frame, double read_us)
{
    frame_log_entry entry;
    if (session_meter(&r->session, frame) || session_map(&r->session, frame, &entry))
        return -1;
    if (r->options.compare[0]) {
        const char *const label[2] = {r->side[0].label, r->side[1].label};
        if (compare_frame(&r->compare, &r->session.pipeline, frame, label, &r->session.why))
            return -1;
        r->session.shown = &r->compare.picture;
    }
    entry.read_us = read_us;
    r->bad_frames += entry.bad_share > 0.0;
    r->bad_share = fmax(r->bad_share, entry.bad_share);
    entry.scale = ldexp(entry.scale, r->scale.stops); /* of the file's values */
    if (r->options.explains && entry.frame == r->options.explain) {
        progress_clear(&r->session.progress);
        explain_frame(stdout, &entry, &r->session.pipeline.config);
        fflush(stdout);
    }
    if (entry.frame == 0) {
        r->width = frame->image.width;
        r->height = frame->image.height;
    }
    if (session_show(&r->session, frame, &entry)) {
        if (frame->image.width != r->width || frame->image.height != r->height)
            pupil_refuse_add(&r->session.why, "; that frame is %s", frame->name);
        return -1;
    }
    show_progress(r, &entry);
    return 0;
}

static int goes_on(const replay *r)
{
    return !interrupt_came() && session_goes_on(&r->session);
}

/* Takes a frame as often as --hold says, each time with its own timestamp. */
static int take(replay *r, const pupil_frame *read, double read_us)
{
    const frame_options *o = &r->options;
    session *s = &r->session;
    pupil_frame scaled = *read, *frame = &scaled;
    if (o->reset_each) {
        pupil_reset(&s->pipeline.pupil);
        if (o->compare[0])
            pupil_reset(&r->compare.right.pupil);
        any_scale_forget(&r->scale);
    }
    if (any_scale_take(&r->scale, frame, &s->why))
        return -1;
    frame->info.timestamp_ns += r->loop_ns;
    for (uint64_t i = 0; i < o->hold && goes_on(r); i++) {
        if (o->hold > 1)
            frame->info.timestamp_ns = (int64_t)((double)s->frames * 1e9 / s->source->fps);
        r->last_ns = frame->info.timestamp_ns;
        if (show(r, frame, i ? 0.0 : read_us))
            return -1;
    }
    return 0;
}

/* Refuses options that have no effect on this input. */
static int check_obeyed(replay *r)
{
    const pupil_source_options *asked = &r->options.source;
    const uint32_t obeys = r->session.source->obeys;
    const char *input = r->options.inputs[0];
    if (asked->fps > 0.0 && !(obeys & PUPIL_SOURCE_FPS))
        return pupil_refuse(&r->session.why, "--fps: the frames of %s have times of their own (%.6g frames a second)",
                            input, r->session.source->fps);
    if (asked->width && !(obeys & PUPIL_SOURCE_SIZE))
        return pupil_refuse(&r->session.why,
                            "--size: the frames of %s have a size of their own; docs/guide.md scales them by ffmpeg",
                            input);
    if (asked->seed && !(obeys & PUPIL_SOURCE_SEED))
        return pupil_refuse(&r->session.why, "--seed: sets the path of pan:PANORAMA; %s has none", input);
    return 0;
}

static int open_source(replay *r)
{
    const frame_options *o = &r->options;
    return open_input(o->inputs, o->input_count, &o->source, &r->session.source, &r->session.why) || check_obeyed(r);
}

/* By --ss and --duration: -1: before, 0: within, 1: after. */
static int place_in_time(const replay *r, const pupil_frame *frame)
{
    const frame_options *o = &r->options;
    const double at_s = (double)frame->info.timestamp_ns * 1e-9;
    /* A tolerance of half a period: -ss 2 also takes the frame at 1.9999 s. */
    const double grace_s = 0.5 / r->session.source->fps;
    if (at_s < o->start_s - grace_s)
        return -1;
    return o->duration_s > 0.0 && at_s >= o->start_s + o->duration_s - grace_s;
}

/* At the end of the input: starts again from its beginning, with the first frame a period after the last one. 1: not to
 * be repeated; -1: impossible. */
static int again(replay *r, uint64_t shown_before)
{
    session *s = &r->session;
    if (!r->options.loop || s->frames == shown_before)
        return 1;
    r->loop_ns = r->last_ns + (int64_t)(1e9 / s->source->fps);
    pupil_source_close(s->source);
    s->source = NULL;
    return open_source(r);
}

static int run(replay *r)
{
    session *s = &r->session;
    uint64_t shown_before = 0;
    while (goes_on(r)) {
        pupil_frame frame;
        const double began_s = progress_now_s();
        const int got = pupil_source_next(s->source, &frame, &s->why);
        const double read_us = (progress_now_s() - began_s) * 1e6;
        if (interrupt_came())
            return 0;
        if (got == PUPIL_SOURCE_END) {
            const int stop = again(r, shown_before);
            if (stop)
                return stop < 0 ? -1 : 0;
            shown_before = s->frames;
            continue;
        }
        if (got == PUPIL_SOURCE_DAMAGED && r->options.keep_going) {
            session_say(s, &s->why, "; skipped");
            r->skipped++;
            continue;
        }
        if (got == PUPIL_SOURCE_DAMAGED)
            pupil_refuse_add(&s->why, "; --keep-going skips such frames");
        if (got != PUPIL_SOURCE_FRAME)
            return -1;
        report_notice(&s->progress, s->command, r->loop_ns ? NULL : frame.notice);
        const int place = place_in_time(r, &frame), failed = place == 0 && take(r, &frame, read_us);
        pupil_source_done(s->source, &frame);
        if (failed)
            return -1;
        if (place > 0) {
            if (!r->options.loop)
                return 0;
            const int stop = again(r, shown_before);
            if (stop)
                return stop < 0 ? -1 : 0;
            shown_before = s->frames;
        }
    }
    return 0;
}

/* --- begin and end --- */

/* The left setting is the run's own. */
static int begin_compare(replay *r)
{
    frame_options *o = &r->options;
    session *s = &r->session;
    for (int i = 0; i < 2 && o->compare[0]; i++)
        if (replay_options_side(o, i, &r->side[i], &s->why))
            return -1;
    if (!o->compare[0])
        return 0;
    o->config = r->side[0].options.config;
    o->veil = r->side[0].options.veil;
    o->eye = r->side[0].options.eye;
    return 0;
}

static int open_compare(replay *r)
{
    const session *s = &r->session;
    if (!r->options.compare[0])
        return 0;
    const char *fault = "";
    if (pupil_config_check(&r->side[1].options.config, &fault))
        return pupil_refuse(&r->session.why, "--compare \"%s\": %s", r->options.compare[1], fault);
    return compare_open(&r->compare, &r->side[1].options, s->source->primaries)
               ? pupil_refuse(&r->session.why, "not enough memory")
               : 0;
}

static int begin(replay *r)
{
    frame_options *o = &r->options;
    session *s = &r->session;
    o->source.stop = interrupt_came;
    if (begin_compare(r) || session_check(s) || open_source(r) || session_begin(s, 0) || open_compare(r))
        return -1;
    uint64_t total = s->source->frames * o->hold;
    if (o->most && (!total || total > o->most))
        total = o->most;
    progress_begin(&s->progress, o->quiet, o->loop || o->start_s > 0.0 || o->duration_s > 0.0 ? 0 : total);
    return 0;
}

static int finish(replay *r)
{
    session *s = &r->session;
    if (!s->frames && (r->options.start_s > 0.0 || r->options.duration_s > 0.0) && !*s->why.text)
        return pupil_refuse(&s->why, "%s: has no frame in the time that -ss and -t choose", r->options.inputs[0]);
    if (!s->frames)
        return pupil_refuse(&s->why, "%s: no frame could be read", r->options.inputs[0]);
    if (r->options.explains && r->options.explain >= s->frames)
        return pupil_refuse(&s->why, "--explain %llu: %s has %llu frames, which count from 0",
                            (unsigned long long)r->options.explain, r->options.inputs[0],
                            (unsigned long long)s->frames);
    return session_outputs_finish(&s->outputs, &s->why);
}

/* After Ctrl-C: names the outputs that exist. */
static void tell_interrupted(const replay *r)
{
    const session *s = &r->session;
    fprintf(stderr, "pupil replay: interrupted; ");
    if (!s->outputs.finished) {
        fprintf(stderr, "no output is complete\n");
        return;
    }
    fprintf(stderr, "%llu ", (unsigned long long)s->outputs.frames);
    if (s->progress.total)
        fprintf(stderr, "of %llu ", (unsigned long long)s->progress.total);
    fprintf(stderr, "frames are written");
    session_outputs_name(&s->outputs);
    fputc('\n', stderr);
}

static void tell(const replay *r, const char *by)
{
    const session *s = &r->session;
    const double took_s = progress_now_s() - s->progress.began_s;
    fprintf(stderr, "replayed %llu frame%s in %.1f s", (unsigned long long)s->frames, s->frames == 1 ? "" : "s",
            took_s);
    if (r->skipped)
        fprintf(stderr, ", skipped %llu", (unsigned long long)r->skipped);
    session_outputs_name(&s->outputs);
    if (!session_outputs_want_pixels(&r->options) && !r->options.view && !r->options.explains)
        fprintf(stderr, "; nothing was written: -o out.mp4 names a video");
    if (r->bad_frames)
        fprintf(stderr, "; %llu frame%s pixels that are NaN (shown black) or infinite, up to %.2g %% of one",
                (unsigned long long)r->bad_frames, r->bad_frames == 1 ? " has" : "s have", 100.0 * r->bad_share);
    fprintf(stderr, "%s\n%s", by, s->outputs.summary);
}

int replay_main(int argc, char **argv)
{
    static replay r; /* one run per process; pupil_t and pupil_stats are too large for a stack */
    session *s = &r.session;
    static char command[4096]; /* r keeps its address */
    char by[800];
    s->command = "pupil replay";
    s->options = &r.options;
    command_line(command, sizeof command, argc, argv); /* before parsing reorders argv */
    const int parsed = replay_options_parse(&r.options, argc, argv, &s->why);
    r.options.command = command;
    if (parsed == OPTIONS_HELP)
        return EXIT_DONE;
    if (parsed == OPTIONS_USAGE || frame_options_check_paths(&r.options, &s->why)) {
        session_say(s, &s->why, "");
        return EXIT_USAGE;
    }
    interrupt_watch();
    int failed = begin(&r) || run(&r);
    progress_clear(&s->progress);
    if (!failed && s->view && !s->ended && !session_outputs_want_pixels(&r.options) && !r.options.most)
        view_stay(s->view); /* until a key is pressed */
    failed = (failed && !interrupt_came()) || finish(&r);
    const int interrupted = interrupt_came();
    session_end(s, by, sizeof by);
    any_scale_describe(&r.scale, by + strlen(by), sizeof by - strlen(by));
    pupil_source_close(s->source);
    any_scale_close(&r.scale);
    compare_close(&r.compare);
    if (interrupted)
        tell_interrupted(&r);
    else if (failed)
        session_say(s, &s->why, "");
    else if (!r.options.quiet)
        tell(&r, by);
    return interrupted ? EXIT_INTERRUPTED : failed ? EXIT_FAILED : r.skipped ? EXIT_INCOMPLETE : EXIT_DONE;
}
