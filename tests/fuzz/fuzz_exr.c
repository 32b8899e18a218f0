/* The reader of OpenEXR under libFuzzer. */
#define READER pupil_read_exr
#include "fuzz_still.h"
