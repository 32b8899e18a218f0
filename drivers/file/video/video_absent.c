/* Replaces video_source.c, video_sink.c and jpeg_frame.c in a build without libav. */
#include "jpeg_frame.h"
#include "video_sink.h"
#include "video_source.h"

#include "refuse.h"
#include <stdio.h>

int pupil_video_source_open(const char *path, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why)
{
    (void)options;
    *source = NULL;
    pupil_refuse(
        why,
        "%s: this build of pupil reads no video (it was configured with PUPIL_MEDIA=OFF); name still files or a "
        "folder of them",
        path);
    return PUPIL_SOURCE_FAILED;
}

int pupil_video_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    (void)options;
    *sink = NULL;
    return pupil_refuse(
        why,
        "%s: this build of pupil writes no video but Y4M (it was configured with PUPIL_MEDIA=OFF); name a .y4m "
        "file or a folder of PNG files",
        path);
}

int pupil_jpeg_open(pupil_jpeg **jpeg, uint32_t width, uint32_t height, const pupil_coding *coding, pupil_why *why)
{
    (void)width, (void)height, (void)coding;
    *jpeg = NULL;
    return pupil_refuse(
        why, "this build of pupil reads no JPEG (it was configured with PUPIL_MEDIA=OFF); ask for a raw format");
}

/* Never called: no object of this type exists. */
int pupil_jpeg_decode(pupil_jpeg *jpeg, const void *bytes, size_t size, pupil_image_const *image, pupil_why *why)
{
    (void)jpeg, (void)bytes, (void)size, (void)image;
    return pupil_refuse(why, "this build of pupil reads no JPEG");
}

void pupil_jpeg_close(pupil_jpeg *jpeg)
{
    (void)jpeg;
}
