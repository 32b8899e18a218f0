/* dmabuf.c: runs in the guest (test_dmabuf.sh). Frames of a camera (vivid) in dma-bufs (vgem) become textures without a
 * copy, are metered and mapped by pupil_gles into a dma-buf, and go from there to a monitor (vivid's output) and over
 * its cable back into the camera.
 *
 * Checked for each format: all texels of a texture are the codes in the buffer; the statistics and the mapped picture
 * are those of the CPU, within the tolerances of docs/gpu.md. For the way back: every byte from the cable is that of
 * the mapped picture. */
#include <linux/videodev2.h>

#include "check.h"
#include "egl/dmabuf.h"
#include "egl/egl_context.h"
#include "frame/gles_shared.h"
#include "live/live.h"
#include "vm/compare.h"
#include "vm/node.h"
#include "vm/read_texels.h"
#include "vm/vgem.h"
#include "vm/vivid.h"

/* Small, because everything here is emulated. More frames than buffers, so that one is given back and refilled. */
#define WIDTH  160u
#define HEIGHT 96u
#define FRAMES 4
/* What the monitor is set to: the signal at the HDMI connector, which both ends of the cable need. */
#define VGA_WIDTH  640u
#define VGA_HEIGHT 480u

/* The items of vivid's menu "Test Pattern" (the kernel's v4l2-tpg.h: enum tpg_pattern). */
enum { PATTERN_SQUARES = 4, PATTERN_NOISE = 20 };

/* The formats that vivid fills, and those that pupil takes them for. */
typedef struct format {
    const char *name;
    uint32_t fourcc, pixel;
    uint32_t padding_bytes;
} format;

static const format formats[] = {
    {"YUYV, padded rows", V4L2_PIX_FMT_YUYV, PUPIL_PIXEL_YUYV, 64},
    {"NV12, padded rows", V4L2_PIX_FMT_NV12, PUPIL_PIXEL_NV12, 64},
    {"NV12 in two buffers", V4L2_PIX_FMT_NV12M, PUPIL_PIXEL_NV12, 0},
    {"RGBA8", V4L2_PIX_FMT_RGBA32, PUPIL_PIXEL_RGBA8, 0},
    {"BGRX8", V4L2_PIX_FMT_XBGR32, PUPIL_PIXEL_BGRX8, 0},
    {"RGBX8", V4L2_PIX_FMT_RGBX32, PUPIL_PIXEL_RGBX8, 0},
    {"UYVY, padded rows", V4L2_PIX_FMT_UYVY, PUPIL_PIXEL_UYVY, 64},
    {"NV21", V4L2_PIX_FMT_NV21, PUPIL_PIXEL_NV21, 0},
    {"NV16, padded rows", V4L2_PIX_FMT_NV16, PUPIL_PIXEL_NV16, 64},
    {"I420, padded rows", V4L2_PIX_FMT_YUV420, PUPIL_PIXEL_I420, 64},
    {"GREY8", V4L2_PIX_FMT_GREY, PUPIL_PIXEL_GREY8, 0},
    {"GREY16, padded rows", V4L2_PIX_FMT_Y16, PUPIL_PIXEL_GREY16, 64},
    {"BAYER8", V4L2_PIX_FMT_SRGGB8, PUPIL_PIXEL_BAYER8, 0},
    {"BAYER10", V4L2_PIX_FMT_SRGGB10, PUPIL_PIXEL_BAYER10, 0},
    {"BAYER12", V4L2_PIX_FMT_SRGGB12, PUPIL_PIXEL_BAYER12, 0},
    {"BAYER16", V4L2_PIX_FMT_SRGGB16, PUPIL_PIXEL_BAYER16, 0},
};

/* The target of the mapped picture: a dma-buf that GL renders into. */
typedef struct canvas {
    vgem_buffer memory;
    pupil_dmabuf_textures textures;
    uint32_t pixel, stride_bytes;
    pupil_gles_target target;
} canvas;

static int vgem;
static vivid_node camera, monitor;
static pupil_gles gles;
static pupil_t pupil;
static canvas canvases[2];

/* A frame of the node, as dma-bufs for textures and as an image for the CPU. */
static pupil_dmabuf frame_dmabuf(const vivid_node *node, int index, uint32_t pixel)
{
    const vgem_buffer *b = node->buffer[index];
    pupil_dmabuf d = {.pixel = pixel, .width = node->width, .height = node->height};
    d.fd[0] = b[0].fd, d.stride_bytes[0] = node->stride_bytes[0];
    d.fd[1] = d.fd[2] = b[0].fd;
    d.stride_bytes[1] = d.stride_bytes[2] = node->stride_bytes[0] / (pixel == PUPIL_PIXEL_I420 ? 2 : 1);
    d.offset_bytes[1] = node->stride_bytes[0] * node->height;
    d.offset_bytes[2] = d.offset_bytes[1] + d.stride_bytes[1] * pupil_chroma_rows(pixel, node->height);
    if (node->planes == 2)
        d.fd[1] = b[1].fd, d.stride_bytes[1] = node->stride_bytes[1], d.offset_bytes[1] = 0;
    return d;
}

static pupil_image_const frame_image(const vivid_node *node, int index, uint32_t pixel)
{
    const vgem_buffer *b = node->buffer[index];
    pupil_image_const image = {.data = b[0].data,
                               .stride_bytes = node->stride_bytes[0],
                               .width = node->width,
                               .height = node->height,
                               .pixel = pixel};
    const pupil_dmabuf d = frame_dmabuf(node, index, pixel);
    if (pupil_pixel_planes(pixel) > 1) {
        image.chroma = b[node->planes - 1].data + d.offset_bytes[1];
        image.chroma_stride_bytes = d.stride_bytes[1];
    }
    if (pupil_pixel_planes(pixel) > 2) {
        image.cr = b[0].data + d.offset_bytes[2];
        image.cr_stride_bytes = d.stride_bytes[2];
    }
    return image;
}

static int canvas_open(canvas *c, uint32_t pixel, uint32_t width, uint32_t height)
{
    pupil_why why = {""};
    *c = (canvas){.pixel = pixel, .stride_bytes = width * 4};
    c->target.width = width, c->target.height = height, c->target.top_first = 1;
    if (vgem_make(vgem, (size_t)c->stride_bytes * height, &c->memory) != 0) {
        CHECK_MSG(0, "vgem refuses a buffer");
        return -1;
    }
    const pupil_dmabuf d = {
        .pixel = pixel, .width = width, .height = height, .fd = {c->memory.fd, -1}, .stride_bytes = {c->stride_bytes}};
    int failed = pupil_dmabuf_framebuffer(&d, &c->textures, &c->target.framebuffer, &why);
    CHECK_MSG(!failed, "%s", why.text);
    return failed;
}

static void canvas_close(canvas *c)
{
    pupil_dmabuf_release(&c->textures);
    vgem_free(&c->memory);
}

/* FNV-1a (Fowler, Noll, Vo): whether a buffer has a new picture. */
static uint64_t hash(const vgem_buffer *buffer)
{
    uint64_t h = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < buffer->bytes; i++)
        h = (h ^ buffer->data[i]) * UINT64_C(0x100000001b3);
    return h;
}

static int open_gles(uint32_t pixel, uint32_t width, uint32_t height)
{
    pupil_config config;
    pupil_gles_config gles_config;
    pupil_why why = {""};
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_gles_config_default(&gles_config);
    gles_config.source = PUPIL_GLES_TEXTURES;
    gles_config.pixel = pixel, gles_config.width = width, gles_config.height = height;
    gles_config.normalized_16 = 1;
    int error = pupil_gles_init(&gles, &gles_config, &pupil, pupil_egl_get_proc, &why);
    CHECK_MSG(error == PUPIL_OK, "%s", why.text);
    return error;
}

static int import_all(uint32_t pixel, pupil_dmabuf_textures textures[VIVID_BUFFERS])
{
    pupil_why why = {""};
    int failed = 0;
    memset(textures, 0, VIVID_BUFFERS * sizeof *textures);
    for (int i = 0; i < VIVID_BUFFERS && !failed; i++) {
        const pupil_dmabuf d = frame_dmabuf(&camera, i, pixel);
        failed = pupil_dmabuf_import(&d, &textures[i], &why);
        CHECK_MSG(!failed, "%s", why.text);
    }
    return failed;
}

static int stream(vivid_node *node)
{
    for (uint32_t i = 0; i < VIVID_BUFFERS; i++)
        if (vivid_queue(node, i) != 0)
            return -1;
    return vivid_stream(node);
}

/* Maps one frame both ways, with the curve from its metering. */
static void compare_mapping(const pupil_image_const *image, const canvas *c, figures *all, const char *what)
{
    pupil_curve curve;
    const pupil_image out = {.data = malloc((size_t)c->stride_bytes * image->height),
                             .stride_bytes = c->stride_bytes,
                             .width = image->width,
                             .height = image->height,
                             .pixel = c->pixel};
    CHECK(pupil_get_curve(&pupil, NULL, &curve) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, &curve, image, &out) == PUPIL_OK);
    CHECK(pupil_gles_map(&gles, &curve, &c->target) == PUPIL_OK);
    wait_for_gl(what);
    compare_pictures(&c->memory, &out, all, what);
    free(out.data);
}

/* Takes the camera's next frame, and gives its buffer back. */
static void test_frame(const format *f, int number, const pupil_dmabuf_textures *textures, uint64_t *seen, figures *all)
{
    int index = vivid_dequeue(&camera);
    CHECK_MSG(index >= 0, "%s: no frame", f->name);
    if (index < 0)
        return;
    pupil_image_const image = frame_image(&camera, index, f->pixel);
    for (uint32_t p = 0; p < camera.planes; p++)
        vgem_begin(&camera.buffer[index][p]);
    const uint64_t now = hash(&camera.buffer[index][0]);
    CHECK_MSG(now != seen[index], "%s: buffer %d has the picture that it had", f->name, index);
    seen[index] = now;
    check_texels(&textures[index], &image, f->name);
    CHECK(pupil_gles_use(&gles, textures[index].texture[0], textures[index].texture[1], textures[index].texture[2]) ==
          PUPIL_OK);
    if (number % 2 == 0) /* once for each pattern */
        compare_metering(&gles, &pupil, &image, all, f->name);
    compare_mapping(&image, &canvases[f->pixel == PUPIL_PIXEL_RGBA8 && number % 2], all, f->name);
    for (uint32_t p = 0; p < camera.planes; p++)
        vgem_end(&camera.buffer[index][p]);
    CHECK(vivid_queue(&camera, (uint32_t)index) == 0);
}

/* Frames of one format. The object of the previous format is used again if its pixels are the same. */
static void test_format(const format *f)
{
    static uint32_t opened = PUPIL_PIXEL_NONE;
    pupil_dmabuf_textures textures[VIVID_BUFFERS];
    uint64_t seen[VIVID_BUFFERS] = {0};
    figures all = {0};
    int failed = vivid_start(&camera, vgem, f->fourcc, WIDTH, HEIGHT, f->padding_bytes);
    CHECK_MSG(camera.stride_bytes[0] == pupil_row_bytes(f->pixel, WIDTH) + f->padding_bytes, "%s: rows of %u bytes",
              f->name, camera.stride_bytes[0]);
    failed |= import_all(f->pixel, textures);
    if (opened != f->pixel) {
        pupil_gles_close(&gles);
        failed |= open_gles(f->pixel, WIDTH, HEIGHT);
        opened = f->pixel;
    }
    failed |= node_set(camera.fd, "Test Pattern", PATTERN_NOISE);
    failed |= stream(&camera);
    CHECK_MSG(!failed, "%s: not tested", f->name);
    for (int i = 0; i < FRAMES && !failed; i++) {
        if (i == FRAMES / 2)
            CHECK(node_set(camera.fd, "Test Pattern", PATTERN_SQUARES) == 0);
        test_frame(f, i, textures, seen, &all);
    }
    vivid_stop(&camera);
    for (int i = 0; i < VIVID_BUFFERS; i++)
        pupil_dmabuf_release(&textures[i]);
    judge(&all, f->name);
}

static void test_formats(void)
{
    int failed = canvas_open(&canvases[0], PUPIL_PIXEL_BGRX8, WIDTH, HEIGHT);
    failed |= canvas_open(&canvases[1], PUPIL_PIXEL_RGBA8, WIDTH, HEIGHT);
    for (size_t i = 0; i < sizeof formats / sizeof *formats && !failed; i++)
        test_format(&formats[i]);
    pupil_gles_close(&gles);
    canvas_close(&canvases[1]);
    canvas_close(&canvases[0]);
}

/* The same as in the program: a live source says where its frames are, and each buffer is imported once, until the
 * stream changes. */
static void test_live_format(const format *f, const char *path)
{
    vgem_buffer memory[VIVID_BUFFERS * 2];
    int fd[VIVID_BUFFERS * 2], failed = 0;
    gles_shared shared = {0};
    figures all = {0};
    pupil_source *source = NULL;
    pupil_why why = {""};
    canvas picture;
    for (int i = 0; i < VIVID_BUFFERS * 2 && !failed; i++) {
        failed = vgem_make(vgem, (size_t)WIDTH * HEIGHT * 4, &memory[i]);
        fd[i] = memory[i].fd;
    }
    const pupil_live_options options = {.capture = {.fourcc = f->fourcc,
                                                    .width = WIDTH,
                                                    .height = HEIGHT,
                                                    .memory = PUPIL_V4L2_MEMORY_DMABUF,
                                                    .dmabufs = VIVID_BUFFERS,
                                                    .dmabuf = fd},
                                        .hands_off = 1};
    CHECK_MSG(!failed && pupil_live_open(path, NULL, &options, &source, &why) == 0, "%s: %s", f->name, why.text);
    if (!source || open_gles(f->pixel, WIDTH, HEIGHT) || canvas_open(&picture, PUPIL_PIXEL_BGRX8, WIDTH, HEIGHT))
        return;
    for (int i = 0; i < 2 * VIVID_BUFFERS; i++) {
        pupil_frame frame;
        CHECK_MSG(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME, "%s: %s", f->name, why.text);
        pupil_frame_dmabuf again = *frame.dmabuf;
        again.stream += i == 2 * VIVID_BUFFERS - 1; /* as after opening it again */
        frame.dmabuf = &again;
        const pupil_dmabuf_textures *textures = gles_shared_textures(&shared, &frame);
        CHECK_MSG(textures != NULL, "%s: %s", f->name, shared.refusal.text);
        if (!textures)
            break;
        check_texels(textures, &frame.image, f->name);
        CHECK(pupil_gles_use(&gles, textures->texture[0], textures->texture[1], textures->texture[2]) == PUPIL_OK);
        if (i == 0)
            compare_metering(&gles, &pupil, &frame.image, &all, f->name);
        compare_mapping(&frame.image, &picture, &all, f->name);
        CHECK_MSG(shared.count == (uint32_t)(i < VIVID_BUFFERS ? i + 1
                                             : again.stream    ? 1
                                                               : VIVID_BUFFERS),
                  "%s: frame %d: %u buffers are imported", f->name, i, shared.count);
        pupil_source_done(source, &frame);
    }
    gles_shared_release(&shared);
    pupil_source_close(source);
    canvas_close(&picture);
    pupil_gles_close(&gles);
    for (int i = 0; i < VIVID_BUFFERS * 2; i++)
        vgem_free(&memory[i]);
    judge(&all, f->name);
}

static void test_live(void)
{
    char path[32];
    CHECK(node_find("vivid", 0, 0, path) == 0);
    printf("through a live source:\n");
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i].pixel == PUPIL_PIXEL_YUYV || formats[i].pixel == PUPIL_PIXEL_NV12 ||
            formats[i].pixel == PUPIL_PIXEL_NV21 || formats[i].pixel == PUPIL_PIXEL_I420 ||
            formats[i].pixel == PUPIL_PIXEL_BAYER10)
            test_live_format(&formats[i], path);
}

/* What the camera sees, mapped into every buffer of the monitor. */
static int fill_monitor(void)
{
    const pupil_curve curve = {.scale = 2.0f, .inverse_white_squared = 0.1f, .gamut = 1.0f};
    static unsigned char picture[VGA_WIDTH * VGA_HEIGHT * 4];
    const pupil_image cpu = {.data = picture,
                             .stride_bytes = VGA_WIDTH * 4,
                             .width = VGA_WIDTH,
                             .height = VGA_HEIGHT,
                             .pixel = PUPIL_PIXEL_BGRX8};
    figures all = {0};
    pupil_dmabuf_textures textures[VIVID_BUFFERS];
    pupil_why why = {""};
    int failed = vivid_start(&camera, vgem, V4L2_PIX_FMT_YUYV, VGA_WIDTH, VGA_HEIGHT, 0);
    failed |= import_all(PUPIL_PIXEL_YUYV, textures);
    failed |= open_gles(PUPIL_PIXEL_YUYV, VGA_WIDTH, VGA_HEIGHT);
    failed |= stream(&camera);
    int index = failed ? -1 : vivid_dequeue(&camera);
    CHECK_MSG(index >= 0, "no frame for the monitor");
    if (index >= 0) {
        const pupil_image_const frame = frame_image(&camera, index, PUPIL_PIXEL_YUYV);
        CHECK(pupil_map_rows(&pupil, &curve, &frame, &cpu) == PUPIL_OK);
    }
    for (int i = 0; i < VIVID_BUFFERS && index >= 0; i++) {
        pupil_dmabuf_textures out;
        pupil_gles_target target = {.width = VGA_WIDTH, .height = VGA_HEIGHT, .top_first = 1};
        const pupil_dmabuf d = frame_dmabuf(&monitor, i, PUPIL_PIXEL_BGRX8);
        CHECK_MSG(pupil_dmabuf_framebuffer(&d, &out, &target.framebuffer, &why) == 0, "%s", why.text);
        CHECK(pupil_gles_use(&gles, textures[index].texture[0], 0, 0) == PUPIL_OK);
        CHECK(pupil_gles_map(&gles, &curve, &target) == PUPIL_OK);
        wait_for_gl("the monitor's picture");
        compare_pictures(&monitor.buffer[i][0], &cpu, &all, "the monitor's picture");
        pupil_dmabuf_release(&out);
    }
    vivid_stop(&camera);
    for (int i = 0; i < VIVID_BUFFERS; i++)
        pupil_dmabuf_release(&textures[i]);
    pupil_gles_close(&gles);
    judge(&all, "to the monitor");
    return index >= 0 ? 0 : -1;
}

/* The mapped picture over the cable: the monitor shows it until it gets another one, so each frame of the camera is
 * that picture. */
static void test_cable(void)
{
    const size_t bytes = (size_t)VGA_WIDTH * VGA_HEIGHT * 4;
    int failed = vivid_start(&monitor, vgem, V4L2_PIX_FMT_XBGR32, VGA_WIDTH, VGA_HEIGHT, 0);
    failed |= fill_monitor();
    failed |= vivid_start(&camera, vgem, V4L2_PIX_FMT_XBGR32, VGA_WIDTH, VGA_HEIGHT, 0);
    failed |= node_cable(camera.fd);
    failed |= stream(&monitor);
    failed |= stream(&camera);
    CHECK_MSG(!failed, "the cable: not tested");
    const vgem_buffer *shown = &monitor.buffer[0][0];
    for (int i = 0; i < FRAMES && !failed; i++) {
        size_t off = 0;
        int index = vivid_dequeue(&camera);
        CHECK_MSG(index >= 0, "no frame from the cable");
        if (index < 0)
            break;
        const vgem_buffer *taken = &camera.buffer[index][0];
        vgem_begin(taken);
        for (size_t k = 0; k < bytes; k++)
            off += taken->data[k] != shown->data[k];
        memset(taken->data, 0xa5, bytes); /* so that each frame is new */
        vgem_end(taken);
        CHECK_MSG(off == 0, "frame %d from the cable: %zu of %zu bytes are not the monitor's", i, off, bytes);
        CHECK(vivid_queue(&camera, (uint32_t)index) == 0);
    }
    printf("over the cable       %d frames of %zu bytes compared\n", FRAMES, bytes);
    vivid_stop(&camera);
    vivid_stop(&monitor);
}

int main(int argc, char **argv)
{
    pupil_egl *egl;
    pupil_why why = {""};
    setvbuf(stdout, NULL, _IOLBF, 0);
    check_begin(argc, argv);
    vgem = vgem_open();
    CHECK_MSG(vgem >= 0, "no vgem device");
    CHECK(vivid_open(&camera, 0) == 0 && vivid_open(&monitor, 1) == 0);
    CHECK(node_timings(camera.fd, VGA_WIDTH, VGA_HEIGHT, 60) == 0 &&
          node_timings(monitor.fd, VGA_WIDTH, VGA_HEIGHT, 60) == 0);
    CHECK_MSG(pupil_egl_open(&egl, NULL, &why) == 0, "%s", why.text);
    if (check_state.failures || read_texels_open() != 0)
        return 1;
    pupil_egl_describe(why.text, sizeof why.text);
    printf("%s\n", why.text);
    test_formats();
    test_live();
    test_cable();
    pupil_egl_close(egl);
    return check_end();
}
