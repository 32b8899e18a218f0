/* drivers/file/video/video_format.h: opens a file as libav's streams. A part of video_source.c and video_sound.c.
 *
 * Threads: one thread at a time on an object.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_FORMAT_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_FORMAT_H

#include "video_io.h"
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>

/* The text for a libav error code: the logged message, else the code's name. */
const char *pupil_libav_words(int code, char buffer[AV_ERROR_MAX_STRING_SIZE]);

/* Finds the format of the bytes. 0, or -1 and a sentence without a file name; the caller closes *format either way. */
int pupil_video_format_open(AVFormatContext **format, pupil_video_io *io, pupil_why *why);

/* Checks that a stream's frames have at most this many pixels. 0, or -1 and a sentence. */
int pupil_video_format_fits(const AVCodecParameters *parameters, int64_t max_pixels, pupil_why *why);

/* Probes the streams, with decoders that refuse frames of more pixels. 0, or -1 and a sentence. */
int pupil_video_format_look(AVFormatContext *format, int64_t max_pixels, pupil_why *why);

#endif
