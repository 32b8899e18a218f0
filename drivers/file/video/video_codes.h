/* drivers/file/video/video_codes.h: one decoded frame of PQ or HLG as Y'CbCr 4:4:4 of 16 bits (PUPIL_PIXEL_I444_16),
 * which the library decodes to light. A part of video_pixels.h, whose object has the memory.
 *
 * Codes of limited range are only shifted, and chroma is interpolated in integers, in 64ths of a code: exact up to 10
 * bits, of 4:2:0 up to 12. Full range is scaled to 65535. Grey has no chroma. R'G'B' becomes Y'CbCr of full range with
 * the matrix of its primaries: each of its codes is then within 1.3 of 65535.
 *
 * Threads: as video_pixels.h.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_CODES_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_CODES_H

#include "video_pixels.h"

/* Whether the library has the curve. */
int pupil_video_is_coded(int transfer);

/* Allocates memory for a frame of this kind, with BT.709 or BT.2020 primaries, and describes it in pixels->image. A
 * matrix that the library does not have is refused. */
int pupil_video_codes_set(pupil_video_pixels *pixels, const pupil_video_tags *tags, pupil_why *why);

/* The frame into pixels->codes_out. */
void pupil_video_codes_convert(pupil_video_pixels *pixels, const AVFrame *frame);

#endif
