/* A camera's formats and sizes, of any kind of camera. */
#include "live_source.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

pupil_live_mode *pupil_live_modes_add(pupil_live_modes *modes)
{
    pupil_live_mode *more = realloc(modes->mode, (modes->count + 1) * sizeof *more);
    if (!more)
        return NULL;
    modes->mode = more;
    more[modes->count] = (pupil_live_mode){0};
    return &more[modes->count++];
}

pupil_live_size *pupil_live_mode_add_size(pupil_live_mode *mode)
{
    pupil_live_size *more = realloc(mode->size, (mode->sizes + 1) * sizeof *more);
    if (!more)
        return NULL;
    mode->size = more;
    more[mode->sizes] = (pupil_live_size){0};
    return &more[mode->sizes++];
}

void pupil_live_modes_free(pupil_live_modes *modes)
{
    for (uint32_t i = 0; i < modes->count; i++)
        free(modes->mode[i].size);
    free(modes->mode);
    *modes = (pupil_live_modes){0};
}

static void __attribute__((format(printf, 3, 4))) append(char *text, size_t text_bytes, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, text_bytes - used, format, arguments);
    va_end(arguments);
}

void pupil_live_mode_text(const pupil_live_mode *mode, char *text, size_t text_bytes)
{
    *text = 0;
    for (uint32_t i = 0; i < mode->sizes; i++) {
        const pupil_live_size *s = &mode->size[i];
        append(text, text_bytes, "%s%ux%u", i ? " " : "", s->width, s->height);
        if (s->step_width || s->step_height)
            append(text, text_bytes, "..%ux%u", s->max_width, s->max_height);
        for (uint32_t k = s->rates; k-- > 0;) /* the fastest first */
            append(text, text_bytes, "%s%.6g",
                   k + 1 == s->rates ? "@"
                   : s->fps_between  ? ".."
                                     : ",",
                   s->fps[s->fps_between ? s->rates - 1 - k : k]);
    }
}
