/* The command line of pupil bench kernels. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"
#include "clock.h"
#include "common/interrupt.h"
#include "frames.h"
#include "output/plot.h"
#include "report/camera_light.h"
#include "subject.h"

static const char help[] =
    "usage: pupil bench kernels [options]\n"
    "Metering and mapping in turns with a plain read and a memcpy of the same bytes.\n"
    "      --peers        beside OpenCV, ffmpeg, libplacebo and plain C, as ratios (one thread)\n"
    "      --worst        how long the slowest frame in a thousand takes: ordinary, denormal and odd\n"
    "                     frames, and memory never touched before\n"
    "      --row-gains    what taking lamps' bands out costs beside metering and mapping, as ratios\n"
    "      --plot FILE    speed against error of each choice, as .svg or .png, by gnuplot (one thread)\n"
    "      --format NAME  one input format (all; the three above: rgba32f)\n"
    "      --out NAME     what is mapped to: rgba8 rgb8 bgrx8 nv12, or half: RGBA8 of half a mosaic's\n"
    "                     width and height (rgba8)\n"
    "      --size WxH     (1920x1080)\n"
    "      --threads N    (1; 0: one a processor)\n"
    "      --rounds N     each is run N times; the median counts (21; --peers 15, --worst 2000)\n"
    "      --warm         with what the turns before left in the caches (else cold; --worst always)\n"
    "      --json         one object a line for each kernel\n"
    "  -q, --quiet        no progress       -h, --help\n"
    "kernels: meter, map, fused (both in one pass), exact (meter, then map), and default (fused,\n"
    "with the histogram that the following white point needs)\n"
    "exit: 0 done, 1 failed, 2 usage, 130 interrupted\n";

static void put_help(void)
{
    int column = 8;
    fputs(help, stdout);
    fputs("formats:", stdout);
    for (const bench_format *f = bench_formats; f->name; f++) {
        if (column + 1 + strlen(f->name) > 95)
            column = printf("\n        ") - 1;
        column += printf(" %s", f->name);
    }
    putchar('\n');
}

static int read_out(const char *text, bench_options *o)
{
    for (o->out = bench_outs; o->out->name; o->out++)
        if (strcmp(text, o->out->name) == 0)
            return 0;
    fprintf(stderr, "pupil bench: --out %s: must be one of", text);
    for (const bench_out *out = bench_outs; out->name; out++)
        fprintf(stderr, " %s", out->name);
    fputc('\n', stderr);
    return -1;
}

/* 0; 1: wrong; -1: nothing more is to be done. */
static int read_option(int option, bench_options *o)
{
    switch (option) {
    case 'p':
        o->peers = 1;
        return 0;
    case 'o':
        o->worst = 1;
        return 0;
    case 'l':
        o->row_gains = 1;
        return 0;
    case 'g':
        o->plot = optarg;
        return 0;
    case 'f':
        o->format = optarg;
        return 0;
    case 'u':
        return read_out(optarg, o) != 0;
    case 's':
        return bench_size(optarg, &o->width, &o->height) != 0;
    case 't':
        return bench_number("threads", optarg, 0, BENCH_MOST_THREADS, &o->threads) != 0;
    case 'r':
        return bench_number("rounds", optarg, 1, 10000, &o->rounds) != 0;
    case 'w':
        o->warm = 1;
        return 0;
    case 'j':
        o->json = 1;
        return 0;
    case 'q':
        o->quiet = 1;
        return 0;
    case 'h':
        put_help();
        return -1;
    default:
        return 1;
    }
}

static int read_options(int argc, char **argv, bench_options *o)
{
    static const struct option known[] = {
        {"peers", 0, NULL, 'p'},     {"worst", 0, NULL, 'o'},   {"plot", 1, NULL, 'g'},   {"format", 1, NULL, 'f'},
        {"size", 1, NULL, 's'},      {"threads", 1, NULL, 't'}, {"rounds", 1, NULL, 'r'}, {"warm", 0, NULL, 'w'},
        {"json", 0, NULL, 'j'},      {"quiet", 0, NULL, 'q'},   {"help", 0, NULL, 'h'},   {"out", 1, NULL, 'u'},
        {"row-gains", 0, NULL, 'l'}, {NULL, 0, NULL, 0}};
    int c, wrong = 0;
    optind = 1;
    while (!wrong && (c = getopt_long(argc, argv, "qh", known, NULL)) != -1)
        wrong = read_option(c, o);
    if (wrong || optind == argc)
        return wrong;
    fprintf(stderr, "pupil bench: %s: kernels are chosen by --format; see --help\n", argv[optind]);
    return 1;
}

/* Whether the formats that are to be measured are known, can have the size, and the output; 0, or -1 and a sentence. */
static int check_formats(const bench_options *o)
{
    int found = 0, mosaics = 0;
    for (const bench_format *f = bench_formats; f->name; f++) {
        const int mosaic = camera_is_mosaic(f->pixel);
        const uint32_t group = f->pixel == PUPIL_PIXEL_BAYER10P ? 4 : mosaic ? 2 : 1;
        if (!bench_is_measured(o, f))
            continue;
        found++;
        mosaics += mosaic;
        if (o->width % group || (mosaic && o->height % 2))
            return fprintf(stderr,
                           "pupil bench: --size %lux%lu: %s has a width that is a multiple of %lu, and an even "
                           "height\n",
                           (unsigned long)o->width, (unsigned long)o->height, f->name, (unsigned long)group),
                   -1;
    }
    if (!found) {
        fprintf(stderr, "pupil bench: --format %s: must be one of", o->format);
        for (const bench_format *f = bench_formats; f->name; f++)
            fprintf(stderr, " %s", f->name);
        fputc('\n', stderr);
        return -1;
    }
    if (o->out->step == 2 && !mosaics)
        return fprintf(stderr, "pupil bench: --out half: %s is no mosaic (bayer8 or the like)\n", o->format), -1;
    return 0;
}

/* What goes together; 0, or -1 and a sentence. */
static int check(const bench_options *o)
{
    const int modes = o->peers + o->worst + (o->plot != NULL);
    if (modes + o->row_gains > 1)
        return fputs("pupil bench: --peers, --worst, --row-gains and --plot are measured one at a time\n", stderr), -1;
    if (o->row_gains && (o->width < BENCH_LEAST_LAMPS_PX || o->height < BENCH_LEAST_LAMPS_PX))
        return fprintf(stderr, "pupil bench: --size %lux%lu: --row-gains takes at least 64x64\n",
                       (unsigned long)o->width, (unsigned long)o->height),
               -1;
    if (modes && o->format && strcmp(o->format, "rgba32f") != 0)
        return fprintf(stderr, "pupil bench: --format %s: --peers, --worst and --plot take rgba32f\n", o->format), -1;
    if (modes && o->out != bench_outs)
        return fprintf(stderr, "pupil bench: --out %s: --peers, --worst and --plot are of rgba8\n", o->out->name), -1;
    if ((o->peers || o->plot) && o->threads != 1)
        return fprintf(stderr, "pupil bench: --threads %u: --peers and --plot are of one thread\n", o->threads), -1;
    if (o->plot && o->json)
        return fputs("pupil bench: --json: --plot draws\n", stderr), -1;
    return modes ? 0 : check_formats(o);
}

int bench_kernels_main(int argc, char **argv)
{
    bench_options o = {.out = bench_outs, .width = 1920, .height = 1080, .threads = 1};
    int status = read_options(argc, argv, &o);
    if (status)
        return status < 0 ? BENCH_DONE : BENCH_USAGE;
    if (check(&o))
        return BENCH_USAGE;
    pupil_why why;
    if (o.plot && pupil_plot_check(o.plot, &why)) {
        fprintf(stderr, "pupil bench: %s\n", why.text);
        return BENCH_FAILED;
    }
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const unsigned every = processors < 1                    ? 1
                           : processors > BENCH_MOST_THREADS ? BENCH_MOST_THREADS
                                                             : (unsigned)processors;
    bench_flush room;
    workers *crew = workers_open(o.threads ? o.threads : every);
    if (!crew || bench_flush_open(&room)) {
        workers_close(crew);
        fputs("pupil bench: not enough memory\n", stderr);
        return BENCH_FAILED;
    }
    const bench_flush *flush = o.warm ? NULL : &room;
    interrupt_watch();
    status = o.peers       ? bench_peers(&o, crew, flush)
             : o.worst     ? bench_worst(&o, crew)
             : o.plot      ? bench_plot(&o, crew, flush)
             : o.row_gains ? bench_lamps(&o, crew, flush)
                           : bench_levels(&o, crew, flush);
    bench_flush_close(&room);
    workers_close(crew);
    return status;
}
