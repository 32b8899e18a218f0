/* drivers/file/file_sink.h: display frames into files. */
#ifndef PUPIL_DRIVERS_FILE_FILE_SINK_H
#define PUPIL_DRIVERS_FILE_FILE_SINK_H

#include "pupil/error.h"
#include "sink.h"

/* The kind by the path: .mp4 .mkv .mov a video (libav, H.264 where the library has it), "-" or .y4m YUV4MPEG2 (4:4:4,
 * limited range, uncompressed; BT.601, or BT.709 from 1280 columns or 577 rows on), .png, .jpg and .tif one picture (a
 * second frame is an error), anything without an extension, or with a trailing slash, a folder of frame_000000.png ...
 * (named: by the frames' own names) Anything else is refused with the list of kinds. */
int pupil_file_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);

/* Whether the path names a kind: 0, or -1 and that list. Nothing is opened. */
int pupil_file_sink_check(const char *path, pupil_why *why);

#endif
