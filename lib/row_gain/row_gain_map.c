/* Mapping with a gain for each row: row by row through pupil_map_rows, each with its own scale. */
#include "pupil/row_gain.h"

#include "base/numeric.h"
#include "core/object.h"

/* Rows of `rows` that get one gain. */
static uint32_t rows_together(const pupil_image_const *rows, const pupil_image *out)
{
    const int nv12 = out->pixel == PUPIL_PIXEL_NV12;
    if (nv12 && out->width != rows->width)
        return 4;
    return nv12 ? 2 : pupil_pixel_rows(rows->pixel);
}

/* Of one, two or four, so that the parts are exact; the largest floats have no sum. */
static float mean_of(const float *gain, uint32_t count)
{
    float mean = 0.0f;
    for (uint32_t i = 0; i < count; i++)
        mean += gain[i] / (float)count;
    return mean;
}

/* All that pupil_map_rows would refuse of the whole: nothing is mapped before all of it is known to be right. */
static int check(const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *rows, const float *gain,
                 const pupil_image *out)
{
    int error = pupil_object_check(pupil);
    if (!error)
        error = rows && out && gain ? pupil_image_check(rows, 0) : PUPIL_ERR_NULL;
    if (error)
        return error;
    const pupil_image_const to = pupil_image_as_const(*out);
    error = pupil_image_check(&to, 1);
    if (!error)
        error = pupil_curve_check(curve);
    if (error)
        return error;
    const int same = rows->width == to.width && rows->height == to.height;
    const int halved = rows->width == 2 * to.width && rows->height == 2 * to.height;
    if (!same && !(halved && pupil_pixel_is_mosaic(rows->pixel)))
        return PUPIL_ERR_SIZE;
    for (uint32_t y = 0; y < rows->height; y++)
        if (!pupil_is_finite(gain[y]) || !(gain[y] > 0.0f))
            return PUPIL_ERR_VALUE;
    return PUPIL_OK;
}

int pupil_map_rows_with_gains(const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *rows,
                              const float *gain, const pupil_image *out)
{
    int error = check(pupil, curve, rows, gain, out);
    if (error)
        return error;
    const uint32_t together = rows_together(rows, out), halved = out->width != rows->width ? 2 : 1;
    for (uint32_t y = 0; !error && y < rows->height; y += together) {
        const uint32_t left = rows->height - y, count = left < together ? left : together;
        const pupil_image_const part = pupil_image_rows(*rows, y, count);
        const pupil_image to = pupil_image_out_rows(*out, y / halved, count / halved);
        pupil_curve scaled = *curve;
        const double scale = (double)curve->scale * mean_of(gain + y, count);
        scaled.scale = scale < 0x1p60 ? (float)scale : 0x1p60f;
        error = pupil_map_rows(pupil, &scaled, &part, &to);
    }
    return error;
}
