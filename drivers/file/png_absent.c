/* In place of read_png.c and png_write.c in a build without libpng. */
#include "file/png_write.h"
#include "file/still.h"

#include <stdio.h>

int pupil_read_png(pupil_still *still, const uint8_t *bytes, size_t size, char *why, size_t why_bytes)
{
    (void)still, (void)bytes, (void)size;
    snprintf(why, why_bytes, "this build of pupil reads no PNG (it was configured with PUPIL_PNG=OFF)");
    return -1;
}

int pupil_png_write(const char *path, const char *name, const pupil_image_const *image, char *why, size_t why_bytes)
{
    (void)path, (void)image;
    snprintf(why, why_bytes, "%s: this build of pupil writes no PNG (it was configured with PUPIL_PNG=OFF)", name);
    return -1;
}
