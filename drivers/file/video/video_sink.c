/* A video through libav: H.264 where the library has an encoder for it. It is 4:2:0, because browsers play nothing
 * else, and so has an even size: the last column or row of an odd frame is repeated. */
#include "video_sink.h"

#include "file/common/pending.h"
#include "file/sink/sink_common.h"
#include "video_sound.h"
#include "yuv_rows.h"

#include "refuse.h"
#include <errno.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* H.264 (2021) table A-1: MaxFS, the largest frame of the highest level (6.2), 139264 macroblocks of 16 x 16. */
#define PIXELS_MAX (139264u * 256u)
#define NS         ((AVRational){1, 1000000000})
/* A larger step between frames means that the clock was set: it counts as a nominal frame. */
#define GAP_MAX_NS (INT64_C(3600) * 1000000000)
/* A fragment of live video. A kill loses at most this and the frame that the encoder holds. */
#define FRAGMENT_MS 500

typedef struct video_sink {
    pupil_sink sink;
    pupil_sink_options options;
    pupil_pending pending;
    AVFormatContext *muxer;
    AVCodecContext *encoder;
    AVFrame *frame;
    AVPacket *packet;
    pupil_video_sound *sound; /* NULL: none */
    int frame_ticks;          /* the nominal frame, in the encoder's time base */
    uint64_t frames;
    uint64_t base_frame; /* the last frame whose time came from timestamps, or the first, */
    int64_t base_ns;     /* and its time in the video; frames without timestamps count from it */
    int64_t stamp_ns;    /* of the last frame */
    int64_t last_tick;
    int64_t fragment_begin; /* of a live video: the first tick that is not in the file */
    int is_shown;           /* it is in its place */
} video_sink;

static int fail(const video_sink *v, int error, pupil_why *why)
{
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(error, text, sizeof text);
    return pupil_refuse(why, "%s: cannot be written: %s%s", v->pending.path, text,
                        v->is_shown ? "; what was written before plays" : "");
}

/* The time of the next frame in ticks: the distance of the frames' timestamps where they rise, else the nominal one. */
static int64_t next_tick(video_sink *v, const pupil_frame_info *info)
{
    const int64_t stamp_ns = info ? info->timestamp_ns : 0;
    /* Unsigned, so that the difference never overflows. */
    const uint64_t step_ns = (uint64_t)stamp_ns - (uint64_t)v->stamp_ns;
    const double fps = v->options.fps;
    int64_t time_ns = v->base_ns + (int64_t)((double)(v->frames - v->base_frame) * 1e9 / fps + 0.5), tick;
    if (v->frames > 0 && stamp_ns > v->stamp_ns && step_ns <= GAP_MAX_NS) {
        /* From the last frame's own time, which may have been nominal. */
        time_ns = v->base_ns + (int64_t)((double)(v->frames - 1 - v->base_frame) * 1e9 / fps + 0.5) + (int64_t)step_ns;
        v->base_ns = time_ns;
        v->base_frame = v->frames;
    }
    v->stamp_ns = stamp_ns;
    tick = av_rescale_q(time_ns, (AVRational){1, 1000000000}, v->encoder->time_base);
    if (v->frames > 0 && tick <= v->last_tick)
        tick = v->last_tick + 1;
    v->last_tick = tick;
    return tick;
}

static void fill_frame(AVFrame *frame, const pupil_image_const *image)
{
    const uint32_t width = image->width, height = image->height;
    for (uint32_t y = 0; y < (uint32_t)frame->height; y += 2) {
        const uint8_t *top = (const uint8_t *)image->data + (ptrdiff_t)y * image->stride_bytes;
        const uint8_t *bottom = y + 1 < height ? top + image->stride_bytes : top;
        for (uint32_t row = 0; row < 2; row++) {
            uint8_t *luma = frame->data[0] + (ptrdiff_t)(y + row) * frame->linesize[0];
            pupil_yuv_row(PUPIL_YUV_709, PUPIL_YUV_Y, row ? bottom : top, width, luma);
            if (width % 2)
                luma[width] = luma[width - 1];
        }
        for (int plane = 1; plane <= 2; plane++)
            pupil_yuv709_chroma420_row((pupil_yuv_plane)plane, top, bottom, width,
                                       frame->data[plane] + (ptrdiff_t)(y / 2) * frame->linesize[plane]);
    }
}

/* After half a second of a live video: writes the fragment to the file. The first fragment gives the file its name. */
static int end_fragment(video_sink *v, int64_t packet_end, pupil_why *why)
{
    const AVRational base = v->muxer->streams[0]->time_base;
    if (!v->options.live || av_compare_ts(packet_end - v->fragment_begin, base, FRAGMENT_MS, (AVRational){1, 1000}) < 0)
        return PUPIL_SINK_OK;
    int error = av_write_frame(v->muxer, NULL);
    avio_flush(v->muxer->pb);
    if (error >= 0)
        error = v->muxer->pb->error;
    if (error < 0)
        return fail(v, error, why);
    v->fragment_begin = packet_end;
    if (!v->is_shown && pupil_pending_show(&v->pending, why))
        return PUPIL_SINK_FAILED;
    v->is_shown = 1;
    return PUPIL_SINK_OK;
}

/* Passes a frame (NULL: the end) to the encoder, and its output to the file. */
static int encode(video_sink *v, const AVFrame *frame, pupil_why *why)
{
    int error = avcodec_send_frame(v->encoder, frame);
    if (error < 0)
        return fail(v, error, why);
    while ((error = avcodec_receive_packet(v->encoder, v->packet)) >= 0) {
        if (v->packet->duration <= 0)
            v->packet->duration = v->frame_ticks;
        av_packet_rescale_ts(v->packet, v->encoder->time_base, v->muxer->streams[0]->time_base);
        v->packet->stream_index = 0;
        const int64_t time_ns = av_rescale_q(v->packet->dts, v->muxer->streams[0]->time_base, NS);
        const int64_t packet_end = v->packet->pts + v->packet->duration;
        error = av_interleaved_write_frame(v->muxer, v->packet);
        if (error >= 0)
            error = pupil_video_sound_write(v->sound, time_ns);
        if (error >= 0)
            error = v->muxer->pb->error; /* writes are buffered: a full disk shows here first */
        if (error < 0)
            return fail(v, error, why);
        if (end_fragment(v, packet_end, why))
            return PUPIL_SINK_FAILED;
    }
    return error == AVERROR(EAGAIN) || error == AVERROR_EOF ? PUPIL_SINK_OK : fail(v, error, why);
}

static int video_write(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info, pupil_why *why)
{
    video_sink *v = (video_sink *)sink;
    int error;
    if (pupil_sink_check_image(v->pending.path, &v->options, image, why))
        return PUPIL_SINK_FAILED;
    error = av_frame_make_writable(v->frame); /* a copy only where the encoder still holds it */
    if (error < 0)
        return fail(v, error, why);
    fill_frame(v->frame, image);
    v->frame->pts = next_tick(v, info);
    v->frames++;
    return encode(v, v->frame, why);
}

static void video_discard(pupil_sink *sink)
{
    video_sink *v = (video_sink *)sink;
    avcodec_free_context(&v->encoder);
    av_frame_free(&v->frame);
    av_packet_free(&v->packet);
    pupil_video_sound_close(v->sound);
    if (v->muxer)
        avio_closep(&v->muxer->pb);
    avformat_free_context(v->muxer);
    pupil_pending_discard(&v->pending);
    free(v);
}

static int video_finish(pupil_sink *sink, pupil_why *why)
{
    video_sink *v = (video_sink *)sink;
    int error, close_error;
    if (!v->frames)
        return pupil_refuse(why, "%s: nothing was written, for the input has no frame", v->pending.path);
    if (encode(v, NULL, why))
        return PUPIL_SINK_FAILED;
    error = pupil_video_sound_write(v->sound, av_rescale_q(v->last_tick + v->frame_ticks, v->encoder->time_base, NS));
    if (error >= 0)
        error = av_write_trailer(v->muxer);
    if (error >= 0)
        error = v->muxer->pb->error;
    close_error = avio_closep(&v->muxer->pb);
    if (error < 0 || close_error < 0)
        return fail(v, error < 0 ? error : close_error, why);
    if (pupil_pending_commit(&v->pending, why))
        return PUPIL_SINK_FAILED;
    video_discard(sink); /* after commit it only frees */
    return PUPIL_SINK_OK;
}

static const pupil_sink_ops video_ops = {video_write, video_finish, video_discard};

/* The settings that all encoders share. */
static void describe(video_sink *v, AVCodecContext *c)
{
    int num = 0, den = 1;
    pupil_fps_ratio(v->options.fps, &num, &den);
    /* A tick divides the nominal frame, so that steady video has steady steps, and is at most 0.1 ms, so that
     * timestamps keep theirs. MPEG-4 part 2 allows at most 65535 ticks a second (ISO/IEC 14496-2, 16 bits). */
    int ticks = num;
    while (ticks < 10000)
        ticks *= 2;
    if (ticks > 65535)
        ticks = 60000;
    c->time_base = (AVRational){1, ticks};
    c->framerate = (AVRational){num, den};
    v->frame_ticks = (int)av_rescale(ticks, den, num);
    if (v->frame_ticks < 1)
        v->frame_ticks = 1;
    c->width = (int)(v->options.width + v->options.width % 2);
    c->height = (int)(v->options.height + v->options.height % 2);
    c->sample_aspect_ratio =
        v->options.aspect[0] ? (AVRational){(int)v->options.aspect[0], (int)v->options.aspect[1]} : (AVRational){1, 1};
    c->pix_fmt = AV_PIX_FMT_YUV420P;
    c->chroma_sample_location = AVCHROMA_LOC_LEFT;
    c->color_range = AVCOL_RANGE_MPEG;
    c->colorspace = AVCOL_SPC_BT709;
    c->color_primaries = v->options.primaries == PUPIL_PRIMARIES_BT2020 ? AVCOL_PRI_BT2020 : AVCOL_PRI_BT709;
    /* The pixels' real curve, sRGB by default. With a BT.709 tag, QuickTime, Safari and mpv would assume a camera's or
     * a television's curve and show them lighter or darker. Players that ignore the transfer show both alike (the ASWF
     * Encoding Guidelines measured browsers and say the same). */
    static const enum AVColorTransferCharacteristic curves[PUPIL_TRANSFER_COUNT] = {
        [PUPIL_TRANSFER_SRGB] = AVCOL_TRC_IEC61966_2_1,
        [PUPIL_TRANSFER_GAMMA22] = AVCOL_TRC_GAMMA22,
        [PUPIL_TRANSFER_LINEAR] = AVCOL_TRC_LINEAR};
    c->color_trc = curves[v->options.transfer];
    if (v->muxer->oformat->flags & AVFMT_GLOBALHEADER)
        c->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
}

static int open_encoder(video_sink *v, const char *name)
{
    const AVCodec *codec = avcodec_find_encoder_by_name(name);
    AVDictionary *more = NULL;
    int error;
    if (!codec)
        return AVERROR_ENCODER_NOT_FOUND;
    v->encoder = avcodec_alloc_context3(codec);
    if (!v->encoder)
        return AVERROR(ENOMEM);
    describe(v, v->encoder);
    v->encoder->thread_count = 0; /* as many as there are cores */
    if (strcmp(name, "libx264") == 0) {
        av_dict_set(&more, "preset", "fast", 0);
        av_dict_set(&more, "crf", "18", 0);   /* differences are hard to see (x264's own word for 17 to 18) */
        av_dict_set(&more, "mbtree", "0", 0); /* it reads uninitialised memory: other bits in each process (164) */
        if (v->options.live)                  /* else it holds back over 40 frames */
            av_dict_set(&more, "tune", "zerolatency", 0);
    } else if (strcmp(name, "libopenh264") == 0) {
        /* It has no constant quality mode: 0.2 bits a pixel, twice the usual rate of video of this size. */
        v->encoder->bit_rate = (int64_t)(0.2 * v->options.fps * v->options.width * v->options.height) + 64000;
    } else {
        v->encoder->flags |= AV_CODEC_FLAG_QSCALE;
        v->encoder->global_quality = 2 * FF_QP2LAMBDA; /* the finest quantiser in common use */
    }
    errno = 0;
    error = avcodec_open2(v->encoder, codec, &more);
    if (error < 0 && errno == ENOMEM) /* libx264 reports only that it failed */
        error = AVERROR(ENOMEM);
    av_dict_free(&more);
    if (error < 0)
        avcodec_free_context(&v->encoder);
    return error;
}

static void open_sound(video_sink *v)
{
    const pupil_sink_sound *sound = &v->options.sound;
    pupil_why unused, *without = v->options.without ? v->options.without : &unused;
    without->text[0] = 0;
    if (sound->path && strcmp(sound->path, "-") == 0)
        pupil_refuse(without, "a pipe is read once; name the file");
    else if (sound->path)
        v->sound = pupil_video_sound_open(v->muxer, sound, without);
}

static int open_muxer(video_sink *v, pupil_why *why)
{
    AVDictionary *more = NULL;
    AVStream *stream = avformat_new_stream(v->muxer, NULL);
    int error = stream ? avcodec_parameters_from_context(stream->codecpar, v->encoder) : AVERROR(ENOMEM);
    if (error >= 0) {
        stream->time_base = v->encoder->time_base;
        stream->avg_frame_rate = v->encoder->framerate;
        stream->sample_aspect_ratio = v->encoder->sample_aspect_ratio;
        open_sound(v);
        error = avio_open(&v->muxer->pb, v->muxer->url, AVIO_FLAG_WRITE);
    }
    if (error >= 0) {
        /* The file plays before it is fully downloaded; live, while it is written. Matroska ignores both. */
        av_dict_set(&more, "movflags", v->options.live ? "+frag_custom+empty_moov+default_base_moof" : "+faststart", 0);
        error = avformat_write_header(v->muxer, &more);
        av_dict_free(&more);
    }
    return error < 0 ? fail(v, error, why) : PUPIL_SINK_OK;
}

static int video_begin(video_sink *v, const char *path, pupil_why *why)
{
    static const char *const encoders[] = {"libx264", "libopenh264", "mpeg4"};
    const char *dot = strrchr(path, '.');
    const char *format = dot && strcasecmp(dot, ".mkv") == 0   ? "matroska"
                         : dot && strcasecmp(dot, ".mov") == 0 ? "mov"
                                                               : "mp4";
    char *url;
    int error = AVERROR_ENCODER_NOT_FOUND;
    if (pupil_pending_file(&v->pending, path, v->options.overwrite, why))
        return PUPIL_SINK_FAILED;
    if (asprintf(&url, "file:%s", v->pending.temporary) < 0) /* "file:", for names with a colon */
        return pupil_refuse(why, "%s: out of memory", path);
    avformat_alloc_output_context2(&v->muxer, NULL, format, url);
    free(url);
    v->frame = av_frame_alloc();
    v->packet = av_packet_alloc();
    if (!v->muxer || !v->frame || !v->packet)
        return pupil_refuse(why, "%s: libav has no %s writer", path, format);
    for (size_t i = 0; i < sizeof encoders / sizeof *encoders && !v->encoder && error != AVERROR(ENOMEM); i++)
        error = open_encoder(v, encoders[i]);
    if (!v->encoder) {
        char text[AV_ERROR_MAX_STRING_SIZE] = "";
        av_strerror(error, text, sizeof text);
        return pupil_refuse(why,
                            "%s: libav has no encoder (libx264, libopenh264, mpeg4) for %u x %u pixels (%s); write "
                            "a folder of PNG or a .y4m",
                            path, v->options.width, v->options.height, text);
    }
    v->frame->format = v->encoder->pix_fmt;
    v->frame->width = v->encoder->width;
    v->frame->height = v->encoder->height;
    error = av_frame_get_buffer(v->frame, 0);
    return error < 0 ? fail(v, error, why) : open_muxer(v, why);
}

int pupil_video_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    video_sink *v;
    *sink = NULL;
    if (pupil_sink_check_options(path, options, why))
        return PUPIL_SINK_FAILED;
    if (options->width * options->height > PIXELS_MAX)
        return pupil_refuse(why,
                            "%s: %u x %u pixels are more than a video frame can have (%u in H.264); write a "
                            "folder of PNG or a .y4m",
                            path, options->width, options->height, PIXELS_MAX);
    v = calloc(1, sizeof *v);
    if (!v)
        return pupil_refuse(why, "%s: out of memory", path);
    av_log_set_level(AV_LOG_QUIET); /* errors are reported as sentences; x264 would print its own report */
    v->sink.ops = &video_ops;
    v->options = *options;
    if (video_begin(v, path, why)) {
        video_discard(&v->sink);
        return PUPIL_SINK_FAILED;
    }
    *sink = &v->sink;
    return PUPIL_SINK_OK;
}
