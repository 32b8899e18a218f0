/* drivers/file/recording/recording_mkv.h: a recording's frames.mkv by libavformat: one frame a cluster, each passed to
 * the kernel when its call returns, so that a file is good up to its last whole frame at any moment.
 *
 * Matroska has times in milliseconds. A frame's time is its timestamp's distance from the first frame where timestamps
 * rise, else a nominal period later; it is at least 1 ms after the frame before. So each frame has its own time, and a
 * reader that knows the timestamps sees where one is missing.
 */
#ifndef PUPIL_DRIVERS_FILE_RECORDING_RECORDING_MKV_H
#define PUPIL_DRIVERS_FILE_RECORDING_RECORDING_MKV_H

#include "pupil/error.h"
#include "recording_format.h"

typedef struct pupil_mkv_writer pupil_mkv_writer;

/* Writes the head of the file, before the first frame, into an empty file; fd stays the caller's. 0, or -1 and
 * errno. */
int pupil_mkv_create(pupil_mkv_writer **writer, int fd, const pupil_recording_about *about);
/* -1 and errno: the file ends with the previous frame. */
int pupil_mkv_write(pupil_mkv_writer *writer, int64_t timestamp_ns, void *bytes, size_t size);
/* Writes the index and the duration. -1 and errno: the file is good without them. */
int pupil_mkv_finish(pupil_mkv_writer *writer);
void pupil_mkv_free(pupil_mkv_writer *writer); /* NULL is allowed */

typedef struct pupil_mkv_reader pupil_mkv_reader;

/* 0, or -1 and a sentence that begins with the path. A file that ends before its first frame is no failure. */
int pupil_mkv_open(pupil_mkv_reader **reader, const char *path, double fps, size_t frame_bytes, pupil_why *why);
/* The next frame, which must have this timestamp; its bytes are valid until the next call. 1; 0: the file ends before
 * or in the middle of it; -1 and a sentence without the path. */
int pupil_mkv_read(pupil_mkv_reader *reader, int64_t timestamp_ns, const unsigned char **bytes, size_t *size,
                   pupil_why *why);
void pupil_mkv_close(pupil_mkv_reader *reader); /* NULL is allowed */

#endif
