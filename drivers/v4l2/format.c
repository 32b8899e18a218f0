#include "format.h"

#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>

#include "pupil/config.h"
#include "refuse.h"

typedef struct native {
    uint32_t fourcc;
    uint8_t pixel, bayer, buffers;
} native;

/* Kernels older than a format's name have its number all the same. */
#define FOUR(a, b, c, d) v4l2_fourcc(a, b, c, d)

static const native natives[] = {
    {V4L2_PIX_FMT_SRGGB8, PUPIL_PIXEL_BAYER8, PUPIL_BAYER_RGGB, 1},
    {V4L2_PIX_FMT_SGRBG8, PUPIL_PIXEL_BAYER8, PUPIL_BAYER_GRBG, 1},
    {V4L2_PIX_FMT_SGBRG8, PUPIL_PIXEL_BAYER8, PUPIL_BAYER_GBRG, 1},
    {V4L2_PIX_FMT_SBGGR8, PUPIL_PIXEL_BAYER8, PUPIL_BAYER_BGGR, 1},
    {V4L2_PIX_FMT_SRGGB10, PUPIL_PIXEL_BAYER10, PUPIL_BAYER_RGGB, 1},
    {V4L2_PIX_FMT_SGRBG10, PUPIL_PIXEL_BAYER10, PUPIL_BAYER_GRBG, 1},
    {V4L2_PIX_FMT_SGBRG10, PUPIL_PIXEL_BAYER10, PUPIL_BAYER_GBRG, 1},
    {V4L2_PIX_FMT_SBGGR10, PUPIL_PIXEL_BAYER10, PUPIL_BAYER_BGGR, 1},
    {V4L2_PIX_FMT_SRGGB12, PUPIL_PIXEL_BAYER12, PUPIL_BAYER_RGGB, 1},
    {V4L2_PIX_FMT_SGRBG12, PUPIL_PIXEL_BAYER12, PUPIL_BAYER_GRBG, 1},
    {V4L2_PIX_FMT_SGBRG12, PUPIL_PIXEL_BAYER12, PUPIL_BAYER_GBRG, 1},
    {V4L2_PIX_FMT_SBGGR12, PUPIL_PIXEL_BAYER12, PUPIL_BAYER_BGGR, 1},
    {FOUR('R', 'G', '1', '4'), PUPIL_PIXEL_BAYER14, PUPIL_BAYER_RGGB, 1},
    {FOUR('G', 'R', '1', '4'), PUPIL_PIXEL_BAYER14, PUPIL_BAYER_GRBG, 1},
    {FOUR('G', 'B', '1', '4'), PUPIL_PIXEL_BAYER14, PUPIL_BAYER_GBRG, 1},
    {FOUR('B', 'G', '1', '4'), PUPIL_PIXEL_BAYER14, PUPIL_BAYER_BGGR, 1},
    {V4L2_PIX_FMT_SRGGB16, PUPIL_PIXEL_BAYER16, PUPIL_BAYER_RGGB, 1},
    {V4L2_PIX_FMT_SGRBG16, PUPIL_PIXEL_BAYER16, PUPIL_BAYER_GRBG, 1},
    {V4L2_PIX_FMT_SGBRG16, PUPIL_PIXEL_BAYER16, PUPIL_BAYER_GBRG, 1},
    {V4L2_PIX_FMT_SBGGR16, PUPIL_PIXEL_BAYER16, PUPIL_BAYER_BGGR, 1},
    {V4L2_PIX_FMT_SRGGB10P, PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_RGGB, 1},
    {V4L2_PIX_FMT_SGRBG10P, PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_GRBG, 1},
    {V4L2_PIX_FMT_SGBRG10P, PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_GBRG, 1},
    {V4L2_PIX_FMT_SBGGR10P, PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_BGGR, 1},
    {FOUR('p', 'R', 'C', 'C'), PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_RGGB, 1},
    {FOUR('p', 'g', 'C', 'C'), PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_GRBG, 1},
    {FOUR('p', 'G', 'C', 'C'), PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_GBRG, 1},
    {FOUR('p', 'B', 'C', 'C'), PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_BGGR, 1},
    {V4L2_PIX_FMT_GREY, PUPIL_PIXEL_GREY8, 0, 1},
    {V4L2_PIX_FMT_Y10, PUPIL_PIXEL_GREY10, 0, 1},
    {V4L2_PIX_FMT_Y12, PUPIL_PIXEL_GREY12, 0, 1},
    {V4L2_PIX_FMT_Y16, PUPIL_PIXEL_GREY16, 0, 1},
    {V4L2_PIX_FMT_YUYV, PUPIL_PIXEL_YUYV, 0, 1},
    {V4L2_PIX_FMT_NV12, PUPIL_PIXEL_NV12, 0, 1},
    {V4L2_PIX_FMT_NV12M, PUPIL_PIXEL_NV12, 0, 2},
    {V4L2_PIX_FMT_RGB24, PUPIL_PIXEL_RGB8, 0, 1},
    {FOUR('A', 'B', '2', '4'), PUPIL_PIXEL_RGBA8, 0, 1},
    {V4L2_PIX_FMT_MJPEG, PUPIL_PIXEL_NONE, 0, 1},
    {V4L2_PIX_FMT_JPEG, PUPIL_PIXEL_NONE, 0, 1},
};

#define LEAST_JPEG_BYTES 4 /* its first and its last marker */

const char pupil_v4l2_natives[] = "RGGB, RG10, RG12, RG14, RG16, pRAA, pRCC and their three other orders, GREY, Y10, "
                                  "Y12, Y16, YUYV, NV12, NM12, RGB3, AB24, MJPG, JPEG";

static const native *find(uint32_t fourcc)
{
    for (size_t i = 0; i < sizeof natives / sizeof natives[0]; i++)
        if (natives[i].fourcc == fourcc)
            return &natives[i];
    return NULL;
}

uint32_t pupil_v4l2_pixel_of(uint32_t fourcc)
{
    const native *n = find(fourcc);
    return n ? n->pixel : PUPIL_PIXEL_NONE;
}

int pupil_v4l2_is_read(uint32_t fourcc)
{
    return find(fourcc) != NULL;
}

pupil_v4l2_name pupil_v4l2_fourcc_name(uint32_t fourcc)
{
    pupil_v4l2_name name = {{0}};
    int length = 0;
    for (int i = 0; i < 4; i++) {
        const uint32_t c = fourcc >> 8 * i & 0x7f;
        name.text[length++] = c >= ' ' && c < 0x7f ? (char)c : '?';
    }
    while (length > 1 && name.text[length - 1] == ' ')
        name.text[--length] = 0;
    if (fourcc >> 31)
        memcpy(name.text + length, "-BE", 4);
    return name;
}

uint32_t pupil_v4l2_fourcc(const char *name)
{
    const size_t length = strlen(name);
    uint32_t fourcc = 0;
    if (!length || length > 4)
        return 0;
    for (size_t i = 0; i < 4; i++) {
        const unsigned char c = i < length ? (unsigned char)name[i] : ' ';
        if (c < ' ' || c > '~')
            return 0;
        fourcc |= (uint32_t)c << 8 * i;
    }
    return fourcc;
}

/* --- colour --- */

static int is_yuv(uint32_t pixel)
{
    return pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_NV12;
}

static int is_grey(uint32_t pixel)
{
    return pixel >= PUPIL_PIXEL_GREY8 && pixel <= PUPIL_PIXEL_GREY16;
}

static int is_rgb(uint32_t pixel)
{
    return pixel == PUPIL_PIXEL_RGB8 || pixel == PUPIL_PIXEL_RGBA8;
}

static const char *const xfer_names[] = {"default",    "Rec. 709", "sRGB",   "opRGB",
                                         "SMPTE 240M", "none",     "DCI-P3", "SMPTE 2084 (PQ)"};

static int read_light(uint32_t xfer_func, pupil_coding *coding, pupil_why *why)
{
    if (xfer_func == V4L2_XFER_FUNC_SRGB)
        coding->light = PUPIL_LIGHT_SRGB;
    else if (xfer_func == V4L2_XFER_FUNC_709)
        coding->light = PUPIL_LIGHT_BT709;
    else if (xfer_func == V4L2_XFER_FUNC_NONE)
        coding->light = PUPIL_LIGHT_LINEAR;
    else {
        return pupil_refuse(why, "its transfer function is %s; sRGB, Rec. 709 or none can be read",
                            xfer_func < sizeof xfer_names / sizeof xfer_names[0] ? xfer_names[xfer_func] : "unknown");
    }
    return 0;
}

static int read_matrix(uint32_t ycbcr_enc, pupil_coding *coding, pupil_why *why)
{
    switch (ycbcr_enc) {
    case V4L2_YCBCR_ENC_601:
    case V4L2_YCBCR_ENC_XV601:
    case V4L2_YCBCR_ENC_SYCC:
        coding->matrix = PUPIL_MATRIX_BT601;
        return 0;
    case V4L2_YCBCR_ENC_709:
    case V4L2_YCBCR_ENC_XV709:
        coding->matrix = PUPIL_MATRIX_BT709;
        return 0;
    case V4L2_YCBCR_ENC_BT2020:
        coding->matrix = PUPIL_MATRIX_BT2020;
        return 0;
    default:
        return pupil_refuse(why, "its Y'CbCr encoding is %s; 601, Rec. 709 or BT.2020 can be read",
                            ycbcr_enc == V4L2_YCBCR_ENC_BT2020_CONST_LUM ? "BT.2020 constant luminance"
                            : ycbcr_enc == V4L2_YCBCR_ENC_SMPTE240M      ? "SMPTE 240M"
                                                                         : "unknown");
    }
}

/* Y' 16..235 of 8 bits, and as much of more (Rec. ITU-R BT.2100-2, table 9). */
static void limit_grey(uint32_t pixel, pupil_coding *coding)
{
    const uint32_t more_bits = pixel == PUPIL_PIXEL_GREY8 ? 0 : pixel == PUPIL_PIXEL_GREY10 ? 2 : 4;
    const uint32_t unit = pixel == PUPIL_PIXEL_GREY16 ? 256 : 1u << more_bits;
    coding->black = (float)(16 * unit);
    coding->white = (float)(235 * unit);
}

/* Where the driver leaves a field at "default", the value that videodev2.h gives it; JFIF's where frames are JPEG. */
static void resolve_colour(pupil_v4l2_format *f)
{
    if (f->compressed && f->quantization == V4L2_QUANTIZATION_DEFAULT)
        f->quantization = V4L2_QUANTIZATION_FULL_RANGE;
    if (f->compressed && f->ycbcr_enc == V4L2_YCBCR_ENC_DEFAULT)
        f->ycbcr_enc = V4L2_YCBCR_ENC_601;
    if (f->colorspace == V4L2_COLORSPACE_DEFAULT) /* drivers of cameras must not say so; then as webcams do */
        f->colorspace = V4L2_MAP_COLORSPACE_DEFAULT(0, 0);
    if (f->xfer_func == V4L2_XFER_FUNC_DEFAULT)
        f->xfer_func = V4L2_MAP_XFER_FUNC_DEFAULT(f->colorspace);
    if (f->ycbcr_enc == V4L2_YCBCR_ENC_DEFAULT)
        f->ycbcr_enc = V4L2_MAP_YCBCR_ENC_DEFAULT(f->colorspace);
    if (f->quantization == V4L2_QUANTIZATION_DEFAULT)
        f->quantization = V4L2_MAP_QUANTIZATION_DEFAULT(!is_yuv(f->pixel), f->colorspace, f->ycbcr_enc);
}

static int read_colour(pupil_v4l2_format *f, pupil_why *why)
{
    const int named_xfer = f->xfer_func != V4L2_XFER_FUNC_DEFAULT;
    const int named_range = f->quantization != V4L2_QUANTIZATION_DEFAULT;
    resolve_colour(f);
    f->primaries = f->colorspace == V4L2_COLORSPACE_BT2020 ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709;
    const int limited = f->quantization == V4L2_QUANTIZATION_LIM_RANGE;

    if (is_yuv(f->pixel) || f->compressed) {
        f->coding.range = limited ? PUPIL_RANGE_LIMITED : PUPIL_RANGE_FULL;
        if (read_matrix(f->ycbcr_enc, &f->coding, why))
            return -1;
        return read_light(f->xfer_func, &f->coding, why);
    }
    if (is_grey(f->pixel)) {
        if (named_range && limited)
            limit_grey(f->pixel, &f->coding);
        return named_xfer ? read_light(f->xfer_func, &f->coding, why) : 0;
    }
    if (is_rgb(f->pixel) && (limited || f->xfer_func != V4L2_XFER_FUNC_SRGB))
        return pupil_refuse(why, "its %s is RGB of %s; RGB of full range and sRGB's transfer function can be read",
                            pupil_v4l2_fourcc_name(f->fourcc).text,
                            limited ? "limited range" : "another transfer function");
    return 0; /* a mosaic is linear, regardless of the picture that is made of it */
}

/* --- layout --- */

static int read_layout(pupil_v4l2_format *f, pupil_why *why)
{
    const uint32_t row = (uint32_t)pupil_row_bytes(f->pixel, f->width);
    const uint32_t chroma_row = f->width + f->width % 2, chroma_rows = (f->height + 1) / 2;
    const int nv12 = f->pixel == PUPIL_PIXEL_NV12;
    if (f->compressed) {
        f->stride_bytes[0] = f->stride_bytes[1] = 0;
        f->needs_bytes[0] = LEAST_JPEG_BYTES;
        if (f->size_bytes[0] < LEAST_JPEG_BYTES)
            pupil_refuse(why, "its driver says that a frame of %s has %u bytes at most",
                         pupil_v4l2_fourcc_name(f->fourcc).text, f->size_bytes[0]);
        return f->size_bytes[0] < LEAST_JPEG_BYTES ? -1 : 0;
    }
    if (!f->stride_bytes[0])
        f->stride_bytes[0] = row; /* some drivers of tightly packed frames leave it empty */
    if (f->buffers == 1 || !f->stride_bytes[1])
        f->stride_bytes[1] = nv12 ? f->stride_bytes[0] : 0;
    const int odd = pupil_pixel_bytes(f->pixel) == 2 && f->stride_bytes[0] % 2;
    if (f->stride_bytes[0] < row || (nv12 && f->stride_bytes[1] < chroma_row) || odd)
        return pupil_refuse(why, "its driver says that a row has %u bytes; %u pixels of %s need %u%s",
                            f->stride_bytes[0], f->width, pupil_v4l2_fourcc_name(f->fourcc).text, row,
                            odd ? ", and an even number" : "");
    uint64_t needs[2] = {(uint64_t)f->stride_bytes[0] * (f->height - 1) + row, 0};
    const uint64_t chroma = (uint64_t)f->stride_bytes[1] * (chroma_rows - 1) + chroma_row;
    if (nv12 && f->buffers == 1) {
        f->chroma_bytes = f->stride_bytes[0] * f->height;
        needs[0] = (uint64_t)f->stride_bytes[0] * f->height + chroma;
    } else if (nv12) {
        needs[1] = chroma;
    }
    for (int i = 0; i < 2; i++) {
        if (needs[i] > f->size_bytes[i])
            return pupil_refuse(why, "its driver says that a frame has %u bytes; %ux%u of %s need %llu",
                                f->size_bytes[i], f->width, f->height, pupil_v4l2_fourcc_name(f->fourcc).text,
                                (unsigned long long)needs[i]);
        f->needs_bytes[i] = (uint32_t)needs[i];
    }
    return 0;
}

static int check_size(const pupil_v4l2_format *f, pupil_why *why)
{
    const int mosaic = pupil_pixel_is_mosaic(f->pixel);
    const uint32_t unit = f->pixel == PUPIL_PIXEL_BAYER10P ? 4 : mosaic ? 2 : 1;
    if (!f->width || !f->height || f->width > PUPIL_MAX_SIDE_PX || f->height > PUPIL_MAX_SIDE_PX)
        pupil_refuse(why, "its frames are %ux%u; from 1x1 to %ux%u can be read", f->width, f->height, PUPIL_MAX_SIDE_PX,
                     PUPIL_MAX_SIDE_PX);
    else if (f->width % unit || (mosaic && f->height % 2))
        pupil_refuse(why, "its frames are %ux%u; of %s the width must be a multiple of %u and the height even",
                     f->width, f->height, pupil_v4l2_fourcc_name(f->fourcc).text, unit);
    else
        return 0;
    return -1;
}

static int take_single(const struct v4l2_pix_format *pix, pupil_v4l2_format *f)
{
    const int extended = pix->priv == V4L2_PIX_FMT_PRIV_MAGIC; /* else what follows it is not filled in */
    f->fourcc = pix->pixelformat;
    f->width = pix->width;
    f->height = pix->height;
    f->stride_bytes[0] = pix->bytesperline;
    f->size_bytes[0] = pix->sizeimage;
    f->colorspace = pix->colorspace;
    f->ycbcr_enc = extended ? pix->ycbcr_enc : V4L2_YCBCR_ENC_DEFAULT;
    f->quantization = extended ? pix->quantization : V4L2_QUANTIZATION_DEFAULT;
    f->xfer_func = extended ? pix->xfer_func : V4L2_XFER_FUNC_DEFAULT;
    f->buffers = 1;
    return (int)pix->field;
}

static int take_multi(const struct v4l2_pix_format_mplane *pix, pupil_v4l2_format *f)
{
    f->fourcc = pix->pixelformat;
    f->width = pix->width;
    f->height = pix->height;
    for (int i = 0; i < 2 && i < pix->num_planes; i++) {
        f->stride_bytes[i] = pix->plane_fmt[i].bytesperline;
        f->size_bytes[i] = pix->plane_fmt[i].sizeimage;
    }
    f->colorspace = pix->colorspace;
    f->ycbcr_enc = pix->ycbcr_enc;
    f->quantization = pix->quantization;
    f->xfer_func = pix->xfer_func;
    f->buffers = pix->num_planes;
    return (int)pix->field;
}

int pupil_v4l2_format_read(const struct v4l2_format *answer, pupil_v4l2_format *format, pupil_why *why)
{
    pupil_v4l2_format f = {0};
    const int field = answer->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE ? take_multi(&answer->fmt.pix_mp, &f)
                                                                         : take_single(&answer->fmt.pix, &f);
    const native *n = find(f.fourcc);
    if (!n)
        return pupil_refuse(why, "its format %s is not read; what is: %s", pupil_v4l2_fourcc_name(f.fourcc).text,
                            pupil_v4l2_natives);
    if (f.buffers != n->buffers)
        return pupil_refuse(why, "its driver keeps %s in %u memory areas; it has %u",
                            pupil_v4l2_fourcc_name(f.fourcc).text, f.buffers, n->buffers);
    if (field != V4L2_FIELD_NONE && field != V4L2_FIELD_ANY && field != V4L2_FIELD_INTERLACED)
        return pupil_refuse(why,
                            "its driver hands out single fields (field %d); whole frames are needed, as 'v4l2-ctl "
                            "--set-fmt-video field=none' asks for",
                            field);
    f.pixel = n->pixel;
    f.compressed = n->pixel == PUPIL_PIXEL_NONE;
    f.coding.bayer = n->bayer;
    if (check_size(&f, why) || read_layout(&f, why) || read_colour(&f, why))
        return -1;
    *format = f;
    return 0;
}
