/* lib/kernels/kernels.h: the pieces that touch pixels, as one table of functions a level (scalar now; NEON and AVX2
 * slot in beside it). A row is worked in blocks of up to PUPIL_BLOCK pixels as planar floats that stay in the L1 cache:
 *
 *     load -> luminance -> meter, histogram -> tone -> store
 *
 * Each type is written once, here; every level has the same bits (no fused multiply-add, 16 fixed lanes).
 */
#ifndef PUPIL_KERNELS_KERNELS_H
#define PUPIL_KERNELS_KERNELS_H

#include <stdint.h>

#include "pupil/pupil.h"

#define PUPIL_BLOCK   256 /* pixels; a multiple of 64, so that lanes and exponent moves line up from block to block */
#define PUPIL_LANES   16
#define PUPIL_CEILING 0x1p30f /* the largest luminance; 4 factors of it, or of 2^-30, stay inside a float's range */

/* What metering a run of pixels leaves: pixel i of the run is in lane i % 16; log2 of lane = exponent + log2 product.
 */
typedef struct pupil_run {
    float product[PUPIL_LANES]; /* in [1, 2) between calls */
    int32_t exponent[PUPIL_LANES];
    uint32_t black, clipped, bad;
} pupil_run;

/* 8-bit encoding that is exact by construction: the guess is the code at the start of a cell of the input's float bits
 * (7 bits of fraction), and a cell holds at most one boundary, so one comparison with that boundary settles it. */
typedef struct pupil_encoder {
    const uint8_t *guess; /* by (bits - base_bits) >> 16 */
    const float *bound;   /* bound[k]: the smallest float that is coded k or above; bound[256] is never reached */
    uint32_t base_bits;   /* everything below it is code 0 */
} pupil_encoder;

typedef void pupil_load_kernel(const void *source, uint32_t n, float *r, float *g, float *b);
typedef void pupil_luminance_kernel(const float weight[3], const float *r, const float *g, const float *b, uint32_t n,
                                    float *luminance);
typedef void pupil_meter_kernel(const float *luminance, const float *r, const float *g, const float *b, uint32_t n,
                                float floor, float clip, pupil_run *run);
/* Adds to the bins, the peak bins and the peak. */
typedef void pupil_histogram_kernel(const float *luminance, const float *r, const float *g, const float *b, uint32_t n,
                                    float floor, uint32_t weight, pupil_stats *stats);
/* In place; luminance becomes scratch. */
typedef void pupil_tone_kernel(float *r, float *g, float *b, float *luminance, uint32_t n, const pupil_curve *curve);
typedef void pupil_store_kernel(const float *r, const float *g, const float *b, uint32_t n,
                                const pupil_encoder *encoder, void *target);
/* Writes the fourth byte of RGBA8 pixels. */
typedef void pupil_alpha_kernel(const void *source, uint32_t n, uint8_t *rgba);

typedef struct pupil_kernels {
    pupil_load_kernel *load[PUPIL_PIXEL_COUNT]; /* by input format; NULL: not an input */
    pupil_luminance_kernel *luminance;
    pupil_meter_kernel *meter;
    pupil_histogram_kernel *histogram;
    pupil_tone_kernel *tone;
    pupil_store_kernel *store[PUPIL_PIXEL_COUNT]; /* by output format; NULL: not an output */
    pupil_alpha_kernel *alpha[PUPIL_PIXEL_COUNT]; /* by input format; NULL: opaque */
} pupil_kernels;

extern const pupil_kernels pupil_kernels_scalar;

extern const pupil_encoder pupil_encoders[PUPIL_TRANSFER_COUNT];
extern const float pupil_srgb8_to_linear[256];

/* What a row of a frame is worked with; constant over the frame. */
typedef struct pupil_row_job {
    const pupil_kernels *kernels;
    const pupil_encoder *encoder;
    const pupil_curve *curve; /* NULL: meter only */
    float luma[3];
    float floor, clip;
    uint32_t in_pixel, out_pixel;
    uint32_t histogram; /* gather bins */
} pupil_row_job;

/* Works n pixels that all have the metering weight `weight`; 0 or stats NULL: not metered. target NULL: not mapped. */
void pupil_work_run(const pupil_row_job *job, const uint8_t *source, uint8_t *target, uint32_t n, uint32_t weight,
                    uint32_t band, pupil_stats *stats);

#endif
