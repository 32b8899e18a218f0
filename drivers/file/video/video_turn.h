/* drivers/file/video/video_turn.h: frames that are stored turned or mirrored, as phones store portrait video, made
 * upright as their display matrix says.
 *
 * Threads: one thread at a time on an object.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_TURN_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_TURN_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/image.h"

/* Where the pixel (x, y) goes: to (xx * x + xy * y, yx * x + yy * y), plus an offset that moves the corner to (0, 0).
 * Each is -1, 0 or 1, and each row and column has one that is not 0. All of them 0: the frame stays as it is. */
typedef struct pupil_video_turn {
    int xx, xy, yx, yy;
    uint8_t *room; /* the turned frame */
    size_t room_bytes;
} pupil_video_turn;

/* By libav's display matrix (libavutil/display.h), whose scale and offset are ignored. Quarter turns, mirrored or not;
 * others are refused, with a sentence without a file name. */
int pupil_video_turn_set(pupil_video_turn *turn, const int32_t matrix[9], pupil_why *why);

/* Changes a frame's sides to those of the turned frame. */
void pupil_video_turn_sides(const pupil_video_turn *turn, uint32_t *width, uint32_t *height);

/* An image of video_pixels.h (its planes without padding), or RGB8, turned; its pixels are then in the object, until
 * the next call. 0, or -1 and a sentence. */
int pupil_video_turn_image(pupil_video_turn *turn, pupil_image_const *image, pupil_why *why);

void pupil_video_turn_free(pupil_video_turn *turn);

#endif
