/* drivers/file/recording/recording_read.c: a recording as a source. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "file/common/regular.h"
#include "file/video/jpeg_frame.h"
#include "max_pixels.h"
#include "recording.h"
#include "recording_format.h"
#include "recording_mkv.h"
#include "refuse.h"

#define LINE_MOST_BYTES 4096 /* ours have about 150 */

typedef struct recording {
    pupil_source base;
    pupil_recording_about about; /* its coding: the frame's */
    float usual_balance[3];      /* of frames whose line has none */
    char frames_path[PATH_MAX], lines_path[PATH_MAX];
    char name[PATH_MAX + 32]; /* of the frame */
    int folder_length;        /* length of the recording's name, with which the two paths begin */
    FILE *lines;
    pupil_mkv_reader *mkv;
    unsigned char *bytes; /* the frame, or its JPEG */
    size_t size, capacity;
    pupil_jpeg *jpeg; /* NULL: frames are raw */
    uint64_t frame;   /* how many were handed out */
    int state;        /* PUPIL_SOURCE_FRAME while frames come; END or FAILED for good */
    pupil_why why;
} recording;

__attribute__((format(printf, 2, 3))) static int failed(recording *r, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(r->why.text, sizeof r->why.text, format, arguments);
    va_end(arguments);
    return r->state = PUPIL_SOURCE_FAILED;
}

/* The next line. PUPIL_SOURCE_FRAME; _END where there is none with a newline: its write was cut off. */
static int next_line(recording *r, pupil_frame_info *info)
{
    char line[LINE_MOST_BYTES];
    pupil_why words;
    const unsigned long long number = r->frame + 1;
    uint64_t frame;
    if (!fgets(line, sizeof line, r->lines))
        return ferror(r->lines) ? failed(r, "%s: cannot be read: %s", r->lines_path, strerror(errno))
                                : PUPIL_SOURCE_END;
    if (!strchr(line, '\n'))
        return strlen(line) < sizeof line - 1 && feof(r->lines)
                   ? PUPIL_SOURCE_END
                   : failed(r, "%s:%llu: the line is longer than any that pupil record writes", r->lines_path, number);
    memcpy(r->about.coding.balance, r->usual_balance, sizeof r->usual_balance);
    if (pupil_recording_line_read(line, &frame, info, r->about.coding.balance, &words))
        return failed(r, "%s:%llu: %s", r->lines_path, number, words.text);
    if (frame != r->frame)
        return failed(r, "%s:%llu: \"frame\" is %llu; in this line it must be %llu", r->lines_path, number,
                      (unsigned long long)frame, (unsigned long long)r->frame);
    return PUPIL_SOURCE_FRAME;
}

static int reserve(recording *r, size_t bytes)
{
    if (bytes <= r->capacity)
        return 0;
    unsigned char *more = realloc(r->bytes, bytes);
    if (!more)
        return -1;
    r->bytes = more;
    r->capacity = bytes;
    return 0;
}

/* The next frame's bytes. As next_line. */
static int next_bytes(recording *r, int64_t timestamp_ns)
{
    const unsigned char *bytes;
    size_t size;
    pupil_why words;
    const unsigned long long frame = r->frame;
    const int got = pupil_mkv_read(r->mkv, timestamp_ns, &bytes, &size, &words);
    if (got < 0)
        return failed(r, "%s: frame %llu: %s", r->frames_path, frame, words.text);
    if (!got)
        return PUPIL_SOURCE_END;
    const size_t right = pupil_recording_bytes(&r->about);
    if (!r->about.jpeg && size != right)
        return failed(r, "%s: frame %llu has %zu bytes; %u x %u pixels of %s have %zu", r->frames_path, frame, size,
                      r->about.width, r->about.height, pupil_recording_pixel_name(r->about.pixel), right);
    if (reserve(r, size))
        return failed(r, "%s: no memory for a frame of %zu bytes", r->frames_path, size);
    memcpy(r->bytes, bytes, size); /* aligned for its pixels */
    r->size = size;
    return PUPIL_SOURCE_FRAME;
}

/* Decodes it as the camera driver decoded it, with the same coding. */
static int decode(recording *r, pupil_image_const *image, pupil_why *why)
{
    pupil_why words;
    if (pupil_jpeg_decode(r->jpeg, r->bytes, r->size, image, &words))
        return pupil_refuse(why, "%s: frame %llu: %s", r->frames_path, (unsigned long long)r->frame, words.text);
    if (image->pixel != r->about.pixel)
        return pupil_refuse(why, "%s: frame %llu is not a JPEG that %s can be decoded from, as the others are",
                            r->frames_path, (unsigned long long)r->frame, pupil_recording_pixel_name(r->about.pixel));
    image->coding = &r->about.coding;
    return 0;
}

static int recording_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    recording *r = (recording *)source;
    pupil_frame_info info;
    if (r->state == PUPIL_SOURCE_FRAME)
        r->state = next_line(r, &info);
    if (r->state == PUPIL_SOURCE_FRAME)
        r->state = next_bytes(r, info.timestamp_ns);
    if (r->state != PUPIL_SOURCE_FRAME) {
        if (r->state == PUPIL_SOURCE_FAILED)
            pupil_refuse(why, "%s", r->why.text);
        return r->state;
    }
    memset(frame, 0, sizeof *frame);
    if (r->jpeg && decode(r, &frame->image, why)) {
        r->frame++;
        return PUPIL_SOURCE_DAMAGED;
    }
    if (!r->jpeg)
        frame->image = pupil_recording_image(&r->about, r->bytes);
    frame->coded = r->jpeg ? r->bytes : NULL;
    frame->coded_bytes = r->jpeg ? r->size : 0;
    frame->info = info;
    snprintf(r->name, sizeof r->name, "%.*s frame %llu", r->folder_length, r->frames_path,
             (unsigned long long)info.sequence);
    frame->name = r->name;
    r->frame++;
    return PUPIL_SOURCE_FRAME;
}

static void recording_done(pupil_source *source, pupil_frame *frame)
{
    (void)source;
    (void)frame;
}

static void recording_close(pupil_source *source)
{
    recording *r = (recording *)source;
    if (r->lines)
        fclose(r->lines);
    pupil_mkv_close(r->mkv);
    pupil_jpeg_close(r->jpeg);
    free(r->bytes);
    free(r);
}

static const pupil_source_ops recording_ops = {recording_next, recording_done, recording_close};

/* Up to the first unreadable line: a sparse file may go on for terabytes. */
static uint64_t count_lines(FILE *lines)
{
    uint64_t count = 0;
    char line[LINE_MOST_BYTES];
    while (fgets(line, sizeof line, lines) && strchr(line, '\n'))
        count++;
    rewind(lines);
    return count;
}

static int open_files(recording *r, const char *folder)
{
    pupil_why words;
    if (pupil_recording_path(r->frames_path, folder, PUPIL_RECORDING_FRAMES) ||
        pupil_recording_path(r->lines_path, folder, PUPIL_RECORDING_LINES))
        return failed(r, "%s: the name is too long", folder);
    r->folder_length = (int)strlen(folder);
    r->lines = pupil_regular_open(r->lines_path, &r->why);
    if (!r->lines)
        return -1;
    if (pupil_mkv_open(&r->mkv, r->frames_path, r->about.fps, pupil_recording_bytes(&r->about), &r->why))
        return -1;
    if (r->about.jpeg && pupil_jpeg_open(&r->jpeg, r->about.width, r->about.height, &r->about.coding, &words))
        return failed(r, "%s: %s", r->frames_path, words.text);
    if (reserve(r, pupil_recording_bytes(&r->about)))
        return failed(r, "%s: no memory for a frame", r->frames_path);
    return 0;
}

int pupil_recording_open(const char *folder, const pupil_source_options *options, pupil_source **source, pupil_why *why)
{
    recording *r = calloc(1, sizeof *r);
    *source = NULL;
    if (!r) {
        pupil_refuse(why, "%s: not enough memory", folder);
        return PUPIL_SOURCE_FAILED;
    }
    r->base.ops = &recording_ops;
    r->state = PUPIL_SOURCE_FRAME;
    if (pupil_recording_about_read(folder, &r->about, why) == 0 &&
        pupil_check_max_pixels(options, r->about.width, r->about.height, "", folder, why) == 0) {
        memcpy(r->usual_balance, r->about.coding.balance, sizeof r->usual_balance);
        if (open_files(r, folder) == 0) {
            r->base.fps = r->about.fps;
            r->base.primaries = r->about.primaries;
            r->base.frames = count_lines(r->lines);
            *source = &r->base;
            return 0;
        }
        pupil_refuse(why, "%s", r->why.text);
    }
    recording_close(&r->base);
    return PUPIL_SOURCE_FAILED;
}
