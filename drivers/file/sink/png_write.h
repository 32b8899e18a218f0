/* drivers/file/sink/png_write.h: one display frame into one PNG file. */
#ifndef PUPIL_DRIVERS_FILE_SINK_PNG_WRITE_H
#define PUPIL_DRIVERS_FILE_SINK_PNG_WRITE_H

#include "pupil/error.h"
#include "pupil/image.h"

/* Writes an RGB8 image as 8-bit RGB to `path`, replacing a file that is there. Its chunks name the primaries and the
 * pupil_transfer: BT.709 and sRGB by sRGB, anything else by cHRM and gAMA, BT.2020 with sRGB's curve by cICP too. 0, or
 * -1 and a sentence that begins with `name` (what the user knows the file as); the file is then incomplete, and the
 * caller removes it. */
int pupil_png_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                    uint32_t transfer, pupil_why *why);

#endif
