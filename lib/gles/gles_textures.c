/* Textures: a frame's, where it comes from memory, the tables', and the targets of ES 3.0's chain. */
#include "base/pixel.h"
#include "core/image.h"
#include "gles_private.h"
#include "pupil/veil.h"

/* OES_EGL_image_external's, which gl31.h does not have. */
#define TEXTURE_EXTERNAL 0x8D65

/* How a plane of a format is stored in a texture; a texel has `bytes` bytes. */
typedef struct layout {
    GLenum internal, format, type;
    uint32_t bytes;
} layout;

static const layout r8 = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1}, rg8 = {GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2};
static const layout rgb8 = {GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE, 3}, rgba8 = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4};
static const layout r16 = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2};
static const layout rg16 = {GL_RG16UI, GL_RG_INTEGER, GL_UNSIGNED_SHORT, 4};
static const layout rgb16 = {GL_RGB16UI, GL_RGB_INTEGER, GL_UNSIGNED_SHORT, 6};
static const layout rgba16 = {GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, 8};
static const layout rgb10a2 = {GL_RGB10_A2, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV, 4};
static const layout rgb16f = {GL_RGB16F, GL_RGB, GL_HALF_FLOAT, 6}, rgba16f = {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8};
static const layout rgb32f = {GL_RGB32F, GL_RGB, GL_FLOAT, 12}, rgba32f = {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16};

static const layout *chroma_layout(const pupil_pixel_layout *of)
{
    if (of->sample == 2)
        return of->chroma_bytes == 4 ? &rg16 : &r16;
    return of->chroma_bytes == 2 ? &rg8 : &r8;
}

static const layout *layout_of(uint32_t pixel, int plane)
{
    const pupil_pixel_layout of = pupil_pixel_layout_of(pixel);
    if (plane)
        return chroma_layout(&of);
    switch (pixel) {
    case PUPIL_PIXEL_RGBA32F:
        return &rgba32f;
    case PUPIL_PIXEL_RGB32F:
    case PUPIL_PIXEL_BGR32F:
        return &rgb32f;
    case PUPIL_PIXEL_RGBA16F:
        return &rgba16f;
    case PUPIL_PIXEL_RGB16F:
        return &rgb16f;
    case PUPIL_PIXEL_RGBA16:
        return &rgba16;
    case PUPIL_PIXEL_RGB16:
        return &rgb16;
    case PUPIL_PIXEL_RGB10A2:
        return &rgb10a2;
    case PUPIL_PIXEL_RGBA8:
    case PUPIL_PIXEL_BGRX8:
    case PUPIL_PIXEL_RGBX8:
        return &rgba8;
    case PUPIL_PIXEL_RGB8:
    case PUPIL_PIXEL_BGR8:
        return &rgb8;
    case PUPIL_PIXEL_YUYV:
    case PUPIL_PIXEL_UYVY:
        return &rg8;
    default: /* one sample a texel; of packed samples one byte */
        return of.sample == 2 ? &r16 : &r8;
    }
}

/* In texels. */
typedef struct extent {
    GLsizei width, height;
} extent;

static extent extent_of(const gles_object *o, int plane)
{
    const uint32_t width = o->config.width, height = o->config.height, pixel = o->config.pixel;
    if (plane)
        return (extent){(GLsizei)(pupil_chroma_row_bytes(pixel, width) / layout_of(pixel, plane)->bytes),
                        (GLsizei)pupil_chroma_rows(pixel, height)};
    return (extent){(GLsizei)(pupil_row_bytes(pixel, width) / layout_of(pixel, 0)->bytes), (GLsizei)height};
}

static GLuint make_texture(const gles_object *o, GLenum internal, GLsizei width, GLsizei height)
{
    GLuint name = 0;
    o->gl.GenTextures(1, &name);
    o->gl.BindTexture(GL_TEXTURE_2D, name);
    o->gl.TexStorage2D(GL_TEXTURE_2D, 1, internal, width, height);
    return name;
}

static void send(const gles_object *o, GLuint texture, GLsizei width, GLsizei height, GLenum format, GLenum type,
                 const void *data)
{
    o->gl.BindTexture(GL_TEXTURE_2D, texture);
    o->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, format, type, data);
}

/* As they come from memory, without gaps; rows are of `texels` texels, 0: of the picture's width. */
static void unpack_rows(const gles_object *o, GLint texels)
{
    o->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    o->gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    o->gl.PixelStorei(GL_UNPACK_ROW_LENGTH, texels);
    o->gl.PixelStorei(GL_UNPACK_SKIP_ROWS, 0);
    o->gl.PixelStorei(GL_UNPACK_SKIP_PIXELS, 0);
}

/* Swaps two channels of the bound texture when it is read. */
static void exchange(const gles_object *o, GLenum a, GLenum b)
{
    o->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_R + (a - GL_RED), (GLint)b);
    o->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_R + (b - GL_RED), (GLint)a);
}

static void make_frames(gles_object *o)
{
    const uint32_t pixel = o->config.pixel;
    const int planes = (int)pupil_pixel_planes(pixel);
    for (int turn = 0; turn < 2; turn++)
        for (int plane = 0; plane < planes; plane++) {
            const extent e = extent_of(o, plane);
            o->frame[turn][plane] = make_texture(o, layout_of(pixel, plane)->internal, e.width, e.height);
            if (pixel == PUPIL_PIXEL_BGR8 || pixel == PUPIL_PIXEL_BGRX8 || pixel == PUPIL_PIXEL_BGR32F)
                exchange(o, GL_RED, GL_BLUE);
            if (pixel == PUPIL_PIXEL_UYVY || (pixel == PUPIL_PIXEL_NV21 && plane))
                exchange(o, GL_RED, GL_GREEN);
        }
}

int pupil_gles_target_make(gles_object *o, int i, GLenum internal, GLsizei width, GLsizei height, pupil_why *why)
{
    const gl_functions *gl = &o->gl;
    gl->DeleteTextures(1, &o->target[i]);
    gl->DeleteFramebuffers(1, &o->framebuffer[i]);
    gl->ActiveTexture(GL_TEXTURE0);
    o->target[i] = make_texture(o, internal, width, height);
    gl->GenFramebuffers(1, &o->framebuffer[i]);
    gl->BindFramebuffer(GL_FRAMEBUFFER, o->framebuffer[i]);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, o->target[i], 0);
    if (gl->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
        return PUPIL_OK;
    const char *const name = internal == GL_R16F ? "GL_R16F" : "GL_RGBA32UI";
    pupil_gles_say(why, (const char *const[]){"the driver refuses a framebuffer of ", name, 0});
    return PUPIL_ERR_GLES;
}

/* What ES 3.0's chain draws into. */
static int make_targets(gles_object *o, pupil_why *why)
{
    const GLsizei columns = GLES_REGION_COLUMNS, rows = (GLsizei)o->region_rows;
    const extent size[GLES_TARGET_COUNT] = {[GLES_PARTS] = {columns * GLES_PARTS_X, rows * GLES_PARTS_Y},
                                            [GLES_REGIONS] = {columns, rows},
                                            [GLES_COLUMNS] = {columns, 1},
                                            [GLES_STATE_0] = {1, 1},
                                            [GLES_STATE_1] = {1, 1}};
    for (int i = 0; i < (o->variant.level_here ? GLES_BINS : GLES_COLUMNS); i++) {
        const int error = pupil_gles_target_make(o, i, GL_RGBA32UI, size[i].width, size[i].height, why);
        if (error)
            return error;
    }
    for (int i = GLES_STATE_0; i <= GLES_STATE_1 && o->variant.level_here; i++)
        send(o, o->target[i], 1, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, (const GLuint[4]){0});
    return PUPIL_OK;
}

/* Rows of GLES_TABLE_WIDTH; the last one may be shorter. */
static void send_table(const gles_object *o, GLuint texture, GLsizei count, GLenum format, GLenum type, size_t bytes,
                       const void *table)
{
    const GLsizei rows = count / GLES_TABLE_WIDTH, rest = count % GLES_TABLE_WIDTH;
    const uint8_t *end = (const uint8_t *)table + (size_t)rows * GLES_TABLE_WIDTH * bytes;
    send(o, texture, GLES_TABLE_WIDTH, rows, format, type, table);
    if (rest)
        o->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, rows, rest, 1, format, type, end);
}

int pupil_gles_textures_make(gles_object *o, pupil_why *why)
{
    const gl_functions *gl = &o->gl;
    const extent e = extent_of(o, 0);
    if (e.width > o->largest_side || e.height > o->largest_side) {
        pupil_gles_say(why, (const char *const[]){"the frame is larger than the context's textures can be", 0});
        return PUPIL_ERR_SIZE;
    }
    gl->ActiveTexture(GL_TEXTURE0);
    unpack_rows(o, 0);
    gl->GenSamplers(1, &o->sampler);
    gl->SamplerParameteri(o->sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->SamplerParameteri(o->sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->SamplerParameteri(o->sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->SamplerParameteri(o->sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (o->config.source == PUPIL_GLES_MEMORY)
        make_frames(o);
    if (o->coder.light) {
        o->light = make_texture(o, GL_RG32F, GLES_TABLE_WIDTH, GLES_TABLE_HEIGHT);
        send_table(o, o->light, (GLsizei)o->coder.top + 1, GL_RG, GL_FLOAT, sizeof o->coder.light[0], o->coder.light);
    }
    if (o->config.veil)
        o->veil = make_texture(o, GL_RGB32F, PUPIL_VEIL_NODES, PUPIL_VEIL_NODES);
    o->encoder = make_texture(o, GL_R32UI, GLES_TABLE_WIDTH, GLES_TABLE_HEIGHT);
    if (o->variant.version != PUPIL_GLES_ES30)
        return PUPIL_OK;
    return make_targets(o, why);
}

void pupil_gles_textures_veil(const gles_object *o, const float *nodes)
{
    o->gl.ActiveTexture(GL_TEXTURE0);
    unpack_rows(o, 0);
    send(o, o->veil, PUPIL_VEIL_NODES, PUPIL_VEIL_NODES, GL_RGB, GL_FLOAT, nodes);
}

void pupil_gles_textures_delete(gles_object *o)
{
    const gl_functions *gl = &o->gl;
    gl->DeleteSamplers(1, &o->sampler);
    gl->DeleteTextures(2 * GLES_PLANES, o->frame[0]);
    gl->DeleteTextures(1, &o->light);
    gl->DeleteTextures(1, &o->encoder);
    gl->DeleteTextures(1, &o->veil);
    gl->DeleteTextures(GLES_TARGET_COUNT, o->target);
    gl->DeleteFramebuffers(GLES_TARGET_COUNT, o->framebuffer);
}

void pupil_gles_textures_set(const gles_object *o)
{
    const pupil_encoder *e = &pupil_encoders[o->settings.transfer];
    const GLsizei cells = (GLsizei)((0x3f800000u - e->base_bits) >> 16) + 1; /* up to that of 1.0 */
    o->gl.ActiveTexture(GL_TEXTURE0);
    unpack_rows(o, 0);
    send_table(o, o->encoder, cells, GL_RED_INTEGER, GL_UNSIGNED_INT, sizeof e->cell[0], e->cell);
}

/* --- at work --- */

void pupil_gles_bind(const gles_object *o, uint32_t unit, GLenum target, GLuint texture)
{
    o->gl.ActiveTexture(GL_TEXTURE0 + unit);
    o->gl.BindTexture(target, texture);
    o->gl.BindSampler(unit, o->sampler);
}

void pupil_gles_bind_frame(const gles_object *o)
{
    const GLenum target = o->config.source == PUPIL_GLES_EXTERNAL ? TEXTURE_EXTERNAL : GL_TEXTURE_2D;
    pupil_gles_bind(o, GLES_UNIT_FRAME, target, o->source[0]);
    pupil_gles_bind(o, GLES_UNIT_CHROMA, GL_TEXTURE_2D, o->source[1]);
    pupil_gles_bind(o, GLES_UNIT_CR, GL_TEXTURE_2D, o->source[2]);
    pupil_gles_bind(o, GLES_UNIT_LIGHT, GL_TEXTURE_2D, o->light);
    pupil_gles_bind(o, GLES_UNIT_ENCODER, GL_TEXTURE_2D, o->encoder);
    if (o->veil)
        pupil_gles_bind(o, GLES_UNIT_VEIL, GL_TEXTURE_2D, o->veil);
}

void pupil_gles_unbind(const gles_object *o)
{
    for (uint32_t unit = 0; unit < GLES_UNIT_COUNT; unit++)
        o->gl.BindSampler(unit, 0);
}

/* Sends a plane at once if GL can take its stride, or else row by row. */
static void send_plane(const gles_object *o, GLuint texture, const layout *l, extent e, const void *data,
                       ptrdiff_t stride)
{
    const int near = stride > 0 && stride <= 1 << 30; /* GL counts a row's texels in 32 bits, drivers its bytes, too */
    const int at_once = e.height == 1 || (near && stride % (ptrdiff_t)l->bytes == 0);
    unpack_rows(o, at_once && e.height > 1 ? (GLint)(stride / (ptrdiff_t)l->bytes) : 0);
    if (at_once) {
        send(o, texture, e.width, e.height, l->format, l->type, data);
        return;
    }
    o->gl.BindTexture(GL_TEXTURE_2D, texture);
    for (GLint y = 0; y < e.height; y++)
        o->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, y, e.width, 1, l->format, l->type, (const uint8_t *)data + y * stride);
}

/* The caller's image as one of this version, if it is a frame of the config. */
static int read_image(const gles_object *o, pupil_image_const *image, const pupil_image_const *theirs)
{
    int error = pupil_image_read(image, theirs);
    image->coding = 0; /* the coding is the config's */
    if (!error)
        error = pupil_image_check(image, 0);
    if (error)
        return error;
    if (o->config.source != PUPIL_GLES_MEMORY)
        return PUPIL_ERR_ORDER;
    if (image->pixel != o->config.pixel)
        return PUPIL_ERR_PIXEL;
    return image->width == o->config.width && image->height == o->config.height ? PUPIL_OK : PUPIL_ERR_SIZE;
}

int pupil_gles_upload(pupil_gles *gles, const pupil_image_const *image)
{
    gles_object *o = gles_object_of(gles);
    pupil_image_const own;
    int error = pupil_gles_check(gles);
    if (!error)
        error = read_image(o, &own, image);
    if (error)
        return error;
    image = &own;
    const GLuint *texture = o->frame[o->turn ^= 1];
    const void *const data[GLES_PLANES] = {image->data, image->chroma, image->cr};
    const ptrdiff_t stride[GLES_PLANES] = {image->stride_bytes, image->chroma_stride_bytes, image->cr_stride_bytes};
    const int planes = (int)pupil_pixel_planes(image->pixel);
    o->gl.ActiveTexture(GL_TEXTURE0);
    for (int i = 0; i < planes; i++)
        send_plane(o, texture[i], layout_of(image->pixel, i), extent_of(o, i), data[i], stride[i]);
    for (int i = 0; i < GLES_PLANES; i++)
        o->source[i] = texture[i];
    return pupil_gles_error(o);
}

int pupil_gles_use(pupil_gles *gles, uint32_t texture, uint32_t chroma_texture, uint32_t cr_texture)
{
    const int error = pupil_gles_check(gles);
    if (error)
        return error;
    gles_object *o = gles_object_of(gles);
    const uint32_t planes = pupil_pixel_planes(o->config.pixel);
    if (o->config.source == PUPIL_GLES_MEMORY)
        return PUPIL_ERR_ORDER;
    if (!texture || (planes > 1) != (chroma_texture != 0) || (planes > 2) != (cr_texture != 0))
        return PUPIL_ERR_VALUE;
    o->source[0] = texture;
    o->source[1] = chroma_texture;
    o->source[2] = cr_texture;
    return PUPIL_OK;
}
