/* tests/reference.h: the headers' definitions, computed slowly in long double, as an independent reference for the
 * library. It shares only the public headers with the library. The program has its own, faster reference for mapping
 * (apps/report/verify.c); how pixels are read is written once for both.
 */
#ifndef PUPIL_TESTS_REFERENCE_H
#define PUPIL_TESTS_REFERENCE_H

#include "pupil/pupil.h"

#define REF_TOP 0x1p30L /* the largest value of a luminance, stats.h */

/* Linear light of one pixel, or of a mosaic's quad, from apps/common/pixel_light.h, so to the nearest double. */
void ref_light(const pupil_image_const *image, uint32_t x, uint32_t y, int quad, long double rgba[4]);

/* Converts light to config.output_primaries; config.h. 0: they are the input's. */
int ref_to_picture(const pupil_config *config, long double light[3]);

/* Luminance weights, as real numbers and as the nearest binary32. */
void ref_weights(const pupil_config *config, long double exact[3], float rounded[3]);

/* (wr R + wg G) + wb B in binary32, as stats.h has it. */
float ref_luminance(const float weight[3], const float rgb[3]);

/* The metering weight of a pixel by the cell rule of config.h. */
unsigned ref_cell(const pupil_config *config, uint32_t x, uint32_t y, uint32_t width, uint32_t height);

typedef struct ref_meter {
    long double mean_of_pixels; /* mean log2 of luminances taken in long double */
    long double mean_of_floats; /* mean log2 of the binary32 luminances that stats.h defines */
    uint64_t pixels, weight, black, clipped, bad;
    uint64_t bin[PUPIL_HISTOGRAM_BINS], peak_bin[PUPIL_PEAK_BINS];
    float peak;
    long double band_sum[PUPIL_BANDS]; /* of log2 of the binary32 luminances */
    uint32_t band_pixels[PUPIL_BANDS];
} ref_meter;

void ref_meter_frame(const pupil_config *config, const pupil_image_const *image, ref_meter *meter);

/* log2 of the clamped luminances with their weights, sorted; for quantiles and trimmed means. */
typedef struct ref_order {
    struct ref_item {
        long double log2_luminance;
        unsigned weight;
    } * item;
    size_t count;
    uint64_t weight;
} ref_order;

void ref_order_make(const pupil_config *config, const pupil_image_const *image, ref_order *order);
void ref_order_free(ref_order *order);
long double ref_trimmed(const ref_order *order, double low, double high);
/* The values just below and above the share q of the weight. */
void ref_quantile(const ref_order *order, double q, long double *left, long double *right);

/* Linear display light to an unrounded code, 0..255. */
long double ref_encode(uint32_t transfer, long double light);

/* One pixel through the curve, gamut handling and transfer: three unrounded codes. */
void ref_map(const pupil_config *config, const pupil_curve *curve, const long double rgba[4], long double code[3]);

/* Alpha as an unrounded code. */
long double ref_alpha(const long double rgba[4]);

/* Statistics of a frame of one pixel whose log2 luminance is ev, rounded down to the 2^-40 grid; returns the rounded
 * value. */
double ref_stats_at(double ev, int histogram, pupil_stats *stats);

/* Relative error of a log-average from its error in stops. */
double ref_relative(long double stops_off);

#endif
