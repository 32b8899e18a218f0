#include "cpu_engine.h"

#include <stdlib.h>

#include "pupil/row_gain.h"
#include "refuse.h"
#include "workers.h"

struct cpu_engine {
    workers *w;
    pupil_stats *own;  /* one for each worker */
    int *error;        /* one for each worker */
    const float *gain; /* of the mapped frame's rows; NULL: none */
    frame_veil *veil;  /* NULL: none */
    /* the current pass */
    const pupil_t *pupil;
    const pupil_image_const *in;
    const pupil_image *out; /* NULL: meter only */
    const pupil_curve *curve;
    int meter;
};

cpu_engine *cpu_engine_open(unsigned threads)
{
    cpu_engine *e = calloc(1, sizeof *e);
    if (!e)
        return NULL;
    e->w = workers_open(threads);
    if (e->w) {
        e->own = calloc(workers_count(e->w), sizeof *e->own);
        e->error = calloc(workers_count(e->w), sizeof *e->error);
    }
    if (!e->own || !e->error) {
        cpu_engine_close(e);
        return NULL;
    }
    return e;
}

void cpu_engine_close(cpu_engine *e)
{
    if (!e)
        return;
    workers_close(e->w);
    frame_veil_close(e->veil);
    free(e->own);
    free(e->error);
    free(e);
}

void cpu_engine_row_gains(cpu_engine *e, const float *gain)
{
    e->gain = gain;
}

int cpu_engine_use_veil(cpu_engine *e, const pupil_veil_config *config, const double *bloom_above)
{
    frame_veil_close(e->veil);
    e->veil = frame_veil_open(config, bloom_above, workers_count(e->w));
    return e->veil ? 0 : -1;
}

/* --- a worker's share --- */

/* The first row of a worker's share: pairs of rows stay together, because they may share a gain. */
static uint32_t begins(uint32_t height, unsigned worker, unsigned count)
{
    const uint32_t row = (uint32_t)((uint64_t)height * worker / count);
    return worker < count ? row & ~UINT32_C(1) : row;
}

static void work_share(void *context, unsigned worker, unsigned count)
{
    cpu_engine *e = context;
    const uint32_t height = e->in->height, first = begins(height, worker, count);
    const uint32_t rows = begins(height, worker + 1, count) - first;

    e->error[worker] = PUPIL_OK;
    if (e->meter)
        pupil_stats_clear(&e->own[worker]);
    if (!rows)
        return;
    pupil_image_const in = pupil_image_rows(*e->in, first, rows);
    pupil_image out = {0};
    pupil_curve curve = {0};
    if (e->out) {
        out = *e->out;
        curve = *e->curve;
        curve.first_row = first;
        out.data = (unsigned char *)out.data + (ptrdiff_t)first * out.stride_bytes;
        out.height = rows;
    }
    if (e->meter && e->out)
        e->error[worker] = pupil_fused_rows(e->pupil, &curve, &in, first, height, &out, &e->own[worker]);
    else if (e->veil && !e->out)
        e->error[worker] =
            frame_veil_gather(e->veil, worker, e->pupil, e->in, first, rows, e->meter ? &e->own[worker] : NULL);
    else if (e->veil)
        e->error[worker] = frame_veil_map(e->veil, worker, e->pupil, &curve, e->in, &out);
    else if (e->meter)
        e->error[worker] = pupil_meter_rows(e->pupil, &in, first, height, &e->own[worker]);
    else if (e->gain)
        e->error[worker] = pupil_map_rows_with_gains(e->pupil, &curve, &in, e->gain + first, &out);
    else
        e->error[worker] = pupil_map_rows(e->pupil, &curve, &in, &out);
}

/* --- a frame --- */

/* Merges the workers' statistics. */
static int merge(cpu_engine *e, pupil_stats *stats)
{
    int error = PUPIL_OK;
    pupil_stats_clear(stats);
    for (unsigned i = 0; !error && i < workers_count(e->w); i++)
        error = pupil_stats_add(stats, &e->own[i]);
    return error;
}

/* Meters into stats (unless NULL) and maps by curve to out (unless NULL). With a veil, a pass that does not map gathers
 * light. */
static int pass(cpu_engine *e, const pupil_t *pupil, const pupil_frame *frame, pupil_stats *stats,
                const pupil_curve *curve, const pupil_image *out, pupil_why *why)
{
    int error = PUPIL_OK;
    e->pupil = pupil;
    e->in = &frame->image;
    e->meter = stats != NULL;
    e->curve = curve;
    e->out = out;
    workers_run(e->w, work_share, e);
    for (unsigned i = 0; !error && i < workers_count(e->w); i++)
        error = e->error[i];
    if (!error && stats)
        error = merge(e, stats);
    if (stats && frame->code_light > 0.0f)
        stats->code_light = frame->code_light;
    return error ? pupil_refuse(why, "%s: %s", frame->name, pupil_error_string(error)) : 0;
}

static int solve_veil(cpu_engine *e, const pupil_frame *frame, pupil_why *why)
{
    const int error = frame_veil_solve(e->veil, e->pupil);
    return error ? pupil_refuse(why, "%s: %s", frame->name, pupil_error_string(error)) : 0;
}

const pupil_veil *cpu_engine_find_veil(cpu_engine *e, const pupil_t *pupil, const pupil_frame *frame, pupil_why *why)
{
    const int failed = frame_veil_begin(e->veil, frame, why) || pass(e, pupil, frame, NULL, NULL, NULL, why) ||
                       solve_veil(e, frame, why);
    return failed ? NULL : frame_veil_of(e->veil);
}

static int meter(void *self, pupil_t *pupil, const pupil_frame *frame, pupil_stats *stats, pupil_why *why)
{
    cpu_engine *e = self;
    if (e->veil && frame_veil_begin(e->veil, frame, why))
        return -1;
    if (pass(e, pupil, frame, stats, NULL, NULL, why))
        return -1;
    return e->veil ? solve_veil(e, frame, why) : 0;
}

static int map(void *self, const pupil_t *pupil, const pupil_curve *curve, const pupil_frame *frame,
               const pupil_image *rgb8, pupil_why *why)
{
    return pass(self, pupil, frame, NULL, curve, rgb8, why);
}

static int meter_and_map(void *self, const pupil_t *pupil, const pupil_curve *curve, const pupil_frame *frame,
                         const pupil_image *rgb8, pupil_stats *stats, pupil_why *why)
{
    return pass(self, pupil, frame, stats, curve, rgb8, why);
}

const frame_engine_ops cpu_engine_ops = {.meter = meter, .map = map, .meter_and_map = meter_and_map};
