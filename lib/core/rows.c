/* Rows of a frame through the kernels: each row in runs of equal metering weight. */
#include "object.h"

/* The first x whose pixel lies in column `cell` of the grid or right of it: the smallest with
 * (2x + 1) * 16 / (2 * width) >= cell. The same for rows. */
static uint32_t first_in_cell(uint32_t cell, uint32_t width)
{
    return (cell * width + PUPIL_GRID_SIDE / 2 - 1) / PUPIL_GRID_SIDE;
}

static uint32_t cell_of(uint32_t y, uint32_t height)
{
    return (2 * y + 1) * PUPIL_GRID_SIDE / (2 * height);
}

static void work_row(const pupil_row_job *job, const uint8_t *weight, const uint8_t *in, uint8_t *out, uint32_t width,
                     uint32_t band, pupil_stats *stats)
{
    const size_t in_bytes = pupil_pixel_bytes(job->in_pixel), out_bytes = pupil_pixel_bytes(job->out_pixel);
    uint32_t x = 0;

    for (uint32_t cell = 0; cell < PUPIL_GRID_SIDE;) {
        uint32_t next = cell + 1;
        while (next < PUPIL_GRID_SIDE && weight[next] == weight[cell])
            next++;
        uint32_t end = next < PUPIL_GRID_SIDE ? first_in_cell(next, width) : width;
        if (end > x && (out || weight[cell]))
            pupil_work_run(job, in + x * in_bytes, out ? out + x * out_bytes : 0, end - x, weight[cell], band, stats);
        x = end;
        cell = next;
    }
}

/* The value at which a channel counts as clipped. */
static float clip_of(const pupil_config *config, uint32_t pixel)
{
    if (config->clip > 0.0f)
        return config->clip;
    if (pixel == PUPIL_PIXEL_RGBA16F)
        return 65504.0f; /* the largest binary16 */
    return pixel == PUPIL_PIXEL_RGBA32F || pixel == PUPIL_PIXEL_RGB32F ? PUPIL_CEILING : 1.0f;
}

void pupil_work_rows(const pupil_object *object, const pupil_image_const *in, uint32_t first_row, uint32_t frame_height,
                     pupil_stats *stats, const pupil_curve *curve, const pupil_image *out)
{
    static const uint8_t even[PUPIL_GRID_SIDE] = {0};
    const pupil_row_job job = {
        .kernels = pupil_level_kernels(object->level),
        .encoder = &pupil_encoders[object->config.transfer],
        .curve = curve,
        .luma = {object->luma[0], object->luma[1], object->luma[2]},
        .floor = object->config.floor,
        .clip = clip_of(&object->config, in->pixel),
        .in_pixel = in->pixel,
        .out_pixel = out ? out->pixel : (uint32_t)PUPIL_PIXEL_NONE,
        .histogram = object->histogram,
    };
    const uint8_t *source = in->data;
    uint8_t *target = out ? out->data : 0;

    for (uint32_t i = 0; i < in->height; i++) {
        uint32_t y = first_row + i;
        const uint8_t *weight = stats ? object->config.weight[cell_of(y, frame_height)] : even;
        uint32_t band = stats ? y * PUPIL_BANDS / frame_height : 0;
        work_row(&job, weight, source, target, in->width, band, stats);
        if (i + 1 < in->height) { /* no pointer beyond the image, in whichever direction it lies */
            source += in->stride_bytes;
            target = target ? target + out->stride_bytes : 0;
        }
    }
    if (stats) {
        stats->rows += in->height;
        stats->frame_height = frame_height;
        stats->has_histogram = object->histogram;
    }
}
