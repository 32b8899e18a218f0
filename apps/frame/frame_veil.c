#include "frame_veil.h"

#include <stdlib.h>

#include "refuse.h"

typedef struct worker_veil { /* a worker's own */
    pupil_veil_light light;
    pupil_veil_scratch scratch;
} worker_veil;

struct frame_veil {
    pupil_veil_config config;
    pupil_veil veil;
    unsigned workers;
    worker_veil own[];
};

frame_veil *frame_veil_open(const pupil_veil_config *config, unsigned workers)
{
    frame_veil *v = calloc(1, sizeof *v + workers * sizeof v->own[0]);
    if (!v)
        return NULL;
    v->config = *config;
    v->config.width = v->config.height = 0;
    v->workers = workers;
    return v;
}

void frame_veil_close(frame_veil *v)
{
    free(v);
}

int frame_veil_begin(frame_veil *v, const pupil_frame *frame, pupil_why *why)
{
    const pupil_image_const *in = &frame->image;
    if (pupil_pixel_is_mosaic(in->pixel))
        return pupil_refuse(why, "%s: --veil is not for a camera's mosaic, whose lens has put its own veiling glare in",
                            frame->name);
    if (v->config.width != in->width || v->config.height != in->height) {
        const char *fault = "";
        v->config.width = in->width;
        v->config.height = in->height;
        if (pupil_veil_config_check(&v->config, &fault) || pupil_veil_init(&v->veil, &v->config))
            return pupil_refuse(why, "%s: --veil: %s", frame->name, fault);
    }
    for (unsigned i = 0; i < v->workers; i++)
        pupil_veil_light_clear(&v->own[i].light);
    return 0;
}

int frame_veil_gather(frame_veil *v, unsigned worker, const pupil_t *pupil, const pupil_image_const *rows,
                      uint32_t first_row, pupil_stats *stats)
{
    return pupil_veil_gather_rows(&v->veil, pupil, rows, first_row, stats, &v->own[worker].light);
}

int frame_veil_solve(frame_veil *v)
{
    int error = PUPIL_OK;
    for (unsigned i = 1; !error && i < v->workers; i++)
        error = pupil_veil_light_add(&v->own[0].light, &v->own[i].light);
    if (!error)
        error = pupil_veil_begin(&v->veil);
    if (!error)
        error = pupil_veil_add_light(&v->veil, &v->own[0].light);
    return error ? error : pupil_veil_solve(&v->veil);
}

const pupil_veil *frame_veil_of(const frame_veil *v)
{
    return &v->veil;
}

int frame_veil_map(frame_veil *v, unsigned worker, const pupil_t *pupil, const pupil_curve *curve,
                   const pupil_image_const *rows, const pupil_image *out)
{
    return pupil_veil_map_rows(&v->veil, pupil, curve, rows, out, &v->own[worker].scratch);
}
