/* The CPU takes over from the GPU in the middle of a run: the adapted level is unbroken, and the picture is the CPU's
 * within what numerics.md allows; a context that is gone is noticed by itself. */
#include "frame/replay_work.h"

#include <math.h>

#include "check.h"
#include "egl/egl_context.h"

enum { WIDTH = 61, HEIGHT = 37, FRAMES = 24, HANDOVER = 11 };

static float light[HEIGHT][WIDTH][4];

/* Each frame has its own light, so that the level is on its way all the time. */
static pupil_frame make_frame(int number)
{
    const float stops = 3.0f * sinf(0.4f * (float)number);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 4; c++)
                light[y][x][c] = c == 3 ? 1.0f : (float)check_uniform() * exp2f(stops + 0.1f * (float)(x - y));
    return (pupil_frame){.image = {.data = light,
                                   .stride_bytes = sizeof light[0],
                                   .width = WIDTH,
                                   .height = HEIGHT,
                                   .pixel = PUPIL_PIXEL_RGBA32F},
                         .info = {.timestamp_ns = number * INT64_C(33333333)},
                         .name = "made"};
}

typedef struct run {
    frame_options options;
    replay_work work;
    pupil_t pupil;
    pupil_stats stats;
    pupil_curve curve;
    pupil_image display;
    pupil_exposure exposure;
} run;

static void start(run *r, uint32_t white)
{
    memset(r, 0, sizeof *r);
    pupil_config_default(&r->options.config);
    r->options.config.histogram = 1;
    r->options.config.white_mode = white;
    r->options.gles = 1;
    r->options.threads = 1;
    CHECK(pupil_init(&r->pupil, &r->options.config) == PUPIL_OK);
    CHECK(replay_work_open(&r->work, &r->options) == 0);
}

static void step(run *r, const pupil_frame *frame)
{
    pupil_why why = {""};
    CHECK_MSG(replay_work_frame(&r->work, &r->pupil, frame, 1, &r->stats, &r->curve, &r->display, &why) == 0, "%s",
              why.text);
    CHECK(pupil_get_exposure(&r->pupil, &r->exposure) == PUPIL_OK);
    CHECK(r->display.width == WIDTH && r->display.height == HEIGHT);
}

static void compare(const run *a, const run *b, int number)
{
    const unsigned char *x = a->display.data, *y = b->display.data;
    int apart = 0, off = 0;
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++) {
        apart = abs(x[i] - y[i]) > apart ? abs(x[i] - y[i]) : apart;
        off += x[i] != y[i];
    }
    CHECK_MSG(apart <= 1 && off <= 3, "frame %d: %d codes, %d samples", number, apart, off);
    CHECK_MSG(fabs(a->exposure.adapted_ev - b->exposure.adapted_ev) < 1.45e-5, "frame %d: %.9f %.9f", number,
              a->exposure.adapted_ev, b->exposure.adapted_ev);
    CHECK_MSG(a->exposure.frames == b->exposure.frames, "frame %d: a frame was adapted to twice, or not at all",
              number);
}

/* By EGL's own means: nobody else is told. */
static void lose_context(void)
{
    typedef void *get_display(void);
    typedef unsigned make_current(void *display, void *draw, void *read, void *context);
    get_display *display = (get_display *)pupil_egl_get_proc("eglGetCurrentDisplay");
    make_current *current = (make_current *)pupil_egl_get_proc("eglMakeCurrent");
    CHECK(display && current && current(display(), NULL, NULL, NULL));
}

/* lost: the context is gone without a word; else the caller gives up. */
static void hand_over(uint32_t white, uint32_t version, int lost)
{
    static run cpu, gpu;
    start(&cpu, white);
    start(&gpu, white);
    gpu.options.gles_version = version;
    replay_work_gles(&gpu.work, NULL);
    for (int number = 0; number < FRAMES; number++) {
        const pupil_frame frame = make_frame(number);
        if (number == HANDOVER && lost)
            lose_context();
        else if (number == HANDOVER)
            replay_work_give_up(&gpu.work, &gpu.pupil, "given up");
        step(&cpu, &frame);
        step(&gpu, &frame);
        compare(&cpu, &gpu, number);
        CHECK((gpu.work.gpu != NULL) == (number < HANDOVER));
        CHECK_MSG((*gpu.work.warning.text != 0) == (number >= HANDOVER), "frame %d: %s", number, gpu.work.warning.text);
        CHECK(number < HANDOVER || gpu.stats.has_histogram);
    }
    char told[700];
    replay_work_tell(&gpu.work, told, sizeof told);
    CHECK_MSG(strstr(told, "11 of 24 frames") && strstr(told, "OpenGL ES"), "%s", told);
    CHECK(gpu.work.gpu_frames == HANDOVER && cpu.work.gpu_frames == 0);
    replay_work_close(&cpu.work);
    replay_work_close(&gpu.work);
}

int main(int argc, char **argv)
{
    static run probe;
    check_begin(argc, argv);
    start(&probe, PUPIL_WHITE_FOLLOW);
    replay_work_gles(&probe.work, NULL);
    const pupil_frame frame = make_frame(0);
    step(&probe, &frame);
    const int has_gpu = probe.work.gpu != NULL;
    if (!has_gpu)
        puts(probe.work.warning.text);
    replay_work_close(&probe.work);
    if (!has_gpu)
        return check_state.failures ? check_end() : check_skip("no OpenGL ES 3.1");
    hand_over(PUPIL_WHITE_FOLLOW, 0, 0);
    hand_over(PUPIL_WHITE_NONE, PUPIL_GLES_ES30, 0);
    hand_over(PUPIL_WHITE_FOLLOW, 0, 1);
    return check_end();
}
