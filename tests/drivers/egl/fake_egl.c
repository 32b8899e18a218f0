/* tests/drivers/egl/fake_egl.c: see fake_egl.h. */
#include "fake_egl.h"

#include <GLES3/gl3.h>
/* After gl3.h, whose types it needs. */
#include <GLES2/gl2ext.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

fake_egl fake;

static int display, context, gl_error;

void fake_egl_begin(void)
{
    fake = (fake_egl){.client_extensions = "EGL_EXT_platform_base EGL_MESA_platform_surfaceless EGL_KHR_platform_gbm "
                                           "EGL_EXT_platform_device EGL_EXT_device_base",
                      .extensions =
                          "EGL_KHR_surfaceless_context EGL_KHR_no_config_context EGL_EXT_create_context_robustness "
                          "EGL_KHR_image_base EGL_EXT_image_dma_buf_import EGL_EXT_image_dma_buf_import_modifiers "
                          "EGL_KHR_fence_sync EGL_KHR_wait_sync EGL_ANDROID_native_fence_sync",
                      .version = "1.5",
                      .gl_version = "OpenGL ES 3.2 Fake",
                      .gl_extensions = "GL_EXT_something GL_OES_EGL_image",
                      .devices = 1,
                      .newest = 32,
                      .waits = EGL_CONDITION_SATISFIED_KHR,
                      .error = EGL_BAD_ALLOC};
}

static int fails(const char *name)
{
    if (++fake.calls != fake.fail_at)
        return 0;
    fake.failed = name;
    return 1;
}

static void keep(const EGLint *attributes)
{
    int n = 0;
    while (attributes && n < 30 && attributes[n] != EGL_NONE) {
        fake.attributes[n] = attributes[n];
        fake.attributes[n + 1] = attributes[n + 1];
        n += 2;
    }
    fake.attributes[n] = EGL_NONE;
}

EGLint fake_egl_attribute(EGLint name)
{
    for (int n = 0; fake.attributes[n] != EGL_NONE; n += 2)
        if (fake.attributes[n] == name)
            return fake.attributes[n + 1];
    return -1;
}

/* --- EGL --- */

static EGLDisplay platform_display(EGLenum platform, void *native, const EGLint *attributes)
{
    (void)native, (void)attributes;
    fake.platform = platform;
    return fails("eglGetPlatformDisplayEXT") ? EGL_NO_DISPLAY : &display;
}

static EGLBoolean query_devices(EGLint most, EGLDeviceEXT *devices, EGLint *count)
{
    *count = fake.devices < most ? fake.devices : most;
    if (*count)
        devices[0] = &display;
    return fails("eglQueryDevicesEXT") ? EGL_FALSE : EGL_TRUE;
}

EGLDisplay EGLAPIENTRY eglGetDisplay(EGLNativeDisplayType native)
{
    (void)native;
    fake.platform = 0;
    return fails("eglGetDisplay") ? EGL_NO_DISPLAY : &display;
}

EGLBoolean EGLAPIENTRY eglInitialize(EGLDisplay of, EGLint *major, EGLint *minor)
{
    (void)of, (void)major, (void)minor;
    return fails("eglInitialize") ? EGL_FALSE : EGL_TRUE;
}

const char *EGLAPIENTRY eglQueryString(EGLDisplay of, EGLint name)
{
    return name == EGL_VERSION ? fake.version : of == EGL_NO_DISPLAY ? fake.client_extensions : fake.extensions;
}

EGLBoolean EGLAPIENTRY eglChooseConfig(EGLDisplay of, const EGLint *wanted, EGLConfig *configs, EGLint most,
                                       EGLint *count)
{
    (void)of, (void)wanted, (void)most;
    configs[0] = &display;
    *count = 1;
    return EGL_TRUE;
}

EGLBoolean EGLAPIENTRY eglBindAPI(EGLenum api)
{
    return api != EGL_OPENGL_ES_API || fails("eglBindAPI") ? EGL_FALSE : EGL_TRUE;
}

EGLContext EGLAPIENTRY eglCreateContext(EGLDisplay of, EGLConfig config, EGLContext shared, const EGLint *attributes)
{
    (void)of, (void)config, (void)shared;
    keep(attributes);
    const EGLint minor = fake_egl_attribute(EGL_CONTEXT_MINOR_VERSION);
    const uint32_t wanted =
        (uint32_t)fake_egl_attribute(EGL_CONTEXT_MAJOR_VERSION) * 10 + (minor > 0 ? (uint32_t)minor : 0);
    if (wanted > fake.newest || fails("eglCreateContext"))
        return EGL_NO_CONTEXT;
    fake.contexts++;
    return &context;
}

EGLBoolean EGLAPIENTRY eglDestroyContext(EGLDisplay of, EGLContext is)
{
    (void)of, (void)is;
    fake.contexts--;
    return EGL_TRUE;
}

EGLBoolean EGLAPIENTRY eglMakeCurrent(EGLDisplay of, EGLSurface draw, EGLSurface read, EGLContext is)
{
    (void)of, (void)draw, (void)read;
    if (fails("eglMakeCurrent"))
        return EGL_FALSE;
    fake.is_current = is != EGL_NO_CONTEXT;
    return EGL_TRUE;
}

EGLContext EGLAPIENTRY eglGetCurrentContext(void)
{
    return fake.is_current ? &context : EGL_NO_CONTEXT;
}

EGLDisplay EGLAPIENTRY eglGetCurrentDisplay(void)
{
    return fake.is_current ? &display : EGL_NO_DISPLAY;
}

EGLint EGLAPIENTRY eglGetError(void)
{
    return fake.error;
}

static EGLImageKHR create_image(EGLDisplay of, EGLContext is, EGLenum target, EGLClientBuffer buffer,
                                const EGLint *attributes)
{
    (void)of, (void)is, (void)target, (void)buffer;
    keep(attributes);
    if (fails("eglCreateImageKHR"))
        return EGL_NO_IMAGE_KHR;
    if (fake.image_count < 3) {
        fake.fourcc[fake.image_count] = fake_egl_attribute(EGL_LINUX_DRM_FOURCC_EXT);
        fake.width[fake.image_count] = fake_egl_attribute(EGL_WIDTH);
        fake.height[fake.image_count] = fake_egl_attribute(EGL_HEIGHT);
    }
    fake.image_count++;
    fake.images++;
    return &display;
}

static EGLBoolean destroy_image(EGLDisplay of, EGLImageKHR image)
{
    (void)of, (void)image;
    fake.images--;
    return EGL_TRUE;
}

static EGLSyncKHR create_sync(EGLDisplay of, EGLenum type, const EGLint *attributes)
{
    (void)of, (void)type;
    keep(attributes);
    if (fails("eglCreateSyncKHR"))
        return EGL_NO_SYNC_KHR;
    fake.syncs++;
    return &display;
}

/* Closes the file that it was made from. */
static EGLBoolean destroy_sync(EGLDisplay of, EGLSyncKHR sync)
{
    (void)of, (void)sync;
    const int fd = fake_egl_attribute(EGL_SYNC_NATIVE_FENCE_FD_ANDROID);
    if (fd >= 0)
        close(fd);
    fake.syncs--;
    return EGL_TRUE;
}

static EGLint client_wait(EGLDisplay of, EGLSyncKHR sync, EGLint flags, EGLTimeKHR timeout)
{
    (void)of, (void)sync, (void)flags, (void)timeout;
    return fake.waits;
}

static EGLint wait_sync(EGLDisplay of, EGLSyncKHR sync, EGLint flags)
{
    (void)of, (void)sync, (void)flags;
    return fails("eglWaitSyncKHR") ? EGL_FALSE : EGL_TRUE;
}

static EGLint dup_fd(EGLDisplay of, EGLSyncKHR sync)
{
    (void)of, (void)sync;
    return fails("eglDupNativeFenceFDANDROID") ? -1 : dup(0);
}

/* --- OpenGL ES --- */

static const GLubyte *get_string(GLenum name)
{
    return (const GLubyte *)(name == GL_VERSION ? fake.gl_version : name == GL_EXTENSIONS ? fake.gl_extensions : NULL);
}

static GLenum get_error(void)
{
    const GLenum error = fake.stale_errors > 0 ? GL_INVALID_ENUM : (GLenum)gl_error;
    fake.stale_errors--;
    gl_error = fake.stale_errors >= 0 ? gl_error : GL_NO_ERROR;
    return error;
}

static void gen(int *count, GLsizei n, GLuint *names)
{
    for (GLsizei i = 0; i < n; i++)
        names[i] = (GLuint)++ * count;
}

static void gen_textures(GLsizei n, GLuint *names)
{
    gen(&fake.textures, n, names);
}

static void gen_framebuffers(GLsizei n, GLuint *names)
{
    gen(&fake.framebuffers, n, names);
}

static void delete_textures(GLsizei n, const GLuint *names)
{
    (void)names;
    fake.textures -= n;
}

static void delete_framebuffers(GLsizei n, const GLuint *names)
{
    (void)names;
    fake.framebuffers -= n;
}

static void image_texture(GLenum target, GLeglImageOES image)
{
    (void)target, (void)image;
    gl_error = fails("glEGLImageTargetTexture2DOES") ? GL_INVALID_OPERATION : GL_NO_ERROR;
}

static void tex_parameter(GLenum target, GLenum name, GLint value)
{
    (void)target, (void)value;
    fake.swizzles += name == GL_TEXTURE_SWIZZLE_R;
}

static GLenum check_framebuffer(GLenum target)
{
    (void)target;
    return fails("glCheckFramebufferStatus") ? GL_FRAMEBUFFER_UNSUPPORTED : GL_FRAMEBUFFER_COMPLETE;
}

static void bind(GLenum target, GLuint name)
{
    (void)target, (void)name;
}

static void framebuffer_texture(GLenum target, GLenum place, GLenum textarget, GLuint texture, GLint level)
{
    (void)target, (void)place, (void)textarget, (void)texture, (void)level;
}

static void flush(void)
{
}

typedef __eglMustCastToProperFunctionPointerType found;

__eglMustCastToProperFunctionPointerType EGLAPIENTRY eglGetProcAddress(const char *name)
{
    static const struct {
        const char *name;
        found is;
    } functions[] = {{"eglGetPlatformDisplayEXT", (found)platform_display},
                     {"eglQueryDevicesEXT", (found)query_devices},
                     {"eglCreateImageKHR", (found)create_image},
                     {"eglDestroyImageKHR", (found)destroy_image},
                     {"eglCreateSyncKHR", (found)create_sync},
                     {"eglDestroySyncKHR", (found)destroy_sync},
                     {"eglClientWaitSyncKHR", (found)client_wait},
                     {"eglWaitSyncKHR", (found)wait_sync},
                     {"eglDupNativeFenceFDANDROID", (found)dup_fd},
                     {"glGetString", (found)get_string},
                     {"glGetError", (found)get_error},
                     {"glGenTextures", (found)gen_textures},
                     {"glBindTexture", (found)bind},
                     {"glTexParameteri", (found)tex_parameter},
                     {"glDeleteTextures", (found)delete_textures},
                     {"glEGLImageTargetTexture2DOES", (found)image_texture},
                     {"glGenFramebuffers", (found)gen_framebuffers},
                     {"glBindFramebuffer", (found)bind},
                     {"glFramebufferTexture2D", (found)framebuffer_texture},
                     {"glCheckFramebufferStatus", (found)check_framebuffer},
                     {"glDeleteFramebuffers", (found)delete_framebuffers},
                     {"glFlush", (found)flush}};
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
        if (strcmp(functions[i].name, name) == 0 && (!fake.missing || strcmp(fake.missing, name) != 0))
            return functions[i].is;
    return NULL;
}
