/* drivers/file/video/video_io.c: bytes for libav's demuxers, and the errors that libav reports. */
#include "video_io.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "refuse.h"
#include <libavutil/error.h>
#include <libavutil/log.h>
#include <libavutil/mem.h>

#define BUFFER_BYTES 65536
#define ASK_MS       100

static _Thread_local pupil_video_words kept;
static pthread_mutex_t words_lock = PTHREAD_MUTEX_INITIALIZER; /* of all words that belong to a codec */

static void put(pupil_video_words *words, const char *format, va_list arguments)
{
    if (words->text[0])
        return;
    vsnprintf(words->text, sizeof words->text, format, arguments);
    size_t length = strlen(words->text);
    while (length && (words->text[length - 1] == '\n' || words->text[length - 1] == '.'))
        words->text[--length] = 0;
    for (char *c = words->text; *c; c++)
        if ((unsigned char)*c < ' ' || (unsigned char)*c > '~')
            *c = '?'; /* libav may quote a file's bytes, which must not reach a terminal */
}

/* Decoders also report from their slice threads; all of these name the same codec. */
static void keep(void *context, int level, const char *format, va_list arguments)
{
    pupil_video_words *own = NULL;
    if (level > AV_LOG_ERROR)
        return;
    if (context && *(const AVClass **)context == avcodec_get_class())
        own = ((AVCodecContext *)context)->opaque;
    if (!own) {
        put(&kept, format, arguments);
        return;
    }
    pthread_mutex_lock(&words_lock);
    put(own, format, arguments);
    pthread_mutex_unlock(&words_lock);
}

void pupil_video_words_of(AVCodecContext *codec, pupil_video_words *words)
{
    av_log_set_callback(keep);
    codec->opaque = words;
}

int pupil_video_words_take(pupil_video_words *words, char text[256])
{
    pthread_mutex_lock(&words_lock);
    memcpy(text, words->text, sizeof words->text);
    words->text[0] = 0;
    pthread_mutex_unlock(&words_lock);
    return text[0] != 0;
}

void pupil_video_log_clear(void)
{
    av_log_set_callback(keep);
    kept.text[0] = 0;
}

const char *pupil_video_log_text(void)
{
    return kept.text;
}

/* While a pipe is silent, stop() is polled as well: a signal may come just before the wait. 0: there is something to
 * read; -1: errno. */
static int wait_for(const pupil_video_io *io)
{
    struct pollfd ready = {.fd = io->fd, .events = POLLIN};
    int got = 1;
    while (io->total < 0 && (got = poll(&ready, 1, io->stop ? ASK_MS : -1)) == 0 && !io->stop())
        ;
    if (got == 0)
        errno = EINTR;
    return got > 0 ? 0 : -1;
}

static int read_some(void *opaque, uint8_t *buffer, int wanted)
{
    pupil_video_io *io = opaque;
    if (io->fd < 0) {
        size_t left = io->size - io->position, take = left < (size_t)wanted ? left : (size_t)wanted;
        memcpy(buffer, io->bytes + io->position, take);
        io->position += take;
        return take ? (int)take : AVERROR_EOF;
    }
    if (io->read_most && io->read > io->read_most) {
        io->error = EFBIG;
        return AVERROR(EFBIG);
    }
    ssize_t got;
    do {
        if (io->stop && io->stop()) {
            io->error = EINTR;
            return AVERROR_EXIT;
        }
        got = wait_for(io) ? -1 : read(io->fd, buffer, (size_t)wanted);
    } while (got < 0 && errno == EINTR && io->total >= 0);
    if (got < 0) { /* EINTR of a pipe, too: a writer that has stopped must not keep the program from ending */
        io->error = errno;
        return AVERROR(errno);
    }
    io->read += got;
    return got ? (int)got : AVERROR_EOF;
}

static int64_t seek_to(void *opaque, int64_t offset, int whence)
{
    pupil_video_io *io = opaque;
    whence &= ~AVSEEK_FORCE;
    if (whence == AVSEEK_SIZE)
        return io->total;
    if (io->fd >= 0) {
        off_t at = lseek(io->fd, offset, whence);
        return at < 0 ? AVERROR(errno) : at;
    }
    if (whence == SEEK_CUR && __builtin_add_overflow(offset, (int64_t)io->position, &offset))
        return AVERROR(EINVAL);
    if (whence == SEEK_END && __builtin_add_overflow(offset, (int64_t)io->size, &offset))
        return AVERROR(EINVAL);
    if (offset < 0 || offset > (int64_t)io->size)
        return AVERROR(EINVAL);
    io->position = (size_t)offset;
    return offset;
}

static int make_context(pupil_video_io *io, pupil_why *why)
{
    unsigned char *buffer = av_malloc(BUFFER_BYTES);
    if (buffer)
        io->context = avio_alloc_context(buffer, BUFFER_BYTES, 0, io, read_some, NULL, io->total >= 0 ? seek_to : NULL);
    if (io->context)
        return 0;
    av_free(buffer);
    pupil_video_io_close(io);
    return pupil_refuse(why, "not enough memory");
}

int pupil_video_io_open(pupil_video_io *io, const char *path, pupil_why *why)
{
    struct stat status;
    memset(io, 0, sizeof *io);
    io->close_fd = strcmp(path, "-") != 0;
    /* does not wait for a pipe's writer: wait_for does */
    io->fd = io->close_fd ? open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK) : STDIN_FILENO;
    if (io->fd < 0 || fstat(io->fd, &status)) {
        pupil_refuse(why, "%s", strerror(errno));
        pupil_video_io_close(io);
        return -1;
    }
    if (S_ISDIR(status.st_mode)) {
        pupil_refuse(why, "a folder, not a video");
        pupil_video_io_close(io);
        return -1;
    }
    /* Standard input that is a partly read file counts as a pipe: the file's offsets are not the video's. */
    io->total = S_ISREG(status.st_mode) && lseek(io->fd, 0, SEEK_CUR) == 0 ? status.st_size : -1;
    if (io->total == 0) {
        pupil_refuse(why, "an empty file; an image or a video was expected");
        pupil_video_io_close(io);
        return -1;
    }
    return make_context(io, why);
}

int pupil_video_io_bytes(pupil_video_io *io, const uint8_t *bytes, size_t size, pupil_why *why)
{
    memset(io, 0, sizeof *io);
    io->fd = -1;
    io->bytes = bytes;
    io->size = size;
    io->total = (int64_t)size;
    return make_context(io, why);
}

void pupil_video_io_close(pupil_video_io *io)
{
    if (io->context)
        av_freep(&io->context->buffer);
    avio_context_free(&io->context);
    if (io->fd >= 0 && io->close_fd)
        close(io->fd);
    io->fd = -1;
}
