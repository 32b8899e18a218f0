/* tests/fake_v4l2/fake_v4l2_private.h: shared by the fake's files. */
#ifndef PUPIL_TESTS_FAKE_V4L2_PRIVATE_H
#define PUPIL_TESTS_FAKE_V4L2_PRIVATE_H

#include <linux/videodev2.h>
#include <pthread.h>

#include "fake_v4l2.h"
#include "v4l2/format.h"

#define FAKE_MOST_FILES   96
#define FAKE_MOST_BUFFERS 32
#define FAKE_MOST_EVENTS  8
#define FAKE_SETTINGS     8 /* for how many past frames settings are kept */

typedef enum fake_kind {
    FAKE_CAMERA = 1,
    FAKE_METADATA,
    FAKE_OUTPUT,
    FAKE_TWIN,
    FAKE_MEDIA,
    FAKE_SENSOR,
    FAKE_RECEIVER,
    FAKE_HEAP,       /* a dma-heap; the next ones, too */
    FAKE_CONTIGUOUS, /* linux,cma */
    FAKE_SHARED      /* a dma-buf */
} fake_kind;

typedef struct fake_file {
    int fd, kind; /* kind 0: none */
    int gone;     /* opened before the unplugging */
    int heap;     /* of a dma-buf: the kind of its heap; 0: the camera's own buffer */
    int reading;  /* of a dma-buf: between two syncs */
} fake_file;

typedef struct fake_buffer {
    int memfd[PUPIL_V4L2_MOST_AREAS];
    void *memory[PUPIL_V4L2_MOST_AREAS]; /* the fake's own mapping, or the user's memory, or what a dma-buf will have
                                            once it is synced */
    int dmabuf[PUPIL_V4L2_MOST_AREAS];
    uint32_t bytes[PUPIL_V4L2_MOST_AREAS];
    int queued, done;
    uint32_t sequence, flags, used[PUPIL_V4L2_MOST_AREAS];
    int64_t stamp_ns;
} fake_buffer;

typedef struct fake_settings {
    int32_t automatic, exposure_100us, gain_16ths, priority;
} fake_settings;

#define FAKE_OUTPUT_BUFFERS 4

typedef struct fake_output_buffer {
    int memfd;
    void *memory; /* the fake's own mapping */
    size_t bytes;
    int queued;
    int64_t done_ns; /* when it is given back */
} fake_output_buffer;

typedef struct fake_output {
    uint32_t fourcc, width, height, extra_bytes, colorspace;
    double fps; /* as it was set */
    fake_output_buffer buffer[FAKE_OUTPUT_BUFFERS];
    uint32_t buffers, order[FAKE_OUTPUT_BUFFERS], waiting;
    int owner; /* the fd that owns the buffers; -1 */
    int streaming, gone;
    int64_t last_ns; /* the end of the last frame's time on the screen */
    unsigned char *shown;
    uint32_t shown_bytes;
    uint64_t frames;
} fake_output;

struct fake_v4l2 {
    fake_v4l2_config config;
    pupil_v4l2_system system;
    pthread_mutex_t lock;
    int64_t now_ns;
    double light;
    fake_file file[FAKE_MOST_FILES];
    int maps;

    int plugged, node; /* the number of its video node */
    int64_t back_ns;

    uint32_t fourcc, width, height, interval; /* the index in fake_rates */
    uint32_t type;
    fake_buffer buffer[FAKE_MOST_BUFFERS];
    uint32_t buffers, memory;
    int cached;                                            /* they were allocated as NON_COHERENT */
    void *slow[FAKE_MOST_BUFFERS * PUPIL_V4L2_MOST_AREAS]; /* maps that are read slowly */
    int unsynced;
    int owner;                                      /* the fd that owns the buffers; -1 */
    uint32_t order[FAKE_MOST_BUFFERS], waiting;     /* queued, the first to be filled first */
    uint32_t ready[FAKE_MOST_BUFFERS], ready_count; /* done, the first to be taken first */
    int streaming, broken, ended;
    int64_t start_ns;
    uint64_t made;   /* frames since STREAMON, including lost ones */
    uint64_t writes; /* of controls */

    uint32_t events[FAKE_MOST_EVENTS], event_count, subscribed;
    fake_settings settings, of_frame[FAKE_SETTINGS];
    fake_output output;
};

/* What an ioctl answers: 0, or -1 and errno. */
int fake_fail(int error);

/* fake_modes.c */
int fake_querycap(const fake_v4l2 *f, int kind, struct v4l2_capability *c);
int fake_enum_formats(const fake_v4l2 *f, struct v4l2_fmtdesc *d);
int fake_enum_sizes(const fake_v4l2 *f, struct v4l2_frmsizeenum *s);
int fake_enum_intervals(const fake_v4l2 *f, struct v4l2_frmivalenum *i);
int fake_format(fake_v4l2 *f, struct v4l2_format *format, int set);
int fake_parm(fake_v4l2 *f, struct v4l2_streamparm *p, int set);
uint32_t fake_areas(const fake_v4l2 *f);
/* Strides of planes, sizes of areas. */
void fake_layout(const fake_v4l2 *f, uint32_t stride[PUPIL_V4L2_MOST_AREAS], uint32_t size[PUPIL_V4L2_MOST_AREAS]);
double fake_rate(const fake_v4l2 *f);

/* fake_stream.c */
int fake_stream_ioctl(fake_v4l2 *f, int fd, unsigned long request, void *argument);
void fake_produce(fake_v4l2 *f);          /* all frames that are due */
int64_t fake_next_ns(const fake_v4l2 *f); /* when the next one is; INT64_MAX: never */
void fake_free_buffers(fake_v4l2 *f);
void fake_unplug(fake_v4l2 *f);

/* fake_controls.c; 1: not a request for controls */
int fake_controls_ioctl(fake_v4l2 *f, unsigned long request, void *argument);

/* fake_memory.c */
fake_file *fake_file_of(fake_v4l2 *f, int fd);
int fake_keep(fake_v4l2 *f, int fd, int kind);
int fake_heap_ioctl(fake_v4l2 *f, int kind, unsigned long request, void *argument);
int fake_dmabuf_ioctl(fake_v4l2 *f, fake_file *file, unsigned long request, const void *argument);
int fake_import(fake_v4l2 *f, fake_buffer *own, uint32_t area, int fd, uint32_t bytes, uint32_t least);
void fake_note_map(fake_v4l2 *f, void *memory);
void fake_forget_map(fake_v4l2 *f, const void *memory);
int64_t fake_read_ns(void *context, const void *memory, size_t bytes);

/* fake_jpeg.c: the picture as a webcam's JPEG of 4:2:2, without Huffman tables. Returns its size in bytes; 0: it cannot
 * be made. */
uint32_t fake_jpeg(const fake_v4l2_picture *picture, unsigned char *to, uint32_t room);

/* fake_output.c */
int fake_output_ioctl(fake_v4l2 *f, int fd, unsigned long request, void *argument);
ssize_t fake_output_write(fake_v4l2 *f, const void *data, size_t bytes);
void *fake_output_mmap(fake_v4l2 *f, size_t bytes, off_t offset);
short fake_output_ready(const fake_v4l2 *f);
int64_t fake_output_next_ns(const fake_v4l2 *f); /* when it takes a frame; INT64_MAX: never */
void fake_output_free(fake_v4l2 *f);

/* fake_media.c */
int fake_media_ioctl(const fake_v4l2 *f, int kind, unsigned long request, void *argument);
int fake_media_name(const fake_v4l2 *f, uint32_t major, uint32_t minor, char *name, size_t name_bytes);

#define FAKE_MAJOR          81
#define FAKE_SENSOR_MINOR   200
#define FAKE_RECEIVER_MINOR 201

#endif
