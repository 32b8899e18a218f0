/* lib/core/mapping.h: the arguments of a call that maps rows. */
#ifndef PUPIL_CORE_MAPPING_H
#define PUPIL_CORE_MAPPING_H

#include "image.h"
#include "kernels/kernels.h"

/* Copies and checks all arguments that pupil_map_rows checks, except the object: for calls that map in parts, and must
 * refuse before the first. PUPIL_OK or an error. */
int pupil_mapping_read(pupil_tone *by, pupil_input *in, pupil_output *to, const pupil_curve *curve,
                       const pupil_image_const *rows, const pupil_image *out);

#endif
