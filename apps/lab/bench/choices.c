#include "choices.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "camera_choices.h"
#include "common/interrupt.h"
#include "encoders.h"
#include "frames.h"

enum { ROUNDS = 15, SHARES = 4, FRAMES = 6, SAMPLES = 3 * 16384, ERROR_SAMPLES = 16 * SAMPLES, FRAMES_SEEN = 64 };
enum { MOST_RUNNERS = SHARES + FRAMES + BENCH_ENCODERS + BENCH_CAMERA_CHOICES };

typedef struct meter_job { /* one of each n rows: config.meter_rows */
    pupil_t pupil;
    const pupil_image_const *in;
    pupil_stats stats;
} meter_job;

typedef struct encoder_job {
    const bench_tables *tables;
    bench_encode *run;
    const float *light; /* SAMPLES floats, which fit in a cache */
    uint8_t *code;
    size_t samples; /* in all */
} encoder_job;

typedef struct choosing {
    bench_subject s;
    bench_kernel kernel[FRAMES];
    meter_job meter[SHARES];
    encoder_job encoder[BENCH_ENCODERS];
    bench_tables tables;
    bench_encoder list[BENCH_ENCODERS];
    float light[SAMPLES];
    uint8_t code[SAMPLES];
    bench_runner runner[MOST_RUNNERS];
} choosing;

/* --- metering some of the rows --- */

static void run_meter(void *context)
{
    meter_job *j = context;
    pupil_stats_clear(&j->stats);
    pupil_meter_rows(&j->pupil, j->in, 0, j->in->height, &j->stats);
}

static int meter_job_open(meter_job *j, const pupil_image_const *in, uint32_t n)
{
    pupil_config config;
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE; /* no histogram */
    config.meter_rows = n;
    j->in = in;
    return pupil_init(&j->pupil, &config);
}

/* The largest difference from metering every row, over FRAMES_SEEN frames: each frame chooses another row of n. */
static double meter_error(const pupil_image_const *in, uint32_t n)
{
    meter_job all, some;
    double exact = 0.0, mean = 0.0, most = 0.0;
    if (meter_job_open(&all, in, 1) || meter_job_open(&some, in, n))
        return HUGE_VAL;
    run_meter(&all);
    pupil_stats_mean(&all.stats, 0.0, 1.0, &exact);
    for (int i = 0; i < FRAMES_SEEN; i++) {
        run_meter(&some);
        pupil_stats_mean(&some.stats, 0.0, 1.0, &mean);
        most = fmax(most, fabs(mean - exact));
        pupil_adapt(&some.pupil, &some.stats, NULL);
    }
    return most;
}

/* Stripes, as of light through a blind. */
static void stripe(pupil_image_const in)
{
    for (uint32_t y = 0; y < in.height; y += 8) {
        float *row = (float *)(uintptr_t)pupil_image_rows(in, y, 1).data;
        for (uint32_t i = 0; i < 4 * in.width; i++)
            row[i] *= 16.0f;
    }
}

/* --- encoding --- */

static void run_encoder(void *context)
{
    const encoder_job *j = context;
    for (size_t done = 0; done < j->samples; done += SAMPLES)
        j->run(j->tables, j->light, j->samples - done < SAMPLES ? (j->samples - done + 63) / 64 * 64 : SAMPLES,
               j->code);
}

/* Spread evenly over the codes, in random order: an LCG (Knuth, MMIX). */
static void spread(float *light, uint64_t *state)
{
    for (size_t i = 0; i < SAMPLES; i++) {
        *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        const double code = (double)(*state >> 11) * 0x1p-53;
        light[i] = (float)(code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4));
    }
}

static void encoder_errors(choosing *c, bench_choice choice[BENCH_ENCODERS])
{
    uint64_t state = 1, off[BENCH_ENCODERS] = {0};
    for (size_t done = 0; done < ERROR_SAMPLES; done += SAMPLES) {
        spread(c->light, &state);
        for (int i = 0; i < BENCH_ENCODERS; i++) {
            c->list[i].run(&c->tables, c->light, SAMPLES, c->code);
            for (size_t k = 0; k < SAMPLES; k++) {
                const int far = abs(c->code[k] - bench_code_of((double)c->light[k]));
                off[i] += far > 0;
                choice[i].code_max = far > choice[i].code_max ? far : choice[i].code_max;
            }
        }
    }
    for (int i = 0; i < BENCH_ENCODERS; i++)
        choice[i].error = (double)off[i] / ERROR_SAMPLES;
}

/* --- all --- */

static int line_up(choosing *c, const bench_options *o, workers *crew, uint32_t level)
{
    static const bench_which frames[FRAMES] = {BENCH_MAP,         BENCH_FUSED,  BENCH_WHITE,
                                               BENCH_WHITE_EVERY, BENCH_CONFIG, BENCH_EXACT};
    const size_t samples = (size_t)3 * c->s.in.width * c->s.in.height;
    uint64_t state = 1;
    bench_runner *next = c->runner;
    for (int i = 0; i < FRAMES; i++)
        if (bench_kernel_open(&c->kernel[i], &c->s, frames[i], level))
            return -1;
    for (uint32_t i = 0; i < SHARES; i++) {
        if (meter_job_open(&c->meter[i], &c->s.in, 1u << i))
            return -1;
        *next++ = (bench_runner){.run = run_meter, .context = &c->meter[i]};
    }
    for (int i = 0; i < FRAMES; i++)
        *next++ = (bench_runner){.run = bench_kernel_run, .context = &c->kernel[i]};
    bench_encoders_open(&c->tables, c->list);
    spread(c->light, &state);
    for (int i = 0; i < BENCH_ENCODERS; i++) {
        c->encoder[i] = (encoder_job){&c->tables, c->list[i].run, c->light, c->code, samples};
        *next++ = (bench_runner){.run = run_encoder, .context = &c->encoder[i]};
    }
    return bench_camera_open(o, crew, level, next);
}

static bench_choice *next_choice(bench_choice *choice, size_t *count, bench_group group, const choosing *c,
                                 const bench_runner *r)
{
    bench_choice *one = &choice[(*count)++];
    *one = (bench_choice){.group = group, .ns_per_px = r->median_s * 1e9 / ((double)c->s.in.width * c->s.in.height)};
    return one;
}

static int judge(choosing *c, uint32_t level, bench_choice *choice, size_t *count)
{
    static const char *const frame_name[FRAMES] = {"map alone",          "fused",          "fused+white",
                                                   "white, every pixel", "config default", "exact"};
    const bench_runner *r = c->runner;
    verify_figures figures;
    if (bench_kernel_error(level, PUPIL_PIXEL_RGBA32F, PUPIL_LIGHT_DEFAULT, 1, 0, &figures))
        return -1;
    for (int striped = 0; striped < 2; striped++) {
        if (striped)
            stripe(c->s.in);
        for (uint32_t i = (uint32_t)striped; i < SHARES; i++) {
            bench_choice *one =
                next_choice(choice, count, striped ? BENCH_GROUP_STRIPED : BENCH_GROUP_NATURAL, c, &r[i]);
            one->error = i ? meter_error(&c->s.in, 1u << i) : 0.0;
            if (i)
                snprintf(one->name, sizeof one->name, "1/%u of the rows%s", 1u << i, striped ? ", striped" : "");
            else
                snprintf(one->name, sizeof one->name, "every row");
        }
    }
    r += SHARES;
    for (int i = 0; i < FRAMES; i++) {
        bench_choice *one = next_choice(choice, count, BENCH_GROUP_FRAME, c, r++);
        one->error = (double)figures.off / (double)figures.samples;
        one->code_max = figures.code_error;
        snprintf(one->name, sizeof one->name, "%s", frame_name[i]);
    }
    bench_choice *encoders = &choice[*count];
    for (int i = 0; i < BENCH_ENCODERS; i++)
        snprintf(next_choice(choice, count, BENCH_GROUP_ENCODER, c, r++)->name, sizeof choice->name, "%s",
                 c->list[i].name);
    encoder_errors(c, encoders);
    bench_choice *camera = &choice[*count];
    *count += BENCH_CAMERA_CHOICES;
    return bench_camera_judge(r, camera);
}

int bench_choices(const bench_options *o, workers *crew, const bench_flush *flush, uint32_t level,
                  bench_choice choice[BENCH_MOST_CHOICES], size_t *count)
{
    static choosing c; /* one run per process; the kernels are too large for a stack */
    *count = 0;
    const int failed = bench_subject_open(&c.s, o, PUPIL_PIXEL_RGBA32F, crew) || line_up(&c, o, crew, level) ||
                       bench_race(c.runner, MOST_RUNNERS, o->rounds ? o->rounds : ROUNDS, flush, interrupt_came) ||
                       judge(&c, level, choice, count);
    bench_subject_close(&c.s);
    bench_camera_close();
    return failed ? -1 : 0;
}
