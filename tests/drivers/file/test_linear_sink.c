/* Linear pictures: our own readers (for EXR: the OpenEXR library) read back what was written. */
#include "file/sink/picture_sink.h"

#include <math.h>

#include "file/file_source.h"
#include "scratch.h"

enum { MOST = 300 };
static float picture[MOST * 9 * 3];

static pupil_image_const make(uint32_t width, uint32_t height, int turned)
{
    for (uint32_t i = 0; i < width * height * 3; i++)
        picture[i] = (float)(check_uniform() * pow(2.0, (double)(check_random() % 40) - 20.0));
    picture[0] = 0.0f;
    ptrdiff_t stride = (ptrdiff_t)(width * 3 * sizeof(float));
    pupil_image_const image = {
        .data = picture, .stride_bytes = stride, .width = width, .height = height, .pixel = PUPIL_PIXEL_RGB32F};
    if (turned) { /* the last row first */
        image.data = (const unsigned char *)image.data + (ptrdiff_t)(height - 1) * stride;
        image.stride_bytes = -stride;
    }
    return image;
}

static const float *row_of(const pupil_image_const *image, uint32_t y)
{
    return (const float *)(const void *)((const unsigned char *)image->data + (ptrdiff_t)y * image->stride_bytes);
}

static void read_back(const char *path, const pupil_image_const *image, int exact)
{
    pupil_source *source;
    pupil_source_options options = {0};
    pupil_frame frame;
    pupil_why why = {""};
    CHECK_MSG(pupil_file_source_open(&path, 1, &options, &source, &why) == 0, "%s", why.text);
    CHECK_MSG(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
    CHECK(frame.image.width == image->width && frame.image.height == image->height);
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            const float *a = row_of(image, y) + 3 * x;
            const unsigned char *at = (const unsigned char *)frame.image.data +
                                      (ptrdiff_t)y * frame.image.stride_bytes +
                                      x * pupil_pixel_bytes(frame.image.pixel);
            const float *b = (const float *)(const void *)at;
            float most = fmaxf(a[0], fmaxf(a[1], a[2]));
            for (int c = 0; c < 3; c++) /* RGBE: a step of the brightest channel's mantissa, 1/128 at worst */
                CHECK_MSG(exact ? a[c] == b[c] : fabsf(a[c] - b[c]) <= most / 128, "%s %u,%u: %a, not %a", path, x, y,
                          b[c], a[c]);
        }
    pupil_source_done(source, &frame);
    pupil_source_close(source);
}

static void files(void)
{
    static const char *const names[] = {"a.exr", "a.pfm", "a.hdr"};
    static const uint32_t sizes[][2] = {{1, 1}, {7, 5}, {8, 9}, {130, 3}, {MOST, 9}};
    pupil_why why = {""};
    for (int n = 0; n < 3; n++)
        for (int i = 0; i < 5; i++) {
            pupil_image_const image = make(sizes[i][0], sizes[i][1], i % 2);
            pupil_sink_options options = {.width = sizes[i][0], .height = sizes[i][1], .fps = 30.0, .overwrite = 1};
            pupil_frame_info info = {0};
            pupil_sink *sink;
            CHECK_MSG(pupil_linear_sink_open(scratch(names[n]), &options, &sink, &why) == 0, "%s", why.text);
            CHECK_MSG(pupil_sink_write(sink, &image, &info, &why) == 0, "%s", why.text);
            CHECK(pupil_sink_write(sink, &image, &info, &why) == PUPIL_SINK_FAILED && strstr(why.text, "folder"));
            CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
            read_back(scratch(names[n]), &image, n < 2);
        }
    CHECK(scratch_entries(scratch_folder) == 3);
}

static void a_folder(void)
{
    pupil_image_const image = make(6, 4, 0);
    pupil_sink_options options = {.width = 6, .height = 4, .fps = 30.0};
    pupil_why why = {""};
    pupil_sink *sink;
    for (int pass = 0; pass < 2; pass++) {
        options.overwrite = pass; /* a folder of EXR files may be replaced */
        CHECK_MSG(pupil_linear_sink_open(scratch("frames"), &options, &sink, &why) == 0, "%s", why.text);
        for (uint64_t n = 8; n < 11; n++) {
            pupil_frame_info info = {.sequence = n};
            CHECK_MSG(pupil_sink_write(sink, &image, &info, &why) == 0, "%s", why.text);
        }
        CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
        CHECK(scratch_entries(scratch("frames")) == 3);
        read_back(scratch("frames/frame_000008.exr"), &image, 1);
    }
    options.overwrite = 0;
    CHECK(pupil_linear_sink_open(scratch("frames"), &options, &sink, &why) && strstr(why.text, "not empty"));
    CHECK(pupil_linear_sink_open(scratch("a.jpg"), &options, &sink, &why) && strstr(why.text, ".exr"));
    CHECK(pupil_linear_sink_open(scratch("none/a.exr"), &options, &sink, &why) && strstr(why.text, "none"));
    CHECK(pupil_linear_sink_open(scratch("b.exr"), &options, &sink, &why) == 0);
    CHECK(pupil_sink_finish(sink, &why) && strstr(why.text, "nothing was written"));
    pupil_sink_discard(sink);
    CHECK(pupil_linear_sink_open(scratch("b.exr"), &options, &sink, &why) == 0);
    image.width = 5;
    CHECK(pupil_sink_write(sink, &image, &(pupil_frame_info){0}, &why) && strstr(why.text, "6x4"));
    pupil_sink_discard(sink);
    CHECK(scratch_entries(scratch_folder) == 4);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    files();
    a_folder();
    scratch_clear(scratch_folder);
    return check_end();
}
