/* Replaces the window's files in a build without OpenGL ES. */
#include <stdio.h>

#include "refuse.h"
#include "view.h"

int view_open(view **v, const view_of *of, const pupil_image_const *first, pupil_why *why)
{
    (void)of, (void)first;
    *v = NULL;
    return pupil_refuse(why, "--view: this build has no OpenGL ES; it needs -DPUPIL_GPU=ON");
}

void view_close(view *v)
{
    (void)v;
}

int view_frame(view *v, const pupil_frame *frame, const frame_log_entry *entry)
{
    (void)v, (void)frame, (void)entry;
    return VIEW_QUIT;
}

void view_stay(view *v)
{
    (void)v;
}
