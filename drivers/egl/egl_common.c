#include "egl_private.h"

#include <stdio.h>
#include <string.h>

int pupil_egl_listed(const char *list, const char *name)
{
    size_t length = strlen(name);
    while (list && *list) {
        size_t word = strcspn(list, " ");
        if (word == length && strncmp(list, name, length) == 0)
            return 1;
        list += word;
        list += strspn(list, " ");
    }
    return 0;
}

int pupil_egl_has(EGLDisplay display, const char *extension)
{
    return pupil_egl_listed(eglQueryString(display, EGL_EXTENSIONS), extension);
}

int pupil_egl_has_15(EGLDisplay display)
{
    int major = 0, minor = 0;
    const char *version = eglQueryString(display, EGL_VERSION);
    if (!version || sscanf(version, "%d.%d", &major, &minor) != 2)
        return 0;
    return major > 1 || (major == 1 && minor >= 5);
}

const char *pupil_egl_error(void)
{
    static const struct {
        EGLint code;
        const char *name;
    } names[] = {
        {EGL_SUCCESS, "no error given"},
        {EGL_NOT_INITIALIZED, "EGL_NOT_INITIALIZED"},
        {EGL_BAD_ACCESS, "EGL_BAD_ACCESS"},
        {EGL_BAD_ALLOC, "EGL_BAD_ALLOC"},
        {EGL_BAD_ATTRIBUTE, "EGL_BAD_ATTRIBUTE"},
        {EGL_BAD_CONFIG, "EGL_BAD_CONFIG"},
        {EGL_BAD_CONTEXT, "EGL_BAD_CONTEXT"},
        {EGL_BAD_CURRENT_SURFACE, "EGL_BAD_CURRENT_SURFACE"},
        {EGL_BAD_DISPLAY, "EGL_BAD_DISPLAY"},
        {EGL_BAD_MATCH, "EGL_BAD_MATCH"},
        {EGL_BAD_NATIVE_PIXMAP, "EGL_BAD_NATIVE_PIXMAP"},
        {EGL_BAD_NATIVE_WINDOW, "EGL_BAD_NATIVE_WINDOW"},
        {EGL_BAD_PARAMETER, "EGL_BAD_PARAMETER"},
        {EGL_BAD_SURFACE, "EGL_BAD_SURFACE"},
        {EGL_CONTEXT_LOST, "EGL_CONTEXT_LOST"},
        {EGL_BAD_DEVICE_EXT, "EGL_BAD_DEVICE_EXT"},
    };
    EGLint code = eglGetError();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (names[i].code == code)
            return names[i].name;
    return "an EGL error of no name";
}
