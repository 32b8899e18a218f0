/* The sinks for pictures and YUV4MPEG2, what all sinks have in common, and what they leave behind. */
#include "scratch.h"

#include "file/file_sink.h"
#include "file/sink/sink_common.h"
#include "file/still/still.h"
#include "file/video/yuv_rows.h"

#include <fcntl.h>
#include <math.h>
#include <png.h>

static pupil_why why;

static const struct {
    uint32_t width, height;
} sizes[] = {{1, 1}, {3, 5}, {641, 479}};
#define SIZES (sizeof sizes / sizeof *sizes)

static pupil_sink *open_ok(const char *path, uint32_t width, uint32_t height, double fps, int overwrite)
{
    const pupil_sink_options options = {.width = width, .height = height, .fps = fps, .overwrite = overwrite};
    pupil_sink *sink;
    why.text[0] = 0;
    CHECK_MSG(pupil_file_sink_open(path, &options, &sink, &why) == 0, "%s", why.text);
    if (!sink)
        exit(check_end());
    return sink;
}

static int put(pupil_sink *sink, pupil_image image)
{
    const pupil_image_const in = pupil_image_as_const(image);
    why.text[0] = 0;
    return pupil_sink_write(sink, &in, NULL, &why);
}

/* Compares the file's pixels, by libpng's simplified reader, with the image. */
static int png_is(const char *path, const pupil_image *image)
{
    png_image png = {.version = PNG_IMAGE_VERSION};
    int same = png_image_begin_read_from_file(&png, path) && png.width == image->width && png.height == image->height &&
               png.format == PNG_FORMAT_RGB;
    uint8_t *pixels = same ? malloc(PNG_IMAGE_SIZE(png)) : NULL;
    same = pixels && png_image_finish_read(&png, NULL, pixels, 0, NULL);
    for (uint32_t y = 0; same && y < image->height; y++)
        same = memcmp(pixels + 3 * (size_t)y * image->width, scratch_pixel(image, 0, y), 3 * image->width) == 0;
    free(pixels);
    png_image_free(&png);
    return same;
}

static char *slurp(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    struct stat s = {0};
    char *bytes;
    *size = 0;
    CHECK(f && fstat(fileno(f), &s) == 0);
    bytes = calloc(1, (size_t)s.st_size + 1);
    if (f) {
        *size = fread(bytes, 1, (size_t)s.st_size, f);
        fclose(f);
    }
    return bytes;
}

static void test_png(void)
{
    const char *path = scratch("out.png");
    for (size_t i = 0; i < 2 * SIZES; i++) {
        uint8_t *memory;
        const pupil_image image = scratch_image(sizes[i / 2].width, sizes[i / 2].height, i % 2 != 0, &memory);
        pupil_sink *sink = open_ok(path, image.width, image.height, 30, 1);
        scratch_noise(&image);
        CHECK(put(sink, image) == 0);
        CHECK_REFUSED_AT(put(sink, image), path, "one picture was asked for but the input has more frames");
        CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
        CHECK(png_is(path, &image));
        CHECK(scratch_entries(scratch_folder) == 1);
        free(memory);
    }
    size_t size;
    char *bytes = slurp(path, &size);
    CHECK(memmem(bytes, size, "\0\0\0\1sRGB\0", 9) != NULL);
    free(bytes);
    remove(path);
}

/* A BT.2020 PNG is tagged so, not as sRGB: read again, its colours are BT.2020's. */
static void test_png_bt2020(void)
{
    static const uint8_t red[3] = {255, 0, 0};
    const pupil_sink_options options = {.width = 1, .height = 1, .fps = 30, .primaries = PUPIL_PRIMARIES_BT2020};
    const char *path = scratch("wide.png");
    pupil_image image = {.width = 1, .height = 1, .pixel = PUPIL_PIXEL_RGB8, .stride_bytes = 3, .data = (void *)red};
    pupil_sink *sink;
    pupil_still still = {0};
    size_t size;
    CHECK_MSG(pupil_file_sink_open(path, &options, &sink, &why) == 0, "%s", why.text);
    CHECK(put(sink, image) == 0);
    CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
    CHECK(png_is(path, &image));
    char *bytes = slurp(path, &size);
    CHECK(memmem(bytes, size, "sRGB", 4) == NULL && memmem(bytes, size, "\0\0\0\4cICP\11\15\0\1", 12) != NULL);
    CHECK(memmem(bytes, size, "cHRM", 4) != NULL && memmem(bytes, size, "gAMA", 4) != NULL);
    CHECK_MSG(pupil_read_png(&still, (const uint8_t *)bytes, size, &why) == 0, "%s", why.text);
    const float *light = still.pixels; /* BT.2020's red in BT.709: Rep. ITU-R BT.2407-0, 2.2 */
    CHECK(still.pixel == PUPIL_PIXEL_RGB32F && fabsf(light[0] - 1.6605f) < 1e-3f && fabsf(light[1] + 0.1246f) < 1e-3f &&
          fabsf(light[2] + 0.0182f) < 1e-3f);
    pupil_still_free(&still);
    free(bytes);
    remove(path);
}

/* JPEG and TIFF files do not say which primaries they have, so any but sRGB's are refused, and nothing is left. */
static void test_srgb_alone(void)
{
    static const char *const names[] = {"wide.jpg", "wide.tif"};
    static const uint8_t red[3] = {255, 0, 0};
    const pupil_image image = {
        .width = 1, .height = 1, .pixel = PUPIL_PIXEL_RGB8, .stride_bytes = 3, .data = (void *)red};
    for (size_t i = 0; i < 4; i++) {
        const char *path = scratch(names[i / 2]);
        const pupil_sink_options options = {.width = 1,
                                            .height = 1,
                                            .fps = 30,
                                            .primaries = i % 2 ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709,
                                            .transfer = i % 2 ? PUPIL_TRANSFER_SRGB : PUPIL_TRANSFER_LINEAR};
        pupil_sink *sink;
        CHECK_MSG(pupil_file_sink_open(path, &options, &sink, &why) == 0, "%s", why.text);
        CHECK(put(sink, image) == -1 && strstr(why.text, "is written as sRGB alone"));
        pupil_sink_discard(sink);
        CHECK(!scratch_exists(path));
    }
}

/* A PNG with a transfer other than sRGB's is not tagged as sRGB. */
static void test_png_transfer(void)
{
    static const uint8_t grey[3] = {51, 51, 51};
    pupil_image image = {.width = 1, .height = 1, .pixel = PUPIL_PIXEL_RGB8, .stride_bytes = 3, .data = (void *)grey};
    const double light[PUPIL_TRANSFER_COUNT] = {
        [PUPIL_TRANSFER_GAMMA22] = pow(0.2, 2.2), [PUPIL_TRANSFER_LINEAR] = 0.2};
    for (uint32_t i = 0; i < 4; i++) {
        const uint32_t transfer = i % 2 ? PUPIL_TRANSFER_GAMMA22 : PUPIL_TRANSFER_LINEAR;
        const pupil_sink_options options = {
            .width = 1, .height = 1, .fps = 30, .overwrite = 1, .transfer = transfer, .primaries = i / 2};
        pupil_sink *sink;
        pupil_still still = {0};
        size_t size;
        CHECK_MSG(pupil_file_sink_open(scratch("curve.png"), &options, &sink, &why) == 0, "%s", why.text);
        CHECK(put(sink, image) == 0);
        CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
        char *bytes = slurp(scratch("curve.png"), &size);
        CHECK_MSG(pupil_read_png(&still, (const uint8_t *)bytes, size, &why) == 0, "%s", why.text);
        const float *at = still.pixels;
        CHECK(still.pixel == PUPIL_PIXEL_RGB32F && fabs((double)at[0] - light[transfer]) < 1e-5 &&
              fabs((double)at[2] - light[transfer]) < 1e-5);
        pupil_still_free(&still);
        free(bytes);
        remove(scratch("curve.png"));
    }
}

static void test_folder(void)
{
    const char *path = scratch("out");
    uint8_t *memory[3];
    pupil_image image[3];
    for (int i = 0; i < 3; i++) {
        image[i] = scratch_image(7, 5, i == 1, &memory[i]);
        scratch_noise(&image[i]);
    }
    pupil_sink *sink = open_ok(scratch("out/"), 7, 5, 30, 0);
    for (int i = 0; i < 3; i++)
        CHECK(put(sink, image[i]) == 0);
    CHECK(!scratch_exists(path));
    CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
    CHECK(png_is(scratch("out/frame_000000.png"), &image[0]) && png_is(scratch("out/frame_000001.png"), &image[1]) &&
          png_is(scratch("out/frame_000002.png"), &image[2]));
    CHECK(scratch_entries(path) == 3 && scratch_entries(scratch_folder) == 1);

    const pupil_sink_options options = {.width = 7, .height = 5, .fps = 30};
    CHECK_REFUSED_AT(pupil_file_sink_open(path, &options, &sink, &why), path, "not empty");
    sink = open_ok(path, 7, 5, 30, 1);
    CHECK(put(sink, image[2]) == 0);
    CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
    CHECK(png_is(scratch("out/frame_000000.png"), &image[2]));
    CHECK(scratch_entries(path) == 1 && scratch_entries(scratch_folder) == 1);
    scratch_clear(path);
    for (int i = 0; i < 3; i++)
        free(memory[i]);
}

/* The formula of yuv_rows.h in double, unrounded. */
static double exact_yuv(pupil_yuv_matrix matrix, int plane, double r, double g, double b)
{
    const int is_601 = matrix == PUPIL_YUV_601;
    const double y = is_601 ? 0.299 * r + 0.587 * g + 0.114 * b : 0.2126 * r + 0.7152 * g + 0.0722 * b;
    if (plane == PUPIL_YUV_Y)
        return 16 + 219.0 / 255 * y;
    return 128 +
           224.0 / 255 *
               (plane == PUPIL_YUV_CB ? (b - y) / (is_601 ? 1.772 : 1.8556) : (r - y) / (is_601 ? 1.402 : 1.5748));
}

/* All 2^24 colours. */
static void test_yuv709(void)
{
    static uint8_t rgb[256 * 3], out[256];
    unsigned long off = 0, far = 0, coloured_grey = 0;
    for (int rg = 0; rg < 65536; rg++) {
        for (int b = 0; b < 256; b++) {
            rgb[3 * b] = (uint8_t)(rg >> 8);
            rgb[3 * b + 1] = (uint8_t)rg;
            rgb[3 * b + 2] = (uint8_t)b;
        }
        for (int plane = 0; plane < 3; plane++) {
            pupil_yuv_row(PUPIL_YUV_709, (pupil_yuv_plane)plane, rgb, 256, out);
            for (int b = 0; b < 256; b++) {
                const double exact = exact_yuv(PUPIL_YUV_709, plane, rg >> 8, rg & 255, b);
                off += out[b] != (int)floor(exact + 0.5);
                far += fabs(out[b] - exact) > 0.503; /* as yuv_rows.h says */
                coloured_grey += plane > 0 && rg >> 8 == b && (rg & 255) == b && out[b] != 128;
            }
        }
    }
    printf("yuv709: %lu of %d samples are not the formula rounded\n", off, 3 << 24);
    CHECK(far == 0);
    CHECK(coloured_grey == 0);
    CHECK(off < 3 * (1 << 24) / 5000); /* 0.02 %, as yuv_rows.h says */
}

/* 4:2:0 against the mean of the pixels' exact chroma, columns 1 2 1, rows 1 1, edges repeated. */
static void test_chroma420(void)
{
    for (uint32_t width = 1; width <= 9; width++) {
        uint8_t rows[2][27], out[5];
        for (int i = 0; i < 54; i++)
            rows[i / 27][i % 27] = (uint8_t)check_random();
        for (int plane = 1; plane < 3; plane++) {
            pupil_yuv709_chroma420_row((pupil_yuv_plane)plane, rows[0], rows[1], width, out);
            for (uint32_t x = 0; x < width; x += 2) {
                double sum = 0;
                for (int i = -1; i <= 1; i++) {
                    const int at = (int)x + i < 0 ? 0 : (int)x + i >= (int)width ? (int)width - 1 : (int)x + i;
                    for (int row = 0; row < 2; row++)
                        sum += (i ? 1 : 2) / 8.0 *
                               exact_yuv(PUPIL_YUV_709, plane, rows[row][3 * at], rows[row][3 * at + 1],
                                         rows[row][3 * at + 2]);
                }
                CHECK_MSG(fabs(out[x / 2] - sum) <= 0.503, "width %u x %u: %d %g", width, x, out[x / 2], sum);
            }
        }
    }
}

static void test_y4m_frames(const char *path, const char *header, uint32_t width, uint32_t height, double fps)
{
    uint8_t *memory;
    const pupil_image image = scratch_image(width, height, width % 4 == 3, &memory);
    const size_t pixels = (size_t)width * height;
    const pupil_yuv_matrix matrix =
        width >= 1280 || height > 576 ? PUPIL_YUV_709 : PUPIL_YUV_601; /* as players take it */
    pupil_sink *sink = open_ok(path, width, height, fps, 0);
    char text[256];
    size_t size, at;
    scratch_noise(&image);
    CHECK(put(sink, image) == 0 && put(sink, image) == 0);
    CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
    uint8_t *bytes = (uint8_t *)slurp(path, &size);
    at = (size_t)snprintf(text, sizeof text, "YUV4MPEG2 W%u H%u %s Ip A1:1 C444 XCOLORRANGE=LIMITED\n", width, height,
                          header);
    const int whole = size == at + 2 * (6 + 3 * pixels);
    CHECK_MSG(whole && memcmp(bytes, text, at) == 0, "%zu bytes, %.80s", size, bytes);
    for (int frame = 0; frame < 2 && whole; frame++) {
        CHECK(memcmp(bytes + at, "FRAME\n", 6) == 0);
        at += 6;
        for (int plane = 0; plane < 3; plane++)
            for (size_t i = 0; i < pixels; i++, at++) {
                const uint8_t *p = scratch_pixel(&image, (uint32_t)(i % width), (uint32_t)(i / width));
                if (fabs(bytes[at] - exact_yuv(matrix, plane, p[0], p[1], p[2])) > 0.503)
                    CHECK_MSG(0, "frame %d plane %d sample %zu", frame, plane, i);
            }
    }
    free(bytes);
    free(memory);
    remove(path);
}

static void test_y4m(void)
{
    const char *path = scratch("out.y4m");
    for (size_t i = 0; i < SIZES; i++)
        test_y4m_frames(path, "F30:1", sizes[i].width, sizes[i].height, 30);
    test_y4m_frames(path, "F30:1", 3, 576, 30);
    test_y4m_frames(path, "F30:1", 3, 577, 30);
    test_y4m_frames(path, "F30:1", 1279, 3, 30);
    test_y4m_frames(path, "F30:1", 1280, 3, 30);
    test_y4m_frames(path, "F30000:1001", 2, 2, 29.97);
    test_y4m_frames(path, "F30000:1001", 2, 2, 30000.0 / 1001);
    test_y4m_frames(path, "F24000:1001", 2, 2, 23.976);
    test_y4m_frames(path, "F25:2", 2, 2, 12.5);
    test_y4m_frames(path, "F1:60", 2, 2, 1.0 / 60);
    test_y4m_frames(path, "F10000:333", 2, 2, 1 / 0.0333);
}

/* Writes two frames to standard output, which is `fd`; returns the last call's result. */
static int to_stdout(int fd, int frames)
{
    const int saved = dup(STDOUT_FILENO);
    const pupil_sink_options options = {.width = 200, .height = 200, .fps = 30};
    uint8_t *memory;
    const pupil_image image = scratch_image(200, 200, 0, &memory);
    pupil_sink *sink = NULL;
    int failed;
    scratch_noise(&image);
    fflush(stdout);
    dup2(fd, STDOUT_FILENO);
    why.text[0] = 0;
    failed = pupil_file_sink_open("-", &options, &sink, &why);
    for (int i = 0; i < frames && !failed; i++)
        failed = put(sink, image);
    if (!failed)
        failed = pupil_sink_finish(sink, &why);
    if (failed)
        pupil_sink_discard(sink);
    dup2(saved, STDOUT_FILENO);
    close(saved);
    free(memory);
    return failed;
}

static void test_stdout(void)
{
    int ends[2], fd = open(scratch("stream"), O_RDWR | O_CREAT, 0666);
    size_t size;
    CHECK(to_stdout(fd, 2) == 0);
    close(fd);
    char *bytes = slurp(scratch("stream"), &size);
    CHECK(strncmp(bytes, "YUV4MPEG2 W200 H200 F30:1 ", 26) == 0);
    CHECK(size == strlen("YUV4MPEG2 W200 H200 F30:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n") + 2 * (6 + 120000));
    free(bytes);
    remove(scratch("stream"));

    signal(SIGPIPE, SIG_IGN); /* as in the program */
    CHECK(pipe(ends) == 0);
    close(ends[0]);
    CHECK_REFUSED_AT(to_stdout(ends[1], 2), "standard output", "reader is gone");
    close(ends[1]);
    if ((fd = open("/dev/full", O_WRONLY)) >= 0) {
        CHECK_REFUSED_AT(to_stdout(fd, 2), "standard output", "No space left");
        close(fd);
    }
    if ((fd = posix_openpt(O_RDWR | O_NOCTTY)) >= 0 && grantpt(fd) == 0 && unlockpt(fd) == 0) {
        const int terminal = open(ptsname(fd), O_RDWR | O_NOCTTY);
        if (terminal >= 0)
            CHECK_REFUSED_AT(to_stdout(terminal, 2), "standard output", "terminal");
        close(terminal);
    }
    close(fd);
    fd = open("/dev/null", O_WRONLY);
    CHECK_REFUSED_AT(to_stdout(fd, 0), "standard output", "no frame");
    close(fd);
}

static const char *const outputs[] = {"out.mp4", "out.mkv", "out.mov", "out.y4m", "out.png", "out"};
#define OUTPUTS (sizeof outputs / sizeof *outputs)

static void test_refused_opens(void)
{
    static const char *const unknown[] = {"out.avi", "out.txt", "out.mp4.", "out.bmp", "dir.v1/out.gif"};
    const pupil_sink_options good = {.width = 4, .height = 4, .fps = 30};
    pupil_sink *sink;
    for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++) {
        CHECK_REFUSED_AT(pupil_file_sink_open(unknown[i], &good, &sink, &why), unknown[i], ".mp4, .mkv or .mov");
        CHECK(!sink);
    }
    CHECK_REFUSED_AT(pupil_file_sink_open("", &good, &sink, &why), "\"\"", "needs a name");
    scratch_put(scratch("file"), "");
    for (size_t i = 0; i < OUTPUTS; i++) {
        const pupil_sink_options wide = {.width = 16385, .height = 4, .fps = 30}, none = {.width = 4, .fps = 30},
                                 nan = {.width = 4, .height = 4, .fps = NAN},
                                 fast = {.width = 4, .height = 4, .fps = INFINITY}, still = {.width = 4, .height = 4};
        const char *path = scratch(outputs[i]);
        char nowhere[64], through[64];
        snprintf(nowhere, sizeof nowhere, "missing/%s", outputs[i]);
        snprintf(through, sizeof through, "file/%s", outputs[i]);
        CHECK_REFUSED_AT(pupil_file_sink_open(path, &wide, &sink, &why), path, "16385 x 4");
        CHECK_REFUSED_AT(pupil_file_sink_open(path, &none, &sink, &why), path, "4 x 0");
        CHECK_REFUSED_AT(pupil_file_sink_open(path, &nan, &sink, &why), path, "nan frames a second");
        CHECK_REFUSED_AT(pupil_file_sink_open(path, &fast, &sink, &why), path, "inf frames a second");
        CHECK_REFUSED_AT(pupil_file_sink_open(path, &still, &sink, &why), path, "0 frames a second");
        CHECK_REFUSED_AT(pupil_file_sink_open(scratch(nowhere), &good, &sink, &why), scratch(nowhere),
                         "there is no folder");
        CHECK_REFUSED_AT(pupil_file_sink_open(scratch(through), &good, &sink, &why), scratch(through), "is a file");
        CHECK(!sink && scratch_entries(scratch_folder) == 1);
    }
    remove(scratch("file"));
}

/* Frames that do not fit, inputs without frames, discarded runs, full disks: nothing is left. */
static void test_nothing_left(void)
{
    uint8_t *memory, *small_memory;
    const pupil_image image = scratch_image(160, 120, 0, &memory), small = scratch_image(159, 120, 0, &small_memory);
    pupil_image other = image;
    other.pixel = PUPIL_PIXEL_BGRX8;
    scratch_noise(&image);
    for (size_t i = 0; i < OUTPUTS; i++) {
        const char *path = scratch(outputs[i]);
        pupil_sink *sink = open_ok(path, 160, 120, 30, 0);
        CHECK_REFUSED_AT(pupil_sink_finish(sink, &why), path, "no frame");
        pupil_sink_discard(sink);
        CHECK(scratch_entries(scratch_folder) == 0);

        sink = open_ok(path, 160, 120, 30, 0);
        CHECK_REFUSED_AT(put(sink, small), path, "159 x 120");
        CHECK_REFUSED_AT(put(sink, other), path, "pixel format");
        CHECK(put(sink, image) == 0);
        CHECK(!scratch_exists(path));
        pupil_sink_discard(sink);
        CHECK(scratch_entries(scratch_folder) == 0);

        for (unsigned long limit = 1; limit < 20000; limit = 20 * limit + 1) { /* in the header, the first frame ... */
            int failed = 0;
            sink = open_ok(path, 160, 120, 30, 0);
            scratch_limit(limit);
            for (int n = 0; n < 3 && !failed; n++)
                failed = put(sink, image);
            if (!failed)
                failed = pupil_sink_finish(sink, &why);
            scratch_limit(0);
            CHECK_MSG(failed == -1 && strncmp(why.text, path, strlen(path)) == 0 &&
                          strstr(why.text, "cannot be written"),
                      "%s, %lu bytes: %d %s", path, limit, failed, why.text);
            if (failed)
                pupil_sink_discard(sink);
            CHECK(scratch_entries(scratch_folder) == 0);
        }
    }
    free(memory);
    free(small_memory);
}

/* A live output on a full disk keeps its complete frames, and says how many. */
static void test_live_full(void)
{
    uint8_t *memory;
    const pupil_image image = scratch_image(64, 48, 0, &memory);
    const size_t frame_bytes = 6 + 3 * 64 * 48;
    for (int is_folder = 0; is_folder <= 1; is_folder++) {
        const char *path = scratch(is_folder ? "live" : "live.y4m");
        const pupil_sink_options options = {.width = 64, .height = 48, .fps = 30, .live = 1};
        pupil_sink *sink;
        size_t size;
        CHECK_MSG(pupil_file_sink_open(path, &options, &sink, &why) == 0, "%s", why.text);
        memset(memory, 0, 48 * (size_t)image.stride_bytes); /* a PNG of 100 bytes; noise has 9000 */
        CHECK(put(sink, image) == 0 && scratch_exists(path) == !is_folder && put(sink, image) == 0);
        scratch_noise(&image);
        scratch_limit(is_folder ? 5000 : 100 + frame_bytes * 5 / 2);
        CHECK_REFUSED_AT(put(sink, image), path, "; the 2 frames before are kept");
        scratch_limit(0);
        CHECK_MSG(strstr(why.text, "cannot be written: File too large; "), "%s", why.text);
        pupil_sink_discard(sink);
        CHECK(scratch_entries(scratch_folder) == 1);
        if (is_folder) {
            CHECK(scratch_entries(path) == 2 && scratch_exists(scratch("live/frame_000001.png")));
            scratch_clear(path);
            continue;
        }
        char *bytes = slurp(path, &size);
        CHECK_MSG(size == strcspn(bytes, "\n") + 1 + 2 * frame_bytes, "%zu bytes", size);
        free(bytes);
        remove(path);
    }
    free(memory);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_png();
    test_png_bt2020();
    test_srgb_alone();
    test_png_transfer();
    test_folder();
    test_yuv709();
    test_chroma420();
    test_y4m();
    test_stdout();
    test_refused_opens();
    test_nothing_left();
    test_live_full();
    CHECK(scratch_entries(scratch_folder) == 0);
    scratch_clear(scratch_folder);
    return check_end();
}
