/* Replaces gles_engine.c in a build without OpenGL ES. */
#include <stdio.h>

#include "gles_engine.h"
#include "refuse.h"

int gles_engine_open(gles_engine **g, const pupil_config *config, uint32_t version, pupil_gles_get_proc get_proc,
                     pupil_why *why)
{
    (void)config, (void)version, (void)get_proc;
    *g = NULL;
    return pupil_refuse(why, "this build has no OpenGL ES; it needs -DPUPIL_GPU=ON");
}

void gles_engine_close(gles_engine *g)
{
    (void)g;
}

void gles_engine_use_veil(gles_engine *g)
{
    (void)g;
}

int gles_engine_set_veil(gles_engine *g, const pupil_veil *veil, pupil_why *why)
{
    (void)g, (void)veil, (void)why;
    return -1;
}

const frame_engine_ops gles_engine_ops; /* no engine is ever opened */

int gles_engine_draw(gles_engine *g, const pupil_curve *curve, const pupil_gles_target *target, pupil_why *why)
{
    (void)g, (void)curve, (void)target, (void)why;
    return -1;
}

int gles_engine_retune(gles_engine *g, pupil_t *pupil, const pupil_config *config, pupil_why *why)
{
    (void)g, (void)pupil, (void)config, (void)why;
    return -1;
}

void gles_engine_describe(const gles_engine *g, char *text, size_t text_bytes)
{
    (void)g, (void)text, (void)text_bytes;
}
