/* drivers/libcamera/libcamera_private.h: what the files of this folder share. */
#ifndef PUPIL_DRIVERS_LIBCAMERA_LIBCAMERA_PRIVATE_H
#define PUPIL_DRIVERS_LIBCAMERA_LIBCAMERA_PRIVATE_H

#include <pthread.h>

#include "camera_history.h"
#include "libcamera.h"
#include "v4l2/format.h"

/* ---- which.c ---- */

/* The id of the camera that a user names. 0, or -1 and a sentence. */
int libcamera_find(const pupil_libcamera_layer *layer, const char *which, char *id, size_t id_bytes, pupil_why *why);
/* Webcams' ids end with the numbers of vendor and product (uvcvideo's pipeline). */
int libcamera_is_webcam(const char *id);

/* ---- node.c: the V4L2 node of a webcam ---- */

enum { LIBCAMERA_NODE_CONTROLS = 3 };

typedef struct libcamera_node {
    const pupil_v4l2_system *system;
    int fd; /* -1: none */
    struct {
        uint32_t id;
        int32_t value;
    } saved[LIBCAMERA_NODE_CONTROLS]; /* in the order in which they are put back */
    int saved_count;
    double exposure_s; /* as it was; 0: not known */
    double frame_s;    /* of the stream that is set up; 0: not known */
} libcamera_node;

/* Finds the node by the camera's id, and notes its controls of exposure and gain. Without a node fd is -1. */
void libcamera_node_open(libcamera_node *node, const pupil_v4l2_system *system, const char *id);
/* By system calls alone. The number of controls that could not be put back. */
int libcamera_node_put_back(const libcamera_node *node);
void libcamera_node_close(libcamera_node *node);

/* ---- controls.c: exposure and gain ---- */

typedef struct libcamera_controls {
    pupil_camera base;
    pthread_mutex_t lock; /* of all that follows */
    pupil_libcamera_can can;
    uint32_t is_webcam, delay_given;
    double frame_s;      /* the stream's own frame period */
    uint32_t takes_over; /* the next request turns automatic exposure off */
    uint32_t waits;      /* `pending` has something that was not queued */
    pupil_camera_setting pending;
    uint64_t pending_after;      /* time.measured when it was asked for ... */
    uint32_t pending_is;         /* ... if there was one */
    pupil_camera_setting before; /* what was taken before `pending`, or what was queued last */
    pupil_camera_status status;
    camera_timeline time;
    camera_history exposures, gains; /* of cameras whose frames do not report it */
    uint32_t told;                   /* frames report it */
    uint64_t told_sequence;          /* the last one, and what it reported */
    double told_exposure_s, told_gain;
    libcamera_node node;
} libcamera_controls;

/* NULL and a sentence: exposure cannot be set, or no memory. */
libcamera_controls *libcamera_controls_open(const pupil_libcamera_can *can, const char *id,
                                            const pupil_libcamera_options *options, uint32_t buffers, double frame_s,
                                            pupil_why *why);
/* What the next request asks for. */
pupil_libcamera_ask libcamera_controls_next(libcamera_controls *c);
/* A request with this ask was cancelled, or refused at once. */
void libcamera_controls_refused(libcamera_controls *c, const pupil_libcamera_ask *ask);
/* A frame's metadata, before in_force is asked. 0: it has none. */
void libcamera_controls_told(libcamera_controls *c, uint64_t sequence, double exposure_s, double gain);
/* The stream was started again: everything is asked for once more, manual exposure first. */
void libcamera_controls_restart(libcamera_controls *c);

/* ---- source.c, requests.c ---- */

typedef struct libcamera_request {
    int queued;
    uint64_t at; /* when: how many had come back */
    pupil_libcamera_ask ask;
} libcamera_request;

typedef struct libcamera_source {
    pupil_live live;
    pupil_libcamera_options options;
    const pupil_libcamera_layer *layer;
    char which[256], id[256];
    void *camera; /* NULL: it is gone */
    pupil_libcamera_can can;
    pupil_libcamera_stream stream;
    pupil_v4l2_format format;
    pupil_coding coding;
    libcamera_controls *controls; /* live.camera's; NULL: there are none */
    libcamera_request request[PUPIL_LIBCAMERA_MOST_BUFFERS];
    uint64_t came_back;
    uint32_t cancelled; /* in a row */
    uint32_t index;     /* of the frame that is out */
    int is_out, began, reopened, wants_rate;
    uint64_t sequence;
    uint32_t driver_sequence;
    uint32_t left_out; /* before the frame that is out, for being late */
    pupil_live_pace pace;
    int64_t first_ns, stamp_ns;
    double period_ns;          /* between the last two frames; 0: no frame came so far */
    pupil_frame_dmabuf dmabuf; /* of the frame that is out */
    char label[320];
} libcamera_source;

enum { LIBCAMERA_GONE = -3, LIBCAMERA_STALLED = -4 };

int64_t libcamera_now_ns(const libcamera_source *s);
void libcamera_pause_ms(int ms);
/* Which frame is being exposed now. */
void libcamera_mark(libcamera_source *s);
/* `asks`: with what is asked for now. */
void libcamera_queue(libcamera_source *s, uint32_t index, int asks);
/* Starts the stream, and queues all requests: no frame is out. 0, or -1 and a sentence. */
int libcamera_start(libcamera_source *s, pupil_why *why);
/* PUPIL_SOURCE_FRAME, PUPIL_SOURCE_END, LIBCAMERA_GONE or LIBCAMERA_STALLED. */
int libcamera_next_done(libcamera_source *s, pupil_libcamera_done *done, pupil_why *why);

#endif
