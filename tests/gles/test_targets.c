/* Where the picture is drawn: orientations, windows and memory, letterbox, fill, stretch, split screens, scaling, half
 * size, and the caller's own textures. */
#include <GLES3/gl32.h>

#include <GLES2/gl2ext.h> /* must come after gl32.h */

#include "frames.h"
#include "gl_test.h"
#include "pupil/gles.h"

typedef struct view {
    uint32_t width, height;
    uint8_t *rgba;
} view;

static view view_make(uint32_t width, uint32_t height)
{
    return (view){width, height, calloc((size_t)width * height, 4)};
}

static const uint8_t *at(const view *v, uint32_t x, uint32_t y)
{
    return v->rgba + 4 * ((size_t)y * v->width + x);
}

static int near(const uint8_t *a, const uint8_t *b, int most)
{
    for (int i = 0; i < 4; i++)
        if (abs(a[i] - b[i]) > most)
            return 0;
    return 1;
}

static const pupil_curve curve = {.scale = 1.3f, .inverse_white_squared = 0.1f, .gamut = 1.0f};
static pupil_t pupil;

static view mapped_by_cpu(const pupil_image_const *image, uint32_t half)
{
    view v = view_make(image->width >> half, image->height >> half);
    const pupil_image out = {.data = v.rgba,
                             .stride_bytes = (ptrdiff_t)v.width * 4,
                             .width = v.width,
                             .height = v.height,
                             .pixel = PUPIL_PIXEL_RGBA8};
    CHECK(pupil_map_rows(&pupil, &curve, image, &out) == PUPIL_OK);
    return v;
}

static void open_gles(pupil_gles *gles, const pupil_image_const *image, uint32_t scaled, uint32_t half_size)
{
    pupil_gles_config config;
    pupil_why why = {""};
    pupil_gles_config_default(&config);
    config.pixel = image->pixel;
    config.width = image->width;
    config.height = image->height;
    config.scaled = scaled;
    config.half_size = half_size;
    CHECK_MSG(pupil_gles_init(gles, &config, &pupil, pupil_egl_get_proc, &why) == PUPIL_OK, "%s", why.text);
    CHECK(pupil_gles_upload(gles, image) == PUPIL_OK);
}

/* The picture's pixel that an orientation shows at (x, y), by EXIF's definition of what row 0 and column 0 are. */
static const uint8_t *shown_at(const view *v, uint32_t orientation, uint32_t x, uint32_t y)
{
    const uint32_t right = v->width - 1, bottom = v->height - 1;
    switch (orientation) {
    case PUPIL_GLES_UPRIGHT: /* row 0 is the top, column 0 the left side */
        return at(v, x, y);
    case PUPIL_GLES_MIRRORED:
        return at(v, right - x, y);
    case PUPIL_GLES_ROTATED_180:
        return at(v, right - x, bottom - y);
    case PUPIL_GLES_FLIPPED:
        return at(v, x, bottom - y);
    case PUPIL_GLES_TRANSPOSED: /* row 0 is the left side, column 0 the top */
        return at(v, y, x);
    case PUPIL_GLES_ROTATED_90: /* row 0 is the right side, column 0 the top */
        return at(v, y, bottom - x);
    case PUPIL_GLES_TRANSVERSED: /* row 0 is the right side, column 0 the bottom */
        return at(v, right - y, bottom - x);
    default: /* row 0 is the left side, column 0 the bottom */
        return at(v, right - y, x);
    }
}

/* Checks every pixel where the picture should be; the others are `around`. */
static void check_picture(const view *picture, const view *seen, const pupil_gles_target *t, uint32_t part_x,
                          uint32_t part_width, int most)
{
    static const uint8_t untouched[4] = {9, 8, 7, 6};
    unsigned long wrong = 0;
    const int turned = t->orientation >= PUPIL_GLES_TRANSPOSED;
    const uint32_t width = turned ? picture->height : picture->width;
    const uint32_t height = turned ? picture->width : picture->height;
    for (uint32_t y = 0; y < seen->height; y++)
        for (uint32_t x = 0; x < seen->width; x++) {
            const uint32_t u = x - (uint32_t)t->x, row = y - (uint32_t)t->y;
            const uint32_t v = t->top_first ? row : height - 1 - row;
            const int inside = x >= part_x && x < part_x + part_width && u < width && row < height;
            const uint8_t *right = inside ? shown_at(picture, t->orientation, u, v) : untouched;
            wrong += !near(at(seen, x, y), right, inside ? most : 0);
        }
    CHECK_MSG(wrong == 0, "orientation %u, top_first %u: %lu pixels", t->orientation, t->top_first, wrong);
}

static void wipe(gl_test *test, view *seen, pupil_gles_target *target)
{
    target->framebuffer = gl_test_framebuffer(test, seen->width, seen->height);
    glDisable(GL_SCISSOR_TEST);
    glClearColor(9.0f / 255.0f, 8.0f / 255.0f, 7.0f / 255.0f, 6.0f / 255.0f);
    glClear(GL_COLOR_BUFFER_BIT);
}

static void test_orientations(gl_test *test)
{
    static pupil_gles gles;
    frame f = frame_make(23, 14, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame_lognormal(&f, 0.2, 2.0, check_uniform);
    view picture = mapped_by_cpu(&f.image, 0), seen = view_make(40, 40);
    open_gles(&gles, &f.image, 0, 0);
    for (uint32_t orientation = 0; orientation < PUPIL_GLES_ORIENTATION_COUNT; orientation++)
        for (uint32_t top_first = 0; top_first < 2; top_first++) {
            const int turned = orientation >= PUPIL_GLES_TRANSPOSED;
            pupil_gles_target t = {.x = 5, .y = 9, .width = turned ? 14 : 23, .height = turned ? 23 : 14};
            t.orientation = orientation;
            t.top_first = top_first;
            wipe(test, &seen, &t);
            CHECK(pupil_gles_map(&gles, &curve, &t) == PUPIL_OK);
            gl_test_read(test, seen.rgba);
            check_picture(&picture, &seen, &t, 0, 40, 1);
            t.from = 0.5f; /* the right half only, rounded */
            t.to = 1.0f;
            wipe(test, &seen, &t);
            CHECK(pupil_gles_map(&gles, &curve, &t) == PUPIL_OK);
            gl_test_read(test, seen.rgba);
            const uint32_t first = (uint32_t)(0.5f * (float)t.width + 0.5f);
            check_picture(&picture, &seen, &t, 5 + first, t.width - first, 1);
        }
    pupil_gles_target other = {.width = 24, .height = 14};
    CHECK(pupil_gles_map(&gles, &curve, &other) == PUPIL_ERR_SIZE);
    pupil_gles_close(&gles);
    frame_free(&f);
    free(picture.rgba);
    free(seen.rgba);
}

/* A frame with a dark left and a bright right half, which scaling must keep. */
static frame two_halves(uint32_t width, uint32_t height)
{
    frame f = frame_make(width, height, PUPIL_PIXEL_RGB32F, 0, 0);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            frame_set(&f, x, y, x < width / 2 ? 0.02 : 2.0, 0.1, y < height / 2 ? 0.1 : 0.4, 1.0);
    return f;
}

typedef struct fit_case {
    uint32_t fit, orientation, width, height;
    uint32_t x, y, drawn_width, drawn_height; /* where the 20 x 10 picture should be */
} fit_case;

static void test_fits(gl_test *test)
{
    static const fit_case cases[] = {
        {PUPIL_GLES_LETTERBOX, PUPIL_GLES_UPRIGHT, 40, 40, 0, 10, 40, 20},
        {PUPIL_GLES_LETTERBOX, PUPIL_GLES_UPRIGHT, 60, 20, 10, 0, 40, 20},
        {PUPIL_GLES_LETTERBOX, PUPIL_GLES_ROTATED_180, 10, 10, 0, 2, 10, 5},
        {PUPIL_GLES_STRETCH, PUPIL_GLES_UPRIGHT, 33, 44, 0, 0, 33, 44},
        {PUPIL_GLES_FILL, PUPIL_GLES_UPRIGHT, 40, 40, 0, 0, 40, 40},
        {PUPIL_GLES_LETTERBOX, PUPIL_GLES_UPRIGHT, 20, 30, 0, 10, 20, 10},
    };
    static pupil_gles gles;
    static const uint8_t bar[4] = {0, 0, 0, 255};
    frame f = two_halves(20, 10);
    view picture = mapped_by_cpu(&f.image, 0);
    open_gles(&gles, &f.image, 1, 0);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const fit_case *c = &cases[i];
        view seen = view_make(c->width, c->height);
        pupil_gles_target t = {.width = c->width, .height = c->height, .top_first = 1};
        t.fit = c->fit;
        t.orientation = c->orientation;
        wipe(test, &seen, &t);
        CHECK(pupil_gles_map(&gles, &curve, &t) == PUPIL_OK);
        gl_test_read(test, seen.rgba);
        unsigned long wrong = 0, bars = 0;
        for (uint32_t y = 0; y < c->height; y++)
            for (uint32_t x = 0; x < c->width; x++) {
                const uint32_t u = x - c->x, v = y - c->y;
                if (u >= c->drawn_width || v >= c->drawn_height) {
                    bars += !near(at(&seen, x, y), bar, 0);
                    continue;
                }
                /* away from the edge of two colours only one is visible */
                const double px = (u + 0.5) / c->drawn_width, py = (v + 0.5) / c->drawn_height;
                const int middle = (px > 0.4 && px < 0.6) || (py > 0.35 && py < 0.65);
                const uint8_t *colour = shown_at(&picture, c->orientation, px < 0.5 ? 2 : 17, py < 0.5 ? 1 : 8);
                wrong += !middle && !near(at(&seen, x, y), colour, 1);
            }
        CHECK_MSG(wrong == 0 && bars == 0, "case %zu: %lu pixels, %lu of the bars", i, wrong, bars);
        free(seen.rgba);
    }
    pupil_gles_close(&gles);
    frame_free(&f);
    free(picture.rgba);
}

/* To half size: each pixel is the mean of four. */
static void test_halving(gl_test *test)
{
    static pupil_gles gles;
    frame f = frame_make(64, 32, PUPIL_PIXEL_RGB32F, 0, 0);
    frame_lognormal(&f, 0.2, 2.0, check_uniform);
    view picture = mapped_by_cpu(&f.image, 0), seen = view_make(32, 16);
    pupil_gles_target t = {.width = 32, .height = 16, .top_first = 1};
    open_gles(&gles, &f.image, 1, 0);
    wipe(test, &seen, &t);
    CHECK(pupil_gles_map(&gles, &curve, &t) == PUPIL_OK);
    gl_test_read(test, seen.rgba);
    unsigned long wrong = 0;
    for (uint32_t y = 0; y < 16; y++)
        for (uint32_t x = 0; x < 32; x++)
            for (int i = 0; i < 4; i++) {
                const int sum = at(&picture, 2 * x, 2 * y)[i] + at(&picture, 2 * x + 1, 2 * y)[i] +
                                at(&picture, 2 * x, 2 * y + 1)[i] + at(&picture, 2 * x + 1, 2 * y + 1)[i];
                wrong += abs(4 * at(&seen, x, y)[i] - sum) > 6; /* half a code of rounding, and one of a sample */
            }
    CHECK_MSG(wrong == 0, "%lu samples", wrong);
    pupil_gles_close(&gles);
    frame_free(&f);
    free(picture.rgba);
    free(seen.rgba);
}

static void test_half_size(gl_test *test)
{
    static pupil_gles gles;
    frame f = frame_make(48, 20, PUPIL_PIXEL_BAYER12, 0, 0);
    frame_lognormal(&f, 0.2, 1.0, check_uniform);
    view picture = mapped_by_cpu(&f.image, 1), seen = view_make(24, 10);
    pupil_gles_target t = {.width = 24, .height = 10, .top_first = 1};
    open_gles(&gles, &f.image, 0, 1);
    wipe(test, &seen, &t);
    CHECK(pupil_gles_map(&gles, &curve, &t) == PUPIL_OK);
    gl_test_read(test, seen.rgba);
    check_picture(&picture, &seen, &t, 0, 24, 1);
    pupil_gles_close(&gles);
    frame_free(&f);
    free(picture.rgba);
    free(seen.rgba);
}

/* How a caller creates the textures of a format. */
typedef struct own_textures {
    uint32_t pixel, normalized_16;
    struct {
        GLint internal;
        GLenum format, type;
        uint32_t texel_bytes;
    } plane[3];
    GLint red, blue; /* the first plane's swizzle; 0, 0: none */
} own_textures;

static void make_texture(const own_textures *own, int i, GLsizei width, GLsizei height, ptrdiff_t stride,
                         const void *data)
{
    glPixelStorei(GL_UNPACK_ROW_LENGTH, (GLint)(stride / (ptrdiff_t)own->plane[i].texel_bytes));
    glTexImage2D(GL_TEXTURE_2D, 0, own->plane[i].internal, width, height, 0, own->plane[i].format, own->plane[i].type,
                 data);
    if (i == 0 && own->red) {
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_R, own->red);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_B, own->blue);
    }
}

/* The caller's textures, with GL's default filters. */
static void test_own_textures(gl_test *test, const own_textures *own)
{
    static pupil_gles gles;
    pupil_gles_config config;
    const pupil_coding pq = {.light = PUPIL_LIGHT_PQ};
    frame f = frame_make(31, 17, own->pixel, 0, 0);
    f.image.coding = &pq; /* not for 8-bit RGB */
    frame_lognormal(&f, 0.2, 1.0, check_uniform);
    view picture = mapped_by_cpu(&f.image, 0), seen = view_make(31, 17);
    pupil_gles_target t = {.width = 31, .height = 17, .top_first = 1};
    const GLsizei chroma_height = (GLsizei)pupil_chroma_rows(own->pixel, 17);
    const uint32_t planes = pupil_pixel_planes(own->pixel);
    GLuint texture[3] = {0};
    glGenTextures((GLsizei)planes, texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glBindTexture(GL_TEXTURE_2D, texture[0]);
    make_texture(own, 0, 31, 17, f.image.stride_bytes, f.image.data);
    for (uint32_t i = 1; i < planes; i++) {
        glBindTexture(GL_TEXTURE_2D, texture[i]);
        make_texture(own, (int)i, own->pixel == PUPIL_PIXEL_I444_16 ? 31 : 16, chroma_height,
                     i == 1 ? f.image.chroma_stride_bytes : f.image.cr_stride_bytes,
                     i == 1 ? f.image.chroma : f.image.cr);
    }

    pupil_gles_config_default(&config);
    config.pixel = own->pixel;
    config.normalized_16 = own->normalized_16;
    config.width = 31;
    config.height = 17;
    config.source = PUPIL_GLES_TEXTURES;
    config.coding = &pq;
    CHECK(pupil_gles_init(&gles, &config, &pupil, pupil_egl_get_proc, NULL) == PUPIL_OK);
    CHECK(pupil_gles_map(&gles, &curve, &t) == PUPIL_ERR_ORDER);
    CHECK(pupil_gles_use(&gles, 0, texture[1], texture[2]) == PUPIL_ERR_VALUE);
    CHECK(pupil_gles_use(&gles, texture[0], planes > 1 ? 0 : texture[0], texture[2]) == PUPIL_ERR_VALUE);
    CHECK(pupil_gles_use(&gles, texture[0], texture[1], planes > 2 ? 0 : texture[0]) == PUPIL_ERR_VALUE);
    CHECK(pupil_gles_upload(&gles, &f.image) == PUPIL_ERR_ORDER);
    CHECK(pupil_gles_use(&gles, texture[0], texture[1], texture[2]) == PUPIL_OK);
    wipe(test, &seen, &t);
    CHECK(pupil_gles_map(&gles, &curve, &t) == PUPIL_OK);
    gl_test_read(test, seen.rgba);
    check_picture(&picture, &seen, &t, 0, 31, 1);
    pupil_gles_close(&gles);
    glDeleteTextures((GLsizei)planes, texture);
    frame_free(&f);
    free(picture.rgba);
    free(seen.rgba);
}

static void test_all_own_textures(gl_test *test)
{
    static const own_textures own[] = {
        {PUPIL_PIXEL_NV12, 0, {{GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1}, {GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2}}, 0, 0},
        {PUPIL_PIXEL_BGRX8, 0, {{GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4}}, GL_BLUE, GL_RED},
        {PUPIL_PIXEL_I420_10,
         0,
         {{GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2},
          {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2},
          {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2}},
         0,
         0},
        {PUPIL_PIXEL_I444_16,
         0,
         {{GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2},
          {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2},
          {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2}},
         0,
         0},
        {PUPIL_PIXEL_P010,
         1,
         {{GL_R16_EXT, GL_RED, GL_UNSIGNED_SHORT, 2}, {GL_RG16_EXT, GL_RG, GL_UNSIGNED_SHORT, 4}},
         0,
         0},
    };
    const int has_norm16 = strstr((const char *)glGetString(GL_EXTENSIONS), "GL_EXT_texture_norm16") != NULL;
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++)
        if (!own[i].normalized_16 || has_norm16)
            test_own_textures(test, &own[i]);
}

int main(int argc, char **argv)
{
    static gl_test test;
    pupil_config config;
    check_begin(argc, argv);
    const int status = gl_test_open(&test, PUPIL_GLES_BEST);
    if (status)
        return status;
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    test_orientations(&test);
    test_fits(&test);
    test_halving(&test);
    test_half_size(&test);
    test_all_own_textures(&test);
    gl_test_close(&test);
    return check_end();
}
