#include "session.h"

#include <stdio.h>
#include <string.h>

#include "common/report_error.h"
#include "output/frame_log_fill.h"
#include "output/plot.h"
#include "refuse.h"

void session_say(session *s, pupil_why *why, const char *end)
{
    progress_clear(&s->progress);
    report_error(s->command, why, end);
}

int session_check(session *s)
{
    const char *fault = "";
    if (pupil_config_check(&s->options->config, &fault))
        return pupil_refuse(&s->why, "settings: %s", fault);
    return s->options->plot && pupil_plot_check(s->options->plot, s->options->overwrite, &s->why) ? -1 : 0;
}

int session_begin(session *s, int live)
{
    s->options->config.primaries = s->source->primaries;
    session_outputs_begin(&s->outputs, s->options, s->source, live);
    if (frame_pipeline_open(&s->pipeline, &s->options->config, s->options->threads))
        return pupil_refuse(&s->why, "not enough memory");
    const double *above = s->options->bloom ? &s->options->bloom_above : NULL;
    if (s->options->veil && frame_pipeline_use_veil(&s->pipeline, &s->options->eye, above))
        return pupil_refuse(&s->why, "not enough memory");
    return 0;
}

static void describe_frames(const session *s, char *text, size_t text_bytes)
{
    const unsigned long long frames = s->frames, too_dark = s->too_dark, out_of_range = s->out_of_range;
    if (too_dark)
        snprintf(text, text_bytes, "; %llu of %llu frames are too dark to be brightened further (--amplification)",
                 too_dark, frames);
    else if (out_of_range)
        snprintf(text, text_bytes, "; in %llu of %llu frames most light is at or below %.2g (--floor), or above 1e9",
                 out_of_range, frames, (double)s->options->config.floor);
}

void session_end(session *s, char *by, size_t by_bytes)
{
    *by = 0;
    session_outputs_discard(&s->outputs);
    if (s->pipeline.frames && (s->options->gles || s->options->view))
        frame_pipeline_describe(&s->pipeline, by, by_bytes);
    describe_frames(s, by + strlen(by), by_bytes - strlen(by));
    frame_pipeline_close(&s->pipeline); /* before its window, whose context it may use */
    view_close(s->view);
    s->view = NULL;
}

int session_goes_on(const session *s)
{
    return !s->ended && (!s->options->most || s->frames < s->options->most);
}

/* --- a frame --- */

/* Shows the pipeline's warning; the run continues. */
static void warn(session *s)
{
    if (*s->pipeline.warning.text)
        session_say(s, &s->pipeline.warning, "; the CPU continues");
    *s->pipeline.warning.text = 0;
}

/* The window opens with the first frame, and then the GPU works in its context. */
static int open_view(session *s, const pupil_frame *first)
{
    const frame_options *o = s->options;
    const view_of of = {
        .options = s->options, .pipeline = &s->pipeline, .fps = s->source->fps, .live = s->outputs.live};
    if (o->view)
        return view_open(&s->view, &of, &first->image, &s->why);
    if (o->gles)
        frame_pipeline_use_gpu(&s->pipeline, o->gles_version, NULL);
    return 0;
}

int session_meter(session *s, const pupil_frame *frame)
{
    if (!s->pipeline.frames && open_view(s, frame))
        return -1;
    warn(s);
    s->metered_s = progress_now_s();
    return frame_pipeline_meter(&s->pipeline, frame, &s->why);
}

int session_map(session *s, const pupil_frame *frame, frame_log_entry *entry)
{
    const int whole = !s->view || session_outputs_want_pixels(s->options); /* otherwise the picture is only measured */
    if (frame_pipeline_map(&s->pipeline, frame, whole, &s->why))
        return -1;
    const double process_us = (progress_now_s() - s->metered_s) * 1e6;
    warn(s);
    *entry = frame_log_fill(&s->pipeline, frame, session_outputs_want_figures(s->options));
    entry->frame = s->frames;
    s->out_of_range +=
        !s->pipeline.own_curve && s->pipeline.stats.code_light == 0.0f && strcmp(entry->reason, "range") == 0;
    s->too_dark += !s->pipeline.own_curve && strcmp(entry->reason, "amplification") == 0;
    entry->process_us = process_us;
    return 0;
}

int session_show(session *s, const pupil_frame *frame, frame_log_entry *entry)
{
    const pupil_image *shown = s->shown ? s->shown : &s->pipeline.display;
    const int written = session_outputs_write(&s->outputs, frame, &s->pipeline, shown, entry, &s->why);
    if (written < 0)
        return -1;
    s->frames++;
    s->ended |= written;
    s->ended |= s->view && view_frame(s->view, frame, entry) == VIEW_QUIT;
    warn(s);
    return 0;
}
