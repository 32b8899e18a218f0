/* In place of egl_context.c, dmabuf.c and fence.c in a build without EGL. */
#include <stdio.h>
#include <string.h>

#include "egl/dmabuf.h"
#include "egl/egl_context.h"
#include "refuse.h"

static int refuse(const char *what, pupil_why *why)
{
    return pupil_refuse(why, "this build of pupil has no %s (it was configured with PUPIL_GPU=OFF)", what);
}

int pupil_egl_open(pupil_egl **egl, const pupil_egl_options *options, pupil_why *why)
{
    (void)options;
    *egl = NULL;
    return refuse("OpenGL ES without a window", why);
}

void pupil_egl_close(pupil_egl *egl)
{
    (void)egl;
}

int pupil_egl_make_current(pupil_egl *egl)
{
    (void)egl;
    return -1;
}

int pupil_egl_release_current(pupil_egl *egl)
{
    (void)egl;
    return -1;
}

pupil_gles_function pupil_egl_get_proc(const char *name)
{
    (void)name;
    return NULL;
}

void *pupil_egl_display(const pupil_egl *egl)
{
    (void)egl;
    return NULL;
}

void pupil_egl_describe(char *text, size_t text_bytes)
{
    pupil_why why;
    refuse("EGL", &why);
    snprintf(text, text_bytes, "%s", why.text);
}

int pupil_dmabuf_import(const pupil_dmabuf *buffer, pupil_dmabuf_textures *textures, pupil_why *why)
{
    (void)buffer;
    memset(textures, 0, sizeof *textures);
    return refuse("dma-bufs as textures", why);
}

void pupil_dmabuf_release(pupil_dmabuf_textures *textures)
{
    (void)textures;
}

int pupil_dmabuf_framebuffer(const pupil_dmabuf *buffer, pupil_dmabuf_textures *textures, uint32_t *framebuffer,
                             pupil_why *why)
{
    (void)buffer;
    memset(textures, 0, sizeof *textures);
    *framebuffer = 0;
    return refuse("dma-bufs to draw to", why);
}

pupil_fence *pupil_fence_make(void)
{
    return NULL;
}

int pupil_fence_done(pupil_fence *fence)
{
    (void)fence;
    return -1;
}

int pupil_fence_fd(pupil_fence *fence)
{
    (void)fence;
    return -1;
}

void pupil_fence_close(pupil_fence *fence)
{
    (void)fence;
}

int pupil_fence_wait_fd(int fd)
{
    (void)fd;
    return -1;
}
