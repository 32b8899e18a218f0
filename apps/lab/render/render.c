/* pupil render: the frames of a scene, as linear pictures or, mapped as `pupil replay` maps, for a display. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "common/interrupt.h"
#include "common/progress.h"
#include "file/sink/linear_sink.h"
#include "frame/frame_work.h"
#include "output/outputs.h"
#include "refuse.h"
#include "synth/synth_source.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_INTERRUPTED = 130 };

static const char help[] = "usage: pupil render SCENE [options] -o PATH\n"
                           "The frames of a scene: linear light, or mapped for a display as 'pupil replay' does.\n"
                           "  SCENE  a recipe by its path, or one that is shipped: room, walk\n"
                           "  -o, --out PATH      linear: .exr .hdr .pfm one frame, or a folder of EXR;\n"
                           "                      display: .mp4 .mkv .mov .y4m .png; repeatable\n"
                           "  -n, --frames A..B   the frames A to B, both included; N: the first N (all;\n"
                           "                      one, where an output is one picture)\n"
                           "      --size WxH      instead of the recipe's      --fps N   likewise\n"
                           "      --threads N     (0: one a processor)         -y, --overwrite   a folder\n"
                           "  -q, --quiet  -h, --help\n"
                           "exit: 0 done, 1 failed, 2 usage, 130 interrupted\n";

typedef struct render {
    const char *scene;
    const char *out[OUTPUTS_MOST];
    size_t out_count;
    pupil_source_options source_options;
    int overwrite, quiet;

    pupil_source *source;
    outputs linear, display;
    workers *workers;
    frame_work *work;
    pupil_t pupil;
    pupil_stats stats;
    unsigned char *rgb8;
    uint64_t rendered;
    progress progress;
    pupil_why why;
} render;

/* --- the command line --- */

static int refuse(render *r, const char *option, const char *text, const char *right)
{
    pupil_refuse(&r->why, "--%s %s: must be %s", option, text, right);
    return -1;
}

static int whole(const char *text, char **end, uint64_t *value)
{
    errno = 0;
    *value = strtoull(text, end, 10);
    return *text >= '0' && *text <= '9' && !errno && *value <= UINT64_C(1000000000000) ? 0 : -1;
}

static int parse_frames(render *r, const char *text)
{
    uint64_t a, b;
    char *end;
    const char *right = "A..B with A <= B, or a number of frames, 1 or more";
    if (whole(text, &end, &a))
        return refuse(r, "frames", text, right);
    if (!*end && a) {
        r->source_options.frames = a;
        return 0;
    }
    if (strncmp(end, "..", 2) != 0 || whole(end + 2, &end, &b) || *end || b < a)
        return refuse(r, "frames", text, right);
    r->source_options.first = a;
    r->source_options.frames = b - a + 1;
    return 0;
}

static int parse_size(render *r, const char *text)
{
    uint64_t width, height;
    char *end;
    if (whole(text, &end, &width) || *end != 'x' || whole(end + 1, &end, &height) || *end || !width || !height ||
        width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return refuse(r, "size", text, "WIDTHxHEIGHT, for example 640x360, each from 1 to 16384");
    r->source_options.width = (uint32_t)width;
    r->source_options.height = (uint32_t)height;
    return 0;
}

static int parse_number(render *r, int option, const char *text)
{
    char *end;
    uint64_t threads;
    if (option == 't') {
        if (whole(text, &end, &threads) || *end || threads > 256)
            return refuse(r, "threads", text, "from 0 (one a processor) to 256");
        r->source_options.threads = (unsigned)threads;
        return 0;
    }
    r->source_options.fps = strtod(text, &end);
    if (end == text || *end || !(r->source_options.fps >= 0.001 && r->source_options.fps <= 1e5))
        return refuse(r, "fps", text, "frames a second, from 0.001 to 100000");
    return 0;
}

static int parse_out(render *r, const char *text)
{
    if (!*text || r->out_count == OUTPUTS_MOST - 1)
        return refuse(r, "out", text, "a path, one of at most 16");
    for (size_t i = 0; i < r->out_count; i++)
        if (strcmp(r->out[i], text) == 0)
            return refuse(r, "out", text, "named once; each output needs a place of its own");
    r->out[r->out_count++] = text;
    return 0;
}

static int take(render *r, int option, const char *text)
{
    switch (option) {
    case 'o':
        return parse_out(r, text);
    case 'n':
        return parse_frames(r, text);
    case 's':
        return parse_size(r, text);
    case 'y':
        r->overwrite = 1;
        return 0;
    case 'q':
        r->quiet = 1;
        return 0;
    default:
        return parse_number(r, option, text);
    }
}

/* 0; 1 where help was asked for; -1 and a sentence. */
static int parse(render *r, int argc, char **argv)
{
    static const struct option long_options[] = {{"out", required_argument, NULL, 'o'},
                                                 {"frames", required_argument, NULL, 'n'},
                                                 {"size", required_argument, NULL, 's'},
                                                 {"fps", required_argument, NULL, 'f'},
                                                 {"threads", required_argument, NULL, 't'},
                                                 {"overwrite", no_argument, NULL, 'y'},
                                                 {"quiet", no_argument, NULL, 'q'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {NULL, 0, NULL, 0}};
    int option;
    optind = 1;
    opterr = 0;
    while ((option = getopt_long(argc, argv, "o:n:yqh", long_options, NULL)) != -1) {
        if (option == 'h')
            return 1;
        if (option == '?') {
            pupil_refuse(&r->why, "%s: no such option, or its value is missing; 'pupil render --help' lists them",
                         argv[optind - 1]);
            return -1;
        }
        if (take(r, option, optarg))
            return -1;
    }
    if (argc - optind != 1 || !r->out_count) {
        pupil_refuse(&r->why, "%s; 'pupil render --help' tells more",
                     argc - optind < 1   ? "no scene: name one, for example room"
                     : argc - optind > 1 ? "more than one scene"
                                         : "no output: -o PATH names one");
        return -1;
    }
    r->scene = argv[optind];
    if (strncmp(r->scene, "synth:", 6) == 0)
        r->scene += 6;
    return 0;
}

/* --- frames --- */

static int no_memory(render *r)
{
    pupil_refuse(&r->why, "not enough memory");
    return -1;
}

static int open_outputs(render *r, const pupil_image_const *first)
{
    pupil_sink_options options = {
        .width = first->width, .height = first->height, .fps = r->source->fps, .overwrite = r->overwrite};
    int single;
    for (size_t i = 0; i < r->out_count; i++) {
        if (!pupil_is_linear_path(r->out[i], &single)) {
            if (outputs_open(&r->display, r->out[i], &options, &r->why))
                return -1;
        } else {
            if (pupil_linear_sink_open(r->out[i], &options, &r->linear.sink[r->linear.count], &r->why))
                return -1;
            r->linear.count++;
        }
    }
    if (!r->display.count)
        return 0;
    pupil_config config;
    pupil_config_default(&config);
    pupil_init(&r->pupil, &config);
    r->workers = workers_open(r->source_options.threads);
    r->work = r->workers ? frame_work_open(r->workers) : NULL;
    r->rgb8 = malloc((size_t)first->width * first->height * 3);
    return r->work && r->rgb8 ? 0 : no_memory(r);
}

static int write_frame(render *r, const pupil_frame *frame)
{
    if (!r->rendered && open_outputs(r, &frame->image))
        return -1;
    if (outputs_write(&r->linear, &frame->image, &frame->info, &r->why))
        return -1;
    if (!r->display.count)
        return 0;
    pupil_image out = {.data = r->rgb8,
                       .stride_bytes = (ptrdiff_t)frame->image.width * 3,
                       .width = frame->image.width,
                       .height = frame->image.height,
                       .pixel = PUPIL_PIXEL_RGB8};
    pupil_image_const shown = pupil_image_as_const(out);
    pupil_curve curve;
    int error = frame_work_process(r->work, &r->pupil, 0, &frame->image, &frame->info, &out, &r->stats, &curve);
    if (error) {
        pupil_refuse(&r->why, "%s: %s", frame->name, pupil_error_string(error));
        return -1;
    }
    return outputs_write(&r->display, &shown, &frame->info, &r->why);
}

static void show_progress(render *r)
{
    double now_s = progress_now_s();
    if (!r->progress.shown || now_s - r->progress.last_s < 0.1)
        return;
    r->progress.last_s = now_s;
    r->progress.line_open = 1;
    fprintf(stderr, "\r\033[Kframe %llu of %llu", (unsigned long long)r->rendered,
            (unsigned long long)r->progress.total);
    fflush(stderr);
}

static int run(render *r)
{
    int single;
    for (size_t i = 0; i < r->out_count && !r->source_options.frames; i++) {
        const char *dot = strrchr(r->out[i], '.');
        if ((pupil_is_linear_path(r->out[i], &single) && single) || (dot && strcmp(dot, ".png") == 0))
            r->source_options.frames = 1;
    }
    r->source_options.stop = interrupt_came;
    if (pupil_synth_source_open(r->scene, &r->source_options, &r->source, &r->why))
        return -1;
    progress_begin(&r->progress, r->quiet, r->source->frames);
    while (!interrupt_came()) {
        pupil_frame frame;
        int got = pupil_source_next(r->source, &frame, &r->why);
        if (got == PUPIL_SOURCE_END)
            break;
        if (got != PUPIL_SOURCE_FRAME || write_frame(r, &frame))
            return -1;
        r->rendered++;
        show_progress(r);
        pupil_source_done(r->source, &frame);
    }
    if (interrupt_came() || outputs_finish(&r->linear, &r->why))
        return -1;
    return outputs_finish(&r->display, &r->why);
}

static void end(render *r)
{
    outputs_discard(&r->linear);
    outputs_discard(&r->display);
    frame_work_close(r->work);
    workers_close(r->workers);
    pupil_source_close(r->source);
    free(r->rgb8);
}

int render_main(int argc, char **argv)
{
    static render r; /* one run a process; pupil_t and pupil_stats are large for a stack */
    int parsed = parse(&r, argc, argv);
    if (parsed > 0) {
        fputs(help, stdout);
        return EXIT_DONE;
    }
    if (parsed < 0) {
        fprintf(stderr, "pupil render: %s\n", r.why.text);
        return EXIT_USAGE;
    }
    interrupt_watch();
    double began_s = progress_now_s();
    int failed = run(&r), interrupted = failed && interrupt_came();
    progress_clear(&r.progress);
    end(&r);
    if (interrupted)
        fprintf(stderr, "pupil render: interrupted\n");
    else if (failed)
        fprintf(stderr, "pupil render: %s\n", r.why.text);
    else if (!r.quiet)
        fprintf(stderr, "rendered %llu frames in %.1f s\n", (unsigned long long)r.rendered, progress_now_s() - began_s);
    return interrupted ? EXIT_INTERRUPTED : failed ? EXIT_FAILED : EXIT_DONE;
}
