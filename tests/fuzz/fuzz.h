/* tests/fuzz/fuzz.h: shared by several fuzzers: the folder for their first inputs, and a read of every pixel. */
#ifndef PUPIL_TESTS_FUZZ_H
#define PUPIL_TESTS_FUZZ_H

#include <sys/stat.h>

#include "pupil/pupil.h"

/* The first corpus folder in libFuzzer's arguments, for inputs that random bytes do not find; NULL: none was given, for
 * example when a single input is tried again. */
static inline const char *fuzz_corpus(int argc, char **argv)
{
    struct stat s;
    for (int i = 1; i < argc; i++)
        if (argv[i][0] != '-')
            return stat(argv[i], &s) == 0 && S_ISDIR(s.st_mode) ? argv[i] : NULL;
    return NULL;
}

/* Meters a whole image, so that the sanitizer sees a pixel out of bounds. 0: the library accepts it. */
static inline int fuzz_meter(const pupil_image_const *image, pupil_stats *stats)
{
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    pupil_stats_clear(stats);
    const int error = pupil_init(&pupil, &config);
    return error ? error : pupil_meter_rows(&pupil, image, 0, image->height, stats);
}

#endif
