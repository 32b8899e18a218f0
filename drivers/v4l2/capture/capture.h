/* drivers/v4l2/capture/capture.h: a stream of frames from a camera's node, in the kernel's own buffers.
 *
 *     open (negotiates, maps, starts) -> next -> (use the frame) -> done -> next -> ... -> close
 *
 * Every wait has a bound: next returns after options.timeout_s at the latest, and asks options.stop ten times a second.
 * Nothing is allocated after open; a call makes a bounded number of system calls for each frame that the driver has.
 *
 * Threads: one thread at a time on a capture. Controls may be written to its device's fd from another one.
 */
#ifndef PUPIL_DRIVERS_V4L2_CAPTURE_CAPTURE_H
#define PUPIL_DRIVERS_V4L2_CAPTURE_CAPTURE_H

#include "live_source.h"
#include "memory.h"
#include "pupil/error.h"
#include "v4l2/device.h"
#include "v4l2/format.h"

#define PUPIL_V4L2_MOST_BUFFERS 32 /* of one queue (VIDEO_MAX_FRAME) */

/* Which memory frames come in. */
typedef enum pupil_v4l2_memory {
    PUPIL_V4L2_MEMORY_AUTO = 0, /* what the CPU reads fast: the driver's own, else the next best (pupil_v4l2_reading) */
    PUPIL_V4L2_MEMORY_MMAP,     /* the driver's own, however slow */
    PUPIL_V4L2_MEMORY_USERPTR,  /* this program's */
    PUPIL_V4L2_MEMORY_DMABUF,   /* the caller's dma-bufs */
    PUPIL_V4L2_MEMORY_HEAP,     /* of a dma-heap (/dev/dma_heap) */
    PUPIL_V4L2_MEMORY_COUNT
} pupil_v4l2_memory;

/* How frames are read; dma-bufs between two DMA_BUF_IOCTL_SYNC, from next to done. */
typedef enum pupil_v4l2_reading {
    PUPIL_V4L2_READS_MAPPED = 0, /* where the driver keeps them */
    PUPIL_V4L2_READS_HINTED,     /* the same, allocated with V4L2_MEMORY_FLAG_NON_COHERENT: with caches */
    PUPIL_V4L2_READS_OWN,        /* in ordinary memory that the driver writes to */
    PUPIL_V4L2_READS_HEAP,       /* in dma-bufs of a heap */
    PUPIL_V4L2_READS_CALLERS,    /* in the caller's dma-bufs */
    PUPIL_V4L2_READS_COPIED,     /* copied once, of memory that is slow to read */
    PUPIL_V4L2_READS_COUNT
} pupil_v4l2_reading;

/* What can be asked of a camera. All zero: as it is set, on the kernel, an error if it stops. */
typedef struct pupil_v4l2_options {
    const pupil_v4l2_system *system; /* NULL: the kernel */
    uint32_t fourcc;                 /* 0: what is set, if it is read natively, else the first that is; else JPEGs */
    uint32_t width, height;          /* 0: what is set */
    double fps;                      /* 0: what is set. A camera whose driver has no rate to set runs at its own */
    uint32_t buffers;                /* 2..32; 0: 4 */
    double timeout_s;                /* after so long without a frame the stream has failed; 0: 5 */
    double reopen_s;                 /* pupil_live only: how long to wait for an unplugged camera, or to reopen one
                                      * whose stream stopped or changed; 0: these are errors */
    int late;                        /* a pupil_live_late */
    int share;                       /* 1: buffers as dma-bufs, too */
    uint32_t memory;                 /* a pupil_v4l2_memory */
    uint32_t dmabufs;                /* with PUPIL_V4L2_MEMORY_DMABUF: how many buffers, 2..32 ... */
    const int *dmabuf; /* ... and a dma-buf for each area of each of them, of format.size_bytes at least, open for
                        * reading and writing: the k-th area of buffer i is dmabuf[i * areas + k]. They stay the
                        * caller's, who keeps them open until close */
    int monotonic;     /* pupil_live only: 1: timestamps are CLOCK_MONOTONIC's; 0: the first frame's is 0 */
    int (*stop)(void); /* asked while waiting; nonzero ends the stream; NULL: never */
} pupil_v4l2_options;

typedef struct pupil_v4l2_buffer {
    void *memory[PUPIL_V4L2_MOST_AREAS];
    size_t bytes[PUPIL_V4L2_MOST_AREAS];
    int dmabuf[PUPIL_V4L2_MOST_AREAS];  /* a file descriptor of each area: its memory, or (options.share) an export; -1:
                                         * none */
    void *copy[PUPIL_V4L2_MOST_AREAS];  /* PUPIL_V4L2_READS_COPIED: of each area; NULL: none */
    size_t used[PUPIL_V4L2_MOST_AREAS]; /* bytes of the frame in each area */
    unsigned read;                      /* bit k: area k is between its two syncs */
    int queued;                         /* the driver's */
} pupil_v4l2_buffer;

typedef struct pupil_v4l2_capture {
    pupil_v4l2_device device;
    pupil_v4l2_options options;
    pupil_v4l2_format format;
    double fps;      /* as the driver says; 0: it does not */
    uint32_t memory; /* V4L2's */
    uint32_t can;    /* V4L2_BUF_CAP_... of the driver's buffers */
    uint32_t buffers;
    uint32_t reading;       /* a pupil_v4l2_reading */
    pupil_v4l2_speed speed; /* of the memory that frames come in; not measured: ordinary memory */
    const char *heap;       /* the heap's path; NULL: none */
    pupil_v4l2_buffer buffer[PUPIL_V4L2_MOST_BUFFERS];
    int streaming;
    int last; /* the driver has said that no more will come */
    pupil_live_pace pace;
    int began; /* last_sequence is valid */
    uint32_t last_sequence;
    pupil_live_counts counts;
} pupil_v4l2_capture;

typedef struct pupil_v4l2_frame {
    pupil_image_const image; /* in the kernel's buffer, until done; a JPEG's has no data: pupil_live decodes it */
    const void *coded;       /* a JPEG as it came, in the kernel's buffer, until done; NULL: none */
    size_t coded_bytes;
    int is_shared; /* dmabuf, except for its `stream`, is valid */
    pupil_frame_dmabuf dmabuf;
    uint32_t index;                               /* of its buffer */
    uint32_t offset_bytes[PUPIL_V4L2_MOST_AREAS]; /* where its pixels begin in each area */
    uint32_t sequence;                            /* the driver's number */
    uint32_t lost;                                /* frames missing before it */
    uint32_t stamp;                               /* a pupil_live_stamp */
    int64_t stamp_ns;                             /* CLOCK_MONOTONIC */
    int64_t taken_ns;                             /* when it came from the driver */
} pupil_v4l2_frame;

enum {
    PUPIL_V4L2_END = 0, /* the driver said so, or options.stop */
    PUPIL_V4L2_FRAME = 1,
    PUPIL_V4L2_FAILED = -1,
    PUPIL_V4L2_GONE = -2,    /* unplugged */
    PUPIL_V4L2_STOPPED = -3, /* no frame in time, or the driver gave up: opening again may help */
    PUPIL_V4L2_CHANGED = -4  /* another signal: it must be opened again, at another size perhaps */
};

/* "mapped", "copied", ...: a pupil_v4l2_reading in a word or two. */
const char *pupil_v4l2_reading_name(uint32_t reading);

/* 0, or PUPIL_V4L2_FAILED or _GONE and a sentence; then nothing is left open. */
int pupil_v4l2_capture_open(pupil_v4l2_capture *capture, const char *which, const pupil_v4l2_options *options,
                            pupil_why *why);
/* PUPIL_V4L2_FRAME, _END, or what is wrong and a sentence. The driver lacks buffers that are still out: with all of
 * them out, no frame comes. */
int pupil_v4l2_capture_next(pupil_v4l2_capture *capture, pupil_v4l2_frame *frame, pupil_why *why);
/* Back to the driver; twice is allowed. 0, or as next. */
int pupil_v4l2_capture_done(pupil_v4l2_capture *capture, const pupil_v4l2_frame *frame, pupil_why *why);
double pupil_v4l2_capture_timeout_s(const pupil_v4l2_capture *capture); /* options.timeout_s, or its default */
void pupil_v4l2_capture_close(pupil_v4l2_capture *capture);             /* twice is allowed */

/* --- the parts, each in its own file --- */

/* Format, size, rate: into capture->format and fps. */
int pupil_v4l2_negotiate(pupil_v4l2_capture *capture, pupil_why *why);

/* Memory for frames, mapped and queued; and given back. */
int pupil_v4l2_buffers_make(pupil_v4l2_capture *capture, pupil_why *why);
int pupil_v4l2_buffer_queue(pupil_v4l2_capture *capture, uint32_t index); /* 0, or -1 and errno */
/* Before a filled buffer is read, and after it. 0, or -1 and errno. */
int pupil_v4l2_buffer_read(pupil_v4l2_capture *capture, uint32_t index);
void pupil_v4l2_buffer_unread(pupil_v4l2_capture *capture, uint32_t index);
void pupil_v4l2_buffers_free(pupil_v4l2_capture *capture);

#endif
