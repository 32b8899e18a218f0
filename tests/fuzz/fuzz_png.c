/* The reader of PNG under libFuzzer. */
#define READER pupil_read_png
#include "fuzz_still.h"
