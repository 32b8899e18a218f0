/* An external texture, as from camera stacks: the driver converts it to RGB, which is then metered and mapped as the
 * CPU does with RGBA8, or with RGB10A2 in PQ. Here it is an EGLImage of an ordinary texture. */
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl32.h>
#include <math.h>

#include <GLES2/gl2ext.h> /* must come after gl32.h */

#include "frames.h"
#include "gl_test.h"
#include "pupil/gles.h"

enum { WIDTH = 61, HEIGHT = 37 };

/* The picture as an EGLImage; its texture stays. NULL: the driver has no EGLImages. */
static EGLImageKHR make_image(const pupil_image_const *picture)
{
    GLuint texture;
    PFNEGLCREATEIMAGEKHRPROC create = (PFNEGLCREATEIMAGEKHRPROC)eglGetProcAddress("eglCreateImageKHR");
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    const int is_10 = picture->pixel == PUPIL_PIXEL_RGB10A2;
    glTexStorage2D(GL_TEXTURE_2D, 1, is_10 ? GL_RGB10_A2 : GL_RGBA8, WIDTH, HEIGHT);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, WIDTH, HEIGHT, GL_RGBA,
                    is_10 ? GL_UNSIGNED_INT_2_10_10_10_REV : GL_UNSIGNED_BYTE, picture->data);
    return create ? create(eglGetCurrentDisplay(), eglGetCurrentContext(), EGL_GL_TEXTURE_2D_KHR,
                           (EGLClientBuffer)(uintptr_t)texture, NULL)
                  : EGL_NO_IMAGE_KHR;
}

static GLuint external_of(EGLImageKHR image)
{
    GLuint texture;
    PFNGLEGLIMAGETARGETTEXTURE2DOESPROC target =
        (PFNGLEGLIMAGETARGETTEXTURE2DOESPROC)eglGetProcAddress("glEGLImageTargetTexture2DOES");
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_EXTERNAL_OES, texture);
    target(GL_TEXTURE_EXTERNAL_OES, image);
    return texture;
}

static void compare(gl_test *test, pupil_gles *gles, const pupil_t *pupil, const pupil_image_const *picture)
{
    static uint8_t gpu[WIDTH * HEIGHT * 4], cpu[WIDTH * HEIGHT * 4];
    const pupil_curve curve = {.scale = 1.5f, .inverse_white_squared = 0.2f, .gamut = 1.0f};
    const pupil_image out = {
        .data = cpu, .stride_bytes = WIDTH * 4, .width = WIDTH, .height = HEIGHT, .pixel = PUPIL_PIXEL_RGBA8};
    const pupil_gles_target target = {
        .framebuffer = gl_test_framebuffer(test, WIDTH, HEIGHT), .width = WIDTH, .height = HEIGHT, .top_first = 1};
    pupil_stats stats, cpu_stats;
    double mean = 0.0, cpu_mean = 1.0;
    CHECK(pupil_gles_meter(gles, NULL) == PUPIL_OK);
    CHECK(pupil_gles_collect(gles, UINT64_C(60000000000), &stats, NULL) == PUPIL_OK);
    pupil_stats_clear(&cpu_stats);
    CHECK(pupil_meter_rows(pupil, picture, 0, HEIGHT, &cpu_stats) == PUPIL_OK);
    CHECK(pupil_stats_mean(&stats, 0, 1, &mean) == PUPIL_OK && pupil_stats_mean(&cpu_stats, 0, 1, &cpu_mean) == 0);
    CHECK_MSG(fabs(exp2(mean - cpu_mean) - 1.0) <= 1e-5, "%g and %g", mean, cpu_mean);
    CHECK(stats.pixels == WIDTH * HEIGHT && stats.clipped == cpu_stats.clipped);

    CHECK(pupil_map_rows(pupil, &curve, picture, &out) == PUPIL_OK);
    CHECK(pupil_gles_map(gles, &curve, &target) == PUPIL_OK);
    gl_test_read(test, gpu);
    int most = 0, off = 0;
    for (size_t i = 0; i < sizeof gpu; i++) {
        const int by = abs(gpu[i] - cpu[i]);
        most = by > most ? by : most;
        off += by != 0;
    }
    printf("external: %d of %zu samples off, by %d at most\n", off, sizeof gpu, most);
    CHECK(most <= 1 && off <= 1);
}

/* 0, or a sentence: the driver has no external textures. */
static const char *test_picture(gl_test *test, uint32_t pixel, uint32_t light)
{
    static pupil_gles gles;
    static pupil_t pupil;
    const pupil_coding coding = {.light = light};
    pupil_config settings;
    pupil_gles_config config;
    pupil_why why = {""};
    frame f = frame_make(WIDTH, HEIGHT, pixel, 0, 0);
    f.image.coding = &coding;
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++)
            frame_set(&f, x, y, 1.1 * check_uniform(), check_uniform(), check_uniform(), 1.0); /* some are clipped */

    pupil_config_default(&settings);
    settings.white_mode = PUPIL_WHITE_NONE;
    CHECK(pupil_init(&pupil, &settings) == PUPIL_OK);
    pupil_gles_config_default(&config);
    config.source = PUPIL_GLES_EXTERNAL;
    config.pixel = PUPIL_PIXEL_RGBA8;
    config.coding = &coding;
    config.width = WIDTH;
    config.height = HEIGHT;
    const int error = pupil_gles_init(&gles, &config, &pupil, pupil_egl_get_proc, &why);
    EGLImageKHR image = error ? EGL_NO_IMAGE_KHR : make_image(&f.image);
    if (error == PUPIL_ERR_GLES_VERSION || (!error && image == EGL_NO_IMAGE_KHR)) {
        CHECK_MSG(!error || strstr(why.text, "GL_OES_EGL_image_external_essl3"), "%s", why.text);
        pupil_gles_close(&gles);
        frame_free(&f);
        return "the driver has no external textures";
    }
    CHECK_MSG(error == PUPIL_OK, "%s", why.text);
    const GLuint texture = external_of(image);
    CHECK(pupil_gles_use(&gles, texture, 0, 0) == PUPIL_OK);
    compare(test, &gles, &pupil, &f.image);
    pupil_gles_close(&gles);
    glDeleteTextures(1, &texture);
    ((PFNEGLDESTROYIMAGEKHRPROC)eglGetProcAddress("eglDestroyImageKHR"))(eglGetCurrentDisplay(), image);
    frame_free(&f);
    return NULL;
}

int main(int argc, char **argv)
{
    static gl_test test;
    check_begin(argc, argv);
    const int status = gl_test_open(&test, PUPIL_GLES_BEST);
    if (status)
        return status;
    const char *none = test_picture(&test, PUPIL_PIXEL_RGBA8, PUPIL_LIGHT_DEFAULT);
    if (!none)
        none = test_picture(&test, PUPIL_PIXEL_RGB10A2, PUPIL_LIGHT_PQ);
    gl_test_close(&test);
    const int failed = check_end();
    return failed || !none ? failed : check_cannot(none);
}
