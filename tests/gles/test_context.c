/* egl/egl_context.h and egl/dmabuf.h, where no device is needed: contexts in sequence, simultaneously and in two
 * threads, what is refused, fences. */
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "egl/dmabuf.h"
#include "gles/gl_test.h"
#include "resident.h"

/* Not counted: Mesa's caches fill with the first contexts, those of version 25 with some 200. */
#define WARM_UP 200
#define OPENED  180
/* softpipe clears tens of MiB for each. */
#define WARM_UP_SOFTPIPE 20
#define OPENED_SOFTPIPE  20
/* A leaked llvmpipe context keeps 2.5 MiB; 180 leaks of 4 KiB, the smallest step of resident memory, would be 720 KiB.
 * Other growth takes some dozens. */
#define GROWTH_KIB 300

static pupil_why why;

/* Uses only EGL, so that a fault of pupil_egl_open does not look like a machine without a driver; and in a child
 * process, so that later children have none of the driver's threads. */
static int has_driver(void)
{
    pid_t child = fork();
    int status = -1;
    if (child == 0) {
        PFNEGLGETPLATFORMDISPLAYEXTPROC get =
            (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
        EGLDisplay display = get ? get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL) : EGL_NO_DISPLAY;
        _exit(display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL) ? 0 : 1);
    }
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

static void check_growth(void)
{
    pupil_egl *egl;
    long before = -1, after;
    int warm_up = WARM_UP, opened = OPENED;
    for (int i = 0; i < warm_up + opened; i++) {
        if (i == warm_up)
            before = resident_kib();
        why.text[0] = 0;
        CHECK_MSG(pupil_egl_open(&egl, NULL, &why) == 0, "%s", why.text);
        if (!egl)
            return;
        if (gl_test_interprets())
            warm_up = WARM_UP_SOFTPIPE, opened = OPENED_SOFTPIPE;
        gl_test test = {.egl = egl};
        uint8_t rgba[8 * 8 * 4];
        gl_test_framebuffer(&test, 8, 8);
        glClearColor(0, 1, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        gl_test_read(&test, rgba);
        CHECK(rgba[0] == 0 && rgba[1] == 255 && rgba[2] == 0 && rgba[3] == 255);
        CHECK(gl_test_end(&test) == GL_NO_ERROR);
    }
    after = resident_kib();
    printf("resident after %d contexts %ld KiB, after %d more %ld KiB\n", warm_up, before, opened, after);
#if !CHECK_SANITIZED /* it keeps freed memory for a while */
    CHECK_MSG(before > 0 && after - before <= GROWTH_KIB, "grew by %ld KiB", after - before);
#endif
}

static void *in_other_thread(void *egl)
{
    static int made;
    made = pupil_egl_make_current(egl) == 0 && glGetString(GL_VERSION) && pupil_egl_release_current(egl) == 0;
    return &made;
}

static void check_current(void)
{
    pupil_egl *first = NULL, *second = NULL;
    pthread_t thread;
    void *made = NULL;
    CHECK(pupil_egl_open(&first, NULL, &why) == 0);
    CHECK(pupil_egl_open(&second, NULL, &why) == 0);
    EGLContext of_second = eglGetCurrentContext();
    CHECK(of_second != EGL_NO_CONTEXT && pupil_egl_display(first) == eglGetCurrentDisplay());
    CHECK(pupil_egl_make_current(first) == 0 && eglGetCurrentContext() != of_second);
    /* Closing one leaves the other, and the display, alone. */
    pupil_egl_close(second);
    CHECK(glGetString(GL_VERSION) != NULL && glGetError() == GL_NO_ERROR);
    CHECK(pupil_egl_release_current(first) == 0 && eglGetCurrentContext() == EGL_NO_CONTEXT);
    CHECK(pthread_create(&thread, NULL, in_other_thread, first) == 0 && pthread_join(thread, &made) == 0);
    CHECK(made && *(int *)made);
    CHECK(pupil_egl_make_current(first) == 0 && glGetString(GL_VERSION) != NULL);
    pupil_egl_close(first);
    CHECK(eglGetCurrentContext() == EGL_NO_CONTEXT);
    pupil_egl_close(NULL);
}

static void check_options(void)
{
    pupil_egl *egl;
    pupil_egl_options options = {.version = 20};
    CHECK(pupil_egl_open(&egl, &options, &why) == -1 && !egl && strstr(why.text, "give 0, 30 or 31"));
    CHECK(pupil_egl_open(&egl, &options, NULL) == -1);
    options = (pupil_egl_options){.debug = 1, .robust = 1};
    CHECK(pupil_egl_open(&egl, &options, &why) == 0);
    GLint flags = 0;
    glGetIntegerv(GL_CONTEXT_FLAGS, &flags);
    if (strstr((const char *)glGetString(GL_VERSION), "ES 3.2"))
        CHECK(flags & GL_CONTEXT_FLAG_DEBUG_BIT);
    if (strstr((const char *)glGetString(GL_EXTENSIONS), "GL_KHR_robustness")) {
        GLint strategy = 0;
        glGetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
        CHECK_MSG(strategy == GL_LOSE_CONTEXT_ON_RESET, "strategy 0x%x", strategy);
    }
    glGetError(); /* the names above are ES 3.2's */
    pupil_egl_close(egl);
}

/* In a separate process with its own environment, because Mesa reads it once. Other drivers always give their best
 * version. */
static void check_version(const char *override, uint32_t version, const char *refusal)
{
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        pupil_egl *egl;
        pupil_egl_options options = {.version = version};
        setenv("MESA_GLES_VERSION_OVERRIDE", override, 1);
        setenv("LIBGL_ALWAYS_SOFTWARE", "true", 1);
        int status = pupil_egl_open(&egl, &options, &why);
        int expected = refusal ? status == -1 && !egl && strstr(why.text, refusal) : status == 0;
        if (status == 0 && !strstr((const char *)glGetString(GL_VERSION), "Mesa"))
            expected = 1;
        if (!expected)
            printf("OpenGL ES %s, %u asked for: status %d, \"%s\"\n", override, version, status,
                   status ? why.text : "");
        pupil_egl_close(egl);
        fflush(stdout);
        _exit(expected ? 0 : 1);
    }
    int status = -1;
    CHECK(child > 0 && waitpid(child, &status, 0) == child);
    CHECK_MSG(WIFEXITED(status) && WEXITSTATUS(status) == 0, "OpenGL ES %s, %u asked for", override, version);
}

static void check_fences(void)
{
    pupil_fence *fence = pupil_fence_make();
    CHECK((fence != NULL) ==
          (strstr(eglQueryString(eglGetCurrentDisplay(), EGL_EXTENSIONS), "EGL_KHR_fence_sync") != NULL));
    pupil_fence_close(NULL);
    if (!fence)
        return;
    /* It signals although nothing waits in GL; CTest ends the test if it never does. */
    while (pupil_fence_done(fence) == 0)
        usleep(100);
    CHECK(pupil_fence_done(fence) == 1);
    int native =
        strstr(eglQueryString(eglGetCurrentDisplay(), EGL_EXTENSIONS), "EGL_ANDROID_native_fence_sync") != NULL;
    int fd = pupil_fence_fd(fence);
    CHECK((fd >= 0) == native);
    if (fd >= 0) {
        struct pollfd wanted = {.fd = fd, .events = POLLIN};
        CHECK(poll(&wanted, 1, 0) == 1 && (wanted.revents & POLLIN));
        CHECK(pupil_fence_wait_fd(fd) == 0 && fcntl(fd, F_GETFD) == -1);
    } else {
        int null = open("/dev/null", O_RDONLY);
        CHECK(pupil_fence_wait_fd(null) == -1 && fcntl(null, F_GETFD) != -1);
        close(null);
    }
    CHECK(pupil_fence_wait_fd(-1) == -1);
    pupil_fence_close(fence);
}

/* If gl_test.h reports nothing, there was no fault: here a fault is reported and counted. */
static void check_silence(gl_test *test)
{
    glEnable(GL_POINTS);
    CHECK(test->messages == (test->listens ? 1 : 0));
    CHECK(test->listens || !strstr((const char *)glGetString(GL_RENDERER), "pipe")); /* Mesa's two drivers do report */
    gl_test_forget(test);
    CHECK(test->messages == 0 && glGetError() == GL_NO_ERROR);
}

static void refused(const pupil_dmabuf *buffer, const char *words)
{
    pupil_dmabuf_textures textures;
    memset(&textures, 0xff, sizeof textures);
    why.text[0] = 0;
    CHECK(pupil_dmabuf_import(buffer, &textures, &why) == -1);
    CHECK_MSG(strstr(why.text, words) != NULL, "\"%s\" does not say \"%s\"", why.text, words);
    for (int i = 0; i < 3; i++)
        CHECK(!textures.texture[i] && !textures.image[i]);
    pupil_dmabuf_release(&textures);
}

/* Memory that is no dma-buf: refused by the driver, or imported by one on the CPU that maps any file (Mesa 25). */
static void check_import(const pupil_dmabuf *buffer)
{
    pupil_dmabuf_textures textures;
    if (pupil_dmabuf_import(buffer, &textures, &why)) {
        refused(buffer, "the driver does not import");
        return;
    }
    CHECK(textures.texture[0] && textures.texture[1]);
    pupil_dmabuf_release(&textures);
}

/* Refused before the driver is asked, and by the driver. */
static void check_dmabuf(int memory)
{
    pupil_dmabuf good = {.pixel = PUPIL_PIXEL_NV12,
                         .width = 64,
                         .height = 48,
                         .fd = {memory, memory},
                         .offset_bytes = {0, 64 * 48},
                         .stride_bytes = {64, 64}};
    pupil_dmabuf b = good;
    pupil_dmabuf_textures textures;
    uint32_t framebuffer = 7;
    b.width = 0;
    refused(&b, "0 x 48 pixels; each side is 1 to 16384");
    b = good, b.pixel = PUPIL_PIXEL_RGB8;
    refused(&b, "pixel format 7 is none");
    b = good, b.fd[1] = -1;
    refused(&b, "plane 1 has no file descriptor");
    b = good, b.stride_bytes[1] = 63;
    refused(&b, "plane 1 has rows of 64 bytes, more than its stride of 63");
    b = good, b.offset_bytes[1]++;
    refused(&b, "plane 1 ends at byte 4609 of a buffer of 4608");
    b = good, b.offset_bytes[0] = 0x80000000u;
    refused(&b, "plane 0");
    b = (pupil_dmabuf){.pixel = PUPIL_PIXEL_I420,
                       .width = 64,
                       .height = 48,
                       .fd = {memory, memory, memory},
                       .offset_bytes = {0, 64 * 48, 64 * 48 + 32 * 24 + 1},
                       .stride_bytes = {64, 32, 32}};
    refused(&b, "plane 2 ends at byte 4609 of a buffer of 4608");
    b.stride_bytes[2] = 31;
    refused(&b, "plane 2 has rows of 32 bytes, more than its stride of 31");
    b.pixel = PUPIL_PIXEL_P010;
    refused(&b, "plane 0 has rows of 128 bytes, more than its stride of 64");
    b = good, b.pixel = PUPIL_PIXEL_NV16;
    refused(&b, "plane 1 ends at byte 6144 of a buffer of 4608");
    b = good, b.pixel = PUPIL_PIXEL_GREY10P;
    refused(&b, "plane 0 has rows of 80 bytes, more than its stride of 64");
    CHECK(pupil_dmabuf_framebuffer(&good, &textures, &framebuffer, &why) == -1 && framebuffer == 0);
    CHECK(strstr(why.text, "RGBA8, RGBX8 and BGRX8 can, and the CPU writes more") != NULL);
    if (strstr(eglQueryString(eglGetCurrentDisplay(), EGL_EXTENSIONS), "EGL_EXT_image_dma_buf_import "))
        check_import(&good);
    else
        refused(&good, "EGL lacks EGL_EXT_image_dma_buf_import");
}

int main(int argc, char **argv)
{
    static gl_test test;
    check_begin(argc, argv);
    if (!has_driver())
        return check_skip("no OpenGL ES driver");
    check_version("2.0", PUPIL_GLES_BEST, "no OpenGL ES 3.0");
    check_version("3.0", PUPIL_GLES_ES31, "no OpenGL ES 3.1");
    check_version("3.0", PUPIL_GLES_BEST, NULL);
    check_version("3.1", PUPIL_GLES_ES31, NULL);
    check_current();
    check_options();
    check_growth();

    int memory = memfd_create("no dma-buf", 0);
    pupil_dmabuf nothing = {
        .pixel = PUPIL_PIXEL_GREY8, .width = 64, .height = 48, .fd = {memory}, .stride_bytes = {64}};
    CHECK(ftruncate(memory, 64 * 48 * 3 / 2) == 0);
    CHECK(pupil_fence_make() == NULL);
    refused(&nothing, "no EGL context is current");
    CHECK(gl_test_open(&test, PUPIL_GLES_BEST) == 0);
    check_silence(&test);
    check_fences();
    check_dmabuf(memory);
    gl_test_close(&test);
    close(memory);
    return check_end();
}
