#include "outputs.h"

#include <stdio.h>

#include "common/interrupt.h"
#include "output/plot.h"
#include "refuse.h"

void run_outputs_begin(run_outputs *o, frame_options *options, pupil_source *source, const char *device)
{
    *o = (run_outputs){.options = options, .source = source, .device = device};
    o->pictures.system = pupil_live_capture(source)->device.system;
}

static int record_frame(run_outputs *o, const pupil_frame *frame, pupil_why *why)
{
    const pupil_recorder_options options = {.camera = pupil_live_capture(o->source)->device.name,
                                            .fps = o->source->fps,
                                            .overwrite = o->options->overwrite,
                                            .give_up = interrupt_again};
    if (!o->options->record)
        return 0;
    if (!o->recorder && pupil_recorder_open(&o->recorder, o->options->record, frame, &options, why))
        return -1;
    return pupil_recorder_write(o->recorder, frame, why);
}

static int open_all(run_outputs *o, const pupil_frame *first, pupil_why *why)
{
    const frame_options *options = o->options;
    const pupil_sink_options of_sink = {.width = first->image.width,
                                        .height = first->image.height,
                                        .fps = o->source->fps,
                                        .overwrite = options->overwrite,
                                        .keep_time = 1};
    o->is_open = 1;
    o->width = first->image.width;
    o->height = first->image.height;
    for (size_t i = 0; i < options->out_count; i++)
        if (outputs_open(&o->pictures, options->out[i], &of_sink, why))
            return -1;
    if (options->stats && pupil_stats_file_open(&o->stats_file, options->stats, why))
        return -1;
    if (options->plot && frame_log_open(&o->log, 1)) {
        pupil_refuse(why, "not enough memory");
        return -1;
    }
    return 0;
}

int run_outputs_take(run_outputs *o, const pupil_frame *frame, pupil_why *why)
{
    if (record_frame(o, frame, why))
        return -1;
    return o->is_open ? 0 : open_all(o, frame, why);
}

/* A camera that was opened again may have another size; what was written until then is kept. */
static int is_other_size(const run_outputs *o, const pupil_image_const *display, pupil_why *why)
{
    if (!o->pictures.count || (display->width == o->width && display->height == o->height))
        return 0;
    pupil_refuse(why, "%s: its frames have %u x %u pixels now; the outputs are of %u x %u, and end here", o->device,
                 display->width, display->height, o->width, o->height);
    return 1;
}

/* The one that failed. */
static void drop_picture(run_outputs *o)
{
    frame_options *options = o->options;
    const char *path = o->pictures.path[o->pictures.failed];
    size_t kept = 0;
    for (size_t i = 0; i < options->out_count; i++)
        if (options->out[i] != path)
            options->out[kept++] = options->out[i];
    options->out_count = kept;
    outputs_drop(&o->pictures);
}

static void drop_stats(run_outputs *o)
{
    pupil_stats_file_discard(o->stats_file);
    o->stats_file = NULL;
    o->options->stats = NULL;
}

int run_outputs_write(run_outputs *o, const pupil_frame *frame, const pupil_image_const *display,
                      frame_log_entry *record, pupil_why *why)
{
    if (is_other_size(o, display, why))
        return -1;
    const int64_t began_ns = pupil_live_now_ns(o->source);
    if (outputs_write(&o->pictures, display, &frame->info, why)) {
        const int ended = interrupt_came() || outputs_reader_gone(&o->pictures);
        drop_picture(o);
        return ended ? 1 : -1;
    }
    record->write_us = (double)(pupil_live_now_ns(o->source) - began_ns) * 1e-3;
    if (o->stats_file && pupil_stats_file_write(o->stats_file, record, why)) {
        const int ended = interrupt_came() || pupil_stats_reader_gone(o->stats_file);
        drop_stats(o);
        return ended ? 1 : -1;
    }
    frame_log_add(&o->log, record);
    o->frames++;
    return 0;
}

/* Of several sentences the first one is the cause. */
static int keep_first(int failed, const char *next, pupil_why *why)
{
    if (!failed)
        pupil_refuse(why, "%s", next);
    return -1;
}

int run_outputs_finish(run_outputs *o, pupil_why *why)
{
    pupil_why next;
    int failed = 0;
    pupil_recorder_counts recorded = {0};
    if (o->recorder)
        pupil_recorder_get_counts(o->recorder, &recorded);
    o->not_recorded = recorded.lost;
    if (o->recorder && pupil_recorder_close(o->recorder, &next))
        failed = keep_first(failed, next.text, why);
    o->recorder = NULL;
    if (!o->frames && o->is_open) {
        outputs_discard(&o->pictures);
        drop_stats(o);
        o->options->out_count = 0;
        o->options->plot = NULL;
    }
    while (o->pictures.count && !interrupt_again())
        if (outputs_finish(&o->pictures, &next)) {
            failed = keep_first(failed, next.text, why);
            drop_picture(o);
        }
    if (o->stats_file && !interrupt_again()) {
        if (pupil_stats_file_finish(o->stats_file, &next)) {
            failed = keep_first(failed, next.text, why);
            o->options->stats = NULL;
        }
        o->stats_file = NULL;
    }
    if (o->log.count && !interrupt_again() &&
        pupil_plot_write(o->options->plot, o->log.entry, o->log.count, o->device, &next)) {
        failed = keep_first(failed, next.text, why);
        o->options->plot = NULL;
    }
    return failed;
}

void run_outputs_discard(run_outputs *o)
{
    outputs_discard(&o->pictures);
    pupil_stats_file_discard(o->stats_file);
    frame_log_close(&o->log);
}
