/* Errors of GL, and sentences for the caller. */
#include "gles_private.h"

void pupil_gles_say(pupil_why *why, const char *const parts[])
{
    size_t n = 0;
    if (!why)
        return;
    for (; *parts; parts++)
        for (const char *c = *parts; *c && n + 1 < sizeof why->text; c++)
            why->text[n++] = *c;
    while (n && why->text[n - 1] == '\n') /* as drivers end their logs */
        n--;
    why->text[n] = '\0';
}

static int is_lost(const gles_object *o)
{
    return o->gl.GetGraphicsResetStatus && o->gl.GetGraphicsResetStatus() != GL_NO_ERROR;
}

int pupil_gles_check(const pupil_gles *gles)
{
    if (!gles)
        return PUPIL_ERR_NULL;
    const gles_object *o = (const gles_object *)(const void *)gles;
    if (o->magic != GLES_MAGIC)
        return PUPIL_ERR_OBJECT;
    if (o->gl.GetCurrentContext && o->gl.GetCurrentContext() != o->context)
        return PUPIL_ERR_GLES_CONTEXT;
    return is_lost(o) ? PUPIL_ERR_GLES_LOST : PUPIL_OK;
}

#define CONTEXT_LOST 0x0507 /* ES 3.2 and KHR_robustness */

int pupil_gles_error(const gles_object *o)
{
    const GLenum error = o->gl.GetError();
    if (error == GL_NO_ERROR)
        return PUPIL_OK;
    if (error == CONTEXT_LOST || is_lost(o))
        return PUPIL_ERR_GLES_LOST;
    return error == GL_OUT_OF_MEMORY ? PUPIL_ERR_GLES_MEMORY : PUPIL_ERR_GLES;
}
