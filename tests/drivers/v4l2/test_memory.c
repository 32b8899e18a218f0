/* Memory that the CPU reads slowly is detected, and the next best kind is used. Frames are the same in each kind, and
 * dma-bufs are read between their syncs (the fake's contain nothing new before). */
#include "fake_source.h"

#include <errno.h>
#include <linux/videodev2.h>

static fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    return config;
}

static unsigned differing_rows(const void *a, ptrdiff_t a_stride, const void *b, ptrdiff_t b_stride, uint32_t rows,
                               size_t bytes)
{
    unsigned wrong = 0;
    for (uint32_t y = 0; y < rows; y++)
        wrong += memcmp((const char *)a + y * a_stride, (const char *)b + y * b_stride, bytes) != 0;
    return wrong;
}

/* Of YUYV and NM12: the frame is what the fake draws. */
static void check_frame(const fake_source *s, const pupil_frame *frame)
{
    static unsigned char data[320 * 240 * 2], chroma[320 * 240], cr[320 * 240];
    const pupil_v4l2_format *f = &pupil_live_capture(s->source)->format;
    const pupil_image_const *image = &frame->image;
    fake_v4l2_picture p = {.seed = 1,
                           .sequence = pupil_live_frame(s->source)->sequence,
                           .fourcc = f->fourcc,
                           .width = f->width,
                           .height = f->height,
                           .ycbcr_enc = V4L2_YCBCR_ENC_601,
                           .quantization = V4L2_QUANTIZATION_LIM_RANGE,
                           .xfer_func = V4L2_XFER_FUNC_SRGB,
                           .scale = 1.0};
    const uint32_t row = p.stride_bytes[0] = (uint32_t)pupil_row_bytes(f->pixel, f->width);
    const uint32_t chroma_row = p.stride_bytes[1] = p.stride_bytes[2] =
        (uint32_t)pupil_chroma_row_bytes(f->pixel, f->width);
    const uint32_t rows = pupil_chroma_rows(f->pixel, f->height);
    fake_v4l2_draw(&p, data, chroma, cr);
    unsigned wrong = differing_rows(data, row, image->data, image->stride_bytes, f->height, row);
    if (image->chroma)
        wrong += differing_rows(chroma, chroma_row, image->chroma, image->chroma_stride_bytes, rows, chroma_row);
    if (image->cr)
        wrong += differing_rows(cr, chroma_row, image->cr, image->cr_stride_bytes, rows, chroma_row);
    CHECK_MSG(wrong == 0, "frame %u: %u rows differ", p.sequence, wrong);
}

/* Some frames, two of which are held for a while: each is valid until it is given back. */
static void check_stream(fake_source *s)
{
    for (int i = 0; i < 9 && s->source; i++) {
        pupil_frame frame;
        CHECK_MSG(fake_source_next(s, &frame) == PUPIL_SOURCE_FRAME, "%s", s->why.text);
        CHECK(frame.image.width == 64 && frame.info.sequence == (uint64_t)i);
        if (frame.coded)
            CHECK(frame.coded_bytes > 500 && ((const unsigned char *)frame.coded)[1] == 0xd8);
        else
            check_frame(s, &frame);
        pupil_source_done(s->source, &frame);
    }
}

typedef struct memory_case {
    const char *name;
    int slow, hints, heaps, contiguous, no_import, no_mmap;
    uint32_t asked, reading;
    int is_slow; /* the memory that is read in the end */
    const char *heap;
} memory_case;

static const memory_case cases[] = {
    {"fast", 0, 0, 0, 0, 0, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_MAPPED, 0, NULL},
    {"fast, though there is a heap", 0, 1, 2, 0, 0, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_MAPPED, 0, NULL},
    {"hints", 1, 1, 2, 0, 0, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_HINTED, 0, NULL},
    {"hints that do nothing", 1, 2, 1, 0, 0, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_HEAP, 0,
     "/dev/dma_heap/system"},
    {"a heap", 1, 0, 2, 0, 0, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_HEAP, 0, "/dev/dma_heap/system"},
    {"a contiguous heap", 1, 0, 2, 1, 0, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_HEAP, 0,
     "/dev/dma_heap/linux,cma"},
    {"no contiguous heap", 1, 0, 1, 1, 0, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_COPIED, 1, NULL},
    {"no heap", 1, 0, 0, 0, 0, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_COPIED, 1, NULL},
    {"no import", 1, 0, 2, 0, 1, 0, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_COPIED, 1, NULL},
    {"no maps", 1, 0, 0, 0, 0, 1, PUPIL_V4L2_MEMORY_AUTO, PUPIL_V4L2_READS_OWN, 0, NULL},
    {"maps forced", 1, 1, 2, 0, 0, 0, PUPIL_V4L2_MEMORY_MMAP, PUPIL_V4L2_READS_MAPPED, 1, NULL},
    {"own forced", 0, 0, 0, 0, 0, 0, PUPIL_V4L2_MEMORY_USERPTR, PUPIL_V4L2_READS_OWN, 0, NULL},
    {"a heap forced", 0, 0, 1, 0, 0, 0, PUPIL_V4L2_MEMORY_HEAP, PUPIL_V4L2_READS_HEAP, 0, "/dev/dma_heap/system"},
};

static fake_v4l2_config config_of(const memory_case *m)
{
    fake_v4l2_config c = usual();
    c.slow = m->slow;
    c.hints = m->hints;
    c.heaps = m->heaps;
    c.contiguous = m->contiguous;
    c.no_import = m->no_import;
    c.no_mmap = m->no_mmap;
    return c;
}

static void test_kinds(void)
{
    static const uint32_t formats[] = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_NV12M, V4L2_PIX_FMT_YUV420M, V4L2_PIX_FMT_MJPEG};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int k = 0; k < 8; k++) {
            const memory_case *m = &cases[i];
            const pupil_v4l2_options options = {.fourcc = formats[k / 2], .memory = m->asked, .late = k & 1};
            fake_v4l2_config config = config_of(m);
            config.multiplanar = k >= 2 && k < 6;
            config.data_offset = config.multiplanar ? 96 : 0;
            fake_source s = fake_source_open("/dev/video0", &config, &options);
            CHECK_MSG(s.result == 0, "%s: %s", m->name, s.why.text);
            if (s.source) {
                const pupil_v4l2_capture *c = pupil_live_capture(s.source);
                CHECK_MSG(c->reading == m->reading, "%s: %s", m->name, pupil_v4l2_reading_name(c->reading));
                CHECK_MSG(pupil_v4l2_is_slow(&c->speed) == m->is_slow, "%s: %g of %g", m->name, c->speed.bytes_s,
                          c->speed.ordinary);
                CHECK_MSG(!m->heap == !c->heap && (!m->heap || strcmp(m->heap, c->heap) == 0), "%s: %s", m->name,
                          c->heap ? c->heap : "no heap");
                if (c->reading != PUPIL_V4L2_READS_OWN) /* that one is not measured: it is ordinary memory */
                    CHECK(c->speed.ordinary == 8e9 && c->speed.bytes_s == (m->is_slow ? 0.4e9 : 8e9));
            }
            check_stream(&s);
            fake_source_close(&s);
        }
}

/* The caller's own buffers, which stay open. */
static void test_callers(void)
{
    static const uint32_t formats[] = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_NV12M, V4L2_PIX_FMT_YVU420M};
    for (uint32_t areas = 1; areas <= 3; areas++) {
        fake_v4l2_config config = usual();
        int fds[9];
        config.heaps = 1;
        config.slow = 1;
        config.multiplanar = areas > 1;
        fake_source s = {.fake = fake_v4l2_new(&config)};
        const pupil_v4l2_system *system = fake_v4l2_system(s.fake);
        const int heap = system->open(system->context, "/dev/dma_heap/system");
        for (uint32_t i = 0; i < 3 * areas; i++)
            fds[i] = pupil_v4l2_heap_buffer(system, heap, 8192);
        CHECK(heap >= 0 && fds[3 * areas - 1] >= 0);
        const pupil_v4l2_options options = {.system = system,
                                            .memory = PUPIL_V4L2_MEMORY_DMABUF,
                                            .fourcc = formats[areas - 1],
                                            .dmabuf = fds,
                                            .dmabufs = 3};
        s.result =
            pupil_live_open("0", NULL, &(pupil_live_options){.capture = options, .hands_off = 1}, &s.source, &s.why);
        CHECK_MSG(s.result == 0, "%s", s.why.text);
        if (s.source) {
            const pupil_v4l2_capture *c = pupil_live_capture(s.source);
            CHECK(c->reading == PUPIL_V4L2_READS_CALLERS && c->buffers == 3 &&
                  c->buffer[2].dmabuf[0] == fds[2 * areas]);
        }
        check_stream(&s);
        pupil_source_close(s.source);
        s.source = NULL;
        CHECK(fake_v4l2_holds(s.fake).files == 1 + (int)(3 * areas));
        for (uint32_t i = 0; i < 3 * areas; i++)
            CHECK(system->close(system->context, fds[i]) == 0);
        system->close(system->context, heap);
        fake_source_close(&s);
    }
}

static void check_refused(const fake_v4l2_config *config, const pupil_v4l2_options *options, const char *sentence)
{
    fake_source s = fake_source_open("/dev/video0", config, options);
    CHECK_MSG(s.result == PUPIL_SOURCE_FAILED && strstr(s.why.text, sentence), "'%s' for '%s'", s.why.text, sentence);
    fake_source_close(&s);
}

static void test_refusals(void)
{
    static const int none[] = {-1, -1};
    fake_v4l2_config c = usual();
    check_refused(&c, &(pupil_v4l2_options){.memory = 9}, "memory 9; it is one of the 5");
    check_refused(&c, &(pupil_v4l2_options){.memory = PUPIL_V4L2_MEMORY_HEAP},
                  "/dev/video0: takes no memory of a dma-heap: ");
    check_refused(&c, &(pupil_v4l2_options){.memory = PUPIL_V4L2_MEMORY_DMABUF}, "0 buffers; it must be from 2 to 32");
    check_refused(&c, &(pupil_v4l2_options){.memory = PUPIL_V4L2_MEMORY_DMABUF, .dmabufs = 2},
                  "memory of the caller's dma-bufs, and none was given");
    check_refused(&c, &(pupil_v4l2_options){.memory = PUPIL_V4L2_MEMORY_DMABUF, .dmabufs = 2, .dmabuf = none},
                  "/dev/video0: takes none of the dma-bufs given: ");
    c.heaps = 2;
    c.no_import = 1;
    check_refused(&c, &(pupil_v4l2_options){.memory = PUPIL_V4L2_MEMORY_HEAP}, "takes no memory of a dma-heap: ");
    c.no_mmap = 1;
    check_refused(&c, &(pupil_v4l2_options){.memory = PUPIL_V4L2_MEMORY_MMAP}, "gives no buffers that can be mapped: ");
}

/* The kernel's own measurement: ordinary memory is not slow, and something is read. */
static void test_kernel(void)
{
    const size_t bytes = 1 << 20;
    void *memory = calloc(1, bytes);
    const pupil_v4l2_speed speed = pupil_v4l2_measure(&pupil_v4l2_kernel, memory, bytes);
    CHECK_MSG(speed.bytes_s > 1e6 && speed.ordinary > 1e6, "%g and %g", speed.bytes_s, speed.ordinary);
    const pupil_v4l2_speed nothing = pupil_v4l2_measure(&pupil_v4l2_kernel, memory, 7);
    CHECK(nothing.bytes_s == 0 && !pupil_v4l2_is_slow(&nothing));
    free(memory);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_kinds();
    test_callers();
    test_refusals();
    test_kernel();
    return check_end();
}
