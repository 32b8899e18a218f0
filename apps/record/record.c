/* pupil record: raw frames as they come, into a folder. */
#include "record.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "common/camera.h"
#include "common/interrupt.h"
#include "common/open_input.h"
#include "common/progress.h"
#include "common/report_error.h"
#include "file/recording/recording.h"
#include "live/live.h"
#include "options.h"
#include "options/commands.h"
#include "pupil/pupil.h"
#include "refuse.h"
#include "run/choose.h"
#include "run/sensor.h"

typedef struct record {
    record_options options;
    pupil_source *source;
    char device[PATH_MAX];    /* of the camera */
    const char *name;         /* of the input */
    const pupil_live *camera; /* NULL: the source is not a camera */
    pupil_recorder *recorder;
    int64_t first_ns;
    uint64_t taken, bytes; /* frames from the source, and their bytes */
    pupil_recorder_counts counts;
    progress progress;

    run_sensor sensor;
    pupil_t pupil;
    pupil_stats stats;
    pupil_why why;
} record;

static void say(record *r)
{
    report_error("pupil record", &r->why, "");
}

/* --- the camera's exposure --- */

static int is_steered(const record_options *o)
{
    return o->automatic || o->run.exposure_s > 0 || o->run.gain > 0;
}

static int begin_exposure(record *r)
{
    const record_options *o = &r->options;
    pupil_camera *camera = pupil_live_camera(r->source);
    if (!is_steered(o))
        return 0;
    if (!camera)
        return pupil_refuse(&r->why, "--%s: %.900s",
                            o->automatic            ? "auto"
                            : o->run.exposure_s > 0 ? "shutter"
                                                    : "gain",
                            pupil_live_no_controls(r->source));
    camera_guard(r->source);
    pupil_init(&r->pupil, &r->options.run.shown.config);
    run_sensor_begin(&r->sensor, &r->options.run, r->source, NULL);
    return run_choose_mode(&r->options.run, r->source, NULL, &r->why);
}

/* From the first frame on, which has the time; a camera that was unplugged and came back is taken again. */
static int follow_light(record *r, const pupil_frame *frame)
{
    pupil_curve unused;
    if (!is_steered(&r->options))
        return 0;
    if (run_sensor_take(&r->sensor, &r->why))
        return -1;
    if (!r->options.automatic)
        return 0;
    pupil_stats_clear(&r->stats);
    const int error = pupil_meter_rows(&r->pupil, &frame->image, 0, frame->image.height, &r->stats);
    if (error)
        return pupil_refuse(&r->why, "%s: %s", frame->name, pupil_error_string(error));
    run_sensor_frame(&r->sensor, &r->stats, &frame->info, &unused);
    return 0;
}

/* --- frames --- */

static size_t bytes_of(const pupil_frame *frame)
{
    const pupil_image_const *image = &frame->image;
    if (frame->coded)
        return frame->coded_bytes;
    const size_t planes = pupil_pixel_planes(image->pixel);
    return pupil_row_bytes(image->pixel, image->width) * image->height +
           (planes > 1 ? planes - 1 : 0) * pupil_chroma_row_bytes(image->pixel, image->width) *
               pupil_chroma_rows(image->pixel, image->height);
}

static int open_recorder(record *r, const pupil_frame *first)
{
    const pupil_recorder_options options = {.camera = r->camera ? r->camera->is.name : r->name,
                                            .fps = r->source->fps,
                                            .primaries = r->source->primaries,
                                            .overwrite = r->options.run.shown.overwrite,
                                            .wait = !r->camera,
                                            .give_up = interrupt_again};
    r->first_ns = first->info.timestamp_ns;
    return pupil_recorder_open(&r->recorder, r->options.folder, first, &options, &r->why);
}

static void show(record *r)
{
    if (!progress_due(&r->progress, 0.2))
        return;
    const double took_s = r->progress.last_s - r->progress.began_s;
    pupil_recorder_get_counts(r->recorder, &r->counts);
    progress_add(&r->progress, "frame %llu   %.1f frames/s   %.1f MB/s   lost %llu", (unsigned long long)r->taken,
                 (double)r->taken / took_s, (double)r->bytes * 1e-6 / took_s, (unsigned long long)r->counts.lost);
    if (r->camera && r->camera->counts.lost)
        progress_add(&r->progress, ", by the camera %llu", (unsigned long long)r->camera->counts.lost);
    progress_show(&r->progress);
}

static int goes_on(const record *r, const pupil_frame *last)
{
    const double passed_s = (double)(last->info.timestamp_ns - r->first_ns) * 1e-9 + 1.0 / r->source->fps;
    return (!r->options.run.shown.most || r->taken < r->options.run.shown.most) &&
           (!(r->options.run.seconds > 0) || passed_s < r->options.run.seconds - 1e-9);
}

static int run(record *r)
{
    for (int more = 1; more && !interrupt_came();) {
        pupil_frame frame;
        const int got = pupil_source_next(r->source, &frame, &r->why);
        if (got == PUPIL_SOURCE_END || (got != PUPIL_SOURCE_FRAME && interrupt_came()))
            break;
        if (got != PUPIL_SOURCE_FRAME)
            return -1;
        int failed = !r->recorder && open_recorder(r, &frame);
        failed = failed || pupil_recorder_write(r->recorder, &frame, &r->why) || follow_light(r, &frame);
        if (!failed) {
            r->taken++;
            r->bytes += bytes_of(&frame);
            more = goes_on(r, &frame);
            show(r);
        }
        pupil_source_done(r->source, &frame);
        if (failed)
            return -1;
    }
    if (r->taken)
        return 0;
    return pupil_refuse(&r->why, "%s: no frame came, so nothing was recorded", r->name);
}

/* --- begin and end --- */

static int open_source(record *r, const pupil_live_system *system)
{
    const record_options *o = &r->options;
    r->options.run.shown.source.stop = interrupt_came;
    r->name = o->run.shown.input_count ? o->run.shown.inputs[0] : r->device;
    if (o->run.shown.input_count && (o->run.shown.input_count > 1 || !pupil_live_is_camera(r->name)))
        return open_input(o->run.shown.inputs, o->run.shown.input_count, &o->run.shown.source, &r->source, &r->why);
    if (camera_choose(system, o->run.shown.input_count ? o->run.shown.inputs[0] : o->run.device, r->device,
                      sizeof r->device, &r->why))
        return -1;
    const pupil_live_options live = {.system = system,
                                     .capture = {.fourcc = o->run.live.capture.fourcc, .late = PUPIL_LIVE_LATE_KEPT},
                                     .hands_off = !is_steered(o)};
    if (pupil_live_open(r->device, &o->run.shown.source, &live, &r->source, &r->why))
        return -1;
    r->camera = pupil_live_get(r->source);
    if (is_steered(o) && !o->run.shown.quiet && *r->camera->remark.text) {
        r->why = r->camera->remark;
        say(r);
    }
    return begin_exposure(r);
}

static void tell(const record *r)
{
    fprintf(stderr, "recorded %llu frame%s, %.1f MB, in %.1f s", (unsigned long long)r->counts.written,
            r->counts.written == 1 ? "" : "s", (double)r->bytes * 1e-6 * (double)r->counts.written / (double)r->taken,
            progress_now_s() - r->progress.began_s);
    report_name(stderr, "; ", r->options.folder, "");
    if (r->counts.lost)
        fprintf(stderr, "; %llu were lost, for the disk was too slow", (unsigned long long)r->counts.lost);
    if (r->camera && r->camera->counts.lost)
        fprintf(stderr, "; %llu never came from the camera", (unsigned long long)r->camera->counts.lost);
    fputc('\n', stderr);
}

/* Ctrl-C is the usual end. Frames that were written remain, also after a failure. */
static int end(record *r, int failed)
{
    pupil_why unused;
    if (r->camera && pupil_live_give_back(r->source, failed ? &unused : &r->why))
        failed = -1;
    camera_guard(NULL);
    if (!r->recorder)
        return failed;
    pupil_recorder_get_counts(r->recorder, &r->counts);
    if (pupil_recorder_close(r->recorder, failed ? &unused : &r->why))
        return -1;
    r->counts.written = r->taken - r->counts.lost; /* also those that waited */
    return failed;
}

int record_on(const pupil_live_system *system, int argc, char **argv)
{
    static record r; /* one run at a time; pupil_t and pupil_stats are too large for a stack */
    memset(&r, 0, sizeof r);
    const int parsed = record_options_parse(&r.options, argc, argv, &r.why);
    if (parsed == OPTIONS_HELP)
        return EXIT_DONE;
    if (parsed == OPTIONS_USAGE) {
        say(&r);
        return EXIT_USAGE;
    }
    interrupt_watch();
    progress_begin(&r.progress, r.options.run.shown.quiet, 0);
    int failed = open_source(&r, system) || run(&r);
    progress_clear(&r.progress);
    failed = end(&r, failed);
    if (failed)
        say(&r);
    if (r.counts.written && !r.options.run.shown.quiet)
        tell(&r);
    pupil_source_close(r.source);
    (void)camera_await_last_write();
    return failed ? EXIT_FAILED : r.counts.lost ? EXIT_INCOMPLETE : EXIT_DONE;
}

int record_main(int argc, char **argv)
{
    return record_on(NULL, argc, argv);
}
