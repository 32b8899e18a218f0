#include "open_input.h"

#include <stdio.h>
#include <string.h>

#include "file/file_source.h"
#include "synth/synth_source.h"

int open_input(const char *const *inputs, size_t count, const pupil_source_options *options, pupil_source **source,
               char *why, size_t why_bytes)
{
    static const char synth[] = "synth:";
    for (size_t i = 0; i < count; i++) {
        if (strncmp(inputs[i], synth, sizeof synth - 1) != 0)
            continue;
        if (count > 1) {
            snprintf(why, why_bytes, "%s: a synthetic scene must be the only input", inputs[i]);
            return PUPIL_SOURCE_FAILED;
        }
        return pupil_synth_source_open(inputs[i] + sizeof synth - 1, options, source, why, why_bytes);
    }
    return pupil_file_source_open(inputs, count, options, source, why, why_bytes);
}
