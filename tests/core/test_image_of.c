/* pupil_image_of, pupil_image_const_of and pupil_image_bytes, for every format and at odd sizes: the same statistics
 * and the same picture as of padded rows in planes of their own, and no byte beyond the last one is touched. */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

#define GUARD 64

/* Copies a plane's rows without their padding to `to`, or back. */
static unsigned char *copy_plane(const void *plane, ptrdiff_t stride, size_t row_bytes, uint32_t rows,
                                 unsigned char *to, int back)
{
    for (uint32_t y = 0; y < rows; y++, to += row_bytes) {
        unsigned char *row = (unsigned char *)(uintptr_t)plane + (ptrdiff_t)y * stride;
        memcpy(back ? row : to, back ? to : row, row_bytes);
    }
    return to;
}

static void copy_planes(const pupil_image_const *image, unsigned char *to, int back)
{
    const size_t chroma_bytes = pupil_chroma_row_bytes(image->pixel, image->width);
    const uint32_t chroma_rows = pupil_chroma_rows(image->pixel, image->height);
    to = copy_plane(image->data, image->stride_bytes, pupil_row_bytes(image->pixel, image->width), image->height, to,
                    back);
    if (image->chroma)
        to = copy_plane(image->chroma, image->chroma_stride_bytes, chroma_bytes, chroma_rows, to, back);
    if (image->cr)
        copy_plane(image->cr, image->cr_stride_bytes, chroma_bytes, chroma_rows, to, back);
}

static unsigned char *tight_memory(uint32_t pixel, uint32_t width, uint32_t height)
{
    const size_t bytes = pupil_image_bytes(pixel, width, height);
    unsigned char *memory = malloc(bytes + GUARD);
    memset(memory, 0xa5, bytes + GUARD);
    return memory;
}

static int guard_intact(const unsigned char *memory, size_t bytes)
{
    for (size_t i = 0; i < GUARD; i++)
        if (memory[bytes + i] != 0xa5)
            return 0;
    return 1;
}

static void check_input(const pupil_t *pupil, uint32_t pixel, uint32_t width, uint32_t height)
{
    pupil_stats padded, tight;
    frame_fit(pixel, &width, &height);
    frame f = frame_make(width, height, pixel, 16, 0);
    frame_lognormal(&f, 0.2, 2, check_uniform);
    unsigned char *memory = tight_memory(pixel, width, height);
    copy_planes(&f.image, memory, 0);
    const pupil_image_const image = pupil_image_const_of(memory, width, height, pixel);
    pupil_stats_clear(&padded);
    pupil_stats_clear(&tight);
    CHECK(pupil_meter_rows(pupil, &f.image, 0, height, &padded) == PUPIL_OK);
    CHECK_MSG(pupil_meter_rows(pupil, &image, 0, height, &tight) == PUPIL_OK, "format %u", pixel);
    CHECK_MSG(!memcmp(&padded, &tight, sizeof padded), "format %u of %u x %u", pixel, width, height);
    CHECK(guard_intact(memory, pupil_image_bytes(pixel, width, height)));
    free(memory);
    frame_free(&f);
}

static void check_output(pupil_t *pupil, uint32_t pixel, uint32_t width, uint32_t height, int *outputs)
{
    frame in = frame_make(width, height, PUPIL_PIXEL_RGB32F, 0, 0), padded = frame_make(width, height, pixel, 16, 0);
    frame back = frame_make(width, height, pixel, 16, 0);
    frame_lognormal(&in, 0.2, 2, check_uniform);
    unsigned char *memory = tight_memory(pixel, width, height);
    const pupil_image out = frame_writable(&padded), tight = pupil_image_of(memory, width, height, pixel);
    const int error = pupil_process(pupil, &in.image, NULL, &out);
    CHECK_MSG(pupil_process(pupil, &in.image, NULL, &tight) == error, "format %u", pixel);
    if (!error) {
        copy_planes(&back.image, memory, 1);
        CHECK_MSG(frame_equal(&padded, &back), "format %u of %u x %u", pixel, width, height);
        ++*outputs;
    }
    CHECK(guard_intact(memory, pupil_image_bytes(pixel, width, height)));
    free(memory);
    frame_free(&in);
    frame_free(&padded);
    frame_free(&back);
}

/* The sentence of PUPIL_ERR_PIXEL_OUT names exactly the formats that can be written. */
static void check_sentence(pupil_t *pupil)
{
#define NAME(pixel) [PUPIL_PIXEL_##pixel] = " " #pixel
    static const char *const names[PUPIL_PIXEL_COUNT] = {
        NAME(RGBA32F), NAME(RGB32F),  NAME(RGBA16F), NAME(RGBA16),  NAME(RGB16),   NAME(RGBA8),    NAME(RGB8),
        NAME(BGRX8),   NAME(YUYV),    NAME(NV12),    NAME(GREY8),   NAME(GREY10),  NAME(GREY12),   NAME(GREY16),
        NAME(BAYER8),  NAME(BAYER10), NAME(BAYER12), NAME(BAYER14), NAME(BAYER16), NAME(BAYER10P), NAME(BAYER12P),
        NAME(I420),    NAME(NV21),    NAME(NV16),    NAME(UYVY),    NAME(BGR8),    NAME(RGBX8),    NAME(GREY10P),
        NAME(GREY12P), NAME(BGR32F),  NAME(RGB16F),  NAME(P010),    NAME(I420_10), NAME(RGB10A2),  NAME(I444_16)};
    static float in_memory[4 * 4 * 4], out_memory[4 * 4 * 4];
    const pupil_image_const in = pupil_image_const_of(in_memory, 4, 4, PUPIL_PIXEL_RGB32F);
    for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++) {
        const pupil_image out = pupil_image_of(out_memory, 4, 4, pixel);
        const int error = pupil_process(pupil, &in, NULL, &out);
        const char *at = strstr(pupil_error_string(PUPIL_ERR_PIXEL_OUT), names[pixel]);
        const int named = at && strchr(" ,", at[strlen(names[pixel])]);
        CHECK_MSG(named ? error == PUPIL_OK : error == PUPIL_ERR_PIXEL_OUT, "%s: %d", names[pixel], error);
    }
}

int main(int argc, char **argv)
{
    static const uint32_t sizes[][2] = {{1, 1}, {7, 5}, {12, 4}};
    pupil_config config;
    pupil_t pupil;
    int outputs = 0;
    check_begin(argc, argv);
    pupil_config_default(&config);
    config.tau_light_s = config.tau_dark_s = 0; /* so that the same frame has the same picture twice */
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            check_input(&pupil, pixel, sizes[i][0], sizes[i][1]);
            check_output(&pupil, pixel, sizes[i][0], sizes[i][1], &outputs);
        }
    CHECK_MSG(outputs == 33, "%d", outputs); /* 11 formats, 3 sizes */
    check_sentence(&pupil);
    const pupil_image nothing = pupil_image_of(NULL, 4, 4, PUPIL_PIXEL_I420);
    CHECK(!nothing.data && !nothing.chroma && !nothing.cr);
    CHECK(pupil_image_bytes(PUPIL_PIXEL_COUNT, 4, 4) == 0);
    CHECK(pupil_image_bytes(PUPIL_PIXEL_I420, 5, 3) == 15 + 2 * 6 && pupil_image_bytes(PUPIL_PIXEL_P010, 4, 4) == 48 &&
          pupil_image_bytes(PUPIL_PIXEL_I444_16, 5, 3) == 90);
    return check_end();
}
