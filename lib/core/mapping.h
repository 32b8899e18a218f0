/* lib/core/mapping.h: what a call that maps rows is given. */
#ifndef PUPIL_CORE_MAPPING_H
#define PUPIL_CORE_MAPPING_H

#include "image.h"
#include "kernels/kernels.h"

/* Copies and checks all that pupil_map_rows would refuse but the object: for calls that map in parts, and must know
 * before the first. PUPIL_OK or an error. */
int pupil_mapping_read(pupil_tone *by, pupil_input *in, pupil_output *to, const pupil_curve *curve,
                       const pupil_image_const *rows, const pupil_image *out);

#endif
