/* In place of gles_work.c where the build has no OpenGL ES. */
#include <stdio.h>

#include "gles_work.h"
#include "refuse.h"

int gles_work_open(gles_work **g, const pupil_config *config, uint32_t version, pupil_gles_get_proc get_proc,
                   pupil_why *why)
{
    (void)config, (void)version, (void)get_proc;
    *g = NULL;
    pupil_refuse(why, "this build has no OpenGL ES; it needs -DPUPIL_GPU=ON");
    return -1;
}

void gles_work_close(gles_work *g)
{
    (void)g;
}

int gles_work_process(gles_work *g, pupil_t *pupil, int fused, const pupil_image_const *in,
                      const pupil_frame_info *info, pupil_stats *stats, pupil_curve *curve, pupil_why *why)
{
    (void)g, (void)pupil, (void)fused, (void)in, (void)info, (void)stats, (void)curve, (void)why;
    return -1;
}

int gles_work_read(gles_work *g, const pupil_curve *curve, const pupil_image *rgb8, pupil_why *why)
{
    (void)g, (void)curve, (void)rgb8, (void)why;
    return -1;
}

int gles_work_draw(gles_work *g, const pupil_curve *curve, const pupil_gles_target *target, pupil_why *why)
{
    (void)g, (void)curve, (void)target, (void)why;
    return -1;
}

int gles_work_retune(gles_work *g, pupil_t *pupil, const pupil_config *config, pupil_why *why)
{
    (void)g, (void)pupil, (void)config, (void)why;
    return -1;
}

void gles_work_describe(const gles_work *g, char *text, size_t text_bytes)
{
    (void)g, (void)text, (void)text_bytes;
}
