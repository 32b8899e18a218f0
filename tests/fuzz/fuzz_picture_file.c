/* JPEG, TIFF, WebP and BMP, which libav reads, under libFuzzer. Pictures are limited to the size that files of so few
 * bytes usually have. */
#include "file/still/still.h"

static int read_small(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    still->most = size * PUPIL_STILL_PIXELS_FOR_BYTE;
    return pupil_read_libav(still, bytes, size, why);
}

#define READER read_small
#include "fuzz_still.h"
