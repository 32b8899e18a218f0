/* drivers/file/video/video_rows.h: rows of a decoded frame's components, and where its chroma is. For video_pixels.c
 * and video_codes.c, whose object has the memory.
 *
 * Threads: as video_pixels.h.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_ROWS_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_ROWS_H

#include "video_pixels.h"

/* Fills in chroma_left and chroma_eighths; location is an AVChromaLocation. */
void pupil_video_set_chroma(pupil_video_pixels *pixels, int location);

/* The two rows of chroma around the luma row y, and the weight of the lower one in eighths. */
typedef struct pupil_video_chroma_rows {
    int upper, lower;
    uint32_t eighths;
} pupil_video_chroma_rows;

pupil_video_chroma_rows pupil_video_chroma_rows_at(const pupil_video_pixels *pixels, const AVFrame *frame, int y);

/* One row of a component as it is stored, at least until the next call. */
const uint16_t *pupil_video_read_codes(pupil_video_pixels *pixels, const AVFrame *frame, int component, int y,
                                       int width);

#endif
