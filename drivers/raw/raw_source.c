/* Frames without a header, from one file or several. */
#include "raw_source.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file/still/natural_order.h"
#include "max_pixels.h"
#include "refuse.h"

#define DEFAULT_FPS 30.0

typedef struct raw_source {
    pupil_source base;
    pupil_raw_layout layout;
    pupil_paths paths;
    size_t path; /* of paths, the one that is read */
    int fd;      /* of it; -1: not yet opened */
    uint64_t left, sequence;
    int is_cut; /* it has bytes after its last whole frame */
    void *bytes;
    size_t frame_bytes;
    pupil_white_balance colour;
    int has_colour; /* of this file */
} raw_source;

static void raw_close(pupil_source *source)
{
    raw_source *r = (raw_source *)source;
    if (r->fd >= 0)
        close(r->fd);
    pupil_paths_free(&r->paths);
    free(r->bytes);
    free(r);
}

/* How many whole frames a file has, and whether there is a piece of another; -1 and a sentence. */
static int count_frames(const raw_source *r, const char *path, const struct stat *is, uint64_t *frames, int *is_cut,
                        pupil_why *why)
{
    const pupil_raw_layout *l = &r->layout;
    if (!S_ISREG(is->st_mode))
        return pupil_refuse(why, "%s: is not a regular file; a file of raw frames is needed here", path);
    const uint64_t size = (uint64_t)is->st_size, content = size < l->skip_bytes ? 0 : size - l->skip_bytes;
    *frames = content / r->frame_bytes;
    *is_cut = content % r->frame_bytes != 0;
    if (!*frames)
        return pupil_refuse(why, "%s: has %llu bytes; a frame of %ux%u %s has %zu%s", path, (unsigned long long)size,
                            l->width, l->height, l->format, r->frame_bytes,
                            l->skip_bytes ? ", after those that are skipped" : "");
    return 0;
}

static int open_file(raw_source *r, pupil_why *why)
{
    const char *path = r->paths.path[r->path];
    struct stat is;
    r->fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (r->fd < 0 || fstat(r->fd, &is) != 0)
        return pupil_refuse(why, "%s: cannot be opened: %s", path, strerror(errno));
    if (count_frames(r, path, &is, &r->left, &r->is_cut, why))
        return -1;
    if (lseek(r->fd, (off_t)r->layout.skip_bytes, SEEK_SET) < 0)
        return pupil_refuse(why, "%s: cannot be read: %s", path, strerror(errno));
    r->has_colour = 0;
    return 0;
}

static void next_file(raw_source *r)
{
    if (r->fd >= 0)
        close(r->fd);
    r->fd = -1;
    r->path++;
}

static int read_frame(raw_source *r, pupil_why *why)
{
    const char *path = r->paths.path[r->path];
    for (size_t got = 0; got < r->frame_bytes;) {
        const ssize_t n = read(r->fd, (uint8_t *)r->bytes + got, r->frame_bytes - got);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return pupil_refuse(why, "%s: cannot be read: %s", path, n < 0 ? strerror(errno) : "it became shorter");
        got += (size_t)n;
    }
    return 0;
}

/* The first frame of a file is balanced by itself, because a still has no other. */
static int colour_frame(raw_source *r, pupil_frame *frame, pupil_why *why)
{
    if (!r->has_colour) {
        if (pupil_white_balance_begin(&r->colour, &r->layout.colour, &r->layout.coding, r->layout.pixel, NULL, why))
            return -1;
        frame->image.coding = &r->colour.coding;
        pupil_white_balance_frame(&r->colour, &frame->image, &frame->info);
    }
    r->has_colour = 1;
    frame->image.coding = &r->colour.coding;
    return 0;
}

static int raw_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    raw_source *r = (raw_source *)source;
    while (r->path < r->paths.count) {
        const uint64_t index = r->sequence;
        if (r->fd < 0 && open_file(r, why)) {
            next_file(r);
            r->sequence++;
            return PUPIL_SOURCE_DAMAGED;
        }
        if (!r->left && r->is_cut) {
            pupil_refuse(why, "%s: ends within a frame; is its size right? A frame of %ux%u %s has %zu bytes",
                         r->paths.path[r->path], r->layout.width, r->layout.height, r->layout.format, r->frame_bytes);
            next_file(r);
            r->sequence++;
            return PUPIL_SOURCE_DAMAGED;
        }
        if (!r->left) {
            next_file(r);
            continue;
        }
        r->left--;
        r->sequence++;
        if (read_frame(r, why))
            return PUPIL_SOURCE_DAMAGED;
        memset(frame, 0, sizeof *frame);
        pupil_raw_layout_image(&r->layout, r->bytes, &frame->image);
        frame->info.timestamp_ns = llround((double)index * 1e9 / source->fps);
        frame->info.sequence = index;
        frame->name = r->paths.path[r->path];
        return colour_frame(r, frame, why) ? PUPIL_SOURCE_FAILED : PUPIL_SOURCE_FRAME;
    }
    return PUPIL_SOURCE_END;
}

static void raw_done(pupil_source *source, pupil_frame *frame)
{
    raw_source *r = (raw_source *)source;
    pupil_white_balance_frame(&r->colour, &frame->image, &frame->info);
}

static const pupil_source_ops raw_ops = {raw_next, raw_done, raw_close};

static int find_files(raw_source *r, pupil_why *why)
{
    struct stat is;
    const char *file = r->layout.file;
    if (stat(file, &is) != 0)
        return pupil_refuse(why, "%s: cannot be opened: %s", file, strerror(errno));
    if (S_ISDIR(is.st_mode) ? pupil_paths_folder(&r->paths, file, NULL) : pupil_paths_add(&r->paths, file))
        return pupil_refuse(why, "%s: cannot be read: %s", file, strerror(errno));
    if (!r->paths.count)
        return pupil_refuse(why, "%s: the folder is empty", file);
    for (size_t i = 0; i < r->paths.count; i++) {
        uint64_t frames = 0;
        int is_cut;
        pupil_why unused;
        if (stat(r->paths.path[i], &is) == 0 && count_frames(r, r->paths.path[i], &is, &frames, &is_cut, &unused) == 0)
            r->base.frames += frames;
    }
    r->base.is_named = S_ISDIR(is.st_mode) || r->paths.count == r->base.frames;
    return 0;
}

/* What is wrong with the codes and factors, before a file is read. */
static int check_colour(raw_source *r, pupil_why *why)
{
    pupil_why words;
    const char *reason;
    if (!pupil_white_balance_begin(&r->colour, &r->layout.colour, &r->layout.coding, r->layout.pixel, NULL, &words))
        return 0;
    reason = strstr(words.text, ": "); /* what is before it are options of cameras */
    return pupil_refuse(why, "raw:%s: black, white, shift, knees, balance or matrix does not suit %s: %s",
                        r->layout.file, r->layout.format, reason ? reason + 2 : words.text);
}

static int prepare(raw_source *r, const char *text, const pupil_source_options *options, pupil_why *why)
{
    pupil_image_const image;
    if (pupil_raw_layout_read(&r->layout, text, why) ||
        pupil_check_max_pixels(options, r->layout.width, r->layout.height, "raw:", r->layout.file, why))
        return -1;
    r->frame_bytes = pupil_raw_layout_image(&r->layout, NULL, &image);
    r->bytes = malloc(r->frame_bytes);
    if (!r->bytes)
        return pupil_refuse(why, "raw:%s: not enough memory for a frame", r->layout.file);
    return check_colour(r, why) ? -1 : find_files(r, why);
}

int pupil_raw_source_open(const char *text, const pupil_source_options *options, pupil_source **source, pupil_why *why)
{
    raw_source *r = calloc(1, sizeof *r);
    *source = NULL;
    if (!r) {
        pupil_refuse(why, "raw: not enough memory");
        return PUPIL_SOURCE_FAILED;
    }
    r->fd = -1;
    r->base.ops = &raw_ops;
    r->base.obeys = PUPIL_SOURCE_FPS;
    r->base.fps = options && options->fps > 0 ? options->fps : DEFAULT_FPS;
    if (prepare(r, text, options, why)) {
        raw_close(&r->base);
        return PUPIL_SOURCE_FAILED;
    }
    *source = &r->base;
    return 0;
}
