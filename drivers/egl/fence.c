/* Fences, of egl/dmabuf.h. A pupil_fence is the EGL sync itself, so that a frame allocates nothing here. Functions that
 * EGL 1.4 does not have are looked up; what eglGetProcAddress answers holds for every display. */
#include <GLES3/gl3.h>
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include "egl/dmabuf.h"
#include "egl_private.h"

static struct {
    PFNEGLCREATESYNCKHRPROC create;
    PFNEGLDESTROYSYNCKHRPROC destroy;
    PFNEGLCLIENTWAITSYNCKHRPROC client_wait;
    PFNEGLWAITSYNCKHRPROC wait;
    PFNEGLDUPNATIVEFENCEFDANDROIDPROC dup_fd;
    void(GL_APIENTRYP flush)(void);
} egl;

static pthread_once_t looked_up = PTHREAD_ONCE_INIT;

static void look_up(void)
{
    egl.create = (PFNEGLCREATESYNCKHRPROC)eglGetProcAddress("eglCreateSyncKHR");
    egl.destroy = (PFNEGLDESTROYSYNCKHRPROC)eglGetProcAddress("eglDestroySyncKHR");
    egl.client_wait = (PFNEGLCLIENTWAITSYNCKHRPROC)eglGetProcAddress("eglClientWaitSyncKHR");
    egl.wait = (PFNEGLWAITSYNCKHRPROC)eglGetProcAddress("eglWaitSyncKHR");
    egl.dup_fd = (PFNEGLDUPNATIVEFENCEFDANDROIDPROC)eglGetProcAddress("eglDupNativeFenceFDANDROID");
    egl.flush = (void(GL_APIENTRYP)(void))eglGetProcAddress("glFlush");
}

static EGLDisplay current(void)
{
    pthread_once(&looked_up, look_up);
    return eglGetCurrentDisplay();
}

pupil_fence *pupil_fence_make(void)
{
    EGLDisplay display = current();
    EGLSyncKHR sync = EGL_NO_SYNC_KHR;
    if (display == EGL_NO_DISPLAY || !pupil_egl_has(display, "EGL_KHR_fence_sync"))
        return NULL;
    /* A native fence also serves pupil_fence_fd. */
    if (pupil_egl_has(display, "EGL_ANDROID_native_fence_sync"))
        sync = egl.create(display, EGL_SYNC_NATIVE_FENCE_ANDROID, NULL);
    if (sync == EGL_NO_SYNC_KHR)
        sync = egl.create(display, EGL_SYNC_FENCE_KHR, NULL);
    if (sync == EGL_NO_SYNC_KHR)
        return NULL;
    /* Commands that are not flushed may never begin; and only a flush gives a native fence its file. */
    egl.flush();
    return (pupil_fence *)sync;
}

int pupil_fence_done(pupil_fence *fence)
{
    if (!fence)
        return -1;
    switch (egl.client_wait(current(), (EGLSyncKHR)fence, 0, 0)) {
    case EGL_CONDITION_SATISFIED_KHR:
        return 1;
    case EGL_TIMEOUT_EXPIRED_KHR:
        return 0;
    default:
        return -1;
    }
}

int pupil_fence_fd(pupil_fence *fence)
{
    EGLDisplay display = current();
    if (display == EGL_NO_DISPLAY || !pupil_egl_has(display, "EGL_ANDROID_native_fence_sync"))
        return -1;
    return egl.dup_fd(display, (EGLSyncKHR)fence);
}

void pupil_fence_close(pupil_fence *fence)
{
    if (fence)
        egl.destroy(current(), (EGLSyncKHR)fence);
}

int pupil_fence_wait_fd(int fd)
{
    EGLDisplay display = current();
    if (fd < 0 || display == EGL_NO_DISPLAY || !pupil_egl_has(display, "EGL_ANDROID_native_fence_sync") ||
        !pupil_egl_has(display, "EGL_KHR_wait_sync"))
        return -1;
    /* EGL closes the file that it is given, even if it refuses to wait; the caller's is closed only on success. */
    int own = fcntl(fd, F_DUPFD_CLOEXEC, 0);
    if (own < 0)
        return -1;
    EGLint attributes[] = {EGL_SYNC_NATIVE_FENCE_FD_ANDROID, own, EGL_NONE};
    EGLSyncKHR sync = egl.create(display, EGL_SYNC_NATIVE_FENCE_ANDROID, attributes);
    if (sync == EGL_NO_SYNC_KHR) {
        close(own);
        return -1;
    }
    int waits = egl.wait(display, sync, 0) == EGL_TRUE;
    egl.destroy(display, sync); /* a wait that began continues */
    if (!waits)
        return -1;
    close(fd);
    return 0;
}
