/* pupil bench kernels: metering and mapping at every level and format, in turns with a plain read and a memcpy of the
 * same bytes; each speed has its error. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"
#include "common/interrupt.h"
#include "common/pixel_light.h"
#include "frames.h"
#include "subject.h"

enum { ROUNDS = 21, MOST_RUNNERS = 2 + BENCH_KERNELS * PUPIL_LEVEL_COUNT };

static void tell_json(const bench_options *o, unsigned threads, const bench_kernel *k, const bench_runner *r,
                      const bench_runner *base, const verify_figures error[2])
{
    const double pixels = (double)o->width * o->height;
    printf("{\"bench\":\"kernels\",\"kernel\":\"%s\",\"level\":\"%s\",\"format\":\"%s\",\"out\":\"%s\",\"width\":%lu,"
           "\"height\":%lu,\"threads\":%u,\"cold\":%s,\"ns_per_px\":%.4f,\"bytes_per_px\":%g,\"ratio_read\":%.4f,"
           "\"ratio_memcpy\":%.4f",
           bench_kernel_names[k->which], bench_level_names[k->level], bench_format_name(k->s->in.pixel),
           k->which == BENCH_METER ? "none" : o->out->name, (unsigned long)o->width, (unsigned long)o->height, threads,
           o->warm ? "false" : "true", r->median_s * 1e9 / pixels, (double)k->s->bytes / pixels,
           r->median_s / base[0].median_s, r->median_s / base[1].median_s);
    for (int hard = 0; hard < 2; hard++)
        printf(",\"%serror_ev\":%.3g,\"%serror_code_max\":%d,\"%soff_by_one\":%.3g", hard ? "hard_" : "",
               log2(1.0 + error[hard].log_average_error), hard ? "hard_" : "", error[hard].code_error,
               hard ? "hard_" : "", (double)error[hard].off / (double)error[hard].samples);
    puts("}");
}

static void tell(const bench_options *o, const bench_kernel *k, const bench_runner *r, const bench_runner *base,
                 const verify_figures error[2])
{
    printf("%-8s %-14s %-7s %8.3f %7.2f %9.2f", bench_format_name(k->s->in.pixel), bench_kernel_names[k->which],
           bench_level_names[k->level], r->median_s * 1e9 / ((double)o->width * o->height),
           r->median_s / base[0].median_s, r->median_s / base[1].median_s);
    for (int hard = 0; hard < 2; hard++)
        printf("  %8.1e %d %.5f%%", error[hard].log_average_error, error[hard].code_error,
               100.0 * (double)error[hard].off / (double)error[hard].samples);
    putchar('\n');
}

int bench_is_measured(const bench_options *o, const bench_format *f)
{
    return o->format ? strcmp(o->format, f->name) == 0 : o->out->step == 1 || pupil_pixel_is_mosaic(f->pixel);
}

/* k has room for MOST_RUNNERS. */
static int race(const bench_options *o, bench_subject *s, bench_kernel *k, const bench_flush *flush)
{
    bench_runner runner[MOST_RUNNERS] = {{.run = bench_read_run, .context = s}, {.run = bench_copy_run, .context = s}};
    verify_figures error[2];
    size_t n = 2;
    for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++)
        for (int which = 0; which < BENCH_KERNELS; which++)
            if (!bench_kernel_open(&k[n], s, (bench_which)which, level)) {
                runner[n] = (bench_runner){.run = bench_kernel_run, .context = &k[n]};
                n++;
            }
    if (bench_race(runner, n, o->rounds ? o->rounds : ROUNDS, flush, interrupt_came))
        return interrupt_came() ? BENCH_INTERRUPTED : BENCH_FAILED;
    for (size_t i = 2; i < n; i++) {
        for (int hard = 0; hard < 2 && k[i].which == BENCH_METER; hard++) /* a level's other kernels share them */
            if (bench_kernel_error(k[i].level, s->in.pixel, o->light, o->out->step, hard, &error[hard]))
                return BENCH_FAILED;
        if (o->json)
            tell_json(o, workers_count(s->crew), &k[i], &runner[i], runner, error);
        else
            tell(o, &k[i], &runner[i], runner, error);
    }
    fflush(stdout);
    return BENCH_DONE;
}

int bench_levels(const bench_options *o, workers *crew, const bench_flush *flush)
{
    static bench_kernel k[MOST_RUNNERS]; /* one run per process; too large for a stack */
    int status = BENCH_DONE;
    if (!o->json)
        printf("%lux%lu, %u thread%s, %s, to %s, median of %u rounds in turns; errors on an easy and on a hard frame:\n"
               "of the log-average (relative), of display samples (codes, share that is off)\n"
               "format   kernel         level      ns/px   /read   /memcpy  easy                   hard\n",
               (unsigned long)o->width, (unsigned long)o->height, workers_count(crew),
               workers_count(crew) > 1 ? "s" : "", flush ? "cold" : "warm", o->out->name,
               o->rounds ? o->rounds : ROUNDS);
    for (const bench_format *f = bench_formats; f->name && !status; f++) {
        bench_subject s;
        if (!bench_is_measured(o, f))
            continue;
        if (!o->quiet && isatty(STDERR_FILENO))
            fprintf(stderr, "measuring %s ...\r", f->name);
        status = bench_subject_open(&s, o, f->pixel, crew) ? BENCH_FAILED : race(o, &s, k, flush);
        bench_subject_close(&s);
    }
    return status;
}
