/* A frame on the CPU's threads has the bits of pupil_process. The CPU takes over from the GPU in the middle of a run:
 * the adapted level continues, and the picture is the CPU's within the limits of gpu.md; a lost context is detected. */
#include "frame/pipeline.h"

#include <dlfcn.h>
#include <math.h>

#include "check.h"

enum { WIDTH = 61, HEIGHT = 37, FRAMES = 24, HANDOVER = 11 };

static float light[HEIGHT][WIDTH][4];

/* Each frame has its own light, so that the level is always moving. */
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
    frame_pipeline pipeline;
    pupil_exposure exposure;
} run;

static void start(run *r, uint32_t white)
{
    pupil_config config;
    memset(r, 0, sizeof *r);
    pupil_config_default(&config);
    config.histogram = 1;
    config.white_mode = white;
    CHECK(frame_pipeline_open(&r->pipeline, &config, 1) == 0);
}

/* A frame as metered. */
static void show(run *r, const pupil_frame *frame)
{
    pupil_why why = {""};
    frame_pipeline *p = &r->pipeline;
    CHECK_MSG(frame_pipeline_map(p, frame, 1, &why) == 0, "%s", why.text);
    CHECK(pupil_get_exposure(&p->pupil, &r->exposure) == PUPIL_OK);
    CHECK(p->display.width == WIDTH && p->display.height == HEIGHT);
}

static void step(run *r, const pupil_frame *frame)
{
    pupil_why why = {""};
    CHECK_MSG(frame_pipeline_meter(&r->pipeline, frame, &why) == 0, "%s", why.text);
    show(r, frame);
}

static void compare(const run *a, const run *b, int number)
{
    const unsigned char *x = a->pipeline.display.data, *y = b->pipeline.display.data;
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

/* Directly through EGL, so that neither the engine nor the pipeline notices. EGL is looked up at run time, because a
 * build without a GPU does not link it and does not come here. */
static void lose_context(void)
{
    void *(*display)(void);
    unsigned (*current)(void *display, void *draw, void *read, void *context);
    *(void **)&display = dlsym(RTLD_DEFAULT, "eglGetCurrentDisplay");
    *(void **)&current = dlsym(RTLD_DEFAULT, "eglMakeCurrent");
    CHECK(display && current && current(display(), NULL, NULL, NULL));
}

/* How the GPU ends at frame HANDOVER. */
typedef enum ending {
    GIVEN_UP,         /* by the caller */
    LOST,             /* the context is lost without notice */
    LOST_WHEN_METERED /* the same, after it has metered the frame: the CPU maps it, and it is not metered again */
} ending;

static void hand_over(uint32_t white, uint32_t version, ending how)
{
    static run cpu, gpu;
    const pupil_why given_up = {"given up"};
    frame_pipeline *p = &gpu.pipeline;
    start(&cpu, white);
    start(&gpu, white);
    frame_pipeline_use_gpu(p, version, NULL);
    for (int number = 0; number < FRAMES; number++) {
        pupil_frame frame = make_frame(number);
        pupil_why why = {""};
        frame.window[2] = frame.window[3] = number / 8 % 2 ? 0.5 : 0.0; /* also when the CPU takes over */
        if (number == HANDOVER && how == LOST)
            lose_context();
        else if (number == HANDOVER && how == GIVEN_UP)
            frame_pipeline_give_up_gpu(p, &given_up);
        step(&cpu, &frame);
        CHECK_MSG(frame_pipeline_meter(p, &frame, &why) == 0, "%s", why.text);
        if (number == HANDOVER && how == LOST_WHEN_METERED)
            lose_context();
        show(&gpu, &frame);
        compare(&cpu, &gpu, number);
        CHECK((p->gpu != NULL) == (number < HANDOVER));
        CHECK_MSG((*p->warning.text != 0) == (number >= HANDOVER), "frame %d: %s", number, p->warning.text);
        CHECK(number < HANDOVER || p->stats.has_histogram);
    }
    char words[700];
    frame_pipeline_describe(p, words, sizeof words);
    CHECK_MSG(strstr(words, "11 of 24 frames") && strstr(words, "OpenGL ES"), "%s", words);
    CHECK(p->gpu_frames == HANDOVER && cpu.pipeline.gpu_frames == 0);
    frame_pipeline_close(&cpu.pipeline);
    frame_pipeline_close(p);
}

/* On several threads the CPU gives the bits of pupil_process, in both orders, also before the first light. */
static void like_process(uint32_t order, uint32_t white)
{
    static unsigned char whole[HEIGHT][WIDTH][3];
    pupil_config config;
    pupil_t pupil;
    frame_pipeline p;
    pupil_config_default(&config);
    config.order = order;
    config.white_mode = white;
    CHECK(pupil_metering_roi(&config, 0, 0, 0.1, 0.1) == PUPIL_OK);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && frame_pipeline_open(&p, &config, 3) == 0);
    for (int number = 0; number < 6; number++) {
        pupil_frame frame = make_frame(number);
        if (number < 2) /* one pixel, in the middle of the metering grid, has no weight */
            frame.image.width = frame.image.height = 1;
        const uint32_t width = frame.image.width, height = frame.image.height;
        const pupil_image out = {.data = whole,
                                 .stride_bytes = (ptrdiff_t)width * 3,
                                 .width = width,
                                 .height = height,
                                 .pixel = PUPIL_PIXEL_RGB8};
        pupil_why why = {""};
        CHECK(pupil_process(&pupil, &frame.image, &frame.info, &out) == PUPIL_OK);
        CHECK_MSG(frame_pipeline_meter(&p, &frame, &why) == 0, "%s", why.text);
        CHECK(p.has_light == (number >= 2));
        CHECK(p.is_mapped == (order == PUPIL_ORDER_FUSED && number > 2));
        CHECK_MSG(frame_pipeline_map(&p, &frame, 1, &why) == 0, "%s", why.text);
        CHECK_MSG(memcmp(whole, p.display.data, (size_t)width * height * 3) == 0,
                  "order %u, white %u, frame %d: another picture", order, white, number);
    }
    frame_pipeline_close(&p);
}

/* A frame's window is what --roi of it is, for that frame; where the settings count nothing of it, it is not there. */
static void window(uint32_t version, int on_gpu)
{
    static const double half[4] = {0.125, 0.3, 0.5, 0.5}; /* its rows begin within a cell of the grid */
    static run whole, seen;
    for (int elsewhere = 0; elsewhere < 2; elsewhere++) {
        start(&whole, PUPIL_WHITE_FOLLOW);
        start(&seen, PUPIL_WHITE_FOLLOW);
        if (on_gpu) {
            frame_pipeline_use_gpu(&whole.pipeline, version, NULL);
            frame_pipeline_use_gpu(&seen.pipeline, version, NULL);
        }
        for (int number = 0; number < 8; number++) {
            const int inside = number % 4 != 3;
            pupil_frame frame = make_frame(number);
            pupil_config config = whole.pipeline.config;
            pupil_metering_uniform(&config);
            if (elsewhere)
                pupil_metering_roi(&config, 0.75, 0, 0.25, 0.25);
            if (number == 0)
                frame_pipeline_retune(&seen.pipeline, &config);
            if (inside && !elsewhere)
                pupil_metering_roi(&config, half[0], half[1], half[2], half[3]);
            frame_pipeline_retune(&whole.pipeline, &config);
            step(&whole, &frame);
            if (inside)
                memcpy(frame.window, half, sizeof half);
            step(&seen, &frame);
            CHECK_MSG(fabs(whole.exposure.adapted_ev - seen.exposure.adapted_ev) < 1e-9, "frame %d: %.9f, by roi %.9f",
                      number, seen.exposure.adapted_ev, whole.exposure.adapted_ev);
            CHECK((seen.pipeline.gpu != NULL) == on_gpu);
        }
        if (on_gpu) /* the CPU takes over with the window */
            frame_pipeline_give_up_gpu(&seen.pipeline, &(pupil_why){"given up"});
        frame_pipeline_close(&whole.pipeline);
        frame_pipeline_close(&seen.pipeline);
    }
}

/* Floats that are decoded codes: black counts for the level, however they are metered. */
static void decoded_codes(uint32_t order, int on_gpu)
{
    run r;
    start(&r, PUPIL_WHITE_FOLLOW);
    pupil_config config = r.pipeline.config;
    config.order = order;
    config.highlight_ev = config.tau_light_s = config.tau_dark_s = 0.0;
    frame_pipeline_retune(&r.pipeline, &config);
    if (on_gpu)
        frame_pipeline_use_gpu(&r.pipeline, 0, NULL);
    for (int number = 0; number < 4; number++) {
        pupil_frame frame = make_frame(number);
        double mean = 0.0;
        memset(light, 0, sizeof light / 4);
        frame.code_light = number % 2 ? 0.0f : 0x1p-30f;
        step(&r, &frame);
        CHECK(pupil_stats_mean(&r.pipeline.stats, 0.0, 1.0, &mean) == PUPIL_OK);
        const double black_ev = mean - r.exposure.adapted_ev;
        CHECK_MSG(number % 2 ? black_ev < -2.0 : fabs(black_ev) < 1e-9, "order %u, GPU %d, frame %d: %g above the mean",
                  order, on_gpu, number, -black_ev);
        CHECK((r.pipeline.gpu != NULL) == on_gpu);
    }
    frame_pipeline_close(&r.pipeline);
}

/* Only the curve says how a frame is mapped: the caller's takes effect. */
static void own_curve(void)
{
    run r;
    pupil_why why;
    start(&r, PUPIL_WHITE_NONE);
    const pupil_frame frame = make_frame(0);
    CHECK(frame_pipeline_meter(&r.pipeline, &frame, &why) == 0);
    r.pipeline.curve = (pupil_curve){.scale = 0.0f};
    show(&r, &frame);
    const unsigned char *p = r.pipeline.display.data;
    int most = 0;
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++)
        most = p[i] > most ? p[i] : most;
    CHECK_MSG(most == 0, "code %d where all is black", most);
    CHECK(r.pipeline.adapted.scale > 0.0f);
    frame_pipeline_close(&r.pipeline);
}

int main(int argc, char **argv)
{
    static run probe;
    check_begin(argc, argv);
    for (uint32_t order = 0; order < PUPIL_ORDER_COUNT; order++)
        for (uint32_t white = PUPIL_WHITE_FOLLOW; white <= PUPIL_WHITE_NONE; white++)
            like_process(order, white);
    own_curve();
    window(0, 0);
    decoded_codes(PUPIL_ORDER_EXACT, 0);
    decoded_codes(PUPIL_ORDER_FUSED, 0);
    start(&probe, PUPIL_WHITE_FOLLOW);
    frame_pipeline_use_gpu(&probe.pipeline, 0, NULL);
    const pupil_frame frame = make_frame(0);
    step(&probe, &frame);
    const int has_gpu = probe.pipeline.gpu != NULL;
    if (!has_gpu)
        puts(probe.pipeline.warning.text);
    frame_pipeline_close(&probe.pipeline);
    if (!has_gpu)
        return check_state.failures ? check_end() : check_skip("no OpenGL ES 3.1");
    window(0, 1);
    decoded_codes(PUPIL_ORDER_EXACT, 1);
    hand_over(PUPIL_WHITE_FOLLOW, 0, GIVEN_UP);
    hand_over(PUPIL_WHITE_NONE, PUPIL_GLES_ES30, GIVEN_UP);
    hand_over(PUPIL_WHITE_FOLLOW, 0, LOST);
    hand_over(PUPIL_WHITE_FOLLOW, 0, LOST_WHEN_METERED);
    return check_end();
}
