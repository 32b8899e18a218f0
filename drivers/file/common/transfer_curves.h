/* drivers/file/common/transfer_curves.h: from a code 0..1 to light, by the standards' curves. */
#ifndef PUPIL_DRIVERS_FILE_COMMON_TRANSFER_CURVES_H
#define PUPIL_DRIVERS_FILE_COMMON_TRANSFER_CURVES_H

#include <math.h>

/* IEC 61966-2-1, 5.2. */
static inline double pupil_srgb_light(double code)
{
    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

/* code_light (source.h) of pictures that are coded for an SDR display: that of 8-bit sRGB, whatever their bits and
 * curve. In more bits the same picture has the same noise, and a power law's first codes, which are darker, are no
 * finer. */
#define PUPIL_SDR_CODE_LIGHT (1.0f / 255 / 12.92f)

/* Rec. ITU-R BT.2100-2, table 4; 1.0 is 100 cd/m2 of its 10000. */
static inline double pupil_pq_light(double code)
{
    const double p = pow(code, 32 / 2523.), top = fmax(p - 3424 / 4096., 0);
    return 100 * pow(top / (2413 / 128. - 2392 / 128. * p), 16384 / 2610.);
}

/* Rec. ITU-R BT.2100-2, table 5: the inverse of the OETF, scene light 0..1. */
static inline double pupil_hlg_light(double code)
{
    return code <= 0.5 ? code * code / 3 : (exp((code - 0.55991073) / 0.17883277) + 0.28466892) / 12;
}

#endif
