/* tests/gles/gl_test.h: shared by the GPU tests: a context without a window that receives its driver's messages
 * (GL_KHR_debug), and a framebuffer.
 *
 *     static gl_test test;
 *     int status = gl_test_open(&test, PUPIL_GLES_BEST);
 *     if (status != 0)
 *         return status;                  // no driver, or not this version: skipped
 *     ... gl_test_framebuffer(&test, 64, 48) ... gl_test_read(&test, rgba)
 *     gl_test_close(&test);               // the driver has said nothing bad
 *     return check_end();
 */
#ifndef PUPIL_TESTS_GL_TEST_H
#define PUPIL_TESTS_GL_TEST_H

#include <GLES3/gl32.h>

#include "check.h"
#include "egl/egl_context.h"

typedef struct gl_test {
    pupil_egl *egl;
    unsigned long messages; /* messages of the driver that a correct program does not cause */
    int listens;            /* the driver has GL_KHR_debug */
    uint32_t framebuffer, texture, width, height;
} gl_test;

/* 0, or the exit status: 77 with a message if there is no driver, or none of this version (a pupil_gles_version; 0: 3.1
 * or else 3.0). The object must not move until gl_test_close. */
int gl_test_open(gl_test *test, uint32_t version);

/* Releases everything; pending messages, and the last glGetError, are still reported. */
GLenum gl_test_end(gl_test *test);

/* The driver interprets shaders, pixel by pixel: it takes thirty times as long as one that compiles them, so tests
 * compare less there. */
int gl_test_interprets(void);

/* For a test that provokes errors: those so far were expected. */
void gl_test_forget(gl_test *test);

/* The name of a framebuffer with one RGBA8 attachment, which replaces an earlier one. It is left bound. */
uint32_t gl_test_framebuffer(gl_test *test, uint32_t width, uint32_t height);

/* Reads its pixels, width * height * 4 bytes, the framebuffer's first row first. Waits. */
void gl_test_read(const gl_test *test, uint8_t *rgba);

/* In the header, so that these checks count as the test's own. */
static inline void gl_test_close(gl_test *test)
{
    GLenum error = gl_test_end(test);
    CHECK_MSG(error == GL_NO_ERROR, "glGetError says 0x%x at the end", error);
    CHECK_MSG(test->messages == 0, "%lu messages of the driver's, above", test->messages);
}

#endif
