/* drivers/file/recording/recording_format.c: pixel formats as bytes in a recording. */
#include "recording_format.h"

#include <string.h>
#include <sys/stat.h>

#include "recording.h"
#include "refuse.h"

/* The largest frame that libavformat reads from Matroska (libavformat/matroskadec.c, max_lengths, less a block's
 * head). */
#define FRAME_MOST_BYTES ((UINT32_C(1) << 28) - 4)

#define FOUR(a, b, c, d) ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

typedef struct kept {
    const char *name;
    uint32_t fourcc;
    uint8_t unit, mosaic; /* the width is a multiple of unit, and a mosaic's height is even */
} kept;

/* The codes are those by which FFmpeg knows its raw formats (avcodec_pix_fmt_to_codec_tag: yuyv422, nv12, gray, ...,
 * rgba64le). Formats without an FFmpeg code: half floats have DRM's (AB4H), floats have letters and bits a pixel in
 * FFmpeg's style, packed mosaics have V4L2's, which depends on the order. */
static const kept formats[PUPIL_PIXEL_COUNT] = {
    [PUPIL_PIXEL_RGBA32F] = {"rgba32f", FOUR('R', 'B', 'A', 128), 1, 0},
    [PUPIL_PIXEL_RGB32F] = {"rgb32f", FOUR('R', 'G', 'B', 96), 1, 0},
    [PUPIL_PIXEL_RGBA16F] = {"rgba16f", FOUR('A', 'B', '4', 'H'), 1, 0},
    [PUPIL_PIXEL_RGBA16] = {"rgba16", FOUR('R', 'B', 'A', 64), 1, 0},
    [PUPIL_PIXEL_RGB16] = {"rgb16", FOUR('R', 'G', 'B', 48), 1, 0},
    [PUPIL_PIXEL_RGBA8] = {"rgba8", FOUR('R', 'G', 'B', 'A'), 1, 0},
    [PUPIL_PIXEL_RGB8] = {"rgb8", FOUR('R', 'G', 'B', 24), 1, 0},
    [PUPIL_PIXEL_YUYV] = {"yuyv", FOUR('Y', 'U', 'Y', '2'), 1, 0},
    [PUPIL_PIXEL_NV12] = {"nv12", FOUR('N', 'V', '1', '2'), 1, 0},
    [PUPIL_PIXEL_NV21] = {"nv21", FOUR('N', 'V', '2', '1'), 1, 0},
    [PUPIL_PIXEL_NV16] = {"nv16", FOUR('N', 'V', '1', '6'), 1, 0},
    [PUPIL_PIXEL_I420] = {"i420", FOUR('I', '4', '2', '0'), 1, 0},
    [PUPIL_PIXEL_UYVY] = {"uyvy", FOUR('U', 'Y', 'V', 'Y'), 1, 0},
    [PUPIL_PIXEL_BGR8] = {"bgr8", FOUR('B', 'G', 'R', 24), 1, 0},
    [PUPIL_PIXEL_BGRX8] = {"bgrx8", FOUR('B', 'G', 'R', 0), 1, 0},
    [PUPIL_PIXEL_RGBX8] = {"rgbx8", FOUR('R', 'G', 'B', 0), 1, 0},
    [PUPIL_PIXEL_BGR32F] = {"bgr32f", FOUR('B', 'G', 'R', 96), 1, 0},
    [PUPIL_PIXEL_RGB16F] = {"rgb16f", FOUR('R', 'G', '3', 'H'), 1, 0},
    [PUPIL_PIXEL_GREY10P] = {"grey10p", FOUR('Y', '1', '0', 'P'), 1, 0},
    [PUPIL_PIXEL_GREY12P] = {"grey12p", FOUR('Y', '1', '2', 'P'), 1, 0},
    [PUPIL_PIXEL_P010] = {"p010", FOUR('P', '0', '1', '0'), 1, 0},
    [PUPIL_PIXEL_I420_10] = {"i420-10", FOUR('Y', '3', 11, 10), 1, 0},
    [PUPIL_PIXEL_I444_16] = {"i444-16", FOUR('Y', '3', 0, 16), 1, 0},
    [PUPIL_PIXEL_RGB10A2] = {"rgb10a2", FOUR('A', 'B', '3', '0'), 1, 0},
    [PUPIL_PIXEL_GREY8] = {"grey8", FOUR('Y', '8', '0', '0'), 1, 0},
    [PUPIL_PIXEL_GREY10] = {"grey10", FOUR('Y', '1', 0, 10), 1, 0},
    [PUPIL_PIXEL_GREY12] = {"grey12", FOUR('Y', '1', 0, 12), 1, 0},
    [PUPIL_PIXEL_GREY16] = {"grey16", FOUR('Y', '1', 0, 16), 1, 0},
    [PUPIL_PIXEL_BAYER8] = {"bayer8", 8, 2, 1},
    [PUPIL_PIXEL_BAYER10] = {"bayer10", 16, 2, 1},
    [PUPIL_PIXEL_BAYER12] = {"bayer12", 16, 2, 1},
    [PUPIL_PIXEL_BAYER14] = {"bayer14", 16, 2, 1},
    [PUPIL_PIXEL_BAYER16] = {"bayer16", 16, 2, 1},
    [PUPIL_PIXEL_BAYER10P] = {"bayer10p", 'A', 4, 1},
    [PUPIL_PIXEL_BAYER12P] = {"bayer12p", 'C', 2, 1},
};

int pupil_recording_path(char path[PATH_MAX], const char *folder, const char *name)
{
    const int length = snprintf(path, PATH_MAX, "%s/%s", folder, name);
    return length < 0 || length >= PATH_MAX ? -1 : 0;
}

int pupil_is_recording(const char *folder)
{
    char path[PATH_MAX];
    struct stat status;
    return pupil_recording_path(path, folder, PUPIL_RECORDING_ABOUT) == 0 && stat(path, &status) == 0;
}

const char *pupil_recording_pixel_name(uint32_t pixel)
{
    return pixel < PUPIL_PIXEL_COUNT ? formats[pixel].name : NULL;
}

uint32_t pupil_recording_fourcc(const pupil_recording_about *about)
{
    static const char first[PUPIL_BAYER_COUNT][2] = {{'R', 'G'}, {'G', 'R'}, {'G', 'B'}, {'B', 'G'}};
    static const char packed[PUPIL_BAYER_COUNT] = {'R', 'g', 'G', 'B'}; /* pRAA pgAA pGAA pBAA */
    const kept *f = &formats[about->pixel];
    const char *colours = first[about->coding.bayer];
    if (!f->mosaic)
        return f->fourcc;
    if (f->fourcc >= 'A') /* packed */
        return FOUR('p', packed[about->coding.bayer], f->fourcc, f->fourcc);
    return FOUR(0xba, colours[0], colours[1], f->fourcc); /* FFmpeg's: bayer_rggb8, bayer_rggb16le */
}

size_t pupil_recording_bytes(const pupil_recording_about *about)
{
    const size_t planes = pupil_pixel_planes(about->pixel);
    const size_t chroma =
        pupil_chroma_row_bytes(about->pixel, about->width) * pupil_chroma_rows(about->pixel, about->height);
    return pupil_row_bytes(about->pixel, about->width) * about->height + (planes > 1 ? planes - 1 : 0) * chroma;
}

static unsigned char *pack_rows(unsigned char *to, const void *from, ptrdiff_t stride, size_t row, uint32_t rows)
{
    const unsigned char *at = from;
    if (stride == (ptrdiff_t)row) {
        memcpy(to, at, row * rows);
        return to + row * rows;
    }
    for (uint32_t y = 0; y < rows; y++, to += row)
        memcpy(to, at + (ptrdiff_t)y * stride, row);
    return to;
}

void pupil_recording_pack(const pupil_image_const *image, unsigned char *bytes)
{
    const size_t row = pupil_row_bytes(image->pixel, image->width);
    const size_t chroma_row = pupil_chroma_row_bytes(image->pixel, image->width);
    const uint32_t planes = pupil_pixel_planes(image->pixel), rows = pupil_chroma_rows(image->pixel, image->height);
    unsigned char *end = pack_rows(bytes, image->data, image->stride_bytes, row, image->height);
    if (planes > 1)
        end = pack_rows(end, image->chroma, image->chroma_stride_bytes, chroma_row, rows);
    if (planes > 2)
        pack_rows(end, image->cr, image->cr_stride_bytes, chroma_row, rows);
}

pupil_image_const pupil_recording_image(const pupil_recording_about *about, const unsigned char *bytes)
{
    pupil_image_const image = {0};
    image.data = bytes;
    image.stride_bytes = (ptrdiff_t)pupil_row_bytes(about->pixel, about->width);
    image.width = about->width;
    image.height = about->height;
    image.pixel = about->pixel;
    image.coding = &about->coding;
    const size_t chroma_row = pupil_chroma_row_bytes(about->pixel, about->width);
    const unsigned char *chroma = bytes + (size_t)image.stride_bytes * about->height;
    if (pupil_pixel_planes(about->pixel) > 1) {
        image.chroma = chroma;
        image.chroma_stride_bytes = (ptrdiff_t)chroma_row;
    }
    if (pupil_pixel_planes(about->pixel) > 2) {
        image.cr = chroma + chroma_row * pupil_chroma_rows(about->pixel, about->height);
        image.cr_stride_bytes = (ptrdiff_t)chroma_row;
    }
    return image;
}

int pupil_recording_check(const pupil_recording_about *about, pupil_why *why)
{
    const char *fault = "";
    if (!pupil_recording_pixel_name(about->pixel))
        return pupil_refuse(why, "frames of pixel format %u cannot be recorded; inputs of the library can",
                            about->pixel);
    const kept *f = &formats[about->pixel];
    if (!about->width || !about->height || about->width > PUPIL_MAX_SIDE_PX || about->height > PUPIL_MAX_SIDE_PX)
        return pupil_refuse(why, "frames of %u x %u pixels cannot be recorded; each side is 1 to %u", about->width,
                            about->height, PUPIL_MAX_SIDE_PX);
    if (about->width % f->unit || (f->mosaic && about->height % 2))
        return pupil_refuse(why, "frames of %u x %u pixels; of %s the width is a multiple of %u and the height even",
                            about->width, about->height, f->name, f->unit);
    if (pupil_recording_bytes(about) > FRAME_MOST_BYTES)
        return pupil_refuse(why, "frames of %zu bytes cannot be recorded; at most %u can, for Matroska",
                            pupil_recording_bytes(about), FRAME_MOST_BYTES);
    if (pupil_coding_check(&about->coding, about->pixel, &fault))
        return pupil_refuse(why, "the coding of the frames: %s", fault);
    if (!(about->fps > 0.0 && about->fps <= 1e6))
        return pupil_refuse(why, "fps is %g; it must be above 0 and at most 1000000", about->fps);
    return 0;
}
