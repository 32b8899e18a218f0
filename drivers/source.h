/* drivers/source.h: the interface of everything that delivers frames: files, a video, a rendered scene, a camera. Each
 * is opened by its own function. From then on it is a pupil_source, so its user does not depend on the kind.
 *
 *     open -> next -> (use the frame) -> done -> next -> ... -> close
 *
 * Rules for every source:
 * - Memory is allocated at open, or at the first frame of a new size; none per frame in a steady stream.
 * - A frame handed out by next stays valid until done (or close). One frame is out at a time.
 * - Light has Rec.709 primaries and D65 white, or (live cameras, recordings, video of PQ and HLG) those of
 *   source.primaries; the source converts. PQ: 1.0 is 100 cd/m2. HLG: scene light.
 * - Timestamps are in ns. A source without a clock starts at 0 and adds the frame period.
 * - Every failure is a code and one sentence in the caller's buffer. The sentence names the file (or device) and, where
 *   there is one, the field or line, and says what would be right. No trailing newline, no prefix.
 *
 * Threads: one thread at a time on a source; different sources are independent.
 */
#ifndef PUPIL_DRIVERS_SOURCE_H
#define PUPIL_DRIVERS_SOURCE_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/config.h"
#include "pupil/error.h"
#include "pupil/image.h"
#include "sink.h"

enum {
    PUPIL_SOURCE_END = 0,   /* next: no more frames */
    PUPIL_SOURCE_FRAME = 1, /* next: a frame was handed out */
    PUPIL_SOURCE_DAMAGED =
        -1, /* next: this frame is lost (missing, damaged); calling next again continues with the following one */
    PUPIL_SOURCE_FAILED = -2 /* open, next: nothing more will come */
};

/* Where the planes of an image are in memory that the kernel shares (dma-bufs), for users that can read it there. */
typedef struct pupil_frame_dmabuf {
    int fd[3]; /* of each plane, as image has them; they stay the source's */
    uint32_t offset_bytes[3];
    uint64_t stream; /* another number: earlier file descriptors are closed, and their numbers may be used again */
} pupil_frame_dmabuf;

typedef struct pupil_frame {
    pupil_image_const image;
    pupil_frame_info info;
    const char
        *name; /* for messages and file names: the file the frame came from, or the source's own name; never NULL */
    const char *notice; /* what of it could not be read, though it is a frame: a sentence; NULL: nothing */
    const void *coded;  /* the frame as it came, where that was compressed (MJPG); NULL: the image is as it came */
    size_t coded_bytes; /* of coded */
    const pupil_frame_dmabuf *dmabuf; /* the same image; NULL: it is in this process alone */
    float code_light; /* floats that are decoded codes: the light of the first code above black, for pupil_stats; 0:
                       * they are light, or the image has the codes themselves */
    double window[4]; /* x, y, width and height, in fractions, of the picture in it; what is around that is filled in
                       * and not to be metered (a data window of OpenEXR). A width of 0: all of it */
} pupil_frame;

/* Options that a source obeys. */
enum { PUPIL_SOURCE_FPS = 1, PUPIL_SOURCE_SIZE = 2, PUPIL_SOURCE_SEED = 4 };

/* What a user can ask of any source; each takes what it understands. Zero means: not asked. */
typedef struct pupil_source_options {
    double fps;             /* frames a second of sources that have no clock of their own (stills, pan, synth); 0: 30 */
    uint32_t width, height; /* of sources that can make any size (pan, synth); 0: their default */
    uint64_t frames;     /* how many frames, of sources that have no end of their own (pan, synth); 0: their default */
    uint64_t first;      /* the frame to begin with, of scenes from a recipe (synth) */
    uint64_t seed;       /* of sources that draw random numbers (pan); 0: the default seed */
    unsigned threads;    /* of sources that compute their frames (synth); 0: one for each processor */
    int as_stored;       /* of video and JPEG: not turned upright */
    int as_linear;       /* of pictures within a file (gain maps): codes are light as they are, without a curve */
    uint64_t max_pixels; /* larger frames are refused, except a camera's; 0: for stills as in still.h */
    int (*stop)(void);   /* asked during long work; nonzero ends that; NULL: never */
} pupil_source_options;

typedef struct pupil_source pupil_source;

typedef struct pupil_source_ops {
    int (*next)(pupil_source *source, pupil_frame *frame, pupil_why *why);
    void (*done)(pupil_source *source, pupil_frame *frame);
    void (*close)(pupil_source *source); /* frees everything, the source itself too */
} pupil_source_ops;

/* The first member of every source. */
struct pupil_source {
    const pupil_source_ops *ops;
    double fps;         /* nominal frames a second, above 0 */
    uint64_t frames;    /* how many frames it expects to hand out; 0: unknown */
    uint32_t primaries; /* of its frames, for pupil_config: PUPIL_PRIMARIES_BT709 or BT2020 */
    uint32_t obeys;     /* which of its options act: PUPIL_SOURCE_FPS ... */
    int is_named;       /* each frame has a file of its own, and that file's name */
    /* Skips frames that are not needed, as if they had been taken; returns how many. NULL: take them. */
    uint64_t (*skip)(pupil_source *source, uint64_t frames);
    uint32_t pixel_aspect[2]; /* width to height of a pixel, as it is to be shown; 0, 0: square */
    pupil_sink_sound sound;   /* that goes with the frames, known with the first one; the path lives as long */
};

static inline int pupil_source_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    return source->ops->next(source, frame, why);
}

static inline void pupil_source_done(pupil_source *source, pupil_frame *frame)
{
    source->ops->done(source, frame);
}

static inline void pupil_source_close(pupil_source *source)
{
    if (source)
        source->ops->close(source);
}

#endif
