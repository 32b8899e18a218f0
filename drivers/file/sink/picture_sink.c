/* Pictures: one in a file, or a folder of frame_NNNNNN.png or .exr. */
#include "picture_sink.h"

#include "file/common/pending.h"
#include "png_write.h"
#include "sink_common.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef int write_linear(FILE *file, const pupil_image_const *image);

typedef struct picture_sink {
    pupil_sink sink;
    pupil_sink_options options;
    pupil_pending pending;
    write_linear *write; /* of linear frames; NULL: display frames, as PNG */
    uint64_t frames;
    size_t name_bytes;
    char *file; /* of a folder's frame: where it is written, and what it is called in sentences; room for both */
    char *name;
} picture_sink;

static int check_image(const picture_sink *s, const pupil_image_const *image, pupil_why *why)
{
    const pupil_sink_options *o = &s->options;
    if (!s->write)
        return pupil_sink_check_image(s->pending.path, o, image, why);
    if (image->pixel != PUPIL_PIXEL_RGB32F || image->width != o->width || image->height != o->height)
        return pupil_refuse(why, "%s: takes linear RGB float frames of %ux%u, all of one size", s->pending.path,
                            o->width, o->height);
    return PUPIL_SINK_OK;
}

static int write_file(write_linear *write, const char *path, const char *name, const pupil_image_const *image,
                      pupil_why *why)
{
    FILE *file = fopen(path, "wbe");
    int failed = !file || write(file, image), error = errno;
    if (file && fclose(file) != 0 && !failed) {
        failed = 1;
        error = errno;
    }
    return failed ? pupil_refuse(why, "%s: cannot be written: %s", name, strerror(error)) : PUPIL_SINK_OK;
}

static int picture_write(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info, pupil_why *why)
{
    picture_sink *s = (picture_sink *)sink;
    const char *path = s->pending.temporary, *name = s->pending.path;
    if (!s->pending.is_folder && s->frames)
        return pupil_refuse(
            why, "%s: one picture was asked for but the input has more frames; name a folder or a video", name);
    if (check_image(s, image, why))
        return PUPIL_SINK_FAILED;
    if (s->pending.is_folder) {
        const uint64_t number = s->write ? info->sequence : s->frames;
        const char *extension = s->write ? "exr" : "png";
        snprintf(s->file, s->name_bytes, "%s/frame_%06" PRIu64 ".%s", path, number, extension);
        snprintf(s->name, s->name_bytes, "%s/frame_%06" PRIu64 ".%s", name, number, extension);
        path = s->file;
        name = s->name;
    }
    if (s->write ? write_file(s->write, path, name, image, why)
                 : pupil_png_write(path, name, image, s->options.primaries, s->options.transfer, why))
        return PUPIL_SINK_FAILED;
    s->frames++;
    return PUPIL_SINK_OK;
}

static void picture_discard(pupil_sink *sink)
{
    picture_sink *s = (picture_sink *)sink;
    pupil_pending_discard(&s->pending);
    free(s->file);
    free(s->name);
    free(s);
}

static int picture_finish(pupil_sink *sink, pupil_why *why)
{
    picture_sink *s = (picture_sink *)sink;
    if (!s->frames)
        return pupil_refuse(why, "%s: nothing was written, for the input has no frame", s->pending.path);
    if (pupil_pending_commit(&s->pending, why))
        return PUPIL_SINK_FAILED;
    picture_discard(sink); /* after commit it only frees */
    return PUPIL_SINK_OK;
}

static const pupil_sink_ops picture_ops = {picture_write, picture_finish, picture_discard};

static int open_pictures(const char *path, int is_folder, write_linear *write, const pupil_sink_options *options,
                         pupil_sink **sink, pupil_why *why)
{
    picture_sink *s = calloc(1, sizeof *s);
    if (!s)
        return pupil_refuse(why, "%s: out of memory", path);
    s->sink.ops = &picture_ops;
    s->options = *options;
    s->write = write;
    if (is_folder ? pupil_pending_folder(&s->pending, path, options->overwrite, why)
                  : pupil_pending_file(&s->pending, path, options->overwrite, why)) {
        free(s);
        return PUPIL_SINK_FAILED;
    }
    s->name_bytes = strlen(s->pending.temporary) + strlen(s->pending.path) + 64;
    s->file = malloc(s->name_bytes);
    s->name = malloc(s->name_bytes);
    if (!s->file || !s->name) {
        picture_discard(&s->sink);
        return pupil_refuse(why, "%s: out of memory", path);
    }
    *sink = &s->sink;
    return PUPIL_SINK_OK;
}

/* --- the kinds --- */

static const struct {
    const char *extension;
    write_linear *write;
} linear_kinds[] = {{".exr", pupil_write_exr}, {".hdr", pupil_write_hdr}, {".pfm", pupil_write_pfm}};

/* How a picture is written; NULL: no linear kind. */
static write_linear *linear_kind_of(const char *path, int *single)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    *single = dot && dot != name && strcmp(name, "..") != 0;
    if (!*single)
        return *path && strcmp(path, "-") != 0 ? pupil_write_exr : NULL;
    for (size_t i = 0; i < sizeof linear_kinds / sizeof linear_kinds[0]; i++)
        if (strcasecmp(dot, linear_kinds[i].extension) == 0)
            return linear_kinds[i].write;
    return NULL;
}

int pupil_is_linear_path(const char *path, int *single)
{
    return linear_kind_of(path, single) != NULL;
}

int pupil_linear_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    int single;
    write_linear *write = linear_kind_of(path, &single);
    *sink = NULL;
    if (!write)
        return pupil_refuse(why, "%s: a linear output is a .exr, .hdr or .pfm, or a folder of EXR", path);
    return open_pictures(path, !single, write, options, sink, why);
}

static int open_png(const char *path, int is_folder, const pupil_sink_options *options, pupil_sink **sink,
                    pupil_why *why)
{
    *sink = NULL;
    if (pupil_sink_check_options(path, options, why))
        return PUPIL_SINK_FAILED;
    return open_pictures(path, is_folder, NULL, options, sink, why);
}

int pupil_png_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    return open_png(path, 0, options, sink, why);
}

int pupil_folder_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    return open_png(path, 1, options, sink, why);
}
