/* The reader of Radiance pictures under libFuzzer. */
#define READER pupil_read_radiance
#include "fuzz_still.h"
