#include "pipeline.h"

#include <stdio.h>
#include <stdlib.h>

#include "refuse.h"

#define SMALL_PX 160u /* long side of a picture that is only measured */

int frame_pipeline_open(frame_pipeline *p, const pupil_config *config, unsigned threads)
{
    *p = (frame_pipeline){.config = *config, .cpu = cpu_engine_open(threads)};
    pupil_init(&p->pupil, config);
    return p->cpu ? 0 : -1;
}

void frame_pipeline_close(frame_pipeline *p)
{
    gles_engine_close(p->gpu);
    cpu_engine_close(p->cpu);
    free(p->display.data);
    *p = (frame_pipeline){0};
}

int frame_pipeline_use_veil(frame_pipeline *p, const pupil_veil_config *config, const double *bloom_above)
{
    p->veil = 1;
    p->cpu_only |= bloom_above != NULL;
    return cpu_engine_use_veil(p->cpu, config, bloom_above);
}

/* --- the settings --- */

/* The configuration, with the metering within the window: each cell counts by the share of it that the window covers.
 */
static pupil_config tuned(const frame_pipeline *p)
{
    enum { CELLS = PUPIL_GRID_SIDE * PUPIL_GRID_SIDE };
    pupil_config config = p->config, within = p->config;
    uint8_t *const given = &config.weight[0][0], *const covered = &within.weight[0][0];
    unsigned most = 0;
    if (!(p->window[2] > 0.0) ||
        pupil_metering_roi(&within, p->window[0], p->window[1], p->window[2], p->window[3]) != PUPIL_OK)
        return config;
    for (int i = 0; i < CELLS; i++)
        most = (unsigned)given[i] * covered[i] > most ? (unsigned)given[i] * covered[i] : most;
    for (int i = 0; i < CELLS && most; i++) /* rounded up: what counts a little still counts */
        covered[i] = (uint8_t)(((unsigned)given[i] * covered[i] * 255 + most - 1) / most);
    return most ? within : config; /* a user who meters outside of the window has it so */
}

/* --- CPU or GPU --- */

void frame_pipeline_use_gpu(frame_pipeline *p, uint32_t version, pupil_gles_get_proc get_proc)
{
    pupil_why why;
    if (p->cpu_only)
        return;
    if (gles_engine_open(&p->gpu, &p->config, version, get_proc, &why))
        pupil_refuse(&p->warning, "--gles: %.900s", why.text);
    else if (p->veil)
        gles_engine_use_veil(p->gpu);
}

void frame_pipeline_give_up_gpu(frame_pipeline *p, const pupil_why *why)
{
    pupil_refuse(&p->warning, "--gles: %.900s", why->text);
    gles_engine_close(p->gpu);
    p->gpu = NULL;
    const pupil_config config = tuned(p);
    pupil_retune(&p->pupil, &config); /* the GPU may have had no histogram */
}

void frame_pipeline_describe(const frame_pipeline *p, char *text, size_t text_bytes)
{
    if (!p->gpu_frames)
        snprintf(text, text_bytes, "; by the CPU");
    else if (p->gpu_frames == p->frames)
        snprintf(text, text_bytes, "; GPU: %s", p->gpu_name);
    else
        snprintf(text, text_bytes, "; GPU: %s, %llu of %llu frames, the others by the CPU", p->gpu_name,
                 (unsigned long long)p->gpu_frames, (unsigned long long)p->frames);
}

/* --- the curve --- */

static void find_curve(frame_pipeline *p)
{
    p->has_light = pupil_get_curve(&p->pupil, &p->info, &p->adapted) == PUPIL_OK;
    if (!p->has_light)
        (void)pupil_curve_before_light(&p->pupil, &p->adapted);
}

static void retune(frame_pipeline *p)
{
    const pupil_config config = tuned(p);
    pupil_why why;
    if (!p->gpu)
        pupil_retune(&p->pupil, &config);
    else if (gles_engine_retune(p->gpu, &p->pupil, &config, &why))
        frame_pipeline_give_up_gpu(p, &why);
}

void frame_pipeline_retune(frame_pipeline *p, const pupil_config *config)
{
    p->config = *config;
    retune(p);
    find_curve(p);
}

void frame_pipeline_look_at(frame_pipeline *p, const pupil_frame *frame)
{
    int same = 1;
    for (int i = 0; i < 4; i++) {
        same = same && !(frame->window[i] < p->window[i]) && !(frame->window[i] > p->window[i]);
        p->window[i] = frame->window[i];
    }
    if (!same)
        retune(p);
}

/* --- a frame --- */

static int make_room(frame_pipeline *p, const pupil_image_const *in, int whole, pupil_why *why)
{
    const uint32_t side = in->width > in->height ? in->width : in->height;
    const uint32_t by = whole ? 1 : (side + SMALL_PX - 1) / SMALL_PX;
    const uint32_t width = (in->width + by - 1) / by, height = (in->height + by - 1) / by;
    const size_t row = (size_t)width * 3, bytes = row * height;
    void *data = p->display.data;
    if (bytes > p->display_bytes) {
        free(data);
        data = malloc(bytes);
        p->display_bytes = data ? bytes : 0;
    }
    p->display = (pupil_image){
        .data = data, .stride_bytes = (ptrdiff_t)row, .width = width, .height = height, .pixel = PUPIL_PIXEL_RGB8};
    return data ? 0 : pupil_refuse(why, "not enough memory");
}

/* Meter, then adapt. Fused: the frame is mapped by the level before it, in the same pass if the engine can. */
static int meter_by(frame_pipeline *p, const frame_engine_ops *ops, void *engine, const pupil_frame *frame,
                    pupil_why *why)
{
    const int fused = p->config.order == PUPIL_ORDER_FUSED &&
                      pupil_get_curve(&p->pupil, &frame->info, &p->curve) == PUPIL_OK; /* the first frame is exact */
    p->is_mapped = fused && ops->meter_and_map;
    int failed;
    if (p->is_mapped)
        failed = make_room(p, &frame->image, 1, why) ||
                 ops->meter_and_map(engine, &p->pupil, &p->curve, frame, &p->display, &p->stats, why);
    else
        failed = ops->meter(engine, &p->pupil, frame, &p->stats, why);
    if (failed)
        return -1;
    const int error = pupil_adapt(&p->pupil, &p->stats, &frame->info);
    if (error)
        return pupil_refuse(why, "%s: %s", frame->name, pupil_error_string(error));
    p->info = frame->info;
    find_curve(p);
    if (!fused)
        p->curve = p->adapted;
    return 0;
}

/* The CPU makes the veil of the GPU's frames. */
static int meter_by_gpu(frame_pipeline *p, const pupil_frame *frame, pupil_why *why)
{
    if (meter_by(p, &gles_engine_ops, p->gpu, frame, why))
        return -1;
    const pupil_veil *veil = p->veil ? cpu_engine_find_veil(p->cpu, &p->pupil, frame, why) : NULL;
    return p->veil && (!veil || gles_engine_set_veil(p->gpu, veil, why)) ? -1 : 0;
}

int frame_pipeline_meter(frame_pipeline *p, const pupil_frame *frame, pupil_why *why)
{
    p->frames++;
    frame_pipeline_look_at(p, frame);
    if (p->gpu) {
        pupil_why reason;
        const pupil_t before = p->pupil;
        if (meter_by_gpu(p, frame, &reason) == 0)
            return 0;
        p->pupil = before;
        frame_pipeline_give_up_gpu(p, &reason);
    }
    return meter_by(p, &cpu_engine_ops, p->cpu, frame, why);
}

int frame_pipeline_map(frame_pipeline *p, const pupil_frame *frame, int whole, pupil_why *why)
{
    if (p->is_mapped)
        return 0;
    if (p->gpu) {
        pupil_why reason;
        if (make_room(p, &frame->image, whole, &reason) == 0 &&
            gles_engine_ops.map(p->gpu, &p->pupil, &p->curve, frame, &p->display, &reason) == 0) {
            p->gpu_frames++;
            if (p->gpu_frames == 1)
                gles_engine_describe(p->gpu, p->gpu_name, sizeof p->gpu_name);
            return 0;
        }
        frame_pipeline_give_up_gpu(p, &reason);
    }
    return make_room(p, &frame->image, 1, why) ||
                   cpu_engine_ops.map(p->cpu, &p->pupil, &p->curve, frame, &p->display, why)
               ? -1
               : 0;
}

int frame_pipeline_map_again(frame_pipeline *p, const pupil_curve *curve, const pupil_frame *frame)
{
    return make_room(p, &frame->image, 1, NULL) ||
                   cpu_engine_ops.map(p->cpu, &p->pupil, curve, frame, &p->display, NULL)
               ? -1
               : 0;
}

int frame_pipeline_draw(frame_pipeline *p, const pupil_curve *curve, const pupil_gles_target *target)
{
    pupil_why why;
    if (!p->gpu)
        return -1;
    if (gles_engine_draw(p->gpu, curve, target, &why) == 0)
        return 0;
    frame_pipeline_give_up_gpu(p, &why);
    return -1;
}
