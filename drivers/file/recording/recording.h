/* drivers/file/recording/recording.h: raw frames to the disk as they came, and the same frames back.
 *
 * A recording is a folder:
 *     frames.mkv every frame, lossless: raw video in Matroska, or the camera's own JPEGs; ffmpeg and mpv open it
 *     frames.jsonl a line for each: sequence, timestamp_ns, exposure_s, gain, ...; written after its frame
 *     recording.json what a frame looks like: pixel format, size, coding of light, and where it came from It is usable
 *     at any moment: if its writer is killed, every frame that has a line is there and whole.
 *
 * The recorder has its own thread and buffers for a few frames, allocated at open: write copies the frame and never
 * waits for the disk. Where the disk is slower than the camera, frames are lost, and counted.
 */
#ifndef PUPIL_DRIVERS_FILE_RECORDING_RECORDING_H
#define PUPIL_DRIVERS_FILE_RECORDING_RECORDING_H

#include "pupil/error.h"
#include "source.h"

typedef struct pupil_recorder pupil_recorder;

typedef struct pupil_recorder_options {
    const char *camera;   /* whose frames these are, for people; NULL */
    double fps;           /* nominal, above 0 */
    uint32_t primaries;   /* as pupil_source.primaries */
    int overwrite;        /* 1: a recording (or empty folder) that is there is replaced; 0: it is refused */
    unsigned room;        /* most frames that wait for the disk; 0: 16 */
    int wait;             /* 1: write waits for room instead: for sources that can wait (files, scenes) */
    int (*give_up)(void); /* asked while write or close waits for the disk: 1: the wait ends, and frames not yet written
                           * are left out; NULL: waits for as long as it takes */
} pupil_recorder_options;

typedef struct pupil_recorder_counts {
    uint64_t written, lost; /* lost: there was no room */
} pupil_recorder_counts;

/* `first` is the first frame: all others have its size, pixel format and coding; only coding.balance may differ from
 * frame to frame. Open does not write it. 0, or PUPIL_SINK_FAILED and a sentence (folder, no room on the disk, a pixel
 * format that cannot be kept). */
int pupil_recorder_open(pupil_recorder **recorder, const char *folder, const pupil_frame *first,
                        const pupil_recorder_options *options, pupil_why *why);
/* 0: queued or lost (counted); PUPIL_SINK_FAILED and a sentence: another shape, or the disk failed; what was written
 * stays usable. */
int pupil_recorder_write(pupil_recorder *recorder, const pupil_frame *frame, pupil_why *why);
void pupil_recorder_get_counts(pupil_recorder *recorder, pupil_recorder_counts *counts);
/* Writes the waiting frames and completes the files. The recorder is freed either way, with give_up as soon as the
 * hanging call returns. NULL is allowed. */
int pupil_recorder_close(pupil_recorder *recorder, pupil_why *why);

/* 1: the folder is a recording (it has a recording.json). */
int pupil_is_recording(const char *folder);
/* Its frames, with their infos, bit for bit; a recording that was cut off ends with its last whole frame. */
int pupil_recording_open(const char *folder, const pupil_source_options *options, pupil_source **source,
                         pupil_why *why);

#endif
