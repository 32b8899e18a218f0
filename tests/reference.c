#include "reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/pixel_light.h"

void ref_light(const pupil_image_const *image, uint32_t x, uint32_t y, int quad, long double rgba[4])
{
    double light[4];
    pixel_light(image, x, y, quad, light);
    for (int c = 0; c < 4; c++)
        rgba[c] = light[c];
}

float ref_luminance(const float weight[3], const float rgb[3])
{
    /* volatile: each product and sum is rounded to binary32, even if the compiler would fuse them */
    volatile float r = weight[0] * rgb[0], g = weight[1] * rgb[1], b = weight[2] * rgb[2];
    volatile float rg = r + g;
    return rg + b;
}

unsigned ref_cell(const pupil_config *config, uint32_t x, uint32_t y, uint32_t width, uint32_t height)
{
    return config->weight[(2 * y + 1) * 16 / (2 * height)][(2 * x + 1) * 16 / (2 * width)];
}

/* The samples as binary32. 16-bit ones are code * (1 / 65535), stats.h. */
static void ref_floats(uint32_t pixel, const long double rgba[4], float rgb[3])
{
    const int is_16 = pixel == PUPIL_PIXEL_RGBA16 || pixel == PUPIL_PIXEL_RGB16;
    for (int c = 0; c < 3; c++)
        rgb[c] = is_16 ? (float)roundl(rgba[c] * 65535) * (1.0f / 65535.0f) : (float)rgba[c];
}

static float format_top(uint32_t pixel)
{
    switch (pixel) {
    case PUPIL_PIXEL_RGBA32F:
    case PUPIL_PIXEL_RGB32F:
        return 0x1p30f;
    case PUPIL_PIXEL_RGBA16F:
        return 65504;
    default:
        return 1;
    }
}

typedef struct counted {
    float luminance, clamped, brightest; /* the last two clamped */
    long double exact;                   /* clamped */
    int black, clipped, bad;
} counted;

/* The channel weights of luminance. */
typedef struct weights {
    long double exact[3];
    float rounded[3];
} weights;

static counted count_pixel(const pupil_config *config, const weights *w, const pupil_image_const *image, uint32_t x,
                           uint32_t y)
{
    long double rgba[4];
    float rgb[3];
    counted p = {0};
    const float clip = config->clip > 0 ? config->clip : format_top(image->pixel);
    ref_light(image, x, y, 0, rgba);
    ref_floats(image->pixel, rgba, rgb);
    p.luminance = ref_luminance(w->rounded, rgb);
    p.bad = !isfinite(p.luminance);
    p.black = !p.bad && p.luminance <= config->floor;
    p.clipped = !p.bad && (rgb[0] >= clip || rgb[1] >= clip || rgb[2] >= clip);
    p.clamped = p.luminance > config->floor ? fminf(p.luminance, 0x1p30f) : config->floor;
    /* a pixel without a luminance has no brightest channel either */
    p.brightest = isnan(p.luminance) ? config->floor : fmaxf(rgb[0], fmaxf(rgb[1], rgb[2]));
    p.brightest = p.brightest > config->floor ? fminf(p.brightest, 0x1p30f) : config->floor;
    p.exact = w->exact[0] * rgba[0] + w->exact[1] * rgba[1] + w->exact[2] * rgba[2];
    p.exact = p.exact > config->floor ? fminl(p.exact, REF_TOP) : config->floor;
    if (p.bad)
        p.exact = p.clamped;
    return p;
}

/* The exponent and the top bits of the fraction, from 2^-32 on. */
static uint32_t bin_of(float light, int fraction_bits)
{
    uint32_t bits;
    memcpy(&bits, &light, 4);
    return (bits >> (23 - fraction_bits)) - ((127 - 32) << fraction_bits);
}

void ref_meter_frame(const pupil_config *config, const pupil_image_const *image, ref_meter *meter)
{
    long double pixels_sum = 0, floats_sum = 0;
    long double exact = 1, log2_exact = 0; /* of the pixel before: many frames are uniform */
    weights w;
    ref_weights(config, w.exact, w.rounded);
    memset(meter, 0, sizeof *meter);
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            const unsigned weight = ref_cell(config, x, y, image->width, image->height);
            const unsigned band = (unsigned)((uint64_t)y * PUPIL_BANDS / image->height);
            if (!weight)
                continue;
            const counted p = count_pixel(config, &w, image, x, y);
            log2_exact = p.exact == exact ? log2_exact : log2l(p.exact);
            exact = p.exact;
            const long double log2_float = p.clamped == exact ? log2_exact : log2l(p.clamped);
            pixels_sum += weight * log2_exact;
            floats_sum += weight * log2_float;
            meter->pixels++;
            meter->weight += weight;
            meter->black += (unsigned)p.black;
            meter->clipped += (unsigned)p.clipped;
            meter->bad += (unsigned)p.bad;
            meter->bin[bin_of(p.clamped, 3)] += weight;
            meter->peak_bin[bin_of(p.brightest, 2)] += weight;
            meter->peak = fmaxf(meter->peak, p.brightest);
            meter->band_sum[band] += log2_float;
            meter->band_pixels[band]++;
        }
    meter->mean_of_pixels = meter->weight ? pixels_sum / meter->weight : 0;
    meter->mean_of_floats = meter->weight ? floats_sum / meter->weight : 0;
}

static int by_luminance(const void *a, const void *b)
{
    const long double x = ((const struct ref_item *)a)->log2_luminance,
                      y = ((const struct ref_item *)b)->log2_luminance;
    return (x > y) - (x < y);
}

void ref_order_make(const pupil_config *config, const pupil_image_const *image, ref_order *order)
{
    weights w;
    ref_weights(config, w.exact, w.rounded);
    order->count = 0;
    order->weight = 0;
    order->item = malloc((size_t)image->width * image->height * sizeof *order->item);
    if (!order->item)
        abort();
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            const unsigned weight = ref_cell(config, x, y, image->width, image->height);
            if (!weight)
                continue;
            order->item[order->count].log2_luminance = log2l(count_pixel(config, &w, image, x, y).clamped);
            order->item[order->count++].weight = weight;
            order->weight += weight;
        }
    qsort(order->item, order->count, sizeof *order->item, by_luminance);
}

void ref_order_free(ref_order *order)
{
    free(order->item);
}

long double ref_trimmed(const ref_order *order, double low, double high)
{
    const long double from = low * (long double)order->weight, to = high * (long double)order->weight;
    long double at = 0, sum = 0;
    for (size_t i = 0; i < order->count; i++) {
        const long double next = at + order->item[i].weight;
        const long double kept = fminl(next, to) - fmaxl(at, from);
        if (kept > 0)
            sum += kept * order->item[i].log2_luminance;
        at = next;
    }
    return sum / (to - from);
}

void ref_quantile(const ref_order *order, double q, long double *left, long double *right)
{
    const long double share = q * (long double)order->weight;
    long double at = 0;
    *left = *right = order->item[0].log2_luminance;
    for (size_t i = 0; i < order->count && at <= share; i++) {
        *right = order->item[i].log2_luminance;
        if (at < share)
            *left = order->item[i].log2_luminance;
        at += order->item[i].weight;
    }
}

long double ref_encode(uint32_t transfer, long double light)
{
    if (!(light > 0))
        return 0;
    if (light >= 1)
        return 255;
    if (transfer == PUPIL_TRANSFER_GAMMA22)
        light = powl(light, 1 / 2.2L);
    else if (transfer == PUPIL_TRANSFER_SRGB)
        light = light <= 0.0031308L ? 12.92L * light : 1.055L * powl(light, 1 / 2.4L) - 0.055L;
    return 255 * light;
}

/* --- primaries: SMPTE RP 177 from the chromaticities, by Cramer's rule --- */

static long double determinant(const long double m[9])
{
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

/* x with m x = y */
static void solve(const long double m[9], const long double y[3], long double x[3])
{
    const long double d = determinant(m);
    for (int k = 0; k < 3; k++) {
        long double with[9];
        memcpy(with, m, sizeof with);
        for (int i = 0; i < 3; i++)
            with[3 * i + k] = y[i];
        x[k] = determinant(with) / d;
    }
}

/* Computed once for each, because every pixel needs it. */
static void xyz_of(uint32_t bt2020, long double m[9])
{
    static long double made[2][9];
    static const long double xy[2][6] = {{0.64L, 0.33L, 0.30L, 0.60L, 0.15L, 0.06L},
                                         {0.708L, 0.292L, 0.170L, 0.797L, 0.131L, 0.046L}};
    const long double white[3] = {0.3127L / 0.3290L, 1, (1 - 0.3127L - 0.3290L) / 0.3290L};
    long double amount[3];
    memcpy(m, made[bt2020], sizeof made[bt2020]);
    if (m[3] != 0)
        return;
    for (int k = 0; k < 3; k++) {
        const long double x = xy[bt2020][2 * k], y = xy[bt2020][2 * k + 1];
        m[k] = x / y;
        m[3 + k] = 1;
        m[6 + k] = (1 - x - y) / y;
    }
    solve(m, white, amount);
    for (int i = 0; i < 9; i++)
        m[i] *= amount[i % 3];
    memcpy(made[bt2020], m, sizeof made[bt2020]);
}

/* For BT.709 as given; for BT.2020 converted to the same light. */
void ref_weights(const pupil_config *config, long double exact[3], float rounded[3])
{
    static const long double bt709[3] = {0.2126L, 0.7152L, 0.0722L};
    const float *y = config->rgb_to_xyz + 3;
    const long double sum = (long double)y[0] + y[1] + y[2];
    long double in[9], out[9];
    for (int c = 0; c < 3; c++)
        exact[c] = config->primaries == PUPIL_PRIMARIES_BT709 ? bt709[c] : y[c] / sum;
    if (config->primaries == PUPIL_PRIMARIES_BT2020) {
        xyz_of(1, in);
        xyz_of(0, out);
        for (int c = 0; c < 3; c++) {
            const long double primary[3] = {in[c], in[3 + c], in[6 + c]};
            long double light[3];
            solve(out, primary, light);
            exact[c] = bt709[0] * light[0] + bt709[1] * light[1] + bt709[2] * light[2];
        }
    }
    for (int c = 0; c < 3; c++)
        rounded[c] = (float)exact[c];
}

/* --- beyond the gamut: pupil.h, pupil_curve --- */

/* Ottosson 2020, M1, of RGB in the picture's primaries; scaled, so that white is 1, 1, 1. */
static void cones_of(const pupil_config *picture, long double cones[9])
{
    static const long double of_xyz[9] = {0.8189330101L, 0.3618667424L, -0.1288597137L, 0.0329845436L, 0.9293118715L,
                                          0.0361456387L, 0.0482003018L, 0.2643662691L,  0.6338517070L};
    long double xyz[9];
    xyz_of(picture->primaries == PUPIL_PRIMARIES_BT2020, xyz);
    for (int i = 0; i < 9 && picture->primaries == PUPIL_PRIMARIES_MATRIX; i++)
        xyz[i] = picture->rgb_to_xyz[i];
    for (int i = 0; i < 9; i += 3) {
        for (int j = 0; j < 3; j++)
            cones[i + j] = of_xyz[i] * xyz[j] + of_xyz[i + 1] * xyz[3 + j] + of_xyz[i + 2] * xyz[6 + j];
        const long double white = cones[i] + cones[i + 1] + cones[i + 2];
        for (int j = 0; j < 3; j++)
            cones[i + j] /= white;
    }
}

static long double largest_of(const long double v[3])
{
    return fmaxl(v[0], fmaxl(v[1], v[2]));
}

/* D: its display luminance. */
static void fit(const pupil_config *picture, long double D, long double gamut, long double light[3])
{
    const long double k = gamut > 0 ? PUPIL_GAMUT_KNEE : 1, m = largest_of(light), x = (m - D) / (1 - D);
    if (D >= 1)
        light[0] = light[1] = light[2] = 1;
    if (D >= 1 || x <= k)
        return;
    const long double most = fminl(1, D + (1 - D) * (k + (x - k) / (1 + gamut * (m / (1 - D) - k))));
    const long double part = fminl(1, D * D * D * (m - most) / (most * (m - D)));
    long double cones[9], response[3];
    cones_of(picture, cones);
    for (int i = 0; i < 3; i++) {
        const long double *row = cones + 3 * i;
        response[i] = cbrtl(row[0] * light[0] + row[1] * light[1] + row[2] * light[2]);
    }
    const long double grey = response[1];
    for (int i = 0; i < 3; i++)
        response[i] = powl((1 - part) * response[i] + part * grey, 3);
    solve(cones, response, light);
    const long double reached = largest_of(light);
    for (int c = 0; c < 3; c++)
        light[c] = fmaxl(0, light[c] * most / reached);
}

int ref_to_picture(const pupil_config *config, long double light[3])
{
    long double in[9], out[9], xyz[3] = {0};
    if (config->output_primaries == PUPIL_OUTPUT_AS_INPUT || config->output_primaries == config->primaries + 1)
        return 0;
    for (int c = 0; c < 3; c++)
        light[c] = light[c] > 0x1p31L ? 0x1p31L : light[c] < -0x1p31L ? -0x1p31L : light[c];
    if (config->primaries != PUPIL_PRIMARIES_MATRIX)
        xyz_of(config->primaries == PUPIL_PRIMARIES_BT2020, in);
    for (int i = 0; i < 9 && config->primaries == PUPIL_PRIMARIES_MATRIX; i++)
        in[i] = config->rgb_to_xyz[i] /
                ((long double)config->rgb_to_xyz[3] + config->rgb_to_xyz[4] + config->rgb_to_xyz[5]);
    for (int i = 0; i < 9; i++)
        xyz[i / 3] += in[i] * light[i % 3];
    xyz_of(config->output_primaries == PUPIL_OUTPUT_BT2020, out);
    solve(out, xyz, light);
    for (int c = 0; c < 3; c++)
        light[c] = light[c] > 0 ? light[c] : 0; /* NaN, too */
    return 1;
}

/* What a pixel's values are multiplied by; pupil.h, pupil_curve. */
static long double gain_of(const pupil_curve *curve, long double luminance)
{
    const long double u = curve->scale * luminance, t = fmaxl(1, curve->knot_scale * luminance);
    if (!curve->knots)
        return curve->scale * (1 + u * curve->inverse_white_squared) / (1 + u);
    int stop;
    const long double fraction = 2 * frexpl(fminl(t, 0x1p16L), &stop) - 1;
    const int reached = 8 * (stop - 1) + (int)(8 * fraction),
              k = reached < PUPIL_CURVE_KNOTS ? reached : PUPIL_CURVE_KNOTS - 1;
    long double root = curve->knot[k];
    if (k < PUPIL_CURVE_KNOTS - 1) {
        const long double here = ldexpl(1 + k % 8 / 8.0L, k / 8), next = ldexpl(1 + (k + 1) % 8 / 8.0L, (k + 1) / 8);
        root += (t - here) / (next - here) * ((long double)curve->knot[k + 1] - curve->knot[k]);
    }
    if (curve->levels)
        root = fminl(floorl(root * curve->levels), curve->levels - 1) / (curve->levels - 1);
    return curve->knot_scale * root * root / t;
}

void ref_map(const pupil_config *config, const pupil_curve *curve, const long double rgba[4], long double code[3])
{
    long double exact[3], light[3], luminance;
    float rounded[3], rgb[3];
    pupil_config picture = *config;
    long double given[3] = {rgba[0], rgba[1], rgba[2]};
    if (ref_to_picture(config, given))
        picture.primaries = config->output_primaries - 1;
    ref_weights(&picture, exact, rounded);
    for (int c = 0; c < 3; c++) {
        rgb[c] = (float)given[c];
        light[c] = given[c] > 0 ? fminl(given[c], 0x1p31L) : 0; /* NaN goes to 0; pupil.h, pupil_curve */
    }
    luminance = exact[0] * given[0] + exact[1] * given[1] + exact[2] * given[2];
    if (!isfinite(ref_luminance(rounded, rgb)))
        luminance = ref_luminance(rounded, rgb);
    if (isnan(luminance)) /* a pixel whose luminance is NaN is black */
        light[0] = light[1] = light[2] = 0;
    luminance = luminance > 0 ? fminl(luminance, REF_TOP) : 0;
    const long double gain = gain_of(curve, luminance);
    const long double display = luminance * gain;
    for (int c = 0; c < 3; c++)
        light[c] *= gain;
    if (largest_of(light) > 0)
        fit(&picture, display, curve->gamut, light);
    for (int c = 0; c < 3; c++)
        code[c] = ref_encode(config->transfer, light[c]);
}

long double ref_alpha(const long double rgba[4])
{
    return rgba[3] > 0 ? 255 * fminl(rgba[3], 1) : 0;
}

double ref_stats_at(double ev, int histogram, pupil_stats *stats)
{
    const double whole = floor(ev), rest = floor((ev - whole) * 0x1p40);
    memset(stats, 0, sizeof *stats);
    stats->pixels = stats->weight = stats->rows = stats->frame_height = 1;
    stats->log2_sum = (int64_t)whole;
    stats->log2_frac = (uint64_t)rest;
    stats->has_histogram = histogram != 0;
    stats->band_pixels[0] = 1;
    stats->band_log2_sum[0] = (int64_t)floor((whole + rest * 0x1p-40) * 0x1p24);
    if (histogram) {
        const float luminance = (float)exp2(whole + rest * 0x1p-40);
        stats->bin[bin_of(luminance, 3)] = 1;
        stats->peak_bin[bin_of(luminance, 2)] = 1;
        stats->peak = luminance;
    }
    return whole + rest * 0x1p-40;
}

double ref_relative(long double stops_off)
{
    return (double)fabsl(expm1l(stops_off * 0.693147180559945309417L));
}
