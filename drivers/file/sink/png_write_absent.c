/* Replaces png_write.c and libav_write.c in a build without the media libraries. */
#include "libav_write.h"
#include "png_write.h"

#include "refuse.h"
#include <stdio.h>

int pupil_png_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                    uint32_t transfer, pupil_why *why)
{
    (void)path, (void)image, (void)primaries, (void)transfer;
    return pupil_refuse(why, "%s: this build of pupil writes no PNG (it was configured with PUPIL_MEDIA=OFF)", name);
}

int pupil_jpeg_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                     uint32_t transfer, pupil_why *why)
{
    (void)path, (void)image, (void)primaries, (void)transfer;
    return pupil_refuse(why, "%s: this build of pupil writes no JPEG (it was configured with PUPIL_MEDIA=OFF)", name);
}

int pupil_tiff_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                     uint32_t transfer, pupil_why *why)
{
    (void)path, (void)image, (void)primaries, (void)transfer;
    return pupil_refuse(why, "%s: this build of pupil writes no TIFF (it was configured with PUPIL_MEDIA=OFF)", name);
}
