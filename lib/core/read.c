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

static int check_knots(const pupil_curve *head, const float knot[PUPIL_CURVE_KNOTS])
{
    int right = head->knots == PUPIL_CURVE_KNOTS && head->levels != 1 && head->levels <= 256 &&
                head->knot_scale >= 0.0f && head->knot_scale <= 0x1p60f;
    for (int i = 0; i < PUPIL_CURVE_KNOTS; i++)
        right &= knot[i] >= 0.0f && knot[i] <= 1.0f;
    return right;
}

static int check_curve(const pupil_curve *head, const float knot[PUPIL_CURVE_KNOTS])
{
    int right = head->scale >= 0.0f && head->scale <= 0x1p60f && head->inverse_white_squared >= 0.0f &&
                head->inverse_white_squared <= 0x1p16f && head->gamut >= 0.0f && head->gamut <= 16.0f &&
                head->dither <= 1 && head->first_row < PUPIL_MAX_SIDE_PX && head->rods >= 0.0f && head->rods <= 1.0f;
    return right && (!head->knots || check_knots(head, knot)) ? PUPIL_OK : PUPIL_ERR_VALUE;
}

int pupil_curve_read(pupil_tone *ours, const pupil_curve *theirs)
{
    const size_t first_bytes = PUPIL_FIRST_BYTES(pupil_curve, knot);
    pupil_curve head;
    if (!theirs)
        return PUPIL_ERR_NULL;
    const size_t bytes = theirs->size_bytes ? theirs->size_bytes : first_bytes;
    if (pupil_versioned_fault(theirs, bytes, sizeof head, first_bytes))
        return PUPIL_ERR_SIZE_BYTES;
    __builtin_memcpy(&head, theirs, offsetof(pupil_curve, knot)); /* knots are read where they are, if there are any */
    *ours = (pupil_tone){.scale = head.scale,
                         .inverse_white_squared = head.inverse_white_squared,
                         .gamut = head.gamut,
                         .knot_scale = head.knots ? head.knot_scale : 0.0f,
                         .dither = head.dither,
                         .first_row = head.first_row,
                         .rods = head.rods,
                         .levels = head.levels,
                         .knot = head.knots ? theirs->knot : 0};
    return check_curve(&head, theirs->knot);
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
