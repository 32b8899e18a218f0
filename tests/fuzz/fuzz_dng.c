/* DNG and cameras' raw files, which LibRaw reads, under libFuzzer. */
#define READER pupil_read_raw
#include "fuzz_still.h"

#include "drivers/file/write_dng.h"
#include "fuzz.h"

#include <stdio.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);

/* Random bytes do not find a TIFF: the first corpus folder gets a mosaic and a linear DNG to begin with. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    static uint8_t bytes[1 << 14];
    static uint16_t sample[32 * 24 * 3];
    const char *folder = fuzz_corpus(*argc, *argv);
    for (size_t i = 0; i < sizeof sample / sizeof *sample; i++)
        sample[i] = (uint16_t)(64 + i * 37 % 900);
    for (int linear = 0; folder && linear < 2; linear++) {
        char path[4096];
        const dng d = {32, 24, linear, 64, 1023, {500, 1000, 600}, 1, sample};
        const size_t size = dng_make(&d, bytes);
        snprintf(path, sizeof path, "%s/seed_%s.dng", folder, linear ? "linear" : "mosaic");
        FILE *file = fopen(path, "wbe");
        if (file && (fwrite(bytes, 1, size, file) != size || fclose(file) != 0))
            abort();
    }
    return 0;
}
