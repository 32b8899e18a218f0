/* Dma-bufs and fences: which planes are imported in which format, what is refused, and that nothing leaks if the driver
 * fails. */
#include "fake_egl.h"

#include <fcntl.h>
#include <unistd.h>

#include "check.h"
#include "egl/dmabuf.h"
#include "scratch.h"

#define FOURCC(text) ((EGLint)((text)[0] | (text)[1] << 8 | (text)[2] << 16 | (text)[3] << 24))

static pupil_why why;
static int file; /* of 64 KiB, in the place of a buffer */

static void begin(void)
{
    fake_egl_begin();
    fake.is_current = 1;
}

static int is_clean(void)
{
    return fake.images == 0 && fake.textures == 0 && fake.framebuffers == 0 && fake.syncs == 0;
}

static pupil_dmabuf buffer_of(uint32_t pixel)
{
    return (pupil_dmabuf){.pixel = pixel,
                          .width = 32,
                          .height = 16,
                          .fd = {file, file, file},
                          .offset_bytes = {0, 8192, 16384},
                          .stride_bytes = {512, 512, 512}};
}

static void test_formats(void)
{
    static const struct {
        uint32_t pixel;
        const char *fourcc[3];
        EGLint width[3], height[3];
        int swizzles;
    } cases[] = {
        {PUPIL_PIXEL_RGBA8, {"AB24"}, {32}, {16}, 0},
        {PUPIL_PIXEL_RGBX8, {"XB24"}, {32}, {16}, 0},
        {PUPIL_PIXEL_BGRX8, {"XR24"}, {32}, {16}, 0},
        {PUPIL_PIXEL_RGB10A2, {"AB30"}, {32}, {16}, 0},
        {PUPIL_PIXEL_RGBA16F, {"AB4H"}, {32}, {16}, 0},
        {PUPIL_PIXEL_YUYV, {"GR88"}, {32}, {16}, 0},
        {PUPIL_PIXEL_UYVY, {"GR88"}, {32}, {16}, 1},
        {PUPIL_PIXEL_NV12, {"R8  ", "GR88"}, {32, 16}, {16, 8}, 0},
        {PUPIL_PIXEL_NV21, {"R8  ", "GR88"}, {32, 16}, {16, 8}, 1},
        {PUPIL_PIXEL_P010, {"R16 ", "GR32"}, {32, 16}, {16, 8}, 0},
        {PUPIL_PIXEL_I420, {"R8  ", "R8  ", "R8  "}, {32, 16, 16}, {16, 8, 8}, 0},
        {PUPIL_PIXEL_GREY8, {"R8  "}, {32}, {16}, 0},
        {PUPIL_PIXEL_BAYER16, {"R16 "}, {32}, {16}, 0},
        {PUPIL_PIXEL_BAYER10P, {"R8  "}, {40}, {16}, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const pupil_dmabuf buffer = buffer_of(cases[i].pixel);
        pupil_dmabuf_textures textures;
        begin();
        CHECK_MSG(pupil_dmabuf_import(&buffer, &textures, &why) == 0, "%zu: %s", i, why.text);
        int planes = 0;
        for (; planes < 3 && cases[i].fourcc[planes]; planes++)
            CHECK_MSG(fake.fourcc[planes] == FOURCC(cases[i].fourcc[planes]) &&
                          fake.width[planes] == cases[i].width[planes] &&
                          fake.height[planes] == cases[i].height[planes] && textures.texture[planes],
                      "%zu: plane %d: 0x%x, %d x %d", i, planes, fake.fourcc[planes], fake.width[planes],
                      fake.height[planes]);
        CHECK(fake.image_count == planes && fake.swizzles == cases[i].swizzles);
        pupil_dmabuf_release(&textures);
        pupil_dmabuf_release(&textures);
        CHECK(is_clean());
    }
}

typedef struct refusal {
    pupil_dmabuf buffer;
    const char *extensions, *gl_extensions, *says;
} refusal;

/* Each refusal: one field of a valid buffer is changed. */
static void test_refusals(void)
{
    const pupil_dmabuf right = buffer_of(PUPIL_PIXEL_NV12);
    refusal cases[16];
    int count = 0;
#define CASE(field, value, sentence)                                                                                   \
    do {                                                                                                               \
        cases[count] = (refusal){right, NULL, NULL, sentence};                                                         \
        cases[count++].field = value;                                                                                  \
    } while (0)
    CASE(buffer.width, 0, "frames of 0 x 16 pixels");
    CASE(buffer.height, 0, "frames of 32 x 0 pixels");
    CASE(buffer.width, PUPIL_MAX_SIDE_PX + 1, "each side is 1 to");
    CASE(buffer.height, PUPIL_MAX_SIDE_PX + 1, "each side is 1 to");
    CASE(buffer.pixel, PUPIL_PIXEL_RGB32F, "none that can be imported");
    CASE(buffer.fd[1], -1, "plane 1 has no file descriptor");
    CASE(buffer.offset_bytes[1], UINT32_MAX, "an offset of 4294967295");
    CASE(buffer.stride_bytes[0], UINT32_MAX, "a stride of 4294967295");
    CASE(buffer.stride_bytes[1], 31, "plane 1 has rows of 32 bytes, more than its stride of 31");
    CASE(buffer.offset_bytes[1], 65000, "plane 1 ends at byte");
    CASE(extensions, "EGL_KHR_image_base", "EGL lacks EGL_EXT_image_dma_buf_import");
    CASE(extensions, "EGL_EXT_image_dma_buf_import", "EGL lacks EGL_KHR_image_base");
    CASE(gl_extensions, "", "OpenGL ES lacks GL_OES_EGL_image");
    for (int i = 0; i < count; i++) {
        pupil_dmabuf_textures textures;
        begin();
        fake.extensions = cases[i].extensions ? cases[i].extensions : fake.extensions;
        fake.gl_extensions = cases[i].gl_extensions ? cases[i].gl_extensions : fake.gl_extensions;
        CHECK(pupil_dmabuf_import(&cases[i].buffer, &textures, &why) == -1 && is_clean());
        CHECK_MSG(strstr(why.text, cases[i].says), "%d: %s", i, why.text);
    }
    pupil_dmabuf_textures textures;
    begin();
    fake.is_current = 0;
    CHECK(pupil_dmabuf_import(&right, &textures, &why) == -1 && strstr(why.text, "no EGL context is current"));
}

/* Linear buffers are not checked here, only by the driver. */
static void test_modifiers(void)
{
    pupil_dmabuf buffer = buffer_of(PUPIL_PIXEL_RGBA8);
    pupil_dmabuf_textures textures;
    begin();
    buffer.has_modifier = 1;
    CHECK_MSG(pupil_dmabuf_import(&buffer, &textures, &why) == 0, "%s", why.text);
    CHECK(fake_egl_attribute(EGL_DMA_BUF_PLANE0_MODIFIER_LO_EXT) == 0);
    pupil_dmabuf_release(&textures);
    buffer.modifier = UINT64_C(0x100000002);
    buffer.stride_bytes[0] = 4;
    fake.stale_errors = 20; /* a lost context */
    CHECK(pupil_dmabuf_import(&buffer, &textures, &why) == -1 && strstr(why.text, "OpenGL's error 0x500"));
    fake.stale_errors = 3;
    CHECK_MSG(pupil_dmabuf_import(&buffer, &textures, &why) == 0, "%s", why.text);
    CHECK(fake_egl_attribute(EGL_DMA_BUF_PLANE0_MODIFIER_LO_EXT) == 2 &&
          fake_egl_attribute(EGL_DMA_BUF_PLANE0_MODIFIER_HI_EXT) == 1);
    pupil_dmabuf_release(&textures);
    fake.extensions = "EGL_KHR_image_base EGL_EXT_image_dma_buf_import";
    CHECK(pupil_dmabuf_import(&buffer, &textures, &why) == -1 && strstr(why.text, "its modifier is 0x100000002"));
    buffer = buffer_of(PUPIL_PIXEL_RGBA8);
    buffer.has_modifier = 1; /* linear, which needs no extension */
    CHECK(pupil_dmabuf_import(&buffer, &textures, &why) == 0 &&
          fake_egl_attribute(EGL_DMA_BUF_PLANE0_MODIFIER_LO_EXT) == -1);
    pupil_dmabuf_release(&textures);
    int ends[2]; /* something whose size cannot be known */
    CHECK(pipe(ends) == 0);
    buffer.fd[0] = ends[0];
    CHECK(pupil_dmabuf_import(&buffer, &textures, &why) == 0);
    pupil_dmabuf_release(&textures);
    close(ends[0]);
    close(ends[1]);
    CHECK(is_clean());
}

static void test_each_call(void)
{
    static const uint32_t pixels[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_RGBX8, PUPIL_PIXEL_BGRX8, PUPIL_PIXEL_I420};
    for (size_t i = 0; i < sizeof pixels / sizeof *pixels; i++) {
        const pupil_dmabuf buffer = buffer_of(pixels[i]);
        pupil_dmabuf_textures textures;
        uint32_t framebuffer;
        unsigned long at = 0;
        const int is_drawn = pixels[i] != PUPIL_PIXEL_I420;
        do {
            begin();
            fake.fail_at = ++at;
            const int failed = is_drawn ? pupil_dmabuf_framebuffer(&buffer, &textures, &framebuffer, &why)
                                        : pupil_dmabuf_import(&buffer, &textures, &why);
            CHECK_MSG(!failed == !fake.failed && (!failed || is_clean()), "call %lu: %s", at, why.text);
            CHECK(!is_drawn || (framebuffer != 0) == !failed);
            pupil_dmabuf_release(&textures);
            CHECK(is_clean());
        } while (fake.failed);
        CHECK(at > 3);
    }
    pupil_dmabuf_textures textures;
    uint32_t framebuffer = 7;
    const pupil_dmabuf buffer = buffer_of(PUPIL_PIXEL_NV12);
    CHECK(pupil_dmabuf_framebuffer(&buffer, &textures, &framebuffer, &why) == -1 && framebuffer == 0 &&
          strstr(why.text, "cannot be drawn to"));
}

static void test_fences(void)
{
    begin();
    pupil_fence *fence = pupil_fence_make();
    CHECK(fence && fake.syncs == 1 && pupil_fence_done(fence) == 1);
    fake.waits = EGL_TIMEOUT_EXPIRED_KHR;
    CHECK(pupil_fence_done(fence) == 0);
    fake.waits = EGL_FALSE;
    CHECK(pupil_fence_done(fence) == -1);
    const int fd = pupil_fence_fd(fence);
    CHECK(fd >= 0);
    close(fd);
    pupil_fence_close(fence);
    pupil_fence_close(NULL);
    CHECK(pupil_fence_done(NULL) == -1 && is_clean());
    begin();
    fake.fail_at = 1; /* no native one */
    fence = pupil_fence_make();
    CHECK(fence && fake.syncs == 1);
    pupil_fence_close(fence);
    begin();
    fake.extensions = "EGL_KHR_fence_sync";
    fake.fail_at = 1;
    CHECK(!pupil_fence_make() && pupil_fence_fd(NULL) == -1);
    fake.extensions = "";
    CHECK(!pupil_fence_make());
    fake.is_current = 0;
    CHECK(!pupil_fence_make() && pupil_fence_fd(NULL) == -1 && is_clean());
}

/* Afterwards either the driver owns the file or still the caller: never both, never neither. */
static void test_wait_for_file(void)
{
    static const char *const extensions[] = {NULL, "EGL_KHR_wait_sync", "EGL_ANDROID_native_fence_sync"};
    for (unsigned long fail_at = 0; fail_at < 3; fail_at++)
        for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++) {
            const int files = scratch_entries("/proc/self/fd"), fd = dup(file);
            begin();
            fake.extensions = extensions[i] ? extensions[i] : fake.extensions;
            fake.fail_at = fail_at;
            const int waits = pupil_fence_wait_fd(fd) == 0;
            CHECK(waits == (i == 0 && fail_at == 0));
            CHECK(scratch_entries("/proc/self/fd") == files + !waits && is_clean());
            if (!waits)
                CHECK(close(fd) == 0);
        }
    begin();
    CHECK(pupil_fence_wait_fd(-1) == -1);
    CHECK(pupil_fence_wait_fd(1 << 20) == -1); /* no file */
    fake.is_current = 0;
    CHECK(pupil_fence_wait_fd(file) == -1 && is_clean());
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    file = open(scratch("buffer"), O_RDWR | O_CREAT, 0600);
    CHECK(file >= 0 && ftruncate(file, 65536) == 0);
    test_formats();
    test_refusals();
    test_modifiers();
    test_each_call();
    test_fences();
    test_wait_for_file();
    close(file);
    scratch_clear(scratch_folder);
    return check_end();
}
