/* drivers/file/recording/recording_mkv.h: a recording's frames.mkv by libavformat: a frame a cluster, each with the
 * kernel when its call returns, so that a file is good up to its last whole frame at any moment.
 *
 * Matroska has times in milliseconds. A frame's is the distance of the timestamps from the first frame on, where they
 * rise, else a nominal period; and at least 1 ms behind the frame before it. So each frame has a time of its own, and a
 * reader that knows the timestamps sees where one is missing.
 */
#ifndef PUPIL_DRIVERS_FILE_RECORDING_RECORDING_MKV_H
#define PUPIL_DRIVERS_FILE_RECORDING_RECORDING_MKV_H

#include "pupil/error.h"
#include "recording_format.h"

typedef struct pupil_mkv_writer pupil_mkv_writer;

/* Writes what is before the first frame into an empty file; fd stays the caller's. 0, or -1 and errno. */
int pupil_mkv_create(pupil_mkv_writer **writer, int fd, const pupil_recording_about *about);
/* -1 and errno: the file ends with the frame before. */
int pupil_mkv_write(pupil_mkv_writer *writer, int64_t timestamp_ns, void *bytes, size_t size);
/* The index, the duration. -1 and errno: the file is good without these. */
int pupil_mkv_finish(pupil_mkv_writer *writer);
void pupil_mkv_free(pupil_mkv_writer *writer); /* NULL is allowed */

typedef struct pupil_mkv_reader pupil_mkv_reader;

/* 0, or -1 and a sentence that begins with the path. A file that ends before its first frame is no failure. */
int pupil_mkv_open(pupil_mkv_reader **reader, const char *path, double fps, size_t frame_bytes, pupil_why *why);
/* The next frame, which is the one of this timestamp; its bytes are good until the next call. 1; 0: the file ends, here
 * or in the middle of it; -1 and a sentence without the path. */
int pupil_mkv_read(pupil_mkv_reader *reader, int64_t timestamp_ns, const unsigned char **bytes, size_t *size,
                   pupil_why *why);
void pupil_mkv_close(pupil_mkv_reader *reader); /* NULL is allowed */

#endif
