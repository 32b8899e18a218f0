#include "libav_write.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>

#include "pupil/config.h"
#include "refuse.h"

/* Quantisers of about quality 95 in other programs' scale: differences are hard to see. */
#define QUALITY 2

/* JFIF 1.02, page 3: BT.601 in full range, here in 65536ths, rounded. */
static uint8_t code(int r, int g, int b, const int weight[3], int zero)
{
    const int sum = weight[0] * r + weight[1] * g + weight[2] * b + (zero << 16) + 32768;
    return (uint8_t)(sum < 0 ? 0 : sum >> 16 > 255 ? 255 : sum >> 16);
}

static void fill_codes(AVFrame *frame, const pupil_image_const *image)
{
    static const int weights[3][3] = {{19595, 38470, 7471}, {-11058, -21710, 32768}, {32768, -27439, -5329}};
    for (uint32_t y = 0; y < image->height; y++) {
        const uint8_t *from = pupil_image_rows(*image, y, 1).data;
        for (int plane = 0; plane < 3; plane++) {
            uint8_t *to = frame->data[plane] + (ptrdiff_t)y * frame->linesize[plane];
            for (uint32_t x = 0; x < image->width; x++)
                to[x] = code(from[3 * x], from[3 * x + 1], from[3 * x + 2], weights[plane], plane ? 128 : 0);
        }
    }
}

static void fill_rgb(AVFrame *frame, const pupil_image_const *image)
{
    for (uint32_t y = 0; y < image->height; y++)
        memcpy(frame->data[0] + (ptrdiff_t)y * frame->linesize[0], pupil_image_rows(*image, y, 1).data,
               3 * (size_t)image->width);
}

typedef struct kind {
    const char *name;
    enum AVCodecID codec;
    enum AVPixelFormat format;
    void (*fill)(AVFrame *frame, const pupil_image_const *image);
} kind;

/* JPEG with chroma for each pixel: colour edges stay sharp. */
static const kind jpeg = {"JPEG", AV_CODEC_ID_MJPEG, AV_PIX_FMT_YUVJ444P, fill_codes};
static const kind tiff = {"TIFF", AV_CODEC_ID_TIFF, AV_PIX_FMT_RGB24, fill_rgb};

static AVCodecContext *open_encoder(const kind *of, const pupil_image_const *image)
{
    const AVCodec *encoder = avcodec_find_encoder(of->codec);
    AVDictionary *more = NULL;
    AVCodecContext *c = encoder ? avcodec_alloc_context3(encoder) : NULL;
    if (!c)
        return NULL;
    c->width = (int)image->width;
    c->height = (int)image->height;
    c->pix_fmt = of->format;
    c->color_range = AVCOL_RANGE_JPEG;
    c->time_base = (AVRational){1, 1};
    c->thread_count = 1;
    c->flags |= AV_CODEC_FLAG_QSCALE | AV_CODEC_FLAG_BITEXACT;
    c->global_quality = QUALITY * FF_QP2LAMBDA;
    if (of->codec == AV_CODEC_ID_TIFF)
        av_dict_set(&more, "compression_algo", "lzw", 0);
    if (avcodec_open2(c, encoder, &more) < 0)
        avcodec_free_context(&c);
    av_dict_free(&more);
    return c;
}

static int encode(const kind *of, AVCodecContext *c, AVFrame *frame, AVPacket *packet, const pupil_image_const *image)
{
    frame->format = c->pix_fmt;
    frame->width = c->width;
    frame->height = c->height;
    frame->quality = c->global_quality;
    if (av_frame_get_buffer(frame, 0) < 0)
        return -1;
    of->fill(frame, image);
    return avcodec_send_frame(c, frame) < 0 || avcodec_send_frame(c, NULL) < 0 || avcodec_receive_packet(c, packet) < 0
               ? -1
               : 0;
}

static int save(const AVPacket *packet, const char *path)
{
    FILE *file = fopen(path, "wbe");
    int failed = !file || fwrite(packet->data, 1, (size_t)packet->size, file) != (size_t)packet->size;
    if (file && fclose(file) != 0)
        failed = 1;
    return failed;
}

/* JPEG and TIFF as written here do not name their colour space: viewers assume sRGB. */
static int write_kind(const kind *of, const char *path, const char *name, const pupil_image_const *image, int is_srgb,
                      pupil_why *why)
{
    if (!is_srgb)
        return pupil_refuse(why, "%s: a %s is written as sRGB alone; a .png says which transfer and primaries it has",
                            name, of->name);
    AVCodecContext *encoder = open_encoder(of, image);
    AVFrame *frame = av_frame_alloc();
    AVPacket *packet = av_packet_alloc();
    int failed = !encoder || !frame || !packet || encode(of, encoder, frame, packet, image);
    if (failed)
        pupil_refuse(why, "%s: libav's encoder of %s fails on %u x %u pixels", name, of->name, image->width,
                     image->height);
    else if ((failed = save(packet, path)))
        pupil_refuse(why, "%s: cannot be written: %s", name, strerror(errno));
    avcodec_free_context(&encoder);
    av_frame_free(&frame);
    av_packet_free(&packet);
    return failed ? -1 : 0;
}

int pupil_jpeg_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                     uint32_t transfer, pupil_why *why)
{
    return write_kind(&jpeg, path, name, image, primaries == PUPIL_PRIMARIES_BT709 && transfer == PUPIL_TRANSFER_SRGB,
                      why);
}

int pupil_tiff_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                     uint32_t transfer, pupil_why *why)
{
    return write_kind(&tiff, path, name, image, primaries == PUPIL_PRIMARIES_BT709 && transfer == PUPIL_TRANSFER_SRGB,
                      why);
}
