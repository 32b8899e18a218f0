/* drivers/file/recording_mkv.h: one video track in Matroska, a frame a cluster, so that a file is good up to its last
 * whole frame at any moment and a frame is written without being copied; and read again.
 *
 * RFC 9559 has the elements, RFC 8794 (EBML) how they are written. libavformat's writer is not taken: it gathers a
 * cluster in memory of its own, and keeps an entry of its index for every frame.
 */
#ifndef PUPIL_DRIVERS_FILE_RECORDING_MKV_H
#define PUPIL_DRIVERS_FILE_RECORDING_MKV_H

#include "file/recording_format.h"

#define PUPIL_MKV_CUES 1024

typedef struct pupil_mkv_writer {
    int fd;
    int64_t end; /* of the last whole frame, and of the file */
    int64_t seek_at, duration_at;
    uint64_t frames;
    uint64_t time_ns, period_ns; /* of the last frame in the file */
    int64_t stamp_ns;            /* as it was given */
    /* The index for players: one of each cue_every frames, so many that they fit. */
    uint64_t cue_every;
    unsigned cues;
    struct {
        uint64_t time_us, position;
    } cue[PUPIL_MKV_CUES];
} pupil_mkv_writer;

/* Writes what stands before the first frame into an empty file; fd stays the caller's. 0, or -1 and errno. */
int pupil_mkv_begin(pupil_mkv_writer *mkv, int fd, const pupil_recording_about *about);
/* A frame at the kernel when it returns. -1 and errno: the file ends with the frame before. */
int pupil_mkv_frame(pupil_mkv_writer *mkv, int64_t timestamp_ns, const void *bytes, size_t size);
/* The index, the duration, the size. -1 and errno: the file is good without these. */
int pupil_mkv_end(pupil_mkv_writer *mkv);

typedef struct pupil_mkv_reader {
    int fd;
    uint64_t at, size; /* where it stands; of the file */
} pupil_mkv_reader;

void pupil_mkv_open(pupil_mkv_reader *mkv, int fd, uint64_t size);
/* The next frame's bytes: where they begin and how many. 1; 0: the file ends, here or in the middle of one; -1: that is
 * no Matroska, at byte mkv->at. */
int pupil_mkv_next(pupil_mkv_reader *mkv, uint64_t *begin, uint64_t *bytes);

#endif
