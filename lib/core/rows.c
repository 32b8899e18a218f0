/* Rows of a frame through the kernels: each row in runs of equal metering weight. */
#include "object.h"

/* The smallest x with (2x + 1) * 16 / (2 * width) >= cell. */
uint32_t pupil_grid_first_in_cell(uint32_t cell, uint32_t width)
{
    return (cell * width + PUPIL_GRID_SIDE / 2 - 1) / PUPIL_GRID_SIDE;
}

uint32_t pupil_grid_cell_of(uint32_t y, uint32_t height)
{
    return (2 * y + 1) * PUPIL_GRID_SIDE / (2 * height);
}

float pupil_clip_of(const pupil_config *config, uint32_t pixel, const pupil_coder *coder)
{
    if (config->clip > 0.0f)
        return config->clip;
    if (pupil_pixel_is_mosaic(pixel))
        return coder->most;
    if (pixel == PUPIL_PIXEL_RGBA16F || pixel == PUPIL_PIXEL_RGB16F)
        return 65504.0f; /* the largest binary16 */
    if (pixel == PUPIL_PIXEL_RGBA32F || pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_BGR32F)
        return PUPIL_CEILING;
    return coder->brightest;
}

void pupil_metered_luma(const float luma[3], const pupil_coder *coder, float metered[3])
{
    const float *m = coder->matrix;
    for (int i = 0; i < 3; i++)
        metered[i] = coder->has_matrix ? (luma[0] * m[i] + luma[1] * m[3 + i]) + luma[2] * m[6 + i] : luma[i];
}

/* Whether all 16 are equal: both halves are the same, and remain so when rotated by a byte. */
static int is_even(const uint8_t weight[PUPIL_GRID_SIDE])
{
    uint64_t half[2];
    _Static_assert(sizeof half == PUPIL_GRID_SIDE, "two words a row of the grid");
    __builtin_memcpy(half, weight, sizeof half);
    return half[0] == half[1] && half[0] == (half[0] << 8 | half[0] >> 56);
}

static inline void work_run(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, uint8_t *target,
                            uint32_t weight, uint32_t band, pupil_stats *stats)
{
    if (job->sample > 1) /* only jobs that meter */
        pupil_meter_sampled(job, row, x, n, weight, band, stats);
    else
        pupil_work_run(job, row, x, n, target, weight, band, stats);
}

/* One row, in runs; `width` is that of the row as job->way makes it. target NULL: not mapped. */
static void work_row(const pupil_row_job *job, const uint8_t *weight, const pupil_row *row, uint8_t *target,
                     uint32_t width, uint32_t band, pupil_stats *stats)
{
    const size_t out_bytes = pupil_pixel_bytes(job->out_pixel);
    uint32_t x = 0;

    if (is_even(weight)) { /* the usual grid: to walk its cells would take a hundred instructions a row */
        if (target || weight[0])
            work_run(job, row, 0, width, target, weight[0], band, stats);
        return;
    }
    for (uint32_t cell = 0; cell < PUPIL_GRID_SIDE;) {
        uint32_t next = cell + 1;
        while (next < PUPIL_GRID_SIDE && weight[next] == weight[cell])
            next++;
        uint32_t end = next < PUPIL_GRID_SIDE ? pupil_grid_first_in_cell(next, width) : width;
        if (end > x && (target || weight[cell]))
            work_run(job, row, x, end - x, target ? target + x * out_bytes : 0, weight[cell], band, stats);
        x = end;
        cell = next;
    }
}

/* docs/numerics.md has the errors. */
#define LEAST_COUNTED 25000u
#define LEAST_SAMPLED 16000u /* PUPIL_ACCURACY_LUMA */

/* The state of one call. */
typedef struct work {
    const pupil_object *object;
    const pupil_image_const *in;
    const pupil_image *out; /* NULL: metered only */
    pupil_stats *stats;     /* NULL: mapped only */
    uint32_t first_row, frame_height;
    pupil_coder coder;
    pupil_chroma_coder chroma;
    pupil_row_job meter, map;
    uint32_t in_unit;            /* rows of a mosaic's quad, or 1 */
    uint32_t planes, planes_out; /* of in; of out */
    uint32_t histogram_step;     /* one of so many rows is counted */
} work;

static const uint8_t *in_row(const work *w, uint32_t i)
{
    return (const uint8_t *)w->in->data + (ptrdiff_t)i * w->in->stride_bytes;
}

static uint8_t *out_row(const work *w, uint32_t i)
{
    return (uint8_t *)w->out->data + (ptrdiff_t)i * w->out->stride_bytes;
}

/* Row i of the call, and for a mosaic the rows next to it. */
static pupil_row row_of(const work *w, uint32_t i)
{
    const pupil_image_const *in = w->in;
    const uint32_t y = (w->first_row + i) / (w->map.way == PUPIL_WAY_BINNED ? 2 : 1);
    pupil_row row = {.data = in_row(w, i), .width = in->width, .y = y};
    const ptrdiff_t chroma_row = pupil_chroma_row_of(in->pixel, i);
    if (w->planes > 1)
        row.chroma = (const uint8_t *)in->chroma + chroma_row * in->chroma_stride_bytes;
    if (w->planes > 2)
        row.cr = (const uint8_t *)in->cr + chroma_row * in->cr_stride_bytes;
    if (w->in_unit == 2) {
        const int is_first = i == 0 && !in->rows_above;
        const int is_last = i + 1 == in->height && !in->rows_below;
        row.above = is_first ? in_row(w, i + 1) : row.data - in->stride_bytes;
        row.below = is_last ? row.data - in->stride_bytes : row.data + in->stride_bytes;
        row.odd = i & 1;
    }
    return row;
}

/* As in Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, 2014 (figure 14, mix32). */
static uint64_t mixed(uint64_t z)
{
    z = (z ^ (z >> 33)) * UINT64_C(0x62a9d9ed799705f5);
    return (z ^ (z >> 28)) * UINT64_C(0xcb24d0a5c88c35b3);
}

/* With config.meter_rows = n one of each n rows (or rows of quads) is metered. The numbers of frame and group choose it
 * pseudo-randomly, so that no stripe is hit every time. */
static int is_metered(const work *w, uint32_t unit_row)
{
    const uint32_t n = w->object->config.meter_rows;
    const uint32_t units = w->frame_height / w->in_unit;
    if (n <= 1)
        return 1;
    const uint32_t group = unit_row / n;
    const uint32_t rows = units - group * n < n ? units - group * n : n;
    const uint64_t z =
        mixed(w->object->adaptation.turn * UINT64_C(0x9e3779b97f4a7c15) + group * UINT64_C(0xd1b54a32d192ed03));
    return unit_row % n == (uint32_t)(z >> 32) % rows;
}

/* How many rows a row represents (0: it is not counted), which pixel of each group of columns it does so with, and the
 * next row that may be counted. */
typedef struct counted {
    uint32_t rows, first, next;
} counted;

/* As is_metered, for config.histogram_step, but independent of the frame's number. Groups start over in each row of the
 * metering grid, so that the rows of a group have the same weights, and the bins' sum is that of all weights. One of
 * each n rows is counted and, in it, one of each `columns` pixels. */
static counted counted_of(const work *w, uint32_t unit_row, uint32_t n, uint32_t columns)
{
    const uint32_t units = w->frame_height / w->in_unit;
    counted c = {.rows = 1, .next = unit_row + 1};
    if (n <= 1)
        return c;
    const uint32_t cell = pupil_grid_cell_of(unit_row, units), first = pupil_grid_first_in_cell(cell, units);
    const uint32_t next = cell + 1 < PUPIL_GRID_SIDE ? pupil_grid_first_in_cell(cell + 1, units) : units;
    const uint32_t group = first + (unit_row - first) / n * n;
    const uint32_t rows = next - group < n ? next - group : n;
    const uint64_t z = mixed((uint64_t)group * UINT64_C(0xd1b54a32d192ed03));
    c.first = (uint32_t)(z >> 48) % columns;
    if (w->object->config.meter_rows <= 1) {
        const uint32_t chosen = group + (uint32_t)(z >> 32 & 0xffff) % rows;
        c.rows = unit_row == chosen ? rows : 0;
        c.next = unit_row < chosen ? chosen : group + rows;
    }
    return c;
}

static const uint8_t *weights_of(const work *w, uint32_t unit_row, uint32_t *band)
{
    const uint32_t units = w->frame_height / w->in_unit;
    *band = unit_row * PUPIL_BANDS / units;
    return w->object->config.weight[pupil_grid_cell_of(unit_row, units)];
}

/* Meters row i, or the quads that begin there, if they are to be metered; returns the next row that may be. */
static uint32_t meter_unit(const work *w, uint32_t i)
{
    const uint32_t unit_row = (w->first_row + i) / w->in_unit, sample = w->meter.sample;
    counted c = {0};
    if (!is_metered(w, unit_row))
        return i + w->in_unit;
    if (sample > 1)
        c = counted_of(w, unit_row, sample, sample);
    else if (w->meter.histogram)
        c = counted_of(w, unit_row, w->histogram_step, w->meter.histogram);
    if (sample <= 1 || c.rows) {
        uint32_t band;
        const uint8_t *weight = weights_of(w, unit_row, &band);
        pupil_row row = row_of(w, i);
        row.bins_rows = c.rows;
        row.bins_first = c.first;
        work_row(&w->meter, weight, &row, 0, w->in->width / w->in_unit, band, w->stats);
    }
    return sample > 1 ? i + (c.next - unit_row) * w->in_unit : i + w->in_unit;
}

/* Meters row i, unless that is done apart for some of its pixels, and, if a row of pixels becomes a row of pixels, maps
 * it in the same pass. */
static void work_plain_row(const work *w, uint32_t i)
{
    static const uint8_t even[PUPIL_GRID_SIDE] = {0};
    pupil_row row = row_of(w, i);
    const uint8_t *weight = even;
    uint32_t band = 0;
    pupil_stats *stats = w->stats && w->meter.sample <= 1 && is_metered(w, w->first_row + i) ? w->stats : 0;
    if (stats)
        weight = weights_of(w, w->first_row + i, &band);
    if (stats && w->map.histogram) {
        const counted c = counted_of(w, w->first_row + i, w->histogram_step, w->map.histogram);
        row.bins_rows = c.rows;
        row.bins_first = c.first;
    }
    if (stats || w->out)
        work_row(&w->map, weight, &row, w->out ? out_row(w, i) : 0, w->in->width, band, stats);
}

/* The row, or the quads, that row i of out is mapped from. */
static pupil_row source_of(const work *w, uint32_t i)
{
    return row_of(w, w->map.way == PUPIL_WAY_BINNED ? 2 * i : i);
}

/* Rows i and i + 1 (or the last alone) of a picture in NV12 or I420. */
static void map_yuv_rows(const work *w, const pupil_luma_tables *tables, uint32_t i)
{
    const int two = i + 1 < w->out->height;
    const pupil_row upper = source_of(w, i), lower = source_of(w, two ? i + 1 : i);
    const pupil_yuv_rows to = {
        .upper = out_row(w, i),
        .lower = two ? out_row(w, i + 1) : 0,
        .chroma = (uint8_t *)w->out->chroma + (ptrdiff_t)(i / 2) * w->out->chroma_stride_bytes,
        .cr = w->planes_out > 2 ? (uint8_t *)w->out->cr + (ptrdiff_t)(i / 2) * w->out->cr_stride_bytes : 0};
    if (tables)
        pupil_map_luma(&w->map, &w->chroma, tables, &upper, &lower, w->out->width, &to);
    else
        pupil_map_yuv(&w->map, &w->chroma, &upper, &lower, 0, w->out->width, &to);
}

/* Rows i and i + 1 (or the last alone) of a picture in RGBA8, by luma. */
static void map_rgb_rows(const work *w, const pupil_luma_tables *tables, uint32_t i)
{
    const int two = i + 1 < w->out->height;
    const pupil_row upper = row_of(w, i), lower = row_of(w, two ? i + 1 : i);
    pupil_map_luma_rgb(&w->map, tables, &upper, two ? &lower : 0, w->out->width, out_row(w, i),
                       two ? out_row(w, i + 1) : 0);
}

/* Rows i to end of out; tables NULL: exactly. */
static void map_rows(const work *w, const pupil_luma_tables *tables, uint32_t i, uint32_t end)
{
    for (; i < end && w->planes_out > 1; i += 2)
        map_yuv_rows(w, tables, i);
    for (; i < end && tables; i += 2)
        map_rgb_rows(w, tables, i);
    for (; i < end; i++) {
        const pupil_row row = source_of(w, i);
        pupil_work_run(&w->map, &row, 0, w->out->width, out_row(w, i), 0, 0, 0);
    }
}

/* Where rows are not mapped one by one as they are metered: four at a time, which are whole quads, and whole pairs of
 * 4:2:0 also in a picture of half the size. They stay in the cache from metering to mapping. Not inline: with what it
 * keeps there, the stack of pupil_work_rows was above its limit (tree.stack). */
static __attribute__((noinline)) void work_in_fours(const work *w, const pupil_luma_tables *tables)
{
    const uint32_t halved = w->map.way == PUPIL_WAY_BINNED ? 2 : 1;
    uint32_t metered = 0;
    for (uint32_t i = 0; i < w->in->height; i += 4) {
        const uint32_t end = w->in->height - i < 4 ? w->in->height : i + 4;
        while (w->stats && metered < end)
            metered = meter_unit(w, metered);
        if (w->out)
            map_rows(w, tables, i / halved, end / halved);
    }
}

/* Whether mapping can go by luma: codes of a display's curve to such codes, whose colours keep their ratio. */
static int goes_by_luma(const work *w)
{
    static const pupil_coding usual = {0};
    if (w->object->config.accuracy != PUPIL_ACCURACY_LUMA || !w->out || w->map.to_picture || w->map.curve->dither ||
        w->object->config.transfer == PUPIL_TRANSFER_LINEAR || pupil_pixel_layout_of(w->in->pixel).yuv != 8 ||
        (w->coder.light != pupil_srgb_light && w->coder.light != pupil_bt709_light))
        return 0;
    const pupil_coding *in = w->in->coding ? w->in->coding : &usual, *out = w->out->coding ? w->out->coding : &usual;
    return w->planes_out > 1 ? in->matrix == out->matrix && in->range == out->range
                             : w->out->pixel == PUPIL_PIXEL_RGBA8 || w->out->pixel == PUPIL_PIXEL_BGRX8;
}

static __attribute__((noinline)) void work_by_luma(const work *w)
{
    pupil_luma_tables tables;
    pupil_luma_tables_make(&w->map, w->planes_out > 1 ? &w->chroma : 0, &tables);
    work_in_fours(w, &tables);
}

static __attribute__((noinline)) void work_plain_rows(const work *w)
{
    const int apart = w->stats && w->meter.sample > 1;
    uint32_t metered = 0;
    for (uint32_t i = 0; i < w->in->height; i++) {
        if (apart && i == metered)
            metered = meter_unit(w, i);
        if (w->out || !apart)
            work_plain_row(w, i);
    }
}

static void count_rows(const work *w)
{
    const float code_light = pupil_code_light(&w->coder, w->in->pixel);
    w->stats->rows += w->in->height;
    w->stats->frame_height = w->frame_height;
    w->stats->has_histogram = w->object->histogram;
    w->stats->code_light = code_light > w->stats->code_light ? code_light : w->stats->code_light;
}

/* A picture of other primaries than the input's, or with the rods' light, gets a job of its own, with its own brightest
 * channels. The rods' light changes no statistics. `mixed`: room for a matrix. */
static void convert_to_picture(work *w, const pupil_tone *curve, pupil_row_job *picture, float mixed[9])
{
    const pupil_object *object = w->object;
    const float *to_picture = object->has_to_picture ? object->to_picture : 0;
    const int mix = w->out && object->has_rods && curve->rods > 0.0f;
    if (mix)
        pupil_mix_rods(to_picture, object->rods_to_picture, curve->rods, mixed);
    else if (!to_picture)
        return;
    *picture = w->map;
    for (int i = 0; i < 3; i++)
        picture->luma[i] = object->picture_luma[i];
    if (w->out) {
        w->map.to_picture = mix ? mixed : to_picture;
        w->map.picture = picture;
    }
    if (object->histogram && w->in_unit == 1) /* no mosaic */
        w->map.to_peak = to_picture;
    w->meter.to_peak = w->map.to_peak;
}

/* The largest step of rows and columns that leaves `least` of the pixels. */
static uint32_t step_for(uint64_t pixels, uint32_t least)
{
    uint32_t step = PUPIL_MOST_STEP;
    while (step > 1 && pixels < (uint64_t)least * step * step)
        step /= 2;
    return step;
}

/* One of how many rows the histogram counts, of a frame that is metered with so many pixels. */
static uint32_t histogram_step(const pupil_object *object, uint32_t width, uint32_t height)
{
    if (!object->histogram || object->config.histogram_step)
        return object->histogram ? object->config.histogram_step : 0;
    return step_for((uint64_t)width * height / 2, LEAST_COUNTED); /* one of 2n x n pixels is counted */
}

/* Makes the metering job from the mapping job. */
static void make_meter(work *w)
{
    const pupil_object *object = w->object;
    const int mosaic = w->in_unit == 2;
    w->meter = w->map;
    w->meter.curve = 0;
    w->meter.way = mosaic ? PUPIL_WAY_BINNED : PUPIL_WAY_PIXELS;
    if (pupil_pixel_layout_of(w->in->pixel).yuv == 8 && object->config.accuracy == PUPIL_ACCURACY_LUMA) {
        w->meter.sample = step_for((uint64_t)w->in->width * w->frame_height, LEAST_SAMPLED);
        w->meter.histogram = w->meter.sample > 1 ? object->histogram : w->meter.histogram;
    }
    w->meter.grey_world = mosaic && object->config.grey_world;
    pupil_metered_luma(object->luma, &w->coder, w->meter.luma);
    if (mosaic)
        pupil_coder_find_ordinary(&w->coder, &w->meter);
}

void pupil_work_rows(const pupil_object *object, const pupil_image_const *in, uint32_t first_row, uint32_t frame_height,
                     pupil_stats *stats, const pupil_tone *curve, const pupil_image *out)
{
    work w = {.object = object, .in = in, .out = out, .stats = stats, .first_row = first_row};
    const int mosaic = pupil_pixel_is_mosaic(in->pixel);
    const int halved = out && out->width != in->width;
    const int yuv = out && pupil_pixel_planes(out->pixel) > 1;
    w.frame_height = frame_height;
    w.in_unit = mosaic ? 2 : 1;
    w.histogram_step = histogram_step(object, in->width / w.in_unit, frame_height / w.in_unit);
    w.planes = pupil_pixel_planes(in->pixel);
    w.planes_out = out ? pupil_pixel_planes(out->pixel) : 0;
    pupil_coder_make(in->coding, in->pixel, &w.coder);
    if (yuv)
        pupil_chroma_coder_make(out->coding, &w.chroma);
    w.map = (pupil_row_job){
        .kernels = pupil_level_kernels(object->level),
        .encoder = &pupil_encoders[object->config.transfer],
        .coder = &w.coder,
        .curve = curve,
        .cones = &object->cones,
        .luma = {object->luma[0], object->luma[1], object->luma[2]},
        .floor = object->config.floor,
        .clip = pupil_clip_of(&object->config, in->pixel, &w.coder),
        .in_pixel = in->pixel,
        .out_pixel = yuv   ? (uint32_t)PUPIL_PIXEL_RGBA8
                     : out ? out->pixel
                           : (uint32_t)PUPIL_PIXEL_NONE,
        .way = !mosaic  ? PUPIL_WAY_PIXELS
               : halved ? PUPIL_WAY_BINNED
                        : PUPIL_WAY_BILINEAR,
        .histogram = w.histogram_step > 1 ? 2 * w.histogram_step : w.histogram_step,
    };
    make_meter(&w);
    pupil_row_job picture;
    float mixed[9];
    if (object->has_to_picture || object->has_rods)
        convert_to_picture(&w, curve, &picture, mixed);

    if (goes_by_luma(&w))
        work_by_luma(&w);
    else if (mosaic || yuv)
        work_in_fours(&w, 0);
    else
        work_plain_rows(&w);
    if (stats)
        count_rows(&w);
}

void pupil_picture_job_make(const pupil_object *object, const pupil_image_const *in, const pupil_tone *curve,
                            uint32_t out_pixel, pupil_picture_job *job)
{
    const float *to_picture = object->has_to_picture ? object->to_picture : 0;
    pupil_coder_make(in->coding, in->pixel, &job->coder);
    job->map = (pupil_row_job){.kernels = pupil_level_kernels(object->level),
                               .encoder = &pupil_encoders[object->config.transfer],
                               .coder = &job->coder,
                               .curve = curve,
                               .cones = &object->cones,
                               .luma = {object->luma[0], object->luma[1], object->luma[2]},
                               .in_pixel = in->pixel,
                               .out_pixel = out_pixel};
    if (object->has_rods && curve->rods > 0.0f) {
        pupil_mix_rods(to_picture, object->rods_to_picture, curve->rods, job->mixed);
        to_picture = job->mixed;
    }
    if (!to_picture)
        return;
    job->picture = job->map;
    for (int i = 0; i < 3; i++)
        job->picture.luma[i] = object->picture_luma[i];
    job->map.to_picture = to_picture;
    job->map.picture = &job->picture;
}
