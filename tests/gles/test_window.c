/* egl/window.h in its own X server (Xvfb), with keys from xdotool. SDL cannot use the machine's screen. */
#include <GLES3/gl3.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "window/window.h"

static pupil_why why;

/* Xvfb's process, once it answers; its display is this process's. -1: there is no Xvfb. */
static pid_t start_server(void)
{
    int ends[2];
    char number[16] = ":";
    if (pipe(ends) != 0)
        return -1;
    pid_t server = fork();
    if (server == 0) {
        char fd[16];
        snprintf(fd, sizeof fd, "%d", ends[1]);
        close(ends[0]);
        if (!freopen("/dev/null", "w", stderr))
            _exit(127);
        execlp("Xvfb", "Xvfb", "-displayfd", fd, "-screen", "0", "640x480x24", "-nolisten", "tcp", "-noreset",
               (char *)NULL); /* else it resets when its last window closes, and is deaf meanwhile */
        _exit(127);
    }
    close(ends[1]);
    ssize_t length = 1, got;
    while ((got = read(ends[0], number + length, sizeof number - 1 - (size_t)length)) > 0) {
        length += got;
        if (number[length - 1] == '\n')
            break;
    }
    close(ends[0]);
    if (server < 0 || length < 3 || number[length - 1] != '\n')
        return -1;
    number[length - 1] = 0;
    setenv("DISPLAY", number, 1);
    return server;
}

static void check_refusals(void)
{
    pupil_window *window;
    pupil_window_options options = {.title = "refused", .width = 320, .height = 240};
    char display[64];
    snprintf(display, sizeof display, "%s", getenv("DISPLAY"));
    unsetenv("DISPLAY");
    CHECK(pupil_window_open(&window, &options, &why) == -1 && !window);
    CHECK_MSG(strstr(why.text, "set DISPLAY or WAYLAND_DISPLAY"), "\"%s\"", why.text);
    CHECK(pupil_window_open(&window, &options, NULL) == -1);
    setenv("DISPLAY", display, 1);
    options.width = 0;
    CHECK(pupil_window_open(&window, &options, &why) == -1 && strstr(why.text, "0 x 240 pixels"));
    options.width = 320, options.version = 20;
    CHECK(pupil_window_open(&window, &options, &why) == -1 && strstr(why.text, "give 0, 30 or 31"));
    pupil_window_close(NULL);
}

/* All events up to a 'q', without those of no interest. */
static void check_keys(pupil_window *window)
{
    static const int expected[] = {'a',
                                   'A',
                                   '+',
                                   '~',
                                   ' ',
                                   '[',
                                   '5',
                                   PUPIL_WINDOW_LEFT,
                                   PUPIL_WINDOW_RIGHT,
                                   PUPIL_WINDOW_UP,
                                   PUPIL_WINDOW_DOWN,
                                   PUPIL_WINDOW_ESCAPE,
                                   PUPIL_WINDOW_TAB,
                                   PUPIL_WINDOW_F11,
                                   'q'};
    size_t count = sizeof expected / sizeof *expected;
    while (pupil_window_poll(window) != PUPIL_WINDOW_NOTHING)
        ;
    CHECK(system("xdotool type 'aA+~ [5' && "
                 "xdotool key Left Right Up Down Escape Tab Return BackSpace ctrl+c F1 F11 && xdotool type q") == 0);
    for (size_t i = 0; i < count; i++) {
        int got, waits = 0;
        while ((got = pupil_window_poll(window)) <= PUPIL_WINDOW_OTHER && waits++ < 30000) /* against hanging */
            usleep(1000);
        CHECK_MSG(got == expected[i], "key %zu is 0x%x, not 0x%x", i, (unsigned)got, (unsigned)expected[i]);
        if (got == 'q')
            break;
    }
}

static void check_size(pupil_window *window, uint32_t width, uint32_t height)
{
    uint32_t w, h;
    pupil_window_size(window, &w, &h);
    CHECK_MSG(w == width && h == height, "%u x %u, not %u x %u", w, h, width, height);
}

/* Of the window that is called second, as the server has it: there is no window manager. */
static void check_geometry(const char *geometry)
{
    char command[128];
    snprintf(command, sizeof command, "xdotool search --name '^second$' getwindowgeometry | grep -q 'Geometry: %s$'",
             geometry);
    CHECK_MSG(system(command) == 0, "not %s", geometry);
}

static void check_window(void)
{
    pupil_window *window, *second;
    pupil_window_options options = {.title = "first", .width = 320, .height = 240, .debug = 1};
    uint8_t rgba[4] = {0};
    CHECK_MSG(pupil_window_open(&window, &options, &why) == 0, "%s", why.text);
    if (!window)
        return;
    CHECK(pupil_window_open(&second, &options, &why) == -1 && !second && strstr(why.text, "open already"));
    check_size(window, 320, 240);
    CHECK(pupil_window_get_proc("glClear") != NULL);
    glClearColor(1, 0, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glReadPixels(160, 120, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
    CHECK(rgba[0] == 255 && rgba[1] == 0 && rgba[2] == 255);
    pupil_window_swap(window);
    pupil_window_set_title(window, "second");
    CHECK(system("xdotool search --sync --name '^second$' >/dev/null") == 0);
    check_keys(window);
    pupil_window_set_fullscreen(window, 1);
    while (pupil_window_poll(window) != PUPIL_WINDOW_NOTHING)
        ;
    check_size(window, 640, 480);
    check_geometry("640x480");
    pupil_window_set_fullscreen(window, 0);
    check_geometry("320x240");
    CHECK(glGetError() == GL_NO_ERROR);
    pupil_window_close(window);

    /* Larger than the screen: its aspect ratio is kept. */
    options.width = 1920, options.height = 1080, options.version = PUPIL_GLES_ES30;
    CHECK_MSG(pupil_window_open(&window, &options, &why) == 0, "%s", why.text);
    if (!window)
        return;
    check_size(window, 640, 360);
    pupil_window_close(window);
    options.fullscreen = 1;
    CHECK_MSG(pupil_window_open(&window, &options, &why) == 0, "%s", why.text);
    if (!window)
        return;
    check_size(window, 640, 480);
    pupil_window_close(window);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    setenv("SDL_VIDEODRIVER", "x11", 1);
    pupil_window *window;
    unsetenv("DISPLAY");
    pupil_window_open(&window, &(pupil_window_options){.width = 1, .height = 1}, &why);
    if (strstr(why.text, "PUPIL_GPU=OFF"))
        return check_skip("built without a window");
    if (system("command -v Xvfb >/dev/null && command -v xdotool >/dev/null") != 0)
        return check_skip("no Xvfb or no xdotool");
    pid_t server = start_server();
    CHECK(server > 0);
    if (server > 0) {
        check_refusals();
        check_window();
        kill(server, SIGTERM);
        waitpid(server, NULL, 0);
    }
    return check_end();
}
