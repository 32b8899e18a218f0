/* drivers/file/sink/jpeg_write.h: one display frame into one JPEG file, by libav's encoder. */
#ifndef PUPIL_DRIVERS_FILE_SINK_JPEG_WRITE_H
#define PUPIL_DRIVERS_FILE_SINK_JPEG_WRITE_H

#include "pupil/error.h"
#include "pupil/image.h"

/* As pupil_png_write, an RGB8 image in sRGB and BT.709; others are refused, for a JPEG cannot say what it has. */
int pupil_jpeg_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                     uint32_t transfer, pupil_why *why);

#endif
