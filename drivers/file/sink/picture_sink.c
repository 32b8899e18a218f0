/* Pictures: one in a file, or a folder of frame_NNNNNN.png or .exr. */
#include "picture_sink.h"

#include "file/common/pending.h"
#include "libav_write.h"
#include "png_write.h"
#include "sink_common.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

typedef int write_linear(FILE *file, const pupil_image_const *image);
typedef int write_display(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                          uint32_t transfer, pupil_why *why);

typedef struct picture_sink {
    pupil_sink sink;
    pupil_sink_options options;
    pupil_pending pending;
    write_linear *write; /* of linear frames; NULL: display frames */
    write_display *display;
    uint64_t frames;
    size_t name_bytes;
    char *file; /* for a frame in a folder: where it is written, and its name in sentences; room for both */
    char *name;
} picture_sink;

static int check_image(const picture_sink *s, const pupil_image_const *image, pupil_why *why)
{
    const pupil_sink_options *o = &s->options;
    if (!s->write && o->named && s->pending.is_folder)
        return PUPIL_SINK_OK;
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

/* The name of the frame's file, without its ending: "shots/a.exr" is "a". */
static void stem_of(const char *path, const char **name, int *length)
{
    const char *slash = strrchr(path, '/');
    *name = slash ? slash + 1 : path;
    const char *dot = strrchr(*name, '.');
    *length = (int)(dot && dot != *name ? (size_t)(dot - *name) : strlen(*name));
}

/* Where a named frame goes: the first of "a.png", "a-1.png" ... that this run has not written. */
static int name_frame(picture_sink *s, pupil_why *why)
{
    const char *stem;
    int length;
    stem_of(s->sink.frame_name, &stem, &length);
    if (length > 200)
        return pupil_refuse(why, "%.*s: a name of over 200 bytes", length, stem);
    for (int n = 0; n < 1000; n++) {
        char number[16] = "";
        if (n)
            snprintf(number, sizeof number, "-%d", n);
        snprintf(s->file, s->name_bytes, "%s/%.*s%s.png", s->pending.temporary, length, stem, number);
        snprintf(s->name, s->name_bytes, "%s/%.*s%s.png", s->pending.path, length, stem, number);
        if (access(s->file, F_OK) == 0)
            continue;
        return s->options.overwrite || access(s->name, F_OK) != 0 ? 0 : pupil_pending_keep(s->name, why);
    }
    return pupil_refuse(why, "%.*s: named by over 1000 inputs", length, stem);
}

/* A live folder is put in place with the pictures it has, without the one that failed. */
static void keep_whole(picture_sink *s, const char *failed, pupil_why *why)
{
    pupil_why other = {""};
    if (!s->options.live || !s->pending.is_folder || !s->frames)
        return;
    unlink(failed);
    if (pupil_pending_commit(&s->pending, &other))
        pupil_refuse_add(why, "; %s", other.text);
    else
        pupil_sink_add_kept(s->frames, why);
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
    if (s->pending.is_folder && s->options.named && sink->frame_name) {
        if (name_frame(s, why))
            return PUPIL_SINK_FAILED;
        path = s->file;
        name = s->name;
    } else if (s->pending.is_folder) {
        const uint64_t number = s->write ? info->sequence : s->frames;
        const char *extension = s->write ? "exr" : "png";
        snprintf(s->file, s->name_bytes, "%s/frame_%06" PRIu64 ".%s", path, number, extension);
        snprintf(s->name, s->name_bytes, "%s/frame_%06" PRIu64 ".%s", name, number, extension);
        path = s->file;
        name = s->name;
    }
    if (s->write ? write_file(s->write, path, name, image, why)
                 : s->display(path, name, image, s->options.primaries, s->options.transfer, why)) {
        keep_whole(s, path, why);
        return PUPIL_SINK_FAILED;
    }
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

static int begin(picture_sink *s, const char *path, int is_folder, pupil_why *why)
{
    const int overwrite = s->options.overwrite;
    if (!is_folder)
        return pupil_pending_file(&s->pending, path, overwrite, why);
    return s->options.named && !s->write ? pupil_pending_into(&s->pending, path, overwrite, why)
                                         : pupil_pending_folder(&s->pending, path, overwrite, why);
}

static int open_pictures(const char *path, int is_folder, write_linear *write, const pupil_sink_options *options,
                         pupil_sink **sink, pupil_why *why)
{
    picture_sink *s = calloc(1, sizeof *s);
    if (!s)
        return pupil_refuse(why, "%s: out of memory", path);
    s->sink.ops = &picture_ops;
    s->options = *options;
    s->write = write;
    s->display = pupil_png_write;
    if (begin(s, path, is_folder, why)) {
        free(s);
        return PUPIL_SINK_FAILED;
    }
    s->name_bytes = strlen(s->pending.temporary) + strlen(s->pending.path) + 256;
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

/* The function that writes a picture; NULL: no linear kind. */
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

static int open_as(write_display *display, const char *path, const pupil_sink_options *options, pupil_sink **sink,
                   pupil_why *why)
{
    const int failed = open_png(path, 0, options, sink, why);
    if (!failed)
        ((picture_sink *)*sink)->display = display;
    return failed;
}

int pupil_jpeg_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    return open_as(pupil_jpeg_write, path, options, sink, why);
}

int pupil_tiff_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    return open_as(pupil_tiff_write, path, options, sink, why);
}

int pupil_png_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    return open_png(path, 0, options, sink, why);
}

int pupil_folder_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    return open_png(path, 1, options, sink, why);
}
