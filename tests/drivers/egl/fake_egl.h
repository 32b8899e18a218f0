/* tests/drivers/egl/fake_egl.h: an EGL and the few functions of OpenGL ES that drivers/egl calls, instead of the
 * driver's. The test chooses what it has; objects that were made and not released are counted, and the n-th call that
 * can fail does. It draws nothing. */
#ifndef PUPIL_TESTS_DRIVERS_EGL_FAKE_EGL_H
#define PUPIL_TESTS_DRIVERS_EGL_FAKE_EGL_H

#include <stdint.h>

#define EGL_NO_X11 1
#include <EGL/egl.h>
#include <EGL/eglext.h>

typedef struct fake_egl {
    /* its capabilities */
    const char *client_extensions, *extensions, *version; /* of EGL */
    const char *gl_version, *gl_extensions;
    const char *missing; /* the function that eglGetProcAddress does not find */
    int devices;
    uint32_t newest;  /* contexts up to this version: 32 */
    EGLint waits;     /* what eglClientWaitSync answers */
    int stale_errors; /* OpenGL's error, from earlier calls */
    EGLint error;     /* eglGetError's answer to any failure */
    /* the calls that fail */
    unsigned long calls, fail_at; /* from 1; 0: none */
    const char *failed;
    /* what exists */
    int contexts, images, textures, framebuffers, syncs, is_current;
    EGLenum platform;                      /* of the display that was last asked for; 0: the default one */
    EGLint attributes[32];                 /* of the last context, image or sync that was made */
    EGLint fourcc[3], width[3], height[3]; /* of the images, in order */
    int image_count;
    int swizzles;
} fake_egl;

extern fake_egl fake;

/* A whole EGL 1.5 with everything. */
void fake_egl_begin(void);

/* An attribute of the object that was made last; -1: it has none. */
EGLint fake_egl_attribute(EGLint name);

#endif
