/* The command line of pupil bench kernels. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"
#include "camera.h"
#include "clock.h"
#include "common/interrupt.h"
#include "common/pixel_light.h"
#include "common/report_error.h"
#include "frames.h"
#include "output/plot.h"
#include "subject.h"

static int parse_out(const option_value *v)
{
    bench_options *o = v->options;
    for (const bench_out *out = bench_outs; out->name; out++)
        if (strcmp(v->text, out->name) == 0) {
            o->out = out;
            return OPTIONS_RUN;
        }
    return option_refuse(v, NULL);
}

static int parse_format(const option_value *v)
{
    bench_options *o = v->options;
    o->format = v->text;
    return bench_format_named(v->text) ? OPTIONS_RUN : option_refuse(v, NULL);
}

static int parse_light(const option_value *v)
{
    static const char *const names[PUPIL_LIGHT_COUNT] = {"srgb", [PUPIL_LIGHT_PQ] = "pq", [PUPIL_LIGHT_HLG] = "hlg"};
    bench_options *o = v->options;
    for (o->light = PUPIL_LIGHT_DEFAULT; o->light < PUPIL_LIGHT_COUNT; o->light++) /* the default is sRGB there */
        if (names[o->light] && strcmp(v->text, names[o->light]) == 0)
            return OPTIONS_RUN;
    return option_refuse(v, NULL);
}

#define AT(field) offsetof(bench_options, field)

static const option_row rows[] = {
    {"peers", 0, OPTION_FLAG, NULL, AT(peers),
     .help = "compared with OpenCV, ffmpeg, libplacebo and plain C, as ratios (one thread)",
     .more = "fused and exact take turns with the peers that were built in (-DPUPIL_BENCH_PEERS=ON)."},
    {"worst", 0, OPTION_FLAG, NULL, AT(worst),
     .help = "the slowest frame in a thousand: ordinary, denormal and odd frames, and memory never touched before",
     .more = "The median and the slowest of 2000 fused frames: ordinary, hard, dark, denormal, NaN and infinite ones, "
             "and with an output that was never touched before."},
    {"row-gains", 0, OPTION_FLAG, NULL, AT(row_gains),
     .help = "the cost of pupil run --row-gains relative to metering and mapping"},
    {"plot", 0, OPTION_PATH, "FILE", AT(plot),
     .help = "speed and error of each choice, as .svg or .png, by gnuplot (one thread)",
     .more = "Choices: every row or some of them, fused or in two passes, ways to encode. Also prints the same."},
    OPTION_ROW_OVERWRITE(bench_options, overwrite),
    {"format", 0, OPTION_CHOICE, "NAME", 0, .parse = parse_format, .words = BENCH_FORMAT_WORDS,
     .help = "one input format (all; --peers, --worst and --plot: rgba32f)"},
    {"light", 0, OPTION_CHOICE, "NAME", 0, .parse = parse_light, .words = "srgb|pq|hlg", .initial = "srgb",
     .help = "what the codes of --format p010, i420-10, i444-16, rgb10a2 or another Y'CbCr format represent"},
    {"out", 0, OPTION_CHOICE, "NAME", 0, .parse = parse_out,
     .words = "rgba8|rgb8|bgrx8|bgr8|nv12|half|i420|rgba32f|rgb32f|rgba16f|rgb16f", .initial = "rgba8",
     .help = "output format; half is RGBA8 of half a mosaic's width and height"},
    {"size", 0, OPTION_SIZE, "WxH", AT(width), .high = PUPIL_MAX_SIDE_PX, .initial = "1920x1080",
     .help = "of the frames"},
    {"threads", 0, OPTION_COUNT32, "N", AT(threads), .high = BENCH_MOST_THREADS, .initial = "1",
     .help = "worker threads, 0: one a processor"},
    {"rounds", 0, OPTION_COUNT32, "N", AT(rounds), .low = 1, .high = 10000,
     .help = "each is run N times; the median counts (21; --peers 15, --worst 2000)"},
    {"warm", 0, OPTION_FLAG, NULL, AT(warm), .help = "do not flush the caches before each turn (--worst never does)"},
    OPTION_ROW_JSON(bench_options, json, "one object a line for each kernel"),
    OPTION_ROW_QUIET(bench_options, quiet),
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command bench_kernels_command = {
    .name = "bench kernels",
    .summary = "metering and mapping at every level, format and number of threads; their errors",
    .usage = "[options]",
    .about = "Metering and mapping, in turns with a plain read and a memcpy of the same bytes.",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual =
        "Measures metering and mapping at every level that this CPU has, in turns with a plain read and a memcpy "
        "of the same bytes. Kernels: meter, map, fused (both in one pass), exact (meter, then map), "
        "config-default (what pupil_config_default gives: exact, with the histogram that a following white point "
        "needs), fused+white (fused, with it), fused+every (the same, counting every pixel) and curve (fused, by a "
        "table of knots: --tone adjust); of 8-bit Y'CbCr also luma (fused+white by PUPIL_ACCURACY_LUMA). Errors are "
        "those of the log-average "
        "against long double, and of display samples against double, on an easy and on a hard frame.\n\n"
        "Formats: floats, half, 16 and 8 bit, and cameras' formats (yuyv, uyvy, nv12, nv21, nv16, i420, grey8 to "
        "grey16, bayer8 to bayer16, bayer10p, bayer12p) among them.",
    .instead = "choose kernels by --format",
    .groups = groups,
};

/* Whether the formats that are to be measured can have the size, and the output; 0, or -1 and a sentence. */
static int check_formats(const bench_options *o)
{
    int mosaics = 0;
    for (const bench_format *f = bench_formats; f->name; f++) {
        const int mosaic = pupil_pixel_is_mosaic(f->pixel);
        const uint32_t group = f->pixel == PUPIL_PIXEL_BAYER10P ? 4 : mosaic ? 2 : 1;
        if (!bench_is_measured(o, f))
            continue;
        mosaics += mosaic;
        if (o->width % group || (mosaic && o->height % 2))
            return fprintf(stderr,
                           "pupil bench: --size %lux%lu: %s has a width that is a multiple of %lu, and an even "
                           "height\n",
                           (unsigned long)o->width, (unsigned long)o->height, f->name, (unsigned long)group),
                   -1;
    }
    if (o->out->step == 2 && !mosaics)
        return fprintf(stderr, "pupil bench: --out half: %s is not a mosaic (bayer8 or the like)\n", o->format), -1;
    return 0;
}

/* Checks which options exclude each other; 0, or -1 and a sentence. */
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
    const uint32_t pixel = o->format ? bench_format_named(o->format) : PUPIL_PIXEL_NONE;
    if (o->light && !bench_is_yuv(pixel) && pixel != PUPIL_PIXEL_RGB10A2)
        return fputs("pupil bench: --light: takes --format p010, i420-10, i444-16, rgb10a2 or another Y'CbCr format\n",
                     stderr),
               -1;
    return modes ? 0 : check_formats(o);
}

int bench_kernels_main(int argc, char **argv)
{
    bench_options o = {.out = bench_outs, .width = 1920, .height = 1080, .threads = 1};
    option_words words;
    int status = options_read(&bench_kernels_command, &o, argc, argv, &words);
    if (status >= 0)
        return status;
    if (check(&o))
        return BENCH_USAGE;
    pupil_why why;
    if (o.plot && pupil_plot_check(o.plot, o.overwrite, &why)) {
        report_error("pupil bench", &why, "");
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
