/* pupil run: live frames of a camera through meter -> adapt -> map, with its exposure and gain under control. */
#include "run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "choose.h"
#include "colour.h"
#include "commands.h"
#include "common/interrupt.h"
#include "common/report_error.h"
#include "frame/replay_work.h"
#include "output/frame_log_fill.h"
#include "output/plot.h"
#include "outputs.h"
#include "refuse.h"
#include "resume.h"
#include "row_gains.h"
#include "sensor.h"
#include "status.h"
#include "view/view.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_LOST = 3, EXIT_GIVEN_UP = 130 };

#define LAST_WRITE_S 10.0 /* uvcvideo gives up a control's transfer after 5 */

typedef struct run {
    run_options options;
    const pupil_v4l2_system *system; /* NULL: the kernel */
    char device[256];
    const char *input; /* device: the name of the only input */
    pupil_source *source;
    replay_work work;
    run_sensor sensor;
    run_resume resume;
    run_colour colour;
    run_row_gains lamps;
    pupil_t pupil;
    pupil_stats stats;
    pupil_curve curve;

    view *view;
    run_outputs outputs;
    run_status status;
    pupil_v4l2_counts counts; /* at the last frame */
    uint64_t frames;
    int64_t end_ns;    /* of -t; 0: none */
    int ended, failed; /* ended: as it was asked for; failed: why has a sentence */
    pupil_why why;
} run;

static run r; /* one a process; fatal signals must find its camera */

static void say(pupil_why *why, const char *end)
{
    run_status_clear(&r.status);
    report_error("pupil run", why, end);
}

/* Of several sentences the first one is the cause. */
static int fail(const char *why)
{
    if (!r.failed && why != r.why.text)
        pupil_refuse(&r.why, "%s", why);
    r.failed = 1;
    return -1;
}

static int is_over(void)
{
    return interrupt_came() || (r.end_ns && r.source && pupil_live_now_ns(r.source) >= r.end_ns);
}

/* --- a frame --- */

static void warn(void)
{
    if (!*r.work.warning.text)
        return;
    say(&r.work.warning, "; the CPU continues");
    *r.work.warning.text = 0;
}

static int curve_of_view(void *context, pupil_curve *curve)
{
    return run_sensor_curve(context, curve);
}

/* The window comes with the first frame, and where it is there the GPU is its own. */
static int open_view(const pupil_frame *first, pupil_why *why)
{
    const view_of of = {.options = &r.options.shown,
                        .pupil = &r.pupil,
                        .work = &r.work,
                        .fps = r.source->fps,
                        .live = 1,
                        .curve = curve_of_view,
                        .context = &r.sensor};
    return r.options.shown.view ? view_open(&r.view, &of, &first->image, why) : 0;
}

/* Frames that are written have all their pixels; what is only viewed is measured in a smaller picture. */
static int is_written(void)
{
    const frame_options *o = &r.options.shown;
    return o->out_count || o->stats || o->plot;
}

static void describe_camera(const pupil_frame *frame, frame_log_entry *record)
{
    const pupil_v4l2_counts before = r.counts, *now = &pupil_live_capture(r.source)->counts;
    const pupil_v4l2_frame *f = pupil_live_frame(r.source);
    record->live = 1;
    record->frame = r.frames;
    record->sequence = frame->info.sequence;
    record->lost = now->lost - before.lost;
    record->flagged = now->flagged - before.flagged + now->cut - before.cut;
    record->late = now->late - before.late;
    record->read_us = f->stamp == PUPIL_V4L2_STAMP_NONE ? (double)NAN : (double)(f->taken_ns - f->stamp_ns) * 1e-3;
    r.counts = *now;
    run_sensor_describe(&r.sensor, &frame->info, record);
}

static int show(pupil_frame *frame)
{
    pupil_why why;
    pupil_image out;
    if (!r.frames && open_view(frame, &why))
        return fail(why.text);
    warn();
    if (run_colour_take(&r.colour, &r.options.colour, r.source, frame, &why))
        return fail(why.text);
    const int64_t began_ns = pupil_live_now_ns(r.source);
    frame_work_gain(r.work.cpu, run_row_gains_take(&r.lamps, &r.sensor, frame));
    if (replay_work_frame(&r.work, &r.pupil, frame, !r.view || is_written(), &r.stats, &r.curve, &out, &why))
        return fail(why.text);
    const int64_t mapped_ns = pupil_live_now_ns(r.source);
    warn();
    if (run_outputs_take(&r.outputs, frame, &why))
        return fail(why.text);
    const pupil_image_const display = pupil_image_as_const(out);
    const int measured = r.options.shown.stats || r.options.shown.plot || r.view;
    frame_log_entry record =
        frame_log_fill(&r.pupil, &r.options.shown.config, &r.stats, &r.curve, frame, measured ? &display : NULL);
    describe_camera(frame, &record);
    record.process_us = (double)(mapped_ns - began_ns) * 1e-3;
    record.latency_us = record.read_us + (double)(mapped_ns - pupil_live_frame(r.source)->taken_ns) * 1e-3;
    const int written = run_outputs_write(&r.outputs, frame, &display, &record, &why);
    if (written < 0)
        return fail(why.text);
    r.ended = written;
    run_resume_frame(&r.resume, r.source, &r.sensor.setting, mapped_ns);
    pupil_colour_frame(&r.colour.colour, &frame->image, &frame->info);
    r.frames++;
    run_status_frame(&r.status, &record);
    r.ended |= r.view && view_frame(r.view, frame, &r.curve, &display, &record) == VIEW_QUIT;
    warn();
    return 0;
}

/* Until it ends, or fails: then why has a sentence. */
static void go_on(void)
{
    while (!r.failed && !r.ended && !is_over() && (!r.options.shown.most || r.frames < r.options.shown.most)) {
        pupil_frame frame;
        pupil_why why;
        const int got = pupil_source_next(r.source, &frame, &why);
        if (got == PUPIL_SOURCE_END || is_over())
            break;
        if (got != PUPIL_SOURCE_FRAME) {
            fail(why.text);
            break;
        }
        if (run_sensor_take(&r.sensor, &why)) {
            fail(why.text);
        } else if (!run_resume_leaves_out(&r.resume, r.source, &frame.info)) {
            if (!r.frames && r.options.seconds > 0.0)
                r.end_ns = pupil_live_frame(r.source)->taken_ns + (int64_t)(r.options.seconds * 1e9);
            show(&frame);
        }
        pupil_source_done(r.source, &frame);
    }
    if (!r.frames && !r.failed && !interrupt_came()) {
        pupil_refuse(&r.why, "%s: no frame came", r.device);
        r.failed = 1;
    }
}

/* --- begin and end --- */

static void restore(void)
{
    if (r.source)
        pupil_live_restore(r.source);
}

static int begin(void)
{
    run_options *o = &r.options;
    const char *fault = "";
    if (pupil_config_check(&o->shown.config, &fault)) {
        pupil_refuse(&r.why, "settings: %s", fault);
        return -1;
    }
    if (o->shown.plot && pupil_plot_check(o->shown.plot, &r.why))
        return -1;
    if (run_resume_check(o->resume, &r.why) ||
        run_choose_camera(r.system, o->device, r.device, sizeof r.device, &r.why))
        return -1;
    o->shown.inputs = &r.input;
    o->shown.input_count = 1;
    r.input = r.device;
    o->shown.source.stop = is_over;
    o->live.capture.system = r.system;
    o->live.hands_off = o->mode == RUN_DIGITAL && !(o->exposure_s > 0.0) && !(o->gain > 0.0);
    interrupt_fatal(restore);
    if (pupil_live_open(r.device, &o->shown.source, &o->live, &r.source, &r.why))
        return -1;
    run_outputs_begin(&r.outputs, &o->shown, r.source, r.device);
    pupil_why remark = {""};
    if (run_choose_mode(o, r.source, &remark, &r.why))
        return -1;
    if (*remark.text && !o->shown.quiet)
        say(&remark, "");
    run_sensor_begin(&r.sensor, o, r.source);
    run_resume_begin(&r.resume, o->resume, r.source, &remark);
    if (*remark.text)
        say(&remark, "");
    r.sensor.first_total_s = r.resume.total_s;
    run_row_gains_begin(&r.lamps, o, r.source, &remark);
    if (*remark.text && !o->shown.quiet)
        say(&remark, "");
    r.colour.own_picture = o->mode == RUN_SENSOR;
    o->shown.config.nominal_frame_s = 1.0 / r.source->fps;
    pupil_init(&r.pupil, &o->shown.config);
    if (replay_work_open(&r.work, &o->shown)) {
        pupil_refuse(&r.why, "not enough memory");
        return -1;
    }
    r.work.judge = run_sensor_judge;
    r.work.context = &r.sensor;
    r.work.cpu_only = o->row_gains;
    if (o->shown.gles && !o->shown.view)
        replay_work_gles(&r.work, NULL);
    run_status_begin(&r.status, o->shown.quiet, r.source, o);
    return 0;
}

static void finish(void)
{
    pupil_why why;
    if (run_outputs_finish(&r.outputs, &why))
        fail(why.text);
    if (!interrupt_again() && run_resume_end(&r.resume, &why))
        fail(why.text);
}

/* The camera comes first: nothing that follows can keep it. */
static void give_back(void)
{
    pupil_why why;
    if (r.source && pupil_live_give_back(r.source, &why) && !r.failed)
        fail(why.text);
}

static void end(char *more, size_t more_bytes)
{
    run_outputs_discard(&r.outputs);
    replay_work_tell(&r.work, more, more_bytes);
    replay_work_close(&r.work); /* before its window, whose context it may use */
    view_close(r.view);
    interrupt_fatal(NULL);
    pupil_source_close(r.source);
    r.source = NULL;
    if (pupil_live_await(LAST_WRITE_S, interrupt_again))
        fail("a control's write hangs: the camera keeps what it was set to");
}

int run_on(const pupil_v4l2_system *system, int argc, char **argv)
{
    char more[900] = "";
    r.system = system;
    const int parsed = run_options_parse(&r.options, argc, argv, &r.why);
    if (parsed == OPTIONS_HELP)
        return EXIT_DONE;
    if (parsed == OPTIONS_USAGE || frame_options_check_paths(&r.options.shown, &r.why) ||
        run_choose_outputs(&r.options, &r.why)) {
        say(&r.why, "");
        return EXIT_USAGE;
    }
    interrupt_watch();
    if (begin())
        r.failed = 1;
    else
        go_on();
    run_status_clear(&r.status);
    give_back();
    finish();
    const int given_up = interrupt_again();
    const uint64_t reopened = r.source ? pupil_live_capture(r.source)->counts.reopened : 0;
    end(more, sizeof more);
    if (r.outputs.not_recorded)
        snprintf(more + strlen(more), sizeof more - strlen(more), "; %llu not recorded, for the disk was too slow",
                 (unsigned long long)r.outputs.not_recorded);
    run_sensor_tell(&r.sensor, more + strlen(more), sizeof more - strlen(more));
    run_row_gains_tell(&r.lamps, more + strlen(more), sizeof more - strlen(more));
    if (r.failed)
        say(&r.why, "");
    if (given_up)
        fprintf(stderr, "pupil run: given up; outputs that were not complete are not there\n");
    else
        run_status_end(&r.status, &r.options, reopened, more);
    return given_up ? EXIT_GIVEN_UP : r.failed ? EXIT_FAILED : r.outputs.not_recorded ? EXIT_LOST : EXIT_DONE;
}

int run_main(int argc, char **argv)
{
    return run_on(NULL, argc, argv);
}
