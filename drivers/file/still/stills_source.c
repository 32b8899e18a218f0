/* A sequence of stills as a source: the next file is read when the next frame is asked for. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "natural_order.h"
#include "refuse.h"
#include "still.h"
#include "stills_source.h"

#define DEFAULT_FPS 30.0

typedef struct stills_source {
    pupil_source source;
    pupil_paths paths;
    size_t next;
    pupil_still still;
} stills_source;

/* A lost frame keeps its time slot: later frames do not move. */
static int stills_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    stills_source *s = (stills_source *)source;
    size_t index = s->next;
    if (index >= s->paths.count)
        return PUPIL_SOURCE_END;
    s->next++;
    if (pupil_still_load(&s->still, s->paths.path[index], why))
        return PUPIL_SOURCE_DAMAGED;
    memset(frame, 0, sizeof *frame);
    frame->image.data = s->still.pixels;
    frame->image.width = s->still.width;
    frame->image.height = s->still.height;
    frame->image.pixel = s->still.pixel;
    frame->image.stride_bytes = (ptrdiff_t)(s->still.width * pupil_pixel_bytes(s->still.pixel));
    frame->code_light = s->still.code_light;
    frame->info.timestamp_ns = llround((double)index * 1e9 / source->fps);
    frame->info.sequence = index;
    frame->name = s->paths.path[index];
    frame->notice = s->still.notice.text[0] ? s->still.notice.text : NULL;
    memcpy(frame->window, s->still.window, sizeof frame->window);
    return PUPIL_SOURCE_FRAME;
}

static uint64_t stills_skip(pupil_source *source, uint64_t frames)
{
    stills_source *s = (stills_source *)source;
    const uint64_t left = s->paths.count - s->next, skipped = frames < left ? frames : left;
    s->next += (size_t)skipped;
    return skipped;
}

static void stills_done(pupil_source *source, pupil_frame *frame)
{
    (void)source;
    (void)frame;
}

static void stills_close(pupil_source *source)
{
    stills_source *s = (stills_source *)source;
    pupil_paths_free(&s->paths);
    pupil_still_free(&s->still);
    free(s);
}

static const pupil_source_ops stills_ops = {stills_next, stills_done, stills_close};

static int fill(stills_source *s, const char *const *paths, size_t count, pupil_why *why)
{
    if (count == 0)
        return pupil_refuse(why, "no still was named; at least one file is needed");
    for (size_t i = 0; i < count; i++) {
        struct stat status;
        if (stat(paths[i], &status) != 0)
            return pupil_refuse(why, "%s: cannot be opened: %s", paths[i], strerror(errno));
        if (pupil_paths_add(&s->paths, paths[i]))
            return pupil_refuse(why, "no memory for the names of %zu stills", count);
    }
    return 0;
}

int pupil_stills_source_open(const char *const *paths, size_t count, const pupil_source_options *options,
                             pupil_source **source, pupil_why *why)
{
    stills_source *s;
    double fps = options && options->fps != 0 ? options->fps : DEFAULT_FPS;
    if (!(fps > 0 && isfinite(fps))) {
        pupil_refuse(why, "fps is %g; a number above 0 is needed", fps);
        return PUPIL_SOURCE_FAILED;
    }
    s = calloc(1, sizeof *s);
    if (!s) {
        pupil_refuse(why, "no memory for a sequence of stills");
        return PUPIL_SOURCE_FAILED;
    }
    s->source.ops = &stills_ops;
    s->source.fps = fps;
    s->source.frames = count;
    s->source.is_named = 1;
    s->source.skip = stills_skip;
    s->source.obeys = PUPIL_SOURCE_FPS;
    s->still.as_stored = options && options->as_stored;
    s->still.max_pixels = options ? options->max_pixels : 0;
    if (fill(s, paths, count, why)) {
        stills_close(&s->source);
        return PUPIL_SOURCE_FAILED;
    }
    *source = &s->source;
    return 0;
}
