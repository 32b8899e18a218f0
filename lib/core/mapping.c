#include "mapping.h"

#include "read.h"

int pupil_mapping_read(pupil_tone *by, pupil_input *in, pupil_output *to, const pupil_curve *curve,
                       const pupil_image_const *rows, const pupil_image *out)
{
    int error = pupil_input_read(in, rows);
    if (!error)
        error = pupil_output_read(to, out);
    if (!error)
        error = pupil_curve_read(by, curve);
    if (error)
        return error;
    const pupil_image *image = &to->image;
    const int same = in->image.width == image->width && in->image.height == image->height;
    const int halved = in->image.width == 2 * image->width && in->image.height == 2 * image->height;
    return same || (halved && pupil_pixel_is_mosaic(in->image.pixel)) ? PUPIL_OK : PUPIL_ERR_SIZE;
}
