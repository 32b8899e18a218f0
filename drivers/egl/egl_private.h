/* drivers/egl/egl_private.h: what the files of this folder share. */
#ifndef PUPIL_DRIVERS_EGL_EGL_PRIVATE_H
#define PUPIL_DRIVERS_EGL_EGL_PRIVATE_H

#define EGL_NO_X11 1 /* else its header brings in Xlib's */
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "refuse.h"

/* The list, words separated by blanks, has the name. NULL: an empty list. */
int pupil_egl_listed(const char *list, const char *name);
/* The display has the extension. EGL_NO_DISPLAY: EGL itself has it. */
int pupil_egl_has(EGLDisplay display, const char *extension);
/* The display's EGL is 1.5 or newer. */
int pupil_egl_has_15(EGLDisplay display);

/* The name of eglGetError: "EGL_BAD_MATCH". */
const char *pupil_egl_error(void);

#endif
