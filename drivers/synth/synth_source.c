/* drivers/synth/synth_source.c: the rendered scene as a source of frames. */
#include "synth/synth_source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "refuse.h"
#include "synth/scene_source.h"
#include "synth/walk.h"

#define DEFAULT_FPS    30.0
#define DEFAULT_WIDTH  320u
#define DEFAULT_HEIGHT 180u
#define DEFAULT_FRAMES 300u
#define LONGEST_S      3.2e9 /* a hundred years; 2^63 ns are 292 */

typedef struct synth_source {
    pupil_source source;
    uint64_t next;
    uint32_t width, height;
    float *rgb;
    char name[48];
} synth_source;

static int synth_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    synth_source *s = (synth_source *)source;
    pupil_walk_view view;
    (void)why;
    if (s->next >= source->frames)
        return PUPIL_SOURCE_END;

    pupil_walk_view_at(s->next, source->frames, &view);
    pupil_walk_render(&view, s->width, s->height, s->rgb);
    snprintf(s->name, sizeof s->name, "synth:walk frame %llu", (unsigned long long)s->next);

    memset(frame, 0, sizeof *frame);
    frame->image.data = s->rgb;
    frame->image.stride_bytes = (ptrdiff_t)(s->width * 3 * sizeof(float));
    frame->image.width = s->width;
    frame->image.height = s->height;
    frame->image.pixel = PUPIL_PIXEL_RGB32F;
    frame->info.timestamp_ns = (int64_t)((double)s->next * 1e9 / source->fps + 0.5);
    frame->info.sequence = s->next;
    frame->name = s->name;
    s->next++;
    return PUPIL_SOURCE_FRAME;
}

static void synth_done(pupil_source *source, pupil_frame *frame)
{
    (void)source;
    (void)frame;
}

static void synth_close(pupil_source *source)
{
    free(((synth_source *)source)->rgb);
    free(source);
}

static const pupil_source_ops synth_ops = {synth_next, synth_done, synth_close};

/* What is wrong with the options, as a sentence; 0 if nothing is. */
static int refuse(const char *name, double fps, uint64_t first, uint64_t frames, uint32_t width, uint32_t height,
                  pupil_why *why)
{
    if (!(fps > 0.0 && fps <= 1e6))
        return pupil_refuse(why, "synth:%s: %g frames a second; it must be above 0 and at most 1000000", name, fps);
    if (width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return pupil_refuse(why, "synth:%s: a size of %lux%lu; at most %ux%u", name, (unsigned long)width,
                            (unsigned long)height, PUPIL_MAX_SIDE_PX, PUPIL_MAX_SIDE_PX);
    if (first)
        return pupil_refuse(why, "synth:%s: begins with frame 0 only", name);
    if ((double)frames / fps > LONGEST_S)
        return pupil_refuse(why, "synth:%s: %llu frames at %g fps last longer than a hundred years", name,
                            (unsigned long long)frames, fps);
    return 0;
}

int pupil_synth_source_open(const char *name, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why)
{
    if (strcmp(name, "walk") != 0)
        return pupil_scene_source_open(name, options, source, why);
    double fps = options->fps != 0.0 ? options->fps : DEFAULT_FPS;
    uint64_t frames = options->frames ? options->frames : DEFAULT_FRAMES;
    uint32_t width = options->width ? options->width : DEFAULT_WIDTH;
    uint32_t height = options->height ? options->height : DEFAULT_HEIGHT;
    if (refuse(name, fps, options->first, frames, width, height, why))
        return PUPIL_SOURCE_FAILED;

    synth_source *s = calloc(1, sizeof *s);
    float *rgb = malloc((size_t)width * height * 3 * sizeof(float));
    if (!s || !rgb) {
        free(s);
        free(rgb);
        pupil_refuse(why, "synth:%s: no memory for frames of %lux%lu pixels", name, (unsigned long)width,
                     (unsigned long)height);
        return PUPIL_SOURCE_FAILED;
    }
    s->source.ops = &synth_ops;
    s->source.fps = fps;
    s->source.frames = frames;
    s->width = width;
    s->height = height;
    s->rgb = rgb;
    *source = &s->source;
    return 0;
}
