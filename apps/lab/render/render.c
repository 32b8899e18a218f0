/* pupil render: the frames of a scene, as linear pictures or, mapped as `pupil replay` maps, for a display. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/progress.h"
#include "common/report_error.h"
#include "file/sink/picture_sink.h"
#include "frame/pipeline.h"
#include "layers.h"
#include "options/commands.h"
#include "output/pictures.h"
#include "refuse.h"
#include "synth/synth_source.h"

typedef struct render {
    const char *scene;
    const char *out[PICTURES_MOST];
    size_t out_count;
    pupil_source_options source_options;
    int overwrite, quiet;
    unsigned layers; /* 0: only light */

    pupil_source *source;
    pictures linear, display;
    frame_pipeline pipeline; /* for display outputs */
    uint64_t rendered;
    progress progress;
    pupil_why why;
} render;

/* --- the command line --- */

/* Parses a number of frames, and sets `end` after it; -1: no number. */
static int whole(const char *text, char **end, uint64_t *value)
{
    errno = 0;
    *value = strtoull(text, end, 10);
    return *text >= '0' && *text <= '9' && !errno && *value <= UINT64_C(1000000000000) ? 0 : -1;
}

static int parse_frames(const option_value *v)
{
    pupil_source_options *o = &((render *)v->options)->source_options;
    uint64_t a, b;
    char *end;
    if (whole(v->text, &end, &a))
        return option_refuse(v, NULL);
    if (!*end && a) {
        o->frames = a;
        return OPTIONS_RUN;
    }
    if (strncmp(end, "..", 2) != 0 || whole(end + 2, &end, &b) || *end || b < a)
        return option_refuse(v, NULL);
    o->first = a;
    o->frames = b - a + 1;
    return OPTIONS_RUN;
}

static int parse_out(const option_value *v)
{
    render *r = v->options;
    if (!*v->text || r->out_count == PICTURES_MOST - 1)
        return option_refuse(v, "a path, one of at most 16");
    for (size_t i = 0; i < r->out_count; i++)
        if (strcmp(r->out[i], v->text) == 0)
            return option_refuse(v, "named once; each output needs a place of its own");
    r->out[r->out_count++] = v->text;
    return OPTIONS_RUN;
}

static int parse_layers(const option_value *v)
{
    return layers_parse(v->text, &((render *)v->options)->layers) ? option_refuse(v, NULL) : OPTIONS_RUN;
}

#define AT(field) offsetof(render, field)

static const option_row rows[] = {
    {"out", 'o', OPTION_PATH, "PATH", 0, .parse = parse_out,
     .help = "linear: .exr .hdr .pfm one frame, or a folder of EXR; display: .mp4 .mkv .mov .y4m .png .jpg .tif; "
             "repeatable"},
    {"frames", 'n', OPTION_TEXT, "A..B", 0, .parse = parse_frames,
     .right = "A..B with A <= B, or a number of frames, 1 or more",
     .help = "the frames A to B, both included; N: the first N (all; one, where an output is one picture)"},
    {"size", 0, OPTION_SIZE, "WxH", AT(source_options.width), .high = PUPIL_MAX_SIDE_PX,
     .help = "instead of the recipe's"},
    {"fps", 0, OPTION_NUMBER, "N", AT(source_options.fps), .low = 0.001, .high = 1e5, .unit = "frames a second",
     .help = "instead of the recipe's"},
    {"layers", 0, OPTION_TEXT, "NAMES", 0, .parse = parse_layers,
     .right = "one or more of depth, normal, albedo, occlusion and ssao, with commas between",
     .help = "also depth,normal,albedo,occlusion,ssao: further channels of an .exr",
     .more =
         "Of the ray through the middle of each pixel: Z is the depth in metres along the camera's axis, N.X N.Y N.Z "
         "the normal, albedo.R G B the diffuse reflectance; occlusion.Y how open the point is to light from all "
         "around within 0.5 m, by rays, and ssao.Y the same in screen space."},
    OPTION_ROW_THREADS(render, source_options.threads, "0"),
    OPTION_ROW_OVERWRITE(render, overwrite),
    OPTION_ROW_QUIET(render, quiet),
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command render_command = {
    .name = "render",
    .summary = "the frames of a scene: linear pictures, or mapped for a display",
    .usage = "SCENE [options] -o PATH",
    .about = "Renders the frames of a scene: linear light, or mapped for a display as by pupil replay.\n"
             "  SCENE  a recipe by its path, or one that is built in: room, walk, table, candle,\n"
             "         stars, meadow, leds, lamps, room-radiosity",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual = "Renders the frames of a scene: rays from a pinhole, soft shadows, the same bits on every machine. SCENE "
              "is as in synth:SCENE.",
    .groups = groups,
};

/* -1: continue; else the exit status. */
static int parse(render *r, int argc, char **argv)
{
    option_words words;
    const int status = options_read(&render_command, r, argc, argv, &words);
    if (status >= 0)
        return status;
    if (words.count != 1 || !r->out_count) {
        fprintf(stderr, "pupil render: %s; 'pupil render --help' has more\n",
                words.count < 1   ? "no scene: name one, for example room"
                : words.count > 1 ? "more than one scene"
                                  : "no output: -o PATH names one");
        return EXIT_USAGE;
    }
    r->scene = words.word[0];
    if (strncmp(r->scene, "synth:", 6) == 0)
        r->scene += 6;
    return -1;
}

/* --- frames --- */

static int no_memory(render *r)
{
    return pupil_refuse(&r->why, "not enough memory");
}

static int open_outputs(render *r, const pupil_image_const *first)
{
    pupil_sink_options options = {
        .width = first->width, .height = first->height, .fps = r->source->fps, .overwrite = r->overwrite};
    int single;
    for (size_t i = 0; i < r->out_count; i++) {
        if (!pupil_is_linear_path(r->out[i], &single)) {
            if (pictures_open(&r->display, r->out[i], &options, &r->why))
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
    return frame_pipeline_open(&r->pipeline, &config, r->source_options.threads) ? no_memory(r) : 0;
}

static int write_frame(render *r, const pupil_frame *frame)
{
    if (!r->rendered && open_outputs(r, &frame->image))
        return -1;
    if (pictures_write(&r->linear, &frame->image, &frame->info, NULL, &r->why))
        return -1;
    if (!r->display.count)
        return 0;
    if (frame_pipeline_meter(&r->pipeline, frame, &r->why) || frame_pipeline_map(&r->pipeline, frame, 1, &r->why))
        return -1;
    const pupil_image_const shown = pupil_image_as_const(r->pipeline.display);
    return pictures_write(&r->display, &shown, &frame->info, NULL, &r->why);
}

static void show_progress(render *r)
{
    if (!progress_due(&r->progress, 0.1))
        return;
    progress_add(&r->progress, "frame %llu of %llu", (unsigned long long)r->rendered,
                 (unsigned long long)r->progress.total);
    progress_show(&r->progress);
}

static void show_layers(void *context, uint64_t done, uint64_t total)
{
    render *r = context;
    r->rendered = done;
    r->progress.total = total;
    show_progress(r);
}

static int run_layers(render *r)
{
    if (r->out_count != 1)
        return pupil_refuse(&r->why, "--layers: one output, a .exr or a folder of them");
    progress_begin(&r->progress, r->quiet, 0);
    return layers_render(r->scene, &r->source_options, r->layers, r->out[0], r->overwrite, show_layers, r, &r->why);
}

static int run(render *r)
{
    int single;
    r->source_options.stop = interrupt_came;
    if (r->layers)
        return run_layers(r);
    for (size_t i = 0; i < r->out_count && !r->source_options.frames; i++) {
        const char *dot = strrchr(r->out[i], '.');
        const int picture = dot && (strcmp(dot, ".png") == 0 || strcmp(dot, ".jpg") == 0 || strcmp(dot, ".jpeg") == 0 ||
                                    strncmp(dot, ".tif", 4) == 0);
        if ((pupil_is_linear_path(r->out[i], &single) && single) || picture)
            r->source_options.frames = 1;
    }
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
    if (interrupt_came() || pictures_finish(&r->linear, &r->why))
        return -1;
    return pictures_finish(&r->display, &r->why);
}

static void end(render *r)
{
    pictures_discard(&r->linear);
    pictures_discard(&r->display);
    frame_pipeline_close(&r->pipeline);
    pupil_source_close(r->source);
}

int render_main(int argc, char **argv)
{
    static render r; /* one run per process; pupil_t and pupil_stats are too large for a stack */
    const int parsed = parse(&r, argc, argv);
    if (parsed >= 0)
        return parsed;
    interrupt_watch();
    double began_s = progress_now_s();
    int failed = run(&r), interrupted = failed && interrupt_came();
    progress_clear(&r.progress);
    end(&r);
    if (interrupted)
        fprintf(stderr, "pupil render: interrupted\n");
    else if (failed)
        report_error("pupil render", &r.why, "");
    else if (!r.quiet)
        fprintf(stderr, "rendered %llu frame%s in %.1f s\n", (unsigned long long)r.rendered, r.rendered == 1 ? "" : "s",
                progress_now_s() - began_s);
    return interrupted ? EXIT_INTERRUPTED : failed ? EXIT_FAILED : EXIT_DONE;
}
