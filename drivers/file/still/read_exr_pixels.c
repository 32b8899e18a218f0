/* OpenEXR pixels: the library decompresses a chunk, this file spreads it over the picture.
 *
 * The library's own unpacking is not used: 3.1.5 writes through NULL where one of four channels of a half-float file is
 * not wanted, and does not support subsampled chroma. */
#include <stdlib.h>
#include <string.h>

#include "read_exr.h"

int pupil_exr_fail(exr_plan *plan, const char *what)
{
    return pupil_still_fail(plan->why, "%s%s%s", what, *plan->library_says ? ": " : "", plan->library_says);
}

/* The largest decompressed chunk: 256 lines (the most) of the widest allowed picture with four float channels. */
#define MAX_CHUNK_BYTES (UINT64_C(1) << 28)

/* The largest factor by which a packed chunk can grow: see read_exr.c. */
#define MAX_RATIO 1400

typedef struct exr_pixels {
    exr_plan *plan;
    float *rgb;
    uint32_t width, height; /* of the display window */
    float *chroma[2];       /* RY and BY over the data window, at their own sampling */
    int64_t chroma_width, chroma_height;
    exr_decode_pipeline_t decode;
    exr_result_t (*decompress)(exr_decode_pipeline_t *decode);
    int begun; /* decode has been set up */
} exr_pixels;

/* IEEE 754 binary16 to binary32: exact. */
static float half_to_float(uint32_t half)
{
    uint32_t sign = (half & 0x8000) << 16, exponent = half >> 10 & 31, mantissa = half & 1023, bits;
    float value;
    if (exponent == 0) {
        value = (float)mantissa * 0x1p-24f;
        return sign ? -value : value;
    }
    bits = sign | mantissa << 13 | (exponent == 31 ? 0x7f800000 : (exponent + 112) << 23);
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Samples are little-endian in the file, and so in the library's buffer. */
static float sample(const uint8_t *bytes, uint16_t type)
{
    uint32_t bits = (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8;
    float value;
    if (type == EXR_PIXEL_HALF)
        return half_to_float(bits);
    bits |= (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
    if (type == EXR_PIXEL_UINT)
        return (float)bits;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* A row of one full-size channel, which begins at (x, y) of the file's coordinates. */
static void spread_row(exr_pixels *p, int place, const uint8_t *in, const exr_coding_channel_info_t *info, int64_t x,
                       int64_t y)
{
    const exr_attr_box2i_t *display = &p->plan->display;
    int64_t first = x < display->min.x ? display->min.x - x : 0;
    int64_t end = x + info->width - 1 > display->max.x ? display->max.x - x + 1 : info->width;
    float *out;
    if (y < display->min.y || y > display->max.y || first >= end)
        return;
    out = p->rgb + ((uint64_t)(y - display->min.y) * p->width + (uint64_t)(x + first - display->min.x)) * 3 + place;
    in += first * info->bytes_per_element;
    for (int64_t i = first; i < end; i++, in += info->bytes_per_element, out += 3)
        *out = sample(in, info->data_type);
}

static void spread_chroma(exr_pixels *p, int which, const uint8_t *in, const exr_coding_channel_info_t *info, int64_t x,
                          int64_t y)
{
    const exr_plan *plan = p->plan;
    int64_t column = (x - plan->data.min.x) / plan->step_x, row = (y - plan->data.min.y) / plan->step_y;
    float *out;
    if (row >= p->chroma_height || column + info->width > p->chroma_width)
        return;
    out = p->chroma[which] + row * p->chroma_width + column;
    for (int i = 0; i < info->width; i++, in += info->bytes_per_element)
        out[i] = sample(in, info->data_type);
}

/* A decompressed chunk has its lines from the top, and each line has the channels' rows one after the other. */
static void spread_chunk(exr_pixels *p, int64_t left, int64_t top)
{
    const exr_plan *plan = p->plan;
    const uint8_t *in = p->decode.unpacked_buffer;
    for (int64_t y = top; y < top + p->decode.chunk.height; y++) {
        for (int c = 0; c < p->decode.channel_count; c++) {
            const exr_coding_channel_info_t *info = p->decode.channels + c;
            if (y % info->y_samples)
                continue;
            for (int place = 0; place < 3; place++) {
                if (plan->channel[place] != c)
                    continue;
                if (plan->kind == EXR_KIND_LUMA_CHROMA && place != 1)
                    spread_chroma(p, place / 2, in, info, left, y);
                else
                    spread_row(p, place, in, info, left, y);
            }
            in += (int64_t)info->width * info->bytes_per_element;
        }
    }
}

/* Whether the chunk is as the library's decompressors assume; else they would write beyond its buffers. The channels'
 * rows must fill it exactly, which fails if a subsampled channel has an odd number of lines. */
static int check_chunk(exr_pixels *p, const exr_chunk_info_t *chunk, int64_t top)
{
    uint64_t rows = 0, blocks = 0;
    for (int c = 0; c < p->decode.channel_count; c++) {
        const exr_coding_channel_info_t *info = p->decode.channels + c;
        uint64_t row = (uint64_t)info->width * (uint64_t)info->bytes_per_element;
        blocks += row * (uint64_t)info->height;
        for (int64_t y = top; y < top + chunk->height; y++)
            if (y % info->y_samples == 0)
                rows += row;
    }
    if (rows != chunk->unpacked_size || blocks != chunk->unpacked_size)
        return pupil_still_fail(p->plan->why,
                                "has channels subsampled in a way that the OpenEXR C library cannot unpack");
    if (chunk->unpacked_size > MAX_CHUNK_BYTES)
        return pupil_still_fail(p->plan->why, "has a chunk of %llu bytes; at most 256 MiB are decompressed at once",
                                (unsigned long long)chunk->unpacked_size);
    if (chunk->unpacked_size / MAX_RATIO > chunk->packed_size ||
        (p->plan->compression == EXR_COMPRESSION_NONE && chunk->packed_size != chunk->unpacked_size))
        return pupil_still_fail(p->plan->why, "is damaged: a chunk of %llu bytes cannot hold its %llu bytes of pixels",
                                (unsigned long long)chunk->packed_size, (unsigned long long)chunk->unpacked_size);
    return 0;
}

/* The library chooses how to read and decompress by the channels' destinations. Its unpacking is not used, so the
 * destinations only need to look valid. */
static exr_result_t begin_decode(exr_pixels *p, const exr_chunk_info_t *chunk)
{
    const exr_plan *plan = p->plan;
    exr_result_t result = exr_decoding_initialize(plan->file, plan->part, chunk, &p->decode);
    p->begun = result == EXR_ERR_SUCCESS;
    if (!p->begun)
        return result;
    for (int c = 0; c < p->decode.channel_count; c++) {
        p->decode.channels[c].decode_to_ptr = (uint8_t *)p->rgb;
        p->decode.channels[c].user_pixel_stride = 12; /* unlike any sample's size: no reading straight into place */
        p->decode.channels[c].user_line_stride = (int32_t)p->width * 12;
    }
    result = exr_decoding_choose_default_routines(plan->file, plan->part, &p->decode);
    p->decode.unpack_and_convert_fn = NULL;
    p->decompress = p->decode.decompress_fn;
    return result;
}

static int read_chunk(exr_pixels *p, const exr_chunk_info_t *chunk, int64_t left, int64_t top)
{
    exr_plan *plan = p->plan;
    exr_result_t result =
        p->begun ? exr_decoding_update(plan->file, plan->part, chunk, &p->decode) : begin_decode(p, chunk);
    if (result != EXR_ERR_SUCCESS)
        return pupil_exr_fail(plan, "cannot be decoded");
    if (check_chunk(p, chunk, top))
        return -1;
    /* A chunk that compression would not shrink is stored as it is; 3.1.5 treats such B44 chunks as compressed. */
    p->decode.decompress_fn = chunk->packed_size == chunk->unpacked_size ? NULL : p->decompress;
    result = exr_decoding_run(plan->file, plan->part, &p->decode);
    if (result == EXR_ERR_FEATURE_NOT_IMPLEMENTED)
        return pupil_still_fail(plan->why,
                                "is compressed with %s, which the installed OpenEXR C library (%s) does not read; "
                                "rewrite it with ZIP or PIZ",
                                plan->compression == EXR_COMPRESSION_DWAA ? "DWAA" : "DWAB", OPENEXR_VERSION_STRING);
    if (result != EXR_ERR_SUCCESS || !p->decode.unpacked_buffer)
        return pupil_exr_fail(plan, "is damaged");
    spread_chunk(p, left, top);
    return 0;
}

static int read_scanlines(exr_pixels *p)
{
    exr_plan *plan = p->plan;
    int32_t lines = 1;
    exr_get_scanlines_per_chunk(plan->file, plan->part, &lines);
    for (int64_t y = plan->data.min.y; y <= plan->data.max.y; y += lines) {
        exr_chunk_info_t chunk;
        if (exr_read_scanline_chunk_info(plan->file, plan->part, (int)y, &chunk) != EXR_ERR_SUCCESS)
            return pupil_exr_fail(plan, "is damaged or was not written to the end");
        if (read_chunk(p, &chunk, plan->data.min.x, y))
            return -1;
    }
    return 0;
}

static int read_tiles(exr_pixels *p)
{
    exr_plan *plan = p->plan;
    uint32_t tile_x = 1, tile_y = 1;
    exr_tile_level_mode_t level;
    exr_tile_round_mode_t round;
    int64_t width = (int64_t)plan->data.max.x - plan->data.min.x + 1;
    int64_t height = (int64_t)plan->data.max.y - plan->data.min.y + 1;
    exr_get_tile_descriptor(plan->file, plan->part, &tile_x, &tile_y, &level, &round);
    for (int64_t y = 0; y * tile_y < height; y++)
        for (int64_t x = 0; x * tile_x < width; x++) {
            exr_chunk_info_t chunk;
            if (exr_read_tile_chunk_info(plan->file, plan->part, (int)x, (int)y, 0, 0, &chunk) != EXR_ERR_SUCCESS)
                return pupil_exr_fail(plan, "is damaged or was not written to the end");
            if (read_chunk(p, &chunk, plan->data.min.x + x * tile_x, plan->data.min.y + y * tile_y))
                return -1;
        }
    return 0;
}

/* Chroma at a pixel of the data window: linear between the samples, which sit on the even pixels. */
static float chroma_at(const exr_pixels *p, int which, int64_t x, int64_t y)
{
    const float *plane = p->chroma[which];
    int64_t x0 = x / p->plan->step_x, y0 = y / p->plan->step_y;
    int64_t x1 = x % p->plan->step_x && x0 + 1 < p->chroma_width ? x0 + 1 : x0;
    int64_t y1 = y % p->plan->step_y && y0 + 1 < p->chroma_height ? y0 + 1 : y0;
    const float *above = plane + y0 * p->chroma_width, *below = plane + y1 * p->chroma_width;
    return 0.25f * (above[x0] + above[x1] + below[x0] + below[x1]);
}

/* Y, RY = (R - Y) / Y and BY = (B - Y) / Y to R, G, B ("Technical Introduction to OpenEXR", luminance/chroma images).
 */
static void rebuild_colour(exr_pixels *p)
{
    const exr_attr_box2i_t *data = &p->plan->data, *display = &p->plan->display;
    const double *w = p->plan->colour.luminance;
    float wr = (float)w[0], wg = (float)w[1], wb = (float)w[2];
    for (int64_t y = data->min.y > display->min.y ? data->min.y : display->min.y;
         y <= data->max.y && y <= display->max.y; y++)
        for (int64_t x = data->min.x > display->min.x ? data->min.x : display->min.x;
             x <= data->max.x && x <= display->max.x; x++) {
            float *rgb = p->rgb + ((uint64_t)(y - display->min.y) * p->width + (uint64_t)(x - display->min.x)) * 3;
            float luminance = rgb[1];
            rgb[0] = (chroma_at(p, 0, x - data->min.x, y - data->min.y) + 1) * luminance;
            rgb[2] = (chroma_at(p, 1, x - data->min.x, y - data->min.y) + 1) * luminance;
            rgb[1] = (luminance - wr * rgb[0] - wb * rgb[2]) / wg;
        }
}

static void spread_grey(exr_pixels *p)
{
    float *rgb = p->rgb;
    for (uint64_t i = (uint64_t)p->width * p->height; i; i--, rgb += 3)
        rgb[1] = rgb[2] = rgb[0];
}

static int reserve_chroma(exr_pixels *p)
{
    const exr_plan *plan = p->plan;
    p->chroma_width = ((int64_t)plan->data.max.x - plan->data.min.x) / plan->step_x + 1;
    p->chroma_height = ((int64_t)plan->data.max.y - plan->data.min.y) / plan->step_y + 1;
    for (int i = 0; i < 2; i++) {
        p->chroma[i] = calloc((size_t)(p->chroma_width * p->chroma_height), sizeof(float));
        if (!p->chroma[i])
            return pupil_still_fail(plan->why, "no memory for its chroma channels");
    }
    return 0;
}

static int covers(const exr_attr_box2i_t *outer, const exr_attr_box2i_t *inner)
{
    return outer->min.x <= inner->min.x && outer->min.y <= inner->min.y && outer->max.x >= inner->max.x &&
           outer->max.y >= inner->max.y;
}

/* One axis: where the data window begins in the display window, and which share of it that covers, as fractions. */
static void cover(int32_t data_min, int32_t data_max, int32_t display_min, int32_t display_max, double *begin,
                  double *share)
{
    const int64_t first = data_min > display_min ? data_min : display_min;
    const int64_t end = (int64_t)(data_max < display_max ? data_max : display_max) + 1;
    const double side = (double)display_max - display_min + 1;
    *begin = (double)(first - display_min) / side;
    *share = (double)(end - first) / side;
}

static void set_window(const exr_plan *plan, double window[4])
{
    const exr_attr_box2i_t *data = &plan->data, *display = &plan->display;
    cover(data->min.x, data->max.x, display->min.x, display->max.x, &window[0], &window[2]);
    cover(data->min.y, data->max.y, display->min.y, display->max.y, &window[1], &window[3]);
}

static int read_all(exr_pixels *p, pupil_still *still)
{
    exr_plan *plan = p->plan;
    if (plan->kind == EXR_KIND_LUMA_CHROMA && reserve_chroma(p))
        return -1;
    if (!covers(&plan->data, &plan->display)) {
        memset(p->rgb, 0, (size_t)p->width * p->height * 3 * sizeof(float));
        set_window(plan, still->window);
    }
    if (plan->is_tiled ? read_tiles(p) : read_scanlines(p))
        return -1;
    if (plan->kind == EXR_KIND_LUMA_CHROMA)
        rebuild_colour(p);
    if (plan->kind == EXR_KIND_LUMINANCE)
        spread_grey(p);
    pupil_still_colour_apply(&plan->colour, p->rgb, (uint64_t)p->width * p->height);
    return 0;
}

int pupil_exr_read_pixels(exr_plan *plan, pupil_still *still)
{
    exr_pixels p = {.plan = plan};
    int result;
    if (pupil_still_reserve(still, (uint64_t)((int64_t)plan->display.max.x - plan->display.min.x + 1),
                            (uint64_t)((int64_t)plan->display.max.y - plan->display.min.y + 1), PUPIL_PIXEL_RGB32F,
                            plan->why))
        return -1;
    p.rgb = still->pixels;
    p.width = still->width;
    p.height = still->height;
    result = read_all(&p, still);
    if (p.begun)
        exr_decoding_destroy(plan->file, &p.decode);
    free(p.chroma[0]);
    free(p.chroma[1]);
    return result;
}
