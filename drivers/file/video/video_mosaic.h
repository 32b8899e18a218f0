/* drivers/file/video/video_mosaic.h: frames of libav's bayer_* pixel formats, as images of the library: linear light of
 * full range, balanced as raw files are (colour/white_balance.h): the first frame is made grey on average, and the
 * others follow.
 *
 * Threads: one thread at a time on an object.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_MOSAIC_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_MOSAIC_H

#include <libavutil/frame.h>

#include "colour/white_balance.h"
#include "pupil/error.h"

typedef struct pupil_video_mosaic {
    uint8_t *bytes; /* the image's */
    size_t room_bytes;
    pupil_white_balance colour;
    int has_colour;
} pupil_video_mosaic;

/* Whether an AVPixelFormat is one of them. */
int pupil_video_is_mosaic(int format);

/* The frame as an image, which stays until the next call. -1 and a sentence without a file name. */
int pupil_video_mosaic_take(pupil_video_mosaic *mosaic, const AVFrame *frame, const pupil_frame_info *info,
                            pupil_image_const *image, pupil_why *why);

/* After a frame was shown. */
void pupil_video_mosaic_done(pupil_video_mosaic *mosaic, const pupil_image_const *image, const pupil_frame_info *info);

void pupil_video_mosaic_free(pupil_video_mosaic *mosaic);

#endif
