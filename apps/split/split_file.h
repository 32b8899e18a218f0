/* apps/split/split_file.h: the files of pupil meter, adapt and map: a part has the statistics of some frames of an
 * input; curves have what maps each frame.
 *
 * On disk: a split_header, then a record for each frame: its info and a struct of the library, as words of 64 bits,
 * each in a variable number of bytes, and a run of zeros in two; in a part also the frame's name. Complete or absent
 * (file/common/pending.h). The header allows only a program of the same version on the same kind of machine to read it.
 * A file with a damaged header or record is refused when it is opened.
 */
#ifndef PUPIL_APPS_SPLIT_SPLIT_FILE_H
#define PUPIL_APPS_SPLIT_SPLIT_FILE_H

#include "file/common/pending.h"
#include "pupil/pupil.h"

#define SPLIT_PART   "pupil part"
#define SPLIT_CURVES "pupil curves"

typedef struct split_header {
    char kind[16];        /* SPLIT_PART or SPLIT_CURVES */
    char version[16];     /* pupil_version() */
    uint32_t byte_order;  /* 0x01020304 */
    uint32_t own_bytes;   /* of this header */
    uint64_t first;       /* the number of the first frame in the input ... */
    uint64_t count;       /* ... and how many there are */
    uint64_t bytes;       /* of the records ... */
    uint64_t digest;      /* ... and their FNV-1a */
    uint64_t own_digest;  /* FNV-1a of this header, with 0 here */
    uint64_t input_names; /* FNV-1a of the names of all inputs, without their folders */
    uint64_t input_bytes; /* of the inputs that are files, together */
    uint64_t input_count;
    uint32_t is_last;  /* the input ends after these frames */
    uint32_t dither;   /* frame_options.dither */
    uint32_t has_unit; /* frame `unit_frame`, the first with light, has set unit_stops (frame/any_scale.h) */
    int32_t unit_stops;
    uint64_t unit_frame;
    double fps;
    char input[256];     /* the first input, for people */
    pupil_config config; /* of the metering; in curves also of the adaptation */
} split_header;

typedef struct split_frame {
    pupil_frame_info info;
    uint64_t pixels; /* split_pixels() of it */
    char name[512];  /* of a part; else empty */
    union {
        pupil_stats stats; /* of a part */
        pupil_curve curve; /* of curves */
        uint64_t words[1200];
    } is;
} split_frame;

typedef struct split_file {
    split_header header;
    const char *path;
    FILE *stream;
    pupil_pending pending;  /* of a file that is written */
    uint64_t frames;        /* written or read */
    uint64_t bytes, digest; /* the digest of a file that is written */
    int writes;
} split_file;

/* Opens a file to write; the header's settings are the caller's. 0, or -1 and a sentence that names the path. */
int split_file_create(split_file *f, const char *path, int overwrite, pupil_why *why);
int split_file_write(split_file *f, const split_frame *frame, pupil_why *why);
/* Puts it in its place. */
int split_file_finish(split_file *f, pupil_why *why);

/* Opens a file of this kind to read. */
int split_file_open(split_file *f, const char *path, const char *kind, pupil_why *why);
/* The next frame. */
int split_file_read(split_file *f, split_frame *frame, pupil_why *why);

/* Closes the file, and removes it if it is not finished. Takes a zeroed struct, and a second call. */
void split_file_close(split_file *f);

/* FNV-1a, 64 bits, continued. */
uint64_t split_digest(uint64_t digest, const void *bytes, size_t count);

#endif
