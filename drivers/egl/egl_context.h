/* drivers/egl/egl_context.h: an OpenGL ES context without a window, for pupil_gles (pupil/gles.h).
 *
 * Where EGL is left out of the build (PUPIL_GPU=OFF) open fails with a sentence that says so.
 *
 * Threads: a context is current in one thread at a time; it is made current in the thread that opens it.
 */
#ifndef PUPIL_DRIVERS_EGL_CONTEXT_H
#define PUPIL_DRIVERS_EGL_CONTEXT_H

#include <stddef.h>

#include "pupil/error.h"
#include "pupil/gles.h"

typedef struct pupil_egl pupil_egl;

typedef struct pupil_egl_options {
    uint32_t version; /* a pupil_gles_version: at least this one; 0: 3.1, or else 3.0 */
    int debug;        /* a debug context, for KHR_debug */
    int robust;       /* with reset notification, where the driver has it */
} pupil_egl_options;

/* On the display of the surfaceless platform, or else of a GBM device, of EGL's first device, or the default one; it
 * stays initialised until the process ends. 0, or -1 and a sentence that says what to install or what the driver lacks.
 * options NULL: all zero. */
int pupil_egl_open(pupil_egl **egl, const pupil_egl_options *options, pupil_why *why);

/* Destroys the context; if it was current in this thread, none is now. NULL is allowed. pupil_gles_close comes first.
 */
void pupil_egl_close(pupil_egl *egl);

/* 0: current in this thread from now on. */
int pupil_egl_make_current(pupil_egl *egl);
/* No context in this thread. */
int pupil_egl_release_current(pupil_egl *egl);

/* For pupil_gles_init. */
pupil_gles_function pupil_egl_get_proc(const char *name);

/* The EGLDisplay; for a window's context (drivers/window/window.h) use eglGetCurrentDisplay. */
void *pupil_egl_display(const pupil_egl *egl);

/* GL_RENDERER and GL_VERSION of the current context, as text for messages: "llvmpipe (...), OpenGL ES 3.2 ..." */
void pupil_egl_describe(char *text, size_t text_bytes);

#endif
