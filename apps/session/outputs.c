#include "outputs.h"

#include <stdio.h>

#include "common/interrupt.h"
#include "common/progress.h"
#include "common/report_error.h"
#include "file/file_sink.h"
#include "live/live.h"
#include "output/plot.h"
#include "refuse.h"

int session_outputs_check_kinds(const frame_options *options, pupil_why *why)
{
    for (size_t i = 0; i < options->out_count; i++)
        if (pupil_file_sink_check(options->out[i], why))
            return -1;
    return (options->stats && pupil_stats_file_check(options->stats, why)) ||
                   (options->plot && pupil_plot_kind(options->plot, why) < 0)
               ? -1
               : 0;
}

int session_outputs_want_pixels(const frame_options *options)
{
    return options->out_count || options->stats || options->plot || options->report;
}

int session_outputs_want_figures(const frame_options *options)
{
    return options->stats || options->plot || options->report || options->view || options->explains;
}

void session_outputs_begin(session_outputs *o, frame_options *options, const pupil_source *source, int live)
{
    *o = (session_outputs){.options = options, .source = source, .live = live};
    if (live)
        o->pictures.system = pupil_live_get(source)->system;
}

/* --- a frame --- */

static int record_frame(session_outputs *o, const pupil_frame *frame, pupil_why *why)
{
    if (!o->options->record)
        return 0;
    const pupil_recorder_options options = {.camera = pupil_live_get(o->source)->is.name,
                                            .fps = o->source->fps,
                                            .primaries = o->source->primaries,
                                            .overwrite = o->options->overwrite,
                                            .give_up = interrupt_again};
    if (!o->recorder && pupil_recorder_open(&o->recorder, o->options->record, frame, &options, why))
        return -1;
    return pupil_recorder_write(o->recorder, frame, why);
}

/* A gap longer than this, while a camera was away, is left out. */
#define LIVE_GAP_S 2.0

/* Sound has the frames' pace; --hold changes it. */
static pupil_sink_sound sound_of(session_outputs *o, const pupil_frame *first)
{
    if (o->options->hold <= 1)
        return (pupil_sink_sound){o->source->sound.path, o->source->sound.begin_ns + first->info.timestamp_ns};
    o->held_sound = o->options->out_count && o->source->sound.path;
    return (pupil_sink_sound){0};
}

/* Whether the input is a video whose frames are shown once each. */
static int has_own_times(const session_outputs *o)
{
    return !(o->source->obeys & PUPIL_SOURCE_FPS) && o->options->hold <= 1;
}

static int open_all(session_outputs *o, const pupil_frame *frame, const pupil_image *first, pupil_why *why)
{
    const frame_options *options = o->options;
    const pupil_sink_options of_sink = {.width = first->width,
                                        .height = first->height,
                                        .fps = o->source->fps,
                                        .overwrite = options->overwrite,
                                        .primaries = pictures_primaries(&options->config),
                                        .transfer = options->config.transfer,
                                        .keep_time = o->live || has_own_times(o),
                                        .gap_most_s = o->live ? LIVE_GAP_S : PUPIL_SINK_VIDEO_GAP_S,
                                        .aspect = {o->source->pixel_aspect[0], o->source->pixel_aspect[1]},
                                        .named = options->reset_each && o->source->is_named,
                                        .live = o->live,
                                        .sound = sound_of(o, frame)};
    o->is_open = 1;
    o->width = first->width;
    o->height = first->height;
    for (size_t i = 0; i < options->out_count; i++)
        if (pictures_open(&o->pictures, options->out[i], &of_sink, why))
            return -1;
    if (options->stats && pupil_stats_file_open(&o->stats_file, options->stats, o->options->overwrite, why))
        return -1;
    if ((options->plot || options->report) && frame_log_open(&o->log, o->live))
        return pupil_refuse(why, "not enough memory");
    frame_options_release_begun();
    if (options->report)
        return replay_report_open(&o->report, options, &of_sink, o->source->frames * options->hold, why);
    return 0;
}

/* A reopened camera may have another size; what was written until then is kept. */
static int is_other_size(const session_outputs *o, const pupil_image *display, pupil_why *why)
{
    if (!o->live || !o->pictures.count || (display->width == o->width && display->height == o->height))
        return 0;
    pupil_refuse(why, "%s: its frames have %u x %u pixels now; the outputs are of %u x %u, and end here",
                 o->options->inputs[0], display->width, display->height, o->width, o->height);
    return 1;
}

/* Drops the picture that failed. */
static void drop_picture(session_outputs *o)
{
    frame_options *options = o->options;
    const char *path = o->pictures.path[o->pictures.failed];
    size_t kept = 0;
    for (size_t i = 0; i < options->out_count; i++)
        if (options->out[i] != path)
            options->out[kept++] = options->out[i];
    options->out_count = kept;
    pictures_drop(&o->pictures);
}

static void drop_stats(session_outputs *o)
{
    pupil_stats_file_discard(o->stats_file);
    o->stats_file = NULL;
    o->options->stats = NULL;
}

/* A failed output of a live run is dropped. */
static int picture_failed(session_outputs *o)
{
    if (!o->live)
        return -1;
    const int ended = interrupt_came() || pictures_reader_gone(&o->pictures);
    drop_picture(o);
    return ended ? 1 : -1;
}

static int stats_failed(session_outputs *o)
{
    if (!o->live)
        return -1;
    const int ended = interrupt_came() || pupil_stats_reader_gone(o->stats_file);
    drop_stats(o);
    return ended ? 1 : -1;
}

int session_outputs_write(session_outputs *o, const pupil_frame *frame, const frame_pipeline *p,
                          const pupil_image *shown, frame_log_entry *entry, pupil_why *why)
{
    const pupil_image_const display = pupil_image_as_const(*shown);
    if (record_frame(o, frame, why) || (!o->is_open && open_all(o, frame, shown, why)) || is_other_size(o, shown, why))
        return -1;
    const double began_s = progress_now_s();
    if (pictures_write(&o->pictures, &display, &frame->info, frame->name, why))
        return picture_failed(o);
    entry->write_us = (progress_now_s() - began_s) * 1e6;
    if (o->stats_file && pupil_stats_file_write(o->stats_file, entry, why))
        return stats_failed(o);
    if (frame_log_add(&o->log, entry))
        return pupil_refuse(why, "not enough memory");
    if (o->report && replay_report_frame(o->report, frame, &p->curve, &display, &p->stats, entry, why))
        return -1;
    o->frames++;
    return 0;
}

/* --- the end --- */

typedef int finish_part(session_outputs *o, pupil_why *why);

static int finish_recording(session_outputs *o, pupil_why *why)
{
    pupil_recorder_counts counts;
    if (!o->recorder)
        return 0;
    pupil_recorder_get_counts(o->recorder, &counts);
    o->not_recorded = counts.lost;
    const int failed = pupil_recorder_close(o->recorder, why);
    o->recorder = NULL;
    return failed;
}

static int finish_plot(session_outputs *o, pupil_why *why)
{
    const char *path = o->options->plot;
    if (!path || !o->log.count)
        return 0;
    if (pupil_plot_write(path, o->options->overwrite, o->log.entry, o->log.count, o->options->inputs[0], why)) {
        o->options->plot = NULL;
        return -1;
    }
    o->finished++;
    return 0;
}

static int finish_report(session_outputs *o, pupil_why *why)
{
    replay_report *report = o->report;
    if (!report)
        return 0;
    o->report = NULL;
    if (replay_report_finish(report, o->log.entry, o->log.count, o->summary, sizeof o->summary, why))
        return -1;
    o->finished++;
    return 0;
}

static int finish_stats(session_outputs *o, pupil_why *why)
{
    pupil_stats_file *file = o->stats_file;
    if (!file)
        return 0;
    o->stats_file = NULL;
    if (pupil_stats_file_finish(file, why)) {
        o->options->stats = NULL;
        return -1;
    }
    o->finished++;
    return 0;
}

/* In a live run, and after Ctrl-C, pictures after a failed one are finished all the same. */
static int finish_pictures(session_outputs *o, pupil_why *why)
{
    const int keep = o->live || o->is_cut;
    pupil_why unused;
    int failed = 0;
    while (o->pictures.count && !(keep && interrupt_again())) {
        const size_t count = o->pictures.count;
        const int fault = pictures_finish(&o->pictures, failed ? &unused : why);
        o->finished += count - o->pictures.count;
        if (fault && !keep)
            return -1;
        if (fault)
            drop_picture(o);
        failed |= fault;
    }
    return failed;
}

/* The outputs most likely to fail go first, when nothing is in its place yet. */
static int finish_files(session_outputs *o, pupil_why *why)
{
    static finish_part *const part[] = {finish_plot, finish_report, finish_stats, finish_pictures};
    for (size_t i = 0; i < sizeof part / sizeof part[0]; i++)
        if (interrupt_came() || part[i](o, why))
            return -1;
    return 0;
}

/* After Ctrl-C: finishes with the complete frames. Outputs about a whole run are not made. */
static int finish_cut(session_outputs *o, pupil_why *why)
{
    frame_options *options = o->options;
    o->is_cut = 1;
    options->plot = options->report = NULL;
    const int no_stats = finish_stats(o, why);
    return finish_pictures(o, why) || no_stats ? -1 : 0;
}

/* What cannot be made again goes first. */
static int finish_live(session_outputs *o, pupil_why *why)
{
    static finish_part *const part[] = {finish_recording, finish_pictures, finish_stats, finish_plot};
    pupil_why unused;
    int failed = 0;
    if (!o->frames && o->is_open) {
        pictures_discard(&o->pictures);
        drop_stats(o);
        o->options->out_count = 0;
        o->options->plot = NULL;
    }
    for (size_t i = 0; i < sizeof part / sizeof part[0]; i++)
        if (i == 0 || !interrupt_again())
            failed |= part[i](o, failed ? &unused : why);
    return failed;
}

int session_outputs_finish(session_outputs *o, pupil_why *why)
{
    if (!o->options) /* not begun */
        return 0;
    if (o->live)
        return finish_live(o, why);
    if (!interrupt_came() && finish_files(o, why) == 0)
        return 0;
    return interrupt_came() && o->frames ? finish_cut(o, why) : -1;
}

void session_outputs_discard(session_outputs *o)
{
    pictures_discard(&o->pictures);
    pupil_stats_file_discard(o->stats_file);
    replay_report_discard(o->report);
    frame_log_close(&o->log);
}

void session_outputs_name(const session_outputs *o)
{
    const frame_options *options = o->options;
    const char *const others[] = {options->stats, options->plot, options->record};
    for (size_t i = 0; i < options->out_count; i++)
        report_name(stderr, "; ", options->out[i], "");
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (others[i])
            report_name(stderr, "; ", others[i], "");
    if (options->report)
        report_name(stderr, "; ", options->report, "/index.html");
    if (o->held_sound)
        fprintf(stderr, "; without sound: --hold changes the pace");
    fputs(o->pictures.silent, stderr);
}
