/* Which kind of output a path names. */
#include "file_sink.h"

#include "file/sink/picture_sink.h"
#include "file/sink/sink_common.h"
#include "file/video/video_sink.h"

#include "refuse.h"
#include <string.h>
#include <strings.h>

typedef int open_sink(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);

static const struct {
    const char *extension;
    open_sink *open;
} kinds[] = {
    {".mp4", pupil_video_sink_open}, {".mkv", pupil_video_sink_open}, {".mov", pupil_video_sink_open},
    {".y4m", pupil_y4m_sink_open},   {".png", pupil_png_sink_open},   {".jpg", pupil_jpeg_sink_open},
    {".jpeg", pupil_jpeg_sink_open}, {".tif", pupil_tiff_sink_open},  {".tiff", pupil_tiff_sink_open},
};

/* The function that opens it; NULL and a sentence: there is none. */
static open_sink *opener_of(const char *path, pupil_why *why)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    if (!*path) {
        pupil_refuse(why, "\"\": an output needs a name");
        return NULL;
    }
    if (strcmp(path, "-") == 0)
        return pupil_y4m_sink_open;
    /* A leading dot begins no extension: "." and ".hidden" are folders. */
    if (!dot || dot == name || strcmp(name, "..") == 0)
        return pupil_folder_sink_open;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcasecmp(dot, kinds[i].extension) == 0)
            return kinds[i].open;
    pupil_refuse(
        why,
        "%s: no kind of output ends in \"%s\"; name a .mp4, .mkv or .mov video, a .y4m, a .png, .jpg or .tif, a "
        "folder (no extension, or a slash at the end) or - for YUV4MPEG2 on standard output; others by ffmpeg: "
        "pupil ... -q -o - | ffmpeg -i - %s",
        path, dot, path);
    return NULL;
}

int pupil_file_sink_check(const char *path, pupil_why *why)
{
    return opener_of(path, why) ? 0 : -1;
}

int pupil_file_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why)
{
    open_sink *const open = opener_of(path, why);
    *sink = NULL;
    return open ? open(path, options, sink, why) : -1;
}
