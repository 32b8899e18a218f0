/* A context without a window. The display is never terminated: it belongs to the whole process, and
 * initialising it again does nothing. */
#include "egl/egl_context.h"

#include <GLES3/gl3.h>
#include <stdio.h>
#include <stdlib.h>

#include "egl_private.h"
#include "refuse.h"

struct pupil_egl {
    EGLDisplay display;
    EGLContext context;
};

/* A display of the platform; EGL_NO_DISPLAY: not here. */
static EGLDisplay platform_display(EGLenum platform, const char *extension)
{
    PFNEGLGETPLATFORMDISPLAYEXTPROC get =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    PFNEGLQUERYDEVICESEXTPROC devices = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    EGLDeviceEXT first = NULL; /* for GBM: a device of EGL's own choice */
    EGLint count = 0;
    if (!get || !pupil_egl_has(EGL_NO_DISPLAY, extension))
        return EGL_NO_DISPLAY;
    if (platform == EGL_PLATFORM_DEVICE_EXT && (!devices || !devices(1, &first, &count) || count < 1))
        return EGL_NO_DISPLAY;
    return get(platform, first, NULL);
}

/* The first display that can be initialised; EGL_NO_DISPLAY: none. */
static EGLDisplay find_display(void)
{
    static const struct {
        EGLenum platform;
        const char *extension;
    } platforms[] = {{EGL_PLATFORM_SURFACELESS_MESA, "EGL_MESA_platform_surfaceless"},
                     {EGL_PLATFORM_GBM_KHR, "EGL_KHR_platform_gbm"},
                     {EGL_PLATFORM_DEVICE_EXT, "EGL_EXT_platform_device"}};
    for (size_t i = 0; i < sizeof platforms / sizeof *platforms; i++) {
        EGLDisplay display = platform_display(platforms[i].platform, platforms[i].extension);
        if (display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL))
            return display;
    }
    EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    return display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL) ? display : EGL_NO_DISPLAY;
}

/* Any configuration will do, for nothing is ever drawn to a surface of EGL's. */
static EGLConfig any_config(EGLDisplay display)
{
    static const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT_KHR, EGL_SURFACE_TYPE, 0, EGL_NONE};
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint count = 0;
    if (!pupil_egl_has(display, "EGL_KHR_no_config_context"))
        eglChooseConfig(display, wanted, &config, 1, &count);
    return config;
}

static EGLContext create(EGLDisplay display, uint32_t version, int debug, int robust)
{
    int newest = pupil_egl_has_15(display);
    EGLint attributes[16];
    int n = 0;
    attributes[n++] = EGL_CONTEXT_MAJOR_VERSION; /* EGL_CONTEXT_CLIENT_VERSION in EGL 1.4 */
    attributes[n++] = (EGLint)(version / 10);
    if (newest || pupil_egl_has(display, "EGL_KHR_create_context")) {
        attributes[n++] = EGL_CONTEXT_MINOR_VERSION;
        attributes[n++] = (EGLint)(version % 10);
        if (debug) {
            attributes[n++] = newest ? EGL_CONTEXT_OPENGL_DEBUG : EGL_CONTEXT_FLAGS_KHR;
            attributes[n++] = newest ? EGL_TRUE : EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR;
        }
    }
    if (robust) {
        int extension = pupil_egl_has(display, "EGL_EXT_create_context_robustness");
        if (!extension && !newest)
            return EGL_NO_CONTEXT;
        attributes[n++] = extension ? EGL_CONTEXT_OPENGL_ROBUST_ACCESS_EXT : EGL_CONTEXT_OPENGL_ROBUST_ACCESS;
        attributes[n++] = EGL_TRUE;
        attributes[n++] = extension ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT
                                    : EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY;
        attributes[n++] = EGL_LOSE_CONTEXT_ON_RESET;
    }
    attributes[n] = EGL_NONE;
    return eglCreateContext(display, any_config(display), EGL_NO_CONTEXT, attributes);
}

/* The current context's version, as 32 for 3.2; 0: no OpenGL ES. */
static uint32_t current_version(void)
{
    PFNGLGETSTRINGPROC get_string = (PFNGLGETSTRINGPROC)eglGetProcAddress("glGetString");
    const char *text = (const char *)get_string(GL_VERSION);
    unsigned major, minor;
    return text && sscanf(text, "OpenGL ES %u.%u", &major, &minor) == 2 ? major * 10 + minor : 0;
}

static int open_context(pupil_egl *egl, const pupil_egl_options *options, pupil_why *why)
{
    uint32_t lowest = options->version ? options->version : PUPIL_GLES_ES30;
    uint32_t version = options->version ? options->version : PUPIL_GLES_ES31;
    if (!eglBindAPI(EGL_OPENGL_ES_API))
        return pupil_refuse(why, "EGL has no OpenGL ES here: %s", pupil_egl_error());
    if (!pupil_egl_has(egl->display, "EGL_KHR_surfaceless_context"))
        return pupil_refuse(why, "EGL has no contexts without a window here: it lacks %s",
                            "EGL_KHR_surfaceless_context");
    for (; version >= lowest && egl->context == EGL_NO_CONTEXT; version--) {
        if (options->robust)
            egl->context = create(egl->display, version, options->debug, 1);
        if (egl->context == EGL_NO_CONTEXT)
            egl->context = create(egl->display, version, options->debug, 0);
    }
    if (egl->context == EGL_NO_CONTEXT)
        return pupil_refuse(why, "the driver has no OpenGL ES %u.%u: %s", lowest / 10, lowest % 10, pupil_egl_error());
    if (pupil_egl_make_current(egl) != 0)
        return pupil_refuse(why, "the OpenGL ES context cannot be made current: %s", pupil_egl_error());
    if (!eglGetProcAddress("glGetString")) /* EGL 1.4 may find only extensions' functions */
        return pupil_refuse(why, "EGL does not find OpenGL ES's own functions here: it lacks %s",
                            "EGL_KHR_get_all_proc_addresses");
    uint32_t got = current_version();
    if (got < lowest)
        return pupil_refuse(why, "the driver has OpenGL ES %u.%u; %u.%u is needed", got / 10, got % 10, lowest / 10,
                            lowest % 10);
    return 0;
}

int pupil_egl_open(pupil_egl **egl, const pupil_egl_options *options, pupil_why *why)
{
    static const pupil_egl_options usual;
    if (!options)
        options = &usual;
    *egl = NULL;
    if (options->version != PUPIL_GLES_BEST && options->version != PUPIL_GLES_ES30 &&
        options->version != PUPIL_GLES_ES31)
        return pupil_refuse(why, "version %u is not a pupil_gles_version; give 0, 30 or 31", options->version);
    pupil_egl *opened = calloc(1, sizeof *opened);
    if (!opened)
        return pupil_refuse(why, "out of memory");
    opened->context = EGL_NO_CONTEXT;
    opened->display = find_display();
    if (opened->display == EGL_NO_DISPLAY) {
        free(opened);
        return pupil_refuse(why, "no driver for OpenGL ES is found (%s). On Debian: apt-get install libgl1-mesa-dri",
                            pupil_egl_error());
    }
    if (open_context(opened, options, why) != 0) {
        pupil_egl_close(opened);
        return -1;
    }
    *egl = opened;
    return 0;
}

void pupil_egl_close(pupil_egl *egl)
{
    if (!egl)
        return;
    if (egl->context != EGL_NO_CONTEXT) {
        if (eglGetCurrentContext() == egl->context)
            pupil_egl_release_current(egl);
        eglDestroyContext(egl->display, egl->context);
    }
    free(egl);
}

int pupil_egl_make_current(pupil_egl *egl)
{
    return eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context) ? 0 : -1;
}

int pupil_egl_release_current(pupil_egl *egl)
{
    return eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT) ? 0 : -1;
}

pupil_gles_function pupil_egl_get_proc(const char *name)
{
    return eglGetProcAddress(name);
}

void *pupil_egl_display(const pupil_egl *egl)
{
    return egl->display;
}

void pupil_egl_describe(char *text, size_t text_bytes)
{
    PFNGLGETSTRINGPROC get_string = (PFNGLGETSTRINGPROC)eglGetProcAddress("glGetString");
    const char *renderer = (const char *)get_string(GL_RENDERER), *version = (const char *)get_string(GL_VERSION);
    snprintf(text, text_bytes, "%s, %s", renderer ? renderer : "no renderer", version ? version : "no OpenGL ES");
}
