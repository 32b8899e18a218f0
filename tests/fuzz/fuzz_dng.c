/* DNG and cameras' raw files, which LibRaw reads, under libFuzzer. */
#define READER pupil_read_raw
#include "fuzz_still.h"
