#include "pictures.h"

#include <stdio.h>
#include <string.h>

#include "common/reader.h"
#include "file/file_sink.h"

uint32_t pictures_primaries(const pupil_config *config)
{
    if (config->output_primaries == PUPIL_OUTPUT_AS_INPUT)
        return config->primaries;
    return config->output_primaries == PUPIL_OUTPUT_BT2020 ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709;
}

int pictures_open(pictures *o, const char *path, const pupil_sink_options *options, pupil_why *why)
{
    pupil_why without = {""};
    pupil_sink_options of_sink = *options;
    pupil_sink **sink = &o->sink[o->count];
    of_sink.without = &without;
    const int error = pupil_live_is_output(path) ? pupil_live_output_open(sink, path, &of_sink, o->system, why)
                                                 : pupil_file_sink_open(path, &of_sink, sink, why);
    if (error)
        return error;
    o->path[o->count++] = path;
    const size_t used = strlen(o->silent);
    if (*without.text)
        snprintf(o->silent + used, sizeof o->silent - used, "; %s is without its sound: %s", path, without.text);
    return PUPIL_SINK_OK;
}

int pictures_write(pictures *o, const pupil_image_const *rgb8, const pupil_frame_info *info, const char *name,
                   pupil_why *why)
{
    int error = PUPIL_SINK_OK;
    for (size_t i = 0; !error && i < o->count; i++) {
        o->sink[i]->frame_name = name;
        error = pupil_sink_write(o->sink[i], rgb8, info, why);
        o->failed = i;
    }
    return error;
}

static void remove_at(pictures *o, size_t at)
{
    o->count--;
    for (size_t i = at; i < o->count; i++) {
        o->sink[i] = o->sink[i + 1];
        o->path[i] = o->path[i + 1];
    }
}

void pictures_drop(pictures *o)
{
    pupil_sink_discard(o->sink[o->failed]);
    remove_at(o, o->failed);
}

int pictures_reader_gone(const pictures *o)
{
    return strcmp(o->path[o->failed], "-") == 0 && reader_gone();
}

int pictures_finish(pictures *o, pupil_why *why)
{
    while (o->count) {
        o->failed = 0;
        if (pupil_sink_finish(o->sink[0], why))
            return PUPIL_SINK_FAILED;
        remove_at(o, 0);
    }
    return PUPIL_SINK_OK;
}

void pictures_discard(pictures *o)
{
    while (o->count)
        pupil_sink_discard(o->sink[--o->count]);
}
