/* drivers/file/video/video_sound.h: the sound of a video, copied into another one as it is.
 *
 * Threads: one thread at a time on an object.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_SOUND_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_SOUND_H

#include <libavformat/avformat.h>

#include "sink.h"

typedef struct pupil_video_sound pupil_video_sound;

/* Opens the file again and adds a stream to the muxer for each of its audio streams, before the header is written.
 * NULL: there is none, or it is left out; then `why` (else empty) says the reason. */
pupil_video_sound *pupil_video_sound_open(AVFormatContext *muxer, const pupil_sink_sound *of, pupil_why *why);

/* Writes the sound before this time of the video. 0, or a libav error code. */
int pupil_video_sound_write(pupil_video_sound *sound, int64_t before_ns);

void pupil_video_sound_close(pupil_video_sound *sound); /* NULL is allowed */

#endif
