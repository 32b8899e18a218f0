/* In place of window.c in a build without SDL. */
#include <stdio.h>

#include "refuse.h"
#include "window.h"

int pupil_window_open(pupil_window **window, const pupil_window_options *options, pupil_why *why)
{
    (void)options;
    *window = NULL;
    if (why)
        pupil_refuse(why, "this build of pupil opens no window (it was configured with PUPIL_GPU=OFF)");
    return -1;
}

void pupil_window_close(pupil_window *window)
{
    (void)window;
}

pupil_gles_function pupil_window_get_proc(const char *name)
{
    (void)name;
    return NULL;
}

void pupil_window_size(const pupil_window *window, uint32_t *width, uint32_t *height)
{
    (void)window;
    *width = *height = 0;
}

int pupil_window_poll(pupil_window *window)
{
    (void)window;
    return PUPIL_WINDOW_QUIT;
}

void pupil_window_set_fullscreen(pupil_window *window, int on)
{
    (void)window, (void)on;
}

void pupil_window_set_title(pupil_window *window, const char *title)
{
    (void)window, (void)title;
}

void pupil_window_swap(pupil_window *window)
{
    (void)window;
}
