/* apps/frame/gles_shared.h: frames of a camera as textures, without a copy: each of its few buffers is imported once.
 *
 * The GPU's driver decides whether it takes a buffer (format, stride, memory). Once it refuses one, frames are
 * uploaded, and `refusal` says why.
 *
 * Threads: the one in which the context is current.
 */
#ifndef PUPIL_APPS_FRAME_GLES_SHARED_H
#define PUPIL_APPS_FRAME_GLES_SHARED_H

#include "egl/dmabuf.h"
#include "source.h"

enum { GLES_SHARED_MOST = 32 }; /* buffers: V4L2's VIDEO_MAX_FRAME */

typedef struct gles_shared {
    uint64_t stream; /* of all buffers here */
    uint32_t pixel, width, height, count;
    struct {
        pupil_frame_dmabuf is;
        pupil_dmabuf_textures textures;
    } buffer[GLES_SHARED_MOST];
    pupil_why refusal; /* "": none so far */
} gles_shared;

/* The textures of this frame's buffer, valid until a frame of another stream comes. NULL: the frame is to be
 * uploaded. */
const pupil_dmabuf_textures *gles_shared_textures(gles_shared *shared, const pupil_frame *frame);
/* A zeroed struct is allowed, and a second call. */
void gles_shared_release(gles_shared *shared);

#endif
