/* Windows on screens that lack something or fail: a sentence, and nothing leaks; their sizes; and which events give
 * which key. */
#include "fake_sdl.h"

#include "check.h"
#include "window/window.h"

static pupil_why why;

static pupil_window *opens(const pupil_window_options *options)
{
    pupil_window *window;
    why.text[0] = 0;
    const int opened = pupil_window_open(&window, options, &why) == 0;
    CHECK(opened == (window != NULL) && fake.windows == opened && fake.contexts == opened && fake.started == opened);
    CHECK_MSG(opened || strlen(why.text) > 10, "'%s'", why.text);
    return window;
}

static void closes(pupil_window *window)
{
    pupil_window_close(window);
    CHECK(fake.windows == 0 && fake.contexts == 0 && !fake.started);
}

static void test_refusals(void)
{
    static const struct {
        pupil_window_options options;
        const char *driver, *gl_version;
        unsigned newest;
        int no_functions;
        const char *says; /* NULL: it opens */
    } cases[] = {
        {{.width = 8, .height = 0}, "fake", "OpenGL ES 3.2", 32, 0, "8 x 0 pixels"},
        {{.width = PUPIL_MAX_SIDE_PX + 1, .height = 8}, "fake", "OpenGL ES 3.2", 32, 0, "each side is 1 to"},
        {{.width = 8, .height = PUPIL_MAX_SIDE_PX + 1}, "fake", "OpenGL ES 3.2", 32, 0, "each side is 1 to"},
        {{.width = 8, .height = 8, .version = 32}, "fake", "OpenGL ES 3.2", 32, 0, "give 0, 30 or 31"},
        {{.width = 8, .height = 8}, "offscreen", "OpenGL ES 3.2", 32, 0, "its offscreen driver alone would start"},
        {{.width = 8, .height = 8, .version = PUPIL_GLES_ES31},
         "fake",
         "OpenGL ES 3.0",
         30,
         0,
         "no OpenGL ES 3.1 (SDL: the fake failed)"},
        {{.width = 8, .height = 8, .version = PUPIL_GLES_ES31},
         "fake",
         "OpenGL ES 3.0",
         32,
         0,
         "the display has \"OpenGL ES 3.0\"; OpenGL ES 3.1 is needed"},
        {{.width = 8, .height = 8}, "fake", "4.6", 32, 0, "the display has \"4.6\""},
        {{.width = 8, .height = 8}, "fake", NULL, 32, 0, "the display has \"no OpenGL\""},
        {{.width = 8, .height = 8}, "fake", "OpenGL ES 3.2", 32, 1, "the display has \"no OpenGL\""},
        {{.width = 8, .height = 8}, "fake", "OpenGL ES 3.0", 30, 0, NULL},
        {{.width = 8, .height = 8, .version = PUPIL_GLES_ES30}, "fake", "OpenGL ES 3.2", 32, 0, NULL},
    };
    unsetenv("SDL_VIDEODRIVER");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_sdl_begin();
        fake.driver = cases[i].driver;
        fake.gl_version = cases[i].gl_version;
        fake.newest = cases[i].newest;
        fake.no_functions = cases[i].no_functions;
        pupil_window *window = opens(&cases[i].options);
        CHECK_MSG(!window == (cases[i].says != NULL) && (window || strstr(why.text, cases[i].says)), "case %zu: %s", i,
                  why.text);
        closes(window);
    }
    fake_sdl_begin();
    fake.driver = "offscreen"; /* as requested */
    setenv("SDL_VIDEODRIVER", "offscreen", 1);
    pupil_window *window = opens(&(pupil_window_options){.width = 8, .height = 8}), *second;
    CHECK(window && pupil_window_open(&second, &(pupil_window_options){.width = 8, .height = 8}, &why) == -1 &&
          strstr(why.text, "a window is open already"));
    closes(window);
    unsetenv("SDL_VIDEODRIVER");
    unsigned long at = 0;
    do {
        fake_sdl_begin();
        fake.newest = 30;
        fake.fail_at = ++at;
        window = opens(&(pupil_window_options){.width = 8, .height = 8});
        CHECK_MSG(!window == (fake.failed != NULL), "call %lu (%s): %s", at, fake.failed, why.text);
        closes(window);
    } while (fake.failed);
    CHECK(at == 4);
}

/* The picture's shape within the screen's room, in pixels. */
static void test_sizes(void)
{
    static const struct {
        uint32_t width, height;
        int bounds_w, bounds_h, density, w, h;
    } cases[] = {{640, 360, 1920, 1080, 1, 640, 360},    {3840, 1080, 1920, 1080, 1, 1920, 540},
                 {1080, 3840, 1920, 1080, 1, 303, 1080}, {640, 2000, 1920, 1080, 1, 345, 1080},
                 {5000, 3, 1000, 1000, 1, 1000, 1},      {3, 5000, 1000, 1000, 1, 1, 1000},
                 {640, 360, 0, 0, 1, 640, 360},          {640, 360, 1920, 1080, 2, 320, 180}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_sdl_begin();
        fake.bounds_w = cases[i].bounds_w;
        fake.bounds_h = cases[i].bounds_h;
        fake.density = cases[i].density;
        pupil_window *window = opens(&(pupil_window_options){.width = cases[i].width, .height = cases[i].height});
        uint32_t w, h;
        CHECK_MSG(fake.w == cases[i].w && fake.h == cases[i].h, "case %zu: %d x %d", i, fake.w, fake.h);
        pupil_window_size(window, &w, &h);
        CHECK(w == (uint32_t)(cases[i].w * cases[i].density) && h == (uint32_t)(cases[i].h * cases[i].density));
        closes(window);
    }
    fake_sdl_begin();
    fake.density = 2;
    pupil_window *window =
        opens(&(pupil_window_options){.title = "a title", .width = 64, .height = 64, .fullscreen = 1, .debug = 1});
    CHECK(fake.flags & SDL_WINDOW_FULLSCREEN_DESKTOP && strcmp(fake.title, "a title") == 0);
    CHECK(fake.x == 0 && fake.y == 0 && fake.w == 1920 && fake.h == 1080);
    pupil_window_set_fullscreen(window, 0);
    CHECK(!fake.flags && fake.w == 32 && fake.h == 32);
    for (int i = 0; i < 2; i++) { /* SDL does it alone: with a window manager, or on a screen of unknown size */
        fake.frame = i ? 20 : 0;
        fake.bounds_w = i ? 1920 : 0;
        fake.w = 32;
        pupil_window_set_fullscreen(window, 1);
        CHECK(fake.flags & SDL_WINDOW_FULLSCREEN_DESKTOP && fake.w == 32 && fake.h == 32);
        fake.w = 1920;
        pupil_window_set_fullscreen(window, 0);
        CHECK(!fake.flags && fake.w == 1920);
    }
    pupil_window_set_title(window, "another");
    CHECK(strcmp(fake.title, "another") == 0);
    pupil_window_swap(window);
    closes(window);
    pupil_window_close(NULL);
}

static void test_events(void)
{
    fake_sdl_begin();
    pupil_window *window = opens(&(pupil_window_options){.width = 8, .height = 8});
    CHECK(fake.text_input && pupil_window_poll(window) == PUPIL_WINDOW_NOTHING);
    fake.events[0].type = SDL_TEXTINPUT; /* without letters, as from input methods */
    fake.events[1].type = SDL_TEXTINPUT;
    strcpy(fake.events[1].text.text, "a\x1b\xc3\xa9");
    fake.events[2].type = SDL_KEYDOWN;
    fake.events[2].key.keysym.sym = SDLK_F11;
    fake.events[3].type = SDL_KEYDOWN;
    fake.events[3].key.keysym.sym = SDLK_q;
    fake.events[4].type = SDL_MOUSEMOTION;
    fake.events[5].type = SDL_QUIT;
    fake.event_count = 6;
    static const int expected[] = {PUPIL_WINDOW_OTHER, 'a',
                                   PUPIL_WINDOW_OTHER, PUPIL_WINDOW_OTHER,
                                   PUPIL_WINDOW_OTHER, PUPIL_WINDOW_F11,
                                   PUPIL_WINDOW_OTHER, PUPIL_WINDOW_OTHER,
                                   PUPIL_WINDOW_QUIT,  PUPIL_WINDOW_NOTHING};
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        const int got = pupil_window_poll(window);
        CHECK_MSG(got == expected[i], "event %zu: %d, not %d", i, got, expected[i]);
    }
    closes(window);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_refusals();
    test_sizes();
    test_events();
    return check_end();
}
