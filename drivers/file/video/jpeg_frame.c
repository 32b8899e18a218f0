#include "jpeg_frame.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include <libavcodec/avcodec.h>
#include <libavutil/pixdesc.h>

#include "jpeg_parse.h"
#include "refuse.h"
#include "video_io.h"

#define MOST_BYTES (INT_MAX / 2)

struct pupil_jpeg {
    uint32_t width, height;
    pupil_coding coding, grey_coding;
    AVCodecContext *codec;
    AVPacket *packet;
    AVFrame *frame;
    AVBufferRef *coded; /* with the padding that libavcodec may read */
    uint8_t *room;      /* samples that the library needs in another layout than the decoder's */
    size_t room_bytes;
    int has_own_tables; /* the decoder now has a frame's Huffman tables, not the standard's */
};

/* --- the decoder --- */

/* A new one has the standard's tables. */
static int start(pupil_jpeg *j)
{
    const AVCodec *decoder = avcodec_find_decoder(AV_CODEC_ID_MJPEG);
    avcodec_free_context(&j->codec);
    j->codec = decoder ? avcodec_alloc_context3(decoder) : NULL;
    if (!j->codec)
        return -1;
    j->codec->thread_count = 1;
    j->codec->flags |= AV_CODEC_FLAG_BITEXACT;
    j->codec->idct_algo = FF_IDCT_SIMPLE; /* its results are the same in all versions */
    j->codec->err_recognition = AV_EF_EXPLODE;
    j->codec->max_pixels = (int64_t)PUPIL_MAX_SIDE_PX * PUPIL_MAX_SIDE_PX;
    j->has_own_tables = 0;
    pupil_video_log_clear();
    return avcodec_open2(j->codec, decoder, NULL) < 0 ? -1 : 0;
}

/* Of grey, limited range is Y' 16..235 (Rec. ITU-R BT.601-7, item 2.5.3). */
static void set_coding(pupil_jpeg *j, const pupil_coding *coding)
{
    j->coding = coding ? *coding : (pupil_coding){.matrix = PUPIL_MATRIX_BT601, .range = PUPIL_RANGE_FULL};
    if (j->coding.light == PUPIL_LIGHT_DEFAULT)
        j->coding.light = PUPIL_LIGHT_SRGB;
    j->grey_coding = j->coding;
    if (j->coding.range == PUPIL_RANGE_LIMITED) {
        j->grey_coding.black = 16;
        j->grey_coding.white = 235;
    }
}

int pupil_jpeg_open(pupil_jpeg **jpeg, uint32_t width, uint32_t height, const pupil_coding *coding, pupil_why *why)
{
    const char *wrong = NULL;
    *jpeg = NULL;
    if (!width || !height || width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return pupil_refuse(why, "frames of %u x %u pixels; 1 to %u a side can be read", width, height,
                            PUPIL_MAX_SIDE_PX);
    if (coding && pupil_coding_check(coding, PUPIL_PIXEL_YUYV, &wrong))
        return pupil_refuse(why, "%s", wrong);
    pupil_jpeg *j = calloc(1, sizeof *j);
    if (!j)
        return pupil_refuse(why, "not enough memory");
    j->width = width;
    j->height = height;
    set_coding(j, coding);
    j->packet = av_packet_alloc();
    j->frame = av_frame_alloc();
    if (!j->packet || !j->frame || start(j)) {
        pupil_jpeg_close(j);
        return pupil_refuse(why, "libavcodec's decoder of JPEG does not start");
    }
    *jpeg = j;
    return 0;
}

void pupil_jpeg_close(pupil_jpeg *j)
{
    if (!j)
        return;
    avcodec_free_context(&j->codec);
    av_packet_free(&j->packet);
    av_frame_free(&j->frame);
    av_buffer_unref(&j->coded);
    free(j->room);
    free(j);
}

/* --- to the library's formats --- */

static int reserve(pupil_jpeg *j, size_t bytes)
{
    if (bytes <= j->room_bytes)
        return 0;
    free(j->room);
    j->room = malloc(bytes);
    j->room_bytes = j->room ? bytes : 0;
    return j->room ? 0 : -1;
}

static void to_yuyv(const AVFrame *f, uint8_t *out, size_t row_bytes)
{
    for (int y = 0; y < f->height; y++) {
        const uint8_t *luma = f->data[0] + (ptrdiff_t)y * f->linesize[0];
        const uint8_t *cb = f->data[1] + (ptrdiff_t)y * f->linesize[1];
        const uint8_t *cr = f->data[2] + (ptrdiff_t)y * f->linesize[2];
        uint8_t *to = out + (size_t)y * row_bytes;
        for (int x = 0; x < f->width / 2; x++) {
            to[4 * x] = luma[2 * x];
            to[4 * x + 1] = cb[x];
            to[4 * x + 2] = luma[2 * x + 1];
            to[4 * x + 3] = cr[x];
        }
        if (f->width % 2) { /* for an odd width the last pixel is repeated */
            const int x = f->width / 2;
            to[4 * x] = to[4 * x + 2] = luma[2 * x];
            to[4 * x + 1] = cb[x];
            to[4 * x + 3] = cr[x];
        }
    }
}

static void to_nv12_chroma(const AVFrame *f, uint8_t *out, size_t row_bytes)
{
    for (int y = 0; y < (f->height + 1) / 2; y++) {
        const uint8_t *cb = f->data[1] + (ptrdiff_t)y * f->linesize[1];
        const uint8_t *cr = f->data[2] + (ptrdiff_t)y * f->linesize[2];
        uint8_t *to = out + (size_t)y * row_bytes;
        for (int x = 0; x < (f->width + 1) / 2; x++) {
            to[2 * x] = cb[x];
            to[2 * x + 1] = cr[x];
        }
    }
}

static uint8_t round_code(double value)
{
    return value <= 0 ? 0 : value >= 255 ? 255 : (uint8_t)(value + 0.5);
}

/* Chroma of the pixel's own block: 4:4:4 has one for each. */
static void to_rgb(const AVFrame *f, const AVPixFmtDescriptor *d, const pupil_coding *coding, uint8_t *out,
                   size_t row_bytes)
{
    static const double reds[] = {0.299, 0.2126, 0.2627}, blues[] = {0.114, 0.0722, 0.0593}; /* pupil/coding.h */
    const double kr = reds[coding->matrix], kb = blues[coding->matrix], kg = 1 - kr - kb;
    const int full = coding->range == PUPIL_RANGE_FULL;
    const double luma_gain = full ? 1 : 255.0 / 219, chroma_gain = full ? 1 : 255.0 / 224;
    for (int y = 0; y < f->height; y++) {
        const uint8_t *luma = f->data[0] + (ptrdiff_t)y * f->linesize[0];
        const uint8_t *cbs = f->data[1] + (ptrdiff_t)(y >> d->log2_chroma_h) * f->linesize[1];
        const uint8_t *crs = f->data[2] + (ptrdiff_t)(y >> d->log2_chroma_h) * f->linesize[2];
        uint8_t *to = out + (size_t)y * row_bytes;
        for (int x = 0; x < f->width; x++, to += 3) {
            const double l = (luma[x] - (full ? 0 : 16)) * luma_gain;
            const double cb = (cbs[x >> d->log2_chroma_w] - 128) * chroma_gain;
            const double cr = (crs[x >> d->log2_chroma_w] - 128) * chroma_gain;
            to[0] = round_code(l + 2 * (1 - kr) * cr);
            to[1] = round_code(l - 2 * kb * (1 - kb) / kg * cb - 2 * kr * (1 - kr) / kg * cr);
            to[2] = round_code(l + 2 * (1 - kb) * cb);
        }
    }
}

/* The library's format for a decoded frame; PUPIL_PIXEL_NONE if it is not read. */
static uint32_t pixel_of(const AVPixFmtDescriptor *d)
{
    if (!d || d->comp[0].depth != 8 || d->comp[0].step != 1 ||
        d->flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_ALPHA))
        return PUPIL_PIXEL_NONE;
    if (d->nb_components == 1)
        return PUPIL_PIXEL_GREY8;
    if (d->nb_components != 3 || !(d->flags & AV_PIX_FMT_FLAG_PLANAR))
        return PUPIL_PIXEL_NONE;
    if (d->log2_chroma_w == 1 && d->log2_chroma_h == 0)
        return PUPIL_PIXEL_YUYV;
    if (d->log2_chroma_w == 1 && d->log2_chroma_h == 1)
        return PUPIL_PIXEL_NV12;
    return PUPIL_PIXEL_RGB8;
}

static int present(pupil_jpeg *j, pupil_image_const *image, pupil_why *why)
{
    const AVFrame *f = j->frame;
    const AVPixFmtDescriptor *d = av_pix_fmt_desc_get((enum AVPixelFormat)f->format);
    const uint32_t pixel = pixel_of(d);
    const int grey = pixel == PUPIL_PIXEL_GREY8;
    if (pixel == PUPIL_PIXEL_NONE)
        return pupil_refuse(why, "a JPEG of %s; grey and Y'CbCr of 8 bits can be read",
                            d ? d->name : "an unknown kind");
    if (pixel == PUPIL_PIXEL_RGB8 && j->coding.light != PUPIL_LIGHT_SRGB)
        return pupil_refuse(why, "a JPEG of %s whose light is not sRGB's; of 4:2:2 and 4:2:0 it may be any", d->name);
    const size_t row_bytes =
        pixel == PUPIL_PIXEL_NV12 ? (size_t)j->width + j->width % 2 : pupil_row_bytes(pixel, j->width);
    const size_t rows = pixel == PUPIL_PIXEL_NV12 ? (j->height + 1) / 2 : j->height;
    if (!grey && reserve(j, row_bytes * rows))
        return pupil_refuse(why, "not enough memory for a frame of %u x %u", j->width, j->height);
    *image = (pupil_image_const){.data = f->data[0],
                                 .stride_bytes = f->linesize[0],
                                 .width = j->width,
                                 .height = j->height,
                                 .pixel = pixel,
                                 .coding = grey ? &j->grey_coding : &j->coding};
    if (pixel == PUPIL_PIXEL_NV12) {
        to_nv12_chroma(f, j->room, row_bytes);
        image->chroma = j->room;
        image->chroma_stride_bytes = (ptrdiff_t)row_bytes;
    } else if (!grey) {
        if (pixel == PUPIL_PIXEL_YUYV)
            to_yuyv(f, j->room, row_bytes);
        else
            to_rgb(f, d, &j->coding, j->room, row_bytes);
        image->data = j->room;
        image->stride_bytes = (ptrdiff_t)row_bytes;
    }
    return 0;
}

/* --- a frame --- */

/* Room for a JPEG with some to spare: no two have the same size. */
static int reserve_coded(pupil_jpeg *j, size_t bytes)
{
    if (j->coded && bytes + AV_INPUT_BUFFER_PADDING_SIZE <= j->coded->size)
        return 0;
    av_buffer_unref(&j->coded);
    j->coded = av_buffer_alloc(bytes + bytes / 2 + AV_INPUT_BUFFER_PADDING_SIZE);
    return j->coded ? 0 : -1;
}

static int decode(pupil_jpeg *j, size_t used, pupil_why *why)
{
    memset(j->coded->data + used, 0, AV_INPUT_BUFFER_PADDING_SIZE);
    j->packet->buf = av_buffer_ref(j->coded);
    j->packet->data = j->coded->data;
    j->packet->size = (int)used;
    pupil_video_log_clear();
    int code = j->packet->buf ? avcodec_send_packet(j->codec, j->packet) : AVERROR(ENOMEM);
    av_packet_unref(j->packet);
    if (code == 0)
        code = avcodec_receive_frame(j->codec, j->frame);
    const char *words = pupil_video_log_text();
    if (code < 0 || *words || j->frame->decode_error_flags || j->frame->flags & AV_FRAME_FLAG_CORRUPT) {
        char name[AV_ERROR_MAX_STRING_SIZE] = "its decoder marks it so";
        if (code < 0)
            av_strerror(code, name, sizeof name);
        pupil_refuse(why, "a damaged JPEG: %s", *words ? words : name);
        avcodec_flush_buffers(j->codec);
        return -1;
    }
    if ((uint32_t)j->frame->width != j->width || (uint32_t)j->frame->height != j->height)
        return pupil_refuse(why, "a damaged JPEG: decoded, it has %d x %d pixels", j->frame->width, j->frame->height);
    return 0;
}

int pupil_jpeg_decode(pupil_jpeg *j, const void *bytes, size_t size, pupil_image_const *image, pupil_why *why)
{
    pupil_jpeg_shape shape;
    if (size > MOST_BYTES)
        return pupil_refuse(why, "a JPEG of %zu bytes; at most %d can be read", size, MOST_BYTES);
    if (reserve_coded(j, size))
        return pupil_refuse(why, "not enough memory for a JPEG of %zu bytes", size);
    const size_t used = pupil_jpeg_parse(bytes, size, j->coded->data, &shape, why);
    if (!used)
        return -1;
    if (shape.width != j->width || shape.height != j->height)
        return pupil_refuse(why, "a JPEG of %u x %u pixels; %u x %u were expected", shape.width, shape.height, j->width,
                            j->height);
    if (!shape.has_huffman_tables && j->has_own_tables && start(j))
        return pupil_refuse(why, "libavcodec's decoder of JPEG does not start again");
    j->has_own_tables |= shape.has_huffman_tables;
    return decode(j, used, why) || present(j, image, why) ? -1 : 0;
}
