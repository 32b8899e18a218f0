/* tests/vm/loop.h: our own frames into vivid's HDMI monitor, over its cable, and back from its HDMI input, bit by bit.
 * In a header, so that its checks count as the test's own. */
#ifndef PUPIL_TESTS_VM_LOOP_H
#define PUPIL_TESTS_VM_LOOP_H

#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "check.h"
#include "live/live.h"
#include "pupil/error.h"
#include "v4l2/output/v4l2_sink.h"
#include "vm/node.h"

#define LOOP_WIDTH  1920u
#define LOOP_HEIGHT 1080u
#define LOOP_FRAMES 3 /* that come back whole; everything here is emulated */

/* Frame n: 16-bit words that no other frame has. */
static void loop_draw(uint32_t n, void *to, size_t bytes)
{
    uint32_t *word = to, w = n * UINT32_C(0x9e3779b9) + 1;
    for (size_t i = 0; i < bytes / 4; i++) {
        w ^= w << 13; /* xorshift (Marsaglia 2003) */
        w ^= w >> 17;
        w ^= w << 5;
        word[i] = w;
    }
}

/* Which of the frames 1 to `last` is complete in `bytes`; 0: none. */
static uint32_t loop_which(const void *data, uint32_t last, void *room, size_t bytes)
{
    for (uint32_t n = 1; n <= last; n++) {
        loop_draw(n, room, 4);
        if (memcmp(room, data, 4) == 0) {
            loop_draw(n, room, bytes);
            return memcmp(room, data, bytes) == 0 ? n : 0;
        }
    }
    return 0;
}

/* `put` shows frame n, 0 or -1. Takes the camera's frames until LOOP_FRAMES different ones came back complete. */
static void loop_run(const char *camera, uint32_t fourcc, int (*put)(void *closure, uint32_t n), void *closure,
                     const char *what)
{
    const pupil_v4l2_options o = {
        .fourcc = fourcc, .width = LOOP_WIDTH, .height = LOOP_HEIGHT, .timeout_s = 20, .buffers = 2};
    const size_t bytes = (size_t)LOOP_WIDTH * LOOP_HEIGHT * (fourcc == V4L2_PIX_FMT_RGB24 ? 3 : 2);
    static pupil_why loop_why;
    void *room = malloc(bytes);
    pupil_source *source = NULL;
    uint32_t shown = 0, last = 0, whole = 0, foreign = 0;
    while (shown < 3 && put(closure, shown + 1) == 0)
        shown++;
    CHECK_MSG(shown == 3, "%s: %u frames were taken", what, shown);
    const int failed = shown < 3 || pupil_live_open(camera, NULL, &(pupil_live_options){.capture = o, .hands_off = 1},
                                                    &source, &loop_why);
    CHECK_MSG(!failed, "%s: %s", what, loop_why.text);
    for (int i = 0; room && !failed && i < 20 && whole < LOOP_FRAMES; i++) {
        pupil_frame frame;
        const int got = pupil_source_next(source, &frame, &loop_why);
        CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%s: %s", what, loop_why.text);
        if (got != PUPIL_SOURCE_FRAME)
            break;
        const uint32_t n = loop_which(frame.image.data, shown, room, bytes);
        CHECK(frame.image.stride_bytes == (ptrdiff_t)(bytes / LOOP_HEIGHT));
        foreign += !n;
        whole += n > last;
        last = n > last ? n : last;
        pupil_source_done(source, &frame);
        if (put(closure, shown + 1) == 0)
            shown++;
    }
    CHECK_MSG(whole == LOOP_FRAMES && foreign == 0, "%s: %u whole frames, %u others", what, whole, foreign);
    if (!failed)
        printf("%s: %u of %u frames came back bit by bit, %llu were lost\n", what, whole, shown,
               (unsigned long long)pupil_live_capture(source)->counts.lost);
    pupil_source_close(source);
    free(room);
}

/* Raw frames, as any program would. */
#define LOOP_BUFFERS 3
typedef struct loop_raw {
    int fd;
    void *memory[LOOP_BUFFERS];
    size_t bytes, length[LOOP_BUFFERS];
} loop_raw;

static void loop_raw_open(loop_raw *r)
{
    struct v4l2_requestbuffers request = {
        .count = LOOP_BUFFERS, .type = V4L2_BUF_TYPE_VIDEO_OUTPUT, .memory = V4L2_MEMORY_MMAP};
    CHECK(ioctl(r->fd, VIDIOC_REQBUFS, &request) == 0 && request.count == LOOP_BUFFERS);
    for (uint32_t i = 0; i < LOOP_BUFFERS; i++) {
        struct v4l2_buffer b = {.type = V4L2_BUF_TYPE_VIDEO_OUTPUT, .memory = V4L2_MEMORY_MMAP, .index = i};
        CHECK(ioctl(r->fd, VIDIOC_QUERYBUF, &b) == 0 && b.length >= r->bytes);
        r->length[i] = b.length;
        r->memory[i] = mmap(NULL, b.length, PROT_READ | PROT_WRITE, MAP_SHARED, r->fd, b.m.offset);
        CHECK(r->memory[i] != MAP_FAILED);
    }
}

static void loop_raw_close(loop_raw *r)
{
    for (int i = 0; i < LOOP_BUFFERS; i++)
        munmap(r->memory[i], r->length[i]);
    close(r->fd);
}

static int loop_put_raw(void *closure, uint32_t n)
{
    const loop_raw *r = closure;
    int type = V4L2_BUF_TYPE_VIDEO_OUTPUT, got = n <= LOOP_BUFFERS ? 0 : -1;
    struct v4l2_buffer b = {
        .type = V4L2_BUF_TYPE_VIDEO_OUTPUT, .memory = V4L2_MEMORY_MMAP, .index = n - 1, .field = V4L2_FIELD_NONE};
    for (int i = 0; got != 0 && i < 2000; i++) { /* ten seconds at most */
        got = ioctl(r->fd, VIDIOC_DQBUF, &b);
        if (got != 0)
            usleep(5000);
    }
    if (got != 0)
        return -1;
    loop_draw(n, r->memory[b.index], r->bytes);
    b.bytesused = (uint32_t)r->bytes;
    return ioctl(r->fd, VIDIOC_QBUF, &b) == 0 && (n > 1 || ioctl(r->fd, VIDIOC_STREAMON, &type) == 0) ? 0 : -1;
}

/* Through the sink: a picture of RGB8. */
typedef struct loop_sink {
    pupil_sink *sink;
    void *frame;
} loop_sink;

static int loop_put_sink(void *closure, uint32_t n)
{
    const loop_sink *s = closure;
    static pupil_why sink_why;
    const pupil_image_const image = {.data = s->frame,
                                     .stride_bytes = 3 * (ptrdiff_t)LOOP_WIDTH,
                                     .width = LOOP_WIDTH,
                                     .height = LOOP_HEIGHT,
                                     .pixel = PUPIL_PIXEL_RGB8};
    loop_draw(n, s->frame, (size_t)3 * LOOP_WIDTH * LOOP_HEIGHT);
    const int failed = pupil_sink_write(s->sink, &image, NULL, &sink_why);
    CHECK_MSG(!failed, "%s", sink_why.text);
    return failed;
}

/* 1080p60 at both ends. */
static void check_loop(const char *camera, const char *monitor)
{
    const int in = node_open(camera), out = node_open(monitor);
    CHECK(node_input(in, 3) == 0 && node_cable(in) == 0);
    CHECK(node_timings(in, LOOP_WIDTH, LOOP_HEIGHT, 60) == 0 && node_timings(out, LOOP_WIDTH, LOOP_HEIGHT, 60) == 0);
    CHECK(node_output_format(out, V4L2_PIX_FMT_YUYV, LOOP_WIDTH, LOOP_HEIGHT) == 0);
    loop_raw raw = {.fd = out, .bytes = (size_t)2 * LOOP_WIDTH * LOOP_HEIGHT};
    loop_raw_open(&raw);
    loop_run(camera, V4L2_PIX_FMT_YUYV, loop_put_raw, &raw, "1080p60 YUYV over HDMI");
    loop_raw_close(&raw);

    const int again = node_open(monitor);
    CHECK(node_output_format(again, V4L2_PIX_FMT_RGB24, LOOP_WIDTH, LOOP_HEIGHT) == 0);
    close(again);
    const pupil_sink_options options = {.width = LOOP_WIDTH, .height = LOOP_HEIGHT, .fps = 60};
    static pupil_why sink_why;
    loop_sink s = {NULL, malloc((size_t)3 * LOOP_WIDTH * LOOP_HEIGHT)};
    const int failed = pupil_v4l2_sink_open(&s.sink, monitor, &options, NULL, &sink_why);
    CHECK_MSG(!failed, "%s", sink_why.text);
    if (!failed)
        loop_run(camera, V4L2_PIX_FMT_RGB24, loop_put_sink, &s, "1080p60 RGB24 through the sink over HDMI");
    pupil_sink_discard(s.sink);
    free(s.frame);

    /* The monitor's formats are reported. */
    const pupil_sink_options small = {.width = 100, .height = 100, .fps = 60};
    CHECK(pupil_v4l2_sink_open(&s.sink, monitor, &small, NULL, &sink_why) == PUPIL_SINK_FAILED);
    CHECK_MSG(strstr(sink_why.text, "takes frames of 1920x1080, not of 100x100"), "%s", sink_why.text);
    close(in);
}

#endif
