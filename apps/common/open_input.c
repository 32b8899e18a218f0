#include "open_input.h"

#include <stdio.h>
#include <string.h>

#include "file/file_source.h"
#include "file/recording/recording.h"
#include "live/live.h"
#include "raw/raw_source.h"
#include "refuse.h"
#include "synth/synth_source.h"

#define SYNTH "synth:"
#define RAW   "raw:"

static int starts_with(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

/* The kind of an input that must be the only one; NULL: a file, of which there can be several. */
static const char *kind_of(const char *input)
{
    return pupil_live_is_camera(input) ? "camera"
           : starts_with(input, SYNTH) ? "synthetic scene"
           : starts_with(input, RAW)   ? "file of raw frames"
           : pupil_is_recording(input) ? "recording"
                                       : NULL;
}

int open_input(const char *const *inputs, size_t count, const pupil_source_options *options, pupil_source **source,
               pupil_why *why)
{
    for (size_t i = 0; i < count; i++) {
        const char *kind = kind_of(inputs[i]);
        if (!kind)
            continue;
        if (count > 1) {
            pupil_refuse(why, "%s: a %s must be the only input", inputs[i], kind);
            return PUPIL_SOURCE_FAILED;
        }
        if (*kind == 'c')
            return pupil_live_open(inputs[i], options, &(pupil_live_options){.hands_off = 1}, source, why);
        if (*kind == 's')
            return pupil_synth_source_open(inputs[i] + sizeof SYNTH - 1, options, source, why);
        if (*kind == 'f')
            return pupil_raw_source_open(inputs[i] + sizeof RAW - 1, options, source, why);
        return pupil_recording_open(inputs[i], options, source, why);
    }
    return pupil_file_source_open(inputs, count, options, source, why);
}
