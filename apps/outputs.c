#include "outputs.h"

#include "file/file_sink.h"
#include "v4l2/v4l2_sink.h"

int outputs_open(outputs *o, const char *path, const pupil_sink_options *options, char *why, size_t why_bytes)
{
    pupil_sink **sink = &o->sink[o->count];
    const int error = pupil_is_v4l2_output(path) ? pupil_v4l2_sink_open(sink, path, options, NULL, why, why_bytes)
                                                 : pupil_file_sink_open(path, options, sink, why, why_bytes);
    if (!error)
        o->count++;
    return error;
}

int outputs_write(outputs *o, const pupil_image_const *rgb8, const pupil_frame_info *info, char *why, size_t why_bytes)
{
    int error = PUPIL_SINK_OK;
    for (size_t i = 0; !error && i < o->count; i++)
        error = pupil_sink_write(o->sink[i], rgb8, info, why, why_bytes);
    return error;
}

int outputs_finish(outputs *o, char *why, size_t why_bytes)
{
    while (o->count) {
        if (pupil_sink_finish(o->sink[0], why, why_bytes))
            return PUPIL_SINK_FAILED;
        for (size_t i = 1; i < o->count; i++)
            o->sink[i - 1] = o->sink[i];
        o->count--;
    }
    return PUPIL_SINK_OK;
}

void outputs_discard(outputs *o)
{
    while (o->count)
        pupil_sink_discard(o->sink[--o->count]);
}
