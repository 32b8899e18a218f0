/* drivers/sink.h: the seam for display frames: a video file, a folder of pictures, a stream. The mirror of source.h.
 *
 *     open -> write ... write -> finish   or, when anything went wrong,   discard
 *
 * Rules for every sink:
 * - The output is written under another name in the same folder, and renamed in finish. After discard nothing is left.
 *   So an output is complete or absent. (Streams, such as standard output, cannot take anything back; a live output
 *   keeps its whole frames.)
 * - Frames are PUPIL_PIXEL_RGB8 in the options' primaries and transfer, all of the size that open was given.
 * - Every failure is PUPIL_SINK_FAILED and one sentence in the caller's buffer: it names the path and says what would
 * be right. After a failed write or finish the caller still calls discard.
 *
 * Threads: one thread at a time on a sink.
 */
#ifndef PUPIL_DRIVERS_SINK_H
#define PUPIL_DRIVERS_SINK_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/config.h"
#include "pupil/error.h"
#include "pupil/image.h"

enum { PUPIL_SINK_OK = 0, PUPIL_SINK_FAILED = -1 };

/* The sound that goes with the frames, from a file. */
typedef struct pupil_sink_sound {
    const char *path; /* NULL: none; "-": of standard input, which cannot be read again */
    int64_t begin_ns; /* the file's time of the first frame */
} pupil_sink_sound;

/* How long a frame of a video may be shown: a video may have slides. */
#define PUPIL_SINK_VIDEO_GAP_S 60.0

typedef struct pupil_sink_options {
    uint32_t width, height; /* of every frame */
    double fps;             /* nominal frames a second, above 0 */
    int overwrite;          /* a file, or a folder that is not empty, is replaced; else it is kept, and refused */
    uint32_t primaries;     /* a pupil_primaries, BT.709 or BT.2020: what .mp4, .mkv, .mov and .png are tagged with */
    uint32_t transfer;      /* a pupil_transfer; the same */
    int keep_time; /* of formats without timestamps (YUV4MPEG2), which play at fps: a frame is written as often as
                    * its timestamp requires. So a stream with gaps plays at its own speed. Longer gaps than
                    * gap_most_s are left out. Other formats store the timestamps */
    double gap_most_s;
    uint32_t aspect[2]; /* of a pixel, width to height; 0, 0: square. .mp4, .mkv, .mov and .y4m store it */
    int named; /* of a folder: each picture has the name of its frame (pupil_sink.frame_name), and its own size */
    pupil_sink_sound sound; /* copied into .mp4, .mkv and .mov, as it is */
    pupil_why *without; /* set by open: why a video has no sound; empty: it has, or there is none. NULL: not asked */
    int live; /* .mp4, .mkv and .mov: what was written plays even if the process is killed: at most a second is lost.
               * The file has its final name from the first half second on, also if a write fails later. It is made of
               * fragments, and encoded without lookahead. A .y4m has its final name from its first frame on; if a write
               * fails it is cut to its whole frames, and a folder gets its final name with those it has */
} pupil_sink_options;

typedef struct pupil_sink pupil_sink;

typedef struct pupil_sink_ops {
    int (*write)(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info, pupil_why *why);
    int (*finish)(pupil_sink *sink, pupil_why *why); /* on success the sink is gone */
    void (*discard)(pupil_sink *sink);               /* the sink is gone */
} pupil_sink_ops;

struct pupil_sink {
    const pupil_sink_ops *ops;
    const char *frame_name; /* of the frame that is written next; the file that it came from. NULL: none */
};

static inline int pupil_sink_write(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info,
                                   pupil_why *why)
{
    return sink->ops->write(sink, image, info, why);
}

static inline int pupil_sink_finish(pupil_sink *sink, pupil_why *why)
{
    return sink->ops->finish(sink, why);
}

static inline void pupil_sink_discard(pupil_sink *sink)
{
    if (sink)
        sink->ops->discard(sink);
}

#endif
