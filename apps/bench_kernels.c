/* pupil bench kernels: metering and mapping at every level, format and number of threads, in turns with a plain read
 * and a memcpy of the same bytes; beside each speed its error. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"
#include "bench_clock.h"
#include "bench_frames.h"
#include "bench_plain.h"
#include "interrupt.h"
#include "verify.h"
#include "workers.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_INTERRUPTED = 130 };
enum { KERNELS = 5, MOST_RUNNERS = 2 + 2 + KERNELS * PUPIL_LEVEL_COUNT, FORMATS = 7 };

static const char help[] = "usage: pupil bench kernels [options]\n"
                           "Metering and mapping in turns with a plain read and a memcpy of the same bytes.\n"
                           "      --format NAME  rgba32f rgb32f rgba16f rgba16 rgb16 rgba8 rgb8 (all)\n"
                           "      --size WxH     (1920x1080)\n"
                           "      --threads N    (1; 0: one a processor)\n"
                           "      --rounds N     each is run N times; the median counts (21)\n"
                           "      --warm         with what the turns before left in the caches (else cold)\n"
                           "      --json         one object a line for each kernel\n"
                           "  -q, --quiet        no progress       -h, --help\n"
                           "kernels: meter, map (to RGBA8), fused (both in one pass), exact (meter, then map), and\n"
                           "default (fused, with the histogram that the following white point needs)\n"
                           "exit: 0 done, 1 failed, 2 usage, 130 interrupted\n";

static const char *const kernel_name[KERNELS] = {"meter", "map", "fused", "exact", "default"};
static const char *const level_name[PUPIL_LEVEL_COUNT] = {"scalar", "neon", "avx2", "avx512"};

typedef struct options {
    const char *format;
    uint32_t width, height;
    unsigned threads, rounds;
    int warm, json, quiet;
} options;

/* ---- one kernel ----------------------------------------------------------------------------------------------------
 */

typedef struct subject { /* what all of a format's runners share */
    const options *o;
    workers *crew;
    pupil_image_const in;
    pupil_image out;
    unsigned char *copy;
    size_t bytes;
    unsigned long long seen;
    pupil_curve curve;
} subject;

typedef struct kernel {
    subject *s;
    int which;
    uint32_t level;
    pupil_t pupil;
    pupil_stats stats[64]; /* one a worker */
    bench_plain *plain;
} kernel;

static void part_of(const subject *s, unsigned worker, unsigned count, pupil_image_const *in, pupil_image *out,
                    uint32_t *first)
{
    const uint32_t begin = s->in.height * worker / count, end = s->in.height * (worker + 1) / count;
    *first = begin;
    *in = pupil_image_rows(s->in, begin, end - begin);
    *out = s->out;
    out->data = (unsigned char *)s->out.data + (ptrdiff_t)begin * s->out.stride_bytes;
    out->height = end - begin;
}

static void work(void *context, unsigned worker, unsigned count)
{
    kernel *k = context;
    subject *s = k->s;
    pupil_image_const in;
    pupil_image out;
    uint32_t first;
    part_of(s, worker, count, &in, &out, &first);
    if (!in.height)
        return;
    pupil_stats *stats = &k->stats[worker];
    pupil_stats_clear(stats);
    if (k->which == 0 || k->which == 3)
        pupil_meter_rows(&k->pupil, &in, first, s->in.height, stats);
    if (k->which == 1 || k->which == 3)
        pupil_map_rows(&k->pupil, &s->curve, &in, &out);
    if (k->which == 2 || k->which == 4)
        pupil_fused_rows(&k->pupil, &s->curve, &in, first, s->in.height, &out, stats);
}

static void run_kernel(void *context)
{
    kernel *k = context;
    workers_run(k->s->crew, work, k);
}

static void run_plain(void *context)
{
    kernel *k = context;
    subject *s = k->s;
    k->plain(s->in.data, (size_t)s->in.width * s->in.height, 4.0f, s->out.data);
}

static void read_part(void *context, unsigned worker, unsigned count)
{
    subject *s = context;
    const size_t lines = s->bytes / 64, begin = lines * worker / count, end = lines * (worker + 1) / count;
    unsigned long long seen = bench_read((const unsigned char *)s->in.data + begin * 64, (end - begin) * 64);
    if (worker == 0)
        s->seen += seen;
}

static void run_read(void *context)
{
    workers_run(((subject *)context)->crew, read_part, context);
}

static void copy_part(void *context, unsigned worker, unsigned count)
{
    subject *s = context;
    const size_t begin = s->bytes * worker / count, end = s->bytes * (worker + 1) / count;
    memcpy(s->copy + begin, (const unsigned char *)s->in.data + begin, end - begin);
}

static void run_copy(void *context)
{
    workers_run(((subject *)context)->crew, copy_part, context);
}

static void configure(pupil_config *c, int which)
{
    pupil_config_default(c);
    c->white_mode = which == 4 ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_FIXED;
    c->white = 4.0;
}

/* ---- its error -----------------------------------------------------------------------------------------------------
 */

/* Of a level on a frame like the one that is timed, or a hard one; small, for the reference is slow. */
static int measure_error(uint32_t level, uint32_t pixel, int hard, verify_figures *f)
{
    pupil_config c;
    pupil_t pupil;
    pupil_stats stats;
    pupil_curve curve;
    pupil_image_const in = bench_frame(pixel, 480, 270, hard);
    pupil_image out = {
        .data = malloc(480 * 270 * 3), .stride_bytes = 480 * 3, .width = 480, .height = 270, .pixel = PUPIL_PIXEL_RGB8};
    *f = (verify_figures){0};
    configure(&c, 0);
    c.levels = 1u << level;
    int failed = !in.data || !out.data || pupil_init(&pupil, &c);
    if (!failed) {
        const pupil_image_const mapped = pupil_image_as_const(out);
        failed = pupil_process(&pupil, &in, NULL, &out) || pupil_get_stats(&pupil, &stats) ||
                 pupil_get_curve(&pupil, NULL, &curve);
        if (!failed)
            verify_frame(f, &c, &in, &curve, &mapped, &stats);
    }
    free((void *)(uintptr_t)in.data);
    free(out.data);
    return failed;
}

/* ---- a format ------------------------------------------------------------------------------------------------------
 */

static void tell(const subject *s, const options *o, uint32_t pixel, const char *name, const char *level,
                 const bench_runner *r, const bench_runner *base, const verify_figures error[2])
{
    const double pixels = (double)o->width * o->height, ns = r->median_s * 1e9 / pixels;
    const double bytes = (double)pupil_pixel_bytes(pixel);
    (void)s;
    if (o->json) {
        printf(
            "{\"bench\":\"kernels\",\"kernel\":\"%s\",\"level\":\"%s\",\"format\":\"%s\",\"out\":\"%s\",\"width\":%lu,"
            "\"height\":%lu,\"threads\":%u,\"cold\":%s,\"ns_per_px\":%.4f,\"bytes_per_px\":%g,\"ratio_read\":%.4f,"
            "\"ratio_memcpy\":%.4f",
            name, level, bench_format_names[pixel - 1], strcmp(name, "meter") == 0 ? "none" : "rgba8",
            (unsigned long)o->width, (unsigned long)o->height, workers_count(s->crew), o->warm ? "false" : "true", ns,
            bytes, r->median_s / base[0].median_s, r->median_s / base[1].median_s);
        for (int hard = 0; error && hard < 2; hard++)
            printf(",\"%serror_ev\":%.3g,\"%serror_code_max\":%d,\"%soff_by_one\":%.3g", hard ? "hard_" : "",
                   log2(1.0 + error[hard].log_average_error), hard ? "hard_" : "", error[hard].code_error,
                   hard ? "hard_" : "", (double)error[hard].off / (double)error[hard].samples);
        puts("}");
        return;
    }
    printf("%-8s %-8s %-7s %8.3f %7.2f %9.2f", bench_format_names[pixel - 1], name, level, ns,
           r->median_s / base[0].median_s, r->median_s / base[1].median_s);
    for (int hard = 0; error && hard < 2; hard++)
        printf("  %8.1e %d %.5f%%", error[hard].log_average_error, error[hard].code_error,
               100.0 * (double)error[hard].off / (double)error[hard].samples);
    putchar('\n');
}

/* 0, or the exit status. */
static int race(subject *s, const options *o, uint32_t pixel, kernel *k, const bench_flush *flush)
{
    bench_runner runner[MOST_RUNNERS] = {{run_read, s, 0, 0}, {run_copy, s, 0, 0}};
    static bench_plain *const plain[2] = {bench_plain_usual, bench_plain_fast};
    size_t n = 2;
    for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++)
        for (int which = 0; which < KERNELS; which++) {
            kernel *one = &k[n];
            pupil_config c;
            uint32_t got;
            configure(&c, which);
            c.levels = 1u << level;
            if (pupil_init(&one->pupil, &c) || pupil_get_level(&one->pupil, &got) || got != level)
                continue;
            one->s = s;
            one->which = which;
            one->level = level;
            runner[n++] = (bench_runner){run_kernel, one, 0, 0};
        }
    const size_t own = n;
    for (int i = 0; i < 2 && pixel == PUPIL_PIXEL_RGBA32F && workers_count(s->crew) == 1; i++) {
        k[n].s = s;
        k[n].plain = plain[i];
        runner[n] = (bench_runner){run_plain, &k[n], 0, 0};
        n++;
    }
    if (bench_race(runner, n, o->rounds, flush, interrupt_came))
        return interrupt_came() ? EXIT_INTERRUPTED : EXIT_FAILED;
    verify_figures error[2];
    for (size_t i = 2; i < own; i++) {
        if (k[i].which == 0 &&
            (measure_error(k[i].level, pixel, 0, &error[0]) || measure_error(k[i].level, pixel, 1, &error[1])))
            return EXIT_FAILED;
        tell(s, o, pixel, kernel_name[k[i].which], level_name[k[i].level], &runner[i], runner, error);
    }
    for (size_t i = own; i < n; i++)
        tell(s, o, pixel, i == own ? "plain" : "plain-fast", "C", &runner[i], runner, NULL);
    fflush(stdout);
    return EXIT_DONE;
}

static int bench_format(const options *o, uint32_t pixel, workers *crew, const bench_flush *flush)
{
    subject s = {.o = o, .crew = crew, .in = bench_frame(pixel, o->width, o->height, 0)};
    s.bytes = (size_t)o->width * o->height * pupil_pixel_bytes(pixel);
    s.copy = aligned_alloc(64, (s.bytes + 63) / 64 * 64);
    s.out = (pupil_image){.data = aligned_alloc(64, ((size_t)o->width * o->height * 4 + 63) / 64 * 64),
                          .stride_bytes = (ptrdiff_t)o->width * 4,
                          .width = o->width,
                          .height = o->height,
                          .pixel = PUPIL_PIXEL_RGBA8};
    kernel *k = calloc(MOST_RUNNERS, sizeof *k);
    int status = EXIT_FAILED;
    pupil_config c;
    pupil_t pupil;
    configure(&c, 0);
    if (s.in.data && s.copy && s.out.data && k && !pupil_init(&pupil, &c) &&
        !pupil_process(&pupil, &s.in, NULL, &s.out) && !pupil_get_curve(&pupil, NULL, &s.curve)) {
        memset(s.copy, 0, s.bytes);
        status = race(&s, o, pixel, k, flush);
    } else {
        fprintf(stderr, "pupil bench: not enough memory for frames of %lux%lu pixels\n", (unsigned long)o->width,
                (unsigned long)o->height);
    }
    free(k);
    free(s.out.data);
    free(s.copy);
    free((void *)(uintptr_t)s.in.data);
    return status;
}

/* ---- the command ---------------------------------------------------------------------------------------------------
 */

static int number(const char *option, const char *text, unsigned long least, unsigned long most, unsigned *value)
{
    char *end;
    unsigned long n = strtoul(text, &end, 10);
    if (*end || end == text || *text == '-' || n < least || n > most) {
        fprintf(stderr, "pupil bench: --%s %s: must be a whole number from %lu to %lu\n", option, text, least, most);
        return -1;
    }
    *value = (unsigned)n;
    return 0;
}

/* 0; else the exit status, less 1 for EXIT_DONE. */
static int read_options(int argc, char **argv, options *o)
{
    static const struct option known[] = {{"format", 1, NULL, 'f'}, {"size", 1, NULL, 's'}, {"threads", 1, NULL, 't'},
                                          {"rounds", 1, NULL, 'r'}, {"warm", 0, NULL, 'w'}, {"json", 0, NULL, 'j'},
                                          {"quiet", 0, NULL, 'q'},  {"help", 0, NULL, 'h'}, {NULL, 0, NULL, 0}};
    int c;
    char after;
    optind = 1;
    while ((c = getopt_long(argc, argv, "qh", known, NULL)) != -1) {
        int wrong = 0;
        switch (c) {
        case 'f':
            o->format = optarg;
            break;
        case 's':
            if (sscanf(optarg, "%5ux%5u%c", &o->width, &o->height, &after) != 2 || !o->width || !o->height ||
                o->width > PUPIL_MAX_SIDE_PX || o->height > PUPIL_MAX_SIDE_PX) {
                fprintf(stderr, "pupil bench: --size %s: must be WxH, each from 1 to %u\n", optarg, PUPIL_MAX_SIDE_PX);
                wrong = 1;
            }
            break;
        case 't':
            wrong = number("threads", optarg, 0, 64, &o->threads);
            break;
        case 'r':
            wrong = number("rounds", optarg, 1, 10000, &o->rounds);
            break;
        case 'w':
            o->warm = 1;
            break;
        case 'j':
            o->json = 1;
            break;
        case 'q':
            o->quiet = 1;
            break;
        case 'h':
            fputs(help, stdout);
            return -1;
        default:
            wrong = 1;
        }
        if (wrong)
            return EXIT_USAGE;
    }
    if (optind < argc) {
        fprintf(stderr, "pupil bench: %s: kernels are chosen by --format; see --help\n", argv[optind]);
        return EXIT_USAGE;
    }
    return 0;
}

int bench_kernels_main(int argc, char **argv)
{
    options o = {.width = 1920, .height = 1080, .threads = 1, .rounds = 21};
    int status = read_options(argc, argv, &o), found = 0;
    if (status)
        return status < 0 ? EXIT_DONE : status;
    for (int i = 0; i < FORMATS; i++)
        found += !o.format || strcmp(o.format, bench_format_names[i]) == 0;
    if (!found) {
        fprintf(stderr, "pupil bench: --format %s: must be one of rgba32f rgb32f rgba16f rgba16 rgb16 rgba8 rgb8\n",
                o.format);
        return EXIT_USAGE;
    }
    bench_flush flush;
    workers *crew = workers_open(o.threads);
    if (!crew || bench_flush_open(&flush)) {
        fputs("pupil bench: not enough memory\n", stderr);
        return EXIT_FAILED;
    }
    interrupt_watch();
    if (!o.json)
        printf("%lux%lu, %u thread%s, %s, median of %u rounds in turns; errors on an easy and on a hard frame: of the\n"
               "log-average (relative), of display samples (codes, share that is off)\n"
               "format   kernel   level      ns/px   /read   /memcpy  easy                   hard\n",
               (unsigned long)o.width, (unsigned long)o.height, workers_count(crew), workers_count(crew) > 1 ? "s" : "",
               o.warm ? "warm" : "cold", o.rounds);
    for (int i = 0; i < FORMATS && !status; i++) {
        if (o.format && strcmp(o.format, bench_format_names[i]) != 0)
            continue;
        if (!o.quiet && isatty(STDERR_FILENO))
            fprintf(stderr, "measuring %s ...\r", bench_format_names[i]);
        status = bench_format(&o, (uint32_t)i + 1, crew, o.warm ? NULL : &flush);
    }
    bench_flush_close(&flush);
    workers_close(crew);
    return status;
}
