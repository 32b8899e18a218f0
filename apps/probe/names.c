/* Names of numbers. */
#include <stdio.h>

#include "probe.h"

const char *probe_stamp(uint32_t stamp)
{
    static const char *const names[] = {"none", "end of frame", "start of exposure"};
    return stamp < sizeof names / sizeof names[0] ? names[stamp] : "unknown";
}

void probe_law_text(const pupil_camera_gain *law, char *text, size_t text_bytes)
{
    const double *p = law->p;
    *text = 0;
    if (law->law == PUPIL_CAMERA_DB)
        snprintf(text, text_bytes, "%g dB a code", p[0]);
    else if (law->law == PUPIL_CAMERA_OCTAVES)
        snprintf(text, text_bytes, "%g codes an octave", p[0]);
    else if (law->law == PUPIL_CAMERA_TABLE)
        snprintf(text, text_bytes, "a table of %u", law->rows);
    else if (p[1] == 0.0 && p[2] == 0.0)
        snprintf(text, text_bytes, "code / %g", p[3] / p[0]);
    else if (p[0] == 0.0 && p[2] == -1.0)
        snprintf(text, text_bytes, "%g / (%g - code)", p[1], p[3]);
    else
        snprintf(text, text_bytes, "(%g code + %g) / (%g code + %g)", p[0], p[1], p[2], p[3]);
}
