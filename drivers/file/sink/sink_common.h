/* drivers/file/sink/sink_common.h: what the file sinks require of their options and frames, and how they refuse. */
#ifndef PUPIL_DRIVERS_FILE_SINK_SINK_COMMON_H
#define PUPIL_DRIVERS_FILE_SINK_SINK_COMMON_H

#include "pupil/error.h"
#include "refuse.h" /* its -1 is PUPIL_SINK_FAILED */
#include "sink.h"

/* 0, or a sentence that begins with `path` and names the field. */
int pupil_sink_check_options(const char *path, const pupil_sink_options *options, pupil_why *why);
int pupil_sink_check_image(const char *path, const pupil_sink_options *options, const pupil_image_const *image,
                           pupil_why *why);

/* Adds to the sentence how many frames a live output has that failed. */
void pupil_sink_add_kept(uint64_t frames, pupil_why *why);

/* fps as num / den: NTSC rates exactly (29.97 is 30000/1001), others to 1e-9 where a denominator up to 65535 gives
 * that, else the nearest. fps has passed the check above. */
void pupil_fps_ratio(double fps, int *num, int *den);

#endif
