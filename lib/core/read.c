#include "read.h"

#include "base/versioned.h"
#include "object.h"

/* pupil_versioned_read of a struct whose size_bytes may be 0, which means the first release's. */
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

static int check_curve(const pupil_curve *curve)
{
    int right = curve->scale >= 0.0f && curve->scale <= 0x1p60f && curve->inverse_white_squared >= 0.0f &&
                curve->inverse_white_squared <= 0x1p16f && curve->gamut >= 0.0f && curve->gamut <= 16.0f &&
                curve->dither <= 1 && curve->first_row < PUPIL_MAX_SIDE_PX;
    return right ? PUPIL_OK : PUPIL_ERR_VALUE;
}

int pupil_curve_read(pupil_curve *ours, const pupil_curve *theirs)
{
    *ours = (pupil_curve){0};
    if (!theirs)
        return PUPIL_ERR_NULL;
    if (read_struct(ours, sizeof *ours, PUPIL_FIRST_BYTES(pupil_curve, first_row), theirs))
        return PUPIL_ERR_SIZE_BYTES;
    return check_curve(ours);
}

const char *pupil_coding_read(pupil_coding *ours, const pupil_coding *theirs)
{
    *ours = (pupil_coding){0};
    return read_struct(ours, sizeof *ours, PUPIL_FIRST_BYTES(pupil_coding, knee_light), theirs);
}

int pupil_image_read(pupil_image_const *ours, const pupil_image_const *theirs)
{
    *ours = (pupil_image_const){0};
    if (!theirs)
        return PUPIL_ERR_NULL;
    const char *fault = read_struct(ours, sizeof *ours, PUPIL_FIRST_BYTES(pupil_image_const, rows_below), theirs);
    return fault ? PUPIL_ERR_SIZE_BYTES : PUPIL_OK;
}

int pupil_image_out_read(pupil_image *ours, const pupil_image *theirs)
{
    *ours = (pupil_image){0};
    if (!theirs)
        return PUPIL_ERR_NULL;
    const char *fault = read_struct(ours, sizeof *ours, PUPIL_FIRST_BYTES(pupil_image, coding), theirs);
    return fault ? PUPIL_ERR_SIZE_BYTES : PUPIL_OK;
}
