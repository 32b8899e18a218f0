#include "frame_work.h"

#include <stdlib.h>

#include "pupil/row_gain.h"

struct frame_work {
    workers *w;
    pupil_stats *own; /* one a worker */
    int *error;       /* one a worker */
    /* the frame at hand */
    const pupil_t *pupil;
    const pupil_image_const *in;
    const pupil_image *out; /* NULL: meter only */
    const pupil_curve *curve;
    const float *gain; /* of its rows, where it is mapped; NULL: none */
    int meter;
};

frame_work *frame_work_open(workers *w)
{
    frame_work *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    f->w = w;
    f->own = calloc(workers_count(w), sizeof *f->own);
    f->error = calloc(workers_count(w), sizeof *f->error);
    if (!f->own || !f->error) {
        frame_work_close(f);
        return NULL;
    }
    return f;
}

void frame_work_close(frame_work *f)
{
    if (f) {
        free(f->own);
        free(f->error);
        free(f);
    }
}

/* The first row of a worker's share: pairs stay together, for they may have one gain. */
static uint32_t begins(uint32_t height, unsigned worker, unsigned count)
{
    const uint32_t row = (uint32_t)((uint64_t)height * worker / count);
    return worker < count ? row & ~UINT32_C(1) : row;
}

static void work_share(void *context, unsigned worker, unsigned count)
{
    frame_work *f = context;
    const uint32_t height = f->in->height, first = begins(height, worker, count);
    const uint32_t rows = begins(height, worker + 1, count) - first;

    f->error[worker] = PUPIL_OK;
    if (f->meter)
        pupil_stats_clear(&f->own[worker]);
    if (!rows)
        return;
    pupil_image_const in = pupil_image_rows(*f->in, first, rows);
    pupil_image out = {0};
    if (f->out) {
        out = *f->out;
        out.data = (unsigned char *)out.data + (ptrdiff_t)first * out.stride_bytes;
        out.height = rows;
    }
    if (f->meter && f->out)
        f->error[worker] = pupil_fused_rows(f->pupil, f->curve, &in, first, height, &out, &f->own[worker]);
    else if (f->meter)
        f->error[worker] = pupil_meter_rows(f->pupil, &in, first, height, &f->own[worker]);
    else if (f->gain)
        f->error[worker] = pupil_map_rows_with_gains(f->pupil, f->curve, &in, f->gain + first, &out);
    else
        f->error[worker] = pupil_map_rows(f->pupil, f->curve, &in, &out);
}

static int pass(frame_work *f, int meter, const pupil_curve *curve, const pupil_image *out)
{
    f->meter = meter;
    f->curve = curve;
    f->out = out;
    workers_run(f->w, work_share, f);
    for (unsigned i = 0; i < workers_count(f->w); i++)
        if (f->error[i])
            return f->error[i];
    return PUPIL_OK;
}

/* What the workers have metered, as one, and what it does to the level. */
static int adapt(frame_work *f, pupil_t *pupil, const pupil_frame_info *info, pupil_stats *stats)
{
    int error = PUPIL_OK;
    pupil_stats_clear(stats);
    for (unsigned i = 0; !error && i < workers_count(f->w); i++)
        error = pupil_stats_add(stats, &f->own[i]);
    return error ? error : pupil_adapt(pupil, stats, info);
}

void frame_work_gain(frame_work *f, const float *gain)
{
    f->gain = gain;
}

int frame_work_meter(frame_work *f, pupil_t *pupil, const pupil_image_const *in, const pupil_frame_info *info,
                     pupil_stats *stats)
{
    f->pupil = pupil;
    f->in = in;
    const int error = pass(f, 1, NULL, NULL);
    return error ? error : adapt(f, pupil, info, stats);
}

int frame_work_process(frame_work *f, pupil_t *pupil, int fused, const pupil_image_const *in,
                       const pupil_frame_info *info, const pupil_image *out, pupil_stats *stats, pupil_curve *curve)
{
    f->pupil = pupil;
    f->in = in;
    fused = fused && pupil_get_curve(pupil, info, curve) == PUPIL_OK; /* the first frame is done exactly */
    int error = pass(f, 1, curve, fused ? out : NULL);
    if (!error)
        error = adapt(f, pupil, info, stats);
    if (!error && !fused) {
        if (pupil_get_curve(pupil, info, curve) != PUPIL_OK) { /* no light so far: rare, and may take its time */
            *curve = (pupil_curve){.scale = 1.0f, .inverse_white_squared = 1.0f};
            pupil_t copy = *pupil; /* this frame has been adapted to */
            return pupil_process(&copy, in, info, out);
        }
        error = pass(f, 0, curve, out);
    }
    return error;
}

int frame_work_map(frame_work *f, const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *in,
                   const pupil_image *out)
{
    f->pupil = pupil;
    f->in = in;
    return pass(f, 0, curve, out);
}
