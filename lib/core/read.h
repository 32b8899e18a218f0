/* lib/core/read.h: the arguments of a call, as structs of this version. A caller's struct is copied once, where the
 * call enters the library. Statistics are too large for that: their fields are used where they are, after
 * pupil_stats_check_bytes. */
#ifndef PUPIL_CORE_READ_H
#define PUPIL_CORE_READ_H

#include "kernels/kernels.h"
#include "pupil/pupil.h"

/* These return PUPIL_OK or an error. */

/* `theirs` may be NULL: nothing is known. */
int pupil_info_read(pupil_frame_info *ours, const pupil_frame_info *theirs);
/* Checks its values, too. */
int pupil_curve_read(pupil_tone *ours, const pupil_curve *theirs);
/* NULL, or a sentence; the values are not checked. */
const char *pupil_coding_read(pupil_coding *ours, const pupil_coding *theirs);

/* Its values, and the coding that it points at, are not checked. */
int pupil_image_read(pupil_image_const *ours, const pupil_image_const *theirs);
int pupil_image_out_read(pupil_image *ours, const pupil_image *theirs);

/* PUPIL_OK, or PUPIL_ERR_SIZE_BYTES. */
int pupil_stats_check_bytes(const pupil_stats *stats);

#endif
