/* drivers/libcamera/layer.h: what is used of libcamera, as one table of C functions, so that a fake can take its place.
 * layer.cpp is the one file that calls the library; layer_absent.c says that there is none.
 *
 *     open -> configure -> start -> queue, queue, ... -> wait -> (use the frame) -> queue -> ... -> stop -> close
 *
 * A request belongs to a buffer, and has its number. Each one that was queued comes back from `wait` once: with a
 * frame, or cancelled. That is libcamera's promise; the source handles requests that break it.
 */
#ifndef PUPIL_DRIVERS_LIBCAMERA_LAYER_H
#define PUPIL_DRIVERS_LIBCAMERA_LAYER_H

#ifdef __cplusplus
extern "C" {
#endif

#include <stddef.h>
#include <stdint.h>

#include "live_source.h"
#include "pupil/error.h"

#define PUPIL_LIBCAMERA_MOST_BUFFERS 32
#define PUPIL_LIBCAMERA_MOST_PLANES  3

/* Controls that a camera lists (Camera::controls). The two modes came with libcamera 0.5. */
enum {
    PUPIL_LIBCAMERA_CAN_EXPOSURE = 1,
    PUPIL_LIBCAMERA_CAN_GAIN = 2,
    PUPIL_LIBCAMERA_CAN_FRAME = 4, /* FrameDurationLimits */
    PUPIL_LIBCAMERA_CAN_AE = 8,    /* AeEnable */
    PUPIL_LIBCAMERA_CAN_EXPOSURE_MODE = 16,
    PUPIL_LIBCAMERA_CAN_GAIN_MODE = 32
};

typedef struct pupil_libcamera_range {
    double least, most, usual; /* most 0: not known */
} pupil_libcamera_range;

typedef struct pupil_libcamera_can {
    char model[64];
    uint32_t controls; /* PUPIL_LIBCAMERA_CAN_..., or'ed */
    pupil_libcamera_range exposure_s, gain, frame_s;
} pupil_libcamera_can;

/* 0: as it is. */
typedef struct pupil_libcamera_wanted {
    uint32_t fourcc; /* V4L2's */
    uint32_t width, height, buffers;
} pupil_libcamera_wanted;

typedef struct pupil_libcamera_stream {
    uint32_t fourcc; /* V4L2's name of libcamera's format */
    uint32_t width, height, stride_bytes, size_bytes, buffers;
    uint32_t colorspace, ycbcr_enc, quantization, xfer_func; /* V4L2's numbers; 0: not known */
} pupil_libcamera_stream;

/* A buffer's planes, mapped to be read, and their dma-bufs. */
typedef struct pupil_libcamera_buffer {
    uint32_t planes;
    const unsigned char *memory[PUPIL_LIBCAMERA_MOST_PLANES];
    size_t bytes[PUPIL_LIBCAMERA_MOST_PLANES];
    int dmabuf[PUPIL_LIBCAMERA_MOST_PLANES];
    uint32_t offset_bytes[PUPIL_LIBCAMERA_MOST_PLANES]; /* where the plane begins in its dma-buf */
} pupil_libcamera_buffer;

/* What a request asks for. 0: as it is. */
typedef struct pupil_libcamera_ask {
    int automatic; /* 1: on; -1: off: AeEnable, and where they are listed the two modes */
    double exposure_s, gain;
    double frame_least_s, frame_most_s; /* both or none */
} pupil_libcamera_ask;

/* A request that came back. */
typedef struct pupil_libcamera_done {
    uint32_t index;
    int cancelled;     /* there is no frame, and what was asked for was not set */
    int damaged;       /* as the driver says */
    uint32_t sequence; /* the driver's number */
    int64_t stamp_ns;  /* CLOCK_MONOTONIC; 0: none */
    size_t used[PUPIL_LIBCAMERA_MOST_PLANES];
    double exposure_s, gain; /* of this very frame, by its metadata; 0: it has none */
    double black;            /* of a full scale of 65535; negative: none */
} pupil_libcamera_done;

typedef struct pupil_libcamera_layer {
    void *context; /* the first argument of list, open and now_ns */
    /* Each camera's id. 0, or -1 and a sentence. */
    int (*list)(void *context, void (*found)(void *closure, const char *id, const char *model), void *closure,
                pupil_why *why);
    /* NULL and a sentence. */
    void *(*open)(void *context, const char *id, pupil_why *why);
    void (*close)(void *camera);
    /* Fills an empty `offers` with the camera's name, controls and modes (freed by the caller), and `can`. Either may
     * be NULL. 0, or -1: no memory. */
    int (*offers)(void *camera, pupil_live_offers *offers, pupil_libcamera_can *can);
    /* Takes the camera for this process, and makes its buffers. 0, or -1 and a sentence. */
    int (*configure)(void *camera, const pupil_libcamera_wanted *wanted, pupil_libcamera_stream *stream,
                     pupil_why *why);
    const pupil_libcamera_buffer *(*buffer)(void *camera, uint32_t index);
    int (*start)(void *camera, pupil_why *why);
    /* All requests that are still out are dropped: none of them comes back. */
    void (*stop)(void *camera);
    /* 0, or -1: the camera is not there to take it. */
    int (*queue)(void *camera, uint32_t index, const pupil_libcamera_ask *ask);
    /* 1: `done` has one; 0: none came in time; -1: the camera is gone, and nothing is left. */
    int (*wait)(void *camera, pupil_libcamera_done *done, int timeout_ms);
    int64_t (*now_ns)(void *context); /* CLOCK_MONOTONIC */
} pupil_libcamera_layer;

/* The library's. NULL: this program was built without it. */
const pupil_libcamera_layer *pupil_libcamera_library(void);
/* "0.0.3"; "": without it. */
const char *pupil_libcamera_version(void);

#ifdef __cplusplus
}
#endif

#endif
