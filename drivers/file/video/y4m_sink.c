/* YUV4MPEG2, 4:4:4, 8 bit, limited range, to a file or to standard output. The format names the range (XCOLORRANGE, as
 * mjpegtools and ffmpeg have it) but not the matrix. So this sink uses the matrix that players assume where none is
 * named; pupil_video_pixels reads such a video with it, too (yuv_rows.h). */
#include "video_sink.h"

#include "file/common/pending.h"
#include "file/sink/sink_common.h"
#include "yuv_rows.h"

#include "refuse.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BUFFER_BYTES 65536u /* a pipe's usual size; holds at least one row of PUPIL_MAX_SIDE_PX samples */

typedef struct y4m_sink {
    pupil_sink sink;
    pupil_sink_options options;
    pupil_pending pending; /* of a file; all zero for standard output */
    int to_stdout, fd;
    uint64_t frames;
    int is_shown;      /* a live file: it is in its place, */
    off_t whole_bytes; /* and this long with its whole frames */
    double due_s;      /* keep_time: the last frame's time in the stream, without gaps, */
    int64_t stamp_ns;  /* and its timestamp */
    uint64_t came;
    size_t filled;
    uint8_t buffer[BUFFER_BYTES];
} y4m_sink;

static const char *y4m_name(const y4m_sink *s)
{
    return s->to_stdout ? "standard output" : s->pending.path;
}

static int y4m_flush(y4m_sink *s, pupil_why *why)
{
    for (size_t sent = 0; sent < s->filled;) {
        const ssize_t n = write(s->fd, s->buffer + sent, s->filled - sent);
        if (n >= 0) {
            sent += (size_t)n;
        } else if (errno == EAGAIN) { /* a program made the pipe non-blocking */
            struct pollfd ready = {.fd = s->fd, .events = POLLOUT};
            if (poll(&ready, 1, -1) < 0)
                return pupil_refuse(why, "%s: cannot be written: %s", y4m_name(s), strerror(errno));
        } else if (errno == EPIPE) {
            return pupil_refuse(why, "%s: the reader is gone", y4m_name(s));
        } else { /* EINTR too: a reader that has stopped must not keep the program from ending */
            return pupil_refuse(why, "%s: cannot be written: %s", y4m_name(s), strerror(errno));
        }
    }
    s->filled = 0;
    return PUPIL_SINK_OK;
}

/* Where to put the next `bytes`, after making room; NULL where that failed. */
static uint8_t *y4m_room(y4m_sink *s, size_t bytes, pupil_why *why)
{
    if (s->filled + bytes > sizeof s->buffer && y4m_flush(s, why))
        return NULL;
    s->filled += bytes;
    return s->buffer + s->filled - bytes;
}

static int y4m_text(y4m_sink *s, const char *text, pupil_why *why)
{
    uint8_t *room = y4m_room(s, strlen(text), why);
    if (!room)
        return PUPIL_SINK_FAILED;
    memcpy(room, text, strlen(text));
    return PUPIL_SINK_OK;
}

static int y4m_header(y4m_sink *s, pupil_why *why)
{
    char text[128];
    const uint32_t *aspect = s->options.aspect;
    int num = 0, den = 1;
    pupil_fps_ratio(s->options.fps, &num, &den);
    snprintf(text, sizeof text, "YUV4MPEG2 W%u H%u F%d:%d Ip A%u:%u C444 XCOLORRANGE=LIMITED\n", s->options.width,
             s->options.height, num, den, aspect[0] ? aspect[0] : 1, aspect[0] ? aspect[1] : 1);
    return y4m_text(s, text, why);
}

/* How often a frame is to be written: up to the nearest tick of the stream's rate, and not at all where that tick has a
 * frame already. */
static uint64_t y4m_times(y4m_sink *s, const pupil_frame_info *info)
{
    const int64_t stamp_ns = info ? info->timestamp_ns : 0;
    const double step_s = ((double)stamp_ns - (double)s->stamp_ns) * 1e-9;
    if (!s->options.keep_time)
        return 1;
    if (s->came++)
        s->due_s += step_s > 0.0 && step_s <= s->options.gap_most_s ? step_s : 1.0 / s->options.fps;
    s->stamp_ns = stamp_ns;
    const uint64_t until = (uint64_t)(s->due_s * s->options.fps + 0.5) + 1;
    return until > s->frames ? until - s->frames : 0;
}

static int y4m_frame(y4m_sink *s, const pupil_image_const *image, pupil_why *why)
{
    const pupil_yuv_matrix matrix = pupil_yuv_matrix_of(image->width, image->height);
    if (y4m_text(s, "FRAME\n", why))
        return PUPIL_SINK_FAILED;
    for (int plane = PUPIL_YUV_Y; plane <= PUPIL_YUV_CR; plane++)
        for (uint32_t y = 0; y < image->height; y++) {
            uint8_t *room = y4m_room(s, image->width, why);
            if (!room)
                return PUPIL_SINK_FAILED;
            pupil_yuv_row(matrix, (pupil_yuv_plane)plane,
                          (const uint8_t *)image->data + (ptrdiff_t)y * image->stride_bytes, image->width, room);
        }
    return y4m_flush(s, why); /* the pipe's reader gets each frame at once */
}

/* Called after a whole frame. The first one gives a live file its name. */
static int y4m_note_whole(y4m_sink *s, pupil_why *why)
{
    if (s->to_stdout || !s->options.live)
        return PUPIL_SINK_OK;
    s->whole_bytes = lseek(s->fd, 0, SEEK_CUR);
    if (!s->is_shown && pupil_pending_show(&s->pending, why))
        return PUPIL_SINK_FAILED;
    s->is_shown = 1;
    return PUPIL_SINK_OK;
}

/* Cuts off the part of a frame that failed. */
static int y4m_keep_whole(y4m_sink *s, pupil_why *why)
{
    s->filled = 0;
    if (s->is_shown && ftruncate(s->fd, s->whole_bytes) == 0 && lseek(s->fd, s->whole_bytes, SEEK_SET) >= 0)
        pupil_sink_add_kept(s->frames, why);
    return PUPIL_SINK_FAILED;
}

static int y4m_write(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info, pupil_why *why)
{
    y4m_sink *s = (y4m_sink *)sink;
    if (pupil_sink_check_image(y4m_name(s), &s->options, image, why))
        return PUPIL_SINK_FAILED;
    if (s->frames == 0 && y4m_header(s, why))
        return PUPIL_SINK_FAILED;
    for (uint64_t times = y4m_times(s, info); times; times--) {
        if (y4m_frame(s, image, why))
            return y4m_keep_whole(s, why);
        s->frames++;
        if (y4m_note_whole(s, why))
            return PUPIL_SINK_FAILED;
    }
    return PUPIL_SINK_OK;
}

static void y4m_discard(pupil_sink *sink)
{
    y4m_sink *s = (y4m_sink *)sink;
    if (!s->to_stdout && s->fd >= 0)
        close(s->fd);
    pupil_pending_discard(&s->pending);
    free(s);
}

static int y4m_finish(pupil_sink *sink, pupil_why *why)
{
    y4m_sink *s = (y4m_sink *)sink;
    if (!s->frames)
        return pupil_refuse(why, "%s: nothing was written, for the input has no frame", y4m_name(s));
    if (!s->to_stdout) {
        const int failed = close(s->fd);
        s->fd = -1;
        if (failed)
            return pupil_refuse(why, "%s: cannot be written: %s", y4m_name(s), strerror(errno));
        if (pupil_pending_commit(&s->pending, why))
            return PUPIL_SINK_FAILED;
    }
    y4m_discard(sink); /* after commit it only frees */
    return PUPIL_SINK_OK;
}

static const pupil_sink_ops y4m_ops = {y4m_write, y4m_finish, y4m_discard};

static int y4m_begin(y4m_sink *s, const char *path, pupil_why *why)
{
    if (s->to_stdout) {
        s->fd = STDOUT_FILENO;
        if (isatty(s->fd))
            return pupil_refuse(why, "standard output: is a terminal, which cannot show YUV4MPEG2; pipe it into a "
                                     "player or redirect it to a file");
        return PUPIL_SINK_OK;
    }
    if (pupil_pending_file(&s->pending, path, s->options.overwrite, why))
        return PUPIL_SINK_FAILED;
    s->fd = fcntl(s->pending.fd, F_DUPFD_CLOEXEC, 0);
    if (s->fd < 0)
        return pupil_refuse(why, "%s: cannot be written: %s", path, strerror(errno));
    return PUPIL_SINK_OK;
}

int pupil_y4m_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    y4m_sink *s;
    *sink = NULL;
    if (pupil_sink_check_options(path, options, why))
        return PUPIL_SINK_FAILED;
    s = calloc(1, sizeof *s);
    if (!s)
        return pupil_refuse(why, "%s: out of memory", path);
    s->sink.ops = &y4m_ops;
    s->options = *options;
    s->to_stdout = strcmp(path, "-") == 0;
    s->fd = -1;
    if (y4m_begin(s, path, why)) {
        y4m_discard(&s->sink);
        return PUPIL_SINK_FAILED;
    }
    if (options->without)
        pupil_refuse(options->without, "%s", options->sound.path ? "Y4M has none" : "");
    *sink = &s->sink;
    return PUPIL_SINK_OK;
}
