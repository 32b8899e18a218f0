/* Import of dma-bufs, a plane at a time (EGL_EXT_image_dma_buf_import), as textures (GL_OES_EGL_image). */
#include "egl/dmabuf.h"

#include <GLES3/gl3.h>
/* After gl3.h, whose types it needs. */
#include <GLES2/gl2ext.h>
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include "egl_private.h"
#include "refuse.h"

/* Names of formats and the linear modifier, as in the kernel's drm_fourcc.h. */
#define FOURCC(a, b, c, d) ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)
#define FORMAT_R8          FOURCC('R', '8', ' ', ' ')
#define FORMAT_R16         FOURCC('R', '1', '6', ' ')
#define FORMAT_GR88        FOURCC('G', 'R', '8', '8')
#define FORMAT_GR1616      FOURCC('G', 'R', '3', '2')
#define FORMAT_ABGR8888    FOURCC('A', 'B', '2', '4')
#define FORMAT_XBGR8888    FOURCC('X', 'B', '2', '4')
#define FORMAT_XRGB8888    FOURCC('X', 'R', '2', '4')
#define FORMAT_ABGR2101010 FOURCC('A', 'B', '3', '0')
#define FORMAT_ABGR16F     FOURCC('A', 'B', '4', 'H')
#define MODIFIER_LINEAR    0

#define PLANES 3

typedef struct plane {
    uint32_t format, width, height, texel_bytes; /* width and height in texels */
    int exchanged;                               /* the first two channels are read in the other order */
    int fd;
    uint32_t offset_bytes, stride_bytes;
} plane;

static struct {
    PFNEGLCREATEIMAGEKHRPROC create_image;
    PFNEGLDESTROYIMAGEKHRPROC destroy_image;
    PFNGLEGLIMAGETARGETTEXTURE2DOESPROC image_texture;
    PFNGLGETSTRINGPROC get_string;
    PFNGLGETERRORPROC get_error;
    PFNGLGENTEXTURESPROC gen_textures;
    PFNGLBINDTEXTUREPROC bind_texture;
    PFNGLTEXPARAMETERIPROC tex_parameter;
    PFNGLDELETETEXTURESPROC delete_textures;
    PFNGLGENFRAMEBUFFERSPROC gen_framebuffers;
    PFNGLBINDFRAMEBUFFERPROC bind_framebuffer;
    PFNGLFRAMEBUFFERTEXTURE2DPROC framebuffer_texture;
    PFNGLCHECKFRAMEBUFFERSTATUSPROC check_framebuffer;
    PFNGLDELETEFRAMEBUFFERSPROC delete_framebuffers;
} gl;

static pthread_once_t looked_up = PTHREAD_ONCE_INIT;

static void look_up(void)
{
    gl.create_image = (PFNEGLCREATEIMAGEKHRPROC)eglGetProcAddress("eglCreateImageKHR");
    gl.destroy_image = (PFNEGLDESTROYIMAGEKHRPROC)eglGetProcAddress("eglDestroyImageKHR");
    gl.image_texture = (PFNGLEGLIMAGETARGETTEXTURE2DOESPROC)eglGetProcAddress("glEGLImageTargetTexture2DOES");
    gl.get_string = (PFNGLGETSTRINGPROC)eglGetProcAddress("glGetString");
    gl.get_error = (PFNGLGETERRORPROC)eglGetProcAddress("glGetError");
    gl.gen_textures = (PFNGLGENTEXTURESPROC)eglGetProcAddress("glGenTextures");
    gl.bind_texture = (PFNGLBINDTEXTUREPROC)eglGetProcAddress("glBindTexture");
    gl.tex_parameter = (PFNGLTEXPARAMETERIPROC)eglGetProcAddress("glTexParameteri");
    gl.delete_textures = (PFNGLDELETETEXTURESPROC)eglGetProcAddress("glDeleteTextures");
    gl.gen_framebuffers = (PFNGLGENFRAMEBUFFERSPROC)eglGetProcAddress("glGenFramebuffers");
    gl.bind_framebuffer = (PFNGLBINDFRAMEBUFFERPROC)eglGetProcAddress("glBindFramebuffer");
    gl.framebuffer_texture = (PFNGLFRAMEBUFFERTEXTURE2DPROC)eglGetProcAddress("glFramebufferTexture2D");
    gl.check_framebuffer = (PFNGLCHECKFRAMEBUFFERSTATUSPROC)eglGetProcAddress("glCheckFramebufferStatus");
    gl.delete_framebuffers = (PFNGLDELETEFRAMEBUFFERSPROC)eglGetProcAddress("glDeleteFramebuffers");
}

/* RGB, which is one plane; 0: not imported. */
static uint32_t rgb_format(uint32_t pixel)
{
    switch (pixel) {
    case PUPIL_PIXEL_RGBA8:
        return FORMAT_ABGR8888;
    case PUPIL_PIXEL_RGBX8:
        return FORMAT_XBGR8888;
    case PUPIL_PIXEL_BGRX8:
        return FORMAT_XRGB8888;
    case PUPIL_PIXEL_RGB10A2:
        return FORMAT_ABGR2101010;
    case PUPIL_PIXEL_RGBA16F:
        return FORMAT_ABGR16F;
    default:
        return 0;
    }
}

/* The planes of a buffer, as pupil_gles_use wants them; how many, or 0. */
static int planes_of(const pupil_dmabuf *b, plane planes[PLANES])
{
    static const uint32_t formats[2][2] = {{FORMAT_R8, FORMAT_R16}, {FORMAT_GR88, FORMAT_GR1616}};
    const int count = (int)pupil_pixel_planes(b->pixel);
    const int packed_yuv = b->pixel == PUPIL_PIXEL_YUYV || b->pixel == PUPIL_PIXEL_UYVY;
    const uint32_t rgb = rgb_format(b->pixel);
    if (!rgb && !packed_yuv && count < 2 && !pupil_pixel_bits(b->pixel))
        return 0;
    for (int i = 0; i < count; i++) {
        const size_t row = i ? pupil_chroma_row_bytes(b->pixel, b->width) : pupil_row_bytes(b->pixel, b->width);
        const uint32_t channels = packed_yuv || (i && count == 2) ? 2 : 1;
        uint32_t bytes = (uint32_t)pupil_pixel_bytes(b->pixel) * (i ? channels : 1);
        bytes = bytes ? bytes : 1; /* packed samples: a texel for each byte */
        planes[i] = (plane){.format = rgb ? rgb : formats[channels - 1][bytes / channels - 1],
                            .width = (uint32_t)(row / bytes),
                            .height = i ? pupil_chroma_rows(b->pixel, b->height) : b->height,
                            .texel_bytes = bytes,
                            .exchanged = b->pixel == PUPIL_PIXEL_UYVY || (b->pixel == PUPIL_PIXEL_NV21 && i),
                            .fd = b->fd[i],
                            .offset_bytes = b->offset_bytes[i],
                            .stride_bytes = b->stride_bytes[i]};
    }
    return count;
}

/* A plane that does not fit its buffer would be read beyond its end. Only the driver knows the rows of a modifier other
 * than linear. */
static int check_plane(const pupil_dmabuf *b, const plane *p, int index, pupil_why *why)
{
    uint64_t row = (uint64_t)p->width * p->texel_bytes;
    if (p->fd < 0)
        return pupil_refuse(why, "dma-buf: plane %d has no file descriptor", index);
    if (p->offset_bytes > INT32_MAX || p->stride_bytes > INT32_MAX)
        return pupil_refuse(why,
                            "dma-buf: plane %d: an offset of %u and a stride of %u bytes; EGL "
                            "knows neither from 2^31",
                            index, p->offset_bytes, p->stride_bytes);
    if (b->has_modifier && b->modifier != MODIFIER_LINEAR)
        return 0;
    if (p->stride_bytes < row)
        return pupil_refuse(why, "dma-buf: plane %d has rows of %llu bytes, more than its stride of %u", index,
                            (unsigned long long)row, p->stride_bytes);
    uint64_t end = p->offset_bytes + (uint64_t)p->stride_bytes * (p->height - 1) + row;
    off_t size = lseek(p->fd, 0, SEEK_END);
    if (size >= 0 && end > (uint64_t)size)
        return pupil_refuse(why, "dma-buf: plane %d ends at byte %llu of a buffer of %llu", index,
                            (unsigned long long)end, (unsigned long long)size);
    return 0;
}

/* Whether the context can import the buffer, by its extensions; finds its display. */
static int check_context(const pupil_dmabuf *b, EGLDisplay *display, pupil_why *why)
{
    static const char *const needed[] = {"EGL_KHR_image_base", "EGL_EXT_image_dma_buf_import"};
    pthread_once(&looked_up, look_up);
    *display = eglGetCurrentDisplay();
    if (*display == EGL_NO_DISPLAY)
        return pupil_refuse(why, "dma-buf: no EGL context is current in this thread");
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++)
        if (!pupil_egl_has(*display, needed[i]))
            return pupil_refuse(why, "dma-buf: the driver imports none: EGL lacks %s", needed[i]);
    if (!pupil_egl_listed((const char *)gl.get_string(GL_EXTENSIONS), "GL_OES_EGL_image"))
        return pupil_refuse(why, "dma-buf: the driver makes no textures of one: OpenGL ES lacks %s",
                            "GL_OES_EGL_image");
    if (b->has_modifier && b->modifier != MODIFIER_LINEAR &&
        !pupil_egl_has(*display, "EGL_EXT_image_dma_buf_import_modifiers"))
        return pupil_refuse(why, "dma-buf: its modifier is 0x%llx, and EGL lacks %s", (unsigned long long)b->modifier,
                            "EGL_EXT_image_dma_buf_import_modifiers");
    return 0;
}

/* Drops errors from before; a lost context reports one for ever. */
static void drop_errors(void)
{
    for (int i = 0; i < 8 && gl.get_error() != GL_NO_ERROR; i++)
        ;
}

static void pair(EGLint *attributes, int *count, EGLint name, EGLint value)
{
    attributes[(*count)++] = name;
    attributes[(*count)++] = value;
}

static int import_plane(EGLDisplay display, const pupil_dmabuf *b, const plane *p, void **image, uint32_t *texture,
                        pupil_why *why)
{
    const char fourcc[] = {(char)p->format, (char)(p->format >> 8), (char)(p->format >> 16), (char)(p->format >> 24),
                           0};
    EGLint attributes[32];
    int n = 0;
    pair(attributes, &n, EGL_WIDTH, (EGLint)p->width);
    pair(attributes, &n, EGL_HEIGHT, (EGLint)p->height);
    pair(attributes, &n, EGL_LINUX_DRM_FOURCC_EXT, (EGLint)p->format);
    pair(attributes, &n, EGL_DMA_BUF_PLANE0_FD_EXT, p->fd);
    pair(attributes, &n, EGL_DMA_BUF_PLANE0_OFFSET_EXT, (EGLint)p->offset_bytes);
    pair(attributes, &n, EGL_DMA_BUF_PLANE0_PITCH_EXT, (EGLint)p->stride_bytes);
    /* A driver without modifiers assumes that a buffer is linear, or asks the kernel. */
    if (b->has_modifier && pupil_egl_has(display, "EGL_EXT_image_dma_buf_import_modifiers")) {
        pair(attributes, &n, EGL_DMA_BUF_PLANE0_MODIFIER_LO_EXT, (EGLint)(b->modifier & 0xffffffff));
        pair(attributes, &n, EGL_DMA_BUF_PLANE0_MODIFIER_HI_EXT, (EGLint)(b->modifier >> 32));
    }
    attributes[n] = EGL_NONE;
    *image = gl.create_image(display, EGL_NO_CONTEXT, EGL_LINUX_DMA_BUF_EXT, NULL, attributes);
    if (*image == EGL_NO_IMAGE_KHR)
        return pupil_refuse(why,
                            "dma-buf: the driver does not import %u x %u texels of %s with a stride of %u bytes: %s",
                            p->width, p->height, fourcc, p->stride_bytes, pupil_egl_error());
    drop_errors();
    gl.gen_textures(1, texture);
    gl.bind_texture(GL_TEXTURE_2D, *texture);
    gl.image_texture(GL_TEXTURE_2D, *image);
    gl.tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (p->exchanged) {
        gl.tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_R, GL_GREEN);
        gl.tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_G, GL_RED);
    }
    gl.bind_texture(GL_TEXTURE_2D, 0);
    GLenum error = gl.get_error();
    if (error != GL_NO_ERROR)
        return pupil_refuse(why, "dma-buf: the driver makes no 2D texture of %s (OpenGL's error 0x%x)", fourcc, error);
    return 0;
}

int pupil_dmabuf_import(const pupil_dmabuf *buffer, pupil_dmabuf_textures *textures, pupil_why *why)
{
    plane planes[PLANES];
    EGLDisplay display;
    memset(textures, 0, sizeof *textures);
    if (buffer->width < 1 || buffer->width > PUPIL_MAX_SIDE_PX || buffer->height < 1 ||
        buffer->height > PUPIL_MAX_SIDE_PX)
        return pupil_refuse(why, "dma-buf: frames of %u x %u pixels; each side is 1 to %u", buffer->width,
                            buffer->height, PUPIL_MAX_SIDE_PX);
    int count = planes_of(buffer, planes);
    if (count == 0)
        return pupil_refuse(why, "dma-buf: pixel format %u is none that can be imported", buffer->pixel);
    for (int i = 0; i < count; i++)
        if (check_plane(buffer, &planes[i], i, why) != 0)
            return -1;
    if (check_context(buffer, &display, why) != 0)
        return -1;
    for (int i = 0; i < count; i++)
        if (import_plane(display, buffer, &planes[i], &textures->image[i], &textures->texture[i], why) != 0) {
            pupil_dmabuf_release(textures);
            return -1;
        }
    return 0;
}

void pupil_dmabuf_release(pupil_dmabuf_textures *textures)
{
    EGLDisplay display = eglGetCurrentDisplay();
    if (textures->framebuffer)
        gl.delete_framebuffers(1, &textures->framebuffer);
    for (int i = 0; i < PLANES; i++) {
        if (textures->texture[i])
            gl.delete_textures(1, &textures->texture[i]);
        if (textures->image[i])
            gl.destroy_image(display, textures->image[i]);
    }
    memset(textures, 0, sizeof *textures);
}

int pupil_dmabuf_framebuffer(const pupil_dmabuf *buffer, pupil_dmabuf_textures *textures, uint32_t *framebuffer,
                             pupil_why *why)
{
    memset(textures, 0, sizeof *textures);
    *framebuffer = 0;
    if (buffer->pixel != PUPIL_PIXEL_RGBA8 && buffer->pixel != PUPIL_PIXEL_RGBX8 && buffer->pixel != PUPIL_PIXEL_BGRX8)
        return pupil_refuse(why,
                            "dma-buf: pixel format %u cannot be drawn to; RGBA8, RGBX8 and BGRX8 can, and the CPU "
                            "writes more (pupil/image.h)",
                            buffer->pixel);
    if (pupil_dmabuf_import(buffer, textures, why) != 0)
        return -1;
    gl.gen_framebuffers(1, &textures->framebuffer);
    gl.bind_framebuffer(GL_FRAMEBUFFER, textures->framebuffer);
    gl.framebuffer_texture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures->texture[0], 0);
    GLenum status = gl.check_framebuffer(GL_FRAMEBUFFER);
    gl.bind_framebuffer(GL_FRAMEBUFFER, 0);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
        pupil_dmabuf_release(textures);
        return pupil_refuse(why, "dma-buf: the driver does not draw to this buffer (status 0x%x)", status);
    }
    *framebuffer = textures->framebuffer;
    return 0;
}
