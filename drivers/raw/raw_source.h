/* drivers/raw/raw_source.h: files of a sensor's or a camera's frames without a header, as `v4l2-ctl --stream-to`
 * and many other programs write them.
 *
 *     raw:FILE,format=pRAA,size=1920x1080[,key=value...]
 *
 * FILE is a file of any number of frames, or a folder of such files, which follow one another in natural order. Keys:
 *
 *   format   V4L2's name, as `pupil list` shows it: RG10, pBAA, GREY, Y10P, YUYV, NV12
 *   size     pixels
 *   stride   bytes from one row to the next, where rows are padded (bytesperline of V4L2)
 *   skip     bytes in front of the first frame
 *   black, white, shift   codes and bits, as in pupil/coding.h
 *   knees    CODE:LIGHT/CODE:LIGHT..., as in pupil/coding.h
 *   balance  auto (the default: each file's first frame is made grey on average, those after it follow), off, or R/G/B
 *   matrix   nine numbers with / between, from the balanced sensor's RGB to Rec.709
 *
 * A file that ends within a frame hands out those that are whole, and then a damaged one. Time: options.fps, or 30.
 */
#ifndef PUPIL_DRIVERS_RAW_RAW_SOURCE_H
#define PUPIL_DRIVERS_RAW_RAW_SOURCE_H

#include "colour/white_balance.h"
#include "source.h"

/* What the keys say. */
typedef struct pupil_raw_layout {
    char file[4096];
    char format[8];
    uint32_t pixel, bayer, width, height;
    uint64_t stride_bytes, skip_bytes; /* stride 0: rows without padding */
    pupil_coding coding;               /* black, white, shift; the rest is in colour */
    pupil_colour_options colour;
} pupil_raw_layout;

/* `text`: without "raw:". 0, or -1 and a sentence that names the key and what would be right. */
int pupil_raw_layout_read(pupil_raw_layout *layout, const char *text, pupil_why *why);

/* A frame of this layout at these bytes, and how many it has; 0: the format has no frame of such a size. */
size_t pupil_raw_layout_image(const pupil_raw_layout *layout, const void *bytes, pupil_image_const *image);

/* 0, or PUPIL_SOURCE_FAILED and a sentence. */
int pupil_raw_source_open(const char *text, const pupil_source_options *options, pupil_source **source, pupil_why *why);

#endif
