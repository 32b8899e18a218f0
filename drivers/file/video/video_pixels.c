/* drivers/file/video/video_pixels.c: one decoded video frame as an image; SDR to linear Rec.709 float, exactly. */
#include "video_pixels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file/common/transfer_curves.h"
#include "refuse.h"
#include "video_codes.h"
#include "video_rows.h"
#include "yuv_rows.h"

/* Largest entry of the light table: the unit of signals in this file. */
#define FULL (PUPIL_LIGHT_CODES - 1)

void pupil_video_pixels_free(pupil_video_pixels *p)
{
    free(p->pixels);
    free(p->codes);
    for (int i = 0; i < 3; i++)
        free(p->rows[i]);
    for (int i = 0; i < 2; i++)
        free(p->chroma_rows[i]);
    for (int i = 0; i < 3; i++)
        free(p->wide_rows[i]);
    free(p->planes);
    free(p->chroma_left);
    free(p->chroma_eighths);
    memset(p, 0, sizeof *p);
}

static int reserve_chroma(pupil_video_pixels *p, size_t width)
{
    p->codes = malloc(width * sizeof *p->codes);
    p->chroma_left = malloc(width * sizeof *p->chroma_left);
    p->chroma_eighths = malloc(width * sizeof *p->chroma_eighths);
    return !p->codes || !p->chroma_left || !p->chroma_eighths ? -1 : 0;
}

static int reserve_light(pupil_video_pixels *p, size_t width, size_t height)
{
    int missing = 0;
    p->pixels = malloc(width * height * 3 * sizeof *p->pixels);
    for (int i = 0; i < 3; i++)
        missing |= !(p->rows[i] = malloc(width * sizeof **p->rows));
    for (int i = 0; i < 2; i++)
        missing |= !(p->chroma_rows[i] = malloc((width + 1) * sizeof **p->chroma_rows));
    return missing || !p->pixels ? -1 : 0;
}

/* Rec. ITU-R BT.709-6 item 4.6, BT.2100-2 table 9: limited range is 219 (luma) and 224 (chroma) steps of 8 bits above
 * 16 and around 128; full range is all codes, chroma around the middle one. */
static void set_range(pupil_video_pixels *p, int is_full)
{
    for (int i = 0; i < 3; i++) {
        int depth = p->format->comp[p->is_grey ? 0 : i].depth, is_chroma = i > 0 && !p->is_rgb;
        double step = ldexp(1, depth - 8), steps = ldexp(1, depth) - 1;
        double span = is_full ? steps : (is_chroma ? 224 : 219) * step;
        double zero = is_chroma ? 128 * step : is_full ? 0 : 16 * step;
        p->offset[i] = (float)zero;
        p->gain[i] = (float)(FULL / span);
    }
}

static int set_matrix(pupil_video_pixels *p, int space, int primaries, pupil_why *why)
{
    double red, blue;
    if (p->is_rgb || p->is_grey)
        return 0;
    if (pupil_light_luma(&red, &blue, (enum AVColorSpace)space, (enum AVColorPrimaries)primaries)) {
        const char *name = av_color_space_name((enum AVColorSpace)space);
        return pupil_refuse(
            why, "its colour matrix %s cannot be read; bt709, bt2020nc, smpte170m, bt470bg, smpte240m and fcc can",
            name ? name : "(unknown)");
    }
    double green = 1 - red - blue;
    p->red_v = (float)(2 * (1 - red));
    p->blue_u = (float)(2 * (1 - blue));
    p->green_v = (float)(-2 * (1 - red) * red / green);
    p->green_u = (float)(-2 * (1 - blue) * blue / green);
    return 0;
}

static int set_light(pupil_video_pixels *p, int transfer, int primaries, pupil_why *why)
{
    double matrix[9];
    if (pupil_light_table(p->light, (enum AVColorTransferCharacteristic)transfer)) {
        const char *name = av_color_transfer_name((enum AVColorTransferCharacteristic)transfer);
        return pupil_refuse(
            why,
            "its transfer curve %s cannot be read; PQ (smpte2084), HLG (arib-std-b67), bt709 and its kin, "
            "iec61966-2-1, gamma22, gamma28 and linear can",
            name ? name : "(unknown)");
    }
    if (pupil_light_to_rec709(matrix, (enum AVColorPrimaries)primaries)) {
        const char *name = av_color_primaries_name((enum AVColorPrimaries)primaries);
        return pupil_refuse(why, "its primaries %s cannot be read; bt709, bt2020, smpte432 and the like can",
                            name ? name : "(unknown)");
    }
    p->has_709_primaries = matrix[0] == 1;
    for (int i = 0; i < 9; i++)
        p->to_709[i / 3][i % 3] = (float)matrix[i];
    return 0;
}

static int is_readable(const AVPixFmtDescriptor *d, int format)
{
    const uint64_t odd = AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL |
                         AV_PIX_FMT_FLAG_BAYER | AV_PIX_FMT_FLAG_FLOAT;
    if (!d || d->flags & odd || format == AV_PIX_FMT_XYZ12LE || format == AV_PIX_FMT_XYZ12BE)
        return 0;
    for (int i = 0; i < d->nb_components; i++)
        if (d->comp[i].depth > 16)
            return 0;
    return 1;
}

static int is_yuvj(int format)
{
    return format == AV_PIX_FMT_YUVJ411P || format == AV_PIX_FMT_YUVJ420P || format == AV_PIX_FMT_YUVJ422P ||
           format == AV_PIX_FMT_YUVJ440P || format == AV_PIX_FMT_YUVJ444P;
}

/* What is not tagged is filled in as the header says. */
static int is_open(int primaries)
{
    return primaries == AVCOL_PRI_UNSPECIFIED || primaries == AVCOL_PRI_RESERVED0 || primaries == AVCOL_PRI_RESERVED;
}

static int filled_in(int transfer, int primaries, int space)
{
    const int is_2020 = pupil_video_is_coded(transfer) || space == AVCOL_SPC_BT2020_NCL;
    return !is_open(primaries) ? primaries : is_2020 ? AVCOL_PRI_BT2020 : AVCOL_PRI_BT709;
}

uint32_t pupil_video_primaries(int transfer, int primaries, int space)
{
    const int is_2020 = filled_in(transfer, primaries, space) == AVCOL_PRI_BT2020;
    return pupil_video_is_coded(transfer) && is_2020 ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709;
}

static pupil_video_tags resolve(const pupil_video_pixels *p, const AVFrame *f)
{
    pupil_video_tags t = {.space = f->colorspace, .transfer = f->color_trc, .primaries = f->color_primaries};
    if (t.space == AVCOL_SPC_UNSPECIFIED || t.space == AVCOL_SPC_RESERVED || t.space == AVCOL_SPC_RGB) {
        if (pupil_video_is_coded(t.transfer) || t.primaries == AVCOL_PRI_BT2020)
            t.space = AVCOL_SPC_BT2020_NCL;
        else
            t.space = pupil_yuv_matrix_of((uint32_t)f->width, (uint32_t)f->height) == PUPIL_YUV_709
                          ? AVCOL_SPC_BT709
                          : AVCOL_SPC_SMPTE170M;
    }
    t.primaries = filled_in(t.transfer, t.primaries, f->colorspace);
    if (t.space == AVCOL_SPC_CHROMA_DERIVED_NCL && t.primaries == AVCOL_PRI_BT709)
        t.space = AVCOL_SPC_BT709;
    else if (t.space == AVCOL_SPC_CHROMA_DERIVED_NCL && t.primaries == AVCOL_PRI_BT2020)
        t.space = AVCOL_SPC_BT2020_NCL;
    t.is_full = p->is_rgb || is_yuvj(f->format) || f->color_range == AVCOL_RANGE_JPEG ||
                (p->is_grey && f->color_range != AVCOL_RANGE_MPEG);
    return t;
}

static float code_light(const pupil_video_pixels *p, int transfer)
{
    const int is_sdr = transfer != AVCOL_TRC_LINEAR && !pupil_video_is_coded(transfer);
    return is_sdr ? PUPIL_SDR_CODE_LIGHT : p->light[(uint32_t)(p->gain[0] + 0.5f)];
}

static int set_pixels(pupil_video_pixels *p, const pupil_video_tags *tags, pupil_why *why)
{
    if (reserve_light(p, (size_t)p->kind.width, (size_t)p->kind.height))
        return pupil_refuse(why, "not enough memory for a frame of %d x %d", p->kind.width, p->kind.height);
    set_range(p, tags->is_full);
    if (set_matrix(p, tags->space, tags->primaries, why) || set_light(p, tags->transfer, tags->primaries, why))
        return -1;
    p->code_light = code_light(p, tags->transfer);
    p->image = pupil_image_const_of(p->pixels, (uint32_t)p->kind.width, (uint32_t)p->kind.height, PUPIL_PIXEL_RGB32F);
    return 0;
}

static int set_kind(pupil_video_pixels *p, const pupil_video_kind *kind, const AVFrame *f, pupil_why *why)
{
    pupil_video_pixels_free(p);
    p->format = av_pix_fmt_desc_get((enum AVPixelFormat)f->format);
    if (!is_readable(p->format, f->format))
        return pupil_refuse(why, "its pixel format %s cannot be read; RGB, grey and YUV of up to 16 bits can",
                            p->format ? p->format->name : "(unknown)");
    p->is_rgb = (p->format->flags & AV_PIX_FMT_FLAG_RGB) != 0;
    p->is_grey = p->format->nb_components < 3;
    p->kind = *kind;
    const pupil_video_tags tags = resolve(p, f);
    int failed = reserve_chroma(p, (size_t)f->width);
    p->is_coded = pupil_video_is_coded(tags.transfer) &&
                  (tags.primaries == AVCOL_PRI_BT709 || tags.primaries == AVCOL_PRI_BT2020);
    p->primaries = pupil_video_primaries(tags.transfer, tags.primaries, tags.space);
    if (failed) {
        pupil_refuse(why, "not enough memory for a frame of %d x %d", f->width, f->height);
    } else {
        pupil_video_set_chroma(p, f->chroma_location);
        failed = p->is_coded ? pupil_video_codes_set(p, &tags, why) : set_pixels(p, &tags, why);
    }
    if (failed)
        pupil_video_pixels_free(p);
    return failed;
}

/* One row of one component, in table units. */
static void read_row(pupil_video_pixels *p, const AVFrame *f, int component, int y, int width, float *out)
{
    float offset = p->offset[component], gain = p->gain[component];
    const uint16_t *codes = pupil_video_read_codes(p, f, component, y, width);
    for (int x = 0; x < width; x++)
        out[x] = ((float)codes[x] - offset) * gain;
}

/* Chroma for the luma row y: linear between the two rows of chroma around it, then between the two samples. */
static void read_chroma(pupil_video_pixels *p, const AVFrame *f, int component, int y)
{
    int width = AV_CEIL_RSHIFT(f->width, p->format->log2_chroma_w);
    float *top = p->chroma_rows[0], *bottom = p->chroma_rows[1], *out = p->rows[component];
    const pupil_video_chroma_rows rows = pupil_video_chroma_rows_at(p, f, y);
    const float share = (float)rows.eighths / 8;
    read_row(p, f, component, rows.upper, width, top);
    if (share > 0 && rows.lower != rows.upper) {
        read_row(p, f, component, rows.lower, width, bottom);
        for (int x = 0; x < width; x++)
            top[x] += share * (bottom[x] - top[x]);
    }
    top[width] = top[width - 1];
    for (int x = 0; x < f->width; x++) {
        const float *c = top + p->chroma_left[x];
        out[x] = c[0] + (float)p->chroma_eighths[x] / 8 * (c[1] - c[0]);
    }
}

static float light(const pupil_video_pixels *p, float signal)
{
    signal = signal > 0 ? signal : 0;
    signal = signal < FULL ? signal : FULL;
    return p->light[(uint32_t)(signal + 0.5f)];
}

static void convert_row(pupil_video_pixels *p, const AVFrame *f, int y, float *out)
{
    const float *a = p->rows[0], *b = p->rows[p->is_grey ? 0 : 1], *c = p->rows[p->is_grey ? 0 : 2];
    for (int i = 0; i < (p->is_grey ? 1 : 3); i++)
        if (i == 0 || p->is_rgb)
            read_row(p, f, i, y, f->width, p->rows[i]);
        else
            read_chroma(p, f, i, y);
    for (int x = 0; x < f->width; x++, out += 3) {
        float r = a[x], g = b[x], blue = c[x];
        if (!p->is_rgb && !p->is_grey) {
            r = a[x] + p->red_v * c[x];
            g = a[x] + p->green_u * b[x] + p->green_v * c[x];
            blue = a[x] + p->blue_u * b[x];
        }
        out[0] = light(p, r);
        out[1] = light(p, g);
        out[2] = light(p, blue);
    }
}

/* Each row of the matrix sums to 1; computed with differences, grey stays grey to the last bit. */
static void to_rec709(const pupil_video_pixels *p, float *pixel, int count)
{
    for (int x = 0; x < count; x++, pixel += 3) {
        float r = pixel[0], g = pixel[1], b = pixel[2];
        pixel[0] = r + p->to_709[0][1] * (g - r) + p->to_709[0][2] * (b - r);
        pixel[1] = g + p->to_709[1][0] * (r - g) + p->to_709[1][2] * (b - g);
        pixel[2] = b + p->to_709[2][0] * (r - b) + p->to_709[2][1] * (g - b);
    }
}

int pupil_video_pixels_convert(pupil_video_pixels *p, const AVFrame *f, pupil_why *why)
{
    const pupil_video_kind kind = {f->width,       f->height,    f->format,          f->colorspace,
                                   f->color_range, f->color_trc, f->color_primaries, f->chroma_location};
    if (memcmp(&kind, &p->kind, sizeof kind) && set_kind(p, &kind, f, why))
        return -1;
    if (p->is_coded)
        pupil_video_codes_convert(p, f);
    for (int y = 0; y < f->height && !p->is_coded; y++) {
        float *row = p->pixels + (size_t)y * (size_t)f->width * 3;
        convert_row(p, f, y, row);
        if (!p->has_709_primaries)
            to_rec709(p, row, f->width);
    }
    return 0;
}
