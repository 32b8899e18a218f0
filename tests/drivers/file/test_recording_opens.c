/* What other programs see in a recording: for every frame, libavformat finds a key frame with the same time and bytes,
 * and FFmpeg's own pixel format if it has one. */
#include "check.h"
#include "scratch.h"

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/log.h>
#include <libavutil/pixdesc.h>

#include "file/recording/recording.h"
#include "recording_frames.h"

#define COUNT 40

static pupil_why why;

/* The pixel format that FFmpeg decodes to, for the coding's mosaic order. NULL: it has none. */
static const char *name_of(uint32_t pixel, uint32_t bayer)
{
    static const char *const orders[] = {"rggb", "grbg", "gbrg", "bggr"};
    static const char *const names[PUPIL_PIXEL_COUNT] = {
        [PUPIL_PIXEL_RGBA16] = "rgba64le", [PUPIL_PIXEL_RGB16] = "rgb48le",   [PUPIL_PIXEL_RGBA8] = "rgba",
        [PUPIL_PIXEL_RGB8] = "rgb24",      [PUPIL_PIXEL_YUYV] = "yuyv422",    [PUPIL_PIXEL_NV12] = "nv12",
        [PUPIL_PIXEL_GREY8] = "gray",      [PUPIL_PIXEL_GREY10] = "gray10le", [PUPIL_PIXEL_GREY12] = "gray12le",
        [PUPIL_PIXEL_GREY16] = "gray16le", [PUPIL_PIXEL_I420] = "yuv420p",    [PUPIL_PIXEL_I420_10] = "yuv420p10le",
        [PUPIL_PIXEL_NV21] = "nv21",       [PUPIL_PIXEL_UYVY] = "uyvy422",    [PUPIL_PIXEL_BGR8] = "bgr24",
        [PUPIL_PIXEL_BGRX8] = "bgr0",      [PUPIL_PIXEL_RGBX8] = "rgb0",      [PUPIL_PIXEL_I444_16] = "yuv444p16le"};
    static char name[32];
    if (!pupil_pixel_is_mosaic(pixel))
        return names[pixel];
    if (pixel >= PUPIL_PIXEL_BAYER10P)
        return NULL;
    snprintf(name, sizeof name, "bayer_%s%s", orders[bayer], pixel == PUPIL_PIXEL_BAYER8 ? "8" : "16le");
    return name;
}

/* A frame's bytes as a recording has them. */
static size_t tight(const pupil_image_const *image, unsigned char *bytes)
{
    const size_t row = pupil_row_bytes(image->pixel, image->width),
                 chroma_row = pupil_chroma_row_bytes(image->pixel, image->width);
    const uint32_t chroma_rows = pupil_chroma_rows(image->pixel, image->height);
    unsigned char *to = bytes;
    for (uint32_t y = 0; y < image->height; y++, to += row)
        memcpy(to, (const char *)image->data + (ptrdiff_t)y * image->stride_bytes, row);
    for (uint32_t y = 0; y < chroma_rows; y++, to += chroma_row)
        memcpy(to, (const char *)image->chroma + (ptrdiff_t)y * image->chroma_stride_bytes, chroma_row);
    for (uint32_t y = 0; image->cr && y < chroma_rows; y++, to += chroma_row)
        memcpy(to, (const char *)image->cr + (ptrdiff_t)y * image->cr_stride_bytes, chroma_row);
    return (size_t)(to - bytes);
}

static void check_decoded(AVStream *stream, AVPacket *packet, const char *name, const unsigned char *bytes, size_t size)
{
    AVCodecContext *decoder = avcodec_alloc_context3(avcodec_find_decoder(stream->codecpar->codec_id));
    AVFrame *frame = av_frame_alloc();
    unsigned char *got = malloc(size);
    avcodec_parameters_to_context(decoder, stream->codecpar);
    CHECK(avcodec_open2(decoder, NULL, NULL) == 0);
    CHECK(avcodec_send_packet(decoder, packet) == 0 && avcodec_receive_frame(decoder, frame) == 0);
    CHECK_MSG(strcmp(av_get_pix_fmt_name(frame->format), name) == 0, "%s: %s", name,
              av_get_pix_fmt_name(frame->format));
    const int copied = av_image_copy_to_buffer(got, (int)size, (const uint8_t *const *)frame->data, frame->linesize,
                                               frame->format, frame->width, frame->height, 1);
    CHECK_MSG(copied == (int)size && memcmp(got, bytes, size) == 0, "%s: %d of %d bytes", name, copied, (int)size);
    free(got);
    av_frame_free(&frame);
    avcodec_free_context(&decoder);
}

/* How many frames it finds. */
static int check_open(const test_frames *frames, const char *folder, uint32_t primaries, int decode)
{
    static unsigned char bytes[1 << 16];
    char path[1100];
    AVFormatContext *format = NULL;
    AVPacket *packet = av_packet_alloc();
    const pupil_image_const *image = &frames->frame[0].image;
    const char *name = name_of(image->pixel, frames->coding.bayer);
    int n = 0;
    snprintf(path, sizeof path, "%s/frames.mkv", folder);
    CHECK(avformat_open_input(&format, path, NULL, NULL) == 0 && avformat_find_stream_info(format, NULL) >= 0);
    CHECK(strstr(format->iformat->name, "matroska") && format->nb_streams == 1);
    AVStream *stream = format->streams[0];
    CHECK(stream->codecpar->codec_id == AV_CODEC_ID_RAWVIDEO && stream->codecpar->width == (int)image->width &&
          stream->codecpar->height == (int)image->height);
    CHECK(av_cmp_q(stream->avg_frame_rate, (AVRational){30, 1}) == 0);
    CHECK(stream->codecpar->color_primaries ==
          (primaries == PUPIL_PRIMARIES_BT2020 ? AVCOL_PRI_BT2020 : AVCOL_PRI_UNSPECIFIED));
    if (name && !strcmp(name, "yuyv422"))
        CHECK(stream->codecpar->color_range ==
                  (frames->coding.range == PUPIL_RANGE_FULL ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG) &&
              stream->codecpar->color_space == (frames->coding.matrix == PUPIL_MATRIX_BT709   ? AVCOL_SPC_BT709
                                                : frames->coding.matrix == PUPIL_MATRIX_BT601 ? AVCOL_SPC_SMPTE170M
                                                                                              : AVCOL_SPC_BT2020_NCL));
    while (av_read_frame(format, packet) == 0 && n < frames->count) {
        const size_t size = tight(&frames->frame[n].image, bytes);
        const int64_t ms = av_rescale_q(packet->pts, stream->time_base, (AVRational){1, 1000});
        CHECK(packet->flags & AV_PKT_FLAG_KEY && packet->size == (int)size && !memcmp(packet->data, bytes, size));
        CHECK_MSG(ms == frames->frame[n].info.timestamp_ns / 1000000, "frame %d at %lld ms", n, (long long)ms);
        if (decode && name && n < 3)
            check_decoded(stream, packet, name, bytes, size);
        av_packet_unref(packet);
        n++;
    }
    av_packet_free(&packet);
    avformat_close_input(&format);
    return n;
}

static void test_formats(void)
{
    static const uint32_t sizes[][2] = {{32, 16}, {5, 3}};
    for (uint32_t pixel = 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        for (int odd = 0; odd < 2; odd++) {
            const uint32_t primaries = odd ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709;
            const pupil_recorder_options options = {.fps = 30, .wait = 1, .primaries = primaries};
            test_frames frames;
            if (odd && pupil_pixel_is_mosaic(pixel))
                continue;
            frames_make(&frames, pixel, sizes[odd][0], sizes[odd][1], COUNT);
            for (int i = 0; i < COUNT; i++)
                frames.frame[i].info.timestamp_ns = i * INT64_C(33333000);
            const char *folder = scratch("opens");
            CHECK(frames_record(&frames, folder, &options, &why) == COUNT);
            CHECK_MSG(check_open(&frames, folder, primaries, 1) == COUNT, "pixel %u", pixel);
            /* without what close writes, and with half a frame at the end, as after a kill */
            char path[1100];
            snprintf(path, sizeof path, "%s/opens/frames.mkv", scratch_folder);
            struct stat s;
            CHECK(stat(path, &s) == 0 && truncate(path, s.st_size / 2) == 0);
            const int half = check_open(&frames, folder, primaries, 0);
            CHECK_MSG(half > 0 && half < COUNT, "%d frames of the half", half);
            scratch_clear(folder);
            frames_free(&frames);
        }
}

/* More frames than the index has entries: seeking to a time finds its frame, or the one before it in the index. */
static void test_seek(void)
{
    const pupil_recorder_options options = {.fps = 1000, .wait = 1};
    test_frames frames;
    pupil_recorder *recorder;
    char path[1100];
    frames_make(&frames, PUPIL_PIXEL_GREY8, 2, 2, 1);
    CHECK(pupil_recorder_open(&recorder, scratch("seek"), &frames.frame[0], &options, &why) == 0);
    for (int i = 0; i < 5000; i++) {
        frames.frame[0].info.timestamp_ns = i * INT64_C(1000000);
        CHECK(pupil_recorder_write(recorder, &frames.frame[0], &why) == 0);
    }
    CHECK(pupil_recorder_close(recorder, &why) == 0);
    AVFormatContext *format = NULL;
    AVPacket *packet = av_packet_alloc();
    snprintf(path, sizeof path, "%s/seek/frames.mkv", scratch_folder);
    CHECK(avformat_open_input(&format, path, NULL, NULL) == 0 && avformat_find_stream_info(format, NULL) >= 0);
    CHECK_MSG(format->duration == 5000000, "%lld us", (long long)format->duration);
    AVStream *stream = format->streams[0];
    for (int64_t ms = 4990; ms > 0; ms -= 499) {
        const int64_t pts = av_rescale_q(ms, (AVRational){1, 1000}, stream->time_base);
        CHECK(av_seek_frame(format, 0, pts, AVSEEK_FLAG_BACKWARD) >= 0 && av_read_frame(format, packet) == 0);
        const int64_t at = av_rescale_q(packet->pts, stream->time_base, (AVRational){1, 1000});
        CHECK_MSG(at <= ms && at > ms - 8, "%d ms for %d", (int)at, (int)ms);
        av_packet_unref(packet);
    }
    av_packet_free(&packet);
    avformat_close_input(&format);
    frames_free(&frames);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    av_log_set_level(AV_LOG_QUIET);
    test_formats();
    test_seek();
    scratch_clear(scratch_folder);
    return check_end();
}
