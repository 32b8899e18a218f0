/* In place of lib/kernels/avx2.c and avx512.c, which take half a minute to compile and see no public struct. The mask
 * PUPIL_LEVELS in CMakeLists.txt keeps pupil_init from choosing these levels. */
#include "kernels/kernels.h"

const pupil_kernels pupil_kernels_avx2;
const pupil_kernels pupil_kernels_avx512;
