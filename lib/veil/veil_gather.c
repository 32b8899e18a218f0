/* A frame's light in cells: a kernel sums each run of a row in one cell, in floats, which then become integers. */
#include "veil_private.h"

#include "base/numeric.h"
#include "core/image.h"
#include "core/object.h"
#include "veil_rows.h"

static veil_light_object *light_of(pupil_veil_light *light)
{
    return (veil_light_object *)(void *)light;
}

static int check_light(const pupil_veil_light *light)
{
    if (!light)
        return PUPIL_ERR_NULL;
    return ((const veil_light_object *)(const void *)light)->magic == VEIL_LIGHT_MAGIC ? PUPIL_OK : PUPIL_ERR_OBJECT;
}

int pupil_veil_light_clear(pupil_veil_light *light)
{
    if (!light)
        return PUPIL_ERR_NULL;
    __builtin_memset(light, 0, sizeof *light);
    light_of(light)->magic = VEIL_LIGHT_MAGIC;
    return PUPIL_OK;
}

double pupil_veil_cell_pixels(uint32_t width, uint32_t height)
{
    const uint32_t across = (width + VEIL_CELLS - 1) / VEIL_CELLS, down = (height + VEIL_CELLS - 1) / VEIL_CELLS;
    double pixels = 1.0;
    while (pixels < (double)across * down)
        pixels *= 2.0;
    return pixels;
}

int pupil_veil_light_add(pupil_veil_light *light, const pupil_veil_light *other)
{
    int error = check_light(light);
    if (!error)
        error = check_light(other);
    if (error)
        return error;
    veil_light_object *to = light_of(light);
    const veil_light_object *from = (const veil_light_object *)(const void *)other;
    if (!from->rows)
        return PUPIL_OK;
    if (to->rows && (to->width != from->width || to->height != from->height))
        return PUPIL_ERR_OBJECT;
    if (to->rows > from->height - from->rows)
        return PUPIL_ERR_ROWS;
    to->width = from->width;
    to->height = from->height;
    to->rows += from->rows;
    for (int j = 0; j < VEIL_CELLS; j++)
        for (int i = 0; i < VEIL_CELLS; i++)
            for (int channel = 0; channel < 3; channel++) {
                to->cell[j][i].sum[channel] += from->cell[j][i].sum[channel];
                to->cell[j][i].x[channel] += from->cell[j][i].x[channel];
                to->cell[j][i].y[channel] += from->cell[j][i].y[channel];
            }
    return PUPIL_OK;
}

/* --- a row --- */

typedef struct gathering {
    const pupil_kernels *kernels;
    veil_rows rows;
    uint32_t width, height;
    double unit;    /* of the integers */
    double a_pixel; /* in cells */
} gathering;

/* To the nearest; |x| < 2^62. Without a branch: the signs of moments are random. */
static int64_t whole(double x)
{
    const uint64_t half = UINT64_C(0x3fe0000000000000), sign = UINT64_C(1) << 63;
    return (int64_t)(x + pupil_double_of_bits((pupil_bits_of_double(x) & sign) | half));
}

/* Adds a run's sums to the cell, with moments about its middle in cells. */
static void add_run(const gathering *g, const pupil_veil_sums *sums, uint32_t first, uint32_t column, double down,
                    veil_cell *cell)
{
    const double across = (first + 0.5) * g->a_pixel - (column + 0.5);
    for (int channel = 0; channel < 3; channel++) {
        const double sum = (double)sums->sum[channel] * g->unit, moment = (double)sums->moment[channel] * g->unit;
        cell->sum[channel] += whole(sum);
        cell->x[channel] += whole(sum * across + moment * g->a_pixel);
        cell->y[channel] += whole(sum * down);
    }
}

/* `count` runs, which are pixels begin to end of a row. */
static void sum_runs(const gathering *g, const pupil_row *row, ptrdiff_t next_row, uint32_t begin, uint32_t end,
                     const uint32_t *run, uint32_t count, pupil_planes *planes, pupil_veil_sums *sums)
{
    const uint32_t pixel = g->rows.image->pixel;
    if (pixel == PUPIL_PIXEL_RGBA32F) {
        PUPIL_PIECE(g->kernels, veil_gather_rgba32f)
        (row->data + 16 * (size_t)begin, next_row, run, count, sums);
        return;
    }
    (void)PUPIL_PIECE(g->kernels, load[pixel])(&g->rows.coder, row, begin, end - begin, planes);
    PUPIL_PIECE(g->kernels, veil_gather)(planes, run, count, sums);
}

/* As many whole cells at a time as a block has room for: each run is then summed by one kernel call, however rows are
 * split. */
static __attribute__((noinline)) void gather_row(const gathering *g, uint32_t i, uint32_t y, pupil_planes *planes,
                                                 veil_cell cells[VEIL_CELLS])
{
    enum { RUNS = 12 };
    uint32_t run[RUNS]; /* pixels in each cell */
    pupil_veil_sums sums[RUNS];
    const pupil_row row = pupil_veil_row_of(&g->rows, i);
    const ptrdiff_t next_row = i + 1 < g->rows.image->height ? g->rows.image->stride_bytes : 0;
    const double down = (y + 0.5) * VEIL_CELLS / g->height - (pupil_veil_cell_of(y, g->height) + 0.5);
    for (uint32_t first = 0; first < VEIL_CELLS;) {
        const uint32_t begin = pupil_veil_first_in_cell(first, g->width);
        uint32_t end = begin, count = 0;
        for (; count < RUNS && first + count < VEIL_CELLS; count++) {
            const uint32_t next = pupil_veil_first_in_cell(first + count + 1, g->width);
            if (next - begin > PUPIL_BLOCK)
                break;
            run[count] = next - end;
            end = next;
        }
        first += count;
        if (end == begin) /* more cells than pixels: all of these are empty */
            continue;
        sum_runs(g, &row, next_row, begin, end, run, count, planes, sums);
        for (uint32_t c = 0, at = begin; c < count; at += run[c], c++)
            add_run(g, &sums[c], at, first - count + c, down, &cells[first - count + c]);
    }
}

/* --- rows --- */

static int check_rows(const veil_object *o, const pupil_image_const *rows, uint32_t first_row, const pupil_stats *stats,
                      const veil_light_object *light)
{
    const uint32_t width = o->config.width, height = o->config.height;
    if (pupil_pixel_is_mosaic(rows->pixel))
        return PUPIL_ERR_PIXEL;
    if (rows->width != width)
        return PUPIL_ERR_SIZE;
    if (first_row >= height || rows->height > height - first_row || first_row % pupil_pixel_rows(rows->pixel))
        return PUPIL_ERR_ROWS;
    if (light->rows && (light->width != width || light->height != height))
        return PUPIL_ERR_OBJECT;
    if (light->rows > height - rows->height || (stats && stats->rows > height - rows->height))
        return PUPIL_ERR_ROWS;
    return PUPIL_OK;
}

/* Refused, if at all, by the first rows' metering: then nothing is touched yet. */
static __attribute__((noinline)) int gather(const veil_object *o, const pupil_t *pupil, const pupil_image_const *image,
                                            uint32_t first_row, pupil_stats *stats, veil_light_object *to)
{
    gathering g = {.kernels = pupil_level_kernels(pupil_object_of_const(pupil)->level),
                   .width = o->config.width,
                   .height = o->config.height};
    g.a_pixel = (double)VEIL_CELLS / g.width;
    g.unit = 0x1p32 / pupil_veil_cell_pixels(g.width, g.height);
    pupil_veil_rows_begin(&g.rows, image);
    const uint32_t together = pupil_pixel_rows(image->pixel);
    for (uint32_t i = 0; i < image->height; i += together) {
        const uint32_t left = image->height - i, count = left < together ? left : together;
        const pupil_image_const part = pupil_image_rows(*image, i, count);
        const int error = stats ? pupil_meter_rows(pupil, &part, first_row + i, g.height, stats) : PUPIL_OK;
        if (error)
            return error;
        for (uint32_t y = first_row + i; y < first_row + i + count; y++)
            gather_row(&g, y - first_row, y, &to->planes, to->cell[pupil_veil_cell_of(y, g.height)]);
    }
    __builtin_memset(&to->planes, 0, sizeof to->planes); /* the same light is the same bytes */
    to->width = g.width;
    to->height = g.height;
    to->rows += image->height;
    return PUPIL_OK;
}

int pupil_veil_gather_rows(const pupil_veil *veil, const pupil_t *pupil, const pupil_image_const *rows,
                           uint32_t first_row, pupil_stats *stats, pupil_veil_light *light)
{
    pupil_input in;
    int error = pupil_veil_check(veil);
    if (!error)
        error = pupil_object_check(pupil);
    if (!error)
        error = check_light(light);
    if (!error)
        error = pupil_input_read(&in, rows);
    if (!error)
        error = check_rows(pupil_veil_object_of_const(veil), &in.image, first_row, stats, light_of(light));
    if (error)
        return error;
    return gather(pupil_veil_object_of_const(veil), pupil, &in.image, first_row, stats, light_of(light));
}
