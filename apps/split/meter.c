/* pupil meter: the statistics of some frames. */
#include <string.h>

#include "common/interrupt.h"
#include "common/report_error.h"
#include "frame/pipeline.h"
#include "options/commands.h"
#include "refuse.h"
#include "split_input.h"

typedef struct metering {
    split_options options;
    split_input input;
    split_file part;
    split_frame frame;
    frame_pipeline pipeline;
    progress progress;
} metering;

static int begin(metering *m, pupil_why *why)
{
    frame_options *o = &m->options.frames;
    const char *fault;
    if (pupil_config_check(&o->config, &fault))
        return pupil_refuse(why, "settings: %s", fault);
    if (split_input_open(&m->input, &m->options, NULL, why))
        return -1;
    o->config.primaries = m->input.source->primaries;
    split_header *h = &m->part.header;
    memcpy(h->kind, SPLIT_PART, sizeof SPLIT_PART);
    split_input_describe(&m->input, h);
    h->first = m->options.first;
    h->dither = o->dither;
    h->config = o->config;
    pupil_config config = o->config;
    config.histogram = 1; /* for any settings of pupil adapt */
    if (frame_pipeline_open(&m->pipeline, &config, o->threads))
        return pupil_refuse(why, "not enough memory");
    return split_file_create(&m->part, m->options.out, o->overwrite, why);
}

static int run(metering *m, pupil_why *why)
{
    pupil_frame frame;
    int got;
    while ((got = split_input_next(&m->input, &frame, why)) > 0) {
        split_frame *f = &m->frame;
        report_notice(&m->progress, "pupil meter", frame.notice);
        f->info = frame.info;
        f->pixels = split_pixels(&frame.image);
        snprintf(f->name, sizeof f->name, "%s", frame.name);
        frame_pipeline_look_at(&m->pipeline, &frame);
        const int failed = cpu_engine_ops.meter(m->pipeline.cpu, &m->pipeline.pupil, &frame, &f->is.stats, why) ||
                           split_file_write(&m->part, f, why);
        split_input_done(&m->input, &frame);
        if (failed)
            return -1;
        split_show(&m->progress, m->input.number);
    }
    m->part.header.is_last = (uint32_t)m->input.is_at_end;
    return got < 0 || interrupt_came() ? -1 : split_file_finish(&m->part, why);
}

int meter_main(int argc, char **argv)
{
    static metering m;
    pupil_why why = {0};
    const int parsed = meter_options_parse(&m.options, argc, argv, &why);
    if (parsed == OPTIONS_HELP)
        return EXIT_DONE;
    if (parsed == OPTIONS_USAGE || split_options_check_paths(&m.options, &why)) {
        report_error("pupil meter", &why, "");
        return EXIT_USAGE;
    }
    interrupt_watch();
    progress_begin(&m.progress, m.options.frames.quiet, 0);
    const int failed = begin(&m, &why) || run(&m, &why);
    progress_clear(&m.progress);
    if (!failed && !m.options.frames.quiet) {
        split_tell("metered", m.part.frames, m.progress.began_s);
        report_name(stderr, "; ", m.options.out, "\n");
    }
    split_file_close(&m.part);
    split_input_close(&m.input);
    frame_pipeline_close(&m.pipeline);
    return split_end("pupil meter", failed, &why);
}
