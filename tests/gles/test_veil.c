/* A picture with its veil, by the GPU and by the CPU: at most one code of difference, on one sample of 10,000; and what
 * is refused. */
#include "check.h"
#include "frames.h"
#include "pupil/veil.h"
#include "same.h"

#define NODE_FLOATS (PUPIL_VEIL_NODES * PUPIL_VEIL_NODES * 3)

static pupil_gles gles;
static pupil_t pupil;
static pupil_veil veil;
static pupil_veil_light light;
static pupil_veil_scratch scratch;
static float nodes[NODE_FLOATS];

static void find_veil(const pupil_image_const *image, pupil_veil_result *result)
{
    pupil_veil_config config;
    pupil_veil_config_default(&config);
    config.width = image->width;
    config.height = image->height;
    CHECK(pupil_veil_init(&veil, &config) == PUPIL_OK);
    CHECK(pupil_veil_light_clear(&light) == PUPIL_OK);
    CHECK(pupil_veil_gather_rows(&veil, &pupil, image, 0, NULL, &light) == PUPIL_OK);
    CHECK(pupil_veil_begin(&veil) == PUPIL_OK && pupil_veil_add_light(&veil, &light) == PUPIL_OK);
    CHECK(pupil_veil_solve(&veil) == PUPIL_OK && pupil_veil_get_nodes(&veil, nodes) == PUPIL_OK);
    CHECK(pupil_veil_get(&veil, result) == PUPIL_OK);
}

static void compare(gl_test *test, const pupil_image_const *image, same_figures *figures)
{
    const size_t bytes = (size_t)image->width * image->height * 4;
    uint8_t *gpu = malloc(bytes), *cpu = malloc(bytes);
    const pupil_image out = {.data = cpu,
                             .stride_bytes = (ptrdiff_t)image->width * 4,
                             .width = image->width,
                             .height = image->height,
                             .pixel = PUPIL_PIXEL_RGBA8};
    const pupil_gles_target target = {.framebuffer = gl_test_framebuffer(test, image->width, image->height),
                                      .width = image->width,
                                      .height = image->height,
                                      .top_first = 1};
    pupil_curve curve = {.scale = 1.0f, .inverse_white_squared = 0.25f, .gamut = 2.0f, .dither = image->width % 2};
    pupil_veil_result result;
    find_veil(image, &result);
    CHECK(pupil_gles_veil(&gles, nodes, (float)result.direct) == PUPIL_OK);
    CHECK(pupil_veil_map_rows(&veil, &pupil, &curve, image, &out, &scratch) == PUPIL_OK);
    CHECK(pupil_gles_map(&gles, &curve, &target) == PUPIL_OK);
    gl_test_read(test, gpu);
    compare_codes(gpu, cpu, bytes, figures, "veil");
    free(gpu);
    free(cpu);
}

static void check_frame(gl_test *test, uint32_t version, uint32_t pixel, uint32_t width, uint32_t height,
                        same_figures *figures)
{
    pupil_config config;
    pupil_gles_config with;
    pupil_why why = {""};
    const pupil_curve curve = {.scale = 1.0f};
    frame f = frame_make(width, height, pixel, 0, 0);
    frame_lognormal(&f, 0.02, 3, check_uniform);
    frame_set(&f, width / 3, height / 2, 500, 300, 100, 1);
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_gles_config_default(&with);
    with.version = version;
    with.pixel = pixel;
    with.width = width;
    with.height = height;
    with.veil = 1;
    const int error = pupil_gles_init(&gles, &with, &pupil, pupil_egl_get_proc, &why);
    CHECK_MSG(error == PUPIL_OK, "%s", why.text);
    if (!error) {
        const pupil_gles_target target = {
            .framebuffer = gl_test_framebuffer(test, width, height), .width = width, .height = height, .top_first = 1};
        CHECK(pupil_gles_upload(&gles, &f.image) == PUPIL_OK);
        CHECK(pupil_gles_map(&gles, &curve, &target) == PUPIL_ERR_ORDER); /* no veil yet */
        CHECK(pupil_gles_veil(&gles, NULL, 1) == PUPIL_ERR_NULL);
        CHECK(pupil_gles_veil(&gles, nodes, NAN) == PUPIL_ERR_VALUE);
        CHECK(pupil_gles_veil(&gles, nodes, 1.1f) == PUPIL_ERR_VALUE);
        compare(test, &f.image, figures);
        pupil_gles_close(&gles);
    }
    with.veil = 0;
    CHECK(pupil_gles_init(&gles, &with, &pupil, pupil_egl_get_proc, &why) == PUPIL_OK);
    CHECK(pupil_gles_veil(&gles, nodes, 1) == PUPIL_ERR_ORDER);
    pupil_gles_close(&gles);
    CHECK(same_frame(test, &f.image, &config, figures, "without"));
    with.veil = 2;
    CHECK(pupil_gles_init(&gles, &with, &pupil, pupil_egl_get_proc, &why) == PUPIL_ERR_CONFIG);
    with.veil = 1;
    with.pixel = PUPIL_PIXEL_BAYER8;
    with.width = with.height = 64;
    CHECK(pupil_gles_init(&gles, &with, &pupil, pupil_egl_get_proc, &why) == PUPIL_ERR_CONFIG);
    frame_free(&f);
}

int main(int argc, char **argv)
{
    static const uint32_t versions[] = {PUPIL_GLES_ES30, PUPIL_GLES_ES31};
    static const uint32_t sizes[][2] = {{320, 180}, {33, 47}, {131, 1}, {64, 64}};
    check_begin(argc, argv);
    for (int v = 0; v < 2; v++) {
        static gl_test test;
        same_figures figures = {0};
        const int status = gl_test_open(&test, versions[v]);
        if (status)
            return status;
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            check_frame(&test, versions[v], PUPIL_PIXEL_RGBA32F, sizes[i][0], sizes[i][1], &figures);
            check_frame(&test, versions[v], PUPIL_PIXEL_RGBA8, sizes[i][0], sizes[i][1], &figures);
        }
        printf("ES %u: ", versions[v]);
        same_judge(&figures, "veil");
        gl_test_close(&test);
    }
    return check_end();
}
