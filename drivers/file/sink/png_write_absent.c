/* In place of png_write.c in a build without the media libraries. */
#include "png_write.h"

#include <stdio.h>

int pupil_png_write(const char *path, const char *name, const pupil_image_const *image, char *why, size_t why_bytes)
{
    (void)path, (void)image;
    snprintf(why, why_bytes, "%s: this build of pupil writes no PNG (it was configured with PUPIL_MEDIA=OFF)", name);
    return -1;
}
