/* A pupil_coding: its check, and its factors for the kernels. */
#include "object.h"

#include "base/fault.h"
#include "base/numeric.h"
#include "base/pixel.h"
#include "core/read.h"

static int all_zero(const float *x, int count)
{
    for (int i = 0; i < count; i++)
        if (x[i] != 0.0f)
            return 0;
    return 1;
}

static int all_within(const float *x, int count, double low, double high)
{
    for (int i = 0; i < count; i++)
        if (!within((double)x[i], low, high))
            return 0;
    return 1;
}

/* The number of knees has been checked. White 0 depends on the format: fault_for checks it. */
static const char *knee_fault(const pupil_coding *c)
{
    double code = (double)c->black, light = 0x1p-30;
    for (uint32_t i = 0; i < c->knees; i++) {
        if (!((double)c->knee_code[i] >= code + 1.0))
            return "knee_code must rise by at least 1 from black and from knee to knee";
        if (!((double)c->knee_light[i] > light && c->knee_light[i] < 1.0f))
            return "knee_light must rise from knee to knee, from above 2^-30 to below 1";
        code = (double)c->knee_code[i];
        light = (double)c->knee_light[i];
    }
    if (c->knees && (code > 65534.0 || (c->white != 0.0f && (double)c->white < code + 1.0)))
        return "knee_code must be at least 1 below white";
    return 0;
}

/* What is wrong for any format. */
static const char *fault_of(const pupil_coding *c)
{
    const int white_is_right = c->white == 0.0f || (c->white <= 65535.0f && c->white - c->black >= 1.0f);
    const pupil_rule rules[] = {
        {c->matrix < PUPIL_MATRIX_COUNT, "matrix must be a pupil_matrix"},
        {c->range < PUPIL_RANGE_COUNT, "range must be a pupil_range"},
        {c->light < PUPIL_LIGHT_COUNT, "light must be a pupil_light"},
        {c->bayer < PUPIL_BAYER_COUNT, "bayer must be a pupil_bayer"},
        {c->shift <= 6, "shift must be from 0 to the bits of the word that the format leaves over (at most 6)"},
        {within((double)c->black, 0.0, 65534.0), "black must be from 0 to 65534"},
        {white_is_right, "white must be 0 (the format's largest code) or from black + 1 to 65535"},
        {all_zero(c->balance, 3) || all_within(c->balance, 3, 0x1p-10, 0x1p10),
         "balance must be all 0, or each factor from 2^-10 to 2^10"},
        {all_within(c->rgb_from_camera, 9, -16.0, 16.0), "rgb_from_camera must be numbers from -16 to 16"},
        {c->knees <= PUPIL_KNEES, "knees must be from 0 to 8"},
    };
    const char *fault = first_fault(rules, sizeof rules / sizeof rules[0]);
    return fault ? fault : knee_fault(c);
}

/* What is wrong for grey and mosaics. */
static const char *fault_for(const pupil_coding *c, uint32_t pixel, uint32_t bits)
{
    if (c->shift > (pupil_pixel_bytes(pixel) == 2 ? 16 - bits : 0))
        return "shift must be 0, or in formats of 10, 12 or 14 bits in 16-bit words up to 16 - bits";
    if (c->white == 0.0f && c->black > (float)((1u << bits) - 2))
        return "black must be at least 1 below the format's largest code, where white is 0";
    if (pupil_pixel_is_mosaic(pixel) && c->light > PUPIL_LIGHT_LINEAR)
        return "light of a mosaic must be PUPIL_LIGHT_DEFAULT or PUPIL_LIGHT_LINEAR";
    if (c->knees && c->light > PUPIL_LIGHT_LINEAR)
        return "light must be PUPIL_LIGHT_DEFAULT or PUPIL_LIGHT_LINEAR where there are knees";
    if (c->knees && c->white == 0.0f && c->knee_code[c->knees - 1] > (float)((1u << bits) - 2))
        return "knee_code must be at least 1 below the format's largest code, where white is 0";
    return 0;
}

int pupil_coding_check(const pupil_coding *coding, uint32_t pixel, const char **why)
{
    pupil_coding own;
    if (!coding)
        return PUPIL_ERR_NULL;
    const uint32_t bits = pupil_pixel_bits(pixel);
    const char *fault = pupil_coding_read(&own, coding);
    if (!fault)
        fault = fault_of(&own);
    if (!fault && bits)
        fault = fault_for(&own, pixel, bits);
    if (fault && why)
        *why = fault;
    return fault ? PUPIL_ERR_CODING : PUPIL_OK;
}

/* Kr, Kb (coding.h has the sources) */
static const float luma_of_matrix[PUPIL_MATRIX_COUNT][2] = {
    [PUPIL_MATRIX_BT601] = {0.299f, 0.114f},
    [PUPIL_MATRIX_BT709] = {0.2126f, 0.0722f},
    [PUPIL_MATRIX_BT2020] = {0.2627f, 0.0593f},
};

/* The smallest factor from `about` on that takes span to at least `top`: full remains full with any rounding. */
static float unit_to(float top, float span)
{
    float unit = top / span;
    while (unit * span < top)
        unit = pupil_float_of_bits(pupil_bits_of_float(unit) + 1);
    return unit;
}

static void from_yuv(const pupil_coding *coding, uint32_t bits, pupil_coder *c)
{
    const float kr = luma_of_matrix[coding->matrix][0];
    const float kb = luma_of_matrix[coding->matrix][1];
    const float kg = 1.0f - kr - kb;
    const float one = (float)(1u << (bits - 8)), all = (float)((1u << bits) - 1); /* a code of 8 bits; the largest
                                                                                   * code */
    const int full = coding->range == PUPIL_RANGE_FULL;
    const float chroma = c->top / (full ? all : 224.0f * one);
    c->y_zero = full ? 0.0f : 16.0f * one;
    c->y_unit = unit_to(c->top, full ? all : 219.0f * one);
    const double unit = (double)c->top / (full ? (double)all : 219.0 * (double)one);
    c->y_coarse = pupil_float_of_bits(pupil_bits_of_float((float)unit) & 0xfffe0000u); /* 7 bits; codes have 16 */
    c->y_fine = (float)(unit - (double)c->y_coarse);
    c->red_v = 2.0f * (1.0f - kr) * chroma;
    c->blue_u = 2.0f * (1.0f - kb) * chroma;
    c->green_u = -c->blue_u * kb / kg;
    c->green_v = -c->red_v * kr / kg;
}

/* The code of the largest light. */
static float white_of(const pupil_coding *coding, uint32_t bits)
{
    return coding->white != 0.0f ? coding->white : (float)((1u << bits) - 1);
}

/* The lines between knees. The last one reaches white: full remains full. */
static void from_knees(const pupil_coding *coding, uint32_t bits, pupil_coder *c)
{
    pupil_line *line = c->line;
    float from = coding->black, light = 0.0f;
    c->lines = coding->knees + 1;
    for (uint32_t i = 0; i < coding->knees; i++) {
        const float slope = (coding->knee_light[i] - light) / (coding->knee_code[i] - from);
        line[i] = (pupil_line){from, light, slope};
        from = coding->knee_code[i];
        light = coding->knee_light[i];
    }
    const float span = white_of(coding, bits) - from;
    float slope = (1.0f - light) / span;
    while (light + span * slope < 1.0f)
        slope = pupil_float_of_bits(pupil_bits_of_float(slope) + 1);
    line[coding->knees] = (pupil_line){from, light, slope};
}

static void from_grey(const pupil_coding *coding, uint32_t bits, pupil_coder *c)
{
    c->shift = coding->shift;
    c->unit = 1.0f; /* codes, where there are knees */
    if (coding->knees) {
        from_knees(coding, bits, c);
        return;
    }
    c->zero = coding->black;
    c->unit = unit_to(1.0f, white_of(coding, bits) - coding->black);
}

static void from_mosaic(const pupil_coding *coding, uint32_t bits, pupil_coder *c)
{
    float balance[3] = {1.0f, 1.0f, 1.0f};
    for (int i = 0; i < 3 && !all_zero(coding->balance, 3); i++)
        balance[i] = coding->balance[i];
    c->zero4 = 4.0f * coding->black;
    c->full4 = 4.0f * white_of(coding, bits);
    c->black4 = (int32_t)(c->zero4 + 0.5f);
    c->most = balance[0];
    for (int i = 0; i < 3; i++) {
        c->unit4[i] = unit_to(balance[i], c->full4 - c->zero4);
        c->most = balance[i] < c->most ? balance[i] : c->most;
    }
    if (coding->knees) { /* factors apply to light, not to codes */
        from_knees(coding, bits, c);
        for (int i = 0; i < 3; i++)
            c->unit4[i] = balance[i];
    }
    c->shift = coding->shift;
    c->red_x = coding->bayer == PUPIL_BAYER_GRBG || coding->bayer == PUPIL_BAYER_BGGR;
    c->red_y = coding->bayer == PUPIL_BAYER_GBRG || coding->bayer == PUPIL_BAYER_BGGR;
    c->has_matrix = !all_zero(coding->rgb_from_camera, 9);
    for (int i = 0; i < 9; i++)
        c->matrix[i] = coding->rgb_from_camera[i];
}

static const pupil_coding usual = {0};

typedef struct curve {
    const float (*table)[2];
    float top, brightest;
} curve;

void pupil_coder_make(const pupil_coding *coding, uint32_t pixel, pupil_coder *c)
{
    static const curve curves[PUPIL_LIGHT_COUNT] = {[PUPIL_LIGHT_DEFAULT] = {0, 255.0f, 1.0f},
                                                    [PUPIL_LIGHT_LINEAR] = {0, 255.0f, 1.0f},
                                                    [PUPIL_LIGHT_SRGB] = {pupil_srgb_light, 255.0f, 1.0f},
                                                    [PUPIL_LIGHT_BT709] = {pupil_bt709_light, 255.0f, 1.0f},
                                                    [PUPIL_LIGHT_PQ] = {pupil_pq_light, PUPIL_PQ_TOP, 100.0f},
                                                    [PUPIL_LIGHT_HLG] = {pupil_hlg_light, PUPIL_HLG_TOP, 1.0f}};
    const pupil_pixel_layout layout = pupil_pixel_layout_of(pixel);
    const int coded = layout.yuv || pixel == PUPIL_PIXEL_RGB10A2;
    *c = (pupil_coder){0};
    coding = coding ? coding : &usual;
    const curve *light = &curves[coded && !coding->light ? (uint32_t)PUPIL_LIGHT_SRGB : coding->light];
    c->light = light->table;
    c->top = light->top;
    c->brightest = coded || layout.bits ? light->brightest : 1.0f; /* RGB has no curve of the coding */
    if (layout.yuv)
        from_yuv(coding, layout.yuv, c);
    else if (pixel == PUPIL_PIXEL_RGB10A2)
        c->unit = unit_to(c->top, 1023.0f);
    else if (pupil_pixel_is_mosaic(pixel))
        from_mosaic(coding, pupil_pixel_bits(pixel), c);
    else if (pupil_pixel_bits(pixel))
        from_grey(coding, pupil_pixel_bits(pixel), c);
}

/* The light of a value 0..top of the coder's curve. */
static float light_at(const pupil_coder *c, float value)
{
    const int below = (int)value;
    if (!c->light)
        return value / c->top;
    return c->light[below][0] + (value - (float)below) * c->light[below][1];
}

static float code_light(const pupil_coder *c, uint32_t pixel)
{
    const pupil_pixel_layout layout = pupil_pixel_layout_of(pixel);
    if (layout.yuv)
        return light_at(c, c->y_unit);
    if (pixel == PUPIL_PIXEL_RGB10A2)
        return light_at(c, c->unit);
    if (c->lines)
        return c->line[0].slope;
    if (layout.mosaic)
        return 4.0f / (c->full4 - c->zero4);
    if (layout.bits)
        return light_at(c, c->unit * c->top);
    if (layout.sample == 1)
        return pupil_srgb8_to_linear[1];
    return pixel == PUPIL_PIXEL_RGBA16 || pixel == PUPIL_PIXEL_RGB16 ? 1.0f / 65535.0f : 0.0f;
}

float pupil_code_light(const pupil_coder *c, uint32_t pixel)
{
    const float light = code_light(c, pixel);
    return light < 1.0f ? light : 1.0f; /* the only code of PQ may be far above */
}

static float magnitude(float x)
{
    return x < 0.0f ? -x : x;
}

/* Four codes of margin for rounding. */
void pupil_coder_find_ordinary(pupil_coder *coder, const pupil_row_job *job)
{
    const float most = job->clip < coder->most ? job->clip : coder->most;
    const float weights = magnitude(job->luma[0]) + magnitude(job->luma[1]) + magnitude(job->luma[2]);
    for (int i = 0; i < 3; i++) {
        /* at most four times the largest code, below 2^18 */
        coder->ordinary4[i] = (int32_t)(most / coder->unit4[i] + coder->zero4) - 4;
    }
    coder->close_to_1 =
        job->floor >= 0x1p-15f && weights * coder->most < 0x1p14f && coder->zero4 == (float)(int32_t)coder->zero4;
}

static int32_t in_q16(double x)
{
    return (int32_t)(x * 65536.0 + (x < 0.0 ? -0.5 : 0.5));
}

void pupil_chroma_coder_make(const pupil_coding *coding, pupil_chroma_coder *c)
{
    coding = coding ? coding : &usual;
    const double kr = (double)luma_of_matrix[coding->matrix][0];
    const double kb = (double)luma_of_matrix[coding->matrix][1];
    const int full = coding->range == PUPIL_RANGE_FULL;
    const double luma = full ? 1.0 : 219.0 / 255.0;
    const double chroma = full ? 0.5 : 0.5 * 224.0 / 255.0;
    c->y_zero = (full ? 0 : 16 * 65536) + 32768; /* and a half, to round */
    c->y[0] = in_q16(kr * luma);
    c->y[2] = in_q16(kb * luma);
    c->y[1] = in_q16(luma) - c->y[0] - c->y[2]; /* so that white is white */
    c->cb[2] = in_q16(chroma);
    c->cb[0] = in_q16(-kr / (1.0 - kb) * chroma);
    c->cb[1] = -c->cb[0] - c->cb[2]; /* so that grey has no colour */
    c->cr[0] = in_q16(chroma);
    c->cr[2] = in_q16(-kb / (1.0 - kr) * chroma);
    c->cr[1] = -c->cr[0] - c->cr[2];
}
