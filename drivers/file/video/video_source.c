/* drivers/file/video/video_source.c: a video as a source: demux, decode, stamp, and say what is wrong. */
#include "video_source.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <libavutil/display.h>
#include <libavutil/opt.h>

#include "refuse.h"
#include "video_damage.h"
#include "video_format.h"
#include "video_io.h"
#include "video_mosaic.h"
#include "video_pixels.h"
#include "video_turn.h"

#define DEFAULT_FPS 30.0

/* Largest frame: as a still's (still.h). */
#define MOST_PIXELS (INT64_C(1) << 26)

/* A video is given up after this many damaged frames in a row: 100 s at 10 fps. */
#define MAX_DAMAGED 1000

/* How often in a row a demuxer may ask to be called again; reads block, so it has no reason to. */
#define MAX_AGAIN 1000

/* Bytes that are read for a packet, and to find out what a video is: 8 for each pixel of the largest frame. */
#define PACKET_MOST_BYTES (MOST_PIXELS * 8)

/* Latest timestamp believed (about 146 years in ns); a later one is damage. */
#define MAX_TIME_NS (INT64_C(1) << 62)

typedef struct video_source {
    pupil_source base;
    char *name;
    pupil_video_io io;
    AVFormatContext *format;
    AVCodecContext *codec;
    AVStream *stream;
    AVPacket *packet;
    AVFrame *frame;
    pupil_video_pixels pixels;
    pupil_frame first; /* decoded at open, because it says which primaries the frames have; returned by the first
                        * next */
    int is_open, has_first, first_code;
    pupil_why first_why;
    int has_packet;  /* read, and not yet taken by the decoder */
    int is_draining; /* the demuxer has ended */
    int state;       /* PUPIL_SOURCE_FRAME while frames come; END or FAILED for good */
    pupil_video_damage damage;
    pupil_video_turn turn;
    pupil_video_mosaic mosaic;
    int as_stored;                 /* not turned */
    int as_linear;                 /* without a curve */
    const int32_t *display_matrix; /* the stream's; NULL: none */
    char early[384];               /* why the demuxer ended before the video did; "" if it did not */
    pupil_why last;                /* the sentence of FAILED */
    uint64_t handed, sequence;
    int damaged_in_a_row;
    int64_t packets_end;  /* the demuxer's position after the last packet */
    int64_t packets_time; /* when the last packet ended, in units of the stream that are frames in an AVI */
    int64_t first_pts, last_ns, period_ns;
    uint32_t width, height;
} video_source;

__attribute__((format(printf, 3, 4))) static int failed(video_source *v, pupil_why *why, const char *format, ...)
{
    int used = snprintf(v->last.text, sizeof v->last.text, "%s: ", v->name);
    va_list arguments;
    va_start(arguments, format);
    if (used >= 0 && (size_t)used < sizeof v->last.text)
        vsnprintf(v->last.text + used, sizeof v->last.text - (size_t)used, format, arguments);
    va_end(arguments);
    v->state = PUPIL_SOURCE_FAILED;
    pupil_refuse(why, "%s", v->last.text);
    return PUPIL_SOURCE_FAILED;
}

static int damaged(video_source *v, pupil_why *why, const char *words)
{
    if (++v->damaged_in_a_row > MAX_DAMAGED)
        return failed(v, why, "given up after %d damaged frames in a row: %s", MAX_DAMAGED, words);
    pupil_refuse(why, "%s: frame %llu is damaged: %s", v->name, (unsigned long long)v->sequence, words);
    v->sequence++;
    return PUPIL_SOURCE_DAMAGED;
}

/* --- time --- */

static int64_t time_ns(video_source *v, int64_t pts)
{
    int64_t after, ns = -1;
    if (!v->handed) {
        v->first_pts = pts;
        if (pts != AV_NOPTS_VALUE)
            v->base.sound.begin_ns = av_rescale_q(pts, v->stream->time_base, (AVRational){1, 1000000000});
        return 0;
    }
    if (pts != AV_NOPTS_VALUE && v->first_pts != AV_NOPTS_VALUE && !__builtin_sub_overflow(pts, v->first_pts, &after))
        ns = av_rescale_q(after, v->stream->time_base, (AVRational){1, 1000000000});
    return ns > v->last_ns && ns < MAX_TIME_NS ? ns : v->last_ns + v->period_ns;
}

static double nominal_fps(video_source *v, const pupil_source_options *options)
{
    AVRational rate = av_guess_frame_rate(v->format, v->stream, NULL);
    double fps = rate.num > 0 && rate.den > 0 ? av_q2d(rate) : 0;
    if (fps >= 1e-3 && fps <= 1e5) /* anything else is no frame rate but a clock, or damage */
        return fps;
    v->base.obeys = PUPIL_SOURCE_FPS;
    return options && options->fps > 0 ? options->fps : DEFAULT_FPS;
}

/* --- decode --- */

/* The demuxer has ended: was that the end of the video? Two formats that end without an error are checked
 * separately. */
static void note_end(video_source *v, int code)
{
    char words[AV_ERROR_MAX_STRING_SIZE];
    const char *name = v->format->iformat->name;
    if (v->io.error)
        snprintf(v->early, sizeof v->early, "cannot be read on: %s", strerror(v->io.error));
    else if (code != AVERROR_EOF || pupil_video_log_text()[0])
        snprintf(v->early, sizeof v->early, "damaged or cut short: %s", pupil_libav_words(code, words));
    else if (!strcmp(name, "yuv4mpegpipe") && avio_tell(v->format->pb) > v->packets_end)
        snprintf(v->early, sizeof v->early, "cut short: its last frame is not whole");
    else if (!strcmp(name, "avi") && v->stream->nb_frames > v->packets_time)
        snprintf(v->early, sizeof v->early, "cut short: its header promises %lld frames",
                 (long long)v->stream->nb_frames);
}

/* The next packet of the stream into v->packet. 1, 0 at the end, -1 for a packet that is not whole. */
static int read_packet(video_source *v)
{
    v->io.read = 0;
    for (int again = 0;;) {
        pupil_video_log_clear();
        int code = av_read_frame(v->format, v->packet);
        if (code == AVERROR(EAGAIN) && ++again < MAX_AGAIN)
            continue;
        if (code < 0) {
            note_end(v, code);
            return 0;
        }
        if (v->packet->stream_index == v->stream->index)
            break;
        av_packet_unref(v->packet);
    }
    v->packets_end = avio_tell(v->format->pb);
    v->packets_time = v->packet->dts != AV_NOPTS_VALUE ? v->packet->dts + 1 : INT64_MAX;
    if (!(v->packet->flags & AV_PKT_FLAG_CORRUPT)) {
        pupil_video_damage_of_next(&v->damage, pupil_video_log_text());
        return 1;
    }
    av_packet_unref(v->packet);
    return -1;
}

/* One step toward a frame: gives the decoder a packet, or the end of the stream. 0, or a return value of next. */
static int feed(video_source *v, pupil_why *why)
{
    char words[AV_ERROR_MAX_STRING_SIZE], text[256];
    if (pupil_video_damage_left(&v->damage, 0, text))
        return damaged(v, why, text);
    if (!v->has_packet && !v->is_draining) {
        int got = read_packet(v);
        if (got < 0)
            return damaged(v, why, "its data is not whole");
        v->has_packet = got;
        v->is_draining = !got;
    }
    pupil_video_log_clear();
    int code = pupil_video_damage_send(&v->damage, v->codec, v->has_packet ? v->packet : NULL);
    if (code == AVERROR(EAGAIN))
        return 0; /* the decoder's frames must be received first, which the caller does next */
    if (v->has_packet)
        av_packet_unref(v->packet);
    v->has_packet = 0;
    if (code == AVERROR(ENOMEM))
        return failed(v, why, "not enough memory to decode frame %llu", (unsigned long long)v->sequence);
    if (code >= 0 || code == AVERROR_EOF)
        return 0;
    pupil_video_damage_refused(&v->damage, text);
    return damaged(v, why, text[0] ? text : pupil_libav_words(code, words));
}

/* Sets the turn that makes it upright, unless as_stored: by the frame's matrix, else by the stream's. */
static int turn(video_source *v, pupil_why *why)
{
    const AVFrameSideData *of_frame = av_frame_get_side_data(v->frame, AV_FRAME_DATA_DISPLAYMATRIX);
    const int32_t *matrix = of_frame ? (const int32_t *)(const void *)of_frame->data : v->display_matrix;
    if (v->as_stored || !matrix)
        return 0;
    return pupil_video_turn_set(&v->turn, matrix, why);
}

/* The frame as an image, upright. */
static int convert(video_source *v, pupil_frame *out, pupil_why *why)
{
    if (!pupil_video_is_mosaic(v->frame->format)) {
        if (v->as_linear)
            v->frame->color_trc = AVCOL_TRC_LINEAR;
        if (pupil_video_pixels_convert(&v->pixels, v->frame, why))
            return -1;
        out->image = v->pixels.image;
        out->code_light = v->pixels.code_light;
        return turn(v, why) || pupil_video_turn_image(&v->turn, &out->image, why) ? -1 : 0;
    }
    v->pixels.primaries = PUPIL_PRIMARIES_BT709;
    if (turn(v, why))
        return -1;
    if (v->turn.xx || v->turn.xy)
        return pupil_refuse(why, "a mosaic cannot be turned; --no-rotate leaves it as it is stored");
    return pupil_video_mosaic_take(&v->mosaic, v->frame, &out->info, &out->image, why);
}

static int hand_out(video_source *v, pupil_frame *out, pupil_why *why)
{
    AVFrame *f = v->frame;
    pupil_why words;
    char text[256] = "";
    const int found = pupil_video_damage_of_frame(&v->damage, f, text);
    if (found < 0)
        return 0;
    if (found || f->decode_error_flags || f->flags & AV_FRAME_FLAG_CORRUPT)
        return damaged(v, why, text[0] ? text : "its decoder marks it so");
    if (f->width <= 0 || f->height <= 0 || f->width > (int)PUPIL_MAX_SIDE_PX || f->height > (int)PUPIL_MAX_SIDE_PX)
        return failed(v, why, "frames of %d x %d pixels; 1 to %u a side can be read", f->width, f->height,
                      PUPIL_MAX_SIDE_PX);
    if (v->width && (v->width != (uint32_t)f->width || v->height != (uint32_t)f->height))
        return failed(v, why, "frame %llu is %d x %d, the frames before it were %u x %u; they must not change",
                      (unsigned long long)v->sequence, f->width, f->height, v->width, v->height);
    memset(out, 0, sizeof *out);
    const int64_t at_ns = time_ns(v, f->best_effort_timestamp);
    out->info.timestamp_ns = at_ns;
    if (convert(v, out, &words))
        return failed(v, why, "%s", words.text);
    if (v->is_open && v->pixels.primaries != v->base.primaries)
        return failed(v, why, "frame %llu has other primaries than the video before it; they must not change",
                      (unsigned long long)v->sequence);
    v->base.primaries = v->pixels.primaries;
    v->width = (uint32_t)f->width;
    v->height = (uint32_t)f->height;
    v->last_ns = at_ns;
    v->damaged_in_a_row = 0;
    out->info.sequence = v->sequence++;
    out->name = v->name;
    v->handed++;
    return PUPIL_SOURCE_FRAME;
}

static int finish(video_source *v, pupil_why *why)
{
    char text[256];
    if (pupil_video_damage_left(&v->damage, 1, text))
        return damaged(v, why, text);
    if (v->early[0] && v->io.error)
        return failed(v, why, "ends after %llu frame%s: %s", (unsigned long long)v->sequence,
                      v->sequence == 1 ? "" : "s", v->early);
    if (v->early[0]) { /* once: what follows is lost, and then the video is at its end */
        pupil_refuse(why, "%s: ends after %llu frame%s: %s", v->name, (unsigned long long)v->sequence,
                     v->sequence == 1 ? "" : "s", v->early);
        v->early[0] = 0;
        return PUPIL_SOURCE_DAMAGED;
    }
    if (!v->handed)
        return failed(v, why, "its video stream holds no frame that can be decoded");
    return v->state = PUPIL_SOURCE_END;
}

static int decode_next(video_source *v, pupil_frame *out, pupil_why *why)
{
    char words[AV_ERROR_MAX_STRING_SIZE], text[256];
    while (v->state == PUPIL_SOURCE_FRAME) {
        pupil_video_log_clear();
        int code = pupil_video_damage_receive(&v->damage, v->codec, v->frame), result;
        if (code == 0) {
            result = hand_out(v, out, why);
        } else if (code == AVERROR_EOF) {
            return finish(v, why);
        } else if (code == AVERROR(EAGAIN)) {
            result = feed(v, why);
        } else {
            pupil_video_damage_refused(&v->damage, text);
            result = damaged(v, why, text[0] ? text : pupil_libav_words(code, words));
        }
        if (result)
            return result;
    }
    if (v->state == PUPIL_SOURCE_FAILED)
        pupil_refuse(why, "%s", v->last.text);
    return v->state;
}

static int video_next(pupil_source *source, pupil_frame *out, pupil_why *why)
{
    video_source *v = (video_source *)source;
    if (!v->has_first)
        return decode_next(v, out, why);
    v->has_first = 0;
    *out = v->first;
    if (why)
        *why = v->first_why;
    return v->first_code;
}

/* Buffers are the source's own: the next frame overwrites them. */
static void video_done(pupil_source *source, pupil_frame *frame)
{
    video_source *v = (video_source *)source;
    pupil_video_mosaic_done(&v->mosaic, &frame->image, &frame->info);
}

static void video_close(pupil_source *source)
{
    video_source *v = (video_source *)source;
    pupil_video_log_clear();
    avcodec_free_context(&v->codec);
    avformat_close_input(&v->format);
    pupil_video_io_close(&v->io);
    av_packet_free(&v->packet);
    av_frame_free(&v->frame);
    pupil_video_pixels_free(&v->pixels);
    pupil_video_turn_free(&v->turn);
    pupil_video_mosaic_free(&v->mosaic);
    free(v->name);
    free(v);
}

/* --- open --- */

/* The sink opens the file again, which a pipe does not allow. */
static void note_sound(video_source *v)
{
    struct stat is;
    const int is_file = fstat(v->io.fd, &is) == 0 && S_ISREG(is.st_mode) && v->io.close_fd;
    const char *path = is_file ? v->name : "-";
    for (unsigned i = 0; i < v->format->nb_streams && !v->base.sound.path; i++)
        if (v->format->streams[i]->codecpar->codec_type == AVMEDIA_TYPE_AUDIO)
            v->base.sound.path = path;
}

/* Known with the first frame, and turned as that is. */
static void note_aspect(video_source *v)
{
    const AVRational of = av_guess_sample_aspect_ratio(v->format, v->stream, NULL);
    const int turned = v->turn.xy != 0;
    if (of.num <= 0 || of.den <= 0 || of.num == of.den)
        return;
    v->base.pixel_aspect[turned] = (uint32_t)of.num;
    v->base.pixel_aspect[!turned] = (uint32_t)of.den;
}

static int find_stream(video_source *v, const AVCodec **decoder, pupil_why *why)
{
    const int found = av_find_best_stream(v->format, AVMEDIA_TYPE_VIDEO, -1, -1, decoder, 0);
    if (found == AVERROR_DECODER_NOT_FOUND)
        return failed(v, why, "libav has no decoder for its video stream");
    if (found < 0 || v->format->streams[found]->disposition & AV_DISPOSITION_ATTACHED_PIC)
        return failed(v, why, "no video stream in it (libav takes it for \"%s\")",
                      v->format->iformat->long_name ? v->format->iformat->long_name : v->format->iformat->name);
    v->stream = v->format->streams[found];
    for (unsigned i = 0; i < v->format->nb_streams; i++)
        if (v->format->streams[i] != v->stream)
            v->format->streams[i]->discard = AVDISCARD_ALL;
#if LIBAVFORMAT_VERSION_MAJOR < 60 /* later versions attach it to each frame */
    size_t bytes = 0;
    const uint8_t *matrix = av_stream_get_side_data(v->stream, AV_PKT_DATA_DISPLAYMATRIX, &bytes);
    v->display_matrix = bytes >= 9 * sizeof(int32_t) ? (const int32_t *)(const void *)matrix : NULL;
#endif
    return 0;
}

static int open_decoder(video_source *v, const AVCodec *decoder, int64_t max_pixels, int threads, pupil_why *why)
{
    char words[AV_ERROR_MAX_STRING_SIZE];
    const AVCodecParameters *parameters = v->stream->codecpar;
    pupil_why large;
    if (pupil_video_format_fits(parameters, max_pixels, &large))
        return failed(v, why, "%s", large.text);
    v->codec = avcodec_alloc_context3(decoder);
    v->packet = av_packet_alloc();
    v->frame = av_frame_alloc();
    if (!v->codec || !v->packet || !v->frame || avcodec_parameters_to_context(v->codec, parameters) < 0)
        return failed(v, why, "not enough memory");
    v->codec->pkt_timebase = v->stream->time_base;
    v->codec->max_pixels = max_pixels;
    v->codec->thread_count = threads; /* 0: as many as there are processors */
    /* Slices only: a frame comes out of the call that takes its packet, so that libav's messages are about this
     * frame. */
    v->codec->thread_type = FF_THREAD_SLICE;
    /* Not AV_EF_EXPLODE: with it libavcodec 59 fails an assertion on damaged MPEG-4 and aborts. */
    v->codec->err_recognition = AV_EF_CRCCHECK;
    /* libav's usual inverse DCT is up to a tenth of a code too low on average: 0.02 stops in a gain map. This one is
     * libjpeg's. */
    if (v->as_linear)
        v->codec->idct_algo = FF_IDCT_INT;
    AVDictionary *more = NULL;
    if (strcmp(decoder->name, "libdav1d") == 0)
        av_dict_set(&more, "framedelay", "1", 0); /* the same for frames of AV1 */
    pupil_video_damage_begin(&v->damage, v->codec);
    pupil_video_log_clear();
    int code = avcodec_open2(v->codec, decoder, &more);
    av_dict_free(&more);
    if (code < 0)
        return failed(v, why, "its %s decoder does not start: %s", decoder->name, pupil_libav_words(code, words));
    return 0;
}

/* How many frames to expect: what the container says, else its duration in frames. An estimate for a progress line. */
static uint64_t expected_frames(const video_source *v)
{
    if (v->stream->nb_frames > 0)
        return (uint64_t)v->stream->nb_frames;
    double seconds = v->stream->duration > 0 ? (double)v->stream->duration * av_q2d(v->stream->time_base)
                                             : (double)v->format->duration / AV_TIME_BASE;
    double frames = seconds * v->base.fps;
    return frames >= 1 && frames < 1e9 ? (uint64_t)(frames + 0.5) : 0;
}

static const pupil_source_ops video_ops = {video_next, video_done, video_close};

static int open_video(video_source *v, int64_t max_pixels, int threads, const pupil_source_options *options,
                      pupil_source **source, pupil_why *why)
{
    const AVCodec *decoder = NULL;
    pupil_why words;
    v->as_stored = options && options->as_stored;
    v->as_linear = options && options->as_linear;
    v->base.ops = &video_ops;
    v->state = PUPIL_SOURCE_FRAME;
    v->packets_end = INT64_MAX;
    int failed_at =
        pupil_video_format_open(&v->format, &v->io, &words) || pupil_video_format_look(v->format, max_pixels, &words);
    if (failed_at)
        failed(v, why, "%s", words.text);
    if (failed_at || find_stream(v, &decoder, why) || open_decoder(v, decoder, max_pixels, threads, why)) {
        video_close(&v->base);
        return PUPIL_SOURCE_FAILED;
    }
    v->base.fps = nominal_fps(v, options);
    v->base.frames = expected_frames(v);
    v->period_ns = (int64_t)(1e9 / v->base.fps + 0.5);
    const AVCodecParameters *tags = v->stream->codecpar; /* for where the first frame is damaged */
    v->base.primaries = pupil_video_primaries(tags->color_trc, tags->color_primaries, tags->color_space);
    note_sound(v);
    v->first_code = decode_next(v, &v->first, &v->first_why);
    note_aspect(v);
    v->is_open = 1;
    v->has_first = 1;
    *source = &v->base;
    return 0;
}

static video_source *allocate(const char *name, pupil_why *why)
{
    video_source *v = calloc(1, sizeof *v);
    if (v && (v->name = strdup(name)))
        return v;
    free(v);
    pupil_refuse(why, "%s: not enough memory", name);
    return NULL;
}

int pupil_video_source_open(const char *path, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why)
{
    pupil_why words;
    video_source *v = allocate(strcmp(path, "-") ? path : "standard input", why);
    if (!v)
        return PUPIL_SOURCE_FAILED;
    if (pupil_video_io_open(&v->io, path, &words)) {
        failed(v, why, "%s", words.text);
        video_close(&v->base);
        return PUPIL_SOURCE_FAILED;
    }
    v->io.stop = options ? options->stop : NULL;
    v->io.read_most = PACKET_MOST_BYTES;
    const int64_t most = options && options->max_pixels ? (int64_t)options->max_pixels : MOST_PIXELS;
    return open_video(v, most, 0, options, source, why);
}

int pupil_video_source_open_bytes(const uint8_t *bytes, size_t size, const char *name, int64_t max_pixels,
                                  const pupil_source_options *options, pupil_source **source, pupil_why *why)
{
    pupil_why words;
    video_source *v = allocate(name, why);
    if (!v)
        return PUPIL_SOURCE_FAILED;
    if (pupil_video_io_bytes(&v->io, bytes, size, &words)) {
        failed(v, why, "%s", words.text);
        video_close(&v->base);
        return PUPIL_SOURCE_FAILED;
    }
    return open_video(v, max_pixels, 1, options, source, why);
}
