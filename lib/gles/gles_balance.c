/* A white balance that follows the frames. */
#include "gles_private.h"

int pupil_gles_balance(pupil_gles *gles, const float balance[3])
{
    int error = gles && balance ? pupil_gles_check(gles) : PUPIL_ERR_NULL;
    if (error)
        return error;
    gles_object *o = gles_object_of(gles);
    pupil_coding coding = o->coding;
    for (int i = 0; i < 3; i++)
        coding.balance[i] = balance[i];
    if ((error = pupil_coding_check(&coding, o->config.pixel, 0)))
        return error;
    o->coding = coding;
    pupil_gles_coder_set(o);
    if (pupil_pixel_is_mosaic(o->config.pixel))
        pupil_gles_programs_balance(o);
    return pupil_gles_error(o);
}
