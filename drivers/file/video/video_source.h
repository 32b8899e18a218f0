/* drivers/file/video/video_source.h: the parts of pupil_video_source_open (file_source.h), for tests and the fuzzer.
 *
 * Time: a frame's timestamp is its presentation time less that of the first frame; one that is missing, or not after
 * the frame before, counts as one nominal frame later. The nominal rate is the stream's, else options.fps, else 30.
 *
 * Damage: a packet that is cut short or refused by its decoder, and a frame that the decoder marks as damaged or logs
 * an error for (video_damage.h), give PUPIL_SOURCE_DAMAGED; the frames after them follow. A file that ends in the
 * middle of a packet (where the container shows that) gives every whole frame, then PUPIL_SOURCE_DAMAGED once, and then
 * ends. A read error fails. The size must not change after the first frame: another size fails. Frames come upright, by
 * the display matrix of the frame or of the stream, unless options.as_stored.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_SOURCE_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_SOURCE_H

#include "pupil/error.h"
#include "source.h"

/* As pupil_video_source_open, over bytes that the caller keeps until close; frames of at most max_pixels pixels, one
 * decoder thread. */
int pupil_video_source_open_bytes(const uint8_t *bytes, size_t size, const char *name, int64_t max_pixels,
                                  const pupil_source_options *options, pupil_source **source, pupil_why *why);

int pupil_video_source_open(const char *path, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why);

#endif
