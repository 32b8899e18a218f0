/* pupil bench kernels --row-gains: the cost of removing banding from a frame (pupil/row_gain.h), compared with
 * metering and mapping it without. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"
#include "common/interrupt.h"
#include "frames.h"
#include "pupil/row_gain.h"
#include "subject.h"

/* 30 frames a second under 100 Hz: every third has the same phase. WATCHED: one second, and half a second until there
 * are gains. */
enum { ROUNDS = 21, PHASES = 3, WATCHED = 45 };

typedef struct lamp_room {
    bench_subject s;
    bench_kernel meter, map, gains;
    pupil_image_const frame[PHASES]; /* the first is s.in */
    pupil_frame_info info;
    uint64_t frames;
    pupil_row_gain lamps;
    float gain[PUPIL_MAX_SIDE_PX];
} lamp_room;

static void next(void *context)
{
    lamp_room *r = context;
    r->frames++;
    r->info = (pupil_frame_info){.timestamp_ns = (int64_t)(r->frames * 100000000 / PHASES), .exposure_s = 1e-3};
}

static void watch(void *context)
{
    lamp_room *r = context;
    pupil_row_gain_frame(&r->lamps, &r->frame[r->frames % PHASES], &r->info);
}

static void find_gains(void *context)
{
    lamp_room *r = context;
    pupil_row_gain_of_rows(&r->lamps, &r->info, r->s.in.height, r->gain);
}

static int open_room(lamp_room *r, const bench_options *o, uint32_t pixel, workers *crew)
{
    pupil_row_gain_config config;
    const uint32_t level = bench_best_level();
    if (bench_subject_open(&r->s, o, pixel, crew))
        return -1;
    for (int i = 0; i < PHASES; i++) {
        r->frame[i] = bench_lamp_frame(pixel, o->width, o->height, (double)i / PHASES);
        if (!r->frame[i].data)
            return fputs("pupil bench: not enough memory\n", stderr), -1;
    }
    free((void *)(uintptr_t)r->s.in.data);
    r->s.in = r->frame[0];
    pupil_row_gain_config_default(&config);
    config.readout_s = 0.025;
    if (bench_kernel_open(&r->meter, &r->s, BENCH_METER, level) ||
        bench_kernel_open(&r->map, &r->s, BENCH_MAP, level) || bench_kernel_open(&r->gains, &r->s, BENCH_MAP, level) ||
        pupil_row_gain_init(&r->lamps, &config))
        return fputs("pupil bench: no row correction gains\n", stderr), -1;
    r->gains.gain = r->gain;
    r->frames = PHASES; /* a timestamp of 0 means none */
    for (int i = 0; i < WATCHED; i++) {
        next(r);
        watch(r);
    }
    find_gains(r);
    return 0;
}

static void close_room(lamp_room *r)
{
    for (int i = 0; i < PHASES; i++)
        if (r->frame[i].data != r->s.in.data)
            free((void *)(uintptr_t)r->frame[i].data);
    bench_subject_close(&r->s);
}

enum { METER, MAP, WATCH, FIND, MAP_GAINS, RUNNERS };

static void tell(const bench_options *o, const lamp_room *r, const bench_runner *t)
{
    pupil_row_gain_result result;
    double ns[RUNNERS];
    for (int i = 0; i < RUNNERS; i++)
        ns[i] = t[i].median_s * 1e9 / ((double)o->width * o->height);
    pupil_row_gain_get(&r->lamps, &result);
    const double more = (ns[METER] + ns[WATCH] + ns[FIND] + ns[MAP_GAINS]) / (ns[METER] + ns[MAP]);
    if (o->json)
        printf("{\"bench\":\"row-gains\",\"level\":\"%s\",\"format\":\"%s\",\"out\":\"%s\",\"width\":%lu,"
               "\"height\":%lu,\"threads\":%u,\"cold\":%s,\"strength\":%.3f,\"meter_ns_per_px\":%.4f,"
               "\"map_ns_per_px\":%.4f,\"frame_ns_per_px\":%.4f,\"of_rows_us\":%.2f,\"map_gains_ns_per_px\":%.4f,"
               "\"ratio_meter\":%.4f,\"ratio_map\":%.4f,\"ratio_all\":%.4f}\n",
               bench_level_names[r->map.level], bench_format_name(r->s.in.pixel), o->out->name, (unsigned long)o->width,
               (unsigned long)o->height, workers_count(r->s.crew), o->warm ? "false" : "true", result.strength,
               ns[METER], ns[MAP], ns[WATCH], t[FIND].median_s * 1e6, ns[MAP_GAINS], ns[WATCH] / ns[METER],
               ns[MAP_GAINS] / ns[MAP], more);
    else
        printf("%-9s %8.3f %8.3f %10.3f %8.2f %9.1f %10.3f %8.2f %8.2f\n", bench_format_name(r->s.in.pixel), ns[METER],
               ns[MAP], ns[WATCH], ns[WATCH] / ns[METER], t[FIND].median_s * 1e6, ns[MAP_GAINS],
               ns[MAP_GAINS] / ns[MAP], more);
    fflush(stdout);
}

static int race(const bench_options *o, lamp_room *r, const bench_flush *flush)
{
    bench_runner runner[RUNNERS] = {[METER] = {.run = bench_kernel_run, .context = &r->meter},
                                    [MAP] = {.run = bench_kernel_run, .context = &r->map},
                                    [WATCH] = {.run = watch, .context = r, .prepare = next},
                                    [FIND] = {.run = find_gains, .context = r},
                                    [MAP_GAINS] = {.run = bench_kernel_run, .context = &r->gains}};
    if (bench_race(runner, RUNNERS, o->rounds ? o->rounds : ROUNDS, flush, interrupt_came))
        return interrupt_came() ? BENCH_INTERRUPTED : BENCH_FAILED;
    tell(o, r, runner);
    return BENCH_DONE;
}

int bench_lamps(const bench_options *o, workers *crew, const bench_flush *flush)
{
    static lamp_room r; /* one run per process; the kernels are too large for a stack */
    int status = BENCH_DONE;
    if (!o->json)
        printf("%lux%lu, %s, metering and mapping by %u thread%s, %s, to %s, median of %u rounds in turns; ns a pixel\n"
               "                          row_gain_frame (1 thread)     map_rows_with_gains\n"
               "format       meter      map         ns   /meter   of_rows us      ns     /map      all\n",
               (unsigned long)o->width, (unsigned long)o->height, bench_level_names[bench_best_level()],
               workers_count(crew), workers_count(crew) > 1 ? "s" : "", flush ? "cold" : "warm", o->out->name,
               o->rounds ? o->rounds : ROUNDS);
    for (const bench_format *f = bench_formats; f->name && !status; f++) {
        if (!bench_is_measured(o, f))
            continue;
        if (!o->quiet && isatty(STDERR_FILENO))
            fprintf(stderr, "measuring %s ...\r", f->name);
        memset(&r, 0, sizeof r);
        status = open_room(&r, o, f->pixel, crew) ? BENCH_FAILED : race(o, &r, flush);
        close_room(&r);
    }
    return status;
}
