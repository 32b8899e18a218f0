#include "outputs.h"

#include <stdio.h>

#include "common/interrupt.h"
#include "output/plot.h"

void run_outputs_begin(run_outputs *o, replay_options *options, pupil_source *source, const char *device)
{
    *o = (run_outputs){.options = options, .source = source, .device = device};
    o->pictures.system = pupil_live_capture(source)->device.system;
}

static int record_frame(run_outputs *o, const pupil_frame *frame, char *why, size_t why_bytes)
{
    const pupil_recorder_options options = {.camera = pupil_live_capture(o->source)->device.name,
                                            .fps = o->source->fps,
                                            .overwrite = o->options->overwrite,
                                            .give_up = interrupt_again};
    if (!o->options->record)
        return 0;
    if (!o->recorder && pupil_recorder_open(&o->recorder, o->options->record, frame, &options, why, why_bytes))
        return -1;
    return pupil_recorder_write(o->recorder, frame, why, why_bytes);
}

static int open_all(run_outputs *o, const pupil_frame *first, char *why, size_t why_bytes)
{
    const replay_options *options = o->options;
    const pupil_sink_options of_sink = {.width = first->image.width,
                                        .height = first->image.height,
                                        .fps = o->source->fps,
                                        .overwrite = options->overwrite,
                                        .keep_time = 1};
    o->is_open = 1;
    o->width = first->image.width;
    o->height = first->image.height;
    for (size_t i = 0; i < options->out_count; i++)
        if (outputs_open(&o->pictures, options->out[i], &of_sink, why, why_bytes))
            return -1;
    if (options->stats && pupil_stats_file_open(&o->stats_file, options->stats, why, why_bytes))
        return -1;
    if (options->plot && record_list_open(&o->records)) {
        snprintf(why, why_bytes, "not enough memory");
        return -1;
    }
    return 0;
}

int run_outputs_take(run_outputs *o, const pupil_frame *frame, char *why, size_t why_bytes)
{
    if (record_frame(o, frame, why, why_bytes))
        return -1;
    return o->is_open ? 0 : open_all(o, frame, why, why_bytes);
}

/* A camera that was opened again may have another size; what was written until then is kept. */
static int is_other_size(const run_outputs *o, const pupil_image_const *display, char *why, size_t why_bytes)
{
    if (!o->pictures.count || (display->width == o->width && display->height == o->height))
        return 0;
    snprintf(why, why_bytes, "%s: its frames have %u x %u pixels now; the outputs are of %u x %u, and end here",
             o->device, display->width, display->height, o->width, o->height);
    return 1;
}

/* The one that failed. */
static void drop_picture(run_outputs *o)
{
    replay_options *options = o->options;
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

int run_outputs_write(run_outputs *o, const pupil_frame *frame, const pupil_image_const *display, pupil_record *record,
                      char *why, size_t why_bytes)
{
    if (is_other_size(o, display, why, why_bytes))
        return -1;
    const int64_t began_ns = pupil_live_now_ns(o->source);
    if (outputs_write(&o->pictures, display, &frame->info, why, why_bytes)) {
        const int ended = interrupt_came() || outputs_reader_gone(&o->pictures);
        drop_picture(o);
        return ended ? 1 : -1;
    }
    record->write_us = (double)(pupil_live_now_ns(o->source) - began_ns) * 1e-3;
    if (o->stats_file && pupil_stats_file_write(o->stats_file, record, why, why_bytes)) {
        const int ended = interrupt_came() || pupil_stats_reader_gone(o->stats_file);
        drop_stats(o);
        return ended ? 1 : -1;
    }
    record_list_add(&o->records, record);
    o->frames++;
    return 0;
}

/* Of several sentences the first one is the cause. */
static int keep_first(int failed, const char *next, char *why, size_t why_bytes)
{
    if (!failed)
        snprintf(why, why_bytes, "%s", next);
    return -1;
}

int run_outputs_finish(run_outputs *o, char *why, size_t why_bytes)
{
    char next[PUPIL_WHY_BYTES];
    int failed = 0;
    pupil_recorder_counts recorded = {0};
    if (o->recorder)
        pupil_recorder_get_counts(o->recorder, &recorded);
    o->not_recorded = recorded.lost;
    if (o->recorder && pupil_recorder_close(o->recorder, next, sizeof next))
        failed = keep_first(failed, next, why, why_bytes);
    o->recorder = NULL;
    if (!o->frames && o->is_open) {
        outputs_discard(&o->pictures);
        drop_stats(o);
        o->options->out_count = 0;
        o->options->plot = NULL;
    }
    while (o->pictures.count && !interrupt_again())
        if (outputs_finish(&o->pictures, next, sizeof next)) {
            failed = keep_first(failed, next, why, why_bytes);
            drop_picture(o);
        }
    if (o->stats_file && !interrupt_again()) {
        if (pupil_stats_file_finish(o->stats_file, next, sizeof next)) {
            failed = keep_first(failed, next, why, why_bytes);
            o->options->stats = NULL;
        }
        o->stats_file = NULL;
    }
    if (o->records.count && !interrupt_again() &&
        pupil_plot_write(o->options->plot, o->records.records, o->records.count, o->device, next, sizeof next)) {
        failed = keep_first(failed, next, why, why_bytes);
        o->options->plot = NULL;
    }
    return failed;
}

void run_outputs_discard(run_outputs *o)
{
    outputs_discard(&o->pictures);
    pupil_stats_file_discard(o->stats_file);
    record_list_close(&o->records);
}
