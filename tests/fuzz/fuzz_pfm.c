/* The reader of portable float maps under libFuzzer. */
#define READER pupil_read_pfm
#include "fuzz_still.h"
