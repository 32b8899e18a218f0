#include "verify.h"

#include <math.h>

#include "common/gamut.h"
#include "common/pixel_light.h"

static double clamp(double v, double low, double high)
{
    return v > low ? (v < high ? v : high) : low; /* NaN: low */
}

static const double *luma_of(const pupil_config *config)
{
    static const double bt709[3] = {0.2126, 0.7152, 0.0722}, bt2020[3] = {0.2627, 0.6780, 0.0593};
    return config->primaries == PUPIL_PRIMARIES_BT2020 ? bt2020 : bt709;
}

/* From the input's primaries to the picture's (config.h); the program does not use the library's matrix. By SMPTE RP
 * 177-1993 from the chromaticities of BT.709 and BT.2020, to ten digits. */
static const pupil_config *to_picture(const pupil_config *config, pupil_config *picture, double rgb[3])
{
    static const double m[2][9] = {{1.66049100211, -0.587641138789, -0.0728498633199, -0.124550474522, 1.13289989713,
                                    -0.00834942260437, -0.0181507633549, -0.100578898008, 1.11872966136},
                                   {0.627403895935, 0.329283038378, 0.0433130656874, 0.0690972893582, 0.919540395075,
                                    0.0113623155663, 0.0163914388752, 0.0880133078772, 0.895595253248}};
    const int to_bt2020 = config->output_primaries == PUPIL_OUTPUT_BT2020;
    if (config->output_primaries == PUPIL_OUTPUT_AS_INPUT || config->primaries == (uint32_t)to_bt2020)
        return config;
    const double r = rgb[0], g = rgb[1], b = rgb[2];
    for (int c = 0; c < 3; c++) {
        const double *row = m[to_bt2020] + 3 * c;
        rgb[c] = clamp(row[0] * r + row[1] * g + row[2] * b, 0.0, INFINITY);
    }
    *picture = *config;
    picture->primaries = to_bt2020 ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709;
    return picture;
}

/* The display sample by the definitions of config.h and pupil.h. */
static int display_code(uint32_t transfer, double light)
{
    light = clamp(light, 0.0, 1.0);
    double code = light;
    if (transfer == PUPIL_TRANSFER_SRGB)
        code = light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
    else if (transfer == PUPIL_TRANSFER_GAMMA22)
        code = pow(light, 1.0 / 2.2);
    return (int)floor(code * 255.0 + 0.5);
}

/* The root of display light at t times the luminance of a curve's first knot. */
static double root_at(const pupil_curve *curve, double t)
{
    int exponent;
    const double fraction = 2.0 * frexp(clamp(t, 1.0, 0x1p16), &exponent) - 1.0;
    const int k = 8 * (exponent - 1) + (int)(8.0 * fraction);
    if (k >= PUPIL_CURVE_KNOTS - 1)
        return (double)curve->knot[PUPIL_CURVE_KNOTS - 1];
    const double from = (double)curve->knot[k], to = (double)curve->knot[k + 1];
    const double root = from + (8.0 * fraction - k % 8) * (to - from);
    const double levels = (double)curve->levels;
    return curve->levels ? fmin(floor(root * levels), levels - 1.0) / (levels - 1.0) : root;
}

/* The factor for a pixel of luminance y. */
static double gain_of(const pupil_curve *curve, double y)
{
    const double u = (double)curve->scale * y, t = fmax((double)curve->knot_scale * y, 1.0);
    if (!curve->knots)
        return (double)curve->scale * (1.0 + u * (double)curve->inverse_white_squared) / (1.0 + u);
    const double root = root_at(curve, t);
    return (double)curve->knot_scale * root * root / t;
}

static void map_pixel(const pupil_config *config, const pupil_curve *curve, const double in[3], double luminance,
                      int code[3])
{
    double y = clamp(luminance, 0.0, 0x1p30), out[3];
    double s = luminance != luminance ? 0.0 : gain_of(curve, y);
    for (int c = 0; c < 3; c++)
        out[c] = clamp(in[c], 0.0, 0x1p31) * s;
    gamut_fit(config->primaries == PUPIL_PRIMARIES_BT2020, (double)curve->gamut, y * s, out);
    for (int c = 0; c < 3; c++)
        code[c] = display_code(config->transfer, out[c]);
}

static int is_uniform(const pupil_config *config)
{
    for (int i = 0; i < PUPIL_GRID_SIDE * PUPIL_GRID_SIDE; i++)
        if (config->weight[i / PUPIL_GRID_SIDE][i % PUPIL_GRID_SIDE] != config->weight[0][0])
            return 0;
    return 1;
}

static long double luminance_of(const pupil_config *config, const double rgb[3])
{
    const double *luma = luma_of(config);
    return (long double)luma[0] * rgb[0] + (long double)luma[1] * rgb[1] + (long double)luma[2] * rgb[2];
}

static long double logarithm(const pupil_config *config, long double luminance)
{
    return log2l((long double)clamp((double)luminance, (double)config->floor, 0x1p30));
}

/* Compares the display's samples; returns the sum of the logarithms of their luminances in the input. `step`: 2 if each
 * sample is of a quad. */
static long double compare(verify_figures *figures, const pupil_config *config, const pupil_image_const *in,
                           const pupil_curve *curve, const pupil_image_const *out, uint32_t step)
{
    long double sum = 0.0L;
    for (uint32_t y = 0; y < out->height; y++) {
        const uint8_t *row = pupil_image_rows(*out, y, 1).data;
        for (uint32_t x = 0; x < out->width; x++) {
            double rgb[4];
            int code[3];
            pixel_light(in, x * step, y * step, step == 2, rgb);
            const long double luminance = luminance_of(config, rgb);
            sum += logarithm(config, luminance);
            pupil_config own;
            const pupil_config *picture = to_picture(config, &own, rgb);
            map_pixel(config, curve, rgb, (double)(picture == config ? luminance : luminance_of(picture, rgb)), code);
            for (int c = 0; c < 3; c++) {
                int off = row[3 * x + (uint32_t)c] - code[c];
                off = off < 0 ? -off : off;
                figures->off += off != 0;
                figures->code_error = off > figures->code_error ? off : figures->code_error;
            }
        }
    }
    figures->samples += (uint64_t)3 * out->width * out->height;
    return sum;
}

static long double sum_of_quads(const pupil_config *config, const pupil_image_const *in)
{
    long double sum = 0.0L;
    for (uint32_t y = 0; y < in->height; y += 2)
        for (uint32_t x = 0; x < in->width; x += 2) {
            double rgb[4];
            pixel_light(in, x, y, 1, rgb);
            sum += logarithm(config, luminance_of(config, rgb));
        }
    return sum;
}

void verify_frame(verify_figures *figures, const pupil_config *config, const pupil_image_const *in,
                  const pupil_curve *curve, const pupil_image_const *out, const pupil_stats *stats)
{
    const uint32_t metered = pupil_pixel_is_mosaic(in->pixel) ? 2 : 1, step = in->width / out->width;
    double mean;
    long double sum = compare(figures, config, in, curve, out, step);
    if (is_uniform(config) && config->meter_rows <= 1 && pupil_stats_mean(stats, 0.0, 1.0, &mean) == PUPIL_OK) {
        if (metered != step)
            sum = sum_of_quads(config, in);
        double reference = (double)(sum / ((long double)(in->width / metered) * (in->height / metered)));
        double error = fabs(expm1((mean - reference) * 0.69314718055994531));
        figures->log_average_error = error > figures->log_average_error ? error : figures->log_average_error;
        figures->means++;
    }
    figures->frames++;
}
