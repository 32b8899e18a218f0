/* In place of video_source.c and video_sink.c in a build without libav. */
#include "file/file_sink.h"
#include "file/file_source.h"

#include <stdio.h>

int pupil_video_source_open(const char *path, const pupil_source_options *options, pupil_source **source, char *why,
                            size_t why_bytes)
{
    (void)options;
    *source = NULL;
    snprintf(why, why_bytes,
             "%s: this build of pupil reads no video (it was configured with PUPIL_VIDEO=OFF); name still files or a "
             "folder of them",
             path);
    return PUPIL_SOURCE_FAILED;
}

int pupil_video_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, char *why,
                          size_t why_bytes)
{
    (void)options;
    *sink = NULL;
    snprintf(why, why_bytes,
             "%s: this build of pupil writes no video but Y4M (it was configured with PUPIL_VIDEO=OFF); name a .y4m "
             "file or a folder of PNG files",
             path);
    return PUPIL_SINK_FAILED;
}
