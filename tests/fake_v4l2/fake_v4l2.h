/* tests/fake_v4l2/fake_v4l2.h: a camera in this process, in the place of the kernel's: for tests.
 *
 * Its buffers are memfds and its file descriptors real ones, so that what leaks is seen; its clock is its own and moves
 * only where somebody waits (and a microsecond a call), so that hours pass in no time, and the same seed gives the same
 * frames, losses and damages. The scene is light on integers: fake_v4l2_draw draws any frame again.
 *
 * Its nodes: /dev/video0 the camera; video1 its metadata; video2 an output, which takes frames; video3 (config.twin) a
 * second camera, which reports what it offers and does not stream; media0 and v4l-subdev0, 1 (config.media).
 *
 * Threads: any number, one call at a time takes effect.
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

/* All zero but what fake_v4l2_config_default fills in: a webcam without faults. Frames are counted from STREAMON on. */
typedef struct fake_v4l2_config {
    uint64_t seed;
    double fps; /* of the fastest rate; 30 */
    int absent; /* there is no camera */
    int twin;
    int multiplanar;
    int extra_bytes;                                         /* at the end of each row */
    int data_offset;                                         /* multiplanar: bytes before the pixels */
    uint32_t colorspace, ycbcr_enc, quantization, xfer_func; /* V4L2's; 0: DEFAULT */
    uint32_t only_format;                                    /* it has this format alone; 0: all */
    uint32_t width, height;                                  /* it has this size alone; 0: its usual three */
    uint32_t flat;     /* the scene is this value everywhere; 0: ramps and noise */
    double colour[3];  /* of the light, as factors of red, green and blue; all 0: white */
    int64_t stamps_ns; /* that the driver's stamps are ahead of its clock */
    int no_mmap, no_share, no_rate, no_events, no_sizes;
    uint32_t most_buffers; /* 0: 32 */
    int slow;              /* its own buffers are read twenty times as slowly as other memory ... */
    int hints;             /* ... 1: but those allocated as NON_COHERENT are not; 2: it takes the flag, and they are */
    int heaps;             /* 1: there is /dev/dma_heap/system; 2: linux,cma, too */
    int contiguous;        /* it takes dma-bufs of linux,cma alone */
    int no_import;         /* it takes none */
    uint32_t stamp, media;
    uint32_t first_sequence;
    int no_sequence;                                           /* always 0 */
    double dropped, flagged, cut;                              /* shares of the frames, 0..1 */
    uint64_t unplug_at, stall_at, break_at, change_at, end_at; /* the frame at which it happens; 0: never */
    double back_s;                                             /* after an unplugging; 0: never */
    int back_as;                                               /* the number of its node then */
    int start_error;                                           /* errno of VIDIOC_STREAMON */
    int format_error;                                          /* errno of VIDIOC_S_FMT */
    uint32_t control_delay;                                    /* frames until a control is in force, 0..7; 2 */
    uint32_t gain_earlier;                                     /* so many frames before exposure does gain act */
    int deaf_exposure, deaf_gain; /* 1: the control is read back as it was written, and does nothing */
    int coarse_gain;              /* 1: gain acts in whole octaves, and is read back as it was written */
    double black;                 /* of full scale, in samples without light */
    double lamp_hz, modulation;   /* the scene's light is 1 + modulation cos 2 pi lamp_hz t; 0: it is steady */
    double readout_s;             /* from the first row's end of exposure to the last one's, the frame's stamp */
    int64_t pixel_rate, hblank;   /* what the driver says of it: PIXEL_RATE, HBLANK; 0: nothing */
    uint32_t drawn_xfer; /* the transfer function that the picture has, regardless of what is reported; 0: that */
    uint64_t sleep_at;   /* the write of controls, from 1, counted from this configuration on, that takes sleep_s of
                          * the machine's time; 0: none */
    double sleep_s;
    uint32_t out_format, out_width, out_height;               /* the output takes these alone; 0: all */
    uint32_t out_colorspace, out_ycbcr_enc, out_quantization; /* what it answers; 0: what was set, and DEFAULT */
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

/* Another configuration from now on, in mid-stream too; format and size with the next plugging in. */
void fake_v4l2_reconfigure(fake_v4l2 *fake, const fake_v4l2_config *config);

/* The light of the whole scene, as a factor; 1. */
void fake_v4l2_light(fake_v4l2 *fake, double light);

/* What was opened and mapped and is so still. */
typedef struct fake_v4l2_held {
    int files, maps;
    int unsynced; /* dma-bufs that were queued or closed between two syncs, or synced out of turn, ever */
} fake_v4l2_held;
fake_v4l2_held fake_v4l2_holds(fake_v4l2 *fake);

/* What the output shows, and how many frames it was given. Its memory is good until the next call to the system. */
typedef struct fake_v4l2_screen {
    const unsigned char *data; /* NULL: nothing so far */
    uint32_t bytes, fourcc, width, height, stride_bytes, colorspace;
    double fps; /* as it was set; 0: it was not */
} fake_v4l2_screen;
uint64_t fake_v4l2_shown(fake_v4l2 *fake, fake_v4l2_screen *screen);

/* --- the picture --- */
/* Red, green and blue of the scene are whole numbers from 0 to 1023, the same for the 2 x 2 pixels of a quad; scaled by
 * exposure and gain, 4095 is white. */
#define FAKE_SCENE_WHITE 4095

typedef struct fake_v4l2_picture {
    uint64_t seed;
    uint32_t sequence;
    uint32_t fourcc, width, height;
    uint32_t stride_bytes[3];                    /* of the rows, of Cb (and Cr), and of Cr alone */
    uint32_t ycbcr_enc, quantization, xfer_func; /* without DEFAULT */
    double scale;                                /* light * exposure / 10 ms * gain */
    double black;                                /* the configuration's; the next ones, too */
    uint32_t flat;
    double colour[3];
    double lamp_hz, modulation, readout_s; /* the configuration's; the wave is not in JPEGs */
    double end_s, exposure_s;              /* when the last row's exposure ended, by what the wave begins with */
} fake_v4l2_picture;

/* The lamps' light on a row, 1 on average. */
double fake_v4l2_lamp(const fake_v4l2_picture *picture, uint32_t y);

uint32_t fake_v4l2_scene(uint64_t seed, uint32_t sequence, uint32_t x, uint32_t y, uint32_t channel);
/* chroma: the plane of Cb, or of both, and cr: of Cr, wherever they are. */
void fake_v4l2_draw(const fake_v4l2_picture *picture, void *data, void *chroma, void *cr);

/* --- faults --- */
/* A system whose n-th call fails, on top of another one. Closing and unmapping are done all the same. */
typedef struct fake_faults {
    const pupil_v4l2_system *inner;
    unsigned long calls;    /* so far */
    unsigned long fail_at;  /* from 1; 0: never */
    unsigned long fail_for; /* so many calls in a row */
    int error;
    const char *failed; /* the call that failed first; NULL: none so far */
    pupil_v4l2_system system;
} fake_faults;

void fake_faults_begin(fake_faults *faults, const pupil_v4l2_system *inner, unsigned long fail_at,
                       unsigned long fail_for, int error);

#endif
