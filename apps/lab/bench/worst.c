/* pupil bench kernels --worst: how much longer than the median the slowest frame in a thousand takes, for frames that
 * should be as fast as any. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "clock.h"
#include "common/interrupt.h"
#include "frames.h"
#include "subject.h"

enum { ROUNDS = 2000, CASES = 10, HARD = 1, DARK, DENORMAL, ODD, SATURATED, DEFAULT, LAMPS, FRESH, READ };

static const char *const case_name[CASES] = {"ordinary",  "hard",    "dark",      "denormal", "nan-inf",
                                             "saturated", "default", "default-s", "fresh",    "read"};
static const char *const case_says[CASES] = {
    "the easy frame, memory in use",
    "of 16 samples one odd, one denormal, one black; 40 stops",
    "every second pixel is black: 1e-20 or so",
    "the same, 1e-41 or so: denormal",
    "every second pixel has a NaN, +Inf or -Inf",
    "coloured lamps, 10 stops, every pixel beyond the gamut",
    "the easy frame, with the histogram of a white point that follows",
    "the coloured lamps, with it",
    "the easy frame, output never touched before: page faults",
    "no kernel: a plain read of the easy frame, for what the machine itself does"};

typedef struct worst_case {
    bench_subject s;
    bench_kernel kernel;
    void *own_out; /* s.out's memory before it was mapped again */
    size_t bytes;
    int failed;
} worst_case;

/* Gives the output untouched pages, and frees the touched ones. */
static void map_afresh(void *context)
{
    worst_case *w = context;
    if (w->s.out.data && w->s.out.data != w->own_out)
        munmap(w->s.out.data, w->bytes);
    w->s.out.data = mmap(NULL, w->bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (w->s.out.data == MAP_FAILED) {
        w->s.out.data = w->own_out;
        w->failed = 1;
    }
}

static void run_read(void *context)
{
    bench_read_run(&((worst_case *)context)->s);
}

static void run(void *context)
{
    bench_kernel_run(&((worst_case *)context)->kernel);
}

/* Replaces every second pixel of an easy frame, so that odd pixels are always next to ordinary ones. */
static void plant(pupil_image_const in, const float *odd, unsigned count)
{
    float *rgba = (float *)(uintptr_t)in.data;
    const size_t pixels = (size_t)in.width * in.height;
    for (size_t i = 0; i < pixels; i += 2)
        for (size_t k = 0; k < 3; k++)
            rgba[4 * i + k] = odd[(i / 2 + k) % count];
}

/* Lamps of every hue, whose weakest channels have 2 to 10 % of the others' light, from 1 to 1000 times white. */
static void plant_lamps(pupil_image_const in)
{
    static const float lamp[][3] = {{1.0f, 0.02f, 0.05f}, {1.0f, 0.5f, 0.1f},  {0.1f, 1.0f, 0.05f},
                                    {0.05f, 0.6f, 1.0f},  {0.03f, 0.1f, 1.0f}, {1.0f, 0.1f, 0.8f}};
    float *rgba = (float *)(uintptr_t)in.data;
    const size_t pixels = (size_t)in.width * in.height;
    for (size_t i = 0; i < pixels; i++) {
        const float light = (float)exp2(10.0 * (double)(i % 997) / 997.0);
        for (size_t k = 0; k < 3; k++)
            rgba[4 * i + k] = light * lamp[i / 7 % 6][k];
    }
}

static int open_case(worst_case *w, int which, const bench_options *o, workers *crew, uint32_t level)
{
    static const float denormal[] = {1e-41f, 1e-39f, 1e-45f}, dark[] = {1e-20f, 1e-18f, 1e-24f},
                       odd[] = {NAN, INFINITY, -INFINITY, 1.0f};
    if (bench_subject_open(&w->s, o, PUPIL_PIXEL_RGBA32F, crew))
        return -1;
    free(w->s.copy); /* nothing is copied here */
    w->s.copy = NULL;
    if (which == HARD) {
        free((void *)(uintptr_t)w->s.in.data);
        w->s.in = bench_frame(PUPIL_PIXEL_RGBA32F, o->width, o->height, 1);
    }
    w->own_out = w->s.out.data;
    w->bytes = (size_t)o->width * o->height * 4;
    if (!w->s.in.data ||
        bench_kernel_open(&w->kernel, &w->s, which == DEFAULT || which == LAMPS ? BENCH_WHITE : BENCH_FUSED, level))
        return fputs("pupil bench: not enough memory\n", stderr), -1;
    if (which == DARK)
        plant(w->s.in, dark, 3);
    if (which == DENORMAL)
        plant(w->s.in, denormal, 3);
    if (which == ODD)
        plant(w->s.in, odd, 4);
    if (which == SATURATED || which == LAMPS)
        plant_lamps(w->s.in);
    bench_kernel_run(&w->kernel); /* output to memory that is in use */
    return 0;
}

static void close_case(worst_case *w)
{
    if (w->own_out && w->s.out.data != w->own_out) {
        munmap(w->s.out.data, w->bytes);
        w->s.out.data = w->own_out;
    }
    bench_subject_close(&w->s);
}

static void tell(const bench_options *o, uint32_t level, unsigned threads, int i, const bench_runner *r,
                 const bench_runner *ordinary)
{
    const double us = 1e6;
    if (o->json)
        printf("{\"bench\":\"worst\",\"frame\":\"%s\",\"kernel\":\"%s\",\"level\":\"%s\",\"format\":\"rgba32f\","
               "\"out\":\"rgba8\",\"width\":%lu,\"height\":%lu,\"threads\":%u,\"frames\":%u,\"median_us\":%.2f,"
               "\"p99_us\":%.2f,\"p999_us\":%.2f,\"max_us\":%.2f,\"ratio_p999_median\":%.4f,\"ratio_ordinary\":%.4f}\n",
               case_name[i], i == READ ? "read" : "fused", i == READ ? "C" : bench_level_names[level],
               (unsigned long)o->width, (unsigned long)o->height, threads, o->rounds ? o->rounds : ROUNDS,
               us * r->median_s, us * r->p99_s, us * r->p999_s, us * r->most_s, r->p999_s / r->median_s,
               r->median_s / ordinary->median_s);
    else
        printf("%-9s %9.1f %9.1f %9.1f %9.1f %9.2f %9.3f  %s\n", case_name[i], us * r->median_s, us * r->p99_s,
               us * r->p999_s, us * r->most_s, r->p999_s / r->median_s, r->median_s / ordinary->median_s, case_says[i]);
}

static int race(const bench_options *o, worst_case *w, workers *crew, uint32_t level)
{
    bench_runner runner[CASES];
    for (int i = 0; i < CASES; i++) {
        runner[i] = (bench_runner){
            .run = i == READ ? run_read : run, .context = &w[i], .prepare = i == FRESH ? map_afresh : NULL};
        if (open_case(&w[i], i, o, crew, level))
            return BENCH_FAILED;
    }
    if (bench_race(runner, CASES, o->rounds ? o->rounds : ROUNDS, NULL, interrupt_came))
        return interrupt_came() ? BENCH_INTERRUPTED : BENCH_FAILED;
    if (w[FRESH].failed)
        return fputs("pupil bench: not enough memory to map the output afresh\n", stderr), BENCH_FAILED;
    if (!o->json)
        printf("fused, %s, RGBA float, %lux%lu, %u thread%s, %u frames of each in turns; us\n"
               "%-9s %9s %9s %9s %9s %9s %9s\n",
               bench_level_names[level], (unsigned long)o->width, (unsigned long)o->height, workers_count(crew),
               workers_count(crew) > 1 ? "s" : "", o->rounds ? o->rounds : ROUNDS, "frame", "median", "p99", "p99.9",
               "max", "p99.9/med", "/ordinary");
    for (int i = 0; i < CASES; i++)
        tell(o, level, workers_count(crew), i, &runner[i], &runner[0]);
    fflush(stdout);
    return BENCH_DONE;
}

int bench_worst(const bench_options *o, workers *crew)
{
    static worst_case w[CASES]; /* one run per process; the kernels are too large for a stack */
    const int status = race(o, w, crew, bench_best_level());
    for (int i = 0; i < CASES; i++)
        close_case(&w[i]);
    return status;
}
