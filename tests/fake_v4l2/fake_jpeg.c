/* tests/fake_v4l2/fake_jpeg.c: the fake camera's picture as JPEGs like a webcam's. */
#include <linux/videodev2.h>
#include <stdlib.h>
#include <string.h>

#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>

#include "fake_v4l2_private.h"

/* Y'CbCr 4:2:2 in planes, of YUYV. */
static int fill(const fake_v4l2_picture *picture, AVFrame *frame)
{
    fake_v4l2_picture p = *picture;
    p.fourcc = V4L2_PIX_FMT_YUYV;
    p.stride_bytes[0] = (p.width + 1) / 2 * 4;
    unsigned char *yuyv = malloc((size_t)p.stride_bytes[0] * p.height);
    frame->width = (int)p.width;
    frame->height = (int)p.height;
    frame->format = AV_PIX_FMT_YUVJ422P;
    frame->quality = FF_QP2LAMBDA;
    if (!yuyv || av_frame_get_buffer(frame, 0) < 0) {
        free(yuyv);
        return -1;
    }
    fake_v4l2_draw(&p, yuyv, NULL, NULL);
    for (uint32_t y = 0; y < p.height; y++)
        for (uint32_t x = 0; x < p.width; x++) {
            const unsigned char *from = yuyv + (size_t)y * p.stride_bytes[0] + x / 2 * 4;
            frame->data[0][(ptrdiff_t)y * frame->linesize[0] + x] = from[x % 2 * 2];
            frame->data[1][(ptrdiff_t)y * frame->linesize[1] + x / 2] = from[1];
            frame->data[2][(ptrdiff_t)y * frame->linesize[2] + x / 2] = from[3];
        }
    free(yuyv);
    return 0;
}

/* Its tables are the standard ones; cameras leave out the segments that define them, and so does this. */
static uint32_t leave_out_tables(const AVPacket *packet, unsigned char *to, uint32_t room)
{
    const uint32_t size = (uint32_t)packet->size;
    uint32_t used = 2, at = 2;
    if (size > room || size < 4)
        return 0;
    memcpy(to, packet->data, 2);
    while (at + 4 <= size) {
        const uint32_t marker = packet->data[at + 1];
        const uint32_t length = marker == 0xda /* SOS: all the rest */
                                    ? size - at
                                    : 2 + ((uint32_t)packet->data[at + 2] << 8 | packet->data[at + 3]);
        if (length > size - at)
            return 0;
        if (marker != 0xc4) /* DHT */
            memcpy(to + used, packet->data + at, length);
        used += marker != 0xc4 ? length : 0;
        at += length;
    }
    return used;
}

static AVCodecContext *open_encoder(const fake_v4l2_picture *picture)
{
    const AVCodec *codec = avcodec_find_encoder(AV_CODEC_ID_MJPEG);
    AVCodecContext *encoder = codec ? avcodec_alloc_context3(codec) : NULL;
    if (!encoder)
        return NULL;
    encoder->width = (int)picture->width;
    encoder->height = (int)picture->height;
    encoder->pix_fmt = AV_PIX_FMT_YUVJ422P;
    encoder->time_base = (AVRational){1, 30};
    encoder->flags = AV_CODEC_FLAG_QSCALE | AV_CODEC_FLAG_BITEXACT;
    encoder->global_quality = FF_QP2LAMBDA; /* its best quality */
    encoder->qmin = 1;
    encoder->thread_count = 1;
    av_opt_set(encoder->priv_data, "huffman", "default", 0);
    if (avcodec_open2(encoder, codec, NULL) < 0)
        avcodec_free_context(&encoder);
    return encoder;
}

uint32_t fake_jpeg(const fake_v4l2_picture *picture, unsigned char *to, uint32_t room)
{
    AVCodecContext *encoder = open_encoder(picture);
    AVFrame *frame = av_frame_alloc();
    AVPacket *packet = av_packet_alloc();
    uint32_t bytes = 0;
    if (encoder && frame && packet && fill(picture, frame) == 0 && avcodec_send_frame(encoder, frame) == 0 &&
        avcodec_receive_packet(encoder, packet) == 0)
        bytes = leave_out_tables(packet, to, room);
    avcodec_free_context(&encoder);
    av_frame_free(&frame);
    av_packet_free(&packet);
    return bytes;
}
