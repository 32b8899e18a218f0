/* tests/drivers/file/each_call_inputs.h: a small file of each kind, made with the program's own writers or libav. */
#ifndef PUPIL_TESTS_DRIVERS_EACH_CALL_INPUTS_H
#define PUPIL_TESTS_DRIVERS_EACH_CALL_INPUTS_H

#include "clip.h"
#include "recording_frames.h"
#include "scratch.h"
#include "write_dng.h"
#include "write_jpeg.h"

#include "file/file_sink.h"
#include "file/sink/picture_sink.h"

enum { INPUT_WIDTH = 32, INPUT_HEIGHT = 16 };

/* Frames of waves (display) or of noise (linear), written by the sink for the path. */
static inline void input_write(const char *path, int is_linear, int frames)
{
    static uint8_t display[INPUT_HEIGHT * INPUT_WIDTH * 3];
    static float light[INPUT_HEIGHT * INPUT_WIDTH * 3];
    const pupil_sink_options options = {.width = INPUT_WIDTH,
                                        .height = INPUT_HEIGHT,
                                        .fps = 25,
                                        .primaries = PUPIL_PRIMARIES_BT709,
                                        .transfer = PUPIL_TRANSFER_SRGB};
    pupil_image_const image = {.data = display,
                               .stride_bytes = INPUT_WIDTH * 3,
                               .width = INPUT_WIDTH,
                               .height = INPUT_HEIGHT,
                               .pixel = PUPIL_PIXEL_RGB8};
    if (is_linear) {
        image.data = light;
        image.stride_bytes *= (ptrdiff_t)sizeof *light;
        image.pixel = PUPIL_PIXEL_RGB32F;
    }
    pupil_sink *sink;
    pupil_why why = {""};
    const int failed = is_linear ? pupil_linear_sink_open(path, &options, &sink, &why)
                                 : pupil_file_sink_open(path, &options, &sink, &why);
    CHECK_MSG(!failed, "%s", why.text);
    for (int n = 0; n < frames; n++) {
        for (int i = 0; i < INPUT_HEIGHT * INPUT_WIDTH * 3; i++) {
            display[i] = (uint8_t)(128 + 100 * sin(i * 0.003 + n));
            light[i] = (float)check_uniform();
        }
        CHECK_MSG(pupil_sink_write(sink, &image, &(pupil_frame_info){.timestamp_ns = n * INT64_C(40000000)}, &why) == 0,
                  "%s", why.text);
    }
    CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
}

static inline int input_code(const clip *c, int frame, int component, int x, int y)
{
    (void)c;
    return (37 * frame + 11 * component + 3 * x + 5 * y) & 255;
}

/* A lossless video; 0: this libav has no such codec. */
static inline int input_clip(const char *path, const char *container, const char *codec, enum AVPixelFormat format)
{
    const clip c = {.container = container,
                    .codec = codec,
                    .format = format,
                    .width = INPUT_WIDTH,
                    .height = INPUT_HEIGHT,
                    .frames = 3,
                    .space = AVCOL_SPC_BT709,
                    .transfer = AVCOL_TRC_BT709,
                    .primaries = AVCOL_PRI_BT709,
                    .range = AVCOL_RANGE_MPEG,
                    .code = input_code};
    return clip_write(&c, path) == 0;
}

/* A Matroska file with only sound, `seconds` long: 8000 samples a second of 16 bits. */
static inline void input_sound(const char *path, int seconds)
{
    AVFormatContext *out = NULL;
    AVPacket *packet = av_packet_alloc();
    avformat_alloc_output_context2(&out, NULL, "matroska", path);
    AVStream *stream = avformat_new_stream(out, NULL);
    AVCodecParameters *p = stream->codecpar;
    p->codec_type = AVMEDIA_TYPE_AUDIO;
    p->codec_id = AV_CODEC_ID_PCM_S16LE;
    p->format = AV_SAMPLE_FMT_S16;
    p->sample_rate = 8000;
    p->bits_per_coded_sample = 16;
    p->block_align = 2;
    av_channel_layout_default(&p->ch_layout, 1);
    CHECK(avio_open(&out->pb, path, AVIO_FLAG_WRITE) >= 0 && avformat_write_header(out, NULL) >= 0);
    for (int n = 0; n < 10 * seconds; n++) {
        CHECK(av_new_packet(packet, 1600) == 0);
        memset(packet->data, n, 1600);
        packet->pts = packet->dts = n * 100;
        packet->duration = 100;
        packet->stream_index = 0;
        CHECK(av_interleaved_write_frame(out, packet) >= 0);
        av_packet_unref(packet);
    }
    CHECK(av_write_trailer(out) == 0);
    avio_closep(&out->pb);
    avformat_free_context(out);
    av_packet_free(&packet);
}

static inline void input_dng(const char *path)
{
    enum { SIDE = 32 };
    static uint16_t sample[SIDE * SIDE * 3];
    static uint8_t bytes[DNG_HEAD + DNG_MORE + sizeof sample];
    const dng d = {SIDE, SIDE, 0, 256, 4095, {500, 1000, 800}, 1, sample};
    for (size_t i = 0; i < SIDE * SIDE; i++)
        sample[i] = (uint16_t)(300 + i);
    clip_store(path, bytes, dng_make(&d, bytes));
}

/* As from a webcam: without Huffman tables. */
static inline void input_recording_of_jpegs(const char *folder)
{
    static uint8_t bytes[2][65536];
    static const pupil_coding coding = {.matrix = PUPIL_MATRIX_BT601, .range = PUPIL_RANGE_FULL};
    static const pupil_recorder_options options = {.fps = 30, .wait = 1};
    pupil_recorder *recorder = NULL;
    pupil_why why = {""};
    for (int n = 0; n < 2; n++) {
        const flat_jpeg shape = {
            .width = 32, .height = 16, .components = 3, .across = 2, .down = 1, .seed = (uint64_t)n};
        const pupil_frame frame = {.image = {.width = 32, .height = 16, .pixel = PUPIL_PIXEL_YUYV, .coding = &coding},
                                   .info = {.timestamp_ns = n * INT64_C(33333333), .sequence = (uint64_t)n},
                                   .name = "test",
                                   .coded = bytes[n],
                                   .coded_bytes = flat_write(&shape, bytes[n])};
        if (!recorder)
            CHECK_MSG(pupil_recorder_open(&recorder, folder, &frame, &options, &why) == 0, "%s", why.text);
        CHECK_MSG(pupil_recorder_write(recorder, &frame, &why) == 0, "%s", why.text);
    }
    CHECK_MSG(pupil_recorder_close(recorder, &why) == 0, "%s", why.text);
}

#endif
