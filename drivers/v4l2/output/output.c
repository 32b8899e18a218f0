#include "output.h"

#include <linux/videodev2.h>
#include <string.h>

#include "refuse.h"
#include "v4l2/format.h"

#define SHIFT 18 /* the factors' unit is 2^-18: a sum of four pixels' products stays below 2^28 */

const uint32_t pupil_v4l2_outputs[PUPIL_V4L2_OUTPUTS] = {
    V4L2_PIX_FMT_RGB24,  V4L2_PIX_FMT_BGR24,  V4L2_PIX_FMT_XBGR32, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_NV12,
    V4L2_PIX_FMT_YUV420, V4L2_PIX_FMT_UYVY,   V4L2_PIX_FMT_NV21,   V4L2_PIX_FMT_NV16, V4L2_PIX_FMT_YVU420,
    V4L2_PIX_FMT_RGBX32, V4L2_PIX_FMT_ABGR32, V4L2_PIX_FMT_RGBA32};

const char pupil_v4l2_written[] = "RGB3, BGR3, XR24, YUYV, NV12, YU12, UYVY, NV21, NV16, YV12, XB24, AR24, AB24";

int pupil_v4l2_is_written(uint32_t fourcc)
{
    for (int i = 0; i < PUPIL_V4L2_OUTPUTS; i++)
        if (pupil_v4l2_outputs[i] == fourcc)
            return 1;
    return 0;
}

static int is_packed_yuv(const pupil_v4l2_output *o)
{
    return o->pixel == PUPIL_PIXEL_YUYV || o->pixel == PUPIL_PIXEL_UYVY;
}

static int is_rgb(const pupil_v4l2_output *o)
{
    return pupil_pixel_planes(o->pixel) == 1 && !is_packed_yuv(o);
}

/* --- what a driver says --- */

typedef struct colour {
    uint32_t colorspace, ycbcr_enc, quantization;
} colour;

static colour take_single(const struct v4l2_pix_format *pix, pupil_v4l2_output *o)
{
    const int extended = pix->priv == V4L2_PIX_FMT_PRIV_MAGIC; /* else what follows it is not filled in */
    o->fourcc = pix->pixelformat;
    o->width = pix->width;
    o->height = pix->height;
    o->stride_bytes = pix->bytesperline;
    o->size_bytes = pix->sizeimage;
    o->field = pix->field;
    return (colour){pix->colorspace, extended ? pix->ycbcr_enc : 0, extended ? pix->quantization : 0};
}

static colour take_multi(const struct v4l2_pix_format_mplane *pix, pupil_v4l2_output *o)
{
    o->fourcc = pix->pixelformat;
    o->width = pix->width;
    o->height = pix->height;
    o->stride_bytes = pix->plane_fmt[0].bytesperline;
    o->size_bytes = pix->plane_fmt[0].sizeimage;
    o->field = pix->field;
    return (colour){pix->colorspace, pix->ycbcr_enc, pix->quantization};
}

static int32_t fixed(double factor)
{
    return (int32_t)(factor * (1 << SHIFT) + (factor < 0 ? -0.5 : 0.5));
}

/* Green's factor is what the others leave, so that white is exact and grey has no colour. */
static void set_row(int32_t row[3], double red, double blue, int32_t sum)
{
    row[0] = fixed(red);
    row[2] = fixed(blue);
    row[1] = sum - row[0] - row[2];
}

static int read_colour(colour c, pupil_v4l2_output *o, pupil_why *why)
{
    const int rgb = is_rgb(o);
    if (!c.colorspace)
        c.colorspace = V4L2_COLORSPACE_SRGB;
    if (!c.ycbcr_enc)
        c.ycbcr_enc = V4L2_MAP_YCBCR_ENC_DEFAULT(c.colorspace);
    if (!c.quantization)
        c.quantization = V4L2_MAP_QUANTIZATION_DEFAULT(rgb, c.colorspace, c.ycbcr_enc);
    const int limited = c.quantization == V4L2_QUANTIZATION_LIM_RANGE;
    const int is_709 = c.ycbcr_enc == V4L2_YCBCR_ENC_709 || c.ycbcr_enc == V4L2_YCBCR_ENC_XV709;
    const int is_601 =
        c.ycbcr_enc == V4L2_YCBCR_ENC_601 || c.ycbcr_enc == V4L2_YCBCR_ENC_XV601 || c.ycbcr_enc == V4L2_YCBCR_ENC_SYCC;
    if (!rgb && !is_709 && !is_601)
        return pupil_refuse(why, "its Y'CbCr encoding is number %u of V4L2's; 601 or Rec. 709 can be written",
                            c.ycbcr_enc);

    const double red = is_709 ? 0.2126 : 0.299, blue = is_709 ? 0.0722 : 0.114;
    const double luma = limited ? 219.0 / 255.0 : 1.0, chroma = limited ? 224.0 / 255.0 : 1.0;
    const double of_cb = chroma / (2.0 * (1.0 - blue)), of_cr = chroma / (2.0 * (1.0 - red));
    set_row(o->factor[0], luma * red, luma * blue, fixed(luma));
    set_row(o->factor[1], -of_cb * red, of_cb * (1.0 - blue), 0);
    set_row(o->factor[2], of_cr * (1.0 - red), -of_cr * blue, 0);
    o->luma_offset = limited ? 16 : 0;
    for (int i = 0; i < 256; i++)
        o->level[i] = (uint8_t)(limited ? 16 + (i * 219 + 127) / 255 : i);
    return 0;
}

/* Chroma follows the rows, with their stride, or each of two planes with half of it. */
static int read_layout(pupil_v4l2_output *o, pupil_why *why)
{
    const uint32_t planes = pupil_pixel_planes(o->pixel), rows = pupil_chroma_rows(o->pixel, o->height);
    const uint32_t row = (uint32_t)pupil_row_bytes(o->pixel, o->width), widest = planes > 1 ? row + row % 2 : row;
    if (!o->stride_bytes)
        o->stride_bytes = widest;
    if (o->stride_bytes < widest)
        return pupil_refuse(why, "its driver says that a row has %u bytes; %u pixels of %s need %u", o->stride_bytes,
                            o->width, pupil_v4l2_fourcc_name(o->fourcc).text, widest);
    o->chroma_stride_bytes = planes > 1 ? o->stride_bytes / (planes - 1) : 0;
    uint64_t needs = (uint64_t)o->stride_bytes * (o->height - 1) + row;
    if (planes > 1)
        needs = (uint64_t)o->stride_bytes * o->height +
                (uint64_t)o->chroma_stride_bytes * ((uint64_t)rows * (planes - 1) - 1) +
                pupil_chroma_row_bytes(o->pixel, o->width);
    if (needs > o->size_bytes)
        return pupil_refuse(why, "its driver says that a frame has %u bytes; %ux%u of %s need %llu", o->size_bytes,
                            o->width, o->height, pupil_v4l2_fourcc_name(o->fourcc).text, (unsigned long long)needs);
    o->needs_bytes = (uint32_t)needs;
    return 0;
}

int pupil_v4l2_output_read(const struct v4l2_format *answer, pupil_v4l2_output *output, pupil_why *why)
{
    pupil_v4l2_output o = {0};
    const int multi = answer->type == V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE;
    const colour c = multi ? take_multi(&answer->fmt.pix_mp, &o) : take_single(&answer->fmt.pix, &o);
    if (!pupil_v4l2_is_written(o.fourcc) || (multi && answer->fmt.pix_mp.num_planes != 1))
        return pupil_refuse(why, "it takes %s%s; formats that can be written: %s",
                            pupil_v4l2_fourcc_name(o.fourcc).text,
                            pupil_v4l2_is_written(o.fourcc) ? " in several memory areas" : "", pupil_v4l2_written);
    o.pixel = pupil_v4l2_pixel_of(o.fourcc);
    if (!o.width || !o.height || o.width > PUPIL_MAX_SIDE_PX || o.height > PUPIL_MAX_SIDE_PX)
        return pupil_refuse(why, "it takes %ux%u; each side that can be written is 1 to %u", o.width, o.height,
                            PUPIL_MAX_SIDE_PX);
    if (o.field != V4L2_FIELD_NONE && o.field != V4L2_FIELD_ANY && o.field != V4L2_FIELD_INTERLACED)
        return pupil_refuse(why, "it takes single fields (field %u); whole frames can be written", o.field);
    if (read_layout(&o, why) || read_colour(c, &o, why))
        return -1;
    *output = o;
    return 0;
}

/* --- pixels --- */

static void fill_rgb(const pupil_v4l2_output *o, const uint8_t *rgb, unsigned char *to)
{
    const uint32_t bytes = (uint32_t)pupil_pixel_bytes(o->pixel);
    const int red = o->pixel == PUPIL_PIXEL_BGR8 || o->pixel == PUPIL_PIXEL_BGRX8 ? 2 : 0;
    for (uint32_t x = 0; x < o->width; x++, rgb += 3, to += bytes) {
        to[red] = o->level[rgb[0]];
        to[1] = o->level[rgb[1]];
        to[2 - red] = o->level[rgb[2]];
        if (bytes == 4)
            to[3] = 255;
    }
}

static unsigned char luma_of(const pupil_v4l2_output *o, const uint8_t *rgb)
{
    const int32_t sum = o->factor[0][0] * rgb[0] + o->factor[0][1] * rgb[1] + o->factor[0][2] * rgb[2];
    return (unsigned char)(o->luma_offset + ((sum + (1 << (SHIFT - 1))) >> SHIFT));
}

/* Cb and Cr of four pixels (the same one twice where there are two). Full range reaches 255.5. */
static void chroma_of(const pupil_v4l2_output *o, const uint8_t *const rgb[4], unsigned char *cb, unsigned char *cr)
{
    int32_t sum[2] = {0, 0};
    for (int c = 0; c < 3; c++) {
        const int32_t mean = rgb[0][c] + rgb[1][c] + rgb[2][c] + rgb[3][c];
        sum[0] += o->factor[1][c] * mean;
        sum[1] += o->factor[2][c] * mean;
    }
    for (int i = 0; i < 2; i++) {
        const int32_t code = (sum[i] + (128 << (SHIFT + 2)) + (1 << (SHIFT + 1))) >> (SHIFT + 2);
        *(i ? cr : cb) = (unsigned char)(code > 255 ? 255 : code);
    }
}

static void fill_packed_yuv(const pupil_v4l2_output *o, const uint8_t *rgb, unsigned char *to)
{
    const uint32_t luma_at = o->pixel == PUPIL_PIXEL_UYVY;
    for (uint32_t x = 0; x < o->width; x += 2, to += 4) {
        const uint8_t *left = rgb + (size_t)3 * x, *right = x + 1 < o->width ? left + 3 : left;
        const uint8_t *const pair[4] = {left, right, left, right};
        to[luma_at] = luma_of(o, left);
        to[2 + luma_at] = luma_of(o, right);
        chroma_of(o, pair, &to[1 - luma_at], &to[3 - luma_at]);
    }
}

/* A row of Cb and Cr, in one plane or in two, of two rows of pixels or twice the same. */
static void fill_chroma(const pupil_v4l2_output *o, const uint8_t *top, const uint8_t *bottom, unsigned char *to,
                        uint32_t row)
{
    const size_t planar = pupil_pixel_planes(o->pixel) == 3, rows = pupil_chroma_rows(o->pixel, o->height);
    const int cr_first = o->pixel == PUPIL_PIXEL_NV21 || o->fourcc == V4L2_PIX_FMT_YVU420;
    unsigned char *first = to + (size_t)row * o->chroma_stride_bytes;
    unsigned char *second = first + (planar ? rows * o->chroma_stride_bytes : 1);
    unsigned char *cb = cr_first ? second : first, *cr = cr_first ? first : second;
    const size_t step = planar ? 1 : 2;
    for (uint32_t x = 0; x < o->width; x += 2, cb += step, cr += step) {
        const size_t left = (size_t)3 * x, right = x + 1 < o->width ? left + 3 : left;
        const uint8_t *const quad[4] = {top + left, top + right, bottom + left, bottom + right};
        chroma_of(o, quad, cb, cr);
    }
}

static void fill_planes(const pupil_v4l2_output *o, const pupil_image_const *rgb8, uint32_t y, unsigned char *to)
{
    const uint8_t *row = (const uint8_t *)rgb8->data + (ptrdiff_t)y * rgb8->stride_bytes;
    unsigned char *out = to + (size_t)y * o->stride_bytes, *chroma = to + (size_t)o->height * o->stride_bytes;
    for (uint32_t x = 0; x < o->width; x++)
        out[x] = luma_of(o, row + (size_t)3 * x);
    if (o->pixel == PUPIL_PIXEL_NV16)
        fill_chroma(o, row, row, chroma, y);
    else if (y % 2 == 0)
        fill_chroma(o, row, y + 1 < o->height ? row + rgb8->stride_bytes : row, chroma, y / 2);
}

void pupil_v4l2_output_fill(const pupil_v4l2_output *o, const pupil_image_const *rgb8, unsigned char *to)
{
    for (uint32_t y = 0; y < o->height; y++) {
        const uint8_t *row = (const uint8_t *)rgb8->data + (ptrdiff_t)y * rgb8->stride_bytes;
        if (is_packed_yuv(o))
            fill_packed_yuv(o, row, to + (size_t)y * o->stride_bytes);
        else if (is_rgb(o))
            fill_rgb(o, row, to + (size_t)y * o->stride_bytes);
        else
            fill_planes(o, rgb8, y, to);
    }
}
