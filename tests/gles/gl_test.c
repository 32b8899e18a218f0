#include "gles/gl_test.h"

static const char *type_name(GLenum type)
{
    switch (type) {
    case GL_DEBUG_TYPE_ERROR:
        return "error";
    case GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR:
        return "undefined behaviour";
    case GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR:
        return "deprecated";
    case GL_DEBUG_TYPE_PORTABILITY:
        return "portability";
    case GL_DEBUG_TYPE_PERFORMANCE:
        return "performance";
    default:
        return "other";
    }
}

/* Advice on speed differs between drivers and is ignored; any other message is a fault of the caller. */
static int is_fault(GLenum type, GLenum severity)
{
    switch (type) {
    case GL_DEBUG_TYPE_ERROR:
    case GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR:
    case GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR:
    case GL_DEBUG_TYPE_PORTABILITY:
        return 1;
    case GL_DEBUG_TYPE_PERFORMANCE:
        return 0;
    default:
        return severity == GL_DEBUG_SEVERITY_HIGH || severity == GL_DEBUG_SEVERITY_MEDIUM;
    }
}

static void GL_APIENTRY heard(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                              const GLchar *message, const void *user)
{
    gl_test *test = (gl_test *)(uintptr_t)user;
    int fault = is_fault(type, severity);
    (void)id, (void)length;
    if (source == GL_DEBUG_SOURCE_APPLICATION) {
        test->listens = 1;
        return;
    }
    test->messages += fault;
    printf("the driver says (%s%s): %s\n", type_name(type), fault ? "" : ", not counted", message);
}

/* Tested with a message of our own, because GL_KHR_debug may exist without being listed if extensions are hidden. */
static void listen(gl_test *test)
{
    PFNGLDEBUGMESSAGECALLBACKPROC callback =
        (PFNGLDEBUGMESSAGECALLBACKPROC)pupil_egl_get_proc("glDebugMessageCallbackKHR");
    PFNGLDEBUGMESSAGECONTROLPROC control = (PFNGLDEBUGMESSAGECONTROLPROC)pupil_egl_get_proc("glDebugMessageControlKHR");
    PFNGLDEBUGMESSAGEINSERTPROC insert = (PFNGLDEBUGMESSAGEINSERTPROC)pupil_egl_get_proc("glDebugMessageInsertKHR");
    if (callback && control && insert) {
        glEnable(GL_DEBUG_OUTPUT);
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        callback(heard, test);
        control(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, NULL, GL_TRUE);
        insert(GL_DEBUG_SOURCE_APPLICATION, GL_DEBUG_TYPE_MARKER, 1, GL_DEBUG_SEVERITY_NOTIFICATION, -1, "heard");
    }
    if (!test->listens)
        printf("the driver has no GL_KHR_debug: it says nothing\n");
    gl_test_forget(test);
}

int gl_test_interprets(void)
{
    return strstr((const char *)glGetString(GL_RENDERER), "softpipe") != NULL;
}

int gl_test_open(gl_test *test, uint32_t version)
{
    pupil_why why;
    pupil_egl_options options = {.version = version, .debug = 1};
    memset(test, 0, sizeof *test);
    setvbuf(stdout, NULL, _IOLBF, 0); /* so that messages before a crash are seen */
    if (pupil_egl_open(&test->egl, NULL, &why) != 0) {
        printf("%s\n", why.text);
        return check_skip("no OpenGL ES driver");
    }
    pupil_egl_close(test->egl);
    if (pupil_egl_open(&test->egl, &options, &why) != 0)
        return check_skip(why.text);
    pupil_egl_describe(why.text, sizeof why.text);
    printf("%s\n", why.text);
    listen(test);
    return 0;
}

static void delete_framebuffer(gl_test *test)
{
    glDeleteFramebuffers(1, &test->framebuffer);
    glDeleteTextures(1, &test->texture);
    test->framebuffer = test->texture = 0;
}

GLenum gl_test_end(gl_test *test)
{
    pupil_egl_make_current(test->egl);
    delete_framebuffer(test);
    glFinish();
    GLenum error = glGetError();
    pupil_egl_close(test->egl);
    test->egl = NULL;
    return error;
}

void gl_test_forget(gl_test *test)
{
    for (int i = 0; i < 8 && glGetError() != GL_NO_ERROR; i++) /* a lost context always has one */
        ;
    test->messages = 0;
}

uint32_t gl_test_framebuffer(gl_test *test, uint32_t width, uint32_t height)
{
    delete_framebuffer(test);
    test->width = width, test->height = height;
    glGenTextures(1, &test->texture);
    glBindTexture(GL_TEXTURE_2D, test->texture);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, (GLsizei)width, (GLsizei)height);
    glGenFramebuffers(1, &test->framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, test->framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, test->texture, 0);
    glBindTexture(GL_TEXTURE_2D, 0);
    return test->framebuffer;
}

void gl_test_read(const gl_test *test, uint8_t *rgba)
{
    glBindFramebuffer(GL_FRAMEBUFFER, test->framebuffer);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
    glReadPixels(0, 0, (GLsizei)test->width, (GLsizei)test->height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}
