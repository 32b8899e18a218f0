/* drivers/file/recording/recording_format.h: what a recording's frames look like, as bytes on disk and as
 * recording.json has it.
 */
#ifndef PUPIL_DRIVERS_FILE_RECORDING_RECORDING_FORMAT_H
#define PUPIL_DRIVERS_FILE_RECORDING_RECORDING_FORMAT_H

#include <limits.h>
#include <stdio.h>

#include "pupil/error.h"
#include "source.h"

#define PUPIL_RECORDING_FRAMES  "frames.mkv"
#define PUPIL_RECORDING_LINES   "frames.jsonl"
#define PUPIL_RECORDING_ABOUT   "recording.json"
#define PUPIL_RECORDING_PART    "recording.json.part" /* the same, while it is written */
#define PUPIL_RECORDING_VERSION 1

/* Room for a line of frames.jsonl: eight numbers of at most 24 characters, and their names. */
#define PUPIL_RECORDING_LINE_BYTES 512

typedef struct pupil_recording_about {
    uint32_t pixel, width, height; /* pixel: a pupil_pixel */
    uint32_t jpeg;                 /* 1: frames.mkv has the camera's JPEGs, which are decoded to such frames */
    double fps;
    uint32_t primaries; /* a pupil_primaries, BT.709 or BT.2020 */
    pupil_coding coding;
} pupil_recording_about;

/* "folder/name". 0, or -1 where it is too long. */
int pupil_recording_path(char path[PATH_MAX], const char *folder, const char *name);

/* "yuyv" and so on; NULL: frames of this format are not recorded. */
const char *pupil_recording_pixel_name(uint32_t pixel);
/* The format's code in Matroska: FFmpeg's, else V4L2's, else our own. */
uint32_t pupil_recording_fourcc(const pupil_recording_about *about);

/* Bytes of a frame: rows without padding, NV12's chroma behind its luma. */
size_t pupil_recording_bytes(const pupil_recording_about *about);
/* Copies an image of any stride to these bytes; makes an image over them. */
void pupil_recording_pack(const pupil_image_const *image, unsigned char *bytes);
pupil_image_const pupil_recording_image(const pupil_recording_about *about, const unsigned char *bytes);

/* 0, or -1 and a sentence without its subject: no image of the library can have this shape. */
int pupil_recording_check(const pupil_recording_about *about, pupil_why *why);

/* The text of recording.json; to be freed; NULL: out of memory. camera: whose frames these are, for people; NULL. */
char *pupil_recording_about_text(const pupil_recording_about *about, const char *camera);
/* Writes the file, which appears only when it is complete. 0, or -1 and a sentence. */
int pupil_recording_about_write(const char *folder, const pupil_recording_about *about, const char *camera,
                                pupil_why *why);
/* Reads it again. 0, or -1 and a sentence that names the file, and the line or field where there is one. */
int pupil_recording_about_read(const char *folder, pupil_recording_about *about, pupil_why *why);

/* A line of frames.jsonl with its newline; its length. balance: the frame's own white balance; NULL: recording.json's.
 */
size_t pupil_recording_line(char line[PUPIL_RECORDING_LINE_BYTES], uint64_t frame, const pupil_frame_info *info,
                            const float balance[3]);
/* Reads it again; balance is left as it is where the line has none. 0, or -1 and a sentence without its subject that
 * names the field. */
int pupil_recording_line_read(const char *line, uint64_t *frame, pupil_frame_info *info, float balance[3],
                              pupil_why *why);

/* Makes a folder (1), or clears one that is empty or, with overwrite, holds a recording and nothing else (0). -1 and a
 * sentence: nothing was touched. */
int pupil_recording_make_folder(const char *folder, int overwrite, pupil_why *why);
void pupil_recording_remove_files(const char *folder);
/* Makes a new file in it, to read and write; -1 and a sentence. */
int pupil_recording_create(const char *folder, const char *name, pupil_why *why);

#endif
