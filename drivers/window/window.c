/* A window by SDL 2, which knows X11, Wayland and KMS. */
#include "window.h"

#include <SDL.h>
#include <SDL_opengles2.h>
#include <stdio.h>
#include <stdlib.h>

#include "refuse.h"

struct pupil_window {
    SDL_Window *window;
    SDL_GLContext context;
    SDL_Rect before;                         /* full screen, where SDL does not restore it; else w is 0 */
    char text[SDL_TEXTINPUTEVENT_TEXT_SIZE]; /* typed and not yet polled, from `next` on */
    const char *next;
};

static int open_video(pupil_why *why)
{
    if (SDL_WasInit(SDL_INIT_VIDEO))
        return pupil_refuse(why, "a window is open already; there is one a process");
    SDL_SetHint(SDL_HINT_VIDEO_X11_FORCE_EGL, "1"); /* GLX needs an extension for OpenGL ES; dma-bufs need EGL */
    SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0"); /* the desktop's other windows stay as they are */
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");                 /* they are the program's */
    const char *failed = SDL_InitSubSystem(SDL_INIT_VIDEO) == 0 ? NULL : SDL_GetError();
    /* SDL falls back to this driver, which shows nothing. A user chooses it by SDL_VIDEODRIVER. */
    if (!failed && SDL_strcmp(SDL_GetCurrentVideoDriver(), "offscreen") == 0 && !getenv("SDL_VIDEODRIVER")) {
        SDL_Quit();
        failed = "its offscreen driver alone would start";
    }
    if (failed)
        return pupil_refuse(
            why,
            "no display for a window (SDL: %s); set DISPLAY or WAYLAND_DISPLAY, or use the console of a "
            "machine with a screen",
            failed);
    return 0;
}

/* The picture's size, or the largest of its shape that the screen has room for. */
static void fit(uint32_t width, uint32_t height, int *w, int *h)
{
    SDL_Rect room;
    *w = (int)width;
    *h = (int)height;
    if (SDL_GetDisplayUsableBounds(0, &room) != 0 || (*w <= room.w && *h <= room.h))
        return;
    if ((int64_t)*w * room.h > (int64_t)*h * room.w) {
        *h = (int)((int64_t)*h * room.w / *w);
        *w = room.w;
    } else {
        *w = (int)((int64_t)*w * room.h / *h);
        *h = room.h;
    }
    *w = SDL_max(*w, 1);
    *h = SDL_max(*h, 1);
}

static int make_window(pupil_window *window, const pupil_window_options *options, pupil_why *why)
{
    const Uint32 flags = SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI;
    int w, h, drawn_w, drawn_h;
    /* No alpha: a desktop would show through. */
    static const struct {
        SDL_GLattr name;
        int value;
    } attributes[] = {{SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_ES},
                      {SDL_GL_CONTEXT_MAJOR_VERSION, 3},
                      {SDL_GL_CONTEXT_MINOR_VERSION, 0},
                      {SDL_GL_RED_SIZE, 8},
                      {SDL_GL_GREEN_SIZE, 8},
                      {SDL_GL_BLUE_SIZE, 8},
                      {SDL_GL_ALPHA_SIZE, 0},
                      {SDL_GL_DEPTH_SIZE, 0},
                      {SDL_GL_DOUBLEBUFFER, 1}};
    for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++)
        SDL_GL_SetAttribute(attributes[i].name, attributes[i].value);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_FLAGS, options->debug ? SDL_GL_CONTEXT_DEBUG_FLAG : 0);
    fit(options->width, options->height, &w, &h);
    window->window = SDL_CreateWindow(options->title ? options->title : "pupil", SDL_WINDOWPOS_CENTERED,
                                      SDL_WINDOWPOS_CENTERED, w, h, flags);
    if (!window->window)
        return pupil_refuse(
            why, "no window with OpenGL ES (SDL: %s). On Debian: apt-get install libegl1 libgles2 libgl1-mesa-dri",
            SDL_GetError());
    /* If the screen counts in units of several pixels, the window has that many fewer of them. */
    SDL_GL_GetDrawableSize(window->window, &drawn_w, &drawn_h);
    if (drawn_w > w) {
        fit((uint32_t)((int64_t)options->width * w / drawn_w), (uint32_t)((int64_t)options->height * h / drawn_h), &w,
            &h);
        SDL_SetWindowSize(window->window, w, h);
    }
    if (options->fullscreen)
        pupil_window_set_fullscreen(window, 1);
    return 0;
}

static int make_context(pupil_window *window, const pupil_window_options *options, pupil_why *why)
{
    uint32_t lowest = options->version ? options->version : PUPIL_GLES_ES30;
    uint32_t version = options->version ? options->version : PUPIL_GLES_ES31;
    for (; version >= lowest && !window->context; version--) {
        SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, (int)(version % 10));
        window->context = SDL_GL_CreateContext(window->window);
    }
    if (!window->context)
        return pupil_refuse(why, "the display has no OpenGL ES %u.%u (SDL: %s)", lowest / 10, lowest % 10,
                            SDL_GetError());
    const GLubyte *(GL_APIENTRY * get_string)(GLenum name);
    get_string = (const GLubyte *(GL_APIENTRY *)(GLenum))pupil_window_get_proc("glGetString");
    const char *text = get_string ? (const char *)get_string(GL_VERSION) : NULL;
    unsigned major = 0, minor = 0;
    if (!text || sscanf(text, "OpenGL ES %u.%u", &major, &minor) != 2 || major * 10 + minor < lowest)
        return pupil_refuse(why, "the display has \"%s\"; OpenGL ES %u.%u is needed", text ? text : "no OpenGL",
                            lowest / 10, lowest % 10);
    SDL_GL_SetSwapInterval(1); /* where it can */
    return 0;
}

int pupil_window_open(pupil_window **window, const pupil_window_options *options, pupil_why *why)
{
    *window = NULL;
    if (options->width < 1 || options->width > PUPIL_MAX_SIDE_PX || options->height < 1 ||
        options->height > PUPIL_MAX_SIDE_PX)
        return pupil_refuse(why, "a window for %u x %u pixels; each side is 1 to %u", options->width, options->height,
                            PUPIL_MAX_SIDE_PX);
    if (options->version != PUPIL_GLES_BEST && options->version != PUPIL_GLES_ES30 &&
        options->version != PUPIL_GLES_ES31)
        return pupil_refuse(why, "version %u is not a pupil_gles_version; give 0, 30 or 31", options->version);
    if (open_video(why) != 0)
        return -1;
    pupil_window *opened = calloc(1, sizeof *opened);
    if (!opened) {
        SDL_Quit();
        return pupil_refuse(why, "out of memory");
    }
    opened->next = opened->text;
    if (make_window(opened, options, why) != 0 || make_context(opened, options, why) != 0) {
        pupil_window_close(opened);
        return -1;
    }
    SDL_StartTextInput();
    *window = opened;
    return 0;
}

void pupil_window_close(pupil_window *window)
{
    if (!window)
        return;
    if (window->context)
        SDL_GL_DeleteContext(window->context);
    if (window->window)
        SDL_DestroyWindow(window->window);
    SDL_Quit();
    free(window);
}

pupil_gles_function pupil_window_get_proc(const char *name)
{
    /* ISO C has no conversion from an object's pointer to a function's; POSIX says that this one holds. */
    union {
        void *object;
        pupil_gles_function function;
    } found = {SDL_GL_GetProcAddress(name)};
    return found.function;
}

void pupil_window_size(const pupil_window *window, uint32_t *width, uint32_t *height)
{
    int w, h;
    SDL_GL_GetDrawableSize(window->window, &w, &h);
    *width = (uint32_t)w;
    *height = (uint32_t)h;
}

static int key(SDL_Keycode sym)
{
    switch (sym) {
    case SDLK_LEFT:
        return PUPIL_WINDOW_LEFT;
    case SDLK_RIGHT:
        return PUPIL_WINDOW_RIGHT;
    case SDLK_UP:
        return PUPIL_WINDOW_UP;
    case SDLK_DOWN:
        return PUPIL_WINDOW_DOWN;
    case SDLK_ESCAPE:
        return PUPIL_WINDOW_ESCAPE;
    case SDLK_TAB:
        return PUPIL_WINDOW_TAB;
    case SDLK_F11:
        return PUPIL_WINDOW_F11;
    default: /* printable keys come as text, in which shift and the keyboard's layout are respected */
        return PUPIL_WINDOW_OTHER;
    }
}

int pupil_window_poll(pupil_window *window)
{
    SDL_Event event;
    if (!*window->next) {
        if (!SDL_PollEvent(&event))
            return PUPIL_WINDOW_NOTHING;
        if (event.type == SDL_QUIT)
            return PUPIL_WINDOW_QUIT;
        if (event.type == SDL_KEYDOWN)
            return key(event.key.keysym.sym);
        if (event.type != SDL_TEXTINPUT)
            return PUPIL_WINDOW_OTHER;
        SDL_strlcpy(window->text, event.text.text, sizeof window->text);
        window->next = window->text;
        if (!*window->next)
            return PUPIL_WINDOW_OTHER;
    }
    unsigned char typed = (unsigned char)*window->next++;
    return typed >= ' ' && typed <= '~' ? typed : PUPIL_WINDOW_OTHER;
}

static void place(SDL_Window *window, const SDL_Rect *where)
{
    SDL_SetWindowPosition(window, where->x, where->y);
    SDL_SetWindowSize(window, where->w, where->h);
}

/* A window without a frame may have no window manager: then SDL 3 does nothing, and SDL 2 only says that it is done. */
void pupil_window_set_fullscreen(pupil_window *window, int on)
{
    SDL_Window *const w = window->window;
    SDL_Rect *const before = &window->before, screen;
    int top, left, bottom, right;
    if (!on) {
        SDL_SetWindowFullscreen(w, 0);
        if (before->w)
            place(w, before);
        before->w = 0;
        return;
    }
    if (SDL_GetWindowBordersSize(w, &top, &left, &bottom, &right) == 0 && !top && !left && !bottom && !right &&
        SDL_GetDisplayBounds(SDL_max(SDL_GetWindowDisplayIndex(w), 0), &screen) == 0) {
        SDL_GetWindowPosition(w, &before->x, &before->y);
        SDL_GetWindowSize(w, &before->w, &before->h);
        place(w, &screen);
    }
    SDL_SetWindowFullscreen(w, SDL_WINDOW_FULLSCREEN_DESKTOP);
}

void pupil_window_set_title(pupil_window *window, const char *title)
{
    SDL_SetWindowTitle(window->window, title);
}

void pupil_window_swap(pupil_window *window)
{
    SDL_GL_SwapWindow(window->window);
}
