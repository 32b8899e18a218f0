/* Every format, easy and hard frames, sizes and settings: the GPU's statistics and picture compared with the CPU's. */
#include <sys/mman.h>

#include "frames.h"
#include "same.h"

typedef struct scene {
    const char *name;
    void (*draw)(frame *f);
} scene;

static void lognormal(frame *f)
{
    frame_lognormal(f, 0.18, 2.0, check_uniform);
}

static void gradient(frame *f)
{
    frame_gradient(f, 1e-4, 4.0);
}

static void odd(frame *f)
{
    frame_odd(f, check_uniform);
}

static void bits(frame *f)
{
    frame_bits(f, check_uniform);
}

static void black(frame *f)
{
    frame_fill(f, 0.0, 0.0, 0.0);
}

static void white(frame *f)
{
    frame_fill(f, 1.0, 1.0, 1.0);
}

static void one(frame *f)
{
    frame_one(f, 0.01, 60000.0, check_uniform);
}

/* Half of the pixels below the smallest normal half. */
static void subnormal(frame *f)
{
    frame_checker(f, 0x1p-20, 0.18);
}

static const scene scenes[] = {{"log-normal", lognormal}, {"gradient", gradient},  {"odd values", odd},
                               {"any bits", bits},        {"black", black},        {"white", white},
                               {"one bright", one},       {"subnormal", subnormal}};

static const char *const formats[PUPIL_PIXEL_COUNT] = {
    [PUPIL_PIXEL_RGBA32F] = "RGBA32F",   [PUPIL_PIXEL_RGB32F] = "RGB32F",     [PUPIL_PIXEL_RGBA16F] = "RGBA16F",
    [PUPIL_PIXEL_RGBA16] = "RGBA16",     [PUPIL_PIXEL_RGB16] = "RGB16",       [PUPIL_PIXEL_RGBA8] = "RGBA8",
    [PUPIL_PIXEL_RGB8] = "RGB8",         [PUPIL_PIXEL_YUYV] = "YUYV",         [PUPIL_PIXEL_NV12] = "NV12",
    [PUPIL_PIXEL_GREY8] = "GREY8",       [PUPIL_PIXEL_GREY10] = "GREY10",     [PUPIL_PIXEL_GREY12] = "GREY12",
    [PUPIL_PIXEL_GREY16] = "GREY16",     [PUPIL_PIXEL_BAYER8] = "BAYER8",     [PUPIL_PIXEL_BAYER10] = "BAYER10",
    [PUPIL_PIXEL_BAYER12] = "BAYER12",   [PUPIL_PIXEL_BAYER14] = "BAYER14",   [PUPIL_PIXEL_BAYER16] = "BAYER16",
    [PUPIL_PIXEL_BAYER10P] = "BAYER10P", [PUPIL_PIXEL_BAYER12P] = "BAYER12P", [PUPIL_PIXEL_BGRX8] = "BGRX8",
    [PUPIL_PIXEL_I420] = "I420",         [PUPIL_PIXEL_NV21] = "NV21",         [PUPIL_PIXEL_NV16] = "NV16",
    [PUPIL_PIXEL_UYVY] = "UYVY",         [PUPIL_PIXEL_BGR8] = "BGR8",         [PUPIL_PIXEL_RGBX8] = "RGBX8",
    [PUPIL_PIXEL_GREY10P] = "GREY10P",   [PUPIL_PIXEL_GREY12P] = "GREY12P",   [PUPIL_PIXEL_BGR32F] = "BGR32F",
    [PUPIL_PIXEL_RGB16F] = "RGB16F",     [PUPIL_PIXEL_P010] = "P010",         [PUPIL_PIXEL_I420_10] = "I420_10",
    [PUPIL_PIXEL_RGB10A2] = "RGB10A2",   [PUPIL_PIXEL_I444_16] = "I444_16",
};

/* By the frame's number, in turn: the usual config, and one with a grid, a clip, a curve, its own primaries. */
static void configure(pupil_config *config, unsigned turn)
{
    pupil_config_default(config);
    config->white_mode = turn & 1 ? PUPIL_WHITE_NONE : PUPIL_WHITE_FIXED;
    config->white = 3.0;
    config->histogram = turn & 1;
    config->transfer = turn % PUPIL_TRANSFER_COUNT;
    if (turn & 2)
        pupil_metering_centre(config);
    if (turn & 4) {
        pupil_metering_spot(config);
        config->clip = 0.75f;
        config->primaries = PUPIL_PRIMARIES_BT2020;
    }
    config->primaries = turn % 7 == 3 ? PUPIL_PRIMARIES_BT2020 : config->primaries;
    config->output_primaries = turn % 7 == 3 ? PUPIL_OUTPUT_BT709 : turn % 7 == 5 ? PUPIL_OUTPUT_BT2020 : 0;
}

/* Camera formats: every order, matrix, range, light, shift and black level. */
static void code(pupil_coding *coding, uint32_t pixel, unsigned turn)
{
    *coding = (pupil_coding){.matrix = turn % PUPIL_MATRIX_COUNT,
                             .range = turn / 3 % PUPIL_RANGE_COUNT,
                             .light = turn / 2 % PUPIL_LIGHT_COUNT,
                             .bayer = turn % PUPIL_BAYER_COUNT,
                             .black = turn & 1 ? 16.0f : 0.0f};
    if (pupil_pixel_is_mosaic(pixel) && turn & 1) {
        const float matrix[9] = {1.5f, -0.3f, -0.2f, -0.2f, 1.4f, -0.2f, 0.0f, -0.5f, 1.5f};
        memcpy(coding->rgb_from_camera, matrix, sizeof matrix);
        coding->balance[0] = 1.9f;
        coding->balance[1] = 1.0f;
        coding->balance[2] = 1.6f;
    }
    if (pupil_pixel_is_mosaic(pixel))
        coding->light = PUPIL_LIGHT_LINEAR;
    if ((pixel == PUPIL_PIXEL_GREY10 || pixel == PUPIL_PIXEL_BAYER10) && turn & 2)
        coding->shift = 6;
    if (pupil_pixel_bits(pixel) && turn % 5 == 2) {
        const float top = (float)((1u << pupil_pixel_bits(pixel)) - 1);
        coding->light = PUPIL_LIGHT_DEFAULT;
        coding->knees = 2;
        coding->knee_code[0] = 0.3f * top;
        coding->knee_code[1] = 0.7f * top;
        coding->knee_light[0] = 0.01f;
        coding->knee_light[1] = 0.2f;
    }
}

/* The largest size is only for two formats. Of the rest an eighth is compared: most of the time goes to the shaders,
 * and nearly every case has its own. If shaders are interpreted, and under the sanitizers, only two of the largest
 * frames. */
static int is_left_out(uint32_t pixel, size_t scene_number, size_t size_number)
{
    if (size_number != 4)
        return (scene_number + 2 * size_number + pixel) % (size_t)check_every(8) != 0;
    if (gl_test_interprets() || CHECK_SANITIZED)
        return pixel != PUPIL_PIXEL_RGBA16F || scene_number % 4 != 0;
    return pixel != PUPIL_PIXEL_RGBA32F && pixel != PUPIL_PIXEL_RGBA16F;
}

/* A stride that GL cannot express. */
static void test_far_rows(gl_test *test)
{
    const size_t stride = (size_t)(UINT64_C(1) << 33), bytes = stride + 4096;
    uint8_t *far = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    same_figures figures = {0};
    pupil_config config;
    const pupil_image_const image = {
        .data = far, .stride_bytes = (ptrdiff_t)stride, .width = 4, .height = 2, .pixel = PUPIL_PIXEL_GREY8};
    if (!stride || far == MAP_FAILED)
        return; /* not enough address space */
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    memset(far, 60, 4);
    memset(far + stride, 180, 4);
    CHECK(same_frame(test, &image, &config, &figures, "rows 2^33 bytes apart"));
    munmap(far, bytes);
}

int main(int argc, char **argv)
{
    static const uint32_t sizes[][2] = {{1, 1}, {3, 5}, {64, 48}, {161, 119}, {641, 479}};
    static gl_test test;
    same_figures together = {0};
    unsigned turn = 0;
    check_begin(argc, argv);
    const int status = gl_test_open(&test, PUPIL_GLES_BEST);
    if (status)
        return status;
    for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++) {
        same_figures figures = {0};
        CHECK_MSG(formats[pixel], "format %u has no name here", pixel);
        for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++)
            for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++, turn++) {
                uint32_t width = sizes[k][0], height = sizes[k][1];
                if (is_left_out(pixel, s, k))
                    continue;
                pupil_config config;
                pupil_coding coding;
                char what[64];
                frame_fit(pixel, &width, &height);
                frame f = frame_make(width, height, pixel, turn % 3 * 48, turn % 5 == 4);
                scenes[s].draw(&f);
                configure(&config, turn);
                code(&coding, pixel, turn);
                f.image.coding = &coding;
                snprintf(what, sizeof what, "%s %ux%u, %s, %u", formats[pixel], width, height, scenes[s].name, turn);
                if (!same_frame(&test, &f.image, &config, &figures, what)) {
                    config.histogram = 0;
                    CHECK(same_frame(&test, &f.image, &config, &figures, what));
                }
                frame_free(&f);
            }
        /* With few frames, a single column of a gradient that is off in all rows would exceed a format's limit. */
        if (check_state.all)
            same_judge(&figures, formats[pixel]);
        else
            same_print(&figures, formats[pixel]);
        same_add(&together, &figures);
    }
    same_judge(&together, "all formats");
    test_far_rows(&test);
    gl_test_close(&test);
    return check_end();
}
