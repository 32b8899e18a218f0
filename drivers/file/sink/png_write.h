/* drivers/file/sink/png_write.h: one display frame into one PNG file. */
#ifndef PUPIL_DRIVERS_FILE_SINK_PNG_WRITE_H
#define PUPIL_DRIVERS_FILE_SINK_PNG_WRITE_H

#include "pupil/error.h"
#include "pupil/image.h"

/* Writes an RGB8 image as 8-bit RGB with an sRGB chunk to `path`, over what is there. 0, or -1 and a sentence that
 * begins with `name` (what the user knows the file as); the file is then incomplete and the caller's to remove. */
int pupil_png_write(const char *path, const char *name, const pupil_image_const *image, pupil_why *why);

#endif
