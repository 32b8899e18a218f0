#include "frame_veil.h"

#include <stdlib.h>
#include <string.h>

#include "pupil/bloom.h"
#include "refuse.h"

typedef struct worker_veil { /* a worker's own */
    pupil_veil_light light;
    pupil_veil_scratch scratch;
    pupil_bloom_scratch bloom_scratch;
} worker_veil;

struct frame_veil {
    pupil_veil_config config;
    pupil_veil veil;
    int blooms;
    double bloom_above;
    pupil_bloom *bloom; /* of the current size; NULL: none yet, or none at all */
    unsigned workers;
    worker_veil own[];
};

frame_veil *frame_veil_open(const pupil_veil_config *config, const double *bloom_above, unsigned workers)
{
    frame_veil *v = calloc(1, sizeof *v + workers * sizeof v->own[0]);
    if (!v)
        return NULL;
    v->config = *config;
    v->config.width = v->config.height = 0;
    v->workers = workers;
    v->blooms = bloom_above != NULL;
    v->bloom_above = bloom_above ? *bloom_above : 0;
    return v;
}

void frame_veil_close(frame_veil *v)
{
    if (v)
        free(v->bloom);
    free(v);
}

/* For frames of the veil's size. */
static int open_bloom(frame_veil *v, pupil_why *why)
{
    pupil_bloom_config config;
    pupil_veil_result eye;
    const char *fault = "";
    free(v->bloom);
    v->bloom = NULL;
    pupil_veil_get(&v->veil, &eye);
    pupil_bloom_config_default(&config);
    config.width = v->config.width;
    config.height = v->config.height;
    config.threshold = v->bloom_above;
    config.lobes = eye.lobes;
    memcpy(config.lobe, eye.lobe, sizeof config.lobe);
    if (pupil_bloom_config_check(&config, &fault))
        return pupil_refuse(why, "--bloom: %s", fault);
    const size_t bytes = pupil_bloom_bytes(&config);
    v->bloom = malloc(bytes);
    if (!v->bloom)
        return pupil_refuse(why, "not enough memory for --bloom");
    const int error = pupil_bloom_init(v->bloom, bytes, &config);
    return error ? pupil_refuse(why, "--bloom: %s", pupil_error_string(error)) : 0;
}

static int open_size(frame_veil *v, const pupil_frame *frame, pupil_why *why)
{
    const char *fault = "";
    v->config.width = frame->image.width;
    v->config.height = frame->image.height;
    if (pupil_veil_config_check(&v->config, &fault) || pupil_veil_init(&v->veil, &v->config))
        return pupil_refuse(why, "%s: --veil: %s", frame->name, fault);
    return v->blooms ? open_bloom(v, why) : 0;
}

int frame_veil_begin(frame_veil *v, const pupil_frame *frame, pupil_why *why)
{
    const pupil_image_const *in = &frame->image;
    if (pupil_pixel_is_mosaic(in->pixel))
        return pupil_refuse(why, "%s: --veil is not for a camera's mosaic, whose lens has put its own veiling glare in",
                            frame->name);
    if ((v->config.width != in->width || v->config.height != in->height) && open_size(v, frame, why)) {
        v->config.width = v->config.height = 0; /* the next frame of this size is refused, too */
        return -1;
    }
    for (unsigned i = 0; i < v->workers; i++)
        pupil_veil_light_clear(&v->own[i].light);
    return 0;
}

int frame_veil_gather(frame_veil *v, unsigned worker, const pupil_t *pupil, const pupil_image_const *frame,
                      uint32_t first_row, uint32_t rows, pupil_stats *stats)
{
    enum { GROUP = 16 }; /* rows that are gathered twice while they are in the cache */
    int error = PUPIL_OK;
    for (uint32_t done = 0; !error && done < rows; done += GROUP) {
        const uint32_t y = first_row + done, count = rows - done < GROUP ? rows - done : GROUP;
        const pupil_image_const part = pupil_image_rows(*frame, y, count);
        error = pupil_veil_gather_rows(&v->veil, pupil, &part, y, stats, &v->own[worker].light);
        if (!error && v->bloom)
            error = pupil_bloom_gather_rows(v->bloom, pupil, frame, y, count, &v->own[worker].bloom_scratch);
    }
    return error;
}

int frame_veil_solve(frame_veil *v, const pupil_t *pupil)
{
    int error = v->bloom ? pupil_bloom_solve(v->bloom, pupil) : PUPIL_OK;
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
                   const pupil_image_const *frame, const pupil_image *out)
{
    if (v->bloom)
        return pupil_bloom_map_rows(v->bloom, &v->veil, pupil, curve, frame, out, &v->own[worker].bloom_scratch);
    const pupil_image_const rows = pupil_image_rows(*frame, curve->first_row, out->height);
    return pupil_veil_map_rows(&v->veil, pupil, curve, &rows, out, &v->own[worker].scratch);
}
