/* pupil adapt: from the statistics of all frames, in their order, to a curve for each. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/report_error.h"
#include "frame/pipeline.h"
#include "options/commands.h"
#include "output/frame_log_fill.h"
#include "output/stats_file.h"
#include "refuse.h"
#include "split_input.h"

typedef struct adapting {
    split_options options;
    split_file *part; /* in the order of their frames */
    split_file curves;
    split_frame frame;
    frame_pipeline pipeline; /* its level and curves; it has no pixels */
    pupil_stats_file *stats;
    progress progress;
    uint64_t frames;
    int no_histogram; /* the settings need none */
} adapting;

/* --- the parts --- */

static int by_first(const void *a, const void *b)
{
    const split_header *x = &((const split_file *)a)->header, *y = &((const split_file *)b)->header;
    if (x->first != y->first)
        return x->first < y->first ? -1 : 1;
    return (x->count > y->count) - (x->count < y->count);
}

/* Whether both meter with the same bits. */
static int same_metering(const pupil_config *a, const pupil_config *b)
{
    return a->primaries == b->primaries && memcmp(a->rgb_to_xyz, b->rgb_to_xyz, sizeof a->rgb_to_xyz) == 0 &&
           a->floor == b->floor && a->clip == b->clip && a->meter_rows == b->meter_rows &&
           a->histogram_step == b->histogram_step && a->accuracy == b->accuracy && a->grey_world == b->grey_world &&
           a->output_primaries == b->output_primaries && memcmp(a->weight, b->weight, sizeof a->weight) == 0;
}

/* Whether two parts have the same settings, also those that only adaptation and mapping use. */
static int same_settings(const split_header *a, const split_header *b)
{
    return memcmp(&a->config, &b->config, sizeof a->config) == 0 && a->dither == b->dither;
}

/* In the sorted parts each begins where the one before ends, and all are of one input. */
static int check_part(const split_file *first, const split_file *part, uint64_t expected, pupil_why *why)
{
    const split_header *h = &part->header, *of = &first->header;
    if (h->input_names != of->input_names || h->input_count != of->input_count || h->fps != of->fps)
        return pupil_refuse(
            why, "%s: belongs to another input (%s, inputs: %llu, %.6g frames a second) than %s (%s, %llu, %.6g)",
            part->path, h->input, (unsigned long long)h->input_count, h->fps, first->path, of->input,
            (unsigned long long)of->input_count, of->fps);
    if (h->input_bytes != of->input_bytes)
        return pupil_refuse(why, "%s: %s had %llu bytes when it was made, and %llu when %s was: it has changed",
                            part->path, h->input, (unsigned long long)h->input_bytes,
                            (unsigned long long)of->input_bytes, first->path);
    if (!same_settings(h, of) || h->has_unit != of->has_unit || h->unit_stops != of->unit_stops ||
        h->unit_frame != of->unit_frame)
        return pupil_refuse(why, "%s: was metered with other settings than %s", part->path, first->path);
    if (h->count && h->first > expected)
        return pupil_refuse(why, "frames %llu to %llu are missing: no part has them; %s begins at %llu",
                            (unsigned long long)expected, (unsigned long long)h->first - 1, part->path,
                            (unsigned long long)h->first);
    if (h->count && h->first < expected)
        return pupil_refuse(why, "%s: begins at frame %llu, which another part has, too", part->path,
                            (unsigned long long)h->first);
    return 0;
}

static int open_parts(adapting *a, pupil_why *why)
{
    const size_t count = a->options.word_count;
    uint64_t expected = 0;
    int ends = 0;
    a->part = calloc(count, sizeof *a->part);
    if (!a->part)
        return pupil_refuse(why, "not enough memory");
    for (size_t i = 0; i < count; i++)
        if (split_file_open(&a->part[i], a->options.words[i], SPLIT_PART, why))
            return -1;
    qsort(a->part, count, sizeof *a->part, by_first);
    for (size_t i = 0; i < count; i++) {
        if (check_part(&a->part[0], &a->part[i], expected, why))
            return -1;
        expected += a->part[i].header.count;
        ends |= (int)a->part[i].header.is_last;
    }
    if (!ends)
        return pupil_refuse(why, "frames from %llu on are missing: no part says that %s ends",
                            (unsigned long long)expected, a->part[0].header.input);
    return expected ? 0 : pupil_refuse(why, "%s: has no frames", a->part[0].header.input);
}

/* --- frames --- */

/* As in replay's own metering. */
static int wants_histogram(const pupil_config *config)
{
    static pupil_t pupil;
    static pupil_stats stats;
    static const float grey[3] = {0.18f, 0.18f, 0.18f};
    const pupil_image_const image = pupil_image_const_of(grey, 1, 1, PUPIL_PIXEL_RGB32F);
    pupil_stats_clear(&stats);
    return pupil_init(&pupil, config) == PUPIL_OK && pupil_meter(&pupil, &image, NULL) == PUPIL_OK &&
           pupil_get_stats(&pupil, &stats) == PUPIL_OK && stats.has_histogram;
}

static void leave_histogram_out(pupil_stats *stats)
{
    stats->has_histogram = 0;
    stats->peak = 0.0f;
    memset(stats->bin, 0, sizeof stats->bin);
    memset(stats->peak_bin, 0, sizeof stats->peak_bin);
}

static int begin(adapting *a, pupil_why *why)
{
    const frame_options *o = &a->options.frames;
    const split_header *of = &a->part[0].header;
    const char *fault;
    if (pupil_config_check(&o->config, &fault))
        return pupil_refuse(why, "settings: %s", fault);
    if (!same_metering(&o->config, &of->config))
        return pupil_refuse(
            why, "metering cannot be changed here: --metering, --roi, --floor, --accuracy, --histogram-step and "
                 "--output-primaries are options of pupil meter");
    a->pipeline.config = o->config;
    a->no_histogram = !wants_histogram(&o->config);
    pupil_init(&a->pipeline.pupil, &o->config);
    if (o->stats && pupil_stats_file_open(&a->stats, o->stats, o->overwrite, why))
        return -1;
    if (!a->options.out)
        return 0;
    a->curves.header = *of;
    memcpy(a->curves.header.kind, SPLIT_CURVES, sizeof SPLIT_CURVES);
    a->curves.header.is_last = 1;
    a->curves.header.first = 0;
    a->curves.header.config = o->config;
    if (o->dither)
        a->curves.header.dither = o->dither;
    return split_file_create(&a->curves, a->options.out, o->overwrite, why);
}

/* What frame_pipeline_meter does when the frame has been metered. */
static int adapt(adapting *a, pupil_why *why)
{
    frame_pipeline *p = &a->pipeline;
    p->stats = a->frame.is.stats;
    p->info = a->frame.info;
    if (a->no_histogram)
        leave_histogram_out(&p->stats);
    const int fused =
        p->config.order == PUPIL_ORDER_FUSED && pupil_get_curve(&p->pupil, &p->info, &p->curve) == PUPIL_OK;
    const int error = pupil_adapt(&p->pupil, &p->stats, &p->info);
    if (error)
        return pupil_refuse(why, "%s: %s", a->frame.name, pupil_error_string(error));
    p->has_light = pupil_get_curve(&p->pupil, &p->info, &p->adapted) == PUPIL_OK;
    if (!p->has_light)
        (void)pupil_curve_before_light(&p->pupil, &p->adapted);
    if (!fused)
        p->curve = p->adapted;
    return 0;
}

static int note(adapting *a, pupil_why *why)
{
    const pupil_frame frame = {.info = a->frame.info, .name = a->frame.name};
    const split_header *of = &a->part[0].header;
    if (a->stats) {
        frame_log_entry entry = frame_log_fill(&a->pipeline, &frame, 0);
        entry.frame = a->frames;
        entry.scale = a->frames < of->unit_frame ? entry.scale : ldexp(entry.scale, of->unit_stops);
        if (pupil_stats_file_write(a->stats, &entry, why))
            return -1;
    }
    a->frames++;
    if (!a->options.out)
        return 0;
    a->frame.is.curve = a->pipeline.curve;
    return split_file_write(&a->curves, &a->frame, why);
}

static int run(adapting *a, pupil_why *why)
{
    for (size_t i = 0; i < a->options.word_count; i++)
        for (uint64_t n = 0; n < a->part[i].header.count; n++) {
            if (interrupt_came() || split_file_read(&a->part[i], &a->frame, why) || adapt(a, why) || note(a, why))
                return -1;
            split_show(&a->progress, a->frames);
        }
    if (a->options.out && split_file_finish(&a->curves, why))
        return -1;
    pupil_stats_file *stats = a->stats;
    a->stats = NULL;
    return stats && pupil_stats_file_finish(stats, why) ? -1 : 0;
}

/* The parts have the settings to begin with, and the command line changes them. So it is parsed twice, first as a copy,
 * because parsing reorders its words. */
static int parse(adapting *a, int argc, char **argv, pupil_why *why)
{
    char **copy = malloc(((size_t)argc + 1) * sizeof *copy);
    if (!copy)
        return pupil_refuse(why, "not enough memory");
    memcpy(copy, argv, ((size_t)argc + 1) * sizeof *copy);
    int parsed = adapt_options_parse(&a->options, argc, copy, NULL, why);
    if (parsed == OPTIONS_RUN && open_parts(a, why) == 0)
        parsed = adapt_options_parse(&a->options, argc, argv, &a->part[0].header.config, why);
    free(copy);
    return parsed;
}

static void close_all(adapting *a)
{
    for (size_t i = 0; a->part && i < a->options.word_count; i++)
        split_file_close(&a->part[i]);
    free(a->part);
    split_file_close(&a->curves);
    pupil_stats_file_discard(a->stats);
}

int adapt_main(int argc, char **argv)
{
    static adapting a;
    pupil_why why = {0};
    const int parsed = parse(&a, argc, argv, &why);
    if (parsed == OPTIONS_HELP)
        return EXIT_DONE;
    if (parsed == OPTIONS_USAGE || (!*why.text && split_options_check_paths(&a.options, &why))) {
        report_error("pupil adapt", &why, "");
        return EXIT_USAGE;
    }
    interrupt_watch();
    progress_begin(&a.progress, a.options.frames.quiet, 0);
    const int failed = *why.text || begin(&a, &why) || run(&a, &why);
    progress_clear(&a.progress);
    if (!failed && !a.options.frames.quiet) {
        split_tell("adapted to", a.frames, a.progress.began_s);
        if (a.options.out)
            report_name(stderr, "; ", a.options.out, "");
        if (a.options.frames.stats)
            report_name(stderr, "; ", a.options.frames.stats, "");
        fputc('\n', stderr);
    }
    close_all(&a);
    return split_end("pupil adapt", failed, &why);
}
