#include "linear_sink.h"

#include "file/common/pending.h"
#include "sink_common.h"

#include "refuse.h"
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef int write_picture(FILE *file, const pupil_image_const *image);

typedef struct linear_sink {
    pupil_sink sink;
    pupil_sink_options options;
    pupil_pending pending;
    write_picture *write;
    uint64_t frames;
    size_t name_bytes;
    char *name; /* of a folder: room for the path of a frame */
} linear_sink;

static const struct {
    const char *extension;
    write_picture *write;
} kinds[] = {{".exr", pupil_write_exr}, {".hdr", pupil_write_hdr}, {".pfm", pupil_write_pfm}};

/* How a picture is written; NULL: no linear kind. */
static write_picture *kind_of(const char *path, int *single)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    *single = dot && dot != name && strcmp(name, "..") != 0;
    if (!*single)
        return *path && strcmp(path, "-") != 0 ? pupil_write_exr : NULL;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (strcasecmp(dot, kinds[i].extension) == 0)
            return kinds[i].write;
    return NULL;
}

int pupil_is_linear_path(const char *path, int *single)
{
    return kind_of(path, single) != NULL;
}

static int linear_write(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info, pupil_why *why)
{
    linear_sink *l = (linear_sink *)sink;
    const char *path = l->pending.temporary, *shown = l->pending.path;
    if (!l->pending.is_folder && l->frames)
        return pupil_refuse(why, "%s: one picture was asked for but there are more frames; name a folder", shown);
    if (image->pixel != PUPIL_PIXEL_RGB32F || image->width != l->options.width || image->height != l->options.height)
        return pupil_refuse(why, "%s: takes linear RGB float frames of %ux%u, all of one size", shown, l->options.width,
                            l->options.height);
    if (l->pending.is_folder) {
        snprintf(l->name, l->name_bytes, "%s/frame_%06" PRIu64 ".exr", l->pending.temporary, info->sequence);
        path = l->name;
    }
    FILE *file = fopen(path, "wb");
    int failed = !file || l->write(file, image), error = errno;
    if (file && fclose(file) != 0 && !failed) {
        failed = 1;
        error = errno;
    }
    if (failed)
        return pupil_refuse(why, "%s: cannot be written: %s", shown, strerror(error));
    l->frames++;
    return PUPIL_SINK_OK;
}

static void linear_discard(pupil_sink *sink)
{
    linear_sink *l = (linear_sink *)sink;
    pupil_pending_discard(&l->pending);
    free(l->name);
    free(l);
}

static int linear_finish(pupil_sink *sink, pupil_why *why)
{
    linear_sink *l = (linear_sink *)sink;
    if (!l->frames)
        return pupil_refuse(why, "%s: nothing was written, for there is no frame", l->pending.path);
    if (pupil_pending_commit(&l->pending, why))
        return PUPIL_SINK_FAILED;
    linear_discard(sink); /* after commit it only frees */
    return PUPIL_SINK_OK;
}

static const pupil_sink_ops linear_ops = {linear_write, linear_finish, linear_discard};

int pupil_linear_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    int single;
    write_picture *write = kind_of(path, &single);
    *sink = NULL;
    if (!write)
        return pupil_refuse(why, "%s: a linear output is a .exr, .hdr or .pfm, or a folder of EXR", path);
    linear_sink *l = calloc(1, sizeof *l);
    if (!l)
        return pupil_refuse(why, "%s: out of memory", path);
    l->sink.ops = &linear_ops;
    l->options = *options;
    l->write = write;
    if (single ? pupil_pending_file(&l->pending, path, why)
               : pupil_pending_folder(&l->pending, path, options->overwrite, why)) {
        free(l);
        return PUPIL_SINK_FAILED;
    }
    l->name_bytes = strlen(l->pending.temporary) + 64;
    l->name = malloc(l->name_bytes);
    if (!l->name) {
        linear_discard(&l->sink);
        return pupil_refuse(why, "%s: out of memory", path);
    }
    *sink = &l->sink;
    return PUPIL_SINK_OK;
}
