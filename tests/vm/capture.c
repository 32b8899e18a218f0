/* capture.c: runs in the guest (test_capture.sh). Frames of vivid through pupil's camera driver: every format that is
 * read, from each kind of buffer and each kind of input, is compared with the pattern that vivid draws; and our own
 * frames over its HDMI cable, bit by bit.
 *
 * capture [smoke]: a few formats only. */
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <unistd.h>

#include "check.h"
#include "live/live.h"
#include "v4l2/modes.h"
#include "vm/loop.h"
#include "vm/node.h"
#include "vm/pattern.h"
#include "vm/vgem.h"

static pupil_why why;
static unsigned formats_seen;

/* --- kinds of memory --- */

typedef enum memory_mode { MEMORY_MMAP, MEMORY_SHARED, MEMORY_USERPTR, MEMORY_IMPORTED, MEMORY_MODES } memory_mode;
static const char *const memory_names[] = {"MMAP", "MMAP and EXPBUF", "USERPTR", "DMABUF"};
static const uint32_t memory_asked[] = {PUPIL_V4L2_MEMORY_MMAP, PUPIL_V4L2_MEMORY_MMAP, PUPIL_V4L2_MEMORY_USERPTR,
                                        PUPIL_V4L2_MEMORY_DMABUF};
static const uint32_t memory_used[] = {V4L2_MEMORY_MMAP, V4L2_MEMORY_MMAP, V4L2_MEMORY_USERPTR, V4L2_MEMORY_DMABUF};

/* Memory of another device (vgem) for frames: at most three areas, each large enough for every size here. */
#define IMPORTED       3u
#define IMPORTED_BYTES (1024u * 1024 * 2)
static int imported[PUPIL_V4L2_MOST_AREAS * IMPORTED];

static void make_imported(void)
{
    static vgem_buffer buffer[PUPIL_V4L2_MOST_AREAS * IMPORTED];
    const int vgem = vgem_open();
    CHECK(vgem >= 0);
    for (uint32_t i = 0; i < PUPIL_V4L2_MOST_AREAS * IMPORTED; i++) {
        CHECK(vgem >= 0 && vgem_make(vgem, IMPORTED_BYTES, &buffer[i]) == 0);
        imported[i] = buffer[i].fd;
    }
}

/* The current frame has the same contents through its dma-buf. */
static void check_shared_buffer(const pupil_v4l2_capture *c, const pupil_v4l2_frame *frame, const char *what)
{
    const pupil_v4l2_buffer *b = &c->buffer[frame->index];
    for (uint32_t i = 0; i < c->format.buffers; i++) {
        CHECK_MSG(b->dmabuf[i] >= 0, "%s: no dma-buf", what);
        if (b->dmabuf[i] < 0)
            continue;
        void *memory = mmap(NULL, b->bytes[i], PROT_READ, MAP_SHARED, b->dmabuf[i], 0);
        CHECK_MSG(memory != MAP_FAILED && memcmp(memory, b->memory[i], b->bytes[i]) == 0, "%s: another frame", what);
        if (memory != MAP_FAILED)
            munmap(memory, b->bytes[i]);
    }
}

/* --- a stream and its pattern --- */

/* Takes frames until one has the pattern, because frames filled before it was set do not; then one more. */
static void check_pattern(pupil_source *source, int fd, int pattern, memory_mode mode, const char *what)
{
    const pupil_v4l2_capture *c = pupil_live_capture(source);
    double off = INFINITY;
    int right = 0;
    if (node_set(fd, "Test Pattern", pattern) != 0)
        CHECK_MSG(0, "%s: no pattern %d", what, pattern);
    for (uint32_t i = 0; i <= c->buffers + 3 && right < 2; i++) {
        pupil_frame frame;
        const int got = pupil_source_next(source, &frame, &why);
        CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%s: %d, %s", what, got, why.text);
        if (got != PUPIL_SOURCE_FRAME)
            return;
        /* Half of the first line of a 625-line system is data, and random. */
        off = pattern_off(&frame.image, &c->format, pattern, c->format.height == 576);
        right = off <= pattern_tolerance(&c->format, pattern) ? right + 1 : 0;
        if (right && mode == MEMORY_SHARED)
            check_shared_buffer(c, pupil_live_frame(source), what);
        pupil_source_done(source, &frame);
    }
    CHECK_MSG(right == 2, "%s: pattern %d is off by %g codes", what, pattern, off);
}

static void check_format(const char *path, int fd, const pupil_v4l2_options *asked, memory_mode mode, const char *input)
{
    static const int patterns[] = {PATTERN_CHECKERS, PATTERN_RED, PATTERN_BLUE};
    pupil_v4l2_options o = *asked;
    pupil_source *source = NULL;
    char what[128];
    const node_held before = node_holds();
    o.memory = memory_asked[mode];
    o.dmabuf = imported;
    o.dmabufs = mode == MEMORY_IMPORTED ? IMPORTED : 0;
    o.share = mode == MEMORY_SHARED;
    snprintf(what, sizeof what, "%s, %s, %s, %ux%u", input, pupil_v4l2_fourcc_name(o.fourcc).text, memory_names[mode],
             o.width, o.height);
    const int failed = pupil_live_open(path, NULL, &(pupil_live_options){.capture = o, .hands_off = 1}, &source, &why);
    /* vivid reports HDMI as RGB with the transfer function of BT.709, which is refused. */
    if (failed && strstr(why.text, "RGB of another transfer function") && strcmp(input, "HDMI") == 0)
        return;
    CHECK_MSG(!failed, "%s: %s", what, why.text);
    if (failed)
        return;
    const pupil_v4l2_capture *c = pupil_live_capture(source);
    CHECK_MSG(c->memory == memory_used[mode], "%s: memory %u", what, c->memory);
    for (size_t i = 0; i < sizeof patterns / sizeof patterns[0]; i++)
        check_pattern(source, fd, patterns[i], mode, what);
    const pupil_live_counts *counts = &c->counts;
    CHECK_MSG(counts->flagged == 0 && counts->cut == 0 && counts->unstamped == 0, "%s: %llu flagged, %llu cut", what,
              (unsigned long long)counts->flagged, (unsigned long long)counts->cut);
    pupil_source_close(source);
    const node_held after = node_holds();
    CHECK_MSG(after.files == before.files && after.maps == before.maps, "%s: %d files and %d maps are left", what,
              after.files - before.files, after.maps - before.maps);
    formats_seen++;
}

/* Every format that is read, with alternating kinds of memory; the first format with all of them. */
static void check_formats(const char *path, int fd, const pupil_v4l2_options *o, const char *input, int smoke)
{
    pupil_v4l2_device device;
    pupil_live_modes modes;
    unsigned n = 0;
    const unsigned before = formats_seen;
    CHECK_MSG(pupil_v4l2_device_open(&device, NULL, path, &why) == 0, "%s", why.text);
    CHECK_MSG(pupil_v4l2_modes_read(&device, &modes, &why) == 0, "%s", why.text);
    pupil_v4l2_device_close(&device);
    for (uint32_t i = 0; i < modes.count; i++) {
        pupil_v4l2_options one = *o;
        const int is_read = pupil_v4l2_pixel_of(modes.mode[i].fourcc) != PUPIL_PIXEL_NONE;
        if (!is_read || (smoke && n % 6))
            n += is_read;
        else {
            one.fourcc = modes.mode[i].fourcc;
            for (memory_mode mode = MEMORY_MMAP; mode < MEMORY_MODES; mode++)
                if (n == 0 || n % MEMORY_MODES == (unsigned)mode)
                    check_format(path, fd, &one, mode, input);
            n++;
        }
    }
    pupil_live_modes_free(&modes);
    CHECK_MSG(n >= 33, "%s: only %u formats", input, n); /* of the 33 that vivid of Linux 6.1 has in one area */
    printf("%s, %s: %u formats, %u streams\n", path, input, n, formats_seen - before);
}

/* vivid's inputs (the module's input_types): 0 webcam, 1 TV, 2 S-Video, 3 HDMI. */
static void check_camera(const char *path, int smoke)
{
    const pupil_v4l2_options webcam = {.width = 320, .height = 180, .fps = 60, .buffers = 2, .timeout_s = 20};
    const pupil_v4l2_options vga = {.width = 640, .height = 480, .buffers = 2, .timeout_s = 20};
    const pupil_v4l2_options as_it_is = {.fourcc = V4L2_PIX_FMT_YUYV, .timeout_s = 20};
    const int fd = node_open(path);
    CHECK(fd >= 0 && node_set(fd, "OSD Text Mode", 2) == 0); /* nothing is drawn into the picture */
    CHECK(node_input(fd, 0) == 0);
    check_formats(path, fd, &webcam, "webcam", smoke);
    CHECK(node_input(fd, 3) == 0 && node_timings(fd, 640, 480, 60) == 0);
    check_formats(path, fd, &vga, "HDMI", smoke);
    for (int input = 1; input <= 2; input++) { /* interlaced, as one frame */
        CHECK(node_input(fd, input) == 0);
        check_format(path, fd, &as_it_is, MEMORY_MMAP, input == 1 ? "TV" : "S-Video");
    }
    close(fd);
}

int main(int argc, char **argv)
{
    const int smoke = argc > 1 && strcmp(argv[1], "smoke") == 0;
    char path[2][32], monitor[32];
    check_begin(argc - smoke, argv + smoke);
    setvbuf(stdout, NULL, _IOLBF, 0);
    make_imported();
    CHECK(node_find("vivid", 0, 0, path[0]) == 0);
    check_camera(path[0], smoke);
    if (!smoke) {
        CHECK(node_find("vivid", 0, 1, path[1]) == 0 && node_find("vivid", 1, 0, monitor) == 0);
        const int fd = node_open(path[1]);
        static const uint32_t in_areas[] = {V4L2_PIX_FMT_NV12M, V4L2_PIX_FMT_NV21M, V4L2_PIX_FMT_NV16M,
                                            V4L2_PIX_FMT_YUV420M, V4L2_PIX_FMT_YVU420M};
        pupil_v4l2_options vga = {.width = 640, .height = 480, .buffers = 2, .timeout_s = 20};
        CHECK(fd >= 0 && node_set(fd, "OSD Text Mode", 2) == 0 && node_input(fd, 3) == 0 &&
              node_timings(fd, 640, 480, 60) == 0);
        for (size_t i = 0; i < sizeof in_areas / sizeof in_areas[0]; i++)
            for (memory_mode mode = MEMORY_MMAP; mode < MEMORY_MODES; mode++) {
                vga.fourcc = in_areas[i];
                check_format(path[1], fd, &vga, mode, "HDMI, multi-planar");
            }
        close(fd);
        check_loop(path[0], monitor);
    }
    printf("%u streams\n", formats_seen);
    return check_end();
}
