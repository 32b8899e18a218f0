/* A folder of PNG files: frame_000000.png, frame_000001.png ... */
#include "png_sinks.h"

#include "file/common/pending.h"
#include "png_write.h"
#include "sink_common.h"

#include "refuse.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct folder_sink {
    pupil_sink sink;
    pupil_sink_options options;
    pupil_pending pending;
    uint64_t frames;
    size_t name_bytes;
    char *file; /* where the frame is written, and what it is called in sentences: room for both, taken at open */
    char *name;
} folder_sink;

static int folder_sink_write(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info,
                             pupil_why *why)
{
    folder_sink *f = (folder_sink *)sink;
    (void)info;
    snprintf(f->file, f->name_bytes, "%s/frame_%06" PRIu64 ".png", f->pending.temporary, f->frames);
    snprintf(f->name, f->name_bytes, "%s/frame_%06" PRIu64 ".png", f->pending.path, f->frames);
    if (pupil_sink_check_image(f->pending.path, &f->options, image, why) ||
        pupil_png_write(f->file, f->name, image, why))
        return PUPIL_SINK_FAILED;
    f->frames++;
    return PUPIL_SINK_OK;
}

static void folder_sink_discard(pupil_sink *sink)
{
    folder_sink *f = (folder_sink *)sink;
    pupil_pending_discard(&f->pending);
    free(f->file);
    free(f->name);
    free(f);
}

static int folder_sink_finish(pupil_sink *sink, pupil_why *why)
{
    folder_sink *f = (folder_sink *)sink;
    if (!f->frames)
        return pupil_refuse(why, "%s: nothing was written, for the input has no frame", f->pending.path);
    if (pupil_pending_commit(&f->pending, why))
        return PUPIL_SINK_FAILED;
    folder_sink_discard(sink); /* after commit it only frees */
    return PUPIL_SINK_OK;
}

static const pupil_sink_ops folder_sink_ops = {folder_sink_write, folder_sink_finish, folder_sink_discard};

int pupil_folder_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    folder_sink *f;
    *sink = NULL;
    if (pupil_sink_check_options(path, options, why))
        return PUPIL_SINK_FAILED;
    f = calloc(1, sizeof *f);
    if (!f)
        return pupil_refuse(why, "%s: out of memory", path);
    f->sink.ops = &folder_sink_ops;
    f->options = *options;
    if (pupil_pending_folder(&f->pending, path, options->overwrite, why)) {
        free(f);
        return PUPIL_SINK_FAILED;
    }
    f->name_bytes = strlen(f->pending.temporary) + strlen(f->pending.path) + 64;
    f->file = malloc(f->name_bytes);
    f->name = malloc(f->name_bytes);
    if (!f->file || !f->name) {
        folder_sink_discard(&f->sink);
        return pupil_refuse(why, "%s: out of memory", path);
    }
    *sink = &f->sink;
    return PUPIL_SINK_OK;
}
