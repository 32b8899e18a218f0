#include "camera_choices.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "frames.h"

enum { SUBJECTS = 4, WHOLE = 0, PASSED_ON, MOSAIC, HALVED };

static const struct {
    uint32_t pixel;
    bench_out out;
} subject_of[SUBJECTS] = {{PUPIL_PIXEL_NV12, {"rgba8", PUPIL_PIXEL_RGBA8, 1}},
                          {PUPIL_PIXEL_NV12, {"nv12", PUPIL_PIXEL_NV12, 1}},
                          {PUPIL_PIXEL_BAYER10, {"rgba8", PUPIL_PIXEL_RGBA8, 1}},
                          {PUPIL_PIXEL_BAYER10, {"half", PUPIL_PIXEL_RGBA8, 2}}};

/* `luma`: its error is the difference from the previous choice, which has the same output. */
static const struct {
    int subject;
    bench_which which;
    const char *name;
} kernel_of[BENCH_CAMERA_CHOICES] = {{WHOLE, BENCH_FUSED, "fused"},
                                     {WHOLE, BENCH_CONFIG, "config default"},
                                     {WHOLE, BENCH_WHITE, "fused+white"},
                                     {WHOLE, BENCH_LUMA, "luma"},
                                     {PASSED_ON, BENCH_CONFIG, "to NV12, config default"},
                                     {PASSED_ON, BENCH_WHITE, "to NV12, fused+white"},
                                     {PASSED_ON, BENCH_LUMA, "to NV12, luma"},
                                     {MOSAIC, BENCH_FUSED, "fused"},
                                     {HALVED, BENCH_FUSED, "half size"}};

static struct {
    uint32_t level;
    bench_subject s[SUBJECTS];
    bench_kernel kernel[BENCH_CAMERA_CHOICES]; /* too large for a stack */
} camera;

int bench_camera_open(const bench_options *o, workers *crew, uint32_t level, bench_runner runner[BENCH_CAMERA_CHOICES])
{
    camera.level = level;
    for (int i = 0; i < SUBJECTS; i++) {
        bench_options own = *o;
        own.out = &subject_of[i].out;
        own.light = PUPIL_LIGHT_DEFAULT;
        if (bench_subject_open(&camera.s[i], &own, subject_of[i].pixel, crew))
            return -1;
    }
    for (int i = 0; i < BENCH_CAMERA_CHOICES; i++) {
        bench_kernel *k = &camera.kernel[i];
        if (bench_kernel_open(k, &camera.s[kernel_of[i].subject], kernel_of[i].which, level))
            return fputs("pupil bench: this level cannot map frames of a camera\n", stderr), -1;
        runner[i] = (bench_runner){.run = bench_kernel_run, .context = k};
    }
    return 0;
}

void bench_camera_close(void)
{
    for (int i = 0; i < SUBJECTS; i++)
        bench_subject_close(&camera.s[i]);
}

/* The mean and the largest difference of codes by luma from exact codes, by the same curve. */
static int luma_error(bench_kernel *luma, bench_kernel *exact, bench_choice *one)
{
    const bench_subject *s = luma->s;
    const size_t bytes = bench_frame_bytes(s->out.pixel, s->out.width, s->out.height);
    const unsigned char *now = s->out.data;
    unsigned char *before = malloc(bytes);
    uint64_t sum = 0;
    if (!before)
        return fputs("pupil bench: not enough memory\n", stderr), -1;
    bench_kernel_run(exact);
    memcpy(before, now, bytes);
    bench_kernel_run(luma);
    for (size_t i = 0; i < bytes; i++) {
        const int far = abs(now[i] - before[i]);
        sum += (uint64_t)far;
        one->code_max = far > one->code_max ? far : one->code_max;
    }
    free(before);
    /* the fourth byte of RGBA8 is no sample */
    one->error = (double)sum / (double)(s->out.pixel == PUPIL_PIXEL_RGBA8 ? bytes / 4 * 3 : bytes);
    return 0;
}

/* Exact choices are compared with the reference in double, as RGB8: no code differs by more than one. */
static int exact_error(int subject, verify_figures *figures)
{
    return bench_kernel_error(camera.level, subject_of[subject].pixel, PUPIL_LIGHT_DEFAULT,
                              subject_of[subject].out.step, 0, figures);
}

int bench_camera_judge(const bench_runner runner[BENCH_CAMERA_CHOICES], bench_choice choice[BENCH_CAMERA_CHOICES])
{
    verify_figures figures[SUBJECTS];
    for (int i = 0; i < SUBJECTS; i++)
        if (exact_error(i, &figures[i]))
            return -1;
    for (int i = 0; i < BENCH_CAMERA_CHOICES; i++) {
        const int subject = kernel_of[i].subject;
        const pupil_image_const *in = &camera.s[subject].in;
        choice[i] = (bench_choice){.group = subject >= MOSAIC ? BENCH_GROUP_MOSAIC : BENCH_GROUP_CAMERA,
                                   .ns_per_px = runner[i].median_s * 1e9 / ((double)in->width * in->height),
                                   .error = (double)figures[subject].off / (double)figures[subject].samples,
                                   .code_max = figures[subject].code_error};
        snprintf(choice[i].name, sizeof choice[i].name, "%s", kernel_of[i].name);
        if (kernel_of[i].which == BENCH_LUMA && luma_error(&camera.kernel[i], &camera.kernel[i - 1], &choice[i]))
            return -1;
    }
    return 0;
}
