/* drivers/file/video/video_sink.h: display frames into a video: through libav, or as YUV4MPEG2. file_sink.h chooses. */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_SINK_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_SINK_H

#include "sink.h"

int pupil_video_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);
int pupil_y4m_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);

#endif
