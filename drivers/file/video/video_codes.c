#include "video_codes.h"

#include <stdlib.h>

#include "refuse.h"
#include "video_rows.h"

int pupil_video_is_coded(int transfer)
{
    return transfer == AVCOL_TRC_SMPTE2084 || transfer == AVCOL_TRC_ARIB_STD_B67;
}

/* --- a kind of frames --- */

static int set_matrix(pupil_video_pixels *p, int space, pupil_why *why)
{
    if (p->is_rgb || p->is_grey) { /* the driver's own choice; grey has no chroma */
        p->coding.matrix = p->primaries == PUPIL_PRIMARIES_BT2020 ? PUPIL_MATRIX_BT2020 : PUPIL_MATRIX_BT709;
        return 0;
    }
    switch (space) {
    case AVCOL_SPC_BT709:
        p->coding.matrix = PUPIL_MATRIX_BT709;
        return 0;
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
        p->coding.matrix = PUPIL_MATRIX_BT601;
        return 0;
    case AVCOL_SPC_BT2020_NCL:
        p->coding.matrix = PUPIL_MATRIX_BT2020;
        return 0;
    default:
        break;
    }
    const char *name = av_color_space_name((enum AVColorSpace)space);
    return pupil_refuse(
        why, "its colour matrix %s cannot be read with PQ and HLG; bt709, bt2020nc, smpte170m and bt470bg can",
        name ? name : "(unknown)");
}

/* Rec. ITU-R BT.2100-2, table 9: limited range has the 8-bit codes with zero bits appended; full range has fractions of
 * the largest code, with chroma around half of a power of two. */
static void set_scale(pupil_video_pixels *p)
{
    const int is_full = p->coding.range == PUPIL_RANGE_FULL, depth = p->format->comp[0].depth;
    const double steps = (double)((1 << depth) - 1), middle = (double)(1 << (depth - 1));
    const double factor = is_full ? 65535.0 / steps : (double)(1 << (16 - depth));
    for (int is_chroma = 0; is_chroma < 2; is_chroma++) {
        const double zero = is_chroma && is_full ? 32768.0 - middle * factor : 0.0;
        p->to_16[is_chroma][0] = (float)(factor / 64.0);
        p->to_16[is_chroma][1] = (float)(zero + 0.5);
    }
}

static int reserve(pupil_video_pixels *p)
{
    const size_t width = (size_t)p->kind.width, samples = width * (size_t)p->kind.height;
    int missing = !(p->planes = malloc(3 * samples * sizeof *p->planes));
    for (int i = 0; i < 3; i++)
        missing |= !(p->wide_rows[i] = malloc((width + 1) * sizeof **p->wide_rows));
    return missing ? -1 : 0;
}

int pupil_video_codes_set(pupil_video_pixels *p, const pupil_video_tags *tags, pupil_why *why)
{
    const uint32_t width = (uint32_t)p->kind.width, height = (uint32_t)p->kind.height;
    p->coding = (pupil_coding){.range = tags->is_full ? PUPIL_RANGE_FULL : PUPIL_RANGE_LIMITED,
                               .light = tags->transfer == AVCOL_TRC_SMPTE2084 ? PUPIL_LIGHT_PQ : PUPIL_LIGHT_HLG};
    if (set_matrix(p, tags->space, why))
        return -1;
    if (reserve(p))
        return pupil_refuse(why, "not enough memory for a frame of %u x %u", width, height);
    set_scale(p);
    for (size_t i = 0; p->is_grey && i < 2 * (size_t)width * height; i++)
        p->planes[(size_t)width * height + i] = 32768;
    p->image = pupil_image_const_of(p->planes, width, height, PUPIL_PIXEL_I444_16);
    p->image.coding = &p->coding;
    return 0;
}

/* --- a frame --- */

static uint16_t word_of(float code)
{
    code = code > 0 ? code : 0;
    code = code < 65535 ? code : 65535;
    return (uint16_t)(int32_t)code;
}

static void put_luma(pupil_video_pixels *p, const AVFrame *f, int y, uint16_t *restrict out)
{
    const uint16_t *restrict codes = pupil_video_read_codes(p, f, 0, y, f->width);
    const float factor = 64 * p->to_16[0][0], sum = p->to_16[0][1];
    for (int x = 0; x < f->width; x++)
        out[x] = word_of((float)codes[x] * factor + sum);
}

/* Linear between the two rows of chroma around the row y, then between the two samples. */
static void put_chroma(pupil_video_pixels *p, const AVFrame *f, int component, int y, uint16_t *restrict out)
{
    const int width = AV_CEIL_RSHIFT(f->width, p->format->log2_chroma_w);
    const pupil_video_chroma_rows rows = pupil_video_chroma_rows_at(p, f, y);
    const float factor = p->to_16[1][0], sum = p->to_16[1][1];
    uint32_t *restrict mixed = p->wide_rows[0];
    const uint16_t *codes = pupil_video_read_codes(p, f, component, rows.upper, width);
    for (int x = 0; x < width; x++)
        mixed[x] = (8 - rows.eighths) * codes[x];
    codes = pupil_video_read_codes(p, f, component, rows.lower, width);
    for (int x = 0; x < width; x++)
        mixed[x] += rows.eighths * codes[x];
    mixed[width] = mixed[width - 1];
    for (int x = 0; x < f->width; x++) {
        const uint32_t *of = mixed + p->chroma_left[x], share = p->chroma_eighths[x];
        out[x] = word_of((float)(int32_t)((8 - share) * of[0] + share * of[1]) * factor + sum);
    }
}

/* Kr and Kb of BT.709-6, item 3.2, and BT.2020-2, table 4. */
static void put_rgb(pupil_video_pixels *p, const AVFrame *f, int y, uint16_t *const out[3])
{
    const int is_2020 = p->coding.matrix == PUPIL_MATRIX_BT2020;
    const float kr = is_2020 ? 0.2627f : 0.2126f, kb = is_2020 ? 0.0593f : 0.0722f;
    const float factor = 64 * p->to_16[0][0];
    for (int i = 0; i < 3; i++) {
        const uint16_t *codes = pupil_video_read_codes(p, f, i, y, f->width);
        for (int x = 0; x < f->width; x++)
            p->wide_rows[i][x] = codes[x];
    }
    for (int x = 0; x < f->width; x++) {
        const float r = (float)p->wide_rows[0][x] * factor, g = (float)p->wide_rows[1][x] * factor;
        const float b = (float)p->wide_rows[2][x] * factor, luma = g + kr * (r - g) + kb * (b - g);
        out[0][x] = word_of(luma + 0.5f);
        out[1][x] = word_of((b - luma) / (2 * (1 - kb)) + 32768.5f);
        out[2][x] = word_of((r - luma) / (2 * (1 - kr)) + 32768.5f);
    }
}

void pupil_video_codes_convert(pupil_video_pixels *p, const AVFrame *f)
{
    const size_t width = (size_t)f->width, plane = width * (size_t)f->height;
    for (int y = 0; y < f->height; y++) {
        uint16_t *const out = p->planes + width * (size_t)y, *const rows[3] = {out, out + plane, out + 2 * plane};
        if (p->is_rgb) {
            put_rgb(p, f, y, rows);
            continue;
        }
        put_luma(p, f, y, rows[0]);
        for (int i = 1; i < 3 && !p->is_grey; i++)
            put_chroma(p, f, i, y, rows[i]);
    }
}
