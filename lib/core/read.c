#include "read.h"

#include "base/versioned.h"
#include "object.h"

/* pupil_versioned_read of a struct whose size_bytes may be 0, which stands for the first release's. */
static const char *read_struct(void *ours, size_t our_bytes, size_t first_bytes, const void *theirs)
{
    uint32_t size_bytes;
    __builtin_memcpy(&size_bytes, theirs, sizeof size_bytes);
    return pupil_versioned_read(ours, our_bytes, first_bytes, theirs, size_bytes ? size_bytes : first_bytes);
}

int pupil_info_read(pupil_frame_info *ours, const pupil_frame_info *theirs)
{
    const size_t first_bytes = PUPIL_FIRST_BYTES(pupil_frame_info, gain);
    *ours = (pupil_frame_info){.size_bytes = sizeof *ours};
    if (theirs && (read_struct(ours, sizeof *ours, first_bytes, theirs) || ours->reserved))
        return PUPIL_ERR_SIZE_BYTES;
    return PUPIL_OK;
}

int pupil_curve_read(pupil_curve *ours, const pupil_curve *theirs)
{
    *ours = (pupil_curve){0};
    if (!theirs)
        return PUPIL_ERR_NULL;
    if (read_struct(ours, sizeof *ours, PUPIL_FIRST_BYTES(pupil_curve, gamut), theirs))
        return PUPIL_ERR_SIZE_BYTES;
    return pupil_curve_check(ours);
}

const char *pupil_coding_read(pupil_coding *ours, const pupil_coding *theirs)
{
    *ours = (pupil_coding){0};
    return read_struct(ours, sizeof *ours, PUPIL_FIRST_BYTES(pupil_coding, rgb_from_camera), theirs);
}

int pupil_image_read(pupil_image_const *ours, const pupil_image_const *theirs)
{
    *ours = (pupil_image_const){0};
    if (!theirs)
        return PUPIL_ERR_NULL;
    const char *fault = read_struct(ours, sizeof *ours, PUPIL_FIRST_BYTES(pupil_image_const, rows_below), theirs);
    return fault ? PUPIL_ERR_SIZE_BYTES : PUPIL_OK;
}

int pupil_input_read(pupil_input *ours, const pupil_image_const *theirs)
{
    pupil_image_const *image = &ours->image;
    const int error = pupil_image_read(image, theirs);
    if (error)
        return error;
    if (image->coding && pupil_coding_read(&ours->coding, image->coding))
        return PUPIL_ERR_CODING;
    image->coding = image->coding ? &ours->coding : 0;
    return pupil_image_check(image, 0);
}

int pupil_output_read(pupil_output *ours, const pupil_image *theirs)
{
    pupil_image *image = &ours->image;
    *image = (pupil_image){0};
    if (!theirs)
        return PUPIL_ERR_NULL;
    if (read_struct(image, sizeof *image, PUPIL_FIRST_BYTES(pupil_image, coding), theirs))
        return PUPIL_ERR_SIZE_BYTES;
    if (image->coding && pupil_coding_read(&ours->coding, image->coding))
        return PUPIL_ERR_CODING;
    image->coding = image->coding ? &ours->coding : 0;
    const pupil_image_const as_const = pupil_image_as_const(*image);
    return pupil_image_check(&as_const, 1);
}
