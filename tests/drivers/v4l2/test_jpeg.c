/* An MJPG camera: its frames decoded and in their coded form, undecodable ones, and which format is chosen. */
#include "fake_source.h"

#include <linux/videodev2.h>

static fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    return config;
}

/* The frame's samples against those of the coded picture: they differ by the encoder's quantisation, at best 1 to 10
 * codes (MPEG's default matrix of 8..83, ISO/IEC 13818-2, 6.3.11, by 8). */
static void check_picture(const pupil_frame *frame, uint32_t seed, uint32_t sequence)
{
    const pupil_image_const *image = &frame->image;
    fake_v4l2_picture p = {.seed = seed,
                           .sequence = sequence,
                           .fourcc = V4L2_PIX_FMT_YUYV,
                           .width = image->width,
                           .height = image->height,
                           .stride_bytes = {image->width * 2},
                           .ycbcr_enc = V4L2_YCBCR_ENC_601,
                           .quantization = V4L2_QUANTIZATION_FULL_RANGE,
                           .xfer_func = V4L2_XFER_FUNC_SRGB,
                           .scale = 1.0};
    unsigned char *want = malloc((size_t)p.stride_bytes[0] * p.height);
    unsigned off = 0, most = 0;
    if (!want)
        abort();
    fake_v4l2_draw(&p, want, NULL, NULL);
    for (uint32_t y = 0; y < p.height; y++)
        for (uint32_t x = 0; x < 2 * p.width; x++) {
            const int one = ((const unsigned char *)image->data)[(ptrdiff_t)y * image->stride_bytes + x];
            const unsigned apart = (unsigned)abs(one - want[y * p.stride_bytes[0] + x]);
            off += apart;
            most = apart > most ? apart : most;
        }
    CHECK_MSG(most <= 10 && off < 2 * p.width * p.height, "frame %u: %u apart at most, %u in all", sequence, most, off);
    free(want);
}

static void check_coded(const pupil_frame *frame, const fake_source *s)
{
    const unsigned char *bytes = frame->coded;
    const pupil_v4l2_frame *f = pupil_live_frame(s->source);
    const pupil_v4l2_buffer *buffer = &pupil_live_capture(s->source)->buffer[f->index];
    CHECK(bytes == (const unsigned char *)buffer->memory[0] + f->offset_bytes[0]);
    CHECK(frame->coded_bytes > 500 && frame->coded_bytes < buffer->bytes[0]);
    CHECK(bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[frame->coded_bytes - 1] == 0xd9);
}

static void test_stream(void)
{
    for (int kind = 0; kind < 4; kind++) {
        fake_v4l2_config config = usual();
        const pupil_v4l2_options options = {
            .fourcc = V4L2_PIX_FMT_MJPEG, .width = kind & 1 ? 320 : 64, .height = kind & 1 ? 240 : 48};
        config.multiplanar = kind >= 2;
        config.data_offset = kind >= 2 ? 48 : 0;
        fake_source s = fake_source_open("/dev/video0", &config, &options);
        CHECK_MSG(s.result == 0, "%s", s.why.text);
        for (uint32_t i = 0; i < 5 && s.source; i++) {
            pupil_frame frame;
            CHECK_MSG(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME, "%s", s.why.text);
            CHECK(frame.image.pixel == PUPIL_PIXEL_YUYV && frame.image.width == options.width);
            CHECK(frame.image.height == options.height && frame.info.sequence == i && frame.image.coding);
            CHECK(frame.image.coding->range == PUPIL_RANGE_FULL && frame.image.coding->light == PUPIL_LIGHT_SRGB);
            check_picture(&frame, 1, i);
            check_coded(&frame, &s);
            pupil_source_done(s.source, &frame);
        }
        fake_source_close(&s);
    }
}

/* Raw formats have no coded form; without a request, one of them is preferred to JPEG. */
static void test_choice(void)
{
    fake_v4l2_config config = usual();
    pupil_frame frame;
    config.only_format = V4L2_PIX_FMT_MJPEG;
    fake_source s = fake_source_open("/dev/video0", &config, NULL);
    CHECK(s.result == 0 && pupil_live_capture(s.source)->format.compressed);
    fake_source_close(&s);

    config.only_format = 0; /* MJPG, its first format, and all others; set to MJPG by another program before */
    fake_v4l2 *fake = fake_v4l2_new(&config);
    const pupil_v4l2_options mjpg = {.system = fake_v4l2_system(fake), .fourcc = V4L2_PIX_FMT_MJPEG};
    const pupil_v4l2_options any = {.system = fake_v4l2_system(fake)};
    pupil_why why;
    pupil_source *source = NULL;
    CHECK(pupil_live_open("0", NULL, &(pupil_live_options){.capture = mjpg, .hands_off = 1}, &source, &why) == 0);
    pupil_source_close(source);
    CHECK(pupil_live_open("0", NULL, &(pupil_live_options){.capture = any, .hands_off = 1}, &source, &why) == 0);
    CHECK(pupil_live_capture(source)->format.fourcc == V4L2_PIX_FMT_YUYV);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME);
    CHECK(!frame.coded && !frame.coded_bytes && frame.image.data);
    pupil_source_close(source);
    fake_v4l2_free(fake);
}

/* Truncated JPEGs are left out, counted, and missing in the sequence numbers. */
static void test_damaged(void)
{
    fake_v4l2_config config = usual();
    const pupil_v4l2_options options = {.fourcc = V4L2_PIX_FMT_MJPEG, .timeout_s = 2};
    uint64_t missing = 0, last = 0;
    config.cut = 0.3;
    config.seed = check_random();
    fake_source s = fake_source_open("/dev/video0", &config, &options);
    for (int i = 0; i < 100; i++) {
        pupil_frame frame;
        CHECK_MSG(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME, "%s", s.why.text);
        missing += i ? frame.info.sequence - last - 1 : frame.info.sequence;
        last = frame.info.sequence;
        pupil_source_done(s.source, &frame);
    }
    const pupil_live_counts *c = fake_source_counts(&s);
    CHECK_MSG(c->damaged == missing && missing > 15 && missing < 90 && c->lost == 0, "%llu damaged, %llu missing",
              (unsigned long long)c->damaged, (unsigned long long)missing);
    fake_source_close(&s);

    config.cut = 1.0;
    s = fake_source_open("/dev/video0", &config, &options);
    const pupil_v4l2_system *system = fake_v4l2_system(s.fake);
    const int64_t began_ns = system->now_ns(system->context);
    pupil_frame frame;
    CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(
        strstr(s.why.text, "/dev/video0: no whole frame within 2 seconds; the last one is a JPEG that is cut short"),
        "%s", s.why.text);
    CHECK(system->now_ns(system->context) - began_ns < INT64_C(2200000000));
    fake_source_close(&s);
}

/* A camera that comes back with frames of another size. */
static void test_again(void)
{
    fake_v4l2_config config = usual();
    const pupil_v4l2_options options = {.timeout_s = 1, .reopen_s = 20};
    config.only_format = V4L2_PIX_FMT_MJPEG;
    config.change_at = 3;
    fake_source s = fake_source_open("/dev/video0", &config, &options);
    for (uint32_t i = 0; i < 6; i++) {
        pupil_frame frame;
        CHECK_MSG(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME, "%u: %s", i, s.why.text);
        CHECK_MSG(frame.image.width == (i < 3 ? 64 : 32) && frame.image.height == (i < 3 ? 48 : 24), "frame %u: %u", i,
                  frame.image.width);
        pupil_source_done(s.source, &frame);
    }
    CHECK(fake_source_counts(&s)->reopened == 1);
    fake_source_close(&s);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_stream();
    test_choice();
    test_damaged();
    test_again();
    return check_end();
}
