#include "recording_mkv.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>

#include "file/common/write_all.h"
#include "file/video/video_io.h"
#include "refuse.h"

#define ERRNO_MOST        4095      /* of Linux; libav's codes of its own are beyond it */
#define BUFFER_BYTES      4096      /* heads; frames go past it */
#define SEARCH_MOST_BYTES (1 << 28) /* besides the frame: how much libavformat may read to find the next one */
#define HEAD_MOST_BYTES   4096      /* bytes before the first frame; ours has about 600 */
/* A larger step between frames means that the clock was set: it counts as a nominal frame. */
#define GAP_MAX_NS (UINT64_C(3600) * 1000000000)

/* --- times --- */

typedef struct mkv_clock {
    uint64_t period_ns, time_ns, frames; /* time: of the last frame */
    int64_t stamp_ns, ms;
} mkv_clock;

static mkv_clock clock_of(double fps)
{
    return (mkv_clock){.period_ns = (uint64_t)fmin(1e9 / fps + 0.5, (double)GAP_MAX_NS), .ms = -1};
}

static int64_t next_ms(mkv_clock *c, int64_t timestamp_ns)
{
    const uint64_t step_ns = (uint64_t)timestamp_ns - (uint64_t)c->stamp_ns; /* unsigned: never overflows */
    if (c->frames++)
        c->time_ns += timestamp_ns > c->stamp_ns && step_ns <= GAP_MAX_NS ? step_ns : c->period_ns;
    c->stamp_ns = timestamp_ns;
    const int64_t ms = (int64_t)(c->time_ns / 1000000);
    return c->ms = ms > c->ms ? ms : c->ms + 1;
}

/* --- writing --- */

struct pupil_mkv_writer {
    int fd, error; /* errno of what failed first */
    AVFormatContext *format;
    AVIOContext *io;
    AVPacket *packet;
    int64_t end; /* of the last whole frame */
    mkv_clock clock;
    uint64_t next_entry;
};

/* From FFmpeg 7 on (libavformat 61), the bytes to be written are const. */
#if LIBAVFORMAT_VERSION_MAJOR < 61
#define WRITTEN
#else
#define WRITTEN const
#endif

static int put_bytes(void *opaque, WRITTEN uint8_t *bytes, int size)
{
    pupil_mkv_writer *w = opaque;
    if (!w->error && pupil_write_all(w->fd, bytes, (size_t)size))
        w->error = errno;
    return w->error ? AVERROR(w->error) : size;
}

static int64_t seek_to(void *opaque, int64_t offset, int whence)
{
    pupil_mkv_writer *w = opaque;
    if (whence & AVSEEK_SIZE)
        return AVERROR(EINVAL);
    const off_t at = w->error ? -1 : lseek(w->fd, offset, whence & ~AVSEEK_FORCE);
    if (at < 0 && !w->error) /* libavformat would continue to write at the old position */
        w->error = errno;
    return at < 0 ? AVERROR(w->error) : at;
}

/* Cuts off what was written in part. */
static int take_back(pupil_mkv_writer *w, int code)
{
    const int error = w->error ? w->error : code < 0 && code >= -ERRNO_MOST ? AVUNERROR(code) : EIO;
    w->error = error;
    (void)!ftruncate(w->fd, w->end);
    errno = error;
    return -1;
}

/* To the kernel. */
static int flush(pupil_mkv_writer *w, int code)
{
    if (w->io) /* else there was no memory for it */
        avio_flush(w->io);
    if (code < 0 || w->error)
        return take_back(w, code);
    w->end = avio_tell(w->io);
    return 0;
}

static void describe(AVCodecParameters *p, const pupil_recording_about *about)
{
    static const enum AVColorSpace matrices[PUPIL_MATRIX_COUNT] = {AVCOL_SPC_SMPTE170M, AVCOL_SPC_BT709,
                                                                   AVCOL_SPC_BT2020_NCL};
    static const enum AVColorTransferCharacteristic transfers[PUPIL_LIGHT_COUNT] = {
        AVCOL_TRC_IEC61966_2_1, AVCOL_TRC_LINEAR,    AVCOL_TRC_IEC61966_2_1,
        AVCOL_TRC_BT709,        AVCOL_TRC_SMPTE2084, AVCOL_TRC_ARIB_STD_B67};
    p->codec_type = AVMEDIA_TYPE_VIDEO;
    p->codec_id = about->jpeg ? AV_CODEC_ID_MJPEG : AV_CODEC_ID_RAWVIDEO;
    p->codec_tag = about->jpeg ? 0 : pupil_recording_fourcc(about);
    p->width = (int)about->width;
    p->height = (int)about->height;
    if (about->primaries == PUPIL_PRIMARIES_BT2020) /* BT.709 is also what a driver that reports nothing has */
        p->color_primaries = AVCOL_PRI_BT2020;
    const int is_yuv =
        pupil_pixel_planes(about->pixel) > 1 || about->pixel == PUPIL_PIXEL_YUYV || about->pixel == PUPIL_PIXEL_UYVY;
    if (!about->jpeg && is_yuv) {
        p->color_space = matrices[about->coding.matrix];
        p->color_range = about->coding.range == PUPIL_RANGE_FULL ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
        p->color_trc = transfers[about->coding.light];
    }
}

static int begin(pupil_mkv_writer *w, const pupil_recording_about *about)
{
    AVDictionary *options = NULL;
    unsigned char *buffer = av_malloc(BUFFER_BYTES);
    w->packet = av_packet_alloc();
    w->io = buffer ? avio_alloc_context(buffer, BUFFER_BYTES, 1, w, NULL, put_bytes, seek_to) : NULL;
    if (!w->io)
        av_free(buffer);
    avformat_alloc_output_context2(&w->format, NULL, "matroska", NULL);
    AVStream *stream = w->format ? avformat_new_stream(w->format, NULL) : NULL;
    if (!w->packet || !w->io || !stream)
        return AVERROR(ENOMEM);
    w->io->direct = 1; /* saves one more copy of each frame */
    w->format->pb = w->io;
    w->format->flags |= AVFMT_FLAG_CUSTOM_IO;
    w->format->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL; /* letters of our own for formats without any */
    describe(stream->codecpar, about);
    stream->sample_aspect_ratio = stream->codecpar->sample_aspect_ratio = (AVRational){1, 1};
    stream->avg_frame_rate = av_d2q(about->fps, 1000000);
    stream->time_base = (AVRational){1, 1000};
    av_dict_set(&options, "write_crc32", "0", 0); /* checksums of frames take time, and nothing checks them */
    const int code = avformat_write_header(w->format, &options);
    av_dict_free(&options);
    return code;
}

int pupil_mkv_create(pupil_mkv_writer **writer, int fd, const pupil_recording_about *about)
{
    pupil_mkv_writer *w = *writer = calloc(1, sizeof *w);
    if (!w)
        return -1;
    pupil_video_log_clear();
    w->fd = fd;
    w->clock = clock_of(about->fps);
    if (flush(w, begin(w, about)) == 0)
        return 0;
    const int error = errno;
    pupil_mkv_free(w);
    *writer = NULL;
    errno = error;
    return -1;
}

/* libavformat adds an index entry for each frame while the output can seek. That is allowed for the first 1024 frames,
 * and then for about as many of each doubling: some 10000 a day, where entries of all frames would fill the memory. */
static int is_entry(pupil_mkv_writer *w)
{
    const uint64_t frame = w->clock.frames;
    if (frame < w->next_entry)
        return 0;
    w->next_entry = frame + 1 + frame / 1024;
    return 1;
}

int pupil_mkv_write(pupil_mkv_writer *w, int64_t timestamp_ns, void *bytes, size_t size)
{
    if (w->error)
        return take_back(w, 0);
    w->io->seekable = is_entry(w) ? AVIO_SEEKABLE_NORMAL : 0;
    w->packet->data = bytes;
    w->packet->size = (int)size; /* pupil_recording_check */
    w->packet->pts = w->packet->dts = next_ms(&w->clock, timestamp_ns);
    w->packet->duration = (int64_t)(w->clock.period_ns / 1000000);
    w->packet->flags = AV_PKT_FLAG_KEY;
    const int code = av_write_frame(w->format, w->packet);
    return flush(w, code < 0 ? code : av_write_frame(w->format, NULL)); /* NULL: ends the cluster */
}

int pupil_mkv_finish(pupil_mkv_writer *w)
{
    w->io->seekable = AVIO_SEEKABLE_NORMAL;
    return flush(w, w->error ? 0 : av_write_trailer(w->format));
}

void pupil_mkv_free(pupil_mkv_writer *w)
{
    if (!w)
        return;
    avformat_free_context(w->format);
    if (w->io)
        av_freep(&w->io->buffer);
    avio_context_free(&w->io);
    av_packet_free(&w->packet);
    free(w);
}

/* --- reading --- */

struct pupil_mkv_reader {
    pupil_video_io io;
    AVFormatContext *format; /* NULL: the file ends before its first frame */
    size_t frame_bytes;
    AVPacket *packet;
    mkv_clock clock;
};

/* Why libav does not continue; NULL: because the file ends. libav calls a head that was cut off invalid. */
static const char *trouble(pupil_mkv_reader *r, int code, char buffer[AV_ERROR_MAX_STRING_SIZE])
{
    if (r->io.error)
        return strerror(r->io.error);
    if (code == AVERROR(ENOMEM) || errno == ENOMEM)
        return strerror(ENOMEM);
    if (code == AVERROR_EOF || r->io.total < HEAD_MOST_BYTES)
        return NULL;
    av_strerror(code, buffer, AV_ERROR_MAX_STRING_SIZE);
    return pupil_video_log_text()[0] ? pupil_video_log_text() : buffer;
}

static int is_matroska(int fd)
{
    static const unsigned char head[4] = {0x1a, 0x45, 0xdf, 0xa3}; /* EBML (RFC 8794, 11.2.1) */
    unsigned char bytes[4];
    const ssize_t got = pread(fd, bytes, sizeof bytes, 0);
    return got < 0 || memcmp(bytes, head, (size_t)got) == 0;
}

static int open_format(pupil_mkv_reader *r, const char *path, pupil_why *why)
{
    pupil_why words;
    struct stat status;
    if (stat(path, &status))
        return pupil_refuse(why, "%s: cannot be read: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode))
        return pupil_refuse(why, "%s: is not a file", path);
    if (!status.st_size)
        return 0;
    if (pupil_video_io_open(&r->io, path, &words))
        return pupil_refuse(why, "%s: cannot be read: %s", path, words.text);
    if (!is_matroska(r->io.fd))
        return pupil_refuse(why, "%s: is not a Matroska file", path);
    r->packet = av_packet_alloc();
    r->format = avformat_alloc_context();
    if (!r->packet || !r->format)
        return pupil_refuse(why, "%s: not enough memory", path);
    r->io.read_most = (int64_t)r->frame_bytes + SEARCH_MOST_BYTES;
    r->io.context->seekable = 0; /* from the front to the end: the index is for others */
    r->format->pb = r->io.context;
    r->format->flags |= AVFMT_FLAG_CUSTOM_IO | AVFMT_FLAG_NOPARSE | AVFMT_FLAG_NOFILLIN; /* bytes as they are */
    pupil_video_log_clear();
    errno = 0;
    const int code = avformat_open_input(&r->format, "", av_find_input_format("matroska"), NULL);
    const char *fault = code < 0 ? trouble(r, code, words.text) : NULL;
    return fault ? pupil_refuse(why, "%s: is not a Matroska file that can be read: %s", path, fault) : 0;
}

int pupil_mkv_open(pupil_mkv_reader **reader, const char *path, double fps, size_t frame_bytes, pupil_why *why)
{
    pupil_mkv_reader *r = *reader = calloc(1, sizeof *r);
    if (!r)
        return pupil_refuse(why, "%s: not enough memory", path);
    r->io.fd = -1;
    r->clock = clock_of(fps);
    r->frame_bytes = frame_bytes;
    if (open_format(r, path, why) == 0)
        return 0;
    pupil_mkv_close(r);
    *reader = NULL;
    return -1;
}

int pupil_mkv_read(pupil_mkv_reader *r, int64_t timestamp_ns, const unsigned char **bytes, size_t *size, pupil_why *why)
{
    char words[AV_ERROR_MAX_STRING_SIZE];
    const int64_t ms = next_ms(&r->clock, timestamp_ns);
    if (!r->format)
        return 0;
    pupil_video_log_clear();
    av_packet_unref(r->packet);
    r->io.read = 0;
    errno = 0; /* when memory runs out, libavformat reports a damaged block and then the end of the file; errno shows
                * the cause */
    const int code = av_read_frame(r->format, r->packet);
    const char *fault = code < 0 ? trouble(r, code, words) : NULL;
    if (fault)
        return pupil_refuse(why, "cannot be read: %s", fault);
    if (code < 0)
        return 0;
    /* libavformat skips damage and continues with the next whole frame. */
    if (r->packet->pts != ms)
        return pupil_refuse(why, "is damaged: a frame at %lld ms, where its line has it at %lld ms",
                            (long long)r->packet->pts, (long long)ms);
    *bytes = r->packet->data;
    *size = (size_t)r->packet->size;
    return 1;
}

void pupil_mkv_close(pupil_mkv_reader *r)
{
    if (!r)
        return;
    avformat_close_input(&r->format);
    pupil_video_io_close(&r->io);
    av_packet_free(&r->packet);
    free(r);
}
