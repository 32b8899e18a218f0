/* drivers/egl/dmabuf.h: a capture buffer of the kernel's as textures, with no copy, and fences both ways.
 *
 *     once for each buffer:  pupil_dmabuf_import -> textures for pupil_gles_use
 *     for each frame:        wait for the producer's fence, if it has one (pupil_fence_wait_fd) -> pupil_gles_use,
 *                            process -> pupil_fence_make -> when pupil_fence_done, the buffer goes back to its producer
 *
 * A plane is imported by itself, as R8, GR88, R16, ... and converted by pupil's own shader: the import of several
 * planes as one fails on some drivers, and leaves the matrix and range to them. Channels are in the order that
 * pupil_gles_use wants.
 *
 * GL state: the 2D binding of the active texture unit and the framebuffer binding are left 0.
 *
 * Threads: the one in which the context is current. All calls use eglGetCurrentDisplay, which exists as long as the
 * context does: release and close come before its end.
 */
#ifndef PUPIL_DRIVERS_EGL_DMABUF_H
#define PUPIL_DRIVERS_EGL_DMABUF_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/gles.h"

/* A frame in memory that the kernel shares. All planes may be in one file descriptor. */
typedef struct pupil_dmabuf {
    uint32_t pixel; /* a pupil_pixel: RGBA8 (as AB24), RGBX8 (XB24), BGRX8 (XR24), RGB10A2 (AB30), RGBA16F (AB4H), every
                     * Y'CbCr, grey and mosaic. The driver decides which of these it takes. BGRX8 and RGBX8 may be read
                     * as RGBA8, too */
    uint32_t width, height; /* pixels */
    int fd[3];              /* stay the caller's; [1]: chroma, [2]: cr (pupil_image) */
    uint32_t offset_bytes[3], stride_bytes[3];
    int has_modifier; /* modifier is known; else the driver's usual layout */
    uint64_t modifier;
} pupil_dmabuf;

typedef struct pupil_dmabuf_textures {
    uint32_t texture[3];  /* GL names, for pupil_gles_use; 0: no such plane */
    void *image[3];       /* EGLImages */
    uint32_t framebuffer; /* of pupil_dmabuf_framebuffer; else 0 */
} pupil_dmabuf_textures;

/* 0, or -1 and a sentence (the extension that is missing, the format and what the driver said). 16-bit samples are
 * imported as R16 and GR32: pupil_gles_config.normalized_16 is 1 with them. */
int pupil_dmabuf_import(const pupil_dmabuf *buffer, pupil_dmabuf_textures *textures, pupil_why *why);
/* Deletes what import or framebuffer made; twice is allowed. */
void pupil_dmabuf_release(pupil_dmabuf_textures *textures);

/* The same for an output: a framebuffer that renders into the buffer (RGBA8, RGBX8 or BGRX8), for pupil_gles_target.
 * pupil_dmabuf_release deletes it, too. */
int pupil_dmabuf_framebuffer(const pupil_dmabuf *buffer, pupil_dmabuf_textures *textures, uint32_t *framebuffer,
                             pupil_why *why);

/* A fence behind everything that was handed to GL so far. NULL: the driver has none (EGL_KHR_fence_sync), or no memory.
 */
typedef struct pupil_fence pupil_fence;
pupil_fence *pupil_fence_make(void);
/* 1: all of it is done; 0: not yet; -1: it cannot be known (the context is lost, or not current). Never waits. */
int pupil_fence_done(pupil_fence *fence);
/* A sync file of the kernel's, to be polled or handed on, and closed by the caller; -1: the driver has none
 * (EGL_ANDROID_native_fence_sync). */
int pupil_fence_fd(pupil_fence *fence);
void pupil_fence_close(pupil_fence *fence);

/* Makes the GPU wait (not the caller) for a sync file before anything that is handed to GL from now on. Takes over the
 * file descriptor. -1: the driver cannot; poll the file (POLLIN) instead, it stays the caller's. */
int pupil_fence_wait_fd(int fd);

#endif
