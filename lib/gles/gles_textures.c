/* Textures: a frame's, where it comes from memory, the tables', and the targets of ES 3.0's chain. */
#include "core/image.h"
#include "gles_private.h"

/* OES_EGL_image_external's, which gl31.h does not have. */
#define TEXTURE_EXTERNAL 0x8D65

/* How a plane of a format is stored in a texture: of each pixel `texels` / `per` texels of `bytes` bytes. */
typedef struct layout {
    GLenum internal, format, type;
    uint32_t bytes, texels, per;
} layout;

static const layout luma_layout[PUPIL_PIXEL_COUNT] = {
    [PUPIL_PIXEL_RGBA32F] = {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16, 1, 1},
    [PUPIL_PIXEL_RGB32F] = {GL_RGB32F, GL_RGB, GL_FLOAT, 12, 1, 1},
    [PUPIL_PIXEL_RGBA16F] = {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8, 1, 1},
    [PUPIL_PIXEL_RGBA16] = {GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, 8, 1, 1},
    [PUPIL_PIXEL_RGB16] = {GL_RGB16UI, GL_RGB_INTEGER, GL_UNSIGNED_SHORT, 6, 1, 1},
    [PUPIL_PIXEL_RGBA8] = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4, 1, 1},
    [PUPIL_PIXEL_RGB8] = {GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE, 3, 1, 1},
    [PUPIL_PIXEL_YUYV] = {GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2, 1, 1},
    [PUPIL_PIXEL_NV12] = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1, 1},
    [PUPIL_PIXEL_GREY8] = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1, 1},
    [PUPIL_PIXEL_GREY10] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 1},
    [PUPIL_PIXEL_GREY12] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 1},
    [PUPIL_PIXEL_GREY16] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 1},
    [PUPIL_PIXEL_BAYER8] = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1, 1},
    [PUPIL_PIXEL_BAYER10] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 1},
    [PUPIL_PIXEL_BAYER12] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 1},
    [PUPIL_PIXEL_BAYER14] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 1},
    [PUPIL_PIXEL_BAYER16] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 1},
    [PUPIL_PIXEL_BAYER10P] = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 5, 4},
    [PUPIL_PIXEL_BAYER12P] = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 3, 2},
};
static const layout chroma_layout = {GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2, 1, 2};

/* In texels. */
typedef struct extent {
    GLsizei width, height;
} extent;

static extent extent_of(const gles_object *o, int plane)
{
    const uint32_t width = o->config.width, height = o->config.height, pixel = o->config.pixel;
    if (plane)
        return (extent){(GLsizei)((width + 1) / 2), (GLsizei)((height + 1) / 2)};
    const layout *l = &luma_layout[pixel];
    const uint32_t whole = pixel == PUPIL_PIXEL_YUYV ? width + width % 2 : width;
    return (extent){(GLsizei)(whole * l->texels / l->per), (GLsizei)height};
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

static void make_frames(gles_object *o)
{
    const int planes = o->config.pixel == PUPIL_PIXEL_NV12 ? 2 : 1;
    for (int turn = 0; turn < 2; turn++)
        for (int plane = 0; plane < planes; plane++) {
            const extent e = extent_of(o, plane);
            o->frame[turn][plane] = make_texture(
                o, plane ? chroma_layout.internal : luma_layout[o->config.pixel].internal, e.width, e.height);
        }
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
    for (int i = 0; i < (o->variant.level_here ? GLES_TARGET_COUNT : GLES_COLUMNS); i++) {
        o->target[i] = make_texture(o, GL_RGBA32UI, size[i].width, size[i].height);
        o->gl.GenFramebuffers(1, &o->framebuffer[i]);
        o->gl.BindFramebuffer(GL_FRAMEBUFFER, o->framebuffer[i]);
        o->gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, o->target[i], 0);
        if (o->gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
            pupil_gles_say(why, (const char *const[]){"the driver refuses a framebuffer of GL_RGBA32UI", 0});
            return PUPIL_ERR_GLES;
        }
    }
    for (int i = GLES_STATE_0; i <= GLES_STATE_1 && o->variant.level_here; i++)
        send(o, o->target[i], 1, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, (const GLuint[4]){0});
    return PUPIL_OK;
}

/* The table that codes are looked up in; 8-bit RGB is sRGB with any coding (pupil/image.h). */
static const float (*light_of(const gles_object *o))[2]
{
    const int is_rgb8 = o->config.pixel == PUPIL_PIXEL_RGBA8 || o->config.pixel == PUPIL_PIXEL_RGB8;
    const int by_coding = !is_rgb8 || o->config.source == PUPIL_GLES_EXTERNAL;
    return by_coding && o->coder.light ? o->coder.light : pupil_srgb_light;
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
    o->light = make_texture(o, GL_RG32F, 256, 1);
    send(o, o->light, 256, 1, GL_RG, GL_FLOAT, light_of(o));
    o->encoder = make_texture(o, GL_R32UI, GLES_ENCODER_WIDTH, GLES_ENCODER_HEIGHT);
    return o->variant.version == PUPIL_GLES_ES30 ? make_targets(o, why) : PUPIL_OK;
}

void pupil_gles_textures_delete(gles_object *o)
{
    const gl_functions *gl = &o->gl;
    gl->DeleteSamplers(1, &o->sampler);
    gl->DeleteTextures(4, o->frame[0]);
    gl->DeleteTextures(1, &o->light);
    gl->DeleteTextures(1, &o->encoder);
    gl->DeleteTextures(GLES_TARGET_COUNT, o->target);
    gl->DeleteFramebuffers(GLES_TARGET_COUNT, o->framebuffer);
}

void pupil_gles_textures_set(const gles_object *o)
{
    const pupil_encoder *e = &pupil_encoders[o->settings.transfer];
    const GLsizei cells = (GLsizei)((0x3f800000u - e->base_bits) >> 16) + 1; /* up to that of 1.0 */
    const GLsizei rows = cells / GLES_ENCODER_WIDTH;
    o->gl.ActiveTexture(GL_TEXTURE0);
    unpack_rows(o, 0);
    send(o, o->encoder, GLES_ENCODER_WIDTH, rows, GL_RED_INTEGER, GL_UNSIGNED_INT, e->cell);
    o->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, rows, cells - rows * GLES_ENCODER_WIDTH, 1, GL_RED_INTEGER,
                        GL_UNSIGNED_INT, e->cell + rows * GLES_ENCODER_WIDTH);
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
    pupil_gles_bind(o, GLES_UNIT_LIGHT, GL_TEXTURE_2D, o->light);
    pupil_gles_bind(o, GLES_UNIT_ENCODER, GL_TEXTURE_2D, o->encoder);
}

void pupil_gles_unbind(const gles_object *o)
{
    for (uint32_t unit = 0; unit < GLES_UNIT_COUNT; unit++)
        o->gl.BindSampler(unit, 0);
}

/* A plane at once where its rows are one behind the other, or else row by row. */
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
    o->gl.ActiveTexture(GL_TEXTURE0);
    send_plane(o, texture[0], &luma_layout[image->pixel], extent_of(o, 0), image->data, image->stride_bytes);
    if (image->pixel == PUPIL_PIXEL_NV12)
        send_plane(o, texture[1], &chroma_layout, extent_of(o, 1), image->chroma, image->chroma_stride_bytes);
    o->source[0] = texture[0];
    o->source[1] = texture[1];
    return pupil_gles_error(o);
}

int pupil_gles_use(pupil_gles *gles, uint32_t texture, uint32_t chroma_texture)
{
    const int error = pupil_gles_check(gles);
    if (error)
        return error;
    gles_object *o = gles_object_of(gles);
    if (o->config.source == PUPIL_GLES_MEMORY)
        return PUPIL_ERR_ORDER;
    if (!texture || (o->config.pixel == PUPIL_PIXEL_NV12) != (chroma_texture != 0))
        return PUPIL_ERR_VALUE;
    o->source[0] = texture;
    o->source[1] = chroma_texture;
    return PUPIL_OK;
}
