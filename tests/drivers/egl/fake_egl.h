/* tests/drivers/egl/fake_egl.h: an EGL and the few functions of OpenGL ES that drivers/egl calls, in the place of the
 * driver's: what it has is the test's choice, what was made and not given back is counted, and the n-th call that may
 * fail does. It draws nothing. */
#ifndef PUPIL_TESTS_DRIVERS_EGL_FAKE_EGL_H
#define PUPIL_TESTS_DRIVERS_EGL_FAKE_EGL_H

#include <stdint.h>

#define EGL_NO_X11 1
#include <EGL/egl.h>
#include <EGL/eglext.h>

typedef struct fake_egl {
    /* what it has */
    const char *client_extensions, *extensions, *version; /* of EGL */
    const char *gl_version, *gl_extensions;
    const char *missing; /* the function that eglGetProcAddress does not find */
    int devices;
    uint32_t newest;  /* contexts up to this version: 32 */
    EGLint waits;     /* what eglClientWaitSync answers */
    int stale_errors; /* of OpenGL, from before */
    EGLint error;     /* eglGetError's answer to whatever fails */
    /* the n-th call fails */
    unsigned long calls, fail_at; /* from 1; 0: none */
    const char *failed;
    /* what there is */
    int contexts, images, textures, framebuffers, syncs, is_current;
    EGLenum platform;                      /* of the display that was asked for last; 0: the default one */
    EGLint attributes[32];                 /* of the context, the image or the sync that was made last */
    EGLint fourcc[3], width[3], height[3]; /* of the images, in order */
    int image_count;
    int swizzles;
} fake_egl;

extern fake_egl fake;

/* A whole EGL 1.5 with everything. */
void fake_egl_begin(void);

/* The value of an attribute of what was made last; -1: it has none. */
EGLint fake_egl_attribute(EGLint name);

#endif
