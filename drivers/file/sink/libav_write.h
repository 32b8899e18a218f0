/* drivers/file/sink/libav_write.h: one display frame into one JPEG or TIFF file, by libav's encoders. */
#ifndef PUPIL_DRIVERS_FILE_SINK_LIBAV_WRITE_H
#define PUPIL_DRIVERS_FILE_SINK_LIBAV_WRITE_H

#include "pupil/error.h"
#include "pupil/image.h"

/* As pupil_png_write, for an RGB8 image in sRGB and BT.709; others are refused, for these files do not name their
 * colour space. A TIFF has three samples of 8 bits, packed by LZW. */
int pupil_jpeg_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                     uint32_t transfer, pupil_why *why);
int pupil_tiff_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                     uint32_t transfer, pupil_why *why);

#endif
