/* pupil map: some frames by the curves of pupil adapt. */
#include <string.h>

#include "common/interrupt.h"
#include "common/report_error.h"
#include "frame/pipeline.h"
#include "options/commands.h"
#include "output/pictures.h"
#include "refuse.h"
#include "split_input.h"

typedef struct mapping {
    split_options options;
    split_input input;
    split_file curves;
    split_frame frame;
    frame_pipeline pipeline;
    pictures pictures;
    progress progress;
    uint64_t frames;
    int is_open;
} mapping;

/* The input must be that of the curves. */
static int check_input(const mapping *m, pupil_why *why)
{
    const split_header *of = &m->curves.header;
    split_header here = {0};
    split_input_describe(&m->input, &here);
    if (of->input_names != here.input_names || of->input_count != here.input_count)
        return pupil_refuse(why, "%s: has the curves of %s (inputs: %llu), not of %s (inputs: %llu)", m->options.curves,
                            of->input, (unsigned long long)of->input_count, here.input,
                            (unsigned long long)here.input_count);
    if (of->input_bytes != here.input_bytes)
        return pupil_refuse(why, "%s: has the curves of %s with %llu bytes; here it has %llu: meter it again",
                            m->options.curves, of->input, (unsigned long long)of->input_bytes,
                            (unsigned long long)here.input_bytes);
    if (of->fps != here.fps)
        return pupil_refuse(why, "%s: has curves for %.6g frames a second, not for %.6g (--fps)", m->options.curves,
                            of->fps, here.fps);
    return 0;
}

static int begin(mapping *m, pupil_why *why)
{
    split_options *o = &m->options;
    if (split_file_open(&m->curves, o->curves, SPLIT_CURVES, why) ||
        split_input_open(&m->input, o, &m->curves.header, why) || check_input(m, why))
        return -1;
    o->frames.config = m->curves.header.config;
    o->frames.dither = m->curves.header.dither;
    if (frame_options_check(&o->frames, 0, 0, why))
        return -1;
    if (frame_pipeline_open(&m->pipeline, &o->frames.config, o->frames.threads))
        return pupil_refuse(why, "not enough memory");
    for (uint64_t i = 0; i < o->first && i < m->curves.header.count; i++)
        if (split_file_read(&m->curves, &m->frame, why))
            return -1;
    return 0;
}

static int open_pictures(mapping *m, const pupil_frame *first, pupil_why *why)
{
    const frame_options *o = &m->options.frames;
    const pupil_source *source = m->input.source;
    const pupil_sink_options of_sink = {.width = first->image.width,
                                        .height = first->image.height,
                                        .fps = source->fps,
                                        .overwrite = o->overwrite,
                                        .primaries = pictures_primaries(&o->config),
                                        .transfer = o->config.transfer,
                                        .keep_time = !(source->obeys & PUPIL_SOURCE_FPS),
                                        .gap_most_s = PUPIL_SINK_VIDEO_GAP_S,
                                        .aspect = {source->pixel_aspect[0], source->pixel_aspect[1]}};
    m->is_open = 1;
    for (size_t i = 0; i < o->out_count; i++)
        if (pictures_open(&m->pictures, o->out[i], &of_sink, why))
            return -1;
    return 0;
}

static int show(mapping *m, const pupil_frame *frame, pupil_why *why)
{
    const unsigned long long number = m->input.number - 1;
    if (number >= m->curves.header.count)
        return pupil_refuse(why, "%s: has %llu curves; there is none for frame %llu", m->options.curves,
                            (unsigned long long)m->curves.header.count, number);
    if (split_file_read(&m->curves, &m->frame, why))
        return -1;
    if (m->frame.info.timestamp_ns != frame->info.timestamp_ns)
        return pupil_refuse(why, "%s: frame %llu is at %.9f s here, and was metered at %.9f s: another input",
                            m->options.curves, number, (double)frame->info.timestamp_ns * 1e-9,
                            (double)m->frame.info.timestamp_ns * 1e-9);
    if (m->frame.pixels != split_pixels(&frame->image))
        return pupil_refuse(why, "%s: frame %llu, %s, is not the picture that was metered: meter the input again",
                            m->options.curves, number, frame->name);
    m->pipeline.curve = m->frame.is.curve;
    m->pipeline.curve.dither = m->options.frames.config.dither;
    m->pipeline.info = frame->info;
    if (frame_pipeline_map(&m->pipeline, frame, 1, why) || (!m->is_open && open_pictures(m, frame, why)))
        return -1;
    const pupil_image_const display = pupil_image_as_const(m->pipeline.display);
    m->frames++;
    return pictures_write(&m->pictures, &display, &frame->info, frame->name, why);
}

static int run(mapping *m, pupil_why *why)
{
    pupil_frame frame;
    int got;
    while ((got = split_input_next(&m->input, &frame, why)) > 0) {
        report_notice(&m->progress, "pupil map", frame.notice);
        const int failed = show(m, &frame, why);
        split_input_done(&m->input, &frame);
        if (failed)
            return -1;
        split_show(&m->progress, m->input.number);
    }
    if (got < 0 || interrupt_came())
        return -1;
    if (!m->frames)
        return pupil_refuse(why, "%s: has no frame in --range: it ends at %llu", m->options.frames.inputs[0],
                            (unsigned long long)m->input.number);
    return pictures_finish(&m->pictures, why);
}

int map_main(int argc, char **argv)
{
    static mapping m;
    pupil_why why = {0};
    const int parsed = map_options_parse(&m.options, argc, argv, &why);
    if (parsed == OPTIONS_HELP)
        return EXIT_DONE;
    if (parsed == OPTIONS_USAGE || split_options_check_paths(&m.options, &why)) {
        report_error("pupil map", &why, "");
        return EXIT_USAGE;
    }
    interrupt_watch();
    progress_begin(&m.progress, m.options.frames.quiet, 0);
    const int failed = begin(&m, &why) || run(&m, &why);
    progress_clear(&m.progress);
    if (!failed && !m.options.frames.quiet) {
        split_tell("mapped", m.frames, m.progress.began_s);
        for (size_t i = 0; i < m.options.frames.out_count; i++)
            report_name(stderr, "; ", m.options.frames.out[i], "");
        fputc('\n', stderr);
    }
    if (failed)
        pictures_discard(&m.pictures);
    split_file_close(&m.curves);
    split_input_close(&m.input);
    frame_pipeline_close(&m.pipeline);
    return split_end("pupil map", failed, &why);
}
