/* tests/drivers/file/clip.h: small videos, made with libav. */
#ifndef PUPIL_TESTS_CLIP_H
#define PUPIL_TESTS_CLIP_H

#include "check.h"

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>

typedef struct clip {
    const char *container, *codec;
    enum AVPixelFormat format;
    int width, height, frames;
    enum AVColorSpace space;
    enum AVColorTransferCharacteristic transfer;
    enum AVColorPrimaries primaries;
    enum AVColorRange range;
    enum AVChromaLocation chroma;
    const int64_t *pts_ms; /* NULL: 25 frames a second */
    /* the code of one component's sample */
    int (*code)(const struct clip *clip, int frame, int component, int x, int y);
    const void *user;
} clip;

static inline void clip_fill(const clip *c, AVFrame *f, int n)
{
    const AVPixFmtDescriptor *d = av_pix_fmt_desc_get(c->format);
    uint16_t row[8192];
    for (int plane = 0; plane < 4 && f->buf[plane]; plane++) /* av_write_image_line2 only sets bits */
        memset(f->buf[plane]->data, 0, f->buf[plane]->size);
    for (int i = 0; i < d->nb_components; i++) {
        int chroma = i == 1 || i == 2;
        int width = chroma ? AV_CEIL_RSHIFT(c->width, d->log2_chroma_w) : c->width;
        int height = chroma ? AV_CEIL_RSHIFT(c->height, d->log2_chroma_h) : c->height;
        for (int y = 0; y < height; y++) {
            for (int x = 0; x < width; x++)
                row[x] = (uint16_t)c->code(c, n, i, x, y);
            av_write_image_line2(row, f->data, f->linesize, d, 0, y, i, width, sizeof *row);
        }
    }
}

static inline void clip_drain(AVFormatContext *out, AVCodecContext *codec, AVPacket *packet)
{
    while (avcodec_receive_packet(codec, packet) == 0) {
        av_packet_rescale_ts(packet, codec->time_base, out->streams[0]->time_base);
        packet->stream_index = 0;
        av_interleaved_write_frame(out, packet);
    }
}

static inline AVCodecContext *clip_encoder(const clip *c, AVFormatContext *out)
{
    const AVCodec *encoder = avcodec_find_encoder_by_name(c->codec);
    AVCodecContext *codec = avcodec_alloc_context3(encoder);
    codec->width = c->width;
    codec->height = c->height;
    codec->pix_fmt = c->format;
    codec->time_base = c->pts_ms ? (AVRational){1, 1000} : (AVRational){1, 25};
    codec->framerate = (AVRational){25, 1};
    codec->colorspace = c->space;
    codec->color_trc = c->transfer;
    codec->color_primaries = c->primaries;
    codec->color_range = c->range;
    codec->chroma_sample_location = c->chroma;
    codec->thread_count = 1;
    codec->strict_std_compliance = FF_COMPLIANCE_EXPERIMENTAL;
    codec->flags |= AV_CODEC_FLAG_BITEXACT;
    if (out->oformat->flags & AVFMT_GLOBALHEADER)
        codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    av_log_set_level(AV_LOG_QUIET);
    codec->level = !strcmp(c->codec, "ffv1") ? 3 : codec->level; /* version 3 has checksums */
    if (avcodec_open2(codec, encoder, NULL) == 0)
        return codec;
    avcodec_free_context(&codec);
    return NULL;
}

static inline void clip_frames(const clip *c, AVFormatContext *out, AVCodecContext *codec, AVPacket *packet, AVFrame *f)
{
    f->format = c->format;
    f->width = c->width;
    f->height = c->height;
    f->color_range = c->range;
    f->colorspace = c->space;
    f->color_trc = c->transfer;
    f->color_primaries = c->primaries;
    f->chroma_location = c->chroma;
    av_frame_get_buffer(f, 0);
    for (int n = 0; n < c->frames; n++) {
        av_frame_make_writable(f);
        clip_fill(c, f, n);
        f->pts = c->pts_ms ? c->pts_ms[n] : n;
        avcodec_send_frame(codec, f);
        clip_drain(out, codec, packet);
    }
    avcodec_send_frame(codec, NULL);
    clip_drain(out, codec, packet);
    av_write_trailer(out);
}

/* Writes the clip. 0, or -1 where this libav cannot. */
static inline int clip_write(const clip *c, const char *path)
{
    AVFormatContext *out = NULL;
    int rc = -1;
    avformat_alloc_output_context2(&out, NULL, c->container, path);
    AVCodecContext *codec = out ? clip_encoder(c, out) : NULL;
    AVPacket *packet = av_packet_alloc();
    AVFrame *f = av_frame_alloc();
    if (codec && avio_open(&out->pb, path, AVIO_FLAG_WRITE) >= 0) {
        AVStream *stream = avformat_new_stream(out, NULL);
        avcodec_parameters_from_context(stream->codecpar, codec);
        stream->time_base = codec->time_base;
        stream->avg_frame_rate = codec->framerate;
        out->flags |= AVFMT_FLAG_BITEXACT;
        rc = avformat_write_header(out, NULL) < 0 ? -1 : 0;
        if (rc == 0)
            clip_frames(c, out, codec, packet, f);
        avio_closep(&out->pb);
    }
    avformat_free_context(out);
    avcodec_free_context(&codec);
    av_packet_free(&packet);
    av_frame_free(&f);
    return rc;
}

static inline uint8_t *clip_load(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = NULL;
    if (file && fseek(file, 0, SEEK_END) == 0) {
        *size = (size_t)ftell(file);
        rewind(file);
        bytes = malloc(*size);
        if (fread(bytes, 1, *size, file) != *size)
            *size = 0;
    }
    if (file)
        fclose(file);
    return bytes;
}

static inline void clip_store(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0);
}

#endif
