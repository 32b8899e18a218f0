/* Mapping with a gain for each row: row by row, each with its own scale. */
#include "pupil/row_gain.h"

#include "base/numeric.h"
#include "core/image.h"
#include "core/mapping.h"
#include "core/object.h"

/* Rows of `rows` that get one gain. */
static uint32_t rows_together(const pupil_image_const *rows, const pupil_image *out)
{
    const int pairs = pupil_pixel_planes(out->pixel) > 1;
    if (pairs && out->width != rows->width)
        return 4;
    return pairs ? 2 : pupil_pixel_rows(rows->pixel);
}

/* Each of the one, two or four gains is divided first, which is exact: the sum of the largest floats would overflow. */
static float mean_of(const float *gain, uint32_t count)
{
    float mean = 0.0f;
    for (uint32_t i = 0; i < count; i++)
        mean += gain[i] / (float)count;
    return mean;
}

/* Clamped to the range of a curve's scale. */
static float bounded(double scale)
{
    return scale < 0x1p60 ? (float)scale : 0x1p60f;
}

int pupil_map_rows_with_gains(const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *rows,
                              const float *gain, const pupil_image *out)
{
    pupil_tone by;
    pupil_input in;
    pupil_output to;
    int error = pupil_object_check(pupil);
    if (!error)
        error = rows && out && gain ? pupil_mapping_read(&by, &in, &to, curve, rows, out) : PUPIL_ERR_NULL;
    if (error)
        return error;
    const uint32_t height = in.image.height;
    for (uint32_t y = 0; y < height; y++)
        if (!pupil_is_finite(gain[y]) || !(gain[y] > 0.0f))
            return PUPIL_ERR_VALUE;
    const uint32_t together = rows_together(&in.image, &to.image);
    const double scale = (double)by.scale, knot_scale = (double)by.knot_scale;
    const uint32_t first_row = by.first_row;
    const uint32_t halved = to.image.width != in.image.width ? 2 : 1;
    for (uint32_t y = 0; y < height; y += together) {
        const uint32_t left = height - y;
        const uint32_t count = left < together ? left : together;
        const pupil_image_const part = pupil_image_rows(in.image, y, count);
        const pupil_image part_out = pupil_image_out_rows(to.image, y / halved, count / halved);
        const double mean = (double)mean_of(gain + y, count);
        by.scale = bounded(scale * mean);
        by.knot_scale = bounded(knot_scale * mean);
        by.first_row = first_row + y;
        pupil_work_rows(pupil_object_of_const(pupil), &part, by.first_row, count, 0, &by, &part_out);
    }
    return error;
}
