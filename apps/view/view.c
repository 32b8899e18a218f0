/* The window of replay and of a live run: pace, keys, and what is drawn. */
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "common/font.h"
#include "common/interrupt.h"
#include "common/progress.h"
#include "frame/gl_calls.h"
#include "keys.h"
#include "paint.h"
#include "picture.h"
#include "plot.h"
#include "pupil/look.h"
#include "refuse.h"
#include "window/window.h"

#define SAID_S     2.0  /* how long a key's message is shown */
#define TITLE_S    0.5  /* between two updates of the title */
#define LOST_S     0.5  /* frames later than this reset the clock, instead of being caught up with */
#define LEAST_S    0.1  /* a late frame is shown nevertheless if none was shown for so long */
#define SPLIT_STEP 0.05 /* of the width */
#define EDGE_CODES 200  /* steps of 50 codes from one pixel to the next; noise and soft edges have fewer */
#define WHITE      0xF0F0F0ffu
#define SHADE      0x000000b8u

struct view {
    view_of of;
    pupil_window *window;
    gl_calls gl;
    view_paint *paint;
    view_picture picture; /* for frames that the CPU maps */
    view_plot plot;

    const pupil_frame *frame; /* the shown frame; NULL: it was returned to the source */
    int is_mapped;            /* pipeline.display is this frame in full size, mapped by `curve` */
    int was_mapped;           /* is_mapped of the frame before, when it was done */
    pupil_frame_info info;
    pupil_curve curve;
    pupil_t first; /* adapted to the first frame only: for the left of the split */
    int first_known;

    double anchor_s, drawn_s, said_s, titled_s; /* times of: timestamp 0, the last drawing, words, title */
    unsigned drawn;                             /* frames since the last title */
    int anchored, paused, stale, quit;
    int fullscreen, split_on, plot_on, help_on, edges_on;
    uint8_t *marked; /* the picture with its edges */
    size_t marked_bytes;
    float split;
    char said[128];
};

/* --- drawing --- */

/* Shows the picture in memory, with its edges if they are asked for and memory suffices. */
static void take_picture(view *v, const pupil_image_const *shown)
{
    static const uint8_t pink[3] = {255, 0, 128};
    const size_t row = (size_t)3 * shown->width, bytes = row * shown->height;
    if (v->edges_on && v->marked_bytes < bytes) {
        free(v->marked);
        v->marked = malloc(bytes);
        v->marked_bytes = v->marked ? bytes : 0;
    }
    const pupil_image marked = {.data = v->marked,
                                .stride_bytes = (ptrdiff_t)row,
                                .width = shown->width,
                                .height = shown->height,
                                .pixel = shown->pixel};
    const pupil_image_const as_const = pupil_image_as_const(marked);
    const int has_edges = v->edges_on && v->marked && !pupil_mark_edges(shown, EDGE_CODES, pink, &marked, NULL);
    view_picture_take(&v->picture, has_edges ? &as_const : shown);
}

/* Draws a part of the picture mapped by `curve`, with the engine that maps the frames; with edges, on the CPU. */
static void draw_part(view *v, const pupil_curve *curve, uint32_t width, uint32_t height, float from, float to)
{
    const pupil_gles_target target = {.width = width, .height = height, .from = from, .to = to};
    frame_pipeline *p = v->of.pipeline;
    if (from >= to) /* the divide is at an edge; pupil_gles_target takes 0 and 0 for all */
        return;
    if (!v->edges_on && frame_pipeline_draw(p, curve, &target) == 0)
        return;
    const int is_mapped = v->is_mapped && curve == &v->curve;
    if (is_mapped || (v->frame && frame_pipeline_map_again(p, curve, v->frame) == 0)) {
        const pupil_image_const shown = pupil_image_as_const(p->display);
        take_picture(v, &shown);
        v->is_mapped = curve == &v->curve; /* false: another curve's picture has overwritten it */
    }
    view_picture_draw(&v->picture, width, height, from, to);
}

static void paint_words(view *v, float x, float y, float scale, const char *words)
{
    const float margin = 4.0f * scale, width = view_paint_text_width(scale, words);
    float lines = 1.0f;
    for (const char *c = words; *c; c++)
        lines += *c == '\n';
    view_paint_box(v->paint, x, y, width + 2.0f * margin, (FONT_LINE * lines - 3.0f) * scale + 2.0f * margin, SHADE);
    view_paint_text(v->paint, x + margin, y + margin, scale, WHITE, words);
}

static void paint_split(view *v, float width, float height, float scale)
{
    const float at = floorf(width * v->split), y = height - 24.0f * scale;
    view_paint_box(v->paint, at - 0.5f * scale, 0.0f, scale, height, WHITE);
    if (!v->plot_on) {
        paint_words(v, at - 16.0f * scale - view_paint_text_width(scale, "first exposure"), y, scale, "first exposure");
        paint_words(v, at + 8.0f * scale, y, scale, "adapted");
    }
}

static void paint(view *v, float width, float height)
{
    const float scale = fmaxf(1.0f, floorf(fminf(width / 480.0f, height / 300.0f))); /* 2 at 1280 x 720 */
    view_paint_begin(v->paint, width, height);
    if (v->split_on)
        paint_split(v, width, height, scale);
    if (v->plot_on)
        view_plot_paint(&v->plot, v->paint, width, height, scale, v->of.options->config.key);
    if (v->help_on)
        paint_words(v, 8.0f * scale, 32.0f * scale, scale, view_keys_help);
    if (*v->said)
        paint_words(v, 8.0f * scale, 8.0f * scale, scale, v->said);
    view_paint_end(v->paint);
}

static void draw(view *v)
{
    uint32_t width, height;
    pupil_curve first;
    const float split = v->split_on && v->first_known && !v->of.pipeline->own_curve ? v->split : 0.0f;
    pupil_window_size(v->window, &width, &height);
    if (!width || !height)
        return;
    gl_calls_begin(&v->gl, 0, (GLsizei)width, (GLsizei)height);
    v->gl.ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    v->gl.Clear(GL_COLOR_BUFFER_BIT);
    if (split > 0.0f && pupil_get_curve(&v->first, &v->info, &first) == PUPIL_OK)
        draw_part(v, &first, width, height, 0.0f, split);
    draw_part(v, &v->curve, width, height, split, 1.0f);
    gl_calls_begin(&v->gl, 0, (GLsizei)width, (GLsizei)height);
    paint(v, (float)width, (float)height);
    pupil_window_swap(v->window);
    v->drawn_s = progress_now_s();
    v->drawn++;
    v->stale = 0;
}

static void title(view *v)
{
    char law[64], text[512];
    const double now_s = progress_now_s(), since_s = now_s - v->titled_s;
    if (since_s < TITLE_S)
        return;
    view_keys_law(&v->of.options->config, law, sizeof law);
    snprintf(text, sizeof text, "%.200s - %.0f frames/s, EV %+.2f, %s%s%s - pupil", v->of.options->inputs[0],
             v->drawn / since_s, v->of.options->config.ev_compensation, law,
             v->of.options->config.lock ? ", locked" : "", v->of.pipeline->gpu ? "" : ", CPU");
    pupil_window_set_title(v->window, text);
    v->titled_s = now_s;
    v->drawn = 0;
}

/* --- keys --- */

static void say(view *v, const char *words)
{
    snprintf(v->said, sizeof v->said, "%s", words);
    v->said_s = progress_now_s();
}

static void move_split(view *v, double by)
{
    const double split = (double)v->split + by;
    v->split_on = 1;
    v->split = (float)(split < 0.0 ? 0.0 : split > 1.0 ? 1.0 : split);
}

/* Keys that change what is shown, and no setting. */
static void take_view_key(view *v, int key)
{
    switch (key) {
    case 'q':
    case 'Q':
    case PUPIL_WINDOW_ESCAPE:
    case PUPIL_WINDOW_QUIT:
        v->quit = 1;
        break;
    case ' ':
        v->paused = !v->paused;
        v->anchored = 0;
        say(v, v->paused ? "paused" : "on");
        break;
    case 's':
        v->split_on = !v->split_on;
        break;
    case PUPIL_WINDOW_LEFT:
        move_split(v, -SPLIT_STEP);
        break;
    case PUPIL_WINDOW_RIGHT:
        move_split(v, SPLIT_STEP);
        break;
    case 'p':
        v->plot_on = !v->plot_on;
        break;
    case 'e':
        v->edges_on = !v->edges_on;
        break;
    case 'h':
    case '?':
        v->help_on = !v->help_on;
        break;
    case 'f':
    case PUPIL_WINDOW_F11:
        v->fullscreen = !v->fullscreen;
        pupil_window_set_fullscreen(v->window, v->fullscreen);
        break;
    default:
        break;
    }
}

/* Handles the window's events; the shown picture may then be stale. */
static void listen(view *v)
{
    int key;
    while (!v->quit && (key = pupil_window_poll(v->window)) != PUPIL_WINDOW_NOTHING) {
        v->stale = 1;
        if (!view_keys_take(key, &v->of.options->config, v->said, sizeof v->said)) {
            take_view_key(v, key);
            continue;
        }
        v->said_s = progress_now_s();
        v->is_mapped = 0;
        frame_pipeline_retune(v->of.pipeline, &v->of.options->config);
        if (!v->of.pipeline->own_curve && (v->frame || v->of.pipeline->gpu))
            v->curve = v->of.pipeline->adapted;
    }
    if (*v->said && progress_now_s() - v->said_s > SAID_S) {
        *v->said = 0;
        v->stale = 1;
    }
    v->quit |= interrupt_came();
}

/* --- pace --- */

static void doze(double seconds)
{
    const struct timespec t = {.tv_nsec = (long)(fmin(fmax(seconds, 0.0), 0.005) * 1e9)}; /* short, so that keys act
                                                                                           * soon */
    nanosleep(&t, NULL);
}

/* Waits until the frame is due; 0: too late to be shown. */
static int await(view *v, double time_s)
{
    double late_s = v->anchored ? progress_now_s() - v->anchor_s - time_s : 0.0;
    if (!v->anchored || late_s > LOST_S || late_s < -10.0) { /* after a jump of the timestamps it does not wait */
        v->anchor_s = progress_now_s() - time_s;
        v->anchored = 1;
        return 1;
    }
    if (late_s > 1.0 / v->of.fps)
        return progress_now_s() - v->drawn_s > LEAST_S;
    while (!v->quit && v->anchored && (late_s = progress_now_s() - v->anchor_s - time_s) < 0.0) {
        listen(v);
        doze(-late_s);
    }
    return 1;
}

static void stay(view *v, const int *as_long_as)
{
    while (*as_long_as && !v->quit) {
        if (v->stale)
            draw(v);
        title(v);
        doze(1.0);
        listen(v);
    }
}

int view_frame(view *v, const pupil_frame *frame, const frame_log_entry *entry)
{
    const frame_pipeline *p = v->of.pipeline;
    v->frame = frame;
    v->info = frame->info;
    v->curve = p->curve;
    v->is_mapped = p->display.width == frame->image.width && p->display.height == frame->image.height;
    if (!v->first_known && p->has_light) {
        v->first = p->pupil;
        v->first_known = 1;
    }
    view_plot_add(&v->plot, entry);
    listen(v);
    if (!v->quit && (v->of.live ? !v->paused : await(v, entry->time_s)))
        draw(v);
    title(v);
    if (!v->of.live)
        stay(v, &v->paused);
    v->frame = NULL;
    v->was_mapped = v->is_mapped;
    v->is_mapped = 0;
    return v->quit ? VIEW_QUIT : VIEW_ON;
}

void view_stay(view *v)
{
    const int always = 1;
    v->is_mapped = v->was_mapped; /* not overwritten since */
    say(v, "end");
    v->stale = 1;
    stay(v, &always);
}

/* --- life --- */

int view_open(view **opened, const view_of *of, const pupil_image_const *first, pupil_why *why)
{
    const pupil_window_options options = {
        .title = "pupil", .width = first->width, .height = first->height, .version = of->options->gles_version};
    view *v = calloc(1, sizeof *v);
    if (!v)
        return pupil_refuse(why, "not enough memory");
    v->of = *of;
    v->split = 0.5f;
    pupil_why reason = {""};
    if (pupil_window_open(&v->window, &options, &reason) || gl_calls_load(&v->gl, pupil_window_get_proc, &reason) ||
        !(v->paint = view_paint_open(&v->gl, &reason)) || view_picture_open(&v->picture, &v->gl, &reason)) {
        pupil_refuse(why, "--view: %s", reason.text);
        view_close(v);
        return -1;
    }
    /* A software renderer is slower than pupil on the CPU, so it is used only if asked for. */
    if (of->options->gles || of->options->gles_version || !gl_calls_software(&v->gl))
        frame_pipeline_use_gpu(of->pipeline, of->options->gles_version, pupil_window_get_proc);
    *opened = v;
    return 0;
}

void view_close(view *v)
{
    if (!v)
        return;
    free(v->marked);
    view_picture_close(&v->picture);
    view_paint_close(v->paint);
    pupil_window_close(v->window);
    free(v);
}
