#include "gles_shared.h"

#include <string.h>

void gles_shared_release(gles_shared *s)
{
    for (uint32_t i = 0; i < s->count; i++)
        pupil_dmabuf_release(&s->buffer[i].textures);
    s->count = 0;
}

static int is_same(const pupil_frame_dmabuf *a, const pupil_frame_dmabuf *b)
{
    return memcmp(a->fd, b->fd, sizeof a->fd) == 0 &&
           memcmp(a->offset_bytes, b->offset_bytes, sizeof a->offset_bytes) == 0;
}

/* EGL's strides are unsigned and of 32 bits. */
static uint32_t stride_of(ptrdiff_t stride_bytes)
{
    return stride_bytes > 0 && stride_bytes <= INT32_MAX ? (uint32_t)stride_bytes : 0;
}

static int import(gles_shared *s, const pupil_frame *frame)
{
    const pupil_image_const *in = &frame->image;
    pupil_dmabuf buffer = {.pixel = in->pixel, .width = in->width, .height = in->height};
    memcpy(buffer.fd, frame->dmabuf->fd, sizeof buffer.fd);
    memcpy(buffer.offset_bytes, frame->dmabuf->offset_bytes, sizeof buffer.offset_bytes);
    buffer.stride_bytes[0] = stride_of(in->stride_bytes);
    buffer.stride_bytes[1] = stride_of(in->chroma_stride_bytes);
    buffer.stride_bytes[2] = stride_of(in->cr_stride_bytes);
    if (s->count == GLES_SHARED_MOST) /* the source has more buffers than it said */
        gles_shared_release(s);
    if (pupil_dmabuf_import(&buffer, &s->buffer[s->count].textures, &s->refusal))
        return -1;
    s->buffer[s->count++].is = *frame->dmabuf;
    return 0;
}

const pupil_dmabuf_textures *gles_shared_textures(gles_shared *s, const pupil_frame *frame)
{
    const pupil_image_const *in = &frame->image;
    if (!frame->dmabuf || *s->refusal.text)
        return NULL;
    if (s->stream != frame->dmabuf->stream || s->pixel != in->pixel || s->width != in->width || s->height != in->height)
        gles_shared_release(s); /* its file descriptors may be other buffers' by now */
    s->stream = frame->dmabuf->stream;
    s->pixel = in->pixel;
    s->width = in->width;
    s->height = in->height;
    for (uint32_t i = 0; i < s->count; i++)
        if (is_same(&s->buffer[i].is, frame->dmabuf))
            return &s->buffer[i].textures;
    if (import(s, frame) == 0)
        return &s->buffer[s->count - 1].textures;
    gles_shared_release(s);
    return NULL;
}
