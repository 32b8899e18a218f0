/* One picture in one PNG file. */
#include "png_sinks.h"

#include "file/common/pending.h"
#include "png_write.h"
#include "sink_common.h"

#include "refuse.h"
#include <stdlib.h>

typedef struct png_sink {
    pupil_sink sink;
    pupil_sink_options options;
    pupil_pending pending;
    int written;
} png_sink;

static int png_sink_write(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info,
                          pupil_why *why)
{
    png_sink *p = (png_sink *)sink;
    (void)info;
    if (p->written)
        return pupil_refuse(why,
                            "%s: one picture was asked for but the input has more frames; name a folder or a video",
                            p->pending.path);
    if (pupil_sink_check_image(p->pending.path, &p->options, image, why) ||
        pupil_png_write(p->pending.temporary, p->pending.path, image, why))
        return PUPIL_SINK_FAILED;
    p->written = 1;
    return PUPIL_SINK_OK;
}

static int png_sink_finish(pupil_sink *sink, pupil_why *why)
{
    png_sink *p = (png_sink *)sink;
    if (!p->written)
        return pupil_refuse(why, "%s: nothing was written, for the input has no frame", p->pending.path);
    if (pupil_pending_commit(&p->pending, why))
        return PUPIL_SINK_FAILED;
    free(p);
    return PUPIL_SINK_OK;
}

static void png_sink_discard(pupil_sink *sink)
{
    png_sink *p = (png_sink *)sink;
    pupil_pending_discard(&p->pending);
    free(p);
}

static const pupil_sink_ops png_sink_ops = {png_sink_write, png_sink_finish, png_sink_discard};

int pupil_png_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    png_sink *p;
    *sink = NULL;
    if (pupil_sink_check_options(path, options, why))
        return PUPIL_SINK_FAILED;
    p = calloc(1, sizeof *p);
    if (!p)
        return pupil_refuse(why, "%s: out of memory", path);
    p->sink.ops = &png_sink_ops;
    p->options = *options;
    if (pupil_pending_file(&p->pending, path, why)) {
        free(p);
        return PUPIL_SINK_FAILED;
    }
    *sink = &p->sink;
    return PUPIL_SINK_OK;
}
