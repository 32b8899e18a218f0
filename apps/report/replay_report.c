#include "replay_report.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/progress.h"
#include "file/file_sink.h"
#include "output/plot.h"
#include "refuse.h"
#include "report.h"
#include "verify.h"

enum { MOST_ROWS = 24, ROW_TEXT = 96 };

struct replay_report {
    pupil_report *page;
    const frame_options *options;
    pupil_sink *video; /* NULL: none, or given up */
    pupil_why note;
    pupil_t mapper; /* maps a frame at the exposure of the first, to compare with */
    pupil_curve first;
    unsigned char *fixed; /* RGB8 */
    size_t fixed_bytes;
    void *copy; /* of a frame, to time a memcpy */
    size_t copy_bytes;
    uint64_t frames;
    uint32_t primaries; /* of the pictures */
    verify_figures figures;
    double process_us, memcpy_us, pixels; /* over the verified frames */
};

int replay_report_open(replay_report **report, const frame_options *options, const pupil_sink_options *video,
                       uint64_t frames, pupil_why *why)
{
    replay_report *r = calloc(1, sizeof *r);
    if (!r)
        return pupil_refuse(why, "not enough memory");
    r->options = options;
    r->primaries = video->primaries;
    if (pupil_report_begin(&r->page, options->report, options->overwrite, options->reset_each, why)) {
        free(r);
        return -1;
    }
    pupil_init(&r->mapper, &options->config);
    if (frames != 1 && !options->reset_each &&
        pupil_file_sink_open(pupil_report_video(r->page), video, &r->video, &r->note))
        r->video = NULL; /* the page says why->text in its note */
    *report = r;
    return 0;
}

static void *room(void *old, size_t *have, size_t bytes)
{
    if (bytes <= *have)
        return old;
    free(old);
    void *fresh = malloc(bytes);
    *have = fresh ? bytes : 0;
    return fresh;
}

/* The frame at the exposure of the first one; NULL: not possible. */
static const pupil_image_const *map_fixed(replay_report *r, const pupil_image_const *in, pupil_image_const *fixed)
{
    size_t row = (size_t)in->width * 3;
    r->fixed = room(r->fixed, &r->fixed_bytes, row * in->height);
    if (!r->fixed)
        return NULL;
    pupil_image out = {.data = r->fixed,
                       .stride_bytes = (ptrdiff_t)row,
                       .width = in->width,
                       .height = in->height,
                       .pixel = PUPIL_PIXEL_RGB8};
    if (pupil_map_rows(&r->mapper, &r->first, in, &out))
        return NULL;
    *fixed = pupil_image_as_const(out);
    return fixed;
}

/* Microseconds that it takes to copy the frame's pixels, row by row. */
static double time_memcpy(replay_report *r, const pupil_image_const *in)
{
    size_t row = in->width * pupil_pixel_bytes(in->pixel);
    r->copy = room(r->copy, &r->copy_bytes, row * in->height);
    if (!r->copy)
        return 0.0;
    memset(r->copy, 0, row * in->height); /* no page faults while the clock runs */
    double began_s = progress_now_s();
    for (uint32_t y = 0; y < in->height; y++)
        memcpy((unsigned char *)r->copy + y * row, pupil_image_rows(*in, y, 1).data, row);
    return (progress_now_s() - began_s) * 1e6;
}

static void verify(replay_report *r, const pupil_image_const *in, const pupil_curve *curve,
                   const pupil_image_const *rgb8, const pupil_stats *stats, const frame_log_entry *record)
{
    verify_frame(&r->figures, &r->options->config, in, curve, rgb8, stats);
    r->memcpy_us += time_memcpy(r, in);
    r->process_us += record->process_us;
    r->pixels += (double)in->width * in->height;
}

int replay_report_frame(replay_report *r, const pupil_frame *frame, const pupil_curve *curve,
                        const pupil_image_const *rgb8, const pupil_stats *stats, const frame_log_entry *record,
                        pupil_why *why)
{
    pupil_image_const fixed_image;
    const pupil_image_const *fixed = NULL;
    uint64_t n = r->frames++;
    if (n == 0)
        r->first = *curve;
    if (!r->options->reset_each && pupil_report_wants(r->page))
        fixed = map_fixed(r, &frame->image, &fixed_image);
    if (r->options->reset_each || (n & (n + 1)) == 0) /* unrelated pictures, or 0, 1, 3, 7 ...: a few frames of any
                                                       * run */
        verify(r, &frame->image, curve, rgb8, stats, record);
    if (r->video && pupil_sink_write(r->video, rgb8, &frame->info, &r->note)) {
        pupil_sink_discard(r->video);
        r->video = NULL;
    }
    return pupil_report_frame(r->page, rgb8, fixed, record, why);
}

/* --- the page's tables --- */

typedef struct table {
    pupil_report_row row[MOST_ROWS];
    char text[MOST_ROWS][ROW_TEXT];
    size_t count;
} table;

__attribute__((format(printf, 4, 5))) static void put(table *t, const char *label, const char *unit, const char *format,
                                                      ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(t->text[t->count], ROW_TEXT, format, arguments);
    va_end(arguments);
    t->row[t->count] = (pupil_report_row){label, t->text[t->count], unit, NULL};
    t->count++;
}

static void put_settings(table *t, const frame_options *o)
{
    static const char *const transfers[] = {"sRGB", "gamma 2.2", "linear"};
    const pupil_config *c = &o->config;
    if (c->law == PUPIL_LAW_SECONDS) {
        put(t, "time constant toward light", "s", "%g", c->tau_light_s);
        put(t, "time constant toward dark", "s", "%g", c->tau_dark_s);
    } else {
        put(t, "formula", NULL, "%u", c->law - PUPIL_LAW_ARITHMETIC_SCALE + 1);
        put(t, "weight of a frame", NULL, "%g", c->frame_weight);
    }
    put(t, "key", NULL, "%g", c->key);
    put(t, "compensation", "EV", "%g", c->ev_compensation);
    put(t, "metering", NULL, "%s", o->metering);
    if (c->trim_low > 0.0f || c->trim_high < 1.0f)
        put(t, "trimmed to", "%", "%g to %g", 100.0 * (double)c->trim_low, 100.0 * (double)c->trim_high);
    if (c->meter_rows > 1)
        put(t, "metered", NULL, "one of each %u rows", c->meter_rows);
    put(t, "white point", NULL, "%s", o->white);
    put(t, "transfer", NULL, "%s", transfers[c->transfer]);
    put(t, "order", NULL, "%s", c->order == PUPIL_ORDER_FUSED ? "fused: one pass, one frame late" : "exact");
    if (c->lock)
        put(t, "locked", NULL, "at the first frame");
    if (o->reset_each)
        put(t, "adaptation", NULL, "each frame by itself");
}

static void put_figures(table *t, const replay_report *r)
{
    const verify_figures *f = &r->figures;
    double ns = r->process_us * 1e3 / r->pixels;
    put(t, "frames compared with references", NULL, "%u", f->frames);
    if (f->means)
        put(t, "log-average, largest relative error against long double", NULL, "%.2g", f->log_average_error);
    put(t, "display samples, largest distance to double", "codes", "%d", f->code_error);
    put(t, "display samples one code off", "%", "%.2g", 100.0 * (double)f->off / (double)f->samples);
    put(t, "meter, adapt and map, of these frames", "ns / pixel", "%.2f", ns);
    if (r->memcpy_us > 0.0)
        put(t, "the same, as a multiple of a memcpy of the frame", NULL, "%.1f", r->process_us / r->memcpy_us);
}

static void put_summary(const replay_report *r, char *summary, size_t bytes)
{
    const verify_figures *f = &r->figures;
    char mean[64] = "", off[96] = "none of the display's samples differs from a double reference";
    if (f->means)
        snprintf(mean, sizeof mean, "log-average within %.2g of a long-double reference; ", f->log_average_error);
    if (f->off)
        snprintf(off, sizeof off, "%.2g %% of the display's samples differ from a double reference, by %d code at most",
                 100.0 * (double)f->off / (double)f->samples, f->code_error);
    snprintf(summary, bytes, "checked on %u frame%s: %s%s; %.2f ns a pixel, %.1f times a memcpy of the frame\n",
             f->frames, f->frames == 1 ? "" : "s", mean, off, r->process_us * 1e3 / r->pixels,
             r->memcpy_us > 0.0 ? r->process_us / r->memcpy_us : 0.0);
}

static void close_report(replay_report *r)
{
    pupil_sink_discard(r->video);
    free(r->fixed);
    free(r->copy);
    free(r);
}

int replay_report_finish(replay_report *r, const frame_log_entry *records, size_t count, char *summary,
                         size_t summary_bytes, pupil_why *why)
{
    table settings = {.count = 0}, figures = {.count = 0};
    pupil_why plot_note = {""};
    if (r->video && pupil_sink_finish(r->video, &r->note) == PUPIL_SINK_OK)
        r->video = NULL;
    /* without adaptation over time there is nothing to plot */
    if (count > 1 && !r->options->reset_each &&
        pupil_plot_write(pupil_report_plot(r->page), 1, records, count, "", &plot_note))
        pupil_refuse(&r->note, "No plot: %s", plot_note.text);
    if (interrupt_came()) { /* gnuplot gets Ctrl-C, too */
        replay_report_discard(r);
        return -1;
    }
    char title[1024];
    size_t more = r->options->input_count - 1;
    snprintf(title, sizeof title, "%s", r->options->inputs[0]);
    if (more)
        snprintf(title, sizeof title, "%s and %zu more", r->options->inputs[0], more);
    put_settings(&settings, r->options);
    put_figures(&figures, r);
    put_summary(r, summary, summary_bytes);
    pupil_report_page page = {
        .title = title,
        .command = r->options->command,
        .version = pupil_version(),
        .note = *r->note.text ? r->note.text : NULL,
        .records = records,
        .record_count = count,
        .settings = settings.row,
        .setting_count = settings.count,
        .figures = figures.row,
        .figure_count = figures.count,
        .primaries = r->primaries,
        .transfer = r->options->config.transfer,
    };
    int error = pupil_report_finish(r->page, &page, why);
    close_report(r);
    return error;
}

void replay_report_discard(replay_report *r)
{
    if (!r)
        return;
    pupil_sink_discard(r->video);
    r->video = NULL;
    pupil_report_discard(r->page);
    close_report(r);
}
