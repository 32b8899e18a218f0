/* tests/drivers/window/fake_sdl.h: the functions of SDL that drivers/window calls, instead of SDL's: a screen of the
 * test's choice that shows nothing, and whose n-th call that can fail does. */
#ifndef PUPIL_TESTS_DRIVERS_WINDOW_FAKE_SDL_H
#define PUPIL_TESTS_DRIVERS_WINDOW_FAKE_SDL_H

#include <SDL.h>

typedef struct fake_sdl {
    const char *driver, *gl_version; /* NULL: no such string */
    int bounds_w, bounds_h;          /* 0: unknown */
    int density;                     /* pixels per unit of the screen */
    int frame;                       /* above a window */
    unsigned newest;                 /* contexts up to this version: 31 */
    int no_functions;
    SDL_Event events[8];
    int event_count, event_next;
    unsigned long calls, fail_at; /* from 1; 0: none */
    const char *failed;
    int started, windows, contexts; /* what exists */
    int x, y, w, h, minor, text_input;
    Uint32 flags;
    char title[64];
} fake_sdl;

extern fake_sdl fake;

void fake_sdl_begin(void);

#endif
