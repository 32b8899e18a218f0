#include "replay_work.h"

#include "refuse.h"
#include <stdio.h>
#include <stdlib.h>

#define SMALL_PX 160u /* long side of a picture that is only measured */

int replay_work_open(replay_work *w, const frame_options *options)
{
    *w = (replay_work){.options = options, .workers = workers_open(options->threads)};
    w->cpu = w->workers ? frame_work_open(w->workers) : NULL;
    return w->cpu ? 0 : -1;
}

void replay_work_close(replay_work *w)
{
    gles_work_close(w->gpu);
    frame_work_close(w->cpu);
    workers_close(w->workers);
    free(w->display);
    *w = (replay_work){0};
}

void replay_work_gles(replay_work *w, pupil_gles_get_proc get_proc)
{
    pupil_why why;
    if (w->cpu_only)
        return;
    if (gles_work_open(&w->gpu, &w->options->config, w->options->gles_version, get_proc, &why))
        pupil_refuse(&w->warning, "--gles: %.900s", why.text);
}

void replay_work_give_up(replay_work *w, pupil_t *pupil, const char *why)
{
    pupil_refuse(&w->warning, "--gles: %.900s", why);
    gles_work_close(w->gpu);
    w->gpu = NULL;
    pupil_retune(pupil, &w->options->config); /* the GPU may have gone without a histogram */
}

void replay_work_retune(replay_work *w, pupil_t *pupil)
{
    pupil_why why;
    if (!w->gpu)
        pupil_retune(pupil, &w->options->config);
    else if (gles_work_retune(w->gpu, pupil, &w->options->config, &why))
        replay_work_give_up(w, pupil, why.text);
}

/* --- a frame --- */

static int make_room(replay_work *w, const pupil_image_const *in, int whole, pupil_image *out)
{
    const uint32_t side = in->width > in->height ? in->width : in->height;
    const uint32_t by = whole ? 1 : (side + SMALL_PX - 1) / SMALL_PX;
    const uint32_t width = (in->width + by - 1) / by, height = (in->height + by - 1) / by;
    const size_t row = (size_t)width * 3, bytes = row * height;
    if (bytes > w->display_bytes) {
        free(w->display);
        w->display = malloc(bytes);
        w->display_bytes = w->display ? bytes : 0;
        if (!w->display)
            return -1;
    }
    *out = (pupil_image){.data = w->display,
                         .stride_bytes = (ptrdiff_t)row,
                         .width = width,
                         .height = height,
                         .pixel = PUPIL_PIXEL_RGB8};
    return 0;
}

/* The judge's word about a frame; of a fused one it comes too late for the picture. */
static void judge(const replay_work *w, int fused, const pupil_frame *frame, const pupil_stats *stats,
                  pupil_curve *curve)
{
    pupil_curve unused = *curve;
    if (w->judge)
        w->judge(w->context, stats, &frame->info, fused ? &unused : curve);
}

/* 0; -1: the CPU is to do the frame, with the pupil_t as it was. */
static int on_gpu(replay_work *w, pupil_t *pupil, int fused, const pupil_frame *frame, pupil_stats *stats,
                  pupil_curve *curve, const pupil_image *display)
{
    pupil_why why;
    const pupil_t before = *pupil;
    int error = gles_work_process(w->gpu, pupil, fused, &frame->image, &frame->info, stats, curve, &why);
    if (!error) {
        judge(w, fused, frame, stats, curve);
        error = gles_work_read(w->gpu, curve, display, &why);
    }
    if (!error) {
        w->gpu_frames++;
        if (w->gpu_frames == 1)
            gles_work_describe(w->gpu, w->gpu_name, sizeof w->gpu_name);
        return 0;
    }
    *pupil = before;
    replay_work_give_up(w, pupil, why.text);
    return -1;
}

static int on_cpu(replay_work *w, pupil_t *pupil, int fused, const pupil_frame *frame, pupil_stats *stats,
                  pupil_curve *curve, const pupil_image *display)
{
    int error;
    if (!w->judge || fused) {
        error = frame_work_process(w->cpu, pupil, fused, &frame->image, &frame->info, display, stats, curve);
        if (!error)
            judge(w, 1, frame, stats, curve);
        return error;
    }
    error = frame_work_meter(w->cpu, pupil, &frame->image, &frame->info, stats);
    if (error)
        return error;
    if (pupil_get_curve(pupil, &frame->info, curve) != PUPIL_OK)
        *curve = (pupil_curve){.scale = 1.0f, .inverse_white_squared = 1.0f}; /* no light so far */
    judge(w, 0, frame, stats, curve);
    return frame_work_map(w->cpu, pupil, curve, &frame->image, display);
}

int replay_work_frame(replay_work *w, pupil_t *pupil, const pupil_frame *frame, int whole, pupil_stats *stats,
                      pupil_curve *curve, pupil_image *display, pupil_why *why)
{
    const int fused = w->options->config.order == PUPIL_ORDER_FUSED;
    w->frames++;
    if (w->gpu && make_room(w, &frame->image, whole, display) == 0 &&
        on_gpu(w, pupil, fused, frame, stats, curve, display) == 0)
        return 0;
    if (make_room(w, &frame->image, 1, display)) {
        pupil_refuse(why, "not enough memory");
        return -1;
    }
    const int error = on_cpu(w, pupil, fused, frame, stats, curve, display);
    if (error)
        pupil_refuse(why, "%s: %s", frame->name, pupil_error_string(error));
    return error ? -1 : 0;
}

int replay_work_map(replay_work *w, const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *in,
                    pupil_image *display)
{
    return make_room(w, in, 1, display) || frame_work_map(w->cpu, pupil, curve, in, display) ? -1 : 0;
}

void replay_work_tell(const replay_work *w, char *text, size_t text_bytes)
{
    snprintf(text, text_bytes, "%s", w->frames && (w->options->gles || w->options->view) ? "; by the CPU" : "");
    if (w->gpu_frames == w->frames && w->frames)
        snprintf(text, text_bytes, "; GPU: %s", w->gpu_name);
    else if (w->gpu_frames)
        snprintf(text, text_bytes, "; GPU: %s, %llu of %llu frames, the others by the CPU", w->gpu_name,
                 (unsigned long long)w->gpu_frames, (unsigned long long)w->frames);
}
