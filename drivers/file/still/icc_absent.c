/* Replaces icc.c where Little CMS is not installed: pictures count as sRGB, regardless of their profile. */
#include "icc.h"

int pupil_icc_apply_curves(const uint8_t *bytes, size_t size, float *rgb, uint64_t pixels, pupil_still_colour *colour,
                           pupil_why *why)
{
    (void)bytes, (void)size, (void)rgb, (void)pixels, (void)why;
    *colour = (pupil_still_colour){.convert = 0};
    return 0;
}

int pupil_icc_apply_profile(const uint8_t *profile, size_t size, float *rgb, uint64_t pixels, pupil_why *why)
{
    (void)profile, (void)size, (void)rgb, (void)pixels, (void)why;
    return 0;
}
