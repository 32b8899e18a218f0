/* drivers/file/video/video_io.h: bytes for libav's demuxers, and the errors that libav reports.
 *
 * Demuxers get one AVIOContext and nothing else: a playlist or a container that names other files or addresses finds
 * every protocol closed (pupil_video_source_open sets the whitelist).
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_IO_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_IO_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include <libavcodec/avcodec.h>
#include <libavformat/avio.h>

typedef struct pupil_video_io {
    AVIOContext *context;
    int fd, close_fd;  /* -1: the bytes below */
    int error;         /* errno of a read that failed */
    int (*stop)(void); /* asked before each read, which fails if it returns 1; NULL: never. Demuxers search the whole
                        * file for their marks, and a sparse file as large as a disk costs nothing to make */
    const uint8_t *bytes;
    size_t size, position;
    int64_t read, read_most; /* bytes since the caller set `read` to 0, and their limit: libav keeps a whole packet in
                              * memory, and a damaged packet may end only with the file. 0: no limit */
    int64_t total;           /* bytes of the whole file; -1 where that cannot be known (a pipe) */
} pupil_video_io;

/* Opens a file, or standard input for "-". 0, or -1 and a sentence without the path. */
int pupil_video_io_open(pupil_video_io *io, const char *path, pupil_why *why);

/* The same over bytes, which the caller keeps until close. */
int pupil_video_io_bytes(pupil_video_io *io, const uint8_t *bytes, size_t size, pupil_why *why);

void pupil_video_io_close(pupil_video_io *io);

/* From now on libav prints nothing (in the whole process: its log has one hook). Instead the first error that it
 * reports on this thread is kept until the next clear, except errors of a codec that has its own words. */
void pupil_video_log_clear(void);

/* The kept error, without its newline; "" for none. Valid until the next clear on this thread. */
const char *pupil_video_log_text(void);

/* The first error that a codec reports, on any of its threads. */
typedef struct pupil_video_words {
    char text[256]; /* "" for none */
} pupil_video_words;

/* From now on the codec's errors go there, until its opaque is NULL. */
void pupil_video_words_of(AVCodecContext *codec, pupil_video_words *words);

/* Copies them to text, and clears them. Whether there are any. */
int pupil_video_words_take(pupil_video_words *words, char text[256]);

#endif
