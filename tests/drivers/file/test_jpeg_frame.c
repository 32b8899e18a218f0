/* Frames of MJPG: every sample is as written, in every sampling and at difficult sizes; damaged frames are refused. */
#include "check.h"
#include "write_jpeg.h"

#include <math.h>

#include "file/video/jpeg_frame.h"

static uint8_t written[1 << 20], broken[1 << 20];
static pupil_why why;

/* The value at a pixel of a component as it was written. */
static uint8_t sample(const flat_jpeg *j, uint32_t c, uint32_t x, uint32_t y)
{
    const uint32_t across = c ? j->across : 1, down = c ? j->down : 1;
    return flat_value(j, c, x / across / 8, y / down / 8);
}

static uint8_t clamp(double v)
{
    return (uint8_t)fmin(255, fmax(0, floor(v + 0.5)));
}

/* JFIF 1.02, "Conversion to and from RGB". */
static int is_rgb(const flat_jpeg *j, uint32_t x, uint32_t y, const uint8_t *rgb)
{
    const double l = sample(j, 0, x, y), cb = sample(j, 1, x, y) - 128.0, cr = sample(j, 2, x, y) - 128.0;
    const uint8_t want[3] = {clamp(l + 1.402 * cr), clamp(l - 0.344136 * cb - 0.714136 * cr), clamp(l + 1.772 * cb)};
    for (int i = 0; i < 3; i++)
        if (abs(want[i] - rgb[i]) > 1) /* the coefficients have six digits there */
            return 0;
    return 1;
}

static int is_pixel(const flat_jpeg *j, const pupil_image_const *image, uint32_t x, uint32_t y)
{
    const uint8_t *row = (const uint8_t *)image->data + (ptrdiff_t)y * image->stride_bytes;
    if (image->pixel == PUPIL_PIXEL_GREY8)
        return row[x] == sample(j, 0, x, y);
    if (image->pixel == PUPIL_PIXEL_RGB8)
        return is_rgb(j, x, y, row + 3 * x);
    const uint8_t *chroma =
        image->pixel == PUPIL_PIXEL_YUYV
            ? row + x / 2 * 4 + 1
            : (const uint8_t *)image->chroma + (ptrdiff_t)(y / 2) * image->chroma_stride_bytes + x / 2 * 2;
    const uint8_t cr = chroma[image->pixel == PUPIL_PIXEL_YUYV ? 2 : 1];
    return row[image->pixel == PUPIL_PIXEL_YUYV ? 2 * x : x] == sample(j, 0, x, y) && chroma[0] == sample(j, 1, x, y) &&
           cr == sample(j, 2, x, y);
}

static void check_image(const flat_jpeg *j, const pupil_image_const *image)
{
    const uint32_t pixel = j->components == 1               ? PUPIL_PIXEL_GREY8
                           : j->across == 2 && j->down == 1 ? PUPIL_PIXEL_YUYV
                           : j->across == 2 && j->down == 2 ? PUPIL_PIXEL_NV12
                                                            : PUPIL_PIXEL_RGB8;
    unsigned wrong = 0;
    CHECK(image->pixel == pixel && image->width == j->width && image->height == j->height && image->coding);
    CHECK(image->coding->range == PUPIL_RANGE_FULL && image->coding->matrix == PUPIL_MATRIX_BT601);
    CHECK(image->coding->light == PUPIL_LIGHT_SRGB && pupil_coding_check(image->coding, pixel, NULL) == PUPIL_OK);
    for (uint32_t y = 0; y < j->height; y++)
        for (uint32_t x = 0; x < j->width; x++)
            wrong += !is_pixel(j, image, x, y);
    CHECK_MSG(wrong == 0, "%u x %u, %u components %u:%u: %u wrong", j->width, j->height, j->components, j->across,
              j->down, wrong);
}

static pupil_jpeg *begin(const flat_jpeg *j)
{
    pupil_jpeg *jpeg = NULL;
    CHECK_MSG(pupil_jpeg_open(&jpeg, j->width, j->height, NULL, &why) == 0, "%s", why.text);
    if (!jpeg)
        abort();
    return jpeg;
}

static void check_decoded(pupil_jpeg *jpeg, const flat_jpeg *j, const uint8_t *bytes, size_t size)
{
    pupil_image_const image;
    const int result = pupil_jpeg_decode(jpeg, bytes, size, &image, &why);
    CHECK_MSG(result == 0, "%u x %u, %u:%u: %s", j->width, j->height, j->across, j->down, why.text);
    if (result == 0)
        check_image(j, &image);
}

static void test_shapes(void)
{
    static const uint32_t sizes[][2] = {{1, 1},  {2, 1},   {1, 2},   {3, 5},    {8, 8},     {9, 7},
                                        {16, 8}, {17, 33}, {64, 48}, {321, 17}, {16384, 3}, {3, 16384}};
    static const uint32_t samplings[][3] = {{1, 1, 1}, {3, 1, 1}, {3, 2, 1}, {3, 2, 2}, {3, 1, 2}, {3, 4, 1}};
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
        for (size_t k = 0; k < sizeof samplings / sizeof samplings[0]; k++) {
            flat_jpeg j = {.width = sizes[s][0],
                           .height = sizes[s][1],
                           .components = samplings[k][0],
                           .across = samplings[k][1],
                           .down = samplings[k][2]};
            pupil_jpeg *jpeg = begin(&j);
            for (int i = 0; i < 3; i++) {
                j.seed = check_random();
                check_decoded(jpeg, &j, written, flat_write(&j, written));
            }
            pupil_jpeg_close(jpeg);
        }
}

/* A frame's own tables apply only to it; unknown segments are skipped; the sampling may change. */
static void test_kinds(void)
{
    flat_jpeg j = {.width = 40, .height = 24, .components = 3, .across = 2, .down = 1};
    pupil_jpeg *jpeg = begin(&j);
    for (int i = 0; i < 64; i++) {
        j.own_tables = i & 1;
        j.standard_tables = !j.own_tables && i & 2;
        j.progressive = (j.own_tables || j.standard_tables) && i & 4;
        j.extras = (i & 8) != 0;
        j.down = i & 16 ? 2 : 1;
        j.components = i & 32 ? 1 : 3;
        j.seed = check_random();
        size_t size = flat_write(&j, written);
        memset(written + size, 0, 100); /* drivers that hand out the whole buffer */
        check_decoded(jpeg, &j, written, i % 3 ? size : size + 100);
    }
    pupil_jpeg_close(jpeg);
}

static void test_codings(void)
{
    const pupil_coding coding = {
        .matrix = PUPIL_MATRIX_BT709, .range = PUPIL_RANGE_LIMITED, .light = PUPIL_LIGHT_BT709};
    const pupil_coding wrong = {.matrix = 99};
    flat_jpeg j = {.width = 16, .height = 16, .components = 3, .across = 2, .down = 1};
    pupil_image_const image;
    pupil_jpeg *jpeg;
    CHECK(pupil_jpeg_open(&jpeg, 16, 16, &coding, &why) == 0);
    CHECK(pupil_jpeg_decode(jpeg, written, flat_write(&j, written), &image, &why) == 0);
    CHECK(image.coding->matrix == coding.matrix && image.coding->range == coding.range);
    CHECK(image.coding->light == coding.light);
    j.components = 1;
    CHECK(pupil_jpeg_decode(jpeg, written, flat_write(&j, written), &image, &why) == 0);
    CHECK(image.coding->light == coding.light && image.coding->black == 16 && image.coding->white == 235);
    j.components = 3, j.across = 1; /* RGB8 is sRGB's */
    CHECK(pupil_jpeg_decode(jpeg, written, flat_write(&j, written), &image, &why) == -1);
    CHECK_MSG(strstr(why.text, "whose light is not sRGB's"), "%s", why.text);
    pupil_jpeg_close(jpeg);
    CHECK(pupil_jpeg_open(&jpeg, 16, 16, &wrong, &why) == -1 && !jpeg && strstr(why.text, "matrix"));
    CHECK(pupil_jpeg_open(&jpeg, 0, 16, NULL, &why) == -1 && strstr(why.text, "0 x 16 pixels; 1 to 16384"));
    CHECK(pupil_jpeg_open(&jpeg, 16, 16385, NULL, &why) == -1);
    pupil_jpeg_close(NULL);
}

/* Refused by one sentence; the next complete frame is decoded as usual. */
static void check_refused(pupil_jpeg *jpeg, const uint8_t *bytes, size_t size, const char *sentence)
{
    pupil_image_const image;
    why.text[0] = 0;
    CHECK_MSG(pupil_jpeg_decode(jpeg, bytes, size, &image, &why) == -1, "%zu bytes are taken", size);
    CHECK_MSG(strlen(why.text) > 10 && !strchr(why.text, '\n') && strstr(why.text, sentence), "'%s' for '%s'", why.text,
              sentence);
}

static void test_cut(void)
{
    for (int kind = 0; kind < 4; kind++) {
        const flat_jpeg j = {.width = 64,
                             .height = 40,
                             .components = 3,
                             .across = 2,
                             .down = kind & 1 ? 2 : 1,
                             .extras = kind < 2,
                             .standard_tables = kind == 3,
                             .seed = check_random()};
        const size_t size = flat_write(&j, written);
        pupil_jpeg *jpeg = begin(&j);
        for (size_t cut = 0; cut < size; cut++) {
            uint8_t *exact = malloc(cut + 1); /* so that reading a byte too many is seen */
            if (!exact)
                abort();
            memcpy(exact + 1, written, cut);
            check_refused(jpeg, exact + 1, cut, "JPEG");
            free(exact);
        }
        check_decoded(jpeg, &j, written, size);
        pupil_jpeg_close(jpeg);
    }
}

static void test_refusals(void)
{
    flat_jpeg j = {.width = 32, .height = 16, .components = 3, .across = 2, .down = 1};
    pupil_jpeg *jpeg = begin(&j);
    const size_t size = flat_write(&j, written);
    const size_t frame = 2 + 69; /* where its frame header begins */
    check_refused(jpeg, (const uint8_t *)"", 0, "no JPEG: its 0 bytes do not begin with one");
    memset(broken, 0, size);
    check_refused(jpeg, broken, size, "do not begin with one");
    memcpy(broken, written, size);
    broken[frame + 4] = 12;
    check_refused(jpeg, broken, size, "a JPEG of 12 bits; 8 can be read");
    broken[frame + 4] = 8, broken[frame + 1] = 0xc3;
    check_refused(jpeg, broken, size, "a JPEG of process 3; baseline and progressive ones");
    broken[frame + 1] = 0xc0, broken[frame + 6] = 17;
    check_refused(jpeg, broken, size, "a JPEG of 32 x 17 pixels; 32 x 16 were expected");
    broken[frame + 6] = 0;
    check_refused(jpeg, broken, size, "its frame header says 32 x 0 pixels");
    memcpy(broken + 2, written + frame, size - frame);
    check_refused(jpeg, broken, size - frame + 2, "no quantisation table before its picture");
    broken[0] = 0xff, broken[1] = 0xd8, broken[2] = 0xff, broken[3] = 0xd9;
    check_refused(jpeg, broken, 4, "there is no picture in its 4 bytes");
    check_decoded(jpeg, &j, written, size);
    pupil_jpeg_close(jpeg);
}

/* Damaged anywhere: a picture with all its bytes readable, or a sentence. */
static void test_damage(void)
{
    const flat_jpeg j = {.width = 72,
                         .height = 33,
                         .components = 3,
                         .across = 2,
                         .down = 1,
                         .standard_tables = 1,
                         .seed = check_random()};
    const size_t size = flat_write(&j, written);
    unsigned refused = 0;
    pupil_jpeg *jpeg = begin(&j);
    for (int i = 0; i < 3000; i++) {
        pupil_image_const image;
        memcpy(broken, written, size);
        for (uint64_t k = 1 + check_random() % 4; k-- > 0;)
            broken[check_random() % size] = (uint8_t)check_random();
        if (i % 8 == 0) /* no JPEG at all, behind its first bytes */
            for (size_t k = 4; k < size; k++)
                broken[k] = (uint8_t)check_random();
        why.text[0] = 0;
        if (pupil_jpeg_decode(jpeg, broken, size, &image, &why)) {
            CHECK_MSG(strlen(why.text) > 10 && !strchr(why.text, '\n'), "'%s'", why.text);
            refused++;
            continue;
        }
        uint64_t sum = 0;
        for (uint32_t y = 0; y < image.height; y++)
            for (size_t x = 0; x < pupil_row_bytes(image.pixel, image.width); x++)
                sum += ((const uint8_t *)image.data)[(ptrdiff_t)y * image.stride_bytes + (ptrdiff_t)x];
        CHECK(image.width == 72 && image.height == 33 && sum <= UINT64_C(255) * 72 * 33 * 3);
    }
    CHECK_MSG(refused > 500 && refused < 3000, "%u refused", refused);
    check_decoded(jpeg, &j, written, size);
    pupil_jpeg_close(jpeg);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_shapes();
    test_kinds();
    test_codings();
    test_cut();
    test_refusals();
    test_damage();
    return check_end();
}
