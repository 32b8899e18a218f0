/* drivers/window/window.h: a window or a full screen with an OpenGL ES context (SDL 2: X11, Wayland, KMS), and its
 * keys.
 *
 * Where SDL is left out of the build (PUPIL_GPU=OFF) open fails with a sentence that says so.
 *
 * Threads: the one that opens it. One window a process.
 */
#ifndef PUPIL_DRIVERS_WINDOW_WINDOW_H
#define PUPIL_DRIVERS_WINDOW_WINDOW_H

#include <stddef.h>

#include "pupil/error.h"
#include "pupil/gles.h"

typedef struct pupil_window pupil_window;

typedef struct pupil_window_options {
    const char *title;
    uint32_t width, height; /* of the picture, pixels: the window has this size, or a smaller one of the same shape if
                             * the screen is smaller */
    int fullscreen;
    int debug;        /* a debug context */
    uint32_t version; /* a pupil_gles_version: at least this one; 0: 3.1, or else 3.0 */
} pupil_window_options;

/* 0, or -1 and a sentence (no display, no OpenGL ES 3). Its context is current in this thread. */
int pupil_window_open(pupil_window **window, const pupil_window_options *options, pupil_why *why);
void pupil_window_close(pupil_window *window);

pupil_gles_function pupil_window_get_proc(const char *name);

/* The drawable area in pixels; may change whenever poll was called. */
void pupil_window_size(const pupil_window *window, uint32_t *width, uint32_t *height);

/* Keys other than the printable ones, which are their ASCII codes (letters as typed: 'A' with shift). */
enum {
    PUPIL_WINDOW_NOTHING = 0, /* no event */
    PUPIL_WINDOW_OTHER = 1,   /* an event of no interest here, a new size among them: ask again */
    PUPIL_WINDOW_QUIT = 2,    /* the window was closed */
    PUPIL_WINDOW_LEFT = 0x100,
    PUPIL_WINDOW_RIGHT,
    PUPIL_WINDOW_UP,
    PUPIL_WINDOW_DOWN,
    PUPIL_WINDOW_ESCAPE,
    PUPIL_WINDOW_TAB,
    PUPIL_WINDOW_F11
};

/* The next event; never waits. */
int pupil_window_poll(pupil_window *window);

void pupil_window_set_fullscreen(pupil_window *window, int on);
void pupil_window_set_title(pupil_window *window, const char *title);

/* Shows what was drawn. Waits for the display's next refresh where it can (`vsync` set at open by the driver). */
void pupil_window_swap(pupil_window *window);

#endif
