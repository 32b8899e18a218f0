/* tests/gles/session.h: an object behind the shim (gl_shim.h), small frames of changing light for it, and a target. In
 * a header, so that its checks count as the test's own. */
#ifndef PUPIL_TESTS_SESSION_H
#define PUPIL_TESTS_SESSION_H

#include "frames.h"
#include "gl_shim.h"
#include "gl_test.h"
#include "pupil/error.h"
#include "pupil/gles.h"

#define SESSION_FRAMES 5 /* of different light, in turn; not a multiple of the ring's three */

typedef struct session {
    gl_test test;
    pupil_t pupil;
    pupil_gles gles;
    pupil_gles_config config;
    frame frame[SESSION_FRAMES];
    pupil_gles_target target;
    pupil_why why;
} session;

static inline const char *session_name(const session *s)
{
    static char text[64];
    snprintf(text, sizeof text, "ES %u, adapting on the %s, pixel %u", s->config.version,
             s->config.adapt == PUPIL_GLES_ADAPT_GPU ? "GPU" : "CPU", s->config.pixel);
    return text;
}

/* Settings that both versions and both sides support. */
static inline pupil_config session_settings(void)
{
    pupil_config settings;
    pupil_config_default(&settings);
    settings.white_mode = PUPIL_WHITE_FIXED;
    settings.white = 4.0;
    return settings;
}

/* A new pupil_t, frames and a target, for an open context; the target is the only GL object that is made. */
static inline void session_set(session *s, uint32_t version, uint32_t adapt, uint32_t pixel, uint32_t width,
                               uint32_t height)
{
    const pupil_config settings = session_settings();
    CHECK(pupil_init(&s->pupil, &settings) == PUPIL_OK);
    pupil_gles_config_default(&s->config);
    s->config.version = version;
    s->config.adapt = adapt;
    s->config.pixel = pixel;
    s->config.width = width;
    s->config.height = height;
    for (int i = 0; i < SESSION_FRAMES; i++) {
        if (s->frame[i].memory)
            frame_free(&s->frame[i]);
        s->frame[i] = frame_make(width, height, pixel, 0, 0);
        frame_lognormal(&s->frame[i], 0.02 * (1 << i), 1.0, check_uniform);
    }
    s->target = (pupil_gles_target){
        .framebuffer = gl_test_framebuffer(&s->test, width, height), .width = width, .height = height, .top_first = 1};
}

static inline void session_free(session *s)
{
    for (int i = 0; i < SESSION_FRAMES; i++)
        if (s->frame[i].memory)
            frame_free(&s->frame[i]);
    memset(s->frame, 0, sizeof s->frame);
}

static inline int session_init(session *s)
{
    memset(s->why.text, 0, sizeof s->why);
    return pupil_gles_init(&s->gles, &s->config, &s->pupil, gl_shim_get_proc, &s->why);
}

static inline pupil_frame_info session_info(unsigned long i)
{
    return (pupil_frame_info){.timestamp_ns = 1000000000 + (int64_t)i * 33333333, .sequence = i};
}

static inline int session_upload(session *s, unsigned long i)
{
    shim.frame = i;
    return pupil_gles_upload(&s->gles, &s->frame[i % SESSION_FRAMES].image);
}

static inline int session_process(session *s, unsigned long i)
{
    const pupil_frame_info info = session_info(i);
    const int error = session_upload(s, i);
    return error ? error : pupil_gles_process(&s->gles, &s->pupil, &info, &s->target);
}

/* Without ES 3.1 in the context there is nothing to test of it. */
static inline int session_has_31(void)
{
    const char *text = (const char *)glGetString(GL_VERSION);
    return strcmp(text, "OpenGL ES 3.1") >= 0;
}

/* A new object, frames of 16 x 4, and a reset shim. kind & 1: ES 3.1; kind & 2: adapting on the GPU. 0: the context
 * lacks this version. */
static inline int session_set_kind(session *s, int kind, uint32_t pixel)
{
    if (kind & 1 && !session_has_31())
        return 0;
    gl_shim_begin(1);
    session_set(s, kind & 1 ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30, kind & 2 ? PUPIL_GLES_ADAPT_GPU : PUPIL_GLES_ADAPT_CPU,
                pixel, 16, 4);
    return 1;
}

#endif
