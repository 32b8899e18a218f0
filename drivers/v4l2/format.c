#include "format.h"

#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>

#include "pupil/config.h"
#include "refuse.h"

typedef struct native {
    uint32_t fourcc;
    uint8_t pixel, bayer, buffers, cr_first;
} native;

/* Formats by their numbers, because headers of older kernels lack some names. */
#define FOUR(a, b, c, d) v4l2_fourcc(a, b, c, d)

static const native natives[] = {
    {V4L2_PIX_FMT_SRGGB8, PUPIL_PIXEL_BAYER8, PUPIL_BAYER_RGGB, 1, 0},
    {V4L2_PIX_FMT_SGRBG8, PUPIL_PIXEL_BAYER8, PUPIL_BAYER_GRBG, 1, 0},
    {V4L2_PIX_FMT_SGBRG8, PUPIL_PIXEL_BAYER8, PUPIL_BAYER_GBRG, 1, 0},
    {V4L2_PIX_FMT_SBGGR8, PUPIL_PIXEL_BAYER8, PUPIL_BAYER_BGGR, 1, 0},
    {V4L2_PIX_FMT_SRGGB10, PUPIL_PIXEL_BAYER10, PUPIL_BAYER_RGGB, 1, 0},
    {V4L2_PIX_FMT_SGRBG10, PUPIL_PIXEL_BAYER10, PUPIL_BAYER_GRBG, 1, 0},
    {V4L2_PIX_FMT_SGBRG10, PUPIL_PIXEL_BAYER10, PUPIL_BAYER_GBRG, 1, 0},
    {V4L2_PIX_FMT_SBGGR10, PUPIL_PIXEL_BAYER10, PUPIL_BAYER_BGGR, 1, 0},
    {V4L2_PIX_FMT_SRGGB12, PUPIL_PIXEL_BAYER12, PUPIL_BAYER_RGGB, 1, 0},
    {V4L2_PIX_FMT_SGRBG12, PUPIL_PIXEL_BAYER12, PUPIL_BAYER_GRBG, 1, 0},
    {V4L2_PIX_FMT_SGBRG12, PUPIL_PIXEL_BAYER12, PUPIL_BAYER_GBRG, 1, 0},
    {V4L2_PIX_FMT_SBGGR12, PUPIL_PIXEL_BAYER12, PUPIL_BAYER_BGGR, 1, 0},
    {FOUR('R', 'G', '1', '4'), PUPIL_PIXEL_BAYER14, PUPIL_BAYER_RGGB, 1, 0},
    {FOUR('G', 'R', '1', '4'), PUPIL_PIXEL_BAYER14, PUPIL_BAYER_GRBG, 1, 0},
    {FOUR('G', 'B', '1', '4'), PUPIL_PIXEL_BAYER14, PUPIL_BAYER_GBRG, 1, 0},
    {FOUR('B', 'G', '1', '4'), PUPIL_PIXEL_BAYER14, PUPIL_BAYER_BGGR, 1, 0},
    {V4L2_PIX_FMT_SRGGB16, PUPIL_PIXEL_BAYER16, PUPIL_BAYER_RGGB, 1, 0},
    {V4L2_PIX_FMT_SGRBG16, PUPIL_PIXEL_BAYER16, PUPIL_BAYER_GRBG, 1, 0},
    {V4L2_PIX_FMT_SGBRG16, PUPIL_PIXEL_BAYER16, PUPIL_BAYER_GBRG, 1, 0},
    {V4L2_PIX_FMT_SBGGR16, PUPIL_PIXEL_BAYER16, PUPIL_BAYER_BGGR, 1, 0},
    {V4L2_PIX_FMT_SRGGB10P, PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_RGGB, 1, 0},
    {V4L2_PIX_FMT_SGRBG10P, PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_GRBG, 1, 0},
    {V4L2_PIX_FMT_SGBRG10P, PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_GBRG, 1, 0},
    {V4L2_PIX_FMT_SBGGR10P, PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_BGGR, 1, 0},
    {FOUR('p', 'R', 'C', 'C'), PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_RGGB, 1, 0},
    {FOUR('p', 'g', 'C', 'C'), PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_GRBG, 1, 0},
    {FOUR('p', 'G', 'C', 'C'), PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_GBRG, 1, 0},
    {FOUR('p', 'B', 'C', 'C'), PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_BGGR, 1, 0},
    {V4L2_PIX_FMT_GREY, PUPIL_PIXEL_GREY8, 0, 1, 0},
    {V4L2_PIX_FMT_Y10, PUPIL_PIXEL_GREY10, 0, 1, 0},
    {V4L2_PIX_FMT_Y12, PUPIL_PIXEL_GREY12, 0, 1, 0},
    {V4L2_PIX_FMT_Y16, PUPIL_PIXEL_GREY16, 0, 1, 0},
    {FOUR('Y', '1', '0', 'P'), PUPIL_PIXEL_GREY10P, 0, 1, 0},
    {FOUR('Y', '1', '2', 'P'), PUPIL_PIXEL_GREY12P, 0, 1, 0},
    {V4L2_PIX_FMT_YUYV, PUPIL_PIXEL_YUYV, 0, 1, 0},
    {V4L2_PIX_FMT_UYVY, PUPIL_PIXEL_UYVY, 0, 1, 0},
    {V4L2_PIX_FMT_NV12, PUPIL_PIXEL_NV12, 0, 1, 0},
    {V4L2_PIX_FMT_NV21, PUPIL_PIXEL_NV21, 0, 1, 0},
    {V4L2_PIX_FMT_NV16, PUPIL_PIXEL_NV16, 0, 1, 0},
    {V4L2_PIX_FMT_NV12M, PUPIL_PIXEL_NV12, 0, 2, 0},
    {V4L2_PIX_FMT_NV21M, PUPIL_PIXEL_NV21, 0, 2, 0},
    {V4L2_PIX_FMT_NV16M, PUPIL_PIXEL_NV16, 0, 2, 0},
    {V4L2_PIX_FMT_YUV420, PUPIL_PIXEL_I420, 0, 1, 0},
    {V4L2_PIX_FMT_YVU420, PUPIL_PIXEL_I420, 0, 1, 1},
    {V4L2_PIX_FMT_YUV420M, PUPIL_PIXEL_I420, 0, 3, 0},
    {V4L2_PIX_FMT_YVU420M, PUPIL_PIXEL_I420, 0, 3, 1},
    {FOUR('P', '0', '1', '0'), PUPIL_PIXEL_P010, 0, 1, 0},
    {V4L2_PIX_FMT_RGB24, PUPIL_PIXEL_RGB8, 0, 1, 0},
    {V4L2_PIX_FMT_BGR24, PUPIL_PIXEL_BGR8, 0, 1, 0},
    {FOUR('A', 'B', '2', '4'), PUPIL_PIXEL_RGBA8, 0, 1, 0},
    {FOUR('X', 'B', '2', '4'), PUPIL_PIXEL_RGBX8, 0, 1, 0},
    {V4L2_PIX_FMT_XBGR32, PUPIL_PIXEL_BGRX8, 0, 1, 0},
    {V4L2_PIX_FMT_ABGR32, PUPIL_PIXEL_BGRX8, 0, 1, 0},
    {V4L2_PIX_FMT_MJPEG, PUPIL_PIXEL_NONE, 0, 1, 0},
    {V4L2_PIX_FMT_JPEG, PUPIL_PIXEL_NONE, 0, 1, 0},
};

#define LEAST_JPEG_BYTES 4 /* its first and its last marker */
/* Upper bound of a frame's memory as the driver reports it: this program may have to allocate buffers of that size. The
 * widest format read has 8 bytes a pixel; rows may be padded, and JPEGs of tiny frames have tables. */
#define MOST_PIXEL_BYTES 64
#define MOST_MORE_BYTES  (16u << 20)

const char pupil_v4l2_natives[] = "RGGB, RG10, RG12, RG14, RG16, pRAA, pRCC and their three other orders, GREY, Y10, "
                                  "Y12, Y16, Y10P, Y12P, YUYV, UYVY, NV12, NV21, NV16, NM12, NM21, NM16, YU12, YV12, "
                                  "YM12, YM21, P010, RGB3, BGR3, AB24, XB24, XR24, AR24, MJPG, JPEG";

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

uint32_t pupil_v4l2_bayer_of(uint32_t fourcc)
{
    const native *n = find(fourcc);
    return n ? n->bayer : 0;
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
    return pupil_pixel_planes(pixel) > 1 || pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY;
}

static int is_grey(uint32_t pixel)
{
    return pupil_pixel_bits(pixel) && !pupil_pixel_is_mosaic(pixel);
}

static int is_rgb(uint32_t pixel)
{
    return !is_yuv(pixel) && !pupil_pixel_bits(pixel);
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
    else if (xfer_func == V4L2_XFER_FUNC_SMPTE2084)
        coding->light = PUPIL_LIGHT_PQ;
    else {
        return pupil_refuse(why, "its transfer function is %s; sRGB, Rec. 709, SMPTE 2084 (PQ) or none can be read",
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
    const uint32_t unit = 1u << (pupil_pixel_bits(pixel) - 8);
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

static int read_jpeg_layout(pupil_v4l2_format *f, pupil_why *why)
{
    for (int i = 0; i < PUPIL_V4L2_MOST_AREAS; i++)
        f->stride_bytes[i] = 0;
    f->needs_bytes[0] = LEAST_JPEG_BYTES;
    if (f->size_bytes[0] < LEAST_JPEG_BYTES)
        return pupil_refuse(why, "its driver says that a frame of %s has %u bytes at most",
                            pupil_v4l2_fourcc_name(f->fourcc).text, f->size_bytes[0]);
    return 0;
}

/* Fills in strides that the driver leaves empty, as some do for tightly packed frames. In one area chroma has the
 * stride of data, or each of two planes half of it ("Image Formats", Planar YUV Formats). */
static void complete_strides(pupil_v4l2_format *f)
{
    const uint32_t planes = pupil_pixel_planes(f->pixel), one_area = f->buffers == 1;
    const uint32_t row = (uint32_t)pupil_row_bytes(f->pixel, f->width);
    if (!f->stride_bytes[0])
        f->stride_bytes[0] = row + (planes == 3 && one_area ? row % 2 : 0);
    for (uint32_t i = 1; i < PUPIL_V4L2_MOST_AREAS; i++)
        if (i >= planes)
            f->stride_bytes[i] = 0;
        else if (one_area || !f->stride_bytes[i])
            f->stride_bytes[i] = f->stride_bytes[0] / (planes == 3 ? 2 : 1);
}

static int read_layout(pupil_v4l2_format *f, pupil_why *why)
{
    const uint32_t planes = pupil_pixel_planes(f->pixel);
    const int even = pupil_pixel_bytes(f->pixel) == 2;
    uint64_t end[PUPIL_V4L2_MOST_AREAS] = {0}; /* of what is in each area so far, and behind its last row */
    complete_strides(f);
    for (uint32_t i = 0; i < planes; i++) {
        const uint32_t row =
            (uint32_t)(i ? pupil_chroma_row_bytes(f->pixel, f->width) : pupil_row_bytes(f->pixel, f->width));
        const uint32_t rows = i ? pupil_chroma_rows(f->pixel, f->height) : f->height, area = f->buffers > 1 ? i : 0;
        const int odd = even && f->stride_bytes[i] % 2;
        if (f->stride_bytes[i] < row || odd)
            return pupil_refuse(why, "its driver says that a row has %u bytes; %u pixels of %s need %u%s",
                                f->stride_bytes[i], f->width, pupil_v4l2_fourcc_name(f->fourcc).text, row,
                                odd ? ", and an even number" : "");
        const uint64_t needs = end[area] + (uint64_t)f->stride_bytes[i] * (rows - 1) + row;
        if (needs > f->size_bytes[area])
            return pupil_refuse(why, "its driver says that a frame has %u bytes; %ux%u of %s need %llu",
                                f->size_bytes[area], f->width, f->height, pupil_v4l2_fourcc_name(f->fourcc).text,
                                (unsigned long long)needs);
        f->plane_bytes[i] = (uint32_t)end[area];
        f->needs_bytes[area] = (uint32_t)needs;
        end[area] += (uint64_t)f->stride_bytes[i] * rows;
    }
    return 0;
}

static int check_bytes(const pupil_v4l2_format *f, pupil_why *why)
{
    const uint64_t most = MOST_MORE_BYTES + (uint64_t)MOST_PIXEL_BYTES * f->width * f->height;
    for (uint32_t i = 0; i < f->buffers; i++)
        if (f->size_bytes[i] > most)
            return pupil_refuse(why, "its driver says that a frame has %u bytes; %ux%u of %s have %llu at most",
                                f->size_bytes[i], f->width, f->height, pupil_v4l2_fourcc_name(f->fourcc).text,
                                (unsigned long long)most);
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
    for (int i = 0; i < PUPIL_V4L2_MOST_AREAS && i < pix->num_planes; i++) {
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
        return pupil_refuse(why, "its format %s is not supported; supported: %s", pupil_v4l2_fourcc_name(f.fourcc).text,
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
    f.cr_first = n->cr_first;
    f.coding.bayer = n->bayer;
    if (check_size(&f, why) || check_bytes(&f, why) ||
        (f.compressed ? read_jpeg_layout(&f, why) : read_layout(&f, why)) || read_colour(&f, why))
        return -1;
    *format = f;
    return 0;
}
