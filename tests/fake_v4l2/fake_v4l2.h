/* tests/fake_v4l2/fake_v4l2.h: a camera in this process instead of the kernel's, for tests.
 *
 * Its buffers are memfds and its file descriptors real ones, so that leaks are seen. It has its own clock, which only
 * moves while something waits (and a microsecond per call), so hours pass in no time, and the same seed gives the same
 * frames, losses and damages. The scene is computed in integers: fake_v4l2_draw draws any frame again.
 *
 * Its nodes: /dev/video0 the camera; video1 its metadata; video2 an output, which takes frames; video3 (config.twin) a
 * second camera, which reports its modes and does not stream; media0 and v4l-subdev0, 1 (config.media).
 *
 * Threads: any number; calls are serialised.
 */
#ifndef PUPIL_TESTS_FAKE_V4L2_FAKE_V4L2_H
#define PUPIL_TESTS_FAKE_V4L2_FAKE_V4L2_H

#include "v4l2/system.h"

#define FAKE_V4L2_NAME "Fake Camera"
#define FAKE_V4L2_TWIN "Fake Camera, the other"

enum { FAKE_STAMP_END_OF_FRAME, FAKE_STAMP_START_OF_EXPOSURE, FAKE_STAMP_NONE };
enum {
    FAKE_MEDIA_NONE,
    FAKE_MEDIA_RIGHT,
    FAKE_MEDIA_LINK_OFF,
    FAKE_MEDIA_PADS_DIFFER,
    FAKE_MEDIA_NODE_DIFFERS,
    FAKE_MEDIA_CODES_DIFFER
};

/* All zero except what fake_v4l2_config_default fills in: a webcam without faults. Frames count from STREAMON on. */
typedef struct fake_v4l2_config {
    uint64_t seed;
    double fps; /* of the fastest rate; 30 */
    int absent; /* there is no camera */
    int twin;
    int multiplanar;
    int extra_bytes;                                         /* at the end of each row */
    int data_offset;                                         /* multiplanar: bytes before the pixels */
    uint32_t colorspace, ycbcr_enc, quantization, xfer_func; /* V4L2's; 0: DEFAULT */
    uint32_t only_format;                                    /* its only format; 0: all */
    uint32_t width, height;                                  /* its only size; 0: its usual three */
    uint32_t flat;                                           /* a constant scene of this value; 0: ramps and noise */
    double colour[3];  /* of the light, factors for red, green and blue; all 0: white */
    int64_t stamps_ns; /* by how much the driver's stamps are ahead of its clock */
    int no_mmap, no_share, no_rate, no_events, no_sizes;
    uint32_t most_buffers; /* 0: 32 */
    int slow;              /* its own buffers are read twenty times as slowly as other memory ... */
    int hints;             /* ... 1: but those allocated as NON_COHERENT are not; 2: it takes the flag, and they are */
    int heaps;             /* 1: there is /dev/dma_heap/system; 2: linux,cma, too */
    int contiguous;        /* it only takes dma-bufs of linux,cma */
    int no_import;         /* it takes no dma-bufs */
    uint32_t stamp, media;
    uint32_t first_sequence;
    int no_sequence;                                           /* always 0 */
    double dropped, flagged, cut;                              /* shares of the frames, 0..1 */
    uint64_t unplug_at, stall_at, break_at, change_at, end_at; /* the frame at which it happens; 0: never */
    double back_s;                                             /* after an unplugging; 0: never */
    int back_as;                                               /* then the number of its node */
    int start_error;                                           /* errno of VIDIOC_STREAMON */
    int format_error;                                          /* errno of VIDIOC_S_FMT */
    uint32_t control_delay;                                    /* frames until a control is in force, 0..7; 2 */
    uint32_t gain_earlier;                                     /* by how many frames gain acts before exposure */
    int deaf_exposure, deaf_gain; /* 1: the control reads back as written, and does nothing */
    int coarse_gain;              /* 1: gain acts in whole octaves, and reads back as written */
    double black;                 /* of full scale, in samples without light */
    double lamp_hz, modulation;   /* the scene's light is 1 + modulation cos 2 pi lamp_hz t; 0: constant */
    double readout_s;             /* from the first row's end of exposure to the last one's, the frame's stamp */
    int64_t pixel_rate, hblank;   /* what the driver reports of it: PIXEL_RATE, HBLANK; 0: nothing */
    uint32_t drawn_xfer; /* the picture's transfer function, regardless of the reported one; 0: the reported one */
    uint64_t sleep_at;   /* this write of controls, counted from 1 since this configuration, takes sleep_s of the
                          * machine's time; 0: none */
    double sleep_s;
    uint32_t out_format, out_width, out_height;               /* the output only takes these; 0: all */
    uint32_t out_colorspace, out_ycbcr_enc, out_quantization; /* what it reports; 0: what was set, and DEFAULT */
    int out_write_only;                                       /* it has no buffers to stream with */
    uint64_t out_gone_at, out_stall_at;                       /* the output's frame, from 1, at which it happens */
    int real_time;                                            /* the clock is the machine's */
} fake_v4l2_config;

typedef struct fake_v4l2 fake_v4l2;

void fake_v4l2_config_default(fake_v4l2_config *config);
fake_v4l2 *fake_v4l2_new(const fake_v4l2_config *config); /* NULL: no memory */
void fake_v4l2_free(fake_v4l2 *fake);

/* To be handed to any function that takes a system; good until free. */
const pupil_v4l2_system *fake_v4l2_system(fake_v4l2 *fake);

/* Changes the configuration, also in mid-stream; format and size change when it is next plugged in. */
void fake_v4l2_reconfigure(fake_v4l2 *fake, const fake_v4l2_config *config);

/* The light of the whole scene, as a factor; 1. */
void fake_v4l2_light(fake_v4l2 *fake, double light);

/* What is still open and mapped. */
typedef struct fake_v4l2_held {
    int files, maps;
    int unsynced; /* dma-bufs ever queued or closed between two syncs, or synced in the wrong order */
} fake_v4l2_held;
fake_v4l2_held fake_v4l2_holds(fake_v4l2 *fake);

/* What the output shows, and how many frames it was given. Its memory is valid until the next call to the system. */
typedef struct fake_v4l2_screen {
    const unsigned char *data; /* NULL: nothing yet */
    uint32_t bytes, fourcc, width, height, stride_bytes, colorspace;
    double fps; /* as it was set; 0: not set */
} fake_v4l2_screen;
uint64_t fake_v4l2_shown(fake_v4l2 *fake, fake_v4l2_screen *screen);

/* --- the picture --- */
/* Red, green and blue of the scene are integers from 0 to 1023, the same for the 2 x 2 pixels of a quad; after scaling
 * by exposure and gain 4095 is white. */
#define FAKE_SCENE_WHITE 4095

typedef struct fake_v4l2_picture {
    uint64_t seed;
    uint32_t sequence;
    uint32_t fourcc, width, height;
    uint32_t stride_bytes[3];                    /* strides of rows, of Cb (and Cr), and of Cr alone */
    uint32_t ycbcr_enc, quantization, xfer_func; /* without DEFAULT */
    double scale;                                /* light * exposure / 10 ms * gain */
    double black;                                /* the configuration's; the next ones, too */
    uint32_t flat;
    double colour[3];
    double lamp_hz, modulation, readout_s; /* the configuration's; JPEGs do not have the wave */
    double end_s, exposure_s;              /* when the last row's exposure ended, on the wave's clock */
} fake_v4l2_picture;

/* The lamps' light on a row, 1 on average. */
double fake_v4l2_lamp(const fake_v4l2_picture *picture, uint32_t y);

uint32_t fake_v4l2_scene(uint64_t seed, uint32_t sequence, uint32_t x, uint32_t y, uint32_t channel);
/* chroma: the plane of Cb, or of both, and cr: of Cr, wherever they are. */
void fake_v4l2_draw(const fake_v4l2_picture *picture, void *data, void *chroma, void *cr);

/* --- faults --- */
/* A system on top of another one, whose n-th call fails. Closing and unmapping still happen. */
typedef struct fake_faults {
    const pupil_v4l2_system *inner;
    unsigned long calls;    /* so far */
    unsigned long fail_at;  /* from 1; 0: never */
    unsigned long fail_for; /* so many calls in a row */
    int error;
    const char *failed; /* the first call that failed; NULL: none yet */
    pupil_v4l2_system system;
} fake_faults;

void fake_faults_begin(fake_faults *faults, const pupil_v4l2_system *inner, unsigned long fail_at,
                       unsigned long fail_for, int error);

#endif
