/* tests/drivers/window/fake_sdl.c: see fake_sdl.h. */
#include "fake_sdl.h"

#include <stdio.h>
#include <string.h>

fake_sdl fake;

void fake_sdl_begin(void)
{
    fake = (fake_sdl){.driver = "fake",
                      .gl_version = "OpenGL ES 3.2 Fake",
                      .bounds_w = 1920,
                      .bounds_h = 1080,
                      .density = 1,
                      .newest = 32};
}

static int fails(const char *name)
{
    if (++fake.calls != fake.fail_at)
        return 0;
    fake.failed = name;
    return 1;
}

Uint32 SDL_WasInit(Uint32 flags)
{
    return fake.started ? flags : 0;
}

SDL_bool SDL_SetHint(const char *name, const char *value)
{
    (void)name, (void)value;
    return SDL_TRUE;
}

int SDL_InitSubSystem(Uint32 flags)
{
    (void)flags;
    if (fails("SDL_InitSubSystem"))
        return -1;
    fake.started = 1;
    return 0;
}

void SDL_Quit(void)
{
    fake.started = 0;
}

const char *SDL_GetError(void)
{
    return "the fake failed";
}

const char *SDL_GetCurrentVideoDriver(void)
{
    return fake.driver;
}

int SDL_GetDisplayUsableBounds(int display, SDL_Rect *room)
{
    (void)display;
    *room = (SDL_Rect){0, 0, fake.bounds_w, fake.bounds_h};
    return fake.bounds_w ? 0 : -1;
}

int SDL_GetDisplayBounds(int display, SDL_Rect *bounds)
{
    return SDL_GetDisplayUsableBounds(display, bounds);
}

int SDL_GetWindowDisplayIndex(SDL_Window *window)
{
    (void)window;
    return 0;
}

int SDL_GL_SetAttribute(SDL_GLattr name, int value)
{
    if (name == SDL_GL_CONTEXT_MINOR_VERSION)
        fake.minor = value;
    return 0;
}

SDL_Window *SDL_CreateWindow(const char *title, int x, int y, int w, int h, Uint32 flags)
{
    if (fails("SDL_CreateWindow"))
        return NULL;
    fake.windows++;
    fake.x = x;
    fake.y = y;
    fake.w = w;
    fake.h = h;
    fake.flags = flags;
    snprintf(fake.title, sizeof fake.title, "%s", title);
    return (SDL_Window *)&fake;
}

void SDL_DestroyWindow(SDL_Window *window)
{
    (void)window;
    fake.windows--;
}

int SDL_GetWindowBordersSize(SDL_Window *window, int *top, int *left, int *bottom, int *right)
{
    (void)window;
    *top = fake.frame;
    *left = *bottom = *right = 0;
    return 0;
}

void SDL_GetWindowPosition(SDL_Window *window, int *x, int *y)
{
    (void)window;
    *x = fake.x;
    *y = fake.y;
}

void SDL_SetWindowPosition(SDL_Window *window, int x, int y)
{
    (void)window;
    fake.x = x;
    fake.y = y;
}

void SDL_GetWindowSize(SDL_Window *window, int *w, int *h)
{
    (void)window;
    *w = fake.w;
    *h = fake.h;
}

void SDL_SetWindowSize(SDL_Window *window, int w, int h)
{
    (void)window;
    fake.w = w;
    fake.h = h;
}

void SDL_SetWindowTitle(SDL_Window *window, const char *title)
{
    (void)window;
    snprintf(fake.title, sizeof fake.title, "%s", title);
}

int SDL_SetWindowFullscreen(SDL_Window *window, Uint32 flags)
{
    (void)window;
    fake.flags = flags;
    return 0;
}

void SDL_GL_GetDrawableSize(SDL_Window *window, int *w, int *h)
{
    (void)window;
    *w = fake.w * fake.density;
    *h = fake.h * fake.density;
}

SDL_GLContext SDL_GL_CreateContext(SDL_Window *window)
{
    (void)window;
    if (30u + (unsigned)fake.minor > fake.newest || fails("SDL_GL_CreateContext"))
        return NULL;
    fake.contexts++;
    return &fake;
}

void SDL_GL_DeleteContext(SDL_GLContext context)
{
    (void)context;
    fake.contexts--;
}

static const unsigned char *get_string(unsigned name)
{
    (void)name;
    return (const unsigned char *)fake.gl_version;
}

void *SDL_GL_GetProcAddress(const char *name)
{
    union {
        const unsigned char *(*function)(unsigned name);
        void *object;
    } found = {get_string};
    return fake.no_functions || strcmp(name, "glGetString") != 0 ? NULL : found.object;
}

int SDL_GL_SetSwapInterval(int interval)
{
    (void)interval;
    return 0;
}

void SDL_GL_SwapWindow(SDL_Window *window)
{
    (void)window;
}

void SDL_StartTextInput(void)
{
    fake.text_input = 1;
}

int SDL_PollEvent(SDL_Event *event)
{
    if (fake.event_next == fake.event_count)
        return 0;
    *event = fake.events[fake.event_next++];
    return 1;
}
