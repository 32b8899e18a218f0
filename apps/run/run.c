/* pupil run: live frames of a camera through meter -> adapt -> map, with its exposure and gain under control. */
#include "run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ask.h"
#include "choose.h"
#include "colour.h"
#include "common/camera.h"
#include "common/interrupt.h"
#include "control.h"
#include "notify.h"
#include "options/commands.h"
#include "output/frame_log_fill.h"
#include "refuse.h"
#include "resume.h"
#include "row_gains.h"
#include "sensor.h"
#include "session/session.h"
#include "several.h"
#include "status.h"

typedef struct run {
    run_options options;
    const pupil_live_system *system; /* NULL: the machine's */
    char device[272];
    const char *input; /* the device's name, as the only input */
    session session;
    run_several several;
    run_led led;
    run_sensor sensor;
    run_resume resume;
    run_colour colour;
    run_row_gains lamps;
    run_status status;
    run_notify notify;
    run_ask ask;
    run_control *control;
    pupil_live_counts counts; /* at the last frame */
    int failed;               /* session.why has the sentence */
    pupil_why unused;
} run;

/* Of -t: when the run is over, by the clock of the source. The source asks without a context while it waits. */
static struct {
    const pupil_source *source;
    int64_t at_ns; /* 0: no limit */
    const run_several *several;
} end_of_run;

static int is_over(void)
{
    return interrupt_came() || (end_of_run.several && run_several_is_over(end_of_run.several)) ||
           (end_of_run.at_ns && end_of_run.source && pupil_live_now_ns(end_of_run.source) >= end_of_run.at_ns);
}

/* Of several sentences the first is kept, because it is the cause. */
static pupil_why *why_of(run *r)
{
    return r->failed ? &r->unused : &r->session.why;
}

/* --- a frame --- */

static void describe_camera(run *r, const pupil_frame *frame, int64_t mapped_ns, frame_log_entry *entry)
{
    const pupil_source *source = r->session.source;
    const pupil_live_counts before = r->counts;
    const pupil_live_counts *now = &pupil_live_get(source)->counts;
    const pupil_live_times *f = &pupil_live_get(source)->times;
    entry->live = 1;
    entry->sequence = frame->info.sequence;
    entry->lost = now->lost - before.lost;
    entry->flagged = now->flagged - before.flagged + now->cut - before.cut;
    entry->late = now->late - before.late;
    entry->read_us = f->stamp == PUPIL_LIVE_STAMP_NONE ? (double)NAN : (double)(f->taken_ns - f->stamp_ns) * 1e-3;
    entry->latency_us = entry->read_us + (double)(mapped_ns - f->taken_ns) * 1e-3;
    r->counts = *now;
    run_sensor_describe(&r->sensor, &frame->info, entry);
    if (r->options.mode == RUN_SENSOR && entry->aimed_level > 0.0) /* the camera's key, not the level's */
        entry->aimed_level = frame_log_aimed_level(&r->session.pipeline, entry->key);
}

/* A service manager waits until the exposure is right, or as near as the camera can get; without its controls, until
 * the picture's level is right. */
static int is_at_rest(const run *r)
{
    const pupil_camera_loop *loop = &r->sensor.loop;
    pupil_exposure level;
    if (loop->steers)
        return run_sensor_is_at_rest(&loop->setting) || loop->setting.state == PUPIL_SENSOR_LOCKED;
    pupil_get_exposure(&r->session.pipeline.pupil, &level);
    return level.state != PUPIL_STATE_EMPTY && level.state != PUPIL_STATE_ADAPTING;
}

/* With several cameras: publishes this one's decision if it leads, else takes over the leader's, so that pictures are
 * alike. */
static void share(run *r, const pupil_frame *frame, pupil_curve *curve)
{
    run_several *several = &r->several;
    const pupil_sensor_setting *setting = &r->sensor.loop.setting;
    pupil_frame_info info = frame->info;
    if (!several->shared || !r->sensor.loop.steers || !r->sensor.camera || !setting->frames)
        return;
    if (!r->sensor.follows) {
        const run_led led = {.at_ns = run_several_stamp(&frame->info),
                             .total_s = run_sensor_total_s(&r->sensor, &frame->info),
                             .shown_s = run_sensor_shown_s(&r->sensor, &frame->info),
                             .set_s = setting->exposure_s * setting->gain,
                             .scene_ev = setting->scene_ev,
                             .pupil = r->session.pipeline.pupil};
        run_several_publish(several, &led);
        return;
    }
    if (!run_several_read(several, &frame->info, 1.0 / r->session.source->fps, &r->led))
        return;
    several->seen_ev += setting->scene_ev - r->led.scene_ev;
    several->seen++;
    run_sensor_follow(&r->sensor, &frame->info, &r->led);
    info.gain *= exp2(several->ev); /* as if the leader had taken the frame */
    if (!run_sensor_curve(&r->sensor, curve))
        (void)pupil_get_curve(&r->led.pupil, &info, curve);
}

/* Between metering and mapping: the camera's next setting, and of RUN_SENSOR the curve of its own picture. */
static void step_sensor(run *r, const pupil_frame *frame)
{
    frame_pipeline *p = &r->session.pipeline;
    pupil_curve curve = p->curve;
    const double filter_ev = r->sensor.loop.setting.filter_ev;
    r->sensor.follows = !run_several_leads(&r->several, 1.0 / r->session.source->fps);
    run_sensor_frame(&r->sensor, &p->stats, &frame->info, &curve);
    if (r->sensor.loop.setting.filter_ev != filter_ev) { /* the picture adapts to the light without the filter */
        pupil_config config = p->config;
        config.calibration *= exp2(filter_ev - r->sensor.loop.setting.filter_ev);
        r->options.shown.config.calibration = config.calibration;
        frame_pipeline_retune(p, &config);
        curve = r->options.mode == RUN_SENSOR ? curve : p->curve;
    }
    share(r, frame, &curve);
    if (p->config.order != PUPIL_ORDER_FUSED) /* fused frames are mapped already */
        p->curve = curve;
}

static int show(run *r, pupil_frame *frame)
{
    session *s = &r->session;
    frame_log_entry entry;
    if (run_colour_take(&r->colour, &r->options.colour, s->source, frame, &s->why))
        return -1;
    run_sensor_limit(&r->sensor, &frame->info, &s->pipeline);
    cpu_engine_row_gains(s->pipeline.cpu, run_row_gains_take(&r->lamps, &r->sensor, frame));
    if (session_meter(s, frame))
        return -1;
    step_sensor(r, frame);
    if (session_map(s, frame, &entry))
        return -1;
    const int64_t mapped_ns = pupil_live_now_ns(s->source);
    describe_camera(r, frame, mapped_ns, &entry);
    if (session_show(s, frame, &entry))
        return -1;
    run_resume_frame(&r->resume, s->source, &r->sensor.loop.setting, mapped_ns);
    pupil_white_balance_frame(&r->colour.colour, &frame->image, &frame->info);
    run_status_frame(&r->status, &entry);
    run_notify_frame(&r->notify, is_at_rest(r), &entry, mapped_ns);
    r->ask.last = entry;
    return 0;
}

static int take(run *r, pupil_frame *frame)
{
    session *s = &r->session;
    if (run_sensor_take(&r->sensor, &s->why))
        return -1;
    if (run_resume_leaves_out(&r->resume, s->source, &frame->info))
        return 0;
    if (!s->frames && r->options.seconds > 0.0)
        end_of_run.at_ns = pupil_live_get(s->source)->times.taken_ns + (int64_t)(r->options.seconds * 1e9);
    return show(r, frame);
}

/* Between two frames. */
static void serve(run *r)
{
    const pupil_sensor_config *c = &r->sensor.loop.config;
    const int steers = r->sensor.loop.steers && r->sensor.camera;
    r->ask.gain_min = steers ? c->gain_min : 0.0;
    r->ask.exposure_min_s = steers ? c->exposure_min_s : 0.0;
    run_control_serve(r->control);
}

static int go_on(run *r)
{
    session *s = &r->session;
    int failed = 0;
    while (!failed && !is_over() && session_goes_on(s)) {
        pupil_frame frame;
        const int got = pupil_source_next(s->source, &frame, &s->why);
        if (got == PUPIL_SOURCE_END || is_over())
            break;
        if (got != PUPIL_SOURCE_FRAME)
            return -1;
        failed = take(r, &frame);
        pupil_source_done(s->source, &frame);
        serve(r);
    }
    if (!s->frames && !failed && !interrupt_came())
        return pupil_refuse(&s->why, "%s: no frame came", r->device);
    return failed;
}

/* --- begin and end --- */

static void remark(run *r, pupil_why *words, int is_shown)
{
    if (*words->text && is_shown)
        session_say(&r->session, words, "");
    *words->text = 0;
}

static int open_camera(run *r)
{
    run_options *o = &r->options;
    session *s = &r->session;
    if (camera_choose(r->system, o->device, r->device, sizeof r->device, &s->why))
        return -1;
    o->shown.inputs = &r->input;
    o->shown.input_count = 1;
    r->input = r->device;
    o->shown.source.stop = is_over;
    o->live.system = r->system;
    o->live.hands_off = o->mode == RUN_DIGITAL && !(o->exposure_s > 0.0) && !(o->gain > 0.0);
    o->live.capture.share = o->shown.gles || o->shown.view; /* the GPU reads frames without a copy */
    if (o->shown.record && !o->live.capture.late)
        o->live.capture.late = PUPIL_LIVE_LATE_KEPT;
    if (pupil_live_open(r->device, &o->shown.source, &o->live, &s->source, &s->why))
        return -1;
    end_of_run.source = s->source;
    camera_guard(s->source);
    o->shown.config.nominal_frame_s = 1.0 / s->source->fps;
    return session_begin(s, 1);
}

/* Publishes the limits that the other cameras have to keep. */
static void offer(run *r)
{
    pupil_sensor_config c;
    pupil_camera *camera = pupil_live_camera(r->session.source);
    if (!r->several.shared || !camera)
        return;
    pupil_sensor_config_default(&c);
    c.frame_s = 1.0 / r->session.source->fps;
    pupil_camera_configure(camera, &c);
    const double longest_s = r->options.any_frame_rate ? c.exposure_max_s : fmin(c.exposure_max_s, c.frame_s);
    run_several_offer(&r->several, c.exposure_min_s * c.gain_min, longest_s * c.gain_max);
}

/* No state is kept if no control is used, or the user wants a cold start. */
static int keeps_state(const run_options *o)
{
    return !o->begins_cold && o->mode != RUN_DIGITAL && !(o->exposure_s > 0.0 && o->gain > 0.0);
}

static int begin(run *r)
{
    run_options *o = &r->options;
    session *s = &r->session;
    pupil_why words = {""};
    r->ask = (run_ask){.options = o,
                       .session = s,
                       .sensor = &r->sensor,
                       .last = {.state = "empty", .reason = "", .sensor = "", .sensor_reason = "", .day_night = ""}};
    if (o->control && run_control_open(&r->control, o->control, run_ask_line, &r->ask, &s->why))
        return -1;
    if (session_check(s) || run_resume_check(o->resume, &s->why) || open_camera(r) ||
        run_choose_mode(o, s->source, &words, &s->why))
        return -1;
    remark(r, &words, !o->shown.quiet);
    words = pupil_live_get(s->source)->remark;
    remark(r, &words, !o->shown.quiet);
    run_sensor_begin(&r->sensor, o, s->source, r->several.shared ? &r->several : NULL);
    offer(r);
    if (o->resume || keeps_state(o))
        run_resume_begin(&r->resume, o->resume, s->source, &words);
    remark(r, &words, 1);
    r->sensor.first_total_s = r->resume.total_s;
    run_notify_open(&r->notify, &words);
    remark(r, &words, 1);
    run_row_gains_begin(&r->lamps, o, s->source, &words);
    remark(r, &words, !o->shown.quiet);
    r->colour.own_picture = o->mode == RUN_SENSOR;
    s->pipeline.own_curve = o->mode == RUN_SENSOR;
    s->pipeline.cpu_only = o->row_gains;
    run_status_begin(&r->status, s, o->mode, r->resume.total_s > 0.0);
    if (r->several.index)
        s->progress.shown = 0; /* the line is the first camera's */
    return 0;
}

/* The camera is closed first, so that nothing after it can hold it. */
static void finish(run *r)
{
    session *s = &r->session;
    run_notify_close(&r->notify);
    run_several_end(&r->several);
    if (s->source && pupil_live_give_back(s->source, why_of(r)))
        r->failed = 1;
    if (session_outputs_finish(&s->outputs, why_of(r)))
        r->failed = 1;
    if (!interrupt_again() && run_resume_end(&r->resume, why_of(r)))
        r->failed = 1;
}

/* `more`: further text, of which each part begins with "; ". */
static void end(run *r, char *more, size_t more_bytes)
{
    session *s = &r->session;
    session_end(s, more, more_bytes);
    run_control_close(r->control);
    camera_guard(NULL);
    end_of_run.source = NULL;
    pupil_source_close(s->source);
    s->source = NULL;
    if (camera_await_last_write()) {
        pupil_refuse(why_of(r), "a control's write hangs: the camera keeps what it was set to");
        r->failed = 1;
    }
}

/* Adds the run's findings, each after "; ". */
static void add_findings(const run *r, char *more, size_t more_bytes)
{
    const uint64_t not_recorded = r->session.outputs.not_recorded;
    if (not_recorded)
        snprintf(more + strlen(more), more_bytes - strlen(more), "; %llu not recorded, for the disk was too slow",
                 (unsigned long long)not_recorded);
    run_sensor_tell(&r->sensor, more + strlen(more), more_bytes - strlen(more));
    run_row_gains_tell(&r->lamps, more + strlen(more), more_bytes - strlen(more));
    run_several_tell(&r->several, more + strlen(more), more_bytes - strlen(more));
}

static int check_outputs(run_options *o, time_t now, pupil_why *why)
{
    return frame_options_expand_paths(&o->shown, now, why) || run_choose_outputs(o, why) ||
                   frame_options_check_paths(&o->shown, why) || session_outputs_check_kinds(&o->shown, why)
               ? OPTIONS_USAGE
               : OPTIONS_RUN;
}

/* Checks the options of several cameras, before any of them begins. */
static int check_several(const run_options *o, time_t now, pupil_why *why)
{
    static run_options one;
    for (uint32_t i = 0; i < o->devices && o->devices > 1; i++) {
        one = *o;
        run_several_paths(&one, i);
        if (check_outputs(&one, now, why))
            return OPTIONS_USAGE;
    }
    frame_options_release_paths(); /* each process chooses its own */
    return OPTIONS_RUN;
}

/* `status`: in the first process of several cameras, once all have ended, their exit status; else -1. */
static int parse(run *r, int argc, char **argv, int *status)
{
    pupil_why *why = &r->session.why;
    const time_t now = time(NULL);
    int parsed = run_options_parse(&r->options, argc, argv, why);
    *status = -1;
    if (parsed == OPTIONS_HELP)
        return parsed;
    if (!parsed)
        parsed = check_several(&r->options, now, why);
    if (!parsed && r->options.devices > 1)
        *status = run_several_begin(&r->several, &r->options);
    if (*status >= 0)
        return parsed;
    if (parsed || check_outputs(&r->options, now, why)) {
        session_say(&r->session, why, "");
        return OPTIONS_USAGE;
    }
    return parsed;
}

int run_on(const pupil_live_system *system, int argc, char **argv)
{
    static run r; /* pupil_t and pupil_stats are too large for a stack */
    session *s = &r.session;
    char more[1100] = "";
    memset(&r, 0, sizeof r);
    r.notify.fd = -1;
    r.system = system;
    s->command = "pupil run";
    s->options = &r.options.shown;
    int status;
    const int parsed = parse(&r, argc, argv, &status);
    if (status >= 0)
        return status;
    if (parsed != OPTIONS_RUN)
        return parsed == OPTIONS_HELP ? EXIT_DONE : EXIT_USAGE;
    end_of_run.several = &r.several;
    interrupt_watch();
    r.failed = begin(&r) || go_on(&r);
    progress_clear(&s->progress);
    finish(&r);
    const int given_up = interrupt_again();
    const uint64_t reopened = s->source ? pupil_live_get(s->source)->counts.reopened : 0;
    end(&r, more, sizeof more);
    add_findings(&r, more, sizeof more);
    if (r.failed)
        session_say(s, &s->why, "");
    if (given_up)
        fprintf(stderr, "pupil run: given up; outputs that were not complete are not there\n");
    else
        run_status_end(&r.status, &s->outputs, reopened, r.several.shared ? r.device : NULL, more);
    return given_up ? EXIT_INTERRUPTED : r.failed ? EXIT_FAILED : s->outputs.not_recorded ? EXIT_INCOMPLETE : EXIT_DONE;
}

int run_main(int argc, char **argv)
{
    return run_on(NULL, argc, argv);
}
